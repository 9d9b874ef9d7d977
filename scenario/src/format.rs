//! Scenarios as TOML and JSON.

use serde::de::{DeserializeOwned, Deserializer, IgnoredAny};

use crate::strict::read_strictly;
use crate::{Problem, Scenario};

impl Scenario {
    /// The scenario as a tree. TOML's, because it has all doubles: JSON lacks those that are not finite.
    pub(crate) fn tree(&self) -> toml::Value {
        toml::Value::try_from(self).expect("a scenario has only string keys and no value that TOML lacks")
    }

    /// Reads a scenario from TOML.
    ///
    /// # Errors
    /// The first place at which the text is not TOML, or the first field, by name, that makes it no scenario; unknown fields
    /// are refused.
    pub fn from_toml(text: &str) -> Result<Self, Problem> {
        from_table(table(text)?)
    }

    /// Reads a scenario from JSON.
    ///
    /// # Errors
    /// The first place at which the text is not JSON or, if it is, no scenario; unknown fields are refused.
    pub fn from_json(text: &str) -> Result<Self, Problem> {
        let _: IgnoredAny = serde_json::from_str(text).map_err(|error| not_json(&error))?;
        read(&mut serde_json::Deserializer::from_str(text))
    }

    /// Writes the scenario as TOML.
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).expect("a scenario has only string keys and no value that TOML lacks")
    }

    /// Writes the scenario as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a scenario has only string keys")
    }

    /// The scenario as a JSON document.
    pub(super) fn to_value(&self) -> serde_json::Value {
        serde_json::to_value(self).expect("a scenario has only string keys")
    }
}

/// A TOML document as a tree, or why the text is not TOML at all.
pub(super) fn table(text: &str) -> Result<toml::Table, Problem> {
    toml::from_str(text).map_err(|error: toml::de::Error| Problem::new("", "", error.to_string().trim_end()))
}

/// A type out of a parsed TOML document.
pub(super) fn from_table<T: DeserializeOwned>(table: toml::Table) -> Result<T, Problem> {
    read(toml::Value::Table(table))
}

/// A type out of a parsed JSON document.
pub(super) fn from_value<T: DeserializeOwned>(value: serde_json::Value) -> Result<T, Problem> {
    read(value)
}

/// Problem that serde_json found with a text that is not JSON.
pub(super) fn not_json(error: &serde_json::Error) -> Problem {
    Problem::new("", "", format!("not JSON: {error}"))
}

/// A type out of any format.
fn read<'de, T: DeserializeOwned>(format: impl Deserializer<'de>) -> Result<T, Problem> {
    let mut track = serde_path_to_error::Track::new();
    let tracked = serde_path_to_error::Deserializer::new(format, &mut track);
    read_strictly(tracked).map_err(|error| {
        let message = error.to_string();
        Problem::from_serde(track.path().to_string(), without_place(&message))
    })
}

/// Message without the place that the format adds to it (` at line 3 column 7`, or a second line): the path is enough.
fn without_place(message: &str) -> &str {
    let message = message.lines().next().unwrap_or_default();
    let is_place = |place: &str| {
        place.split_once(" column ").is_some_and(|(line, column)| {
            [line, column].iter().all(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
        })
    };
    match message.rsplit_once(" at line ") {
        Some((message, place)) if is_place(place) => message,
        _ => message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Accuracy, AccuracyPreset, Integrator, TimeStepping, preset};

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn toml_and_json_carry_every_digit() {
        let mut scenario = paper();
        scenario.duration = 0.1 + 0.2;
        scenario.contact.stiffness = 1.0 / 3.0 * 1e-300;
        scenario.accuracy = Accuracy::Explicit(TimeStepping {
            integrator: Integrator::Rk4,
            step: 1e-5,
            contact_sweeps: 2,
            tolerance: Some(1e-4),
            spectral_radius: None,
        });
        assert_eq!(Scenario::from_toml(&scenario.to_toml()).unwrap(), scenario);
        assert_eq!(Scenario::from_json(&scenario.to_json()).unwrap(), scenario);
    }

    #[test]
    fn unknown_fields_are_refused_at_their_path() {
        let text = paper().to_toml().replace("flow_rate", "flowrate");
        let problem = Scenario::from_toml(&text).unwrap_err();
        assert_eq!(problem.path, "mud.flowrate");
        assert!(
            problem.message.contains("there is no field") && problem.message.contains("`flow_rate`"),
            "{problem}"
        );
        let problem = Scenario::from_json(&paper().to_json().replace("flow_rate", "flowrate")).unwrap_err();
        assert_eq!(problem.path, "mud.flowrate");
    }

    #[test]
    fn wrong_types_name_the_expected_one() {
        let json = paper().to_json().replace("\"count\": 9", "\"count\": -9");
        let problem = Scenario::from_json(&json).unwrap_err();
        assert_eq!(problem.path, "string.sections[1].count");
        assert_eq!(problem.got, "-9");
        assert_eq!(problem.message, "must be a whole number, 0 or more");

        let toml = paper().to_toml().replace("youngs_modulus = 203000000000.0", "youngs_modulus = \"steel\"");
        let problem = Scenario::from_toml(&toml).unwrap_err();
        assert_eq!(problem.path, "string.material.youngs_modulus");
        assert_eq!(problem.got, "\"steel\"");
        assert!(
            problem.message.starts_with("must be a number, or a text of a number with one of the units Pa, ")
        );
    }

    /// Writes each number of a quantity as a text with the unit in which it is kept, and counts them.
    fn written_with_units(value: &mut serde_json::Value, path: &str) -> usize {
        use serde_json::Value;
        match value {
            Value::Object(members) => {
                let of = |(name, value): (&String, &mut Value)| {
                    written_with_units(value, &format!("{path}.{name}"))
                };
                members.iter_mut().map(of).sum()
            }
            Value::Array(entries) => entries.iter_mut().map(|entry| written_with_units(entry, path)).sum(),
            Value::Number(number) => {
                let Some(unit) = drillsweep_quantity::unit(path.trim_start_matches('.')) else { return 0 };
                *value = format!("{number} {unit}").into();
                1
            }
            _ => 0,
        }
    }

    #[test]
    fn every_number_with_a_unit_may_be_a_text() {
        for (name, _) in crate::PRESETS {
            let scenario = preset(name).unwrap();
            let mut written = scenario.to_value();
            let count = written_with_units(&mut written, "");
            assert!(count > 25, "{name}: {count}");
            assert_eq!(Scenario::from_json(&written.to_string()).as_ref(), Ok(&scenario), "{name}");
        }
        let field = paper().to_toml().replace("hole_diameter = 0.2159", "hole_diameter = \"8 1/2 in\"");
        assert!(field.contains("8 1/2 in"));
        assert_eq!(Scenario::from_toml(&field), Ok(paper()));
    }

    #[test]
    fn a_unit_of_another_dimension_is_refused_with_those_that_fit() {
        let problem = paper().with("mud.density", "500 gpm".into()).unwrap_err();
        assert_eq!((problem.path.as_str(), problem.got.as_str()), ("mud.density", "\"500 gpm\""));
        assert_eq!(
            problem.message,
            "must be a number with one of the units kg/m3, g/cm3, ppg, lb/ft3; `gpm` is a unit of volume flow rate"
        );
        let changed =
            paper().with("mud", serde_json::json!({"flow_rate": "1893 l/min", "density": "1.2 sg"})).unwrap();
        let mud = changed.mud.unwrap();
        assert_eq!((mud.flow_rate, mud.density), (0.031_55, 1_200.0));
    }

    #[test]
    fn missing_fields_are_named() {
        let problem = Scenario::from_toml(&paper().to_toml().replace("hole_diameter", "#")).unwrap_err();
        assert_eq!(problem.path, "well");
        assert!(problem.message.contains("the field `hole_diameter` is missing"), "{problem}");
    }

    #[test]
    fn accuracy_is_a_name_or_an_object() {
        let with = |accuracy: &str| {
            Scenario::from_toml(&paper().to_toml().replace("accuracy = \"standard\"", accuracy))
        };
        assert_eq!(with("accuracy = \"draft\"").unwrap().accuracy, Accuracy::Preset(AccuracyPreset::Draft));
        let explicit = with("accuracy = { integrator = \"esdirk4\", step = 5e-4 }").unwrap().accuracy;
        assert_eq!(explicit.time_stepping().step, 5e-4);
        assert_eq!(explicit.time_stepping().contact_sweeps, 2);

        let problem = with("accuracy = \"perfect\"").unwrap_err();
        assert_eq!(problem.path, "accuracy");
        assert!(problem.message.contains("`draft`, `standard` or `reference`"), "{problem}");
        let problem = with("accuracy = { integrator = \"esdirk4\", step = \"small\" }").unwrap_err();
        assert_eq!(problem.path, "accuracy.step");
        let problem = with("accuracy = { integrator = \"euler\", step = 1e-3 }").unwrap_err();
        assert_eq!(problem.path, "accuracy.integrator");
        let problem = with("accuracy = 3").unwrap_err();
        assert!(problem.message.starts_with("must be \"draft\""), "{problem}");
    }

    #[test]
    fn texts_that_are_neither_are_refused_with_their_line() {
        assert!(Scenario::from_toml("name = ").unwrap_err().message.contains("line 1"));
        let problem = Scenario::from_json("{\n\"name\": }").unwrap_err();
        assert!(problem.message.contains("not JSON") && problem.message.contains("line 2"), "{problem}");
        let trailing = format!("{} x", paper().to_json());
        assert!(Scenario::from_json(&trailing).unwrap_err().message.contains("trailing"));
    }
}
