//! Changing a scenario by the path of a field.

use serde_json::{Map, Value, json};

use crate::format::from_value;
use crate::nearest::did_you_mean;
use crate::{Problem, Scenario, TimeWindow};

impl Scenario {
    /// The scenario with one field changed. `path` names it with dots and indices: `mud.flow_rate`,
    /// `string.sections[1].count`, `recording.nodes`. An object given for an object changes the fields it
    /// names and leaves the others; `null` removes an optional section (`mud`). A field of a named accuracy may
    /// be set: the accuracy is written out first. A tolerance takes the place of a method, and a method that of a tolerance;
    /// a factor on the mesh `auto` that of target lengths. Snapshots come to be by their rate, `recording.snapshots.rate_hz`,
    /// and an end of a settled orbit window makes it a fixed one, the last third otherwise.
    ///
    /// # Errors
    /// A path that names no field (with the fields there are), or a value of the wrong type.
    pub fn with(&self, path: &str, value: Value) -> Result<Self, Problem> {
        let steps = parse(path)?;
        let mut tree = self.to_value();
        match steps.as_slice() {
            [Step::Field("accuracy"), Step::Field(target)] if TARGETS.contains(target) => {
                tree["accuracy"] = json!({ *target: null });
            }
            [Step::Field("mesh"), Step::Field("auto")] => tree["mesh"] = json!({ "auto": null }),
            [Step::Field("recording"), Step::Field("snapshots"), Step::Field("rate_hz")]
                if self.recording.snapshots.is_none() =>
            {
                tree["recording"]["snapshots"] = json!({ "rate_hz": null });
            }
            [Step::Field("recording"), Step::Field("orbit_window"), Step::Field(_)] if self.settles() => {
                let TimeWindow { from, to } = self.last_third();
                tree["recording"]["orbit_window"] = json!({ "from": from, "to": to });
            }
            [Step::Field("accuracy"), _, ..] => {
                tree["accuracy"] = serde_json::to_value(self.accuracy.time_stepping())
                    .expect("an accuracy has only string keys");
            }
            _ => {}
        }
        put(find(&mut tree, &steps)?, value);
        from_value(tree)
    }
}

/// Fields of an accuracy that take the place of a method and its step.
const TARGETS: [&str; 2] = ["statistics", "trajectory"];

/// One step down the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step<'a> {
    Field(&'a str),
    Index(usize),
}

/// Cuts a path into steps.
pub(super) fn parse(path: &str) -> Result<Vec<Step<'_>>, Problem> {
    let malformed = || Problem::new(path, "", "a path reads like string.sections[1].count");
    let mut steps = Vec::new();
    for part in path.split('.') {
        let (field, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
        if field.is_empty() {
            return Err(malformed());
        }
        steps.push(Step::Field(field));
        let mut rest = indices;
        while !rest.is_empty() {
            let (index, after) =
                rest.strip_prefix('[').and_then(|rest| rest.split_once(']')).ok_or_else(malformed)?;
            steps.push(Step::Index(index.parse().map_err(|_| malformed())?));
            rest = after;
        }
    }
    Ok(steps)
}

/// The place that the steps lead to.
fn find<'a>(tree: &'a mut Value, steps: &[Step<'_>]) -> Result<&'a mut Value, Problem> {
    let mut place = tree;
    let mut path = String::new();
    for &step in steps {
        let so_far = path.clone();
        push(&mut path, step);
        place = match (place, step) {
            (Value::Object(fields), Step::Field(field)) => {
                if !fields.contains_key(field) {
                    return Err(Problem::new(path, "", unknown_field(field, fields, &so_far)));
                }
                &mut fields[field]
            }
            (Value::Array(entries), Step::Index(index)) => {
                let count = entries.len();
                entries.get_mut(index).ok_or_else(|| {
                    Problem::new(path.clone(), "", format!("{so_far} has {count} entries, counted from 0"))
                })?
            }
            (Value::Null, _) => {
                return Err(Problem::new(path, "", format!("{so_far} is absent here: set it as a whole")));
            }
            (Value::Array(_), Step::Field(_)) => {
                return Err(Problem::new(
                    path,
                    "",
                    format!("{so_far} is a list: name an entry as {so_far}[0]"),
                ));
            }
            (_, step) => {
                let what = if matches!(step, Step::Index(_)) { "not a list" } else { "not an object" };
                return Err(Problem::new(path, "", format!("{so_far} is {what}")));
            }
        };
    }
    Ok(place)
}

fn push(path: &mut String, step: Step<'_>) {
    match step {
        Step::Field(field) => {
            if !path.is_empty() {
                path.push('.');
            }
            path.push_str(field);
        }
        Step::Index(index) => path.push_str(&format!("[{index}]")),
    }
}

fn unknown_field(field: &str, fields: &Map<String, Value>, place: &str) -> String {
    let names: Vec<&str> = fields.keys().map(String::as_str).collect();
    let place = if place.is_empty() { "a scenario" } else { place };
    let question = did_you_mean(field, names.iter().copied());
    format!("no such field; {question}{place} has {}", names.join(", "))
}

/// Puts a value in its place. Objects are merged when the place has all the fields named; otherwise (another
/// variant, or a field that does not exist and will be refused) the new one replaces the old.
fn put(place: &mut Value, value: Value) {
    match (place, value) {
        (Value::Object(old), Value::Object(new)) if new.keys().all(|field| old.contains_key(field)) => {
            for (field, value) in new {
                put(&mut old[&field], value);
            }
        }
        (place, value) => *place = value,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::{Accuracy, Integrator, NodeChoice, Switch, preset};

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn a_path_changes_one_field_and_nothing_else() {
        let changed = paper().with("mud.flow_rate", json!(0.02)).unwrap();
        assert_eq!(changed.mud.unwrap().flow_rate, 0.02);
        assert_eq!(changed.with("mud.flow_rate", json!(0.01)).unwrap(), paper());

        let changed = paper().with("string.sections[1].count", json!(8)).unwrap();
        assert_eq!(changed.string.sections[1].count, 8);
        let changed = paper().with("duration", json!(30)).unwrap();
        assert_eq!(changed.duration, 30.0);
        let changed = paper().with("effects.torsion", json!("off")).unwrap();
        assert_eq!(changed.effects.torsion, Switch::Off);
    }

    #[test]
    fn lists_and_optional_parts_are_set_as_a_whole() {
        let changed = paper().with("recording.nodes", json!([{"depth": 30.0}, {"node": 2}])).unwrap();
        assert_eq!(changed.recording.nodes, [NodeChoice::Depth(30.0), NodeChoice::Node(2)]);
        let changed = paper().with("recording.nodes[0]", json!({"depth": 30.0})).unwrap();
        assert_eq!(changed.recording.nodes[0], NodeChoice::Depth(30.0));
        assert_eq!(paper().with("mud", Value::Null).unwrap().mud, None);
        let joint = json!({"length": 0.2, "outer_diameter": 0.16, "inner_diameter": 0.09});
        let changed = paper().with("string.sections[0].tool_joint", joint).unwrap();
        assert_eq!(changed.string.sections[0].tool_joint.unwrap().length, 0.2);
    }

    #[test]
    fn an_object_changes_the_fields_it_names() {
        let changed = paper().with("mud", json!({"flow_rate": 0.03, "density": 1500})).unwrap();
        let mut mud = paper().mud.unwrap();
        (mud.flow_rate, mud.density) = (0.03, 1500.0);
        assert_eq!(changed.mud, Some(mud));
        let problem = paper().with("mud", json!({"flowrate": 0.03})).unwrap_err();
        assert_eq!(problem.path, "mud.flowrate");
    }

    #[test]
    fn a_named_accuracy_is_written_out() {
        let changed = paper().with("accuracy.step", json!(5e-4)).unwrap();
        let Accuracy::Explicit(stepping) = changed.accuracy else { panic!("{:?}", changed.accuracy) };
        assert_eq!((stepping.integrator, stepping.step), (Integrator::Esdirk4, 5e-4));
        assert_eq!(changed.with("accuracy", json!("standard")).unwrap(), paper());
    }

    #[test]
    fn snapshots_are_requested_by_their_rate() {
        let asked = paper().with("recording.snapshots.rate_hz", json!(25)).unwrap();
        assert_eq!(asked, paper().with("recording.snapshots", json!({"rate_hz": 25})).unwrap());
        let window = json!({"from": 1, "to": 2});
        let windowed = asked.with("recording.snapshots.window", window.clone()).unwrap();
        assert_eq!(windowed.snapshot_window(), Some(TimeWindow { from: 1.0, to: 2.0 }));
        assert_eq!(windowed.with("recording.snapshots.rate_hz", json!(25)).unwrap(), windowed);
        assert_eq!(windowed.with("recording.snapshots", Value::Null).unwrap(), paper());
        let problem = paper().with("recording.snapshots.window", window).unwrap_err();
        assert!(problem.message.contains("recording.snapshots is absent"), "{problem}");
    }

    #[test]
    fn unknown_paths_list_the_fields_there_are() {
        let refused = |path: &str| paper().with(path, json!(1)).unwrap_err();
        let problem = refused("mud.flowrate");
        assert_eq!(problem.path, "mud.flowrate");
        assert!(problem.message.contains("mud has") && problem.message.contains("flow_rate"), "{problem}");
        assert!(refused("muds.flow_rate").message.contains("a scenario has"));
        assert!(refused("string.sections[8].count").message.contains("8 entries"));
        assert!(refused("string.sections.count").message.contains("string.sections[0]"));
        assert!(refused("duration.seconds").message.contains("not an object"));
        assert!(refused("duration[0]").message.contains("not a list"));
        for malformed in
            ["", ".", "mud.", "string.sections[", "string.sections[x]", "string.sections[0]x", "[0]"]
        {
            assert!(refused(malformed).message.contains("reads like"), "{malformed}");
        }
        let dry = paper().with("mud", Value::Null).unwrap();
        assert!(dry.with("mud.density", json!(1300)).unwrap_err().message.contains("mud is absent"));
    }

    #[test]
    fn wrong_types_name_the_expected_one() {
        let problem = paper().with("mud.flow_rate", json!("fast")).unwrap_err();
        assert_eq!(problem.path, "mud.flow_rate");
        assert_eq!(
            problem.to_string(),
            "mud.flow_rate: must be a number, or a text of a number with one of the units m3/s, m3/min, m3/h, l/s, l/min, \
             gpm, bbl/min (got \"fast\")"
        );
        let problem = paper().with("mud.regime", json!("turbulent")).unwrap_err();
        assert_eq!(problem.path, "mud.regime");
        assert!(problem.message.contains("`auto` or `laminar`"), "{problem}");
        for (path, value, place, message) in [
            ("damping", json!([0.03, 3e-5]), "damping", "must be an object"),
            ("string.gauges", json!([[123.5, 0.001]]), "string.gauges[0]", "must be an object"),
            ("contact.law", json!({"per_node": null}), "contact.law", "must be the name alone"),
        ] {
            let problem = paper().with(path, value).unwrap_err();
            assert_eq!((problem.path.as_str(), problem.message.as_str()), (place, message));
        }
        assert_eq!(paper().with("well", Value::Null).unwrap_err().path, "well");
    }
}
