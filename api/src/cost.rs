//! A work-precision study as people look at it: a table, lines of comma-separated values, a chart.

use std::fmt::Write as _;

pub use drillsweep_sim::study::{CostErrors, CostReport, CostRow, Recommendation};

use crate::picture::{Point, Series, WantedAccuracy, WorkPrecisionChart};

/// Orbit size error that is drawn as the accuracy usually wanted.
const USUALLY_WANTED: f64 = 0.01;

/// Which error a chart shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// Of the orbit's size.
    #[default]
    OrbitSize,
    /// Of the trajectory, up to where histories part.
    Trajectory,
}

/// The study as text for a terminal.
pub fn text(report: &CostReport) -> String {
    let mut text = String::new();
    let mut line = |content: &str| {
        text.push_str(content.trim_end());
        text.push('\n');
    };
    line(&format!(
        "{}: {} s of simulated time, orbit size and lines over [{}, {}) s",
        if report.scenario.is_empty() { "scenario" } else { &report.scenario },
        report.duration,
        report.window.from,
        report.window.to
    ));
    line(&format!(
        "reference: {} at {} ms, {:.3} CPU s per simulated s",
        report.reference.integrator.name(),
        1e3 * report.reference.step,
        report.reference.cpu_per_simulated_second
    ));
    line(&match report.histories_part_at {
        Some(time) => format!(
            "a disturbance of 1e-6 m parts histories at {time:.2} s: trajectories are compared up to there"
        ),
        None => "a disturbance of 1e-6 m does not part histories in that time".to_owned(),
    });
    line("");
    line(&heading("method", "step ms"));
    for row in &report.methods {
        line(&of_row(row.integrator.name(), &format!("{:.4}", 1e3 * row.step), row));
    }
    if !report.meshes.is_empty() {
        line("");
        line(&heading("mesh", "elements"));
        for row in &report.meshes {
            line(&of_row(&format!("target lengths x{}", row.mesh_factor), &row.elements.to_string(), row));
        }
    }
    if !(report.recommendations.is_empty() && report.warnings.is_empty()) {
        line("");
    }
    for recommendation in &report.recommendations {
        line(&recommendation.text);
    }
    for warning in &report.warnings {
        line(&format!("warning: {warning}"));
    }
    text
}

fn heading(what: &str, number: &str) -> String {
    format!(
        "{what:20} {number:>9} {:>9} {:>10} {:>10} {:>11} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "CPU s/s",
        "trajectory",
        "orbit size",
        "mean radius",
        "line Hz",
        "static",
        "C_f",
        "energy",
        "estimate"
    )
}

fn of_row(what: &str, number: &str, row: &CostRow) -> String {
    let mut line = format!("{what:20} {number:>9} {:>9.3}", row.cpu_per_simulated_second);
    let Some(errors) = &row.errors else {
        let _ = write!(line, " failed: {}", row.failure.as_deref().unwrap_or_default());
        return line;
    };
    let CostErrors {
        trajectory,
        orbit_size,
        mean_radius,
        line_frequency_hz,
        static_position,
        friction_coefficient,
        energy,
        estimate,
    } = *errors;
    let columns = [
        (10, trajectory),
        (10, Some(orbit_size)),
        (11, Some(mean_radius)),
        (9, line_frequency_hz),
        (9, Some(static_position)),
        (9, friction_coefficient),
        (9, energy),
        (9, Some(estimate)),
    ];
    for (width, value) in columns {
        let value = value.map_or_else(|| "-".to_owned(), |value| format!("{value:.1e}"));
        let _ = write!(line, " {value:>width$}");
    }
    if row.step_subdivisions > 1 {
        let _ = write!(line, "  (each step cut in {})", row.step_subdivisions);
    }
    line
}

/// One line a run: `role` is reference, method or mesh; times in seconds, errors relative but for the line's frequency; what is
/// absent is empty.
pub fn csv(report: &CostReport) -> String {
    let mut text = String::from(
        "role,integrator,step,mesh_factor,elements,steps,step_subdivisions,cpu_time,cpu_per_simulated_second,trajectory,orbit_size,\
         mean_radius,line_frequency_hz,static_position,friction_coefficient,energy,estimate\n",
    );
    let rows = std::iter::once(("reference", &report.reference))
        .chain(report.methods.iter().map(|row| ("method", row)))
        .chain(report.meshes.iter().map(|row| ("mesh", row)));
    for (role, row) in rows {
        let errors = row.errors.as_ref();
        let of = |value: fn(&CostErrors) -> Option<f64>| {
            errors.and_then(value).map_or_else(String::new, |value| format!("{value:?}"))
        };
        let values = [
            of(|errors| errors.trajectory),
            of(|errors| Some(errors.orbit_size)),
            of(|errors| Some(errors.mean_radius)),
            of(|errors| errors.line_frequency_hz),
            of(|errors| Some(errors.static_position)),
            of(|errors| errors.friction_coefficient),
            of(|errors| errors.energy),
            of(|errors| Some(errors.estimate)),
        ];
        let _ = writeln!(
            text,
            "{role},{},{:?},{:?},{},{},{},{:?},{:?},{}",
            row.integrator.name(),
            row.step,
            row.mesh_factor,
            row.elements,
            row.steps,
            row.step_subdivisions,
            row.cpu_time,
            row.cpu_per_simulated_second,
            values.join(",")
        );
    }
    text
}

/// Error against processor time, one line a method, on logarithmic axes.
pub fn chart(report: &CostReport, measure: Measure) -> WorkPrecisionChart {
    let mut series: Vec<Series> = Vec::new();
    for row in &report.methods {
        let error = row.errors.as_ref().and_then(|errors| match measure {
            Measure::OrbitSize => Some(errors.orbit_size),
            Measure::Trajectory => errors.trajectory,
        });
        let Some(y) = error else { continue };
        let point = Point { x: row.cpu_per_simulated_second, y, label: step_label(row.step) };
        let name = row.integrator.name();
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(Series { name: name.to_owned(), points: vec![point] }),
        }
    }
    WorkPrecisionChart {
        title: format!("What accuracy costs: {}, {} s", report.scenario, report.duration),
        x_label: "CPU seconds per simulated second".to_owned(),
        y_label: match measure {
            Measure::OrbitSize => "relative error of orbit size",
            Measure::Trajectory => "relative error of the trajectory",
        }
        .to_owned(),
        wanted: Some(WantedAccuracy { y: USUALLY_WANTED, label: "1 %".to_owned() }),
        series,
    }
}

fn step_label(step: f64) -> String {
    if step >= 1e-4 { format!("{} ms", (step * 1e6).round() / 1e3) } else { format!("{:.0} µs", step * 1e6) }
}

#[cfg(test)]
mod tests {
    use drillsweep_sim::scenario::{Integrator, TimeWindow};

    use super::*;

    fn row(integrator: Integrator, step: f64, cpu: f64, error: Option<f64>) -> CostRow {
        CostRow {
            integrator,
            step,
            mesh_factor: 1.0,
            elements: 296,
            steps: 10_000,
            step_subdivisions: 1,
            cpu_time: 10.0 * cpu,
            cpu_per_simulated_second: cpu,
            errors: error.map(|error| CostErrors {
                trajectory: Some(2.0 * error),
                orbit_size: error,
                mean_radius: 1e-6,
                line_frequency_hz: None,
                static_position: 0.0,
                friction_coefficient: Some(0.0),
                energy: Some(1e-3),
                estimate: 1e-2,
            }),
            failure: error.is_none().then(|| "diverged at t = 0.1 s".to_owned()),
        }
    }

    fn report() -> CostReport {
        CostReport {
            scenario: "paper-200m".to_owned(),
            duration: 10.0,
            scenario_duration: 60.0,
            window: TimeWindow { from: 3.0, to: 10.0 },
            histories_part_at: Some(4.2),
            reference: row(Integrator::Esdirk4, 1.25e-4, 2.0, Some(0.0)),
            methods: vec![
                row(Integrator::Esdirk4, 1e-3, 0.25, Some(1e-4)),
                row(Integrator::Rk4, 5e-5, 3.0, Some(1e-5)),
                row(Integrator::Rk4, 6e-5, 2.5, None),
            ],
            meshes: Vec::new(),
            recommendations: Vec::new(),
            warnings: vec!["doubt this".to_owned()],
        }
    }

    #[test]
    fn text_shows_every_run_and_what_failed() {
        let text = text(&report());
        assert!(text.contains("parts histories at 4.20 s"));
        let lines: Vec<&str> =
            text.lines().filter(|line| line.starts_with("rk4") || line.starts_with("esdirk4")).collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[0].contains("1.0000") && lines[0].contains("2.0e-4") && lines[0].contains(" - "));
        assert!(lines[2].contains("failed: diverged at t = 0.1 s"));
        assert!(text.contains("warning: doubt this"));
    }

    #[test]
    fn csv_has_one_line_a_run_of_as_many_fields_as_names() {
        let csv = csv(&report());
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 5);
        let fields = |line: &str| line.split(',').count();
        assert!(lines.iter().all(|line| fields(line) == fields(lines[0])), "{csv}");
        assert!(lines[1].starts_with("reference,esdirk4,0.000125,") && lines[4].ends_with(",,,,,,,,"));
    }

    #[test]
    fn chart_has_a_line_a_method_and_leaves_failures_out() {
        let chart = chart(&report(), Measure::Trajectory);
        let sizes: Vec<_> =
            chart.series.iter().map(|series| (series.name.as_str(), series.points.len())).collect();
        assert_eq!(sizes, [("esdirk4", 1), ("rk4", 1)]);
        assert_eq!(chart.series[1].points[0].y, 2e-5);
        assert_eq!(
            (chart.series[0].points[0].label.as_str(), chart.series[1].points[0].label.as_str()),
            ("1 ms", "50 µs")
        );
        assert!(chart.svg().contains("relative error of the trajectory"));
    }
}
