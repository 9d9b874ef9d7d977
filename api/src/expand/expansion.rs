//! Expansion of a request, and keys of its points.

use drillsweep_scenario::{Accuracy, AccuracyPreset, Outputs, Scenario, json_number};
use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::key::CanonicalJson;
use indexmap::IndexMap;
use serde_json::{Map, Value};

use crate::axis::AxisName;
use crate::problem::FieldProblem;

/// Points up to which a dry run looks up results at each named accuracy: each takes as many keys again.
const OTHER_ACCURACIES: usize = 5000;

/// Keys of points, each with that of the same point with everything kept, if it keeps less.
pub type PointKeys = Vec<(PointKey, Option<PointKey>)>;

/// Expansion of a request: one scenario, and the changes of each point to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Expansion {
    /// Preset or scenario with the changes of the request. At the swept fields it has the values of point 1.
    pub base: Scenario,
    /// The swept parameters, in order.
    pub axes: Vec<AxisName>,
    /// The points, by ordinal.
    pub points: Vec<SweepPoint>,
    /// The reference runs that verify some of the points, as [`Expansion::references`] gives them, if the request wants some.
    pub verification: Option<Box<Expansion>>,
    /// Warnings about valid requests that are probably not meant, with JSON Pointers into the request.
    pub warnings: Vec<FieldProblem>,
}

impl Expansion {
    /// The scenario to simulate at a point of this expansion.
    pub fn scenario(&self, point: &SweepPoint) -> Scenario {
        let mut scenario = self.base.clone();
        for (name, &value) in self.axes.iter().zip(&point.values) {
            // Each of these was made once, when the point was validated.
            let _ = scenario.set_number(name.scenario_path(), value);
        }
        scenario
    }

    /// The keys that the points would have at each named accuracy, by its name, each with that of the same point in full if it keeps
    /// less. None of more than 5000 points, and if an axis is of the accuracy itself.
    pub fn keys_by_accuracy(&self) -> Option<IndexMap<&'static str, PointKeys>> {
        let is_of_accuracy = |axis: &AxisName| axis.scenario_path().starts_with("accuracy.");
        if self.points.len() > OTHER_ACCURACIES || self.axes.iter().any(is_of_accuracy) {
            return None;
        }
        let keys_at = |accuracy: AccuracyPreset| {
            let mut written = Keys::default();
            let keys = |point: &SweepPoint| {
                let mut scenario = Scenario { accuracy: Accuracy::Preset(accuracy), ..self.scenario(point) };
                let point = SweepPoint::new(point.ordinal, Vec::new(), &mut scenario, &mut written);
                (point.key, point.fuller_key)
            };
            (accuracy.name(), self.points.iter().map(keys).collect())
        };
        Some(AccuracyPreset::ALL.into_iter().map(keys_at).collect())
    }

    /// Changes of a point to the base, by path: with [`compose`](drillsweep_scenario::compose) the point's scenario again.
    pub fn changes(&self, point: &SweepPoint) -> Map<String, Value> {
        let change =
            |(name, value): (&AxisName, &f64)| (name.scenario_path().to_owned(), json_number(*value));
        self.axes.iter().zip(&point.values).map(change).collect()
    }

    /// The swept parameters of a point in the order of the axes, then the scenario's other parameters with a name.
    pub fn parameters(&self, point: &SweepPoint) -> IndexMap<String, f64> {
        let swept =
            self.axes.iter().zip(&point.values).map(|(name, value)| (name.as_str().to_owned(), *value));
        let is_swept = |path: &str| self.axes.iter().any(|name| name.scenario_path() == path);
        let mud = self.base.mud.as_ref();
        let others =
            AxisName::NAMED.into_iter().filter(|(_, path)| !is_swept(path)).filter_map(|(name, _)| {
                let value = if name == "flow_rate" { mud?.flow_rate } else { mud?.density };
                Some((name.to_owned(), value))
            });
        swept.chain(others).collect()
    }
}

/// One point to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPoint {
    /// Number of the point in its sweep, from 1.
    pub ordinal: u32,
    /// The values of the swept parameters, in the order of the axes.
    pub values: Vec<f64>,
    /// Content hash of physics version and scenario: equal keys, equal results.
    pub key: PointKey,
    /// The key of the same point with everything kept, if this one keeps less: its result will do.
    pub fuller_key: Option<PointKey>,
}

impl SweepPoint {
    /// The point of this scenario, which is left as it was.
    pub(super) fn new(ordinal: u32, values: Vec<f64>, scenario: &mut Scenario, keys: &mut Keys) -> Self {
        let key_of_point = keys.of(scenario);
        let fuller_key = (scenario.recording.outputs != Outputs::Full).then(|| {
            let outputs = std::mem::take(&mut scenario.recording.outputs);
            let fuller = keys.of(scenario);
            scenario.recording.outputs = outputs;
            fuller
        });
        SweepPoint { ordinal, values, key: key_of_point, fuller_key }
    }
}

/// The content hash of a point.
pub type PointKey = [u8; 32];

/// A point's key as it is written on the wire, in hexadecimal.
pub fn key_text(key: &PointKey) -> String {
    blake3::Hash::from_bytes(*key).to_hex().to_string()
}

/// The content hash of a scenario: BLAKE3 over a domain tag, the physics version and the scenario's
/// canonical JSON.
pub fn key(scenario: &Scenario) -> PointKey {
    Keys::default().of(scenario)
}

/// Keys of points one after the other.
#[derive(Debug, Default)]
pub(super) struct Keys(CanonicalJson);

impl Keys {
    /// Key of the next point.
    pub(super) fn of(&mut self, scenario: &Scenario) -> PointKey {
        let mut hasher = blake3::Hasher::new();
        hasher.update(b"drillsweep point\0");
        hasher.update(&PHYSICS_VERSION.to_le_bytes());
        hasher.update(self.0.of(scenario).as_bytes());
        hasher.finalize().into()
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{compose, preset};
    use serde_json::json;

    use super::*;
    use crate::expand::tests::expand;
    use crate::expand::tests::{expansion, problems, request};

    #[test]
    fn equal_points_of_different_requests_have_equal_keys() {
        let key_of = |body| key_text(&expand(&request(body)).unwrap().points[0].key);
        let by_preset = key_of(json!({"preset": "paper-200m"}));
        let mut scenario = serde_json::to_value(preset("paper-200m").unwrap()).unwrap();
        scenario["name"] = "another name".into();
        let mud = scenario["mud"].clone();
        let by_scenario = key_of(json!({"scenario": scenario}));
        let by_set = key_of(json!({"preset": "paper-200m", "set": {"mud.flow_rate": mud["flow_rate"]}}));
        let by_axis =
            key_of(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [mud["flow_rate"]]}}}));
        assert_eq!(by_preset, by_scenario);
        assert_eq!(by_preset, by_set);
        assert_eq!(by_preset, by_axis);
        assert_ne!(by_preset, key_of(json!({"preset": "paper-200m", "set": {"mud.flow_rate": 0.02}})));
        assert_eq!(by_preset.len(), 64);
    }

    #[test]
    fn outputs_belong_to_the_point_and_are_checked_at_their_path() {
        let of = |outputs: Value| json!({"preset": "paper-200m", "outputs": outputs});
        let key_of = |body| expand(&request(body)).unwrap().points[0].key;
        let whole = key_of(json!({"preset": "paper-200m"}));
        assert_eq!(key_of(of(json!("full"))), whole);
        assert_ne!(key_of(of(json!("summary"))), whole);
        let fuller = |body| expand(&request(body)).unwrap().points[0].fuller_key;
        assert_eq!(fuller(of(json!("summary"))), Some(whole));
        assert_eq!(fuller(of(json!("full"))), None);
        let by_path = json!({"preset": "paper-200m", "set": {"recording.outputs": "summary"}});
        assert_eq!(key_of(of(json!("summary"))), key_of(by_path));
        let found = problems(of(json!({"orbits": {"nodes": [{"node": 49}, {"node": 48}], "decimation": 0}})));
        let pointers: Vec<_> = found.iter().map(|(pointer, ..)| pointer.as_str()).collect();
        assert_eq!(pointers, ["/outputs/orbits/decimation", "/outputs/orbits/nodes/1/node"]);
    }

    #[test]
    fn points_have_at_each_accuracy_the_keys_of_a_request_at_it() {
        let of = |accuracy: &str, axes: Value| {
            let set = json!({"accuracy": accuracy});
            expansion(json!({"preset": "paper-200m", "set": set, "outputs": "summary", "axes": axes}))
        };
        let axes = json!({"flow_rate": {"values": [0.01, 0.04]}});
        let by_accuracy = of("draft", axes.clone()).keys_by_accuracy().unwrap();
        assert_eq!(by_accuracy.keys().copied().collect::<Vec<_>>(), ["draft", "standard", "reference"]);
        for (accuracy, keys) in by_accuracy {
            let asked_for = of(accuracy, axes.clone());
            let expected: Vec<_> =
                asked_for.points.iter().map(|point| (point.key, point.fuller_key)).collect();
            assert_eq!(keys, expected, "{accuracy}");
        }
        let of_steps =
            expansion(json!({"preset": "paper-200m", "axes": {"accuracy.step": {"values": [1e-3]}}}));
        assert_eq!(of_steps.keys_by_accuracy(), None);
        let many = of("draft", json!({"flow_rate": {"from": 0.01, "to": 0.06, "count": 5001}}));
        assert_eq!(many.keys_by_accuracy(), None);
    }

    #[test]
    fn every_numeric_field_is_an_axis_by_its_path() {
        let set = json!({"contact.law": "per_length"});
        let expansion = expansion(json!({"preset": "paper-200m", "set": set, "axes": {
            "operation.rotation_speed_rpm": {"values": [90, 120]},
            "contact.stiffness_per_length": {"from": 1e7, "to": 2e7, "count": 2},
            "ensemble": {"values": [4]},
            "accuracy.step": {"values": [1e-3, 5e-4]}
        }}));
        assert_eq!(expansion.points.len(), 8);
        for point in &expansion.points {
            let [speed, stiffness, members, step] = point.values[..] else { panic!("{point:?}") };
            let scenario = preset("paper-200m")
                .unwrap()
                .with("operation.rotation_speed_rpm", json!(speed))
                .and_then(|scenario| scenario.with("contact.law", json!("per_length")))
                .and_then(|scenario| scenario.with("contact.stiffness_per_length", json!(stiffness)))
                .and_then(|scenario| scenario.with("ensemble", json!(members as u32)))
                .and_then(|scenario| scenario.with("accuracy.step", json!(step)))
                .unwrap();
            assert_eq!(expansion.scenario(point), scenario);
            assert_eq!(point.key, key(&scenario));
            // The stored form of the point gives the point.
            let changes = Value::Object(expansion.changes(point)).to_string();
            assert_eq!(compose(&expansion.base.to_json(), &changes).unwrap(), scenario);
        }
        let parameters = expansion.parameters(&expansion.points[7]);
        let names: Vec<&str> = parameters.keys().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "operation.rotation_speed_rpm",
                "contact.stiffness_per_length",
                "ensemble",
                "accuracy.step",
                "flow_rate",
                "mud_density"
            ]
        );
    }
}
