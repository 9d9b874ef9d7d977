//! Forecast of a scenario, without running it: the active effects with their reasons, the size of the problem, steps and
//! processor time at each accuracy.

use drillsweep_scenario::{
    Accuracy, AccuracyPreset, Integrator, Mesh, NodeChoice, Recording, Scenario, Switch, TimeStepping,
    TimeWindow, WallLaw,
};
use serde::{Deserialize, Serialize};

use super::cost;
use crate::footprint::Footprint;
use crate::mesh_estimate::MeshEstimate;
use crate::summary::StaticsSummary;
use drillsweep_sim::force::effect::{EffectDecision, decide_effects};
use drillsweep_sim::solve::model::{Model, ModelError};
use drillsweep_sim::solve::modes::{UndampedTorsion, static_stability};
use drillsweep_sim::solve::run::{shortest_run, twin_time};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::solve::step::{longest_step, resolved_hz, step_count, torsion_step};
use drillsweep_sim::string::StringMesh;

/// The plan of a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct Plan {
    /// Decision about every effect, with its reason.
    pub effects: Vec<EffectDecision>,
    /// Elements of the string at its own accuracy.
    pub elements: usize,
    /// Length of the shortest element \[m\].
    pub shortest_element: f64,
    /// Length of the longest element \[m\].
    pub longest_element: f64,
    /// Nodes of the string.
    pub nodes: usize,
    /// Degrees of freedom of a node that the run in time solves for; 0 without a run in time.
    pub degrees_of_freedom: usize,
    /// Simulated time of all runs of the point together \[s\], without a cost study: the most that they may take if the window is
    /// settled. 0 without a run in time.
    pub simulated_time: f64,
    /// Least simulated time of these runs \[s\]: if the window is settled, runs end once their motion has settled.
    pub shortest_simulated_time: f64,
    /// Memory and storage.
    pub footprint: Footprint,
    /// Expected processor time of the equilibrium with its hydraulics \[s\]; absent if the machine's speed
    /// is not known.
    pub statics_cpu_time: Option<f64>,
    /// The scenario's own accuracy first, then the named ones, without a cost study; none without a run in time.
    pub accuracies: Vec<PlannedAccuracy>,
    /// Study that replaces the run if the scenario has a `cost_study`; absent also if the study has no runs because the scenario
    /// has no equilibrium.
    pub study: Option<PlannedStudy>,
    #[serde(skip)]
    is_study: bool,
    /// The torsional modes that velocity-weakening friction excites, about the equilibrium; absent if [`Plan::with_equilibrium`] was not called,
    /// there is no run in time, twist takes no part or friction does not turn the string.
    pub undamped_torsion: Option<UndampedTorsion>,
    /// Torque at the top \[N m\] at break-away, friction mu_s at every node that touches; absent as `mesh_error`, or if that equilibrium was
    /// not found.
    pub torque_top_break_away: Option<f64>,
    /// Torque at the top \[N m\] of the rotating string, friction mu at the sliding speed of each node; absent as `torque_top_break_away`.
    pub torque_top_rotating: Option<f64>,
    /// The mesh's part of the error of the equilibrium; absent if [`Plan::with_equilibrium`] was not called or there is no equilibrium.
    pub mesh_error: Option<MeshEstimate>,
    /// Warnings, in words, of properties of the equilibrium that can be simulated but are probably not meant.
    pub warnings: Vec<String>,
}

/// Parts of [`Plan::with_equilibrium`], each of which may take seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanningPart {
    /// The equilibrium from which the run starts.
    Equilibrium,
    /// Torsional modes that velocity-weakening friction excites.
    Torsion,
    /// The equilibrium of the other friction at rest, for the torque at the top.
    OtherFriction,
    /// Error of the equilibrium for its mesh, from two finer ones.
    Mesh,
}

impl PlanningPart {
    /// Name for readers who wait for the part.
    pub fn name(self) -> &'static str {
        match self {
            PlanningPart::Equilibrium => "equilibrium",
            PlanningPart::Torsion => "torsional modes",
            PlanningPart::OtherFriction => "equilibrium of the other friction at rest",
            PlanningPart::Mesh => "error of the mesh",
        }
    }
}

/// Size and cost of one accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct PlannedAccuracy {
    /// `draft`, `standard`, `reference`, `tolerance` if one was given, or `explicit` if integrator and step were given in full.
    pub name: String,
    /// Elements of its mesh: `auto` follows the accuracy.
    pub elements: usize,
    /// Method.
    pub integrator: Integrator,
    /// Step \[s\]; the longest one if the step adapts itself.
    pub step: f64,
    /// Steps of all runs of the point together, the most if the window is settled; an estimate if the step adapts itself, and
    /// absent for `rk4` with a tolerance.
    pub steps: Option<u64>,
    /// Least number of steps, as `steps`.
    pub fewest_steps: Option<u64>,
    /// Expected processor time of the whole point on one core \[s\], equilibrium and twin included, the most if the window is
    /// settled; absent if the machine's speed is not known or the steps are not.
    pub cpu_time: Option<f64>,
    /// Least processor time, as `cpu_time` \[s\].
    pub least_cpu_time: Option<f64>,
}

/// Runs and cost of a cost study.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct PlannedStudy {
    /// Runs of all methods, steps and meshes, by all members.
    pub runs: u64,
    /// Their simulated time together \[s\].
    pub simulated_time: f64,
    /// Expected processor time of these runs on one core \[s\], without the rows that `lines_not_known` counts; absent if the
    /// machine's speed is not known.
    pub cpu_time: Option<f64>,
    /// Rows of the study whose time is not known beforehand: `rk4` with a tolerance.
    pub lines_not_known: u64,
}

/// Speed of a machine, in processor seconds, measured by [`calibration_runs`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct MachineSpeed {
    /// Time of an equilibrium with its hydraulics, for each node \[s\].
    pub statics_per_node: f64,
    /// Time of a run before its first step (matrices, stability of the step, factors), by the methods below, for each node \[s\].
    pub start_per_node: [f64; 4],
    /// Time of a step of generalized-alpha, ESDIRK4 with two contact iterations, ESDIRK4 with contact iterations until convergence, and RK4: for each
    /// node of the 200 m string \[s\], with 4, 5 and 6 degrees of freedom.
    pub step_per_node: [[f64; 3]; 4],
    /// Time of a node's step on a mesh of five times as many nodes, which no longer fits the inner caches, over that of the 200 m string.
    pub large_mesh_factor: f64,
    /// Time of a step with the wall along the elements over that with the wall at the nodes, by the methods above.
    #[serde(default = "no_difference")]
    pub along_elements: [f64; 4],
}

/// Default for speeds that were measured without this ratio.
fn no_difference() -> [f64; 4] {
    [1.0; 4]
}

/// Nodes of the large mesh that is timed, over those of the 200 m string.
const LARGE_MESH: f64 = 5.0;

/// Nodes of the 200 m string.
const BASE_NODES: f64 = 297.0;

/// Contact iterations that are enough for convergence.
const CONVERGED_CONTACT_ITERATIONS: u32 = 20;

/// Methods whose steps differ in cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MethodKind {
    GeneralizedAlpha,
    /// Two contact iterations a stage.
    Esdirk4,
    /// Contact iterations until they have converged.
    Esdirk4Converged,
    Rk4,
}

/// A short run whose steps are timed.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationRun {
    /// Scenario to simulate.
    pub scenario: Scenario,
    method: usize,
    degrees_of_freedom: usize,
    is_large: bool,
    is_along_elements: bool,
}

impl Plan {
    /// The plan of a valid scenario; with processor times if the machine's `speed` is known.
    ///
    /// # Errors
    /// The scenario has no model.
    pub fn new(scenario: &Scenario, speed: Option<&MachineSpeed>) -> Result<Self, ModelError> {
        Self::with_twin(scenario, speed, twin_part(scenario))
    }

    /// The plan of a row of a cost study, whose runs have no twin.
    pub(super) fn of_line(scenario: &Scenario, speed: Option<&MachineSpeed>) -> Result<Self, ModelError> {
        Self::with_twin(scenario, speed, 0.0)
    }

    fn with_twin(scenario: &Scenario, speed: Option<&MachineSpeed>, twin: f64) -> Result<Self, ModelError> {
        let model = Model::new(scenario)?;
        let nodes = model.node_count();
        let lengths = || model.mesh.elements.iter().map(|element| element.length);
        let in_time = model.effects.transient;
        let of_members = if in_time { f64::from(scenario.runs()) } else { 0.0 };
        let shortest_part = shortest_run(scenario) / scenario.duration;
        let statics_cpu_time = speed.map(|speed| speed.statics_per_node * nodes as f64);
        let degrees_of_freedom = degrees_of_freedom(&model);
        let along_elements = model.effects.contact && scenario.contact.law == WallLaw::PerLength;
        let accuracies = if in_time { accuracies(scenario) } else { Vec::new() };
        let planned = |(name, accuracy): (&str, Accuracy)| {
            let stepping = accuracy.time_stepping();
            let nodes = nodes_at(&model, accuracy);
            let statics_cpu_time = speed.map(|speed| speed.statics_per_node * nodes as f64);
            let runs = u64::from(scenario.runs());
            let steps = step_count(&model, stepping).map(|steps| steps * runs);
            let cost = |steps: u64| {
                let (speed, method) = (speed?, MethodKind::of(stepping));
                let start = speed.start_per_node[method as usize] * nodes as f64 * runs as f64;
                let along = if along_elements { speed.along_elements[method as usize] } else { 1.0 };
                let step = along * speed.step(method, degrees_of_freedom, nodes);
                Some(statics_cpu_time? + start + step * steps as f64 * (1.0 + twin / runs as f64))
            };
            let fewest_steps = steps.map(|steps| (steps as f64 * shortest_part).round() as u64);
            PlannedAccuracy {
                name: name.to_owned(),
                elements: nodes - 1,
                integrator: stepping.integrator,
                step: longest_step(&model, stepping),
                steps,
                fewest_steps,
                cpu_time: steps.and_then(cost),
                least_cpu_time: fewest_steps.and_then(cost),
            }
        };
        let study = scenario.cost_study.as_ref().and_then(|_| PlannedStudy::new(scenario, speed));
        Ok(Self {
            effects: decide_effects(scenario),
            elements: model.elements.len(),
            shortest_element: lengths().fold(f64::INFINITY, f64::min),
            longest_element: lengths().fold(0.0, f64::max),
            nodes,
            degrees_of_freedom: if in_time { degrees_of_freedom } else { 0 },
            simulated_time: scenario.duration * of_members,
            shortest_simulated_time: shortest_run(scenario) * of_members,
            footprint: Footprint::of_model(&model),
            statics_cpu_time,
            accuracies: accuracies.into_iter().map(planned).collect(),
            study,
            is_study: scenario.cost_study.is_some(),
            undamped_torsion: None,
            torque_top_break_away: None,
            torque_top_rotating: None,
            mesh_error: None,
            warnings: Vec::new(),
        })
    }

    /// The plan with the quantities of the scenario's equilibrium, which takes as long as finding it. If there is none, the run reports
    /// that.
    #[must_use]
    pub fn with_equilibrium(self, scenario: &Scenario) -> Self {
        self.with_equilibrium_by_parts(scenario, |_| ())
    }

    /// As [`Plan::with_equilibrium`], with a call of `begin` at the start of each part.
    #[must_use]
    pub fn with_equilibrium_by_parts(
        mut self,
        scenario: &Scenario,
        mut begin: impl FnMut(PlanningPart),
    ) -> Self {
        begin(PlanningPart::Equilibrium);
        let Some(model) = Model::new(scenario).ok().filter(|model| model.effects.transient) else {
            return self;
        };
        let Ok(equilibrium) = Equilibrium::find(&model) else { return self };
        begin(PlanningPart::Torsion);
        self.undamped_torsion = UndampedTorsion::about(&model, &equilibrium);
        begin(PlanningPart::OtherFriction);
        let start = scenario.statics.friction;
        let other = equilibrium.with_friction_at_rest(&model, start.other());
        let statics = StaticsSummary::new(&model, &equilibrium, start, other.as_ref().ok());
        self.torque_top_break_away = statics.torque_top_break_away;
        self.torque_top_rotating = statics.torque_top_rotating;
        begin(PlanningPart::Mesh);
        self.mesh_error = Some(MeshEstimate::of(&model, &equilibrium));
        self.warnings.extend(static_stability(&model, &equilibrium).and_then(|found| found.warning()));
        for (planned, (_, accuracy)) in self.accuracies.iter_mut().zip(accuracies(scenario)) {
            let more = planned.step / torsion_step(&accuracy.time_stepping(), self.undamped_torsion.as_ref());
            if more > 1.0 {
                planned.step /= more;
                for steps in [&mut planned.steps, &mut planned.fewest_steps].into_iter().flatten() {
                    *steps = (*steps as f64 * more).round() as u64;
                }
                for time in [&mut planned.cpu_time, &mut planned.least_cpu_time].into_iter().flatten() {
                    *time *= more;
                }
            }
        }
        if let (Some(torsion), Some(own)) = (self.undamped_torsion, self.accuracies.first()) {
            self.warnings.extend(torsion.warning(resolved_hz(own.integrator, own.step)));
        }
        self
    }

    /// Largest expected processor time of the point \[s\], at its own accuracy or with its cost study; absent if it is not
    /// known.
    pub fn cpu_time(&self) -> Option<f64> {
        if self.is_study {
            return self.study.as_ref().filter(|study| study.lines_not_known == 0)?.cpu_time;
        }
        self.accuracies.first().map_or(self.statics_cpu_time, |own| own.cpu_time)
    }
}

impl PlannedStudy {
    /// The study of a scenario with a cost study; none if it cannot be planned, which the run reports.
    fn new(scenario: &Scenario, speed: Option<&MachineSpeed>) -> Option<Self> {
        let rows = cost::plan(scenario).ok()?;
        let members = |row: &cost::PlannedRow| u64::from(row.members.end - row.members.start);
        let expected = speed.map(|speed| expected_cpu_time(&rows, speed));
        let is_known = |row: &&cost::PlannedRow| {
            let stepping = row.scenario.accuracy.time_stepping();
            stepping.integrator != Integrator::Rk4 || stepping.tolerance.is_none()
        };
        Some(Self {
            runs: rows.iter().map(members).sum(),
            simulated_time: rows.iter().map(|row| members(row) as f64 * row.scenario.duration).sum(),
            cpu_time: expected.map(|(time, _)| time),
            lines_not_known: (rows.len() - rows.iter().filter(is_known).count()) as u64,
        })
    }
}

/// Steps of the twin that measures the amplification, over those of the run; the largest ratio if the window is settled.
fn twin_part(scenario: &Scenario) -> f64 {
    if scenario.recording.nodes.is_empty() {
        return 0.0;
    }
    let whole = TimeWindow { from: 0.0, to: scenario.duration };
    twin_time(scenario.orbit_window().unwrap_or(whole), scenario.duration) / scenario.duration
}

fn degrees_of_freedom(model: &Model) -> usize {
    4 + usize::from(model.effects.torsion) + usize::from(model.effects.axial_motion)
}

/// The scenario's own accuracy, then the other named ones.
fn accuracies(scenario: &Scenario) -> Vec<(&'static str, Accuracy)> {
    let named = [
        ("draft", AccuracyPreset::Draft),
        ("standard", AccuracyPreset::Standard),
        ("reference", AccuracyPreset::Reference),
    ];
    let own = match scenario.accuracy {
        Accuracy::Preset(own) => {
            named.iter().find(|(_, preset)| *preset == own).map_or("explicit", |(name, _)| name)
        }
        Accuracy::Target(_) => "tolerance",
        Accuracy::Explicit(_) => "explicit",
    };
    let others = named.into_iter().filter(|(name, _)| *name != own);
    let others = others.map(|(name, preset)| (name, Accuracy::Preset(preset)));
    std::iter::once((own, scenario.accuracy)).chain(others).collect()
}

/// Nodes of a model's string at an accuracy, which the mesh `auto` follows. A string that would have too many nodes stays unchanged.
fn nodes_at(model: &Model, accuracy: Accuracy) -> usize {
    let scenario = &model.scenario;
    if scenario.mesh != Mesh::AUTO || accuracy == scenario.accuracy {
        return model.node_count();
    }
    let at_accuracy = Scenario { accuracy, ..scenario.clone() };
    StringMesh::new(&at_accuracy).map_or(model.node_count(), |mesh| mesh.nodes.len())
}

impl MethodKind {
    const ALL: [MethodKind; 4] =
        [MethodKind::GeneralizedAlpha, MethodKind::Esdirk4, MethodKind::Esdirk4Converged, MethodKind::Rk4];

    fn of(stepping: TimeStepping) -> Self {
        match stepping.integrator {
            Integrator::GeneralizedAlpha => MethodKind::GeneralizedAlpha,
            Integrator::Esdirk4 if stepping.contact_sweeps > 2 => MethodKind::Esdirk4Converged,
            Integrator::Esdirk4 => MethodKind::Esdirk4,
            Integrator::Rk4 => MethodKind::Rk4,
        }
    }

    /// Stepping and simulated time \[s\] of a run long enough for timing: some 10 ms.
    fn sample(self) -> (TimeStepping, f64) {
        match self {
            MethodKind::GeneralizedAlpha => (TimeStepping::fixed(Integrator::GeneralizedAlpha, 5e-4), 0.05),
            MethodKind::Esdirk4 => (TimeStepping::fixed(Integrator::Esdirk4, 1e-3), 0.03),
            MethodKind::Esdirk4Converged => {
                let stepping = TimeStepping::fixed(Integrator::Esdirk4, 2.5e-4);
                (TimeStepping { contact_sweeps: CONVERGED_CONTACT_ITERATIONS, ..stepping }, 0.01)
            }
            MethodKind::Rk4 => (TimeStepping::fixed(Integrator::Rk4, 5e-5), 0.005),
        }
    }
}

/// The runs that measure the speed of a machine: every method with 4, 5 and 6 degrees of freedom a node on the scenario `base`
/// (the 200 m string), one on a large mesh of it, and every method with the wall along the elements.
pub fn calibration_runs(base: &Scenario) -> Vec<CalibrationRun> {
    let run = |method: MethodKind, degrees_of_freedom: usize| {
        let (stepping, duration) = method.sample();
        let mut scenario = Scenario {
            duration,
            accuracy: Accuracy::Explicit(stepping),
            recording: Recording {
                nodes: vec![NodeChoice::Node(49)],
                spectrum_windows: Some(Vec::new()),
                orbit_window: None,
                ..base.recording.clone()
            },
            ..base.clone()
        };
        scenario.effects.torsion = if degrees_of_freedom > 4 { Switch::On } else { Switch::Off };
        scenario.effects.axial_motion = if degrees_of_freedom > 5 { Switch::On } else { Switch::Off };
        CalibrationRun {
            scenario,
            method: method as usize,
            degrees_of_freedom,
            is_large: false,
            is_along_elements: false,
        }
    };
    let mut runs: Vec<_> = MethodKind::ALL
        .into_iter()
        .flat_map(|method| (4..=6).map(move |d| (method, d)))
        .map(|(m, d)| run(m, d))
        .collect();
    let mut large = run(MethodKind::GeneralizedAlpha, 6);
    large.is_large = true;
    large.scenario.scale_mesh(1.0 / LARGE_MESH);
    runs.push(large);
    runs.extend(MethodKind::ALL.map(|method| {
        let mut along = run(method, 6);
        along.is_along_elements = true;
        along.scenario.contact.law = WallLaw::PerLength;
        along
    }));
    runs
}

/// Processor time of a calibration run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunTime {
    /// Nodes of its mesh.
    pub nodes: usize,
    /// Steps made.
    pub steps: u64,
    /// Processor time before the first step \[s\].
    pub start_cpu_time: f64,
    /// Processor time of the steps \[s\].
    pub steps_cpu_time: f64,
}

impl MachineSpeed {
    /// The speed from the equilibrium's processor time for each node \[s\] and those of the calibration runs, in their order.
    pub fn from_times(
        statics_per_node: f64,
        runs: impl IntoIterator<Item = (CalibrationRun, RunTime)>,
    ) -> Self {
        let mut speed = Self {
            statics_per_node,
            start_per_node: [0.0; 4],
            step_per_node: [[0.0; 3]; 4],
            large_mesh_factor: 1.0,
            along_elements: no_difference(),
        };
        for (run, RunTime { nodes, steps, start_cpu_time, steps_cpu_time }) in runs {
            let per_node = steps_cpu_time / (steps as f64 * nodes as f64);
            if run.degrees_of_freedom == 6 && !run.is_large && !run.is_along_elements {
                speed.start_per_node[run.method] = start_cpu_time / nodes as f64;
            }
            let usual = &mut speed.step_per_node[run.method][run.degrees_of_freedom - 4];
            if run.is_large {
                speed.large_mesh_factor = (per_node / *usual).max(1.0);
            } else if run.is_along_elements {
                speed.along_elements[run.method] = (per_node / *usual).max(1.0);
            } else {
                *usual = per_node;
            }
        }
        speed
    }

    /// Processor time of one step \[s\]. Between the two timed meshes the cost of a node grows with the logarithm
    /// of their number; beyond them it stays constant.
    fn step(&self, method: MethodKind, degrees_of_freedom: usize, nodes: usize) -> f64 {
        let nodes = nodes as f64;
        let way = ((nodes / BASE_NODES).ln() / LARGE_MESH.ln()).clamp(0.0, 1.0);
        let per_node = self.step_per_node[method as usize][degrees_of_freedom - 4];
        per_node * nodes * (1.0 + way * (self.large_mesh_factor - 1.0))
    }
}

/// Expected processor time of the rows on a machine of this speed \[s\], and the number of rows that it omits, since
/// their steps adapt themselves.
pub fn expected_cpu_time(rows: &[cost::PlannedRow], speed: &MachineSpeed) -> (f64, usize) {
    let cost = |row: &cost::PlannedRow| {
        let members = f64::from(row.members.end - row.members.start);
        Some(members * Plan::of_line(&row.scenario, Some(speed)).ok()?.cpu_time()?)
    };
    rows.iter().map(cost).fold((0.0, 0), |(time, unknown), cost| match cost {
        Some(cost) => (time + cost, unknown),
        None => (time, unknown + 1),
    })
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{CostStudy, MethodSteps, preset};

    use super::*;
    use drillsweep_sim::control::Control;
    use drillsweep_sim::solve::run::{Outcome, Transient};
    use drillsweep_sim::solve::statics::Equilibrium;
    use drillsweep_sim::validation::validate;

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    #[test]
    fn the_mesh_auto_costs_by_the_accuracy() {
        let mut scenario = preset("paper-200m-damped").unwrap();
        scenario.mesh = Mesh::AUTO;
        let plan = Plan::new(&scenario, None).unwrap();
        assert_eq!(plan.accuracies.len(), 3);
        for planned in &plan.accuracies {
            let accuracy = Accuracy::Preset(AccuracyPreset::named(&planned.name).unwrap());
            let of_its_own = Plan::new(&Scenario { accuracy, ..scenario.clone() }, None).unwrap();
            assert_eq!(planned.elements, of_its_own.elements, "{}", planned.name);
        }
        assert_ne!(plan.accuracies[1].elements, plan.accuracies[2].elements);
        scenario.mesh = Mesh::auto(1.0);
        let plan = Plan::new(&scenario, None).unwrap();
        assert!(plan.accuracies.iter().all(|planned| planned.elements == plan.elements));
    }

    #[test]
    fn parts_of_planning_begin_once_each_and_an_unplanned_run_has_only_the_first() {
        let parts_of = |scenario: &Scenario| {
            let mut parts = Vec::new();
            let plan = Plan::new(scenario, None).unwrap();
            let planned = plan.clone().with_equilibrium_by_parts(scenario, |part| parts.push(part));
            assert_eq!(planned, plan.with_equilibrium(scenario));
            parts
        };
        let mut scenario = paper();
        let [first, others @ ..] = [
            PlanningPart::Equilibrium,
            PlanningPart::Torsion,
            PlanningPart::OtherFriction,
            PlanningPart::Mesh,
        ];
        assert_eq!(parts_of(&scenario), [&[first][..], &others].concat());
        scenario.effects.transient = Switch::Off;
        assert_eq!(parts_of(&scenario), [first]);
    }

    #[test]
    fn planned_steps_and_degrees_of_freedom_are_those_of_the_run() {
        type Change = fn(&mut Scenario);
        let changes: [Change; 4] = [
            |_| {},
            |s| (s.contact.stiffness, s.contact.damping) = (1e8, 1e5),
            |s| s.effects.torsion = Switch::Off,
            |s| s.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Rk4, 6e-5)),
        ];
        for change in changes {
            let mut scenario = paper();
            scenario.duration = 0.02;
            scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Esdirk4, 1e-3));
            scenario.recording.spectrum_windows = Some(Vec::new());
            scenario.recording.orbit_window = None;
            change(&mut scenario);
            let plan = Plan::new(&scenario, None).unwrap();
            let model = Model::new(&scenario).unwrap();
            let run = Transient::new(&model, &Equilibrium::find(&model).unwrap()).unwrap();
            assert_eq!(plan.degrees_of_freedom, run.degrees_of_freedom());
            let Ok(Outcome::Finished(records)) = run.run(&Control::new()) else { panic!("not finished") };
            assert_eq!(plan.accuracies[0].steps, Some(records.effort.steps), "{:?}", plan.accuracies);
            assert_eq!(plan.accuracies[0].cpu_time, None);
        }
    }

    #[test]
    fn cost_is_that_of_the_steps_and_the_equilibrium() {
        let speed = MachineSpeed {
            statics_per_node: 1e-4,
            start_per_node: [2e-5, 0.0, 0.0, 0.0],
            step_per_node: [[1e-7, 2e-7, 3e-7], [1e-6; 3], [2e-6; 3], [5e-7; 3]],
            large_mesh_factor: 2.0,
            along_elements: [1.5, 1.0, 1.0, 1.0],
        };
        let mut scenario = paper();
        scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::GeneralizedAlpha, 5e-4));
        scenario.ensemble = 2;
        let plan = Plan::new(&scenario, Some(&speed)).unwrap();
        let statics = 297.0 * 1e-4;
        assert_eq!(plan.simulated_time, 120.0);
        // The twin goes over 20 s, the orbit window.
        let (start, steps) = (2.0 * 297.0 * 2e-5, 297.0 * (240_000.0 + 40_000.0) * 3e-7);
        assert!((plan.cpu_time().unwrap() - (statics + start + steps)).abs() < 1e-9);
        scenario.contact.law = WallLaw::PerLength;
        let along = Plan::new(&scenario, Some(&speed)).unwrap();
        assert!((along.cpu_time().unwrap() - (statics + start + 1.5 * steps)).abs() < 1e-9);
        scenario.contact.law = WallLaw::PerNode;
        let names: Vec<_> = plan.accuracies.iter().map(|accuracy| accuracy.name.as_str()).collect();
        assert_eq!(names, ["explicit", "draft", "standard", "reference"]);

        scenario.recording.nodes.clear();
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        let profile = Plan::new(&scenario, Some(&speed)).unwrap();
        assert_eq!((profile.degrees_of_freedom, profile.simulated_time), (0, 0.0));
        assert!(profile.accuracies.is_empty());
        assert_eq!(profile.cpu_time(), Some(statics));
    }

    #[test]
    fn a_study_is_planned_with_all_its_runs() {
        let speed = MachineSpeed {
            statics_per_node: 0.0,
            start_per_node: [0.0; 4],
            step_per_node: [[1e-6; 3]; 4],
            large_mesh_factor: 1.0,
            along_elements: [1.0; 4],
        };
        let mut scenario = paper();
        let one = Plan::new(&scenario, Some(&speed)).unwrap();
        assert_eq!(one.study, None);
        let steps = MethodSteps::fixed(Integrator::GeneralizedAlpha, vec![1e-3]);
        scenario.cost_study = Some(CostStudy {
            members: 3,
            presets: vec![],
            methods: Some(vec![steps]),
            ..CostStudy::default()
        });
        let plan = Plan::new(&scenario, Some(&speed)).unwrap();
        let study = plan.study.clone().unwrap();
        // RK4 at a 17th of a millisecond and ESDIRK4 at 0.125 ms make the reference.
        assert_eq!((study.runs, study.simulated_time, study.lines_not_known), (9, 540.0, 0));
        let steps = 3.0 * (60.0 * 17e3 + 60.0 / 1.25e-4 + 60.0 / 1e-3);
        assert!((study.cpu_time.unwrap() / (steps * 297e-6) - 1.0).abs() < 1e-9, "{study:?}");
        assert_eq!(plan.cpu_time(), study.cpu_time);
        // The plan also has one run of the scenario.
        assert_eq!((&plan.accuracies, plan.simulated_time), (&one.accuracies, 60.0));

        let adaptive =
            MethodSteps { tolerance: Some(1e-3), ..MethodSteps::fixed(Integrator::Rk4, vec![1e-4]) };
        scenario.cost_study.as_mut().unwrap().methods = Some(vec![adaptive]);
        let plan = Plan::new(&scenario, Some(&speed)).unwrap();
        assert_eq!((plan.study.as_ref().unwrap().lines_not_known, plan.cpu_time()), (1, None));
    }

    #[test]
    fn calibration_covers_every_method_with_every_number_of_degrees_of_freedom() {
        let mut times = Vec::new();
        for (i, run) in calibration_runs(&paper()).into_iter().enumerate() {
            assert_eq!(validate(&run.scenario), Ok(vec![]));
            let plan = Plan::new(&run.scenario, None).unwrap();
            assert_eq!(plan.degrees_of_freedom, run.degrees_of_freedom);
            assert_eq!(plan.nodes > 1400, run.is_large);
            let per_node = match (run.is_large, run.is_along_elements) {
                (true, _) => 4.5,
                (_, true) => 2.0 * [3.0, 6.0, 9.0, 12.0][run.method],
                _ => (i + 1) as f64,
            };
            let nodes = plan.nodes;
            let (start_cpu_time, steps_cpu_time) = (nodes as f64 * 0.5, per_node * 100.0 * nodes as f64);
            times.push((run, RunTime { nodes, steps: 100, start_cpu_time, steps_cpu_time }));
        }
        let speed = MachineSpeed::from_times(1e-4, times);
        assert_eq!(speed.step_per_node, [[1., 2., 3.], [4., 5., 6.], [7., 8., 9.], [10., 11., 12.]]);
        assert_eq!(speed.start_per_node, [0.5; 4]);
        // Of generalized-alpha with six degrees of freedom: 4.5 after 3.
        assert!((speed.large_mesh_factor - 1.5).abs() < 1e-12);
        assert_eq!(speed.along_elements, [2.0; 4]);
        let step = |nodes| speed.step(MethodKind::GeneralizedAlpha, 6, nodes) / nodes as f64;
        assert_eq!(step(100), 3.0);
        assert!((step(664) - 3.75).abs() < 1e-3, "half way by the logarithm: {}", step(664));
        assert!((step(5000) - 4.5).abs() < 1e-12);
    }
}
