//! The preset scenarios and the catalogue of pipes as the service lists them.

use drillsweep_scenario::{CATALOGUE, PRESETS, preset};

use crate::service::{PipeList, ScenarioDetail, ScenarioEntry, ScenarioList};

/// Every preset, by name.
pub fn presets() -> ScenarioList {
    let entry = |&(name, description): &(&str, &str)| ScenarioEntry {
        name: name.to_owned(),
        description: description.to_owned(),
        // A name is one segment of the path.
        link: format!("/v1/scenarios/{}", name.replace('/', "%2F")),
    };
    ScenarioList { scenarios: PRESETS.iter().map(entry).collect() }
}

/// One preset in full; none if there is none of that name.
pub fn preset_detail(name: &str) -> Option<ScenarioDetail> {
    let (name, description) = PRESETS.iter().find(|(preset, _)| *preset == name)?;
    let scenario = Box::new(preset(name)?);
    Some(ScenarioDetail { name: (*name).to_owned(), description: (*description).to_owned(), scenario })
}

/// The catalogue of pipes.
pub fn pipes() -> PipeList {
    PipeList { pipes: CATALOGUE.clone() }
}
