//! The reference runs that verify points.

use std::iter::{once, repeat};

use drillsweep_scenario::{Accuracy, AccuracyPreset, Problem, Problems};
use drillsweep_sim::force::effect::active_effects;
use drillsweep_sim::validation::{validate, validate_changes};

use super::expansion::{Expansion, Keys, SweepPoint};
use super::interruption::Interruption;
use super::problems::Found;
use crate::axis::AxisName;
use crate::problem::ProblemDetails;

impl Expansion {
    /// The reference runs that verify the points at these indices: the same scenarios at the accuracy `reference`, under the points'
    /// ordinals. Parameters of the accuracy itself are left out.
    ///
    /// # Errors
    /// Nothing to verify, or a point that the reference cannot run, as problems of the request as a whole; the error of the interruption.
    pub fn references(
        &self,
        indices: &[usize],
        interruption: Interruption<'_>,
    ) -> Result<Expansion, Box<ProblemDetails>> {
        let mut problems = Found::default();
        let references = references(self, indices, "", &mut problems, interruption)?;
        match problems.is_empty() {
            true => Ok(references),
            false => Err(problems.into_refusal()),
        }
    }
}

/// The reference runs of [`Expansion::references`]; problems are noted at this pointer. The first is validated in full, the others if the axes may have made a
/// difference.
pub(super) fn references(
    expansion: &Expansion,
    indices: &[usize],
    pointer: &str,
    problems: &mut Found,
    interruption: Interruption<'_>,
) -> Result<Expansion, Box<ProblemDetails>> {
    let mut base = expansion.base.clone();
    let reference = Accuracy::Preset(AccuracyPreset::Reference);
    if base.accuracy == reference {
        problems.push(
            pointer,
            None,
            "the points have the accuracy `reference` already, to which a verification compares",
        );
    }
    if base.cost_study.is_some() || !active_effects(&base).transient {
        problems.push(
            pointer,
            None,
            "there is no run in time to verify: the request is a cost study or an equilibrium alone",
        );
    }
    base.accuracy = reference;
    let kept: Vec<usize> = (0..expansion.axes.len())
        .filter(|axis| !expansion.axes[*axis].scenario_path().starts_with("accuracy."))
        .collect();
    let axes: Vec<AxisName> = kept.iter().map(|axis| expansion.axes[*axis].clone()).collect();
    let paths: Vec<&str> = axes.iter().map(AxisName::scenario_path).collect();
    let (mut scenario, mut keys) = (base.clone(), Keys::default());
    let mut points = Vec::with_capacity(indices.len());
    for (point, is_first) in
        indices.iter().map(|index| &expansion.points[*index]).zip(once(true).chain(repeat(false)))
    {
        interruption()?;
        let values: Vec<f64> = kept.iter().map(|axis| point.values[*axis]).collect();
        let set = paths.iter().zip(&values).try_for_each(|(path, value)| scenario.set_number(path, *value));
        let checked = set.map_err(Problems::from).and_then(|()| match is_first {
            true => validate(&scenario),
            false => validate_changes(&scenario, paths.iter().copied()),
        });
        match checked {
            Ok(_) => points.push(SweepPoint::new(point.ordinal, values, &mut scenario, &mut keys)),
            // The point itself is valid: it is the reference that the scenario does not allow.
            Err(_) if problems.is_full() => break,
            Err(Problems(of_scenario)) => {
                for Problem { path, message, .. } in of_scenario {
                    problems.push(
                        pointer,
                        None,
                        format!("not valid at the accuracy `reference`: {path}: {message}"),
                    );
                }
            }
        }
    }
    Ok(Expansion { base, axes, points, verification: None, warnings: Vec::new() })
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Scenario, compose};
    use serde_json::{Value, json};

    use super::*;
    use crate::expand::expansion::key;
    use crate::expand::tests::expand;
    use crate::expand::tests::{pointers, problems, request};

    #[test]
    fn a_sample_is_verified_by_the_same_scenarios_at_the_reference() {
        let body = json!({"preset": "paper-200m", "verify": 4, "outputs": "summary", "set": {"accuracy": "draft"}, "axes": {
            "flow_rate": {"from": 0.01, "to": 0.06, "count": 6}, "mud_density": {"from": 1200, "to": 2100, "count": 10}}});
        let expansion = expand(&request(body.clone())).unwrap();
        let references = expansion.verification.as_deref().unwrap();
        assert_eq!(Some(references), expand(&request(body.clone())).unwrap().verification.as_deref());
        let ordinals: Vec<u32> = references.points.iter().map(|point| point.ordinal).collect();
        assert_eq!(ordinals.len(), 4);
        for (k, ordinal) in (0..4).zip(&ordinals) {
            assert!((15 * k + 1..=15 * k + 15).contains(ordinal), "one of each fourth: {ordinals:?}");
        }
        for reference in &references.points {
            let point = &expansion.points[reference.ordinal as usize - 1];
            let wanted = Scenario {
                accuracy: Accuracy::Preset(AccuracyPreset::Reference),
                ..expansion.scenario(point)
            };
            assert_eq!(references.scenario(reference), wanted);
            assert_eq!(
                (reference.key, references.parameters(reference)),
                (key(&wanted), expansion.parameters(point))
            );
            let stored = |of: &Expansion| serde_json::to_string(&of.base).unwrap();
            let changes = serde_json::to_string(&references.changes(reference)).unwrap();
            assert_eq!(compose(&stored(references), &changes).unwrap(), wanted);
        }
        // A request for that very point has the same work.
        let first = &references.points[0];
        let asked = json!({"preset": "paper-200m", "outputs": "summary", "set": {
            "accuracy": "reference", "mud.flow_rate": first.values[0], "mud.density": first.values[1]}});
        let asked = expand(&request(asked)).unwrap();
        assert_eq!((asked.points[0].key, asked.points[0].fuller_key), (first.key, first.fuller_key));
        assert_eq!(asked.verification, None);

        // Axes of the accuracy itself do not reach the reference.
        let steps = json!({"preset": "paper-200m", "verify": 2, "set": {"accuracy": {"integrator": "esdirk4", "step": 1e-3}},
            "axes": {"accuracy.step": {"values": [1e-3, 5e-4]}}});
        let references = expand(&request(steps)).unwrap().verification.unwrap();
        assert_eq!(references.points[0].key, references.points[1].key);
        assert!(references.axes.is_empty());
    }

    #[test]
    fn an_impossible_verification_is_refused_at_its_path() {
        let of = |verify: Value, set: Value| json!({"preset": "paper-200m", "verify": verify, "set": set});
        for verify in [json!(0), json!(-1), json!(1.5), json!(-0.05)] {
            let [(pointer, got, detail)] = problems(of(verify.clone(), json!({}))).try_into().unwrap();
            assert_eq!((pointer.as_str(), got), ("/verify", Some(verify)));
            assert!(detail.contains("a part of the points"), "{detail}");
        }
        for (set, said) in [
            (json!({"accuracy": "reference"}), "accuracy `reference` already"),
            (json!({"effects.transient": "off"}), "no run in time to verify"),
        ] {
            let [(pointer, got, detail)] = problems(of(json!(0.5), set)).try_into().unwrap();
            assert_eq!((pointer.as_str(), got), ("/verify", None));
            assert!(detail.contains(said), "{detail}");
        }
        // With other problems, only those of the request for verification itself.
        assert_eq!(pointers(of(json!(0.5), json!({"duration": -1}))), ["/set/duration"]);
    }
}
