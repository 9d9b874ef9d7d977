//! Scenarios as TOML and JSON.

use serde::de::DeserializeOwned;

use super::{Problem, Scenario};

impl Scenario {
    /// The scenario as a tree. TOML's, because it has all doubles: JSON lacks those that are not finite.
    pub(crate) fn tree(&self) -> toml::Value {
        toml::Value::try_from(self).expect("a scenario has only string keys and no value that TOML lacks")
    }

    /// Reads a scenario from TOML.
    ///
    /// # Errors
    /// The first place where the text is not TOML, or the first by its fields' names where it is not a scenario; unknown fields
    /// are refused.
    pub fn from_toml(text: &str) -> Result<Self, Problem> {
        from_table(table(text)?)
    }

    /// Reads a scenario from JSON.
    ///
    /// # Errors
    /// The first place where the text is not JSON or not a scenario; unknown fields are refused.
    pub fn from_json(text: &str) -> Result<Self, Problem> {
        let mut deserializer = serde_json::Deserializer::from_str(text);
        let scenario = serde_path_to_error::deserialize(&mut deserializer)
            .map_err(|error| json_problem(error.path().to_string(), error.inner()))?;
        deserializer.end().map_err(|error| json_problem(String::new(), &error))?;
        Ok(scenario)
    }

    /// Writes the scenario as TOML.
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).expect("a scenario has only string keys and no value that TOML lacks")
    }

    /// Writes the scenario as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a scenario has only string keys")
    }
}

/// A TOML document as a tree, or why the text is not TOML at all.
pub(super) fn table(text: &str) -> Result<toml::Table, Problem> {
    toml::from_str(text).map_err(|error: toml::de::Error| Problem::new("", "", error.to_string().trim_end()))
}

/// A type out of a parsed TOML document: code for reading each type from the text itself would be several times as much.
pub(super) fn from_table<T: DeserializeOwned>(table: toml::Table) -> Result<T, Problem> {
    serde_path_to_error::deserialize(toml::Value::Table(table))
        .map_err(|error| Problem::from_serde(error.path().to_string(), error.inner().message()))
}

/// A type out of a parsed JSON document.
pub(super) fn from_value<T: DeserializeOwned>(value: serde_json::Value) -> Result<T, Problem> {
    serde_path_to_error::deserialize(value)
        .map_err(|error| json_problem(error.path().to_string(), error.inner()))
}

/// What serde_json found wrong at a path.
pub(super) fn json_problem(path: String, error: &serde_json::Error) -> Problem {
    let text = error.to_string();
    if !error.is_data() {
        return Problem::new("", "", format!("not JSON: {text}"));
    }
    // The path says where; the line would only blur the message.
    let place = format!(" at line {} column {}", error.line(), error.column());
    Problem::from_serde(path, text.strip_suffix(&place).unwrap_or(&text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Accuracy, AccuracyPreset, Integrator, TimeStepping, preset};

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
    fn unknown_fields_are_refused_where_they_stand() {
        let text = paper().to_toml().replace("flow_rate", "flowrate");
        let problem = Scenario::from_toml(&text).unwrap_err();
        assert_eq!(problem.path, "mud.flowrate");
        assert!(
            problem.message.contains("unknown field") && problem.message.contains("`flow_rate`"),
            "{problem}"
        );
        let problem = Scenario::from_json(&paper().to_json().replace("flow_rate", "flowrate")).unwrap_err();
        assert_eq!(problem.path, "mud.flowrate");
    }

    #[test]
    fn wrong_types_say_what_was_expected() {
        let json = paper().to_json().replace("\"count\": 9", "\"count\": -9");
        let problem = Scenario::from_json(&json).unwrap_err();
        assert_eq!(problem.path, "string.sections[1].count");
        assert_eq!(problem.got, "integer `-9`");
        assert_eq!(problem.message, "must be a whole number, 0 or more");

        let toml = paper().to_toml().replace("youngs_modulus = 203000000000.0", "youngs_modulus = \"steel\"");
        let problem = Scenario::from_toml(&toml).unwrap_err();
        assert_eq!(problem.path, "string.material.youngs_modulus");
        assert_eq!(problem.got, "string \"steel\"");
        assert_eq!(problem.message, "must be a number");
    }

    #[test]
    fn missing_fields_are_named() {
        let problem = Scenario::from_toml(&paper().to_toml().replace("hole_diameter", "#")).unwrap_err();
        assert_eq!(problem.path, "well");
        assert!(problem.message.contains("missing field `hole_diameter`"), "{problem}");
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
        assert!(problem.message.contains("`draft`, `standard`, `reference`"), "{problem}");
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
