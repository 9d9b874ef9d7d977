//! What a cost study found, for people: a text for terminals, a table, and a picture.

mod chart;
mod table;
mod text;

pub use chart::{Measure, PNG_WIDTH, chart};
pub use table::{csv, table};
pub use text::text;

pub use drillsweep_sim::study::{CostErrors, CostReport, CostRow, Recommendation};

/// A step in the unit that reads best, to three digits: `1 ms`, `0.25 ms`, `58.8 µs`.
fn step_text(step: f64) -> String {
    let (value, unit) = match step {
        step if step >= 1.0 => (step, "s"),
        step if step >= 9.995e-5 => (step * 1e3, "ms"),
        step => (step * 1e6, "µs"),
    };
    format!("{} {unit}", three_digits(value))
}

/// A number to three digits, without zeros at the end.
fn three_digits(value: f64) -> String {
    let whole_digits = value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32 + 1;
    let decimals = usize::try_from(3 - whole_digits).unwrap_or(0).min(12);
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_sim::scenario::{Integrator, TimeWindow};
    use drillsweep_sim::study::{CostErrors, CostReport, CostRow, Recommendation};

    use super::*;

    /// A run with errors in proportion to `error`.
    pub(super) fn row(integrator: Integrator, step: f64, cpu: f64, error: f64) -> CostRow {
        CostRow {
            effect: None,
            integrator,
            step,
            mesh_factor: 1.0,
            elements: 296,
            steps: (2.0 / step).round() as u64,
            step_subdivisions: 1,
            cpu_time: 2.0 * cpu,
            cpu_per_simulated_second: cpu,
            errors: Some(CostErrors {
                trajectory: Some(3.0 * error),
                orbit_size: error,
                mean_radius: 0.1 * error,
                line_frequency_hz: Some(0.0),
                static_position: 0.0,
                friction_coefficient: Some(0.0),
                energy: None,
                estimate: 5.0 * error,
            }),
            failure: None,
        }
    }

    /// Two methods, of which the explicit one failed with its largest step, and two meshes.
    pub(super) fn report() -> CostReport {
        let coarse = CostRow { mesh_factor: 2.0, elements: 158, ..row(Integrator::Esdirk4, 1e-3, 0.2, 0.3) };
        let fine = CostRow { mesh_factor: 0.5, elements: 585, ..row(Integrator::Esdirk4, 1e-3, 0.8, 0.04) };
        CostReport {
            scenario: "paper-200m".to_owned(),
            duration: 2.0,
            scenario_duration: 60.0,
            window: TimeWindow { from: 1.0, to: 2.0 },
            histories_part_at: Some(1.234),
            reference: CostRow { errors: None, ..row(Integrator::Esdirk4, 2.5e-4, 1.6, 0.0) },
            methods: vec![
                row(Integrator::Esdirk4, 5e-4, 0.8, 2.5e-4),
                row(Integrator::Esdirk4, 1e-3, 0.4, 4e-3),
                CostRow {
                    errors: None,
                    failure: Some("diverged at 0.1 s, at once".to_owned()),
                    ..row(Integrator::Rk4, 1.0 / 16000.0, 1.0, 0.0)
                },
                row(Integrator::Rk4, 5e-5, 4.2, 1e-3),
            ],
            meshes: vec![coarse, fine],
            effects: Vec::new(),
            recommendations: vec![Recommendation {
                orbit_size: 0.01,
                integrator: Some(Integrator::Esdirk4),
                step: Some(1e-3),
                cpu_time: Some(24.0),
                text: "1 %: esdirk4 with 1 ms, 24 s for 60 s".to_owned(),
            }],
            warnings: vec!["a finer mesh meets a stiffer wall".to_owned()],
        }
    }

    #[test]
    fn steps_read_like_a_person_would_write_them() {
        for (step, text) in [
            (1e-3, "1 ms"),
            (5e-4, "0.5 ms"),
            (2.5e-4, "0.25 ms"),
            (1.25e-4, "0.125 ms"),
            (1e-4, "0.1 ms"),
            (5e-5, "50 µs"),
            (1.0 / 17_000.0, "58.8 µs"),
            (6.25e-5, "62.5 µs"),
            (1.25e-6, "1.25 µs"),
            (0.02, "20 ms"),
            (0.5, "500 ms"),
            (2.0, "2 s"),
        ] {
            assert_eq!(step_text(step), text);
        }
    }
}
