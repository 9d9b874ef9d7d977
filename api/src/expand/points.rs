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

    use crate::expand::tests::{expansion, pointers, problems};

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
    fn bit_depth_is_an_axis_whose_points_have_keys_of_their_own() {
        let body = |depths: Value| {
            json!({
                "preset": "paper-200m",
                "set": {"string.gauges": [], "string.unbalance": [], "recording.nodes": [{"depth": 50}]},
                "axes": {"string.bit_depth": {"values": depths}},
            })
        };
        let depths = [80.0, 110.5, 158.0, 162.0, 199.9, 200.0];
        let expanded = expansion(body(json!(depths)));
        let mut keys: Vec<_> = expanded.points.iter().map(|point| point.key).collect();
        for (point, depth) in expanded.points.iter().zip(depths) {
            assert_eq!(expanded.scenario(point).string.bit_depth, Some(depth));
        }
        let mut whole = body(json!([200.0]));
        whole.as_object_mut().unwrap().remove("axes");
        assert_eq!(expansion(whole).points[0].key, keys[5], "the whole string as without a bit depth");
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), depths.len());
        let found = problems(body(json!([80.0, 250.0])));
        assert_eq!((found.len(), found[0].0.as_str()), (1, "/axes/string.bit_depth/values/1"), "{found:?}");
        assert!(found[0].2.contains("at most the length of the string, 200 m"), "{found:?}");
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
