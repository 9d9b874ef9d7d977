//! Scenarios as arguments of commands.

use std::path::Path;

use anyhow::{Context, anyhow, bail};
use clap::Args;
use drillsweep_scenario::{PRESETS, Scenario, ScenarioRequest, unknown_preset};
use serde_json::{Value, json};

/// One scenario with changes.
#[derive(Args)]
pub(crate) struct ScenarioArguments {
    /// A preset's name (see `drillsweep scenario`) or a scenario file (.toml or .json).
    scenario: String,
    #[command(flatten)]
    changes: ChangeArguments,
}

/// Changes to a scenario.
#[derive(Args)]
pub(crate) struct ChangeArguments {
    /// Change a field of the scenario, such as `mud.flow_rate=0.04` or `mud=null`.
    #[arg(long, value_name = "PATH=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
}

impl ScenarioArguments {
    /// The requested scenario, at a named accuracy if one is given. It is not validated yet.
    pub(crate) fn resolve(&self, accuracy: Option<&str>) -> anyhow::Result<Scenario> {
        Ok(self.request(accuracy)?.resolve()?)
    }

    /// The same as a request.
    pub(crate) fn request(&self, accuracy: Option<&str>) -> anyhow::Result<ScenarioRequest> {
        self.changes.applied_to(&self.scenario, accuracy)
    }
}

impl ChangeArguments {
    /// The scenario of this name with the changes, as a request.
    pub(crate) fn applied_to(&self, name: &str, accuracy: Option<&str>) -> anyhow::Result<ScenarioRequest> {
        let mut request = read(name)?;
        let accuracy = accuracy.map(|name| ("accuracy".to_owned(), json!(name)));
        request.set.extend(self.set.iter().cloned().chain(accuracy));
        Ok(request)
    }
}

/// A preset by name, or the request of a file: a scenario, or a preset or scenario with changes.
pub(crate) fn read(name: &str) -> anyhow::Result<ScenarioRequest> {
    let path = Path::new(name);
    let text = || std::fs::read_to_string(path).with_context(|| format!("cannot read {name}"));
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("toml") => ScenarioRequest::from_toml(&text()?).with_context(|| name.to_owned()),
        Some("json") => ScenarioRequest::from_json(&text()?).with_context(|| name.to_owned()),
        _ if PRESETS.iter().any(|(preset, _)| *preset == name) => Ok(ScenarioRequest::preset(name)),
        _ => {
            let problem = unknown_preset(name).message;
            bail!("no scenario {name:?}: {problem}; files end in .toml or .json")
        }
    }
}

/// `path=value`; the value is JSON, or else a text.
pub(crate) fn parse_set(text: &str) -> anyhow::Result<(String, Value)> {
    let (path, value) = text.split_once('=').with_context(|| format!("write PATH=VALUE, got {text:?}"))?;
    let value = parse_value(value).map_err(|error| anyhow!("{path} {error}"))?;
    Ok((path.trim().to_owned(), value))
}

/// JSON, or else the text itself.
pub(crate) fn parse_value(text: &str) -> anyhow::Result<Value> {
    match serde_json::from_str(text) {
        Ok(value) => Ok(value),
        // Text that begins like JSON is meant as JSON: as plain text it would only be refused for another reason.
        Err(error) if text.starts_with(['{', '[', '"']) => {
            bail!("is not JSON (as in {{\"from\": 2, \"to\": 5}}): {error}")
        }
        Err(_) => Ok(json!(text)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_json_or_a_word_and_broken_json_is_no_word() {
        let set = |text: &str| parse_set(text).map(|(path, value)| (path, value.to_string()));
        assert_eq!(set("mud.flow_rate=0.04").unwrap(), ("mud.flow_rate".into(), "0.04".into()));
        assert_eq!(set("accuracy=draft").unwrap(), ("accuracy".into(), "\"draft\"".into()));
        assert_eq!(set("a={\"from\": 2}").unwrap(), ("a".into(), "{\"from\":2}".into()));
        let error = set("recording.orbit_window={from=2,to=5}").unwrap_err().to_string();
        assert!(error.starts_with("recording.orbit_window is not JSON"), "{error}");
        assert!(set("mud").is_err());
    }
}
