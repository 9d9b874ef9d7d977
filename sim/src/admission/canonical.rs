//! The bytes that stand for a scenario.

use serde::Serialize;

use crate::scenario::{
    ActiveEffects, ContactLaw, CostStudy, DrillString, ElementLengths, Gauge, Mesh, MeshName, Mud,
    NodeChoice, Operation, Outputs, RayleighDamping, Recording, ScaledMesh, Scenario, Section, Snapshots,
    TimeStepping, TimeWindow, ToolJoint, UnbalanceMass, Well,
};

/// What decides the numbers of a run: a scenario without its name, its accuracy written out, its effects decided.
#[derive(Serialize)]
struct Canonical {
    well: Well,
    string: CanonicalString,
    mud: Option<Mud>,
    operation: Operation,
    contact: ContactLaw,
    damping: RayleighDamping,
    mesh: CanonicalMesh,
    duration: f64,
    recording: CanonicalRecording,
    accuracy: TimeStepping,
    effects: ActiveEffects,
    ensemble: u32,
    cost_study: Option<CostStudy>,
}

/// A string of which every section and tool joint has its material written out.
#[derive(Serialize)]
struct CanonicalString {
    sections: Vec<Section>,
    gauges: Vec<Gauge>,
    unbalance: Vec<UnbalanceMass>,
}

impl CanonicalString {
    fn new(string: DrillString) -> Self {
        let written_out = |section: &Section| Section {
            material: Some(string.body_material(section)),
            tool_joint: section
                .tool_joint
                .map(|joint| ToolJoint { material: Some(string.joint_material(section, &joint)), ..joint }),
            ..*section
        };
        let sections = string.sections.iter().map(written_out).collect();
        let DrillString { material: _, sections: _, gauges, unbalance } = string;
        Self { sections, gauges, unbalance }
    }
}

/// What is kept of a run but for its snapshots, which have a place of their own.
#[derive(Serialize)]
struct CanonicalRecording {
    rate_hz: f64,
    nodes: Vec<NodeChoice>,
    spectrum_windows: Option<Vec<TimeWindow>>,
    orbit_window: Option<TimeWindow>,
    stability: bool,
    outputs: Outputs,
}

impl CanonicalRecording {
    fn new(recording: Recording) -> (Self, Option<Snapshots>) {
        let Recording { rate_hz, nodes, spectrum_windows, orbit_window, stability, outputs, snapshots } =
            recording;
        (Self { rate_hz, nodes, spectrum_windows, orbit_window, stability, outputs }, snapshots)
    }
}

/// A mesh whose encoding distinguishes its forms.
#[derive(Serialize)]
enum CanonicalMesh {
    /// By what the lengths of `auto` are multiplied.
    Auto(f64),
    Lengths(ElementLengths),
}

impl Scenario {
    /// The bytes that a result's cache key hashes: two scenarios have the same bytes exactly when they ask for
    /// the same numbers, however they are written. They are the postcard encoding (little-endian IEEE doubles,
    /// fields in their order, no names) of the scenario without its `name`, with a named accuracy written out
    /// as integrator and step, with the material of every section and tool joint, with what a length of wall has by default, with windows that follow the duration, with the mesh `auto` as a factor of one, with every
    /// effect decided, and with -0.0 written as 0.0. Snapshots, which most scenarios do not ask for, stand behind all
    /// else where there are some, and leave no trace where there are none. Any other change of the scenario's fields changes
    /// the encoding, so keys of different versions of the program must not be compared.
    pub fn canonical_bytes(&self) -> Vec<u8> {
        let active = self.active_effects();
        // Taken apart in full, so that a new field cannot be forgotten.
        let Scenario {
            name: _,
            well,
            string,
            mud,
            operation,
            contact,
            damping,
            mesh,
            duration,
            recording,
            accuracy,
            effects: _,
            ensemble,
            cost_study,
        } = self.without_negative_zeros().with_windows_written_out();
        let (recording, snapshots) = CanonicalRecording::new(recording);
        let canonical = Canonical {
            well,
            string: CanonicalString::new(string),
            mud,
            operation,
            contact: contact.written_out(),
            damping,
            mesh: match mesh {
                Mesh::Named(MeshName::Auto) => CanonicalMesh::Auto(1.0),
                Mesh::Scaled(ScaledMesh { auto }) => CanonicalMesh::Auto(auto),
                Mesh::Lengths(lengths) => CanonicalMesh::Lengths(lengths),
            },
            duration,
            recording,
            accuracy: accuracy.time_stepping(),
            effects: active,
            ensemble,
            cost_study,
        };
        let encoded = postcard::to_stdvec(&canonical);
        let encoded = match snapshots {
            Some(snapshots) => encoded.and_then(|encoded| postcard::to_extend(&snapshots, encoded)),
            None => encoded,
        };
        encoded.expect("postcard encodes structs, sequences and numbers of known length")
    }

    fn with_windows_written_out(mut self) -> Self {
        self.recording.spectrum_windows = Some(self.spectrum_windows());
        self.recording.orbit_window = Some(self.orbit_window());
        let window = self.snapshot_window();
        if let Some(snapshots) = &mut self.recording.snapshots {
            snapshots.window = window;
        }
        self
    }

    fn without_negative_zeros(&self) -> Self {
        let mut scenario = self.clone();
        scenario.each_number(&mut |number| {
            // Equal to 0.0 are 0.0 and -0.0.
            if *number == 0.0 {
                *number = 0.0;
            }
        });
        scenario
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::scenario::{Accuracy, AccuracyPreset, Effect, Material, Switch, preset};

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn ways_of_writing_do_not_count() {
        let bytes = paper().canonical_bytes();
        let mut other = paper();
        other.name = "something else".into();
        assert_eq!(other.canonical_bytes(), bytes);
        other.accuracy = Accuracy::Explicit(paper().accuracy.time_stepping());
        assert_eq!(other.canonical_bytes(), bytes);
        let mut following = paper();
        following.recording.orbit_window = None;
        assert_eq!(following.canonical_bytes(), bytes, "the preset's orbit window is the last third");
        other.damping.stiffness_proportional = -0.0;
        other.well.survey[0].azimuth_deg = -0.0;
        other.string.unbalance[3].phase_deg = -0.0;
        assert_eq!(other.canonical_bytes(), bytes);
        assert_eq!(Scenario::from_json(&paper().to_json()).unwrap().canonical_bytes(), bytes);
        let by_length = paper().with("contact.law", Value::from("per_length")).unwrap();
        let written = by_length
            .with("contact.stiffness_per_length", Value::from(2e7))
            .and_then(|scenario| scenario.with("contact.damping_per_length", Value::from(2e4)));
        assert_eq!(written.unwrap().canonical_bytes(), by_length.canonical_bytes());
        assert_ne!(by_length.canonical_bytes(), bytes);
    }

    #[test]
    fn a_material_counts_where_it_is_used_however_it_is_given() {
        let bytes = paper().canonical_bytes();
        let mut other = paper();
        let steel = other.string.material;
        for section in &mut other.string.sections {
            section.material = Some(steel);
        }
        // Tool joints follow their section, and nothing is left of the string's own.
        other.string.material.density = 1.0;
        assert_eq!(other.canonical_bytes(), bytes);
        let joint = other.string.sections[1].tool_joint.as_mut().unwrap();
        joint.material = Some(Material { density: 2800.0, ..steel });
        assert_ne!(other.canonical_bytes(), bytes);
    }

    #[test]
    fn snapshots_count_where_they_are_asked_for_and_leave_other_keys_as_they_were() {
        let bytes = paper().canonical_bytes();
        let of = |snapshots: Value| paper().with("recording.snapshots", snapshots).unwrap().canonical_bytes();
        assert_eq!(of(Value::Null), bytes);
        let asked = of(json!({ "rate_hz": 25.0 }));
        assert!(asked.starts_with(&bytes) && asked.len() > bytes.len());
        assert_eq!(of(json!({ "rate_hz": 25.0, "window": { "from": 0.0, "to": 60.0 } })), asked);
        let others = [
            json!({ "rate_hz": 50.0 }),
            json!({ "rate_hz": 25.0, "window": { "from": 1.0, "to": 60.0 } }),
            json!({ "rate_hz": 25.0, "window": { "from": 0.0, "to": 59.0 } }),
        ];
        for other in others {
            assert_ne!(of(other.clone()), asked, "{other}");
        }
    }

    #[test]
    fn every_number_and_every_switch_counts() {
        let scenario = paper().with("accuracy.tolerance", Value::from(0.01)).unwrap();
        let mut seen = vec![scenario.canonical_bytes()];
        let tree = serde_json::to_value(&scenario).unwrap();
        let mut numbers = Vec::new();
        collect(&tree, String::new(), &mut numbers);
        assert!(numbers.len() > 120, "the walk found only {} numbers", numbers.len());
        for (pointer, number) in numbers {
            let mut changed = tree.clone();
            *changed.pointer_mut(&pointer).unwrap() = match number.as_u64() {
                Some(whole) => Value::from(whole + 1),
                // The next double: even the last bit counts.
                None => Value::from(number.as_f64().unwrap().next_up()),
            };
            let changed: Scenario = serde_json::from_value(changed).unwrap();
            let bytes = changed.canonical_bytes();
            assert!(!seen.contains(&bytes), "{pointer} does not count");
            seen.push(bytes);
        }
        for &effect in Effect::ALL {
            let mut changed = scenario.clone();
            changed.effects.set(effect, Switch::Off);
            assert!(!seen.contains(&changed.canonical_bytes()), "{} does not count", effect.name());
        }
        for accuracy in [AccuracyPreset::Draft, AccuracyPreset::Reference] {
            let changed = Scenario { accuracy: Accuracy::Preset(accuracy), ..scenario.clone() };
            assert!(!seen.contains(&changed.canonical_bytes()));
        }
        assert_ne!(paper().with("mud", Value::Null).unwrap().canonical_bytes(), seen[0]);
    }

    fn collect(tree: &Value, pointer: String, numbers: &mut Vec<(String, serde_json::Number)>) {
        match tree {
            Value::Number(number) => numbers.push((pointer, number.clone())),
            Value::Array(entries) => {
                for (i, entry) in entries.iter().enumerate() {
                    collect(entry, format!("{pointer}/{i}"), numbers);
                }
            }
            Value::Object(fields) => {
                for (field, value) in fields {
                    collect(value, format!("{pointer}/{field}"), numbers);
                }
            }
            _ => {}
        }
    }

    #[test]
    fn numbers_that_are_not_finite_have_bytes_too() {
        let mut scenario = paper();
        scenario.duration = f64::NAN;
        let bytes = scenario.canonical_bytes();
        assert_eq!(scenario.canonical_bytes(), bytes);
        scenario.duration = f64::INFINITY;
        assert_ne!(scenario.canonical_bytes(), bytes);
    }
}
