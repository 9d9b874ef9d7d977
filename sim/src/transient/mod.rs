//! The run in time: equation (37) from the equilibrium at rest, unbalance on from t = 0.
//!
//! Tension, torque and the mud's coefficients are frozen at the equilibrium (docs/model/motion.md). A run can be
//! watched, cancelled and suspended through a [`Control`]; a suspended run goes on from its [`Checkpoint`] to the
//! same bits as one that was never interrupted.

mod adaptive;
mod checkpoint;
mod contact_statistics;
mod dense;
mod disturbance;
mod energy;
mod error;
mod esdirk;
mod failure;
mod forces;
mod forms;
mod generalized_alpha;
mod grid;
mod histories;
mod implicit;
mod method;
mod nodal;
mod rk4;
mod run;
mod settle;
mod snapshots;
mod stability;
mod state;
#[cfg(test)]
mod tests;

pub(crate) use adaptive::SMALLEST_MOTION;
pub use checkpoint::{Checkpoint, CheckpointError};
pub use contact_statistics::ContactStatistics;
pub use disturbance::{DISTURBANCE, disturbance};
pub use energy::EnergyRow;
pub use error::ErrorEstimate;
pub use failure::{DivergenceReason, TransientError};
pub use histories::{Histories, NodeHistory, Series};
pub use implicit::SweepMonitor;
pub(crate) use run::{BLOCK_BYTES, LEDGER_RATE_HZ};
pub use run::{Block, Keep};
pub use settle::{MotionRegime, OrbitInterval, Settling, shortest_run, twin_time};
pub(crate) use settle::{
    course_samples, kept_window_at_most, orbit_window_at_most, spectrum_windows_at_most,
};
pub(crate) use snapshots::SNAPSHOT_BLOCK_BYTES;
pub use snapshots::{SnapshotBlock, SnapshotSeries, SnapshotTimes};

use drillsweep_scenario::{AccuracyPreset, Integrator, Problem, Scenario, TimeStepping, TimeWindow};
use grid::Grid;
use run::{Run, Start};
use serde::{Deserialize, Serialize};

use crate::control::Control;
use crate::effect::active_effects;
use crate::freedom::Freedoms;
use crate::model::Model;
use crate::modes::UndampedTorsion;
use crate::signal::Course;
use crate::statics::Equilibrium;

/// A run under way.
pub struct Transient<'m>(Solved<'m>);

/// The run, by how many degrees of freedom of a node move: those that are held along the whole string are not solved for.
enum Solved<'m> {
    Six(Box<Run<'m, 6>>),
    Five(Box<Run<'m, 5>>),
    Four(Box<Run<'m, 4>>),
}

/// Results of a finished run, with its [`Histories`].
#[derive(Debug, Clone, PartialEq)]
pub struct Records<H = Vec<NodeHistory>> {
    /// Recording rate \[Hz\].
    pub rate_hz: f64,
    /// Length of the run \[s\]: the scenario's duration, or where its window is settled at most that.
    pub simulated_time: f64,
    /// Window of the run's statistics, and the verdict on its settling.
    pub settling: Settling,
    /// Motion of the recorded nodes and of the bit at a lower rate: of the whole run where the window is settled, of the window where it
    /// is fixed.
    pub course: Course,
    /// Histories of the recorded nodes.
    pub histories: H,
    /// The run at the start of its orbit window, or a tenth of a second after it; absent where that is the end.
    pub window_start: Option<Box<Checkpoint>>,
    /// Contact statistics of every node.
    pub contacts: Vec<ContactStatistics>,
    /// The energy ledger, ten rows a second and one at the end.
    pub energy: Vec<EnergyRow>,
    /// Bound of the last row's residual \[J\]; a run that exceeds it ends as diverged.
    pub energy_bound: f64,
    /// Residual that rounding alone may leave \[J\]: works below it show nothing.
    pub energy_rounding: f64,
    /// Estimated error of the lateral displacements.
    pub error: ErrorEstimate,
    /// Effort of the run.
    pub effort: TransientEffort,
}

/// Effort of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TransientEffort {
    /// Integrator and step as used.
    pub stepping: TimeStepping,
    /// Parts into which each step was cut so that the contact iterations are stable.
    pub subdivisions: u32,
    /// Steps made.
    pub steps: u64,
    /// Steps that left more than the tolerance and were made again, shorter.
    pub rejected_steps: u64,
    /// Steps of the shortest length that left more than the tolerance.
    pub unresolved_steps: u64,
    /// The shortest and the longest step made \[s\].
    pub step_range: [f64; 2],
    /// Frequency \[Hz\] up to which the longest step resolves a vibration: its period to a thousandth, and its amplitude to a thousandth
    /// in each period.
    pub resolved_hz: f64,
    /// Contact iterations and how far from convergence they ended.
    pub sweeps: SweepMonitor,
}

/// How a call to [`Transient::run`] ended.
#[derive(Debug)]
pub enum Outcome<H = Vec<NodeHistory>> {
    /// The run is complete.
    Finished(Box<Records<H>>),
    /// It was cancelled.
    Cancelled,
    /// It was suspended, and goes on from here; with the samples so far.
    Suspended(Box<Checkpoint>, H),
}

impl<H> Records<H> {
    /// The windows whose spectra are summarised: the scenario's fixed ones, or the end of the settled one.
    pub fn spectrum_windows(&self, scenario: &Scenario) -> Vec<TimeWindow> {
        scenario.spectrum_windows().unwrap_or_else(|| vec![self.settling.kept_window()])
    }
}

impl Records<()> {
    /// The same with the histories that were kept elsewhere.
    pub fn with_histories<H>(self, histories: H) -> Records<H> {
        let Self {
            rate_hz,
            simulated_time,
            settling,
            course,
            histories: (),
            window_start,
            contacts,
            energy,
            energy_bound,
            energy_rounding,
            error,
            effort,
        } = self;
        Records {
            rate_hz,
            simulated_time,
            settling,
            course,
            histories,
            window_start,
            contacts,
            energy,
            energy_bound,
            energy_rounding,
            error,
            effort,
        }
    }
}

impl<'m> Transient<'m> {
    /// A run of `model` from its equilibrium, as its scenario says.
    ///
    /// # Errors
    /// When a matrix is singular or an explicit step is beyond its stability limit.
    pub fn new(model: &'m Model, equilibrium: &Equilibrium) -> Result<Self, TransientError> {
        Self::member(model, equilibrium, 0)
    }

    /// A run of `model` as a member of its ensemble: from the equilibrium (0), or slightly beside it.
    ///
    /// # Errors
    /// As [`Transient::new`].
    pub fn member(model: &'m Model, equilibrium: &Equilibrium, member: u32) -> Result<Self, TransientError> {
        let system = model.dynamic_system(equilibrium);
        let mut rest = disturbance(model, member);
        for (value, at_rest) in rest.iter_mut().flatten().zip(equilibrium.displacement.iter().flatten()) {
            *value += at_rest;
        }
        let resolving_step = resolving_step(model, equilibrium);
        let start = Start { rest, equilibrium, resolving_step };
        Ok(Self(match *system.moving() {
            [a, b, c, d] => {
                Solved::Four(Box::new(Run::new(model, &system, Freedoms::new([a, b, c, d]), start)?))
            }
            [a, b, c, d, e] => {
                Solved::Five(Box::new(Run::new(model, &system, Freedoms::new([a, b, c, d, e]), start)?))
            }
            _ => Solved::Six(Box::new(Run::new(model, &system, Freedoms::ALL, start)?)),
        }))
    }

    /// A run that goes on from a checkpoint of the same scenario.
    ///
    /// # Errors
    /// When the checkpoint belongs to another scenario or model version, or as [`Transient::new`].
    pub fn resume(
        model: &'m Model,
        equilibrium: &Equilibrium,
        checkpoint: &Checkpoint,
    ) -> Result<Self, CheckpointError> {
        let mut transient = Self::new(model, equilibrium)?;
        match &mut transient.0 {
            Solved::Six(run) => run.go_on_from(checkpoint)?,
            Solved::Five(run) => run.go_on_from(checkpoint)?,
            Solved::Four(run) => run.go_on_from(checkpoint)?,
        }
        Ok(transient)
    }

    /// A run that goes on from a checkpoint of the same scenario as the first member of an ensemble starts: beside it by [`DISTURBANCE`]; for
    /// `time` \[s\] or to its end.
    ///
    /// # Errors
    /// As [`Transient::resume`].
    pub fn twin(
        model: &'m Model,
        equilibrium: &Equilibrium,
        checkpoint: &Checkpoint,
        time: f64,
    ) -> Result<Self, CheckpointError> {
        let mut transient = Self::new(model, equilibrium)?;
        let away = disturbance(model, 1);
        match &mut transient.0 {
            Solved::Six(run) => run.go_on_beside(checkpoint, &away, time)?,
            Solved::Five(run) => run.go_on_beside(checkpoint, &away, time)?,
            Solved::Four(run) => run.go_on_beside(checkpoint, &away, time)?,
        }
        Ok(transient)
    }

    /// Degrees of freedom of a node that the run solves for.
    pub fn degrees_of_freedom(&self) -> usize {
        match &self.0 {
            Solved::Six(_) => 6,
            Solved::Five(_) => 5,
            Solved::Four(_) => 4,
        }
    }

    /// Samples of each recorded node that a resumed run has recorded already; 0 at the start.
    pub fn recorded(&self) -> u64 {
        match &self.0 {
            Solved::Six(run) => run.recorded(),
            Solved::Five(run) => run.recorded(),
            Solved::Four(run) => run.recorded(),
        }
    }

    /// Snapshots that a resumed run has taken already; 0 at the start.
    pub fn snapshots_taken(&self) -> u64 {
        match &self.0 {
            Solved::Six(run) => run.snapshots_taken(),
            Solved::Five(run) => run.snapshots_taken(),
            Solved::Four(run) => run.snapshots_taken(),
        }
    }

    /// Samples of each recorded node that the whole run records.
    fn samples(&self) -> u64 {
        match &self.0 {
            Solved::Six(run) => run.samples(),
            Solved::Five(run) => run.samples(),
            Solved::Four(run) => run.samples(),
        }
    }

    /// Runs until the motion has settled, to the end of the scenario's duration, or until `control` stops it, with the histories in memory; snapshots are passed over.
    ///
    /// # Errors
    /// When the motion diverges.
    pub fn run(self, control: &Control) -> Result<Outcome, TransientError> {
        self.run_on(control, Vec::new())
    }

    /// The same for a resumed run, with the histories that it had when it was suspended.
    ///
    /// # Errors
    /// When the motion diverges, or these are not its histories.
    pub fn run_on(
        self,
        control: &Control,
        mut histories: Vec<NodeHistory>,
    ) -> Result<Outcome, TransientError> {
        let recorded = self.recorded() as usize;
        let nodes = self.nodes();
        if recorded == 0 {
            let samples = self.samples() as usize;
            histories = nodes.iter().map(|&node| NodeHistory::with_capacity(node, samples)).collect();
        }
        if histories.nodes() != nodes || (!nodes.is_empty() && histories.samples() != recorded) {
            let detail = format!("a run suspended after {recorded} samples is resumed with others");
            return Err(TransientError::Histories(detail));
        }
        let mut keep = |block: Block<'_>| {
            for (history, block) in histories.iter_mut().zip(block.histories) {
                history.append(block);
            }
            Ok(())
        };
        Ok(match self.run_into(control, &mut keep)? {
            Outcome::Finished(records) => Outcome::Finished(Box::new(records.with_histories(histories))),
            Outcome::Cancelled => Outcome::Cancelled,
            Outcome::Suspended(checkpoint, ()) => Outcome::Suspended(checkpoint, histories),
        })
    }

    /// Runs until the motion has settled, to the end of the scenario's duration, or until `control` stops it; samples and snapshots are handed over to `keep` block by
    /// block, so that the run's memory does not grow with its duration. Before it ends in any way but by an error or a
    /// cancel, all of them are.
    ///
    /// # Errors
    /// When the motion diverges or a block cannot be kept.
    pub fn run_into(self, control: &Control, keep: &mut Keep<'_>) -> Result<Outcome<()>, TransientError> {
        match self.0 {
            Solved::Six(run) => run.run(control, keep),
            Solved::Five(run) => run.run(control, keep),
            Solved::Four(run) => run.run(control, keep),
        }
    }

    /// The recorded nodes, from 0 at the top.
    fn nodes(&self) -> Vec<usize> {
        match &self.0 {
            Solved::Six(run) => recorded_nodes(run.model()),
            Solved::Five(run) => recorded_nodes(run.model()),
            Solved::Four(run) => recorded_nodes(run.model()),
        }
    }
}

/// Steps of a run of the model's scenario with a stepping of its choice: exact for fixed steps, expected for ESDIRK4 with a tolerance, and
/// none for RK4 with one.
pub fn step_count(model: &Model, stepping: TimeStepping) -> Option<u64> {
    let adapts = stepping.tolerance.is_some();
    if adapts && stepping.integrator == Integrator::Rk4 {
        return None;
    }
    let samples = (model.scenario.duration * model.scenario.recording.rate_hz).round() as u64;
    let grid = expected_grid(model, stepping);
    let longest = grid.at_sample(samples).div_ceil(1 << grid.top());
    let effects = &model.effects;
    let sticks =
        adapts && effects.contact && effects.torsion && (effects.friction || effects.friction_torque);
    let of_friction = if sticks { (model.scenario.duration * STEPS_OF_FRICTION).round() as u64 } else { 0 };
    Some(longest + of_friction)
}

/// Frequency \[Hz\] up to which steps of a method resolve a vibration, as [`TransientEffort::resolved_hz`] says: from the methods'
/// amplification of an undamped oscillation.
pub fn resolved_hz(integrator: Integrator, step: f64) -> f64 {
    let angle = match integrator {
        Integrator::Esdirk4 => esdirk::RESOLVED_ANGLE,
        Integrator::GeneralizedAlpha => generalized_alpha::RESOLVED_ANGLE,
        Integrator::Rk4 => rk4::RESOLVED_ANGLE,
    };
    angle / (std::f64::consts::TAU * step)
}

/// The longest step \[s\] of a run that is to resolve the torsion that velocity-weakening friction feeds.
fn resolving_step(model: &Model, equilibrium: &Equilibrium) -> f64 {
    let stepping = model.scenario.accuracy.time_stepping();
    let torsion = if resolves_torsion(&stepping) { UndampedTorsion::about(model, equilibrium) } else { None };
    torsion_step(&stepping, torsion.as_ref())
}

/// The longest step \[s\] that a stepping takes where `torsion` grows: what resolves the highest mode for one that is to resolve it, which
/// adapts its steps to the tolerance of the reference or a smaller one, and no bound for others. Where torsion grows up to
/// the end of the mesh no step resolves it all; what lies beyond [`FINEST_TORSION_STEP`] the method damps.
pub(crate) fn torsion_step(stepping: &TimeStepping, torsion: Option<&UndampedTorsion>) -> f64 {
    match torsion.and_then(UndampedTorsion::resolving_step) {
        Some(step) if resolves_torsion(stepping) => step.max(FINEST_TORSION_STEP),
        _ => f64::INFINITY,
    }
}

fn resolves_torsion(stepping: &TimeStepping) -> bool {
    stepping.integrator == Integrator::Esdirk4
        && stepping.tolerance.is_some_and(|tolerance| {
            tolerance
                <= TimeStepping::promising(AccuracyPreset::Reference.tolerance()).tolerance.unwrap_or(0.0)
        })
}

/// Shortest step \[s\] that torsion alone is a reason for. ESDIRK4 damps torsion above a kilohertz there; with shorter ones single elements, at
/// some kilohertz, grow in a model without stiffness-proportional damping.
const FINEST_TORSION_STEP: f64 = 1.25e-4;

/// The longest step \[s\] that a run of the model's scenario is expected to make with a stepping of its choice.
pub fn longest_step(model: &Model, stepping: TimeStepping) -> f64 {
    if stepping.integrator == Integrator::Rk4 {
        return stepping.step;
    }
    let grid = expected_grid(model, stepping);
    grid.step(grid.top())
}

fn expected_grid(model: &Model, stepping: TimeStepping) -> Grid {
    let subdivisions = stability::expected_subdivisions(model, &stepping);
    Grid::new(1.0 / model.scenario.recording.rate_hz, stepping.step / f64::from(subdivisions), 0)
}

/// Steps a second \[1/s\] that a run which adapts them makes beyond those of the longest length if nodes stick and slip: 50 to 190 in the damped
/// scenarios at any accuracy, none in that of 1,000 m.
const STEPS_OF_FRICTION: f64 = 110.0;

/// The largest stable step of RK4 \[s\] for a model about its equilibrium.
///
/// # Errors
/// When the mass matrix is singular.
pub fn rk4_stability_limit(model: &Model, equilibrium: &Equilibrium) -> Result<f64, TransientError> {
    Ok(stability::rk4_limit(model, &model.dynamic_system(equilibrium))?)
}

/// Problem with the step of a valid scenario: a fixed step of the explicit method beyond its stability limit. Checked
/// before a run is queued; it takes an equilibrium and some hundred products, and nothing for the other methods.
pub fn step_problem(scenario: &Scenario) -> Option<Problem> {
    let stepping = scenario.accuracy.time_stepping();
    if stepping.integrator != Integrator::Rk4
        || stepping.tolerance.is_some()
        || !active_effects(scenario).transient
    {
        return None;
    }
    let model = Model::new(scenario).ok()?;
    let limit = rk4_stability_limit(&model, &Equilibrium::find(&model).ok()?).ok()?;
    (stepping.step > limit).then(|| {
        let valid = format!(
            "must be at most {limit:.3e} s, the stability limit of rk4 for this mesh; or give a tolerance, or take esdirk4, which has \
             none"
        );
        Problem::new("accuracy.step", stepping.step.to_string(), valid)
    })
}

/// The nodes whose histories a scenario wants, from 0.
pub fn recorded_nodes(model: &Model) -> Vec<usize> {
    model.scenario.recording.nodes.iter().filter_map(|&choice| model.mesh.chosen_node(choice)).collect()
}

/// The bit, from 0 at the top, where its rotation and torque are recorded beside the histories: where torsion is solved for, any node is
/// recorded, and the bit is none of them.
pub fn bit_beside(model: &Model) -> Option<usize> {
    let nodes = recorded_nodes(model);
    let bit = model.node_count().checked_sub(1)?;
    (model.effects.torsion && !nodes.is_empty() && !nodes.contains(&bit)).then_some(bit)
}
