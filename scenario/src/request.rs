//! A scenario as people ask for it: a preset or a full one, with changes.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::format::{from_table, from_value, not_json, table};
use crate::{Problem, Problems, Scenario, preset, unknown_preset};

/// Problems of one request that are looked for at most.
pub const MOST_PROBLEMS: usize = 100;

/// A preset or a full scenario, and what to change in it:
/// `{"preset": "paper-200m", "set": {"mud.flow_rate": 0.02, "mud.density": 1500}}`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioRequest {
    /// Name of a preset; either this or `scenario`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// A full scenario; either this or `preset`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// Values by path (see [`Scenario::with`]): `mud.flow_rate`, `string.sections[1].count`. An object changes
    /// the fields it names; `null` removes what is optional. An outer path is applied before those inside it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub set: BTreeMap<String, Value>,
}

impl ScenarioRequest {
    /// A preset as it is.
    pub fn preset(name: impl Into<String>) -> Self {
        Self { preset: Some(name.into()), ..Self::default() }
    }

    /// Reads a request, or a plain scenario, from JSON.
    ///
    /// # Errors
    /// The first place where the text is not JSON or neither of the two.
    pub fn from_json(text: &str) -> Result<Self, Problem> {
        let document: Value = serde_json::from_str(text).map_err(|error| not_json(&error))?;
        if is_request(|key| document.get(key).is_some()) {
            return from_value(document);
        }
        Ok(Self { scenario: Some(Scenario::from_json(text)?), ..Self::default() })
    }

    /// Reads a request, or a plain scenario, from TOML.
    ///
    /// # Errors
    /// The first place where the text is not TOML or neither of the two.
    pub fn from_toml(text: &str) -> Result<Self, Problem> {
        let document = table(text)?;
        if is_request(|key| document.contains_key(key)) {
            return from_table(document);
        }
        Ok(Self { scenario: Some(from_table(document)?), ..Self::default() })
    }

    /// The scenario asked for. It is not validated yet.
    ///
    /// # Errors
    /// No base or two, an unknown preset, and every change that cannot be made, of many the first [`MOST_PROBLEMS`]. Paths of the
    /// changes are paths in the scenario.
    pub fn resolve(&self) -> Result<Scenario, Problems> {
        self.resolve_for_sweep(&[])
    }

    /// The same where the fields at the paths `swept` will be changed from point to point.
    ///
    /// # Errors
    /// As [`resolve`](Self::resolve).
    pub fn resolve_for_sweep(&self, swept: &[&str]) -> Result<Scenario, Problems> {
        let mut scenario = match (&self.preset, &self.scenario) {
            (Some(name), None) => preset(name).ok_or_else(|| unknown_preset(name))?,
            (None, Some(scenario)) => scenario.clone(),
            (Some(_), Some(_)) => {
                return Err(Problem::new("preset", "", "give either preset or scenario, not both").into());
            }
            (None, None) => {
                return Err(Problem::new("preset", "", "give preset or scenario").into());
            }
        };
        let duration = scenario.duration;
        let mut problems = Vec::new();
        // In the map's order a path comes before the longer ones inside it.
        for (path, value) in &self.set {
            match scenario.with(path, value.clone()) {
                Ok(changed) => scenario = changed,
                Err(problem) => problems.push(problem),
            }
            if problems.len() == MOST_PROBLEMS {
                break;
            }
        }
        if !problems.is_empty() {
            return Err(Problems(problems));
        }
        if scenario.duration != duration || swept.contains(&"duration") {
            self.let_windows_follow(&mut scenario, swept);
        }
        Ok(scenario)
    }

    /// Makes the fixed windows of a preset follow the duration (absent windows do), but for those that the request gives itself:
    /// they were chosen for the preset's own duration. A settled window does not depend on it.
    fn let_windows_follow(&self, scenario: &mut Scenario, swept: &[&str]) {
        if self.preset.is_none() {
            return;
        }
        let gives = |window: &str| {
            let path = format!("recording.{window}");
            let is_of = |changed: &str| {
                changed
                    .strip_prefix(&path)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
            };
            swept.iter().any(|path| is_of(path))
                || self.set.iter().any(|(changed, value)| {
                    is_of(changed) || changed == "recording" && value.get(window).is_some()
                })
        };
        if !gives("spectrum_windows") {
            scenario.recording.spectrum_windows = None;
        }
        if !gives("orbit_window") && !scenario.settles() {
            scenario.recording.orbit_window = None;
        }
    }
}

/// Whether a document with these keys is a request rather than a plain scenario.
fn is_request(has: impl Fn(&str) -> bool) -> bool {
    ["preset", "scenario", "set"].into_iter().any(has)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NodeChoice, TimeWindow};

    fn resolve_json(text: &str) -> Result<Scenario, Problems> {
        ScenarioRequest::from_json(text).unwrap().resolve()
    }

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn a_preset_with_changes() {
        let scenario = resolve_json(
            r#"{"preset": "paper-200m", "set": {"mud.flow_rate": 0.02, "string.sections[1].count": 8,
                "recording.nodes": [{"node": 3}], "operation": {"rotation_speed_rpm": 90}}}"#,
        )
        .unwrap();
        let mut expected = paper();
        expected.mud.as_mut().unwrap().flow_rate = 0.02;
        expected.string.sections[1].count = 8;
        expected.recording.nodes = vec![NodeChoice::Node(3)];
        expected.operation.rotation_speed_rpm = 90.0;
        assert_eq!(scenario, expected);
        assert_eq!(resolve_json(r#"{"preset": "paper-200m", "set": {"mud": null}}"#).unwrap().mud, None);
    }

    #[test]
    fn toml_may_write_paths_as_tables() {
        let request =
            "preset = 'paper-200m'\n[set]\nmud.flow_rate = 0.04\n\"string.sections[1].count\" = 8\n";
        let scenario = ScenarioRequest::from_toml(request).unwrap().resolve().unwrap();
        let mut expected = paper();
        expected.mud.as_mut().unwrap().flow_rate = 0.04;
        expected.string.sections[1].count = 8;
        assert_eq!(scenario, expected);
    }

    #[test]
    fn a_plain_scenario_is_a_request_without_changes() {
        let from_json = ScenarioRequest::from_json(&paper().to_json()).unwrap();
        let from_toml = ScenarioRequest::from_toml(&paper().to_toml()).unwrap();
        assert_eq!(from_json.resolve().unwrap(), paper());
        assert_eq!(from_json, from_toml);
        let wrapped = format!(r#"{{"scenario": {}, "set": {{"duration": 1.0}}}}"#, paper().to_json());
        assert_eq!(resolve_json(&wrapped).unwrap().duration, 1.0);
    }

    #[test]
    fn a_presets_windows_follow_the_duration_unless_given() {
        let windows = |set: &str| {
            let scenario = resolve_json(&format!(r#"{{"preset": "paper-200m", "set": {set}}}"#)).unwrap();
            (scenario.orbit_window().unwrap(), scenario.spectrum_windows().unwrap())
        };
        let window = |from, to| TimeWindow { from, to };
        let own = (window(40.0, 60.0), vec![window(15.0, 25.0), window(50.0, 60.0)]);
        assert_eq!(windows("{}"), own);
        assert_eq!(windows(r#"{"duration": 60}"#), own);
        assert_eq!(windows(r#"{"duration": 6}"#), (window(4.0, 6.0), vec![window(5.0, 6.0)]));
        assert_eq!(windows(r#"{"duration": 120}"#), (window(80.0, 120.0), vec![window(100.0, 120.0)]));
        // A last sixth of five samples has no spectrum.
        assert_eq!(windows(r#"{"duration": 0.03}"#).1, []);

        let given = (window(1.0, 6.0), vec![window(2.0, 6.0)]);
        let orbit = r#"{"duration": 6, "recording.orbit_window": {"from": 1, "to": 6}}"#;
        assert_eq!(windows(orbit), (given.0, vec![window(5.0, 6.0)]));
        let spectrum = r#"{"duration": 6, "recording": {"spectrum_windows": [{"from": 2, "to": 6}]}}"#;
        assert_eq!(windows(spectrum), (window(4.0, 6.0), given.1));
        let edge = r#"{"duration": 61, "recording.orbit_window.to": 61}"#;
        assert_eq!(windows(edge).0, window(40.0, 61.0));
        assert_eq!(windows(r#"{"duration": 6, "recording.spectrum_windows": []}"#).1, []);
    }

    #[test]
    fn a_presets_settled_window_stays_when_the_duration_changes() {
        let resolved =
            |set: &str| resolve_json(&format!(r#"{{"preset": "paper-200m-damped", "set": {set}}}"#)).unwrap();
        for set in ["{}", r#"{"duration": 120}"#] {
            let scenario = resolved(set);
            assert!(scenario.settles() && scenario.spectrum_windows().is_none(), "{set}");
        }
        let following = resolved(r#"{"duration": 120, "recording.orbit_window": null}"#);
        assert_eq!(following.orbit_window(), Some(TimeWindow { from: 80.0, to: 120.0 }));
    }

    #[test]
    fn outer_paths_are_applied_first() {
        let dry = r#"{"preset": "paper-200m-dry", "set": {"mud.density": 1300, "mud": {"density": 1, "flow_rate": 0.0,
            "yield_stress": 0.0, "consistency": 0.001, "flow_index": 1.0}}}"#;
        assert_eq!(resolve_json(dry).unwrap().mud.unwrap().density, 1300.0);
    }

    #[test]
    fn every_impossible_change_is_reported() {
        let problems = resolve_json(
            r#"{"preset": "paper-200m", "set": {"mud.flowrate": 1, "duration": "long", "name": "x"}}"#,
        )
        .unwrap_err();
        let paths: Vec<&str> = problems.0.iter().map(|problem| problem.path.as_str()).collect();
        assert_eq!(paths, ["duration", "mud.flowrate"]);
    }

    #[test]
    fn requests_need_one_base() {
        let problem = &resolve_json(r#"{"preset": "paper-300m"}"#).unwrap_err().0[0];
        assert_eq!((problem.path.as_str(), problem.got.as_str()), ("preset", "paper-300m"));
        assert!(problem.message.contains("paper-200m, paper-200m-dry"));
        assert!(resolve_json(r#"{"set": {}}"#).is_err());
        let both = format!(r#"{{"preset": "paper-200m", "scenario": {}}}"#, paper().to_json());
        assert!(resolve_json(&both).is_err());
        let problem = ScenarioRequest::from_json(r#"{"preset": "paper-200m", "sets": {}}"#).unwrap_err();
        assert!(problem.message.contains("there is no field `sets`"), "{problem}");
        let broken =
            format!(r#"{{"scenario": {}}}"#, paper().to_json().replace("\"count\": 9", "\"count\": 0.5"));
        assert_eq!(
            ScenarioRequest::from_json(&broken).unwrap_err().path,
            "scenario.string.sections[1].count"
        );
    }
}
