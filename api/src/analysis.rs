//! Plan of a point, and its modes of vibration about the equilibrium: both follow from its scenario alone, without a run.

use std::fmt::Display;

use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{ModeSearch, modes};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_study::plan::MachineSpeed;

use crate::problem::{ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::modes::Modes;
pub use drillsweep_study::plan::Plan;

/// Up to this frequency modes are searched \[Hz\]: there are about two for each hertz and 200 m, and each takes its time.
pub const HIGHEST_MODE_HZ: f64 = 50.0;

/// Plan of a scenario with warnings from its equilibrium; with processor times if `speed_json` is the speed that a worker has measured.
///
/// # Errors
/// The scenario has no model.
pub fn plan(scenario: &Scenario, speed_json: Option<&str>) -> Result<Plan, Box<ProblemDetails>> {
    // A speed that another version has written is as good as none.
    let speed: Option<MachineSpeed> = speed_json.and_then(|json| serde_json::from_str(json).ok());
    let plan = Plan::new(scenario, speed.as_ref()).map_err(|error| none("plan", &error))?;
    Ok(plan.with_equilibrium(scenario))
}

/// The modes of a scenario about its equilibrium up to a frequency \[Hz\], its contacts closed and sliding.
///
/// # Errors
/// The scenario has no model or no equilibrium, or its eigenvalues are not found.
pub fn modes_up_to(scenario: &Scenario, to_hz: f64) -> Result<Modes, Box<ProblemDetails>> {
    let model = Model::new(scenario).map_err(|error| none("modes", &error))?;
    let equilibrium = Equilibrium::find(&model).map_err(|error| none("modes", &error))?;
    let search = ModeSearch { to_hz, ..ModeSearch::default() };
    modes(&model, &equilibrium, &search).map_err(|error| none("modes", &error))
}

fn none(what: &str, error: &impl Display) -> Box<ProblemDetails> {
    ProblemDetails::new(ProblemKind::NoResult, format!("the scenario has no {what}: {error}")).into()
}
