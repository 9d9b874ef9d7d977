//! The scenario that the points of a request share.

use drillsweep_scenario::{PRESETS, Problems, Scenario, ScenarioRequest, json_number, unknown_preset};
use drillsweep_sim::validation::validate;
use indexmap::IndexSet;

use super::interruption::Interruption;
use super::layout::{Layout, axis_pointer};
use super::problems::{Found, Written};
use crate::axis::AxisName;
use crate::problem::ProblemDetails;
use crate::request::{Design, SweepRequest};

/// The scenario that the axes are applied to: preset or scenario, with the changes of `set`.
///
/// # Errors
/// The error of the interruption.
pub(super) fn resolve(
    request: &SweepRequest,
    written: &Written<'_>,
    problems: &mut Found,
    interruption: Interruption<'_>,
) -> Result<Option<Scenario>, Box<ProblemDetails>> {
    match (&request.preset, &request.scenario) {
        (Some(_), Some(_)) => problems.push("", None, "`preset` and `scenario` exclude each other; give one"),
        (None, None) => problems.push("", None, "either `preset` or `scenario` must be given"),
        (Some(name), None) if !PRESETS.iter().any(|(preset, _)| preset == name) => {
            problems.push("/preset", Some(name.as_str().into()), unknown_preset(name).message);
        }
        _ => {
            let scenario = ScenarioRequest {
                preset: request.preset.clone(),
                scenario: request.scenario.as_deref().cloned(),
                set: request.set.clone(),
            };
            let swept: Vec<&str> = swept(request).collect();
            interruption()?;
            match scenario.resolve_for_sweep(&swept) {
                Ok(mut scenario) => {
                    if let Some(outputs) = &request.outputs {
                        scenario.recording.outputs = outputs.clone();
                    }
                    return Ok(Some(scenario));
                }
                Err(Problems(of_set)) => {
                    for problem in of_set {
                        problems.add(written, |_| None, &problem);
                    }
                }
            }
        }
    }
    Ok(None)
}

/// Sets the swept fields to the values of the first point; false if one of them is no numeric field.
pub(super) fn set_fields(
    request: &SweepRequest,
    layout: &Layout<'_>,
    base: &mut Scenario,
    problems: &mut Found,
) -> bool {
    let before = problems.len();
    for (axis, (name, value)) in layout.names.iter().zip(layout.values(0)).enumerate() {
        if let Err(problem) = base.set_number(name.scenario_path(), value) {
            let pointer = match request.design {
                Design::List => layout.pointer(0, axis),
                _ => axis_pointer(name),
            };
            let got = (!problem.got.is_empty()).then(|| json_number(value));
            problems.push(pointer, got, format!("{}: {}", problem.path, problem.message));
        }
    }
    problems.len() == before
}

/// The problems of the scenario itself, when the axes cannot be expanded: a sweep's other mistakes are not
/// kept back until its axes are right. Values that the axes would replace are not checked.
pub(super) fn check_without_axes(
    request: &SweepRequest,
    written: &Written<'_>,
    scenario: &Scenario,
    problems: &mut Found,
) {
    let Err(Problems(of_scenario)) = validate(scenario) else { return };
    let replaced: IndexSet<&str> = swept(request).collect();
    for problem in of_scenario.iter().filter(|problem| !replaced.contains(problem.path.as_str())) {
        problems.add(written, |_| None, problem);
    }
}

/// The paths of the fields that a request changes from point to point.
fn swept(request: &SweepRequest) -> impl Iterator<Item = &str> {
    request.names().map(AxisName::scenario_path)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;
    use serde_json::json;

    use crate::expand::tests::{expansion, pointers, problems};

    #[test]
    fn exactly_one_of_preset_and_scenario_is_given() {
        assert_eq!(pointers(json!({})), [""]);
        let scenario = serde_json::to_value(preset("paper-200m").unwrap()).unwrap();
        assert_eq!(pointers(json!({"preset": "paper-200m", "scenario": scenario})), [""]);
        assert_eq!(pointers(json!({"preset": "papre-200m"})), ["/preset"]);
    }

    #[test]
    fn an_override_of_no_field_is_reported_at_its_path() {
        let body =
            json!({"preset": "paper-200m", "set": {"mud.flow_rat": 0.02, "a/b": 1, "duration": "long"}});
        let mut found = pointers(body);
        found.sort();
        assert_eq!(found, ["/set/a~1b", "/set/duration", "/set/mud.flow_rat"]);
    }

    #[test]
    fn a_presets_windows_follow_a_duration_axis() {
        let sweep = expansion(json!({"preset": "paper-200m", "axes": {"duration": {"values": [6, 30]}}}));
        let windows: Vec<_> = sweep
            .points
            .iter()
            .map(|point| sweep.scenario(point))
            .map(|scenario| {
                (scenario.orbit_window().unwrap().from, scenario.spectrum_windows().unwrap()[0].from)
            })
            .collect();
        assert_eq!(windows, [(4.0, 5.0), (20.0, 25.0)]);
        let by_points = expansion(
            json!({"preset": "paper-200m", "design": "list", "points": [{"duration": 6}, {"duration": 30}]}),
        );
        assert_eq!(by_points.points[1].key, sweep.points[1].key);
        let swept_window = expansion(json!({"preset": "paper-200m", "axes": {
            "duration": {"values": [50]}, "recording.orbit_window.to": {"values": [45, 50]}}}));
        let window = swept_window.scenario(&swept_window.points[0]).orbit_window().unwrap();
        assert_eq!((window.from, window.to), (40.0, 45.0));
    }

    #[test]
    fn a_dry_hole_has_no_mud_to_sweep() {
        let found = problems(json!({"preset": "paper-200m-dry", "axes": {"flow_rate": {"values": [0.01]}}}));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "/axes/flow_rate");
    }

    #[test]
    fn wrong_axes_do_not_keep_other_problems_back() {
        let body = json!({
            "preset": "paper-200m",
            "set": {"mud.flow_index": -1},
            "axes": {"flow_rate": {"from": 0.01, "to": 0.06, "count": 1}, "mud_density": {"values": []}}
        });
        assert_eq!(
            pointers(body),
            ["/axes/flow_rate/count", "/axes/mud_density/values", "/set/mud.flow_index"]
        );
    }

    #[test]
    fn axes_that_are_no_numeric_fields_are_refused_by_name() {
        let of = |name: &str| problems(json!({"preset": "paper-200m", "axes": {name: {"values": [1]}}}));
        for (name, detail) in [
            ("mud.flowrate", "no such field; did you mean flow_rate? mud has"),
            ("operation.top", "must be"),
            ("mud", "must be"),
            ("string.sections[99].length", "8 entries"),
            ("name", "must be"),
        ] {
            let found = of(name);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].0, format!("/axes/{name}"));
            assert!(found[0].2.contains(detail), "{found:?}");
        }
        let half = problems(json!({"preset": "paper-200m", "axes": {"ensemble": {"values": [8, 7.5]}}}));
        let expected = ("/axes/ensemble/values/1".to_owned(), Some(json!(7.5)));
        assert_eq!(
            half.iter().map(|of| (of.0.clone(), of.1.clone())).collect::<Vec<_>>(),
            [expected],
            "{half:?}"
        );
        let twice = json!({"preset": "paper-200m",
            "axes": {"flow_rate": {"values": [0.01]}, "mud.flow_rate": {"values": [0.02]}}});
        assert_eq!(pointers(twice), ["/axes/mud.flow_rate"]);
    }
}
