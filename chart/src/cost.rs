//! A cost study as a work-precision diagram.

use drillsweep_api::cost::{CostReport, CostRow, Measure, step_text, three_digits};
use drillsweep_scenario::{AccuracyPreset, Integrator};

use crate::picture::{Drawing, Point, RequestedAccuracy, Series, WorkPrecisionChart};

/// The error that is drawn as a line across.
const REQUESTED: f64 = 0.02;

/// Error against processor time per simulated second, or of runs that settle that of the whole run: a line of the named accuracies, and a line a method with a point a step. The
/// reference's two methods stand with the error of each against the other.
pub fn work_precision(report: &CostReport, measure: Measure) -> Drawing {
    chart(report, measure).drawing()
}

fn chart(report: &CostReport, measure: Measure) -> WorkPrecisionChart {
    let mut series: Vec<(String, Vec<&CostRow>)> = Vec::new();
    let meshes: &[CostRow] = if report.settles { &report.meshes } else { &[] };
    for (row, name) in report
        .compared()
        .map(|row| (row, series_name(row)))
        .chain(meshes.iter().map(|row| (row, mesh_series(row))))
    {
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
            x: if report.settles { row.cpu_time } else { row.cpu_per_simulated_second },
            y: measure.of(row),
            label: match row.tolerance {
                _ if row.mesh_factor != 1.0 => format!("x {}", three_digits(row.mesh_factor)),
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
        title: match report.settles {
            true => format!("Cost of accuracy: runs{of_scenario} until they have settled"),
            false => format!("Cost of accuracy: runs{of_scenario} over {} s", report.duration),
        },
        x_label: match report.settles {
            true => "CPU seconds of the run".to_owned(),
            false => "CPU seconds per simulated second".to_owned(),
        },
        y_label: label(measure, report),
        requested: Some(RequestedAccuracy { y: REQUESTED, label: "requested: 2 %".to_owned() }),
        series: series.collect(),
    }
}

/// Label of the vertical axis.
fn label(measure: Measure, report: &CostReport) -> String {
    let window = || match report.settles {
        true => "once settled".to_owned(),
        false => format!("over [{}, {}) s", report.orbit_window.from, report.orbit_window.to),
    };
    match (measure, report.histories_part_at) {
        (Measure::OrbitSize, _) => format!("relative error of orbit size {}", window()),
        (Measure::RadiusDeviation, _) => format!("relative error of std of radius {}", window()),
        (Measure::Trajectory, None) => "relative error of histories".to_owned(),
        (Measure::Trajectory, Some(time)) => {
            format!("relative error of histories up to {} s", three_digits(time))
        }
    }
}

/// The series of the named accuracies.
const PRESETS: &str = "presets";

/// The series that a line of the study belongs to.
fn series_name(row: &CostRow) -> String {
    let is_preset = AccuracyPreset::named(&row.name).is_some();
    let method = printed_name(row.integrator);
    match (row.tolerance, row.integrator) {
        _ if is_preset => PRESETS.to_owned(),
        (Some(_), _) => format!("{method}, adaptive"),
        (None, Integrator::Rk4) => method.to_owned(),
        (None, _) => format!("{method}, {} iterations", row.contact_sweeps),
    }
}

/// The series of a mesh, at the accuracy of its line.
fn mesh_series(row: &CostRow) -> String {
    format!("{}, other element lengths", row.name)
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
    use drillsweep_api::cost::CostErrors;
    use drillsweep_scenario::TimeWindow;
    use drillsweep_sim::solve::run::MotionRegime;
    use drillsweep_study::cost::StatisticError;

    use super::*;
    use crate::PNG_WIDTH;

    /// A run with a relative error of its orbits' size, and three times that of its histories.
    fn row(integrator: Integrator, step: f64, cpu: f64, error: f64) -> CostRow {
        let orbit_size = StatisticError {
            bias: error,
            half_width: None,
            spread: None,
            significant: None,
            measured_depth: None,
            nodes: Vec::new(),
        };
        CostRow {
            name: integrator.name().to_owned(),
            effect: None,
            integrator,
            step,
            tolerance: None,
            contact_sweeps: 2,
            mesh_factor: 1.0,
            elements: 296,
            steps: (2.0 / step).round() as u64,
            step_subdivisions: 1,
            simulated_time: 2.0,
            regime: Some(MotionRegime::Fixed),
            cpu_time: 2.0 * cpu,
            cpu_per_simulated_second: cpu,
            speed_over_rk4: None,
            errors: Some(CostErrors {
                orbit_size: Some(orbit_size),
                radius_deviation: None,
                mean_radius: None,
                contact_force: None,
                torsional_speed: None,
                lines: None,
                trajectory: Some(3.0 * error.abs()),
                static_position: 0.0,
                friction_coefficient: None,
                energy: None,
                estimate: 5.0 * error.abs(),
            }),
            failure: None,
        }
    }

    /// The reference's two methods, a preset, a fixed step, and a run that failed.
    fn report() -> CostReport {
        let failed = CostRow {
            errors: None,
            failure: Some("diverged at 0.1 s".to_owned()),
            ..row(Integrator::Rk4, 1.0 / 16000.0, 1.0, 0.0)
        };
        CostReport {
            scenario: "paper-200m".to_owned(),
            duration: 2.0,
            settles: false,
            scenario_duration: 60.0,
            orbit_window: TimeWindow { from: 1.333, to: 2.0 },
            spectrum_window: None,
            members: 1,
            histories_part_at: Some(1.234),
            references: vec![
                CostRow { name: "A".to_owned(), ..row(Integrator::Rk4, 5e-5, 4.2, -5e-4) },
                CostRow {
                    name: "B".to_owned(),
                    contact_sweeps: 30,
                    ..row(Integrator::Esdirk4, 1.25e-4, 3.2, 5e-4)
                },
            ],
            agreements: Vec::new(),
            methods: vec![
                CostRow { name: "draft".to_owned(), ..row(Integrator::Esdirk4, 1e-3, 0.4, 0.4) },
                row(Integrator::Esdirk4, 5e-4, 0.8, 4e-3),
                failed,
            ],
            starts: Vec::new(),
            meshes: Vec::new(),
            effects: Vec::new(),
            recommendations: Vec::new(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn every_method_is_a_line_from_large_to_small_steps() {
        let chart = chart(&report(), Measure::OrbitSize);
        let names: Vec<_> = chart.series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["RK4", "ESDIRK4(3)6L, 30 iterations", PRESETS, "ESDIRK4(3)6L, 2 iterations"]);
        let points = |series: usize| -> Vec<_> {
            chart.series[series].points.iter().map(|point| (point.x, point.y, point.label.as_str())).collect()
        };
        assert_eq!(points(0), [(1.0, 0.0, "62.5 µs"), (4.2, 5e-4, "50 µs")], "a failed run has no place");
        assert_eq!(points(2), [(0.4, 0.4, "draft")]);
        assert_eq!(points(3), [(0.8, 4e-3, "0.5 ms")]);
        assert_eq!(chart.requested.map(|requested| requested.y), Some(0.02));
        assert_eq!(chart.title, "Cost of accuracy: runs of paper-200m over 2 s");
        assert_eq!(chart.y_label, "relative error of orbit size over [1.333, 2) s");
    }

    #[test]
    fn trajectories_are_shown_on_demand() {
        let chart = chart(&report(), Measure::Trajectory);
        assert_eq!(chart.series[3].points[0].y, 0.012);
        assert_eq!(chart.y_label, "relative error of histories up to 1.23 s");
    }

    #[test]
    fn a_study_without_any_result_is_still_a_picture() {
        let mut report = report();
        report.references.clear();
        report.methods.clear();
        let drawing = work_precision(&report, Measure::usual(&report));
        assert!(drawing.svg().contains("no data"));
        assert!(drawing.png(PNG_WIDTH).is_ok());
    }
}
