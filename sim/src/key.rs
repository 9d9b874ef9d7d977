//! Canonical JSON of a scenario, from which keys of results are hashed.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use drillsweep_scenario::{ActiveEffects, Effect, OrbitWindow, Scenario, ToolJoint, preset};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use crate::force::effect::active_effects;

/// Canonical JSON (RFC 8785) of the inputs that determine the numbers of a run: two scenarios have the same text exactly if they request the
/// same numbers, however they are written.
///
/// It is the scenario without its `name`, with the accuracy as integrator, step and promise, the material of every section and tool joint,
/// the part of the string that is in the hole with the depths of its gauges and masses, the wall's defaults of a length, windows that follow the duration, the factor on the mesh `auto` that the accuracy chooses, and the names
/// of the active effects in place of the switches. Fields with their default value are left out, so that a new field with a default, or a new
/// effect that old scenarios do not activate, changes no key. Numbers that are not finite, which validation refuses, are `null`.
pub fn canonical_json(scenario: &Scenario) -> String {
    CanonicalJson::default().of(scenario)
}

/// [`canonical_json`] of scenarios one after the other. Sections equal to those of the scenario before are not written again, so that a
/// point of a sweep costs its changes only.
#[derive(Debug, Default)]
pub struct CanonicalJson {
    last: Option<(Decided, [Option<String>; SECTIONS.len()])>,
}

impl CanonicalJson {
    /// Canonical JSON of the next scenario.
    pub fn of(&mut self, scenario: &Scenario) -> String {
        let scenario = &*scenario.in_hole();
        static DEFAULTS: LazyLock<Defaults> = LazyLock::new(|| Defaults::of(&with_every_section()));
        let active = active_effects(scenario);
        match &mut self.last {
            Some((last, texts)) => {
                for (section, text) in SECTIONS.iter().zip(texts) {
                    if !(section.is_same)(last, scenario, &active) {
                        *text = section.text(scenario, &active, &DEFAULTS);
                    }
                }
                last.scenario.clone_from(scenario);
                last.active = active;
            }
            None => {
                let texts = SECTIONS.each_ref().map(|section| section.text(scenario, &active, &DEFAULTS));
                self.last = Some((Decided { scenario: scenario.clone(), active }, texts));
            }
        }
        let texts = self.last.iter().flat_map(|(_, texts)| texts);
        let mut document = String::from("{");
        for (section, text) in SECTIONS.iter().zip(texts) {
            let Some(text) = text else { continue };
            let separator = if document.len() > 1 { ",\"" } else { "\"" };
            document.extend([separator, section.name, "\":", text]);
        }
        document.push('}');
        document
    }
}

/// A scenario with its active effects.
#[derive(Debug)]
struct Decided {
    scenario: Scenario,
    active: ActiveEffects,
}

/// A section of a scenario.
struct Section {
    name: &'static str,
    /// True if all values that the section depends on are the same in two scenarios.
    is_same: fn(&Decided, &Scenario, &ActiveEffects) -> bool,
    /// Its value with all values that follow from the scenario written out.
    value: fn(&Scenario, &ActiveEffects) -> Value,
}

impl Section {
    /// Canonical JSON of the section; none if it has its default.
    fn text(&self, scenario: &Scenario, active: &ActiveEffects, defaults: &Defaults) -> Option<String> {
        let mut value = (self.value)(scenario, active);
        if let Some(defaults) = defaults.fields.get(self.name) {
            if defaults.value.as_ref() == Some(&value) {
                return None;
            }
            defaults.leave_out(&mut value);
        }
        Some(
            serde_json_canonicalizer::to_string(&value)
                .expect("a tree of finite numbers and names is canonical JSON"),
        )
    }
}

/// Section that is the field of the same name.
macro_rules! as_it_is {
    ($field:ident) => {
        Section {
            name: stringify!($field),
            is_same: |a, b, _| a.scenario.$field == b.$field,
            value: |scenario, _| value(&scenario.$field),
        }
    };
}

/// Sections of a scenario in the order of their names, without its name.
const SECTIONS: [Section; 18] = [
    Section {
        name: "accuracy",
        is_same: |a, b, _| a.scenario.accuracy == b.accuracy,
        value: |scenario, _| accuracy(scenario),
    },
    as_it_is!(bit),
    Section {
        name: "contact",
        is_same: |a, b, _| a.scenario.contact == b.contact,
        value: |scenario, _| value(&scenario.contact.written_out()),
    },
    as_it_is!(cost_study),
    as_it_is!(damping),
    as_it_is!(duration),
    Section {
        name: "effects",
        is_same: |a, _, active| a.active == *active,
        value: |_, active| effects(active),
    },
    as_it_is!(ensemble),
    as_it_is!(excitation),
    as_it_is!(hydraulics),
    Section {
        name: "mesh",
        is_same: |a, b, _| (a.scenario.mesh, a.scenario.accuracy) == (b.mesh, b.accuracy),
        value: |scenario, _| value(&scenario.written_out_mesh()),
    },
    as_it_is!(mud),
    as_it_is!(operation),
    Section {
        name: "recording",
        is_same: |a, b, _| a.scenario.duration == b.duration && a.scenario.recording == b.recording,
        value: |scenario, _| recording(scenario),
    },
    as_it_is!(statics),
    Section {
        name: "string",
        is_same: |a, b, _| a.scenario.string == b.string,
        value: |scenario, _| string(scenario),
    },
    as_it_is!(top_drive),
    Section {
        name: "well",
        is_same: |a, b, _| a.scenario.well == b.well,
        value: |scenario, _| well(scenario),
    },
];

fn accuracy(scenario: &Scenario) -> Value {
    let mut accuracy = fields(&scenario.accuracy.time_stepping());
    if let Some(promise) = scenario.accuracy.promise() {
        // A settled window ends by it, and results report it.
        accuracy.insert("promise".to_owned(), json!([promise.orbit_size, promise.radius_deviation]));
    }
    Value::Object(accuracy)
}

fn effects(active: &ActiveEffects) -> Value {
    let effects = Effect::ALL.iter().filter(|&&effect| active.is_active(effect));
    let mut effects: Vec<&str> = effects.map(|effect| effect.name()).collect();
    effects.sort_unstable();
    json!(effects)
}

/// Recording with windows that follow the duration.
fn recording(scenario: &Scenario) -> Value {
    let mut recording = scenario.recording.clone();
    recording.spectrum_windows = scenario.spectrum_windows();
    if let Some(window) = scenario.orbit_window() {
        recording.orbit_window = Some(OrbitWindow::Fixed(window));
    }
    let snapshot_window = scenario.snapshot_window();
    if let Some(snapshots) = &mut recording.snapshots {
        snapshots.window = snapshot_window;
    }
    value(&recording)
}

/// Well without the names of its sections.
fn well(scenario: &Scenario) -> Value {
    let mut well = scenario.well.clone();
    well.section.iter_mut().for_each(|section| section.name.clear());
    value(&well)
}

/// String without names, with a material and its grade in every section and tool joint in place of its own.
fn string(scenario: &Scenario) -> Value {
    let mut string = scenario.string.clone();
    for section in &mut string.sections {
        section.tool_joint = section.tool_joint.map(|joint| ToolJoint {
            material: Some(scenario.string.joint_material(section, &joint)),
            ..joint
        });
        section.material = Some(scenario.string.body_material(section));
        section.grade = None;
        section.name.clear();
    }
    let mut string = fields(&string);
    string.remove("material");
    Value::Object(string)
}

/// Default values of absent parts of a document.
#[derive(Debug, Default)]
struct Defaults {
    /// Value of the part itself if it is absent; `None` if it is required.
    value: Option<Value>,
    /// Defaults of its fields.
    fields: BTreeMap<String, Defaults>,
    /// Defaults of the elements of a list.
    element: Option<Box<Defaults>>,
}

impl Defaults {
    /// Defaults of the parts that a document has.
    fn of<T: Serialize + DeserializeOwned>(document: &T) -> Self {
        let document = value(document);
        Self::below(&document, "", &|pointer| {
            let (parent, field) = pointer.rsplit_once('/')?;
            let mut without = document.clone();
            without.pointer_mut(parent)?.as_object_mut()?.remove(field);
            let read: T = serde_json::from_value(without).ok()?;
            value(&read).pointer(pointer).cloned()
        })
    }

    fn below(part: &Value, pointer: &str, default: &impl Fn(&str) -> Option<Value>) -> Self {
        let at = |step: &str, part| Self::below(part, &format!("{pointer}/{step}"), default);
        let mut defaults = Self { value: default(pointer), ..Self::default() };
        match part {
            Value::Object(fields) => {
                defaults.fields =
                    fields.iter().map(|(name, field)| (name.clone(), at(name, field))).collect();
            }
            Value::Array(elements) => {
                defaults.element = elements.first().map(|element| Box::new(at("0", element)));
            }
            _ => {}
        }
        defaults
    }

    fn leave_out_of_fields(&self, fields: &mut Map<String, Value>) {
        fields.retain(|name, value| {
            let Some(defaults) = self.fields.get(name) else { return true };
            if defaults.value.as_ref() == Some(value) {
                return false;
            }
            defaults.leave_out(value);
            true
        });
    }

    fn leave_out(&self, value: &mut Value) {
        match (value, &self.element) {
            (Value::Object(fields), _) => self.leave_out_of_fields(fields),
            (Value::Array(elements), Some(defaults)) => {
                elements.iter_mut().for_each(|element| defaults.leave_out(element));
            }
            _ => {}
        }
    }
}

/// A scenario in which every optional section is present and every list has an element.
fn with_every_section() -> Scenario {
    let window = json!({ "from": 0.0, "to": 1.0 });
    let method = json!({ "integrator": "esdirk4", "step": 1e-3 });
    let study = json!({
        "reference": { "methods": [method, method] },
        "methods": [{ "integrator": "esdirk4", "steps": [1e-3] }],
        "mesh_factors": [0.5],
    });
    let changes = [
        ("recording.spectrum_windows", json!([window])),
        ("recording.orbit_window", window.clone()),
        ("recording.outputs", json!({ "orbits": { "nodes": [{ "node": 49 }], "window": window } })),
        ("recording.snapshots", json!({ "rate_hz": 25.0, "window": window })),
        ("accuracy", method.clone()),
        ("cost_study", study),
        ("well.section", json!([{ "from": 100.0 }])),
        ("hydraulics.nozzles", json!([0.01])),
        (
            "excitation",
            json!([{ "above_bit": 0.0, "direction": "axial", "force": 1.0, "frequency_hz": 1.0 }]),
        ),
    ];
    let mut scenario = preset("paper-200m").expect("the preset of the paper is part of the program");
    for (path, value) in changes {
        scenario = scenario.with(path, value).expect("a valid field of a scenario");
    }
    let material = scenario.string.material;
    for section in &mut scenario.string.sections {
        section.material = Some(material);
        section.tool_joint = Some(ToolJoint {
            length: 0.3,
            outer_diameter: 0.1,
            inner_diameter: 0.05,
            material: Some(material),
        });
    }
    scenario
}

fn fields(part: &impl Serialize) -> Map<String, Value> {
    match value(part) {
        Value::Object(fields) => fields,
        _ => unreachable!("a struct with named fields is an object"),
    }
}

fn value(part: &impl Serialize) -> Value {
    serde_json::to_value(part).expect("scenarios have only text as names of fields")
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{
        Accuracy, AccuracyPreset, AccuracyTarget, Effect, Material, Mesh, Switch, preset,
    };
    use serde::Deserialize;
    use serde_json::{Value, json};

    use super::*;

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn text_of_the_base_case_stays() {
        // Keys of stored results hash it: a change here means that all of them are computed again.
        let text: Value = serde_json::from_str(&canonical_json(&paper())).unwrap();
        insta::assert_json_snapshot!(text);
    }

    #[test]
    fn hydraulics_with_their_defaults_leave_the_key_and_others_enter_it() {
        let with =
            |path: &str, value: Value| canonical_json(&paper().with(path, value).expect("a valid field"));
        assert_eq!(
            with("hydraulics", json!({ "losses": "eccentric", "nozzles": [] })),
            canonical_json(&paper())
        );
        assert_eq!(with("hydraulics.surface_length", json!(0.0)), canonical_json(&paper()));
        let rp13d = with("hydraulics.losses", json!("rp13d"));
        assert!(rp13d.contains(r#""hydraulics":{"losses":"rp13d"}"#), "{rp13d}");
        let nozzles = with("hydraulics.nozzles", json!([0.0127, 0.0127]));
        assert!(nozzles.contains(r#""hydraulics":{"nozzles":[0.0127,0.0127]}"#), "{nozzles}");
    }

    #[test]
    fn a_hole_section_enters_by_its_numbers_but_its_name() {
        let with = |section: Value| canonical_json(&paper().with("well.section", section).unwrap());
        assert_eq!(with(json!([])), canonical_json(&paper()));
        let plain = with(json!([{ "from": 100.0 }]));
        assert!(plain.contains("\"section\":[{\"from\":100}]"), "{plain}");
        assert_eq!(with(json!([{ "from": 100.0, "name": "casing" }])), plain);
        assert_ne!(with(json!([{ "from": 100.0, "static_friction": 0.3 }])), plain);
    }

    #[test]
    fn the_mesh_auto_is_the_factor_of_its_accuracy() {
        for accuracy in AccuracyPreset::ALL {
            let scenario = Scenario { accuracy: Accuracy::Preset(accuracy), ..paper() };
            let with = |path: &str, value: Value| canonical_json(&scenario.with(path, value).unwrap());
            let factor = scenario.accuracy.mesh_factor();
            assert_eq!(with("mesh", json!("auto")), with("mesh.auto", json!(factor)));
            assert_ne!(with("mesh", json!("auto")), canonical_json(&scenario));
        }
    }

    #[test]
    fn ways_of_writing_do_not_count() {
        let bytes = canonical_json(&paper());
        let mut other = paper();
        other.name = "something else".into();
        assert_eq!(canonical_json(&other), bytes);
        other.accuracy = Accuracy::Target(AccuracyTarget::Statistics(0.02));
        assert_eq!(canonical_json(&other), bytes);
        let mut following = paper();
        following.recording.orbit_window = None;
        assert_eq!(canonical_json(&following), bytes, "the preset's orbit window is the last third");
        other.damping.stiffness_proportional = -0.0;
        other.well.survey[0].azimuth_deg = -0.0;
        other.string.unbalance[3].phase_deg = -0.0;
        assert_eq!(canonical_json(&other), bytes);
        assert_eq!(canonical_json(&Scenario::from_json(&paper().to_json()).unwrap()), bytes);
        let by_length = paper().with("contact.law", Value::from("per_length")).unwrap();
        let written = by_length
            .with("contact.stiffness_per_length", Value::from(2e7))
            .and_then(|scenario| scenario.with("contact.damping_per_length", Value::from(2e4)));
        assert_eq!(canonical_json(&written.unwrap()), canonical_json(&by_length));
        assert_ne!(canonical_json(&by_length), bytes);
    }

    #[test]
    fn equal_steps_with_another_promise_are_another_result() {
        let with = |accuracy| canonical_json(&Scenario { accuracy, ..paper() });
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
        let with = |window: Value| canonical_json(&paper().with("recording.orbit_window", window).unwrap());
        let settled = with(json!("settled"));
        assert_ne!(settled, canonical_json(&paper()));
        let mut spectra = paper().with("recording.orbit_window", json!("settled")).unwrap();
        spectra.recording.spectrum_windows = None;
        assert_ne!(
            canonical_json(&spectra),
            settled,
            "spectra over the settled window are not those of fixed ones"
        );
    }

    #[test]
    fn a_material_enters_the_key_by_its_use_alone() {
        let bytes = canonical_json(&paper());
        let mut other = paper();
        let steel = other.string.material;
        for section in &mut other.string.sections {
            section.material = Some(steel);
        }
        // Tool joints follow their section, and the string's own material is not used.
        other.string.material.density = 1.0;
        assert_eq!(canonical_json(&other), bytes);
        let joint = other.string.sections[1].tool_joint.as_mut().unwrap();
        joint.material = Some(Material { density: 2800.0, ..steel });
        assert_ne!(canonical_json(&other), bytes);
    }

    #[test]
    fn snapshots_change_the_keys_of_their_points_alone() {
        let bytes = canonical_json(&paper());
        let of = |snapshots: Value| canonical_json(&paper().with("recording.snapshots", snapshots).unwrap());
        assert_eq!(of(Value::Null), bytes);
        let asked = of(json!({ "rate_hz": 25.0 }));
        assert_ne!(asked, bytes);
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
        let bytes = canonical_json(&paper());
        let of = |scenario: &Scenario, statics: Value| {
            canonical_json(&scenario.with("statics", statics).expect("a valid section"))
        };
        assert_eq!(of(&paper(), json!({ "friction": "break_away", "start": "one" })), bytes);
        let starts = [
            json!({ "friction": "sliding" }),
            json!({ "start": "both" }),
            json!({ "friction": "sliding", "start": "both" }),
        ];
        let with_snapshots = paper().with("recording.snapshots", json!({ "rate_hz": 25.0 })).unwrap();
        let mut seen = vec![bytes.clone(), canonical_json(&with_snapshots)];
        for scenario in [paper(), with_snapshots] {
            for start in &starts {
                let encoded = of(&scenario, start.clone());
                assert!(!seen.contains(&encoded), "{start}");
                seen.push(encoded);
            }
        }
    }

    #[test]
    fn every_number_and_every_switch_counts() {
        let scenario = paper().with("accuracy.tolerance", Value::from(0.01)).unwrap();
        let mut seen = vec![canonical_json(&scenario)];
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
            let bytes = canonical_json(&changed);
            assert!(!seen.contains(&bytes), "{pointer} does not count");
            seen.push(bytes);
        }
        let active = active_effects(&scenario);
        for &effect in Effect::ALL.iter().filter(|&&effect| active.is_active(effect)) {
            let mut changed = scenario.clone();
            changed.effects.set(effect, Switch::Off);
            assert!(!seen.contains(&canonical_json(&changed)), "{} does not count", effect.name());
        }
        for accuracy in [AccuracyPreset::Draft, AccuracyPreset::Reference] {
            let changed = Scenario { accuracy: Accuracy::Preset(accuracy), ..scenario.clone() };
            assert!(!seen.contains(&canonical_json(&changed)));
        }
        assert_ne!(canonical_json(&paper().with("mud", Value::Null).unwrap()), seen[0]);
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

    /// A later version of the format: a document with more fields than scenarios have.
    #[derive(Serialize, Deserialize)]
    struct Later<D: Default> {
        #[serde(flatten)]
        scenario: Map<String, Value>,
        #[serde(default)]
        drive: D,
        #[serde(default = "stiff")]
        speed_control: String,
    }

    #[derive(Default, PartialEq, Serialize, Deserialize)]
    struct Drive {
        inertia: Option<f64>,
        #[serde(default)]
        limits: Vec<f64>,
    }

    fn stiff() -> String {
        "stiff".to_owned()
    }

    #[test]
    fn a_new_field_changes_no_key_of_a_scenario_without_it() {
        let scenario: Map<String, Value> = SECTIONS
            .iter()
            .map(|section| (section.name.to_owned(), (section.value)(&paper(), &active_effects(&paper()))))
            .collect();
        let canonical = |mut tree: Map<String, Value>, defaults: &Defaults| {
            defaults.leave_out_of_fields(&mut tree);
            serde_json_canonicalizer::to_string(&tree).unwrap()
        };
        let with_drive = json!({ "inertia": 1e3, "limits": [1.0] });
        let mut sample = scenario.clone();
        sample.insert("drive".to_owned(), with_drive.clone());
        let sample: Later<Drive> = serde_json::from_value(Value::Object(sample)).unwrap();
        let mut defaults = Defaults::of(&sample);
        // The new section alone: all others have the defaults of scenarios.
        defaults.fields.extend(Defaults::of(&with_every_section()).fields);
        let later = |more: Value| {
            let mut written = scenario.clone();
            written.append(&mut more.as_object().unwrap().clone());
            canonical(
                fields(&serde_json::from_value::<Later<Drive>>(Value::Object(written)).unwrap()),
                &defaults,
            )
        };
        let before = canonical_json(&paper());
        assert_eq!(later(json!({})), before);
        assert_eq!(later(json!({ "drive": { "limits": [] }, "speed_control": "stiff" })), before);
        let soft = later(json!({ "speed_control": "soft" }));
        let driven = later(json!({ "drive": with_drive }));
        assert!(soft != before && driven != before && soft != driven);
        // Within the new section, too, a default leaves no trace.
        assert_eq!(driven.len() - before.len(), r#""drive":{"inertia":1000,"limits":[1]},"#.len());
    }

    #[test]
    fn an_effect_that_is_not_active_leaves_no_trace() {
        let dry = canonical_json(&paper().with("mud", Value::Null).unwrap());
        for effect in Effect::ALL {
            let is_active = active_effects(&paper()).is_active(*effect);
            let name = format!("\"{}\"", effect.name());
            assert_eq!(canonical_json(&paper()).contains(&name), is_active, "{name}");
            assert!(!(name.contains("fluid") && dry.contains(&name)), "{name}");
        }
    }

    #[test]
    fn sections_are_the_fields_of_a_scenario_in_their_order() {
        let mut fields = fields(&with_every_section());
        fields.remove("name");
        let mut names: Vec<String> = fields.into_iter().map(|(name, _)| name).collect();
        names.sort();
        assert_eq!(SECTIONS.each_ref().map(|section| section.name).as_slice(), names);
    }

    #[test]
    fn a_text_does_not_depend_on_the_scenario_before() {
        let tree = serde_json::to_value(with_every_section()).unwrap();
        let mut numbers = Vec::new();
        collect(&tree, String::new(), &mut numbers);
        let mut writer = CanonicalJson::default();
        for (pointer, number) in numbers {
            let mut changed = tree.clone();
            *changed.pointer_mut(&pointer).unwrap() = match number.as_u64() {
                Some(whole) => Value::from(whole + 1),
                None => Value::from(number.as_f64().unwrap().next_up()),
            };
            let changed: Scenario = serde_json::from_value(changed).unwrap();
            assert_eq!(writer.of(&changed), canonical_json(&changed), "{pointer}");
        }
        for accuracy in AccuracyPreset::ALL {
            let changed = Scenario { accuracy: Accuracy::Preset(accuracy), mesh: Mesh::AUTO, ..paper() };
            assert_eq!(writer.of(&changed), canonical_json(&changed));
        }
        assert_eq!(writer.of(&paper()), canonical_json(&paper()));
    }

    #[test]
    fn every_section_and_every_list_has_its_defaults() {
        fn absent(part: &Value, at: &str, found: &mut Vec<String>) {
            match part {
                Value::Null => found.push(at.to_owned()),
                Value::Array(elements) if elements.is_empty() => found.push(at.to_owned()),
                Value::Array(elements) => absent(&elements[0], at, found),
                Value::Object(fields) => {
                    fields.iter().for_each(|(name, field)| absent(field, &format!("{at}.{name}"), found))
                }
                _ => {}
            }
        }
        let mut found = Vec::new();
        absent(&value(&with_every_section()), "", &mut found);
        // Each is one number, or one word.
        let single = [
            ".accuracy.spectral_radius",
            ".accuracy.tolerance",
            ".bit.aggressiveness",
            ".bit.bit_radius",
            ".contact.damping_per_length",
            ".contact.stiffness_per_length",
            ".cost_study.duration",
            ".cost_study.methods.tolerance",
            ".cost_study.reference.mesh_factor",
            ".cost_study.reference.methods.spectral_radius",
            ".cost_study.reference.methods.tolerance",
            ".cost_study.total",
            ".excitation.above_end",
            ".excitation.band_to_hz",
            ".excitation.measured_depth",
            ".excitation.per_revolution",
            ".excitation.section",
            ".excitation.torque",
            ".hydraulics.nozzle_area",
            ".hydraulics.surface_case",
            ".operation.length_above",
            ".string.bit_depth",
            ".string.gauges.above_bit",
            ".string.gauges.above_end",
            ".string.gauges.section",
            ".string.material.grade",
            ".string.sections.blade_above_end",
            ".string.sections.blade_diameter",
            ".string.sections.grade",
            ".string.sections.make_up_torque",
            ".string.sections.mass_per_length",
            ".string.sections.material.grade",
            ".string.sections.stiffness_inner_diameter",
            ".string.sections.stiffness_outer_diameter",
            ".string.sections.tool_joint.material.grade",
            ".string.unbalance.above_bit",
            ".string.unbalance.above_end",
            ".string.unbalance.section",
            ".top_drive.frequency_hz",
            ".well.section.dynamic_friction",
            ".well.section.hole_diameter",
            ".well.section.static_friction",
        ];
        found.sort();
        assert_eq!(found, single);
    }
}
