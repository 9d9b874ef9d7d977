//! A cost study as a work-precision diagram.

use std::str::FromStr;

use drillsweep_sim::scenario::{AccuracyPreset, Integrator};
use drillsweep_sim::study::cost::{CostReport, CostRow, Quantity};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{step_text, three_digits};
use crate::picture::{Point, Series, WantedAccuracy, WorkPrecisionChart};

/// Width of the picture as PNG: twice its natural size, so that it is sharp on fine screens and in print.
pub const PNG_WIDTH: u32 = 1600;

/// The error that is drawn as a line across.
const WANTED: f64 = 0.02;

/// The error that a work-precision diagram shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Of the recorded histories, up to where they part.
    Trajectory,
    /// Of the size of the orbits, over the orbit window.
    OrbitSize,
    /// Of the standard deviation of the distance from the hole's axis, over the orbit window.
    RadiusDeviation,
}

impl Measure {
    /// All measures, the usual ones first.
    const ALL: [Measure; 3] = [Measure::OrbitSize, Measure::RadiusDeviation, Measure::Trajectory];

    /// Orbit size; the deviation of the radius, or else trajectories, where no run has an error of orbit size to show.
    pub fn usual(report: &CostReport) -> Self {
        let has_any = |measure: &Measure| report.compared().any(|row| measure.of(row) > 0.0);
        Measure::ALL.into_iter().find(has_any).unwrap_or(Measure::OrbitSize)
    }

    /// The size of a run's error; zero, which no diagram shows, where it has none.
    fn of(self, row: &CostRow) -> f64 {
        let bias = |quantity| Some(row.errors.as_ref()?.statistic(quantity)?.bias.abs());
        let error = match self {
            Measure::Trajectory => row.errors.as_ref().and_then(|errors| errors.trajectory),
            Measure::OrbitSize => bias(Quantity::OrbitSize),
            Measure::RadiusDeviation => bias(Quantity::RadiusDeviation),
        };
        error.unwrap_or(0.0)
    }

    fn label(self, report: &CostReport) -> String {
        let window = || format!("over [{}, {}) s", report.orbit_window.from, report.orbit_window.to);
        match (self, report.histories_part_at) {
            (Measure::OrbitSize, _) => format!("relative error of orbit size {}", window()),
            (Measure::RadiusDeviation, _) => format!("relative error of std of radius {}", window()),
            (Measure::Trajectory, None) => "relative error of histories".to_owned(),
            (Measure::Trajectory, Some(time)) => {
                format!("relative error of histories up to {} s", three_digits(time))
            }
        }
    }

    /// The name on the wire.
    fn name(self) -> &'static str {
        match self {
            Measure::Trajectory => "trajectory",
            Measure::OrbitSize => "orbit_size",
            Measure::RadiusDeviation => "radius_deviation",
        }
    }
}

impl FromStr for Measure {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Measure::ALL.into_iter().find(|measure| measure.name() == name);
        found.ok_or_else(|| "must be orbit_size, radius_deviation or trajectory".to_owned())
    }
}

/// Error against processor time per simulated second: a line of the named accuracies, and a line a method with a point a step. The
/// reference's two methods stand with the error of each against the other.
pub fn chart(report: &CostReport, measure: Measure) -> WorkPrecisionChart {
    let mut series: Vec<(String, Vec<&CostRow>)> = Vec::new();
    for row in report.compared() {
        let name = series_name(row);
        match series.iter_mut().find(|(known, _)| *known == name) {
            Some((_, rows)) => rows.push(row),
            None => series.push((name, vec![row])),
        }
    }
    let series = series.into_iter().map(|(name, mut rows)| {
        let order = |row: &CostRow| row.tolerance.unwrap_or(row.step);
        match name == PRESETS {
            true => rows.sort_by(|a, b| a.cpu_time.total_cmp(&b.cpu_time)),
            false => rows.sort_by(|a, b| order(b).total_cmp(&order(a))),
        }
        let point = |row: &CostRow| Point {
            x: row.cpu_per_simulated_second,
            y: measure.of(row),
            label: match row.tolerance {
                _ if name == PRESETS => row.name.clone(),
                Some(tolerance) => format!("{tolerance:e}"),
                None => step_text(row.step),
            },
        };
        let points = rows.into_iter().map(point).collect();
        Series { name, points }
    });
    let of_scenario =
        if report.scenario.is_empty() { String::new() } else { format!(" of {}", report.scenario) };
    WorkPrecisionChart {
        title: format!("What accuracy costs: runs{of_scenario} over {} s", report.duration),
        x_label: "CPU seconds per simulated second".to_owned(),
        y_label: measure.label(report),
        wanted: Some(WantedAccuracy { y: WANTED, label: "wanted: 2 %".to_owned() }),
        series: series.collect(),
    }
}

/// The series of the named accuracies.
const PRESETS: &str = "presets";

/// The series that a line of the study belongs to.
fn series_name(row: &CostRow) -> String {
    let is_preset = [AccuracyPreset::Draft, AccuracyPreset::Standard, AccuracyPreset::Reference]
        .iter()
        .any(|preset| preset.name() == row.name);
    let method = printed_name(row.integrator);
    match (row.tolerance, row.integrator) {
        _ if is_preset => PRESETS.to_owned(),
        (Some(_), _) => format!("{method}, adaptive"),
        (None, Integrator::Rk4) => method.to_owned(),
        (None, _) => format!("{method}, {} sweeps", row.contact_sweeps),
    }
}

/// The name of a method as it is printed.
fn printed_name(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::GeneralizedAlpha => "generalized-alpha",
        Integrator::Esdirk4 => "ESDIRK4(3)6L",
        Integrator::Rk4 => "RK4",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::tests::report;

    #[test]
    fn every_method_is_a_line_from_large_to_small_steps() {
        let chart = chart(&report(), Measure::OrbitSize);
        let names: Vec<_> = chart.series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["RK4", "ESDIRK4(3)6L, 30 sweeps", PRESETS, "ESDIRK4(3)6L, 2 sweeps"]);
        let points = |series: usize| -> Vec<_> {
            chart.series[series].points.iter().map(|point| (point.x, point.y, point.label.as_str())).collect()
        };
        assert_eq!(points(0), [(1.0, 0.0, "62.5 µs"), (4.2, 5e-4, "50 µs")], "a failed run has no place");
        assert_eq!(points(2), [(0.4, 0.4, "draft")]);
        assert_eq!(points(3), [(0.8, 4e-3, "0.5 ms")]);
        assert_eq!(chart.wanted.map(|wanted| wanted.y), Some(0.02));
        assert_eq!(chart.title, "What accuracy costs: runs of paper-200m over 2 s");
        assert_eq!(chart.y_label, "relative error of orbit size over [1.333, 2) s");
    }

    #[test]
    fn trajectories_are_shown_on_demand_and_where_there_is_nothing_else() {
        let mut report = report();
        assert_eq!(Measure::usual(&report), Measure::OrbitSize);
        let chart = chart(&report, Measure::Trajectory);
        assert_eq!(chart.series[3].points[0].y, 0.012);
        assert_eq!(chart.y_label, "relative error of histories up to 1.23 s");
        for row in report.references.iter_mut().chain(&mut report.methods) {
            if let Some(errors) = &mut row.errors {
                errors.orbit_size = None;
            }
        }
        assert_eq!(Measure::usual(&report), Measure::Trajectory);
    }

    #[test]
    fn a_measure_is_read_as_it_is_written() {
        for measure in Measure::ALL {
            let written = serde_json::to_value(measure).unwrap();
            assert_eq!(written.as_str().unwrap().parse(), Ok(measure));
        }
        assert!("orbit".parse::<Measure>().is_err());
    }

    #[test]
    fn a_study_without_any_result_is_still_a_picture() {
        let mut report = report();
        report.references.clear();
        report.methods.clear();
        report.meshes.clear();
        let chart = chart(&report, Measure::usual(&report));
        assert!(chart.svg().contains("no data"));
        assert!(chart.png(PNG_WIDTH).is_ok());
    }
}
