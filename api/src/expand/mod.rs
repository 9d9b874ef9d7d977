//! From a request to the points to compute, or to everything that is wrong with it.

mod base;
mod expansion;
mod interruption;
mod layout;
mod members;
mod points;
mod problems;
mod references;

pub use expansion::{Expansion, PointKey, PointKeys, SweepPoint, key, key_text};
pub use interruption::{Interruption, UNINTERRUPTED};
pub use members::check_patch;

use base::{check_without_axes, resolve, set_fields};
use layout::Layout;
use members::check_members;
use points::points;
use problems::{Found, Written};
use references::references;

use crate::problem::ProblemDetails;
use crate::request::SweepRequest;
use crate::verify::sample;

/// The points of a request, every one of them validated.
///
/// In a grid points are ordered like the digits of a counter: the last axis turns fastest, the first slowest.
///
/// # Errors
/// Every distinct problem of the request and of any of its points, once, with JSON Pointers into the request; of very
/// many the first hundred. The error of the interruption.
pub fn expand(
    request: &SweepRequest,
    interruption: Interruption<'_>,
) -> Result<Expansion, Box<ProblemDetails>> {
    let mut problems = Found::default();
    check_members(request, &mut problems);
    let written = Written::new(request);
    let layout = Layout::new(request, &mut problems);
    let mut expansion = None;
    if let Some(mut base) = resolve(request, &written, &mut problems, interruption)? {
        match layout {
            Some(layout) if set_fields(request, &layout, &mut base, &mut problems) => {
                expansion = Some(points(&written, &layout, base, &mut problems, interruption)?);
            }
            _ => check_without_axes(request, &written, &base, &mut problems),
        }
    }
    match expansion {
        Some(mut expansion) if problems.is_empty() => {
            if let Some(verify) = request.verify {
                let total = expansion.points.len();
                let sample = sample(verify, total, 0, total);
                let references = references(&expansion, &sample, "/verify", &mut problems, interruption)?;
                expansion.verification = Some(Box::new(references));
            }
            if problems.is_empty() { Ok(expansion) } else { Err(problems.into_refusal()) }
        }
        _ => Err(problems.into_refusal()),
    }
}

/// The points of `added`, which are to be added to the sweep of `original` (see [`AppendRequest::of`](crate::AppendRequest::of)), as a sweep of their own. Their
/// parameters have the names that they have in that sweep.
///
/// # Errors
/// As [`expand`].
pub fn expand_added(
    added: &SweepRequest,
    original: &SweepRequest,
    interruption: Interruption<'_>,
) -> Result<Expansion, Box<ProblemDetails>> {
    let mut expansion = expand(added, interruption)?;
    for name in &mut expansion.axes {
        if let Some(known) = original.names().find(|known| known.scenario_path() == name.scenario_path()) {
            *name = known.clone();
        }
    }
    Ok(expansion)
}

#[cfg(test)]
pub(crate) mod tests {
    use serde_json::{Value, json};

    use super::{Expansion, ProblemDetails, SweepRequest, UNINTERRUPTED};
    use crate::problem::FieldProblem;

    pub(crate) fn expand(request: &SweepRequest) -> Result<Expansion, Box<ProblemDetails>> {
        super::expand(request, UNINTERRUPTED)
    }

    pub(super) fn request(body: Value) -> SweepRequest {
        serde_json::from_value(body).unwrap()
    }

    /// Problems of a refused request: pointer, value and message.
    pub(super) fn problems(body: Value) -> Vec<(String, Option<Value>, String)> {
        let details = expand(&request(body)).expect_err("the request must be refused");
        assert_eq!(details.status, 422);
        let of = |error: FieldProblem| (error.pointer.unwrap_or_default(), error.got, error.detail);
        details.errors.into_iter().map(of).collect()
    }

    pub(super) fn pointers(body: Value) -> Vec<String> {
        problems(body).into_iter().map(|(pointer, ..)| pointer).collect()
    }

    pub(super) fn expansion(body: Value) -> Expansion {
        expand(&request(body)).unwrap_or_else(|problem| panic!("{problem}"))
    }

    #[test]
    fn a_run_is_a_sweep_of_one_point() {
        let run: crate::RunRequest =
            serde_json::from_value(json!({"preset": "paper-200m", "set": {"duration": 65}})).unwrap();
        let expansion = expand(&run.into()).unwrap();
        assert_eq!(expansion.points.len(), 1);
        assert_eq!(expansion.points[0].ordinal, 1);
        assert_eq!(expansion.scenario(&expansion.points[0]).duration, 65.0);
    }

    #[test]
    fn added_points_have_the_parameter_names_of_their_sweep() {
        let body = |name: &str| {
            let axes = json!({"contact.stiffness": {"values": [1e6]}, name: {"values": [0.03]}});
            request(json!({"preset": "paper-200m", "axes": axes}))
        };
        let added = super::expand_added(&body("mud.flow_rate"), &body("flow_rate"), UNINTERRUPTED).unwrap();
        let names: Vec<&str> = added.axes.iter().map(crate::AxisName::as_str).collect();
        assert_eq!(names, ["contact.stiffness", "flow_rate"]);
        // Parameters that are not swept have one name, too.
        let parameters: Vec<(String, f64)> = added.parameters(&added.points[0]).into_iter().collect();
        let density = added.base.mud.unwrap().density;
        let wanted = [("contact.stiffness", 1e6), ("flow_rate", 0.03), ("mud_density", density)];
        assert_eq!(parameters, wanted.map(|(name, value)| (name.to_owned(), value)));
    }

    fn keys_in_signs(body: Value) -> Vec<super::PointKey> {
        let expansion = expand(&request(body).in_model_signs()).unwrap_or_else(|problem| panic!("{problem}"));
        expansion.points.iter().map(|point| point.key).collect()
    }

    #[test]
    fn requests_of_both_signs_are_the_same_points() {
        let mut scenario = serde_json::to_value(drillsweep_scenario::preset("paper-200m").unwrap()).unwrap();
        let weight = scenario["operation"]["weight_on_bit"].as_f64().unwrap();
        let torque = scenario["operation"]["torque_on_bit"].as_f64().unwrap();
        let model = keys_in_signs(json!({"scenario": scenario}));
        scenario["operation"]["weight_on_bit"] = json!(-weight);
        scenario["operation"]["torque_on_bit"] = json!(-torque);
        assert_eq!(keys_in_signs(json!({"scenario": scenario, "signs": "driller"})), model);
        let weight = "operation.weight_on_bit";
        for (model, driller) in [
            (json!({"set": {weight: -20e3}}), json!({"set": {weight: 20e3}})),
            (json!({"set": {weight: "-20 kN"}}), json!({"set": {weight: "20 kN"}})),
            (
                json!({"set": {"operation": {"weight_on_bit": 0}}}),
                json!({"set": {"operation": {"weight_on_bit": 0}}}),
            ),
            (
                json!({"axes": {weight: {"values": [-1e4, 0]}}}),
                json!({"axes": {weight: {"values": [1e4, 0]}}}),
            ),
            (
                json!({"axes": {weight: {"from": -1e4, "to": -4e4, "count": 3, "scale": "log"}}}),
                json!({"axes": {weight: {"from": 1e4, "to": 4e4, "count": 3, "scale": "log"}}}),
            ),
            (
                json!({"design": "list", "points": [{weight: -1e4, "flow_rate": 0.01}]}),
                json!({"design": "list", "points": [{weight: 1e4, "flow_rate": 0.01}]}),
            ),
        ] {
            let [mut model, mut driller] = [model, driller];
            model["preset"] = json!("paper-200m");
            driller["preset"] = json!("paper-200m");
            driller["signs"] = json!("driller");
            assert_eq!(keys_in_signs(driller.clone()), keys_in_signs(model), "{driller}");
        }
        // The values of a preset are those of the model in any signs.
        let preset = |signs| keys_in_signs(json!({"preset": "paper-200m", "signs": signs}));
        assert_eq!(preset("driller"), preset("model"));
    }

    #[test]
    fn texts_have_a_length_and_no_control_characters() {
        let of =
            |name: &str, owner: &str| pointers(json!({"preset": "paper-200m", "name": name, "owner": owner}));
        assert_eq!(of("", "two\nlines"), ["/name", "/owner"]);
        assert_eq!(of(&"n".repeat(1000), "\u{7}"), ["/name", "/owner"]);
        assert!(
            super::expand(&request(json!({"preset": "paper-200m", "name": "a b"})), UNINTERRUPTED).is_ok()
        );
        let patch = |name: &str| super::check_patch(&serde_json::from_value(json!({"name": name})).unwrap());
        assert!(patch("tab\t").is_err() && patch("a b").is_ok());
    }
}
