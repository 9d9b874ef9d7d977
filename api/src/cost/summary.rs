//! Cost studies of several scenarios in one table: errors of each method and named accuracy, speeds relative to RK4, and
//! the verdicts on the promises of named accuracies.

use std::fmt::Write as _;

use drillsweep_quantity::columns;
use drillsweep_scenario::{Accuracy, AccuracyPreset, Integrator, Promise};
use drillsweep_study::cost::{CostReport, CostRow, Quantity, StatisticError};
use drillsweep_table::{Column, Table};
use serde::Serialize;

use super::digits::{step_text, three_digits};
use super::text::{Cells, aligned, four_digits, percent, signed_percent};

/// One line of one scenario's study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SummaryRow {
    /// Name of the scenario.
    pub scenario: String,
    /// The reference's largest orbit size of a recorded node that has a reference \[m\]; absent without any.
    pub reference_orbit_size: Option<f64>,
    /// Measured depth of that node \[m\].
    pub measured_depth: Option<f64>,
    /// Step \[s\] of the RK4 run that speeds are relative to; absent if the study has none of fixed steps.
    pub rk4_step: Option<f64>,
    /// Name of the line; `A` and `B` are the reference's two methods, each against the other.
    pub name: String,
    /// Method.
    pub integrator: Integrator,
    /// Step \[s\]; of an adaptive method the longest.
    pub step: f64,
    /// Tolerance of the adaptive step; absent if it is fixed.
    pub tolerance: Option<f64>,
    /// Orbit size at its worst node; absent if no reference exists.
    pub orbit_size: Option<WorstBias>,
    /// Standard deviation of the distance from the hole's axis, likewise.
    pub radius_deviation: Option<WorstBias>,
    /// Processor time per simulated second; absent if the run failed.
    pub cpu_per_simulated_second: Option<f64>,
    /// Speed relative to RK4 with steps of [`SummaryRow::rk4_step`].
    pub speed_over_rk4: Option<f64>,
    /// Promise of a named accuracy, and whether it keeps it; absent for others.
    pub promise: Option<PromiseCheck>,
    /// Lines above a twentieth of the reference's highest that the reference does not have; absent if that is unknown.
    pub spurious_lines: Option<usize>,
    /// Reason of the run's failure.
    pub failure: Option<String>,
}

/// Bias of a statistic at its worst node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WorstBias {
    /// Bias, relative to the reference.
    pub bias: f64,
    /// Half the width of its 95 % confidence interval; absent with one member.
    pub half_width: Option<f64>,
    /// Measured depth of the node \[m\].
    pub measured_depth: Option<f64>,
}

/// A named accuracy's promise against the measured errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PromiseCheck {
    /// Largest bias of orbit sizes that it allows.
    pub orbit_size: f64,
    /// Largest bias of standard deviations of the radius that it allows.
    pub radius_deviation: f64,
    /// Verdict on both.
    pub verdict: Verdict,
    /// Recorded nodes with a reference for both, on which the verdict rests.
    pub nodes: usize,
    /// Recorded nodes.
    pub of_nodes: usize,
}

/// Verdict on a promise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every node that has a reference keeps to it.
    Kept,
    /// A node is off by more.
    Broken,
    /// Unknown: the run failed, no reference exists for one of the two quantities, or an interval of the bias holds both.
    Unknown,
}

impl Verdict {
    fn word(self) -> &'static str {
        match self {
            Verdict::Kept => "kept",
            Verdict::Broken => "broken",
            Verdict::Unknown => "unknown",
        }
    }
}

impl PromiseCheck {
    /// The promise of a named accuracy's line; nothing for other lines.
    fn of(report: &CostReport, row: &CostRow) -> Option<Self> {
        let preset = AccuracyPreset::named(&row.name)?;
        let promise = Accuracy::Preset(preset).promise()?;
        let allowed = [
            (Quantity::OrbitSize, promise.orbit_size),
            (Quantity::RadiusDeviation, promise.radius_deviation),
        ];
        let error = |quantity| row.errors.as_ref().and_then(|errors| errors.statistic(quantity));
        let verdicts = allowed.map(|(quantity, allowed)| verdict(error(quantity), allowed));
        let verdict = match verdicts {
            verdicts if verdicts.contains(&Verdict::Broken) => Verdict::Broken,
            [Verdict::Kept, Verdict::Kept] => Verdict::Kept,
            _ => Verdict::Unknown,
        };
        let nodes = allowed.map(|(quantity, _)| error(quantity).map_or(0, |error| error.nodes.len()));
        let of_nodes = report.agreements.iter().filter(|agreement| agreement.quantity != Quantity::Lines);
        Some(Self {
            orbit_size: promise.orbit_size,
            radius_deviation: promise.radius_deviation,
            verdict,
            nodes: nodes[0].min(nodes[1]),
            of_nodes: of_nodes.map(|agreement| agreement.nodes.len()).max().unwrap_or(0),
        })
    }
}

/// Verdict on a statistic against the allowed error, its interval included.
fn verdict(error: Option<&StatisticError>, allowed: f64) -> Verdict {
    let Some(error) = error else { return Verdict::Unknown };
    let ranges = error.nodes.iter().map(|node| {
        let half_width = node.half_width.unwrap_or(0.0);
        (node.bias.abs() - half_width, node.bias.abs() + half_width)
    });
    let (least, most) =
        ranges.fold((0.0_f64, 0.0_f64), |(least, most), (low, high)| (least.max(low), most.max(high)));
    match () {
        () if least > allowed => Verdict::Broken,
        () if most <= allowed => Verdict::Kept,
        () => Verdict::Unknown,
    }
}

/// The lines of several studies, study by study: the reference's two methods and all others over time; meshes and effects have none.
pub fn summary(reports: &[CostReport]) -> Vec<SummaryRow> {
    reports.iter().flat_map(|report| report.compared().map(|row| summary_row(report, row))).collect()
}

fn summary_row(report: &CostReport, row: &CostRow) -> SummaryRow {
    let agreement = report.agreement(Quantity::OrbitSize);
    let sizes =
        agreement.into_iter().flat_map(|agreement| &agreement.nodes).filter(|node| node.has_reference);
    // The reference is the mean of its two methods.
    let sizes = sizes.map(|node| (0.5 * (node.values[0] + node.values[1]), node.measured_depth));
    let largest = sizes.max_by(|a, b| a.0.total_cmp(&b.0));
    let worst = |quantity| {
        let error = row.errors.as_ref()?.statistic(quantity)?;
        let StatisticError { bias, half_width, measured_depth, .. } = *error;
        Some(WorstBias { bias, half_width, measured_depth })
    };
    let lines = row.errors.as_ref().and_then(|errors| errors.lines.as_ref());
    SummaryRow {
        scenario: report.scenario.clone(),
        reference_orbit_size: largest.map(|(size, _)| size),
        measured_depth: largest.and_then(|(_, depth)| depth),
        rk4_step: report.rk4().map(|rk4| rk4.step),
        name: row.name.clone(),
        integrator: row.integrator,
        step: row.step,
        tolerance: row.tolerance,
        orbit_size: worst(Quantity::OrbitSize),
        radius_deviation: worst(Quantity::RadiusDeviation),
        cpu_per_simulated_second: row.failure.is_none().then_some(row.cpu_per_simulated_second),
        speed_over_rk4: row.speed_over_rk4,
        promise: PromiseCheck::of(report, row),
        spurious_lines: lines.map(|lines| lines.spurious.len()),
        failure: row.failure.clone(),
    }
}

/// The lines of several studies as a table.
pub fn summary_table(rows: &[SummaryRow]) -> Table {
    let texts = |text: &dyn Fn(&SummaryRow) -> Option<String>| Column::Text(rows.iter().map(text).collect());
    let numbers = |number: &dyn Fn(&SummaryRow) -> Option<f64>| {
        Column::Number(rows.iter().map(|row| number(row).unwrap_or(f64::NAN)).collect())
    };
    let spurious = rows.iter().map(|row| i64::try_from(row.spurious_lines?).ok());
    Table::default()
        .with(&columns::SCENARIO, texts(&|row| Some(row.scenario.clone())))
        .with(&columns::REFERENCE_ORBIT_SIZE, numbers(&|row| row.reference_orbit_size))
        .with(&columns::MEASURED_DEPTH, numbers(&|row| row.measured_depth))
        .with(&columns::RK4_STEP, numbers(&|row| row.rk4_step))
        .with(&columns::NAME, texts(&|row| Some(row.name.clone())))
        .with(&columns::INTEGRATOR, texts(&|row| Some(row.integrator.name().to_owned())))
        .with(&columns::STEP, numbers(&|row| Some(row.step)))
        .with(&columns::TOLERANCE, numbers(&|row| row.tolerance))
        .with(&columns::ORBIT_SIZE_BIAS, numbers(&|row| Some(row.orbit_size?.bias)))
        .with(&columns::ORBIT_SIZE_HALF_WIDTH, numbers(&|row| row.orbit_size?.half_width))
        .with(&columns::RADIUS_DEVIATION_BIAS, numbers(&|row| Some(row.radius_deviation?.bias)))
        .with(&columns::RADIUS_DEVIATION_HALF_WIDTH, numbers(&|row| row.radius_deviation?.half_width))
        .with(&columns::CPU_PER_SIMULATED_SECOND, numbers(&|row| row.cpu_per_simulated_second))
        .with(&columns::SPEED_OVER_RK4, numbers(&|row| row.speed_over_rk4))
        .with(&columns::PROMISE, texts(&|row| Some(row.promise?.verdict.word().to_owned())))
        .with(&columns::SPURIOUS_LINES, Column::Integer(spurious.collect()))
        .with(&columns::FAILURE, texts(&|row| row.failure.clone()))
}

/// The lines of several studies in words and aligned columns.
pub fn summary_text(rows: &[SummaryRow]) -> String {
    let cells = |head, cell: &dyn Fn(&SummaryRow) -> Option<String>| Cells {
        head,
        cells: rows.iter().map(cell).collect(),
    };
    let bias = |row: &SummaryRow, worst: Option<WorstBias>| match worst {
        _ if row.failure.is_some() => None,
        None => Some("no reference".to_owned()),
        Some(WorstBias { bias, half_width, .. }) => {
            let interval =
                half_width.map_or_else(String::new, |half_width| format!(" ± {}", percent(half_width)));
            Some(format!("{}{interval}", signed_percent(bias)))
        }
    };
    let columns = [
        cells("scenario", &|row| Some(row.scenario.clone())),
        cells("orbit size", &|row| Some(format!("{} mm", four_digits(1e3 * row.reference_orbit_size?)))),
        cells("at", &|row| row.measured_depth.map(|depth| format!("{} m", three_digits(depth)))),
        cells("name", &|row| (row.name != row.integrator.name()).then(|| row.name.clone())),
        cells("method", &|row| Some(row.integrator.name().to_owned())),
        cells("step", &|row| Some(step_text(row.step))),
        cells("tolerance", &|row| row.tolerance.map(|tolerance| format!("{tolerance:e}"))),
        cells("size error", &|row| bias(row, row.orbit_size)),
        cells("std of radius", &|row| bias(row, row.radius_deviation)),
        cells("CPU s per s", &|row| row.cpu_per_simulated_second.map(three_digits)),
        cells("x rk4", &|row| row.speed_over_rk4.map(three_digits)),
        cells("promise", &|row| {
            let PromiseCheck { verdict, nodes, of_nodes, .. } = row.promise?;
            let at = if verdict == Verdict::Kept && nodes < of_nodes {
                format!(" at {nodes} of {of_nodes} nodes")
            } else {
                String::new()
            };
            Some(format!("{}{at}", verdict.word()))
        }),
        cells("spurious", &|row| row.spurious_lines.map(|lines| lines.to_string())),
    ];
    let failures: Vec<String> = rows
        .iter()
        .map(|row| row.failure.as_ref().map_or_else(String::new, |reason| format!("  failed: {reason}")))
        .collect();
    let mut text =
        "all scenarios: the reference's largest orbit, and the error of each run at its worst node (in %)\n"
            .to_owned();
    text.push_str(&aligned(&columns, &failures));
    let promises = AccuracyPreset::ALL.into_iter().filter_map(|preset| {
        let Promise { orbit_size, radius_deviation } = Accuracy::Preset(preset).promise()?;
        Some(format!("{} {} and {} %", preset.name(), percent(orbit_size), percent(radius_deviation)))
    });
    let _ = writeln!(
        text,
        "promises (orbit size and std of radius): {}; spurious are lines above a twentieth of the highest",
        promises.collect::<Vec<_>>().join(", ")
    );
    let mut known: Vec<&str> = Vec::new();
    for row in rows {
        let is_new = !known.contains(&row.scenario.as_str());
        known.push(&row.scenario);
        if let Some(step) = row.rk4_step.filter(|_| is_new) {
            let _ = writeln!(text, "x rk4 of {}: relative to rk4 with {}", row.scenario, step_text(step));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use drillsweep_study::cost::NodeStatistic;

    use super::*;
    use crate::cost::tests::{report, row};

    /// A report whose line `draft` has biases of orbit size and of the radius' deviation.
    fn with_draft(orbit_size: f64, radius_deviation: Option<f64>) -> CostReport {
        let mut report = report();
        let draft = CostRow { name: "draft".to_owned(), ..row(Integrator::Esdirk4, 8e-3, 0.1, orbit_size) };
        report.methods = vec![draft];
        let errors = report.methods[0].errors.as_mut().unwrap();
        errors.radius_deviation =
            radius_deviation.and_then(|bias| row(Integrator::Esdirk4, 8e-3, 0.1, bias).errors?.orbit_size);
        report
    }

    fn promise(report: &CostReport) -> PromiseCheck {
        summary(std::slice::from_ref(report))[2].promise.unwrap()
    }

    #[test]
    fn a_named_accuracy_keeps_its_promise_or_does_not() {
        for (orbit_size, radius_deviation, verdict) in [
            (0.079, Some(-0.149), Verdict::Kept),
            (-0.081, Some(0.0), Verdict::Broken),
            (0.0, Some(0.151), Verdict::Broken),
            // A promise that one quantity breaks is broken; one that it keeps depends on the other.
            (0.081, None, Verdict::Broken),
            (0.0, None, Verdict::Unknown),
        ] {
            let found = promise(&with_draft(orbit_size, radius_deviation));
            assert_eq!(found.verdict, verdict, "{orbit_size} {radius_deviation:?}");
            assert_eq!((found.orbit_size, found.radius_deviation), (0.08, 0.15));
        }
        let rows = summary(&[with_draft(0.0, None)]);
        assert_eq!((rows[0].promise, rows[1].promise), (None, None), "methods promise nothing");
    }

    #[test]
    fn an_interval_that_holds_both_leaves_the_promise_open() {
        let mut report = with_draft(0.07, Some(0.0));
        for (half_width, verdict) in [(0.005, Verdict::Kept), (0.02, Verdict::Unknown)] {
            let error = report.methods[0].errors.as_mut().unwrap().orbit_size.as_mut().unwrap();
            error.nodes[0].half_width = Some(half_width);
            assert_eq!(promise(&report).verdict, verdict);
        }
        // One node that is off for sure is enough, whatever the others are.
        let error = report.methods[0].errors.as_mut().unwrap().orbit_size.as_mut().unwrap();
        let sure = NodeStatistic { bias: -0.2, half_width: Some(0.1), ..error.nodes[0].clone() };
        error.nodes.push(sure);
        assert_eq!(promise(&report).verdict, Verdict::Broken);
    }

    #[test]
    fn scenarios_stand_under_each_other_with_the_step_of_rk4() {
        let mut other = with_draft(0.041, Some(0.2));
        other.scenario = "other".to_owned();
        other.references[0].step = 4e-5;
        insta::assert_snapshot!(summary_text(&summary(&[report(), other])));
    }

    #[test]
    fn rows_are_served_as_a_table_and_as_json() {
        let rows = summary(&[report()]);
        let csv = drillsweep_table::csv::write(&summary_table(&rows)).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(
            lines[0],
            "scenario,reference_orbit_size,measured_depth,rk4_step,name,integrator,step,tolerance,orbit_size_bias,\
             orbit_size_half_width,radius_deviation_bias,radius_deviation_half_width,cpu_per_simulated_second,speed_over_rk4,\
             promise,spurious_lines,failure"
        );
        assert!(lines[3].ends_with(",draft,esdirk4,0.001,,0.4,,,,0.4,10.5,broken,1,"), "{}", lines[3]);
        assert!(lines[5].ends_with(",,,,,,,,\"diverged at 0.1 s, at once\""), "{}", lines[5]);
        let json = serde_json::to_value(&rows[2]).unwrap();
        assert_eq!(
            (&json["promise"]["verdict"], &json["orbit_size"]["bias"]),
            (&"broken".into(), &0.4.into())
        );
    }
}
