//! Cost studies as one table.

use drillsweep_quantity::columns::*;
use drillsweep_scenario::{AccuracyPreset, Promise};
use drillsweep_study::cost::{CostErrors, CostReport, CostRow, LineErrors, NodeStatistic, Quantity};
use drillsweep_table::{Column, Table};

/// A row of a study, with the name of its scenario and its role.
pub(super) type Run<'a> = (&'a str, &'static str, &'a CostRow);

/// One row a line of each study: its scenario and `role` (`reference`, `method`, `start`, `mesh` or `effect`), its settings, its cost, the
/// verdict on the `promise` of an accuracy preset, its errors against the reference (of statistics bias, half the width of its interval, and
/// spread), and the `failure` of one that has none.
pub fn table<'a>(reports: impl IntoIterator<Item = &'a CostReport>) -> Table {
    of_runs(&reports.into_iter().flat_map(runs).collect::<Vec<_>>())
}

/// The rows of a study.
pub(super) fn runs(report: &CostReport) -> impl Iterator<Item = Run<'_>> {
    report.runs().map(|(role, row)| (report.scenario.as_str(), role, row))
}

/// The table of these rows.
pub(super) fn of_runs(runs: &[Run<'_>]) -> Table {
    let texts = |text: fn(&Run<'_>) -> Option<String>| Column::Text(runs.iter().map(text).collect());
    let numbers = |number: &dyn Fn(&CostRow) -> Option<f64>| {
        Column::Number(runs.iter().map(|(.., row)| number(row).unwrap_or(f64::NAN)).collect())
    };
    let counts = |count: fn(&CostRow) -> Option<u64>| {
        Column::Integer(runs.iter().map(|(.., row)| i64::try_from(count(row)?).ok()).collect())
    };
    let errors = |error: fn(&CostErrors) -> Option<f64>| numbers(&|row| error(row.errors.as_ref()?));
    let mut table = Table::default()
        .with(&SCENARIO, texts(|(scenario, ..)| Some((*scenario).to_owned())))
        .with(&ROLE, texts(|(_, role, _)| Some((*role).to_owned())))
        .with(&NAME, texts(|(.., row)| Some(row.name.clone())))
        .with(&WITHOUT_EFFECT, texts(|(.., row)| Some(row.effect?.name().to_owned())))
        .with(&INTEGRATOR, texts(|(.., row)| Some(row.integrator.name().to_owned())))
        .with(&STEP, numbers(&|row| Some(row.step)))
        .with(&TOLERANCE, numbers(&|row| row.tolerance))
        .with(&CONTACT_ITERATIONS, counts(|row| Some(row.contact_sweeps.into())))
        .with(&MESH_FACTOR, numbers(&|row| Some(row.mesh_factor)))
        .with(&ELEMENTS, counts(|row| Some(row.elements as u64)))
        .with(&STEPS, counts(|row| Some(row.steps)))
        .with(&STEP_SUBDIVISIONS, counts(|row| Some(row.step_subdivisions.into())))
        .with(&SIMULATED_TIME, numbers(&|row| Some(row.simulated_time)))
        .with(&MOTION_REGIME, texts(|(.., row)| Some(row.regime?.name().to_owned())))
        .with(&CPU_TIME, numbers(&|row| Some(row.cpu_time)))
        .with(&CPU_PER_SIMULATED_SECOND, numbers(&|row| Some(row.cpu_per_simulated_second)))
        .with(&SPEED_OVER_RK4, numbers(&|row| row.speed_over_rk4))
        .with(&PROMISE, texts(|run| promise(run).map(str::to_owned)));
    for &quantity in Quantity::ALL.iter().filter(|&&quantity| quantity != Quantity::Lines) {
        let statistic = |row: &CostRow| row.errors.as_ref()?.statistic(quantity).cloned();
        let name = quantity.name();
        table = table
            .with(format!("{name}_bias"), numbers(&|row| Some(statistic(row)?.bias)))
            .with(format!("{name}_half_width"), numbers(&|row| statistic(row)?.half_width))
            .with(format!("{name}_spread"), numbers(&|row| statistic(row)?.spread));
    }
    fn lines(row: &CostRow) -> Option<&LineErrors> {
        row.errors.as_ref()?.lines.as_ref()
    }
    table
        .with(&LINE_FREQUENCY_ERROR_HZ, numbers(&|row| lines(row)?.frequency_hz))
        .with(&LINE_AMPLITUDE_ERROR, numbers(&|row| Some(lines(row)?.amplitude)))
        .with(&MISSING_LINES, counts(|row| Some(lines(row)?.missing.into())))
        .with(&SPURIOUS_LINES, counts(|row| Some(lines(row)?.spurious.len() as u64)))
        .with(&TRAJECTORY_ERROR, errors(|errors| errors.trajectory))
        .with(&STATIC_POSITION_ERROR, errors(|errors| Some(errors.static_position)))
        .with(&FRICTION_COEFFICIENT_ERROR, errors(|errors| errors.friction_coefficient))
        .with(&ENERGY_ERROR, errors(|errors| errors.energy))
        .with(&ESTIMATED_ERROR, errors(|errors| Some(errors.estimate)))
        .with(&FAILURE, texts(|(.., row)| row.failure.clone()))
}

/// Verdict on the promise of an accuracy preset, intervals of the biases included: `kept` at every node that has a reference, `broken` at one, or
/// `unknown`: the run failed, no reference exists for one of the two quantities, or an interval contains the bound. Absent for other rows.
fn promise((_, role, row): &Run<'_>) -> Option<&'static str> {
    let preset = AccuracyPreset::named(&row.name).filter(|_| *role == "method")?;
    let Promise { orbit_size, radius_deviation } = preset.promise();
    let is_kept = |quantity, allowed| {
        let nodes = &row.errors.as_ref()?.statistic(quantity)?.nodes;
        let exceeds = |node: &NodeStatistic| node.bias.abs() - node.half_width.unwrap_or(0.0) > allowed;
        match nodes.iter().any(exceeds) {
            true => Some(false),
            false => nodes.iter().all(|node| node.bound() <= allowed).then_some(true),
        }
    };
    Some(
        match [is_kept(Quantity::OrbitSize, orbit_size), is_kept(Quantity::RadiusDeviation, radius_deviation)]
        {
            [Some(true), Some(true)] => "kept",
            [Some(false), _] | [_, Some(false)] => "broken",
            _ => "unknown",
        },
    )
}

#[cfg(test)]
mod tests {
    use drillsweep_table::csv::write;

    use super::*;
    use crate::cost::tests::{report, with_draft};

    #[test]
    fn every_run_has_a_row_and_a_failed_one_says_why() {
        let other = CostReport { scenario: "other".to_owned(), ..report() };
        let csv = write(&table(&[report(), other])).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(
            lines[0],
            "scenario,role,name,without_effect,integrator,step,tolerance,contact_sweeps,mesh_factor,elements,steps,step_subdivisions,\
             simulated_time,motion_regime,cpu_time,cpu_per_simulated_second,speed_over_rk4,promise,\
             orbit_size_bias,orbit_size_half_width,orbit_size_spread,\
             radius_deviation_bias,radius_deviation_half_width,radius_deviation_spread,\
             mean_radius_bias,mean_radius_half_width,mean_radius_spread,\
             contact_force_bias,contact_force_half_width,contact_force_spread,\
             torsional_speed_bias,torsional_speed_half_width,torsional_speed_spread,\
             line_frequency_error_hz,line_amplitude_error,missing_lines,spurious_lines,trajectory_error,\
             static_position_error,friction_coefficient_error,energy_error,estimated_error,failure"
        );
        let roles: Vec<&str> = lines[1..].iter().filter_map(|line| line.split(',').nth(1)).collect();
        let of_one = ["reference", "reference", "method", "method", "method", "mesh", "mesh"];
        assert_eq!(roles, [of_one, of_one].concat());
        assert_eq!(
            lines[3],
            "paper-200m,method,draft,,esdirk4,0.001,,2,1.0,296,2000,1,2.0,fixed,0.8,0.4,10.5,broken,0.4,,,,,,0.04000000000000001,,,,,,,,,\
             0.0,0.4,0,1,1.2000000000000002,0.0,0.0,,2.0,"
        );
        assert!(lines[5].ends_with(",,,,,,,,\"diverged at 0.1 s, at once\""), "{}", lines[5]);
        assert!(lines[6].starts_with("paper-200m,mesh,esdirk4,,esdirk4,0.001,,2,2.0,158,"), "{}", lines[6]);
        assert!(lines[8].starts_with("other,reference,A,"), "{}", lines[8]);
    }

    /// The verdicts on the rows of a report.
    fn verdicts(report: &CostReport) -> Vec<Option<&'static str>> {
        runs(report).map(|run| promise(&run)).collect()
    }

    #[test]
    fn a_named_accuracy_keeps_its_promise_or_does_not() {
        for (orbit_size, radius_deviation, verdict) in [
            (0.079, Some(-0.149), "kept"),
            (-0.081, Some(0.0), "broken"),
            (0.0, Some(0.151), "broken"),
            // A promise that one quantity breaks is broken; one that it keeps depends on the other.
            (0.081, None, "broken"),
            (0.0, None, "unknown"),
        ] {
            let found = verdicts(&with_draft(orbit_size, radius_deviation));
            // Methods promise nothing.
            assert_eq!(found[..3], [None, None, Some(verdict)], "{orbit_size} {radius_deviation:?}");
        }
        // Nor does an accuracy on another mesh.
        let mut report = report();
        report.meshes[0].name = "draft".to_owned();
        assert_eq!(verdicts(&report)[5], None);
    }

    #[test]
    fn an_interval_that_holds_both_leaves_the_promise_open() {
        let mut report = with_draft(0.07, Some(0.0));
        for (half_width, verdict) in [(0.005, "kept"), (0.02, "unknown")] {
            let error = report.methods[0].errors.as_mut().unwrap().orbit_size.as_mut().unwrap();
            error.nodes[0].half_width = Some(half_width);
            assert_eq!(verdicts(&report)[2], Some(verdict));
        }
        // One node that is off for sure is enough, whatever the others are.
        let error = report.methods[0].errors.as_mut().unwrap().orbit_size.as_mut().unwrap();
        let sure = NodeStatistic { bias: -0.2, half_width: Some(0.1), ..error.nodes[0].clone() };
        error.nodes.push(sure);
        assert_eq!(verdicts(&report)[2], Some("broken"));
    }

    #[test]
    fn columns_have_units() {
        let units = table(&[report()]).units;
        assert_eq!(units["step"], "s");
        assert_eq!(units["cpu_time"], "s");
        assert_eq!(units["cpu_per_simulated_second"], "1");
        assert_eq!(units["line_frequency_error_hz"], "Hz");
        assert_eq!(units["orbit_size_bias"], "1");
        assert_eq!(units["radius_deviation_half_width"], "1");
        assert_eq!(units["speed_over_rk4"], "1");
    }
}
