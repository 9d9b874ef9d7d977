//! The points of a request, validated.

use drillsweep_scenario::{Problem, Problems, Scenario, Warning};
use drillsweep_sim::solve::step::step_problem;
use drillsweep_sim::validation::{validate, validate_changes};

use super::expansion::{Expansion, Keys, SweepPoint};
use super::interruption::Interruption;
use super::layout::Layout;
use super::problems::{Found, Written};
use crate::axis::AxisName;
use crate::problem::ProblemDetails;

/// All points. The first is validated in full, the others if the axes may have made a difference.
///
/// # Errors
/// The error of the interruption.
pub(super) fn points(
    written: &Written<'_>,
    layout: &Layout<'_>,
    base: Scenario,
    problems: &mut Found,
    interruption: Interruption<'_>,
) -> Result<Expansion, Box<ProblemDetails>> {
    let mut warnings = Found::default();
    let mut points = Vec::with_capacity(layout.total);
    let (mut scenario, mut keys) = (base.clone(), Keys::default());
    let paths: Vec<&str> = layout.names.iter().map(AxisName::scenario_path).collect();
    for (index, ordinal) in (0..layout.total).zip(1..) {
        interruption()?;
        let values = layout.values(index);
        let set = paths.iter().zip(&values).try_for_each(|(path, value)| scenario.set_number(path, *value));
        let checked = set.map_err(Problems::from).and_then(|()| match index {
            0 => validate(&scenario),
            _ => validate_changes(&scenario, paths.iter().copied()),
        });
        match checked {
            Ok(of_scenario) => {
                for Warning { path, message } in of_scenario {
                    let problem = Problem { path, got: String::new(), message };
                    warnings.add(written, |path| layout.place(index, path), &problem);
                }
            }
            Err(Problems(of_scenario)) => {
                for problem in &of_scenario {
                    problems.add(written, |path| layout.place(index, path), problem);
                }
                if problems.is_full() {
                    break;
                }
                continue;
            }
        }
        points.push(SweepPoint::new(ordinal, values, &mut scenario, &mut keys));
    }
    let warnings = warnings.into_vec();
    let expansion = Expansion { base, axes: layout.names.clone(), points, verification: None, warnings };
    // The stability limit of an explicit step takes an equilibrium to find: the extreme points stand for all.
    if problems.is_empty() {
        for index in layout.extremes(&expansion.points) {
            interruption()?;
            if let Some(problem) = step_problem(&expansion.scenario(&expansion.points[index])) {
                problems.add(written, |path| layout.place(index, path), &problem);
            }
        }
    }
    Ok(expansion)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::expand::tests::{pointers, problems};

    #[test]
    fn unsafe_time_stepping_is_refused_with_a_valid_step() {
        let of = |accuracy: Value| {
            problems(
                json!({"preset": "paper-200m", "set": {"accuracy": accuracy}, "axes": {"flow_rate": {"values": [0.01, 0.02]}}}),
            )
        };
        let beyond = of(json!({"integrator": "rk4", "step": 1e-4}));
        assert_eq!(beyond.len(), 1, "{beyond:?}");
        // The method's limit of stability in this scenario is 6.37e-5 s.
        assert!(beyond[0].0.starts_with("/set/accuracy") && beyond[0].2.contains("6.3"), "{beyond:?}");
        let undamped = of(json!({"integrator": "generalized_alpha", "step": 5e-4, "spectral_radius": 1.0}));
        assert!(undamped.len() == 1 && undamped[0].2.contains("0 to 0.95"), "{undamped:?}");
        let one_iteration = of(json!({"integrator": "esdirk4", "step": 1e-3, "contact_sweeps": 1}));
        assert!(one_iteration.len() == 1 && one_iteration[0].2.contains("2 to"), "{one_iteration:?}");
    }

    #[test]
    fn checks_skipped_for_later_points_find_nothing() {
        // The second point is bad in the one thing that its axis decides, whichever part of the scenario that is in.
        for (path, values) in [
            ("mud.flow_index", [0.5, -0.5]),
            ("contact.stiffness", [1e6, -1.0]),
            ("well.hole_diameter", [0.22, 0.1]),
            ("string.gauges[0].measured_depth", [150.0, 500.0]),
            ("mesh.collar", [0.5, -1.0]),
            ("recording.rate_hz", [1000.0, -1.0]),
            ("duration", [60.0, 0.0]),
            ("damping.mass_proportional", [0.1, -0.1]),
            ("accuracy.step", [1e-3, -1e-3]),
        ] {
            let body = json!({"preset": "paper-200m", "axes": {path: {"values": values}}});
            let found = pointers(body);
            assert!(found.iter().any(|pointer| pointer.starts_with("/")), "{path}: {found:?}");
        }
    }
}
