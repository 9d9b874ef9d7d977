//! Plan of a point, and its modes of vibration about the equilibrium: both follow from its scenario alone, without a run.

use std::f64::consts::TAU;
use std::fmt::Display;

use drillsweep_quantity::Quantity;
use drillsweep_quantity::columns::*;
use drillsweep_scenario::{NodeChoice, Scenario};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{ModeSearch, modes, modes_in};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::string::MeshNode;
use drillsweep_study::plan::MachineSpeed;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::judgement::{Judgement, Line, LineCause, Motion, OperatingLimits, line_causes, mode_bands};
use crate::problem::{ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::hydraulics::Circuit;
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

/// Pressures of the circuit of a scenario's mud by all sets of formulas.
///
/// # Errors
/// The scenario has no mud, no model or no equilibrium, or a flow has no solution.
pub fn hydraulics(scenario: &Scenario) -> Result<Circuit, Box<ProblemDetails>> {
    let model = Model::new(scenario).map_err(|error| none("hydraulics", &error))?;
    let equilibrium = Equilibrium::find(&model).map_err(|error| none("hydraulics", &error))?;
    Circuit::new(&model, &equilibrium).map_err(|error| none("hydraulics", &error))
}

/// Diagnosis of a finished point: class of its motion by limits, findings with evidence, and causes of its spectral lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Diagnosis {
    /// The judgement.
    #[serde(flatten)]
    pub judgement: Judgement,
    /// Spectral lines of the recorded nodes with their causes, the strongest of each node and window first.
    pub lines: Vec<LineCause>,
}

/// Diagnosis of a point by its scenario, its row, and its lines if its outputs keep them; otherwise the strongest line of each node, from the row.
///
/// # Errors
/// The scenario has no model.
pub fn diagnosis(
    scenario: &Scenario,
    row: &Map<String, Value>,
    lines: Option<Vec<Line>>,
    limits: &OperatingLimits,
) -> Result<Diagnosis, Box<ProblemDetails>> {
    let judgement = Judgement::of_row(row, limits);
    let model = Model::new(scenario).map_err(|error| none("diagnosis", &error))?;
    let lines = lines.unwrap_or_else(|| strongest_lines(&model, row));
    let number = |quantity: &Quantity| row.get(quantity.name).and_then(Value::as_f64);
    let swing = || {
        let relative = number(&BIT_LINE_AMPLITUDE)? / number(&BIT_SPEED_MEAN)?.abs();
        Some([number(&BIT_LINE_FREQUENCY_HZ)?, relative]).filter(|_| relative.is_finite())
    };
    let torsion = swing();
    let bands = mode_bands(&lines, torsion.map(|[frequency_hz, _]| frequency_hz), HIGHEST_MODE_HZ);
    // Causes but modes are found without them.
    let modes = match bands.is_empty() {
        true => Vec::new(),
        false => Equilibrium::find(&model)
            .ok()
            .and_then(|equilibrium| modes_in(&model, &equilibrium, &bands).ok())
            .unwrap_or_default(),
    };
    let rolling = |node: &MeshNode| {
        let hz = -model.rotation_speed * node.contact_radius / node.clearance / TAU;
        Some(hz).filter(|hz| hz.is_finite() && *hz != 0.0)
    };
    let motion = Motion {
        rotation_hz: model.rotation_speed / TAU,
        torsion,
        rolling_hz: model.mesh.nodes.iter().map(rolling).collect(),
        modes,
    };
    Ok(Diagnosis { judgement, lines: line_causes(&lines, &motion) })
}

/// The strongest line of each recorded node in each window, as the row of a point has them.
fn strongest_lines(model: &Model, row: &Map<String, Value>) -> Vec<Line> {
    let number = |name: &str| row.get(name).and_then(Value::as_f64);
    let window = [&STATISTICS_FROM, &STATISTICS_TO].map(|time| number(time.name).unwrap_or(0.0));
    let of_node = |choice: &NodeChoice| {
        let node = model.mesh.chosen_node(*choice)?;
        let place = choice.in_names();
        let lines = (1..).map_while(move |number_of_window| {
            Some(Line {
                node: node + 1,
                measured_depth: model.mesh.nodes[node].measured_depth,
                window,
                frequency_hz: number(&LINE_FREQUENCY_HZ.in_window(&place, number_of_window))?,
                amplitude: number(&LINE_AMPLITUDE.in_window(&place, number_of_window))?,
            })
        });
        Some(lines.collect::<Vec<_>>())
    };
    model.scenario.recording.nodes.iter().filter_map(of_node).flatten().collect()
}

fn none(what: &str, error: &impl Display) -> Box<ProblemDetails> {
    ProblemDetails::new(ProblemKind::NoResult, format!("the scenario has no {what}: {error}")).into()
}
