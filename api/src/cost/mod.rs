//! Results of a cost study, for people: a text for terminals, a table, and which error a chart shows.

mod digits;
mod measure;
mod table;
mod text;

pub use digits::{step_text, three_digits};
pub use measure::Measure;
pub use table::table;
pub use text::{overview, text};

pub use drillsweep_study::cost::{CostErrors, CostReport, CostRow};

#[cfg(test)]
pub(crate) mod tests {
    use drillsweep_scenario::{Integrator, TimeWindow};
    use drillsweep_sim::solve::run::MotionRegime;
    use drillsweep_study::cost::{
        Agreement, CostErrors, CostReport, CostRow, LineErrors, NodeAgreement, NodeStatistic, Quantity,
        Recommendation, SpuriousLine, StatisticError,
    };

    use super::*;

    fn statistic(bias: f64) -> StatisticError {
        let node = NodeStatistic {
            measured_depth: Some(57.8),
            reference: 1.0,
            value: 1.0 + bias,
            bias,
            half_width: None,
            spread: None,
            reference_spread: None,
        };
        StatisticError {
            bias,
            half_width: None,
            spread: None,
            significant: None,
            measured_depth: Some(57.8),
            nodes: vec![node],
        }
    }

    /// A run with errors in proportion to `error`.
    pub(super) fn row(integrator: Integrator, step: f64, cpu: f64, error: f64) -> CostRow {
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
            speed_over_rk4: Some(4.2 / cpu),
            errors: Some(CostErrors {
                orbit_size: Some(statistic(error)),
                radius_deviation: None,
                mean_radius: Some(statistic(0.1 * error)),
                contact_force: None,
                torsional_speed: None,
                lines: Some(LineErrors {
                    frequency_hz: Some(0.0),
                    amplitude: error.abs(),
                    missing: 0,
                    named: Vec::new(),
                    spurious: Vec::new(),
                }),
                trajectory: Some(3.0 * error.abs()),
                static_position: 0.0,
                friction_coefficient: Some(0.0),
                energy: None,
                estimate: 5.0 * error.abs(),
            }),
            failure: None,
        }
    }

    /// A report whose row `draft` has biases of orbit size and of the radius' deviation.
    pub(super) fn with_draft(orbit_size: f64, radius_deviation: Option<f64>) -> CostReport {
        let mut draft =
            CostRow { name: "draft".to_owned(), ..row(Integrator::Esdirk4, 8e-3, 0.1, orbit_size) };
        if let Some(errors) = &mut draft.errors {
            errors.radius_deviation = radius_deviation.map(statistic);
        }
        CostReport { methods: vec![draft], ..report() }
    }

    /// Gives a row's statistics an interval and a spread.
    pub(super) fn with_members(row: &mut CostRow, half_width: f64, spread: f64) {
        let Some(errors) = &mut row.errors else { return };
        for error in [&mut errors.orbit_size, &mut errors.mean_radius].into_iter().flatten() {
            error.half_width = Some(half_width);
            error.spread = Some(spread);
            error.significant = Some(error.bias.abs() > half_width);
        }
    }

    fn agreement(quantity: Quantity, values: [f64; 2], difference: f64, bound: f64) -> Agreement {
        Agreement {
            quantity,
            difference,
            half_width: None,
            bound,
            has_reference: difference <= bound,
            nodes: vec![NodeAgreement {
                measured_depth: Some(57.8),
                values,
                difference,
                has_reference: difference <= bound,
            }],
        }
    }

    /// Two methods that agree on orbit size but not on the radius, a preset with a spurious line, a fixed step, one run that
    /// failed, and two meshes.
    pub(crate) fn report() -> CostReport {
        let coarse = CostRow { mesh_factor: 2.0, elements: 158, ..row(Integrator::Esdirk4, 1e-3, 0.2, 0.3) };
        let fine = CostRow { mesh_factor: 0.5, elements: 585, ..row(Integrator::Esdirk4, 1e-3, 0.8, 0.04) };
        let mut draft = CostRow { name: "draft".to_owned(), ..row(Integrator::Esdirk4, 1e-3, 0.4, 0.4) };
        if let Some(lines) = draft.errors.as_mut().and_then(|errors| errors.lines.as_mut()) {
            lines.spurious.push(SpuriousLine { measured_depth: 57.8, frequency_hz: 14.65, height: 0.593 });
        }
        CostReport {
            scenario: "paper-200m".to_owned(),
            duration: 2.0,
            settles: false,
            scenario_duration: 60.0,
            orbit_window: TimeWindow { from: 1.333, to: 2.0 },
            spectrum_window: Some(TimeWindow { from: 1.667, to: 2.0 }),
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
            agreements: vec![
                agreement(Quantity::OrbitSize, [7.160e-4, 7.164e-4], 5e-4, 0.01),
                agreement(Quantity::RadiusDeviation, [7.8e-5, 8.19e-5], 0.05, 0.03),
            ],
            methods: vec![
                draft,
                row(Integrator::Esdirk4, 5e-4, 0.8, 4e-3),
                CostRow {
                    elements: 0,
                    steps: 0,
                    simulated_time: 0.0,
                    regime: None,
                    cpu_time: 0.0,
                    cpu_per_simulated_second: 0.0,
                    errors: None,
                    speed_over_rk4: None,
                    failure: Some("diverged at 0.1 s, at once".to_owned()),
                    ..row(Integrator::Rk4, 1.0 / 16000.0, 1.0, 0.0)
                },
            ],
            starts: Vec::new(),
            meshes: vec![coarse, fine],
            effects: Vec::new(),
            recommendations: vec![Recommendation {
                quantity: Quantity::OrbitSize,
                accuracy: 0.02,
                name: Some("esdirk4".to_owned()),
                integrator: Some(Integrator::Esdirk4),
                step: Some(5e-4),
                tolerance: None,
                cpu_time: Some(48.0),
                text: "2 % of orbit size: esdirk4 with a step of 0.5 ms".to_owned(),
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
