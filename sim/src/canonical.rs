//! The bytes that stand for a scenario.

use drillsweep_scenario::{
    ActiveEffects, ContactLaw, CostStudy, DrillString, Gauge, Mud, NodeChoice, Operation, OrbitWindow,
    Outputs, RayleighDamping, Recording, Scenario, Section, Snapshots, Statics, TimeStepping, TimeWindow,
    ToolJoint, UnbalanceMass, Well, WindowName, WrittenOutMesh,
};
use serde::Serialize;

use crate::effect::active_effects;

/// Inputs that decide the numbers of a run: a scenario without its name, its accuracy written out, its effects decided.
#[derive(Serialize)]
struct Canonical {
    well: Well,
    string: CanonicalString,
    mud: Option<Mud>,
    operation: Operation,
    contact: ContactLaw,
    damping: RayleighDamping,
    mesh: WrittenOutMesh,
    duration: f64,
    recording: CanonicalRecording,
    accuracy: TimeStepping,
    /// Of orbit size and of the radius' deviation: a settled window ends by it, and results report it.
    promised: Option<[f64; 2]>,
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

/// Recording without its snapshots, which have a place of their own. An absent window is the settled one.
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
        let orbit_window = match orbit_window {
            Some(OrbitWindow::Fixed(window)) => Some(window),
            Some(OrbitWindow::Named(WindowName::Settled)) | None => None,
        };
        (Self { rate_hz, nodes, spectrum_windows, orbit_window, stability, outputs }, snapshots)
    }
}

/// The bytes that a result's cache key hashes: two scenarios have the same bytes exactly when they ask for the same numbers, however they
/// are written. They are the postcard encoding (little-endian IEEE doubles, fields in their order, no names) of the scenario without its
/// `name`, with a named accuracy written out as integrator, step and promise, with the material of every section and tool joint, with what a length
/// of wall has by default, with windows that follow the duration and none in place of a settled one, with the factor on the mesh `auto` that the accuracy chooses, with every effect decided, and
/// with -0.0 written as 0.0.
///
/// Snapshots, which most scenarios do not ask for, stand behind all else where there are some, and leave no trace where there are none; so
/// does the start of the run behind them if it is not the default one (their lengths differ, so that none is taken for the other). Any
/// other change of the scenario's fields changes the encoding, so keys of different versions of the program must not be compared.
pub fn canonical_bytes(scenario: &Scenario) -> Vec<u8> {
    let active = active_effects(scenario);
    let mesh = scenario.written_out_mesh();
    // Taken apart in full, so that a new field cannot be forgotten.
    let Scenario {
        name: _,
        well,
        string,
        mud,
        operation,
        contact,
        statics,
        damping,
        mesh: _,
        duration,
        recording,
        accuracy,
        effects: _,
        ensemble,
        cost_study,
    } = with_windows_written_out(without_negative_zeros(scenario));
    let (recording, snapshots) = CanonicalRecording::new(recording);
    let canonical = Canonical {
        well,
        string: CanonicalString::new(string),
        mud,
        operation,
        contact: contact.written_out(),
        damping,
        mesh,
        duration,
        recording,
        accuracy: accuracy.time_stepping(),
        promised: accuracy.promise().map(|promise| [promise.orbit_size, promise.radius_deviation]),
        effects: active,
        ensemble,
        cost_study,
    };
    let encoded = postcard::to_stdvec(&canonical);
    let encoded = match snapshots {
        Some(snapshots) => encoded.and_then(|encoded| postcard::to_extend(&snapshots, encoded)),
        None => encoded,
    };
    let encoded = match statics {
        statics if statics == Statics::default() => encoded,
        statics => encoded.and_then(|encoded| postcard::to_extend(&statics, encoded)),
    };
    encoded.expect("postcard encodes structs, sequences and numbers of known length")
}

fn with_windows_written_out(mut scenario: Scenario) -> Scenario {
    scenario.recording.spectrum_windows = scenario.spectrum_windows();
    scenario.recording.orbit_window = scenario.orbit_window().map(OrbitWindow::Fixed);
    let window = scenario.snapshot_window();
    if let Some(snapshots) = &mut scenario.recording.snapshots {
        snapshots.window = window;
    }
    scenario
}

fn without_negative_zeros(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.each_number(&mut |number| {
        // Equal to 0.0 are 0.0 and -0.0.
        if *number == 0.0 {
            *number = 0.0;
        }
    });
    scenario
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Accuracy, AccuracyPreset, AccuracyTarget, Effect, Material, Switch, preset};
    use serde_json::{Value, json};

    use super::*;

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn the_mesh_auto_is_the_factor_of_its_accuracy() {
        for accuracy in AccuracyPreset::ALL {
            let scenario = Scenario { accuracy: Accuracy::Preset(accuracy), ..paper() };
            let with = |path: &str, value: Value| canonical_bytes(&scenario.with(path, value).unwrap());
            let factor = scenario.accuracy.mesh_factor();
            assert_eq!(with("mesh", json!("auto")), with("mesh.auto", json!(factor)));
            assert_ne!(with("mesh", json!("auto")), canonical_bytes(&scenario));
        }
    }

    #[test]
    fn ways_of_writing_do_not_count() {
        let bytes = canonical_bytes(&paper());
        let mut other = paper();
        other.name = "something else".into();
        assert_eq!(canonical_bytes(&other), bytes);
        other.accuracy = Accuracy::Target(AccuracyTarget::Statistics(0.02));
        assert_eq!(canonical_bytes(&other), bytes);
        let mut following = paper();
        following.recording.orbit_window = None;
        assert_eq!(canonical_bytes(&following), bytes, "the preset's orbit window is the last third");
        other.damping.stiffness_proportional = -0.0;
        other.well.survey[0].azimuth_deg = -0.0;
        other.string.unbalance[3].phase_deg = -0.0;
        assert_eq!(canonical_bytes(&other), bytes);
        assert_eq!(canonical_bytes(&Scenario::from_json(&paper().to_json()).unwrap()), bytes);
        let by_length = paper().with("contact.law", Value::from("per_length")).unwrap();
        let written = by_length
            .with("contact.stiffness_per_length", Value::from(2e7))
            .and_then(|scenario| scenario.with("contact.damping_per_length", Value::from(2e4)));
        assert_eq!(canonical_bytes(&written.unwrap()), canonical_bytes(&by_length));
        assert_ne!(canonical_bytes(&by_length), bytes);
    }

    #[test]
    fn equal_steps_with_another_promise_are_another_result() {
        let with = |accuracy| canonical_bytes(&Scenario { accuracy, ..paper() });
        let standard = Accuracy::Preset(AccuracyPreset::Standard);
        let stepping = standard.time_stepping();
        let others = [Accuracy::Target(AccuracyTarget::Trajectory(0.04)), Accuracy::Explicit(stepping)];
        for other in others {
            assert_eq!(other.time_stepping(), stepping);
            assert_ne!(with(other), with(standard), "{other:?}");
        }
    }

    #[test]
    fn a_settled_window_is_none_and_differs_from_every_fixed_one() {
        let with = |window: Value| canonical_bytes(&paper().with("recording.orbit_window", window).unwrap());
        let settled = with(json!("settled"));
        assert_ne!(settled, canonical_bytes(&paper()));
        let mut spectra = paper().with("recording.orbit_window", json!("settled")).unwrap();
        spectra.recording.spectrum_windows = None;
        assert_ne!(
            canonical_bytes(&spectra),
            settled,
            "spectra over the settled window are not those of fixed ones"
        );
    }

    #[test]
    fn a_material_counts_where_it_is_used_however_it_is_given() {
        let bytes = canonical_bytes(&paper());
        let mut other = paper();
        let steel = other.string.material;
        for section in &mut other.string.sections {
            section.material = Some(steel);
        }
        // Tool joints follow their section, and nothing is left of the string's own.
        other.string.material.density = 1.0;
        assert_eq!(canonical_bytes(&other), bytes);
        let joint = other.string.sections[1].tool_joint.as_mut().unwrap();
        joint.material = Some(Material { density: 2800.0, ..steel });
        assert_ne!(canonical_bytes(&other), bytes);
    }

    #[test]
    fn snapshots_count_where_they_are_asked_for_and_leave_other_keys_as_they_were() {
        let bytes = canonical_bytes(&paper());
        let of = |snapshots: Value| canonical_bytes(&paper().with("recording.snapshots", snapshots).unwrap());
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
    fn start_counts_unless_it_is_the_default_one_and_leaves_other_keys_as_they_were() {
        let bytes = canonical_bytes(&paper());
        let of = |scenario: &Scenario, statics: Value| {
            canonical_bytes(&scenario.with("statics", statics).expect("a valid section"))
        };
        assert_eq!(of(&paper(), json!({ "friction": "break_away", "start": "one" })), bytes);
        let starts = [
            json!({ "friction": "sliding" }),
            json!({ "start": "both" }),
            json!({ "friction": "sliding", "start": "both" }),
        ];
        let with_snapshots = paper().with("recording.snapshots", json!({ "rate_hz": 25.0 })).unwrap();
        let mut seen = vec![bytes.clone(), canonical_bytes(&with_snapshots)];
        for scenario in [paper(), with_snapshots] {
            for start in &starts {
                let encoded = of(&scenario, start.clone());
                assert!(encoded.starts_with(&bytes) && !seen.contains(&encoded), "{start}");
                seen.push(encoded);
            }
        }
    }

    #[test]
    fn every_number_and_every_switch_counts() {
        let scenario = paper().with("accuracy.tolerance", Value::from(0.01)).unwrap();
        let mut seen = vec![canonical_bytes(&scenario)];
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
            let bytes = canonical_bytes(&changed);
            assert!(!seen.contains(&bytes), "{pointer} does not count");
            seen.push(bytes);
        }
        for &effect in Effect::ALL {
            let mut changed = scenario.clone();
            changed.effects.set(effect, Switch::Off);
            assert!(!seen.contains(&canonical_bytes(&changed)), "{} does not count", effect.name());
        }
        for accuracy in [AccuracyPreset::Draft, AccuracyPreset::Reference] {
            let changed = Scenario { accuracy: Accuracy::Preset(accuracy), ..scenario.clone() };
            assert!(!seen.contains(&canonical_bytes(&changed)));
        }
        assert_ne!(canonical_bytes(&paper().with("mud", Value::Null).unwrap()), seen[0]);
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
        let bytes = canonical_bytes(&scenario);
        assert_eq!(canonical_bytes(&scenario), bytes);
        scenario.duration = f64::INFINITY;
        assert_ne!(canonical_bytes(&scenario), bytes);
    }
}
