//! A cost study as a work-precision diagram.

use std::str::FromStr;

use drillsweep_sim::scenario::Integrator;
use drillsweep_sim::study::{CostReport, CostRow};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{step_text, three_digits};
use crate::picture::{Point, Series, WantedAccuracy, WorkPrecisionChart};

/// Width of the picture as PNG: twice its natural size, so that it is sharp on fine screens and in print.
pub const PNG_WIDTH: u32 = 1600;

/// The error that is drawn as a line across.
const WANTED: f64 = 0.01;

/// The error that a work-precision diagram shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Of the recorded histories, up to where a disturbed reference parts from itself.
    Trajectory,
    /// Of the size of the orbits.
    OrbitSize,
}

impl Measure {
    /// Orbit size; trajectories where no run has an error of orbit size to show.
    pub fn usual(report: &CostReport) -> Self {
        match report.methods.iter().any(|row| Measure::OrbitSize.of(row) > 0.0) {
            true => Measure::OrbitSize,
            false => Measure::Trajectory,
        }
    }

    /// The error of a run; zero, which no diagram shows, where it has none.
    fn of(self, row: &CostRow) -> f64 {
        let error = row.errors.as_ref().and_then(|errors| match self {
            Measure::Trajectory => errors.trajectory,
            Measure::OrbitSize => Some(errors.orbit_size),
        });
        error.unwrap_or(0.0)
    }

    fn label(self, report: &CostReport) -> String {
        match (self, report.histories_part_at) {
            (Measure::OrbitSize, _) => "relative error of orbit size".to_owned(),
            (Measure::Trajectory, None) => "relative error of histories".to_owned(),
            (Measure::Trajectory, Some(time)) => {
                format!("relative error of histories up to {} s", three_digits(time))
            }
        }
    }
}

impl FromStr for Measure {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "trajectory" => Ok(Measure::Trajectory),
            "orbit_size" => Ok(Measure::OrbitSize),
            _ => Err("must be trajectory or orbit_size".to_owned()),
        }
    }
}

/// Error against processor time per simulated second, a line a method, a point a step.
pub fn chart(report: &CostReport, measure: Measure) -> WorkPrecisionChart {
    let mut series: Vec<(Integrator, Vec<&CostRow>)> = Vec::new();
    for row in &report.methods {
        match series.iter_mut().find(|(integrator, _)| *integrator == row.integrator) {
            Some((_, rows)) => rows.push(row),
            None => series.push((row.integrator, vec![row])),
        }
    }
    let series = series.into_iter().map(|(integrator, mut rows)| {
        rows.sort_by(|a, b| b.step.total_cmp(&a.step));
        let point = |row: &CostRow| Point {
            x: row.cpu_per_simulated_second,
            y: measure.of(row),
            label: step_text(row.step),
        };
        Series { name: printed_name(integrator).to_owned(), points: rows.into_iter().map(point).collect() }
    });
    let of_scenario =
        if report.scenario.is_empty() { String::new() } else { format!(" of {}", report.scenario) };
    WorkPrecisionChart {
        title: format!("What accuracy costs: runs{of_scenario} over {} s", report.duration),
        x_label: "CPU seconds per simulated second".to_owned(),
        y_label: measure.label(report),
        wanted: Some(WantedAccuracy { y: WANTED, label: "wanted: 1 %".to_owned() }),
        series: series.collect(),
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
        assert_eq!(names, ["ESDIRK4(3)6L", "RK4"]);
        let points = |series: usize| -> Vec<_> {
            chart.series[series].points.iter().map(|point| (point.x, point.y, point.label.as_str())).collect()
        };
        assert_eq!(points(0), [(0.4, 4e-3, "1 ms"), (0.8, 2.5e-4, "0.5 ms")]);
        assert_eq!(points(1), [(1.0, 0.0, "62.5 µs"), (4.2, 1e-3, "50 µs")], "a failed run has no place");
        assert_eq!(chart.wanted.map(|wanted| wanted.y), Some(0.01));
        assert_eq!(chart.title, "What accuracy costs: runs of paper-200m over 2 s");
    }

    #[test]
    fn trajectories_are_shown_on_demand_and_where_there_are_no_orbits() {
        let mut report = report();
        assert_eq!(Measure::usual(&report), Measure::OrbitSize);
        let chart = chart(&report, Measure::Trajectory);
        assert_eq!(chart.series[0].points[0].y, 0.012);
        assert_eq!(chart.y_label, "relative error of histories up to 1.23 s");
        for row in &mut report.methods {
            if let Some(errors) = &mut row.errors {
                errors.orbit_size = 0.0;
            }
        }
        assert_eq!(Measure::usual(&report), Measure::Trajectory);
    }

    #[test]
    fn a_measure_is_read_as_it_is_written() {
        for measure in [Measure::Trajectory, Measure::OrbitSize] {
            let written = serde_json::to_value(measure).unwrap();
            assert_eq!(written.as_str().unwrap().parse(), Ok(measure));
        }
        assert!("orbit".parse::<Measure>().is_err());
    }

    #[test]
    fn a_study_without_any_result_is_still_a_picture() {
        let mut report = report();
        report.methods.clear();
        report.meshes.clear();
        let chart = chart(&report, Measure::usual(&report));
        assert!(chart.svg().contains("no data"));
        assert!(chart.png(PNG_WIDTH).is_ok());
    }
}
