//! A run by the number of degrees of freedom of its nodes.

use super::checkpoint::{Checkpoint, CheckpointError};
use super::disturbance::disturbance;
use super::histories::{Histories, NodeHistory};
use super::recorded::recorded_nodes;
use super::records::Outcome;
use super::step_loop::{Block, Keep, Run, Start};
use crate::control::Control;
use crate::math::dof::Dofs;
use crate::solve::model::Model;
use crate::solve::statics::Equilibrium;
use crate::solve::step::{TransientError, choice};

/// A run in progress.
pub struct Transient<'m>(pub(super) Solved<'m>);

/// The run, by the number of moving degrees of freedom of a node: those that are held along the whole string are not solved for.
pub(super) enum Solved<'m> {
    Six(Box<Run<'m, 6>>),
    Five(Box<Run<'m, 5>>),
    Four(Box<Run<'m, 4>>),
}

impl<'m> Transient<'m> {
    /// A run of `model` from its equilibrium.
    ///
    /// # Errors
    /// A matrix is singular or an explicit step is beyond its stability limit.
    pub fn new(model: &'m Model, equilibrium: &Equilibrium) -> Result<Self, TransientError> {
        Self::member(model, equilibrium, 0)
    }

    /// A run of `model` as a member of its ensemble: from the equilibrium (0), or from a start disturbed slightly.
    ///
    /// # Errors
    /// As [`Transient::new`].
    pub fn member(model: &'m Model, equilibrium: &Equilibrium, member: u32) -> Result<Self, TransientError> {
        let system = model.dynamic_system(equilibrium);
        let mut rest = disturbance(model, member);
        for (value, at_rest) in rest.iter_mut().flatten().zip(equilibrium.displacement.iter().flatten()) {
            *value += at_rest;
        }
        let resolving_step = choice::resolving_step(model, equilibrium);
        let start = Start { rest, equilibrium, resolving_step };
        Ok(Self(match *system.moving() {
            [a, b, c, d] => Solved::Four(Box::new(Run::new(model, &system, Dofs::new([a, b, c, d]), start)?)),
            [a, b, c, d, e] => {
                Solved::Five(Box::new(Run::new(model, &system, Dofs::new([a, b, c, d, e]), start)?))
            }
            _ => Solved::Six(Box::new(Run::new(model, &system, Dofs::ALL, start)?)),
        }))
    }

    /// A run that continues from a checkpoint of the same scenario.
    ///
    /// # Errors
    /// The checkpoint belongs to another scenario or model version, or [`Transient::new`] fails.
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

    /// A run that continues from a checkpoint of the same scenario, displaced by [`DISTURBANCE`](super::DISTURBANCE) as the start of the first member of an ensemble, for
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

    /// Runs until the motion has settled, to the end of the scenario's duration, or until `control` stops it, with the histories in memory; snapshots
    /// are not kept.
    ///
    /// # Errors
    /// The motion diverges.
    pub fn run(self, control: &Control) -> Result<Outcome, TransientError> {
        self.run_on(control, Vec::new())
    }

    /// The same for a resumed run, with the histories that it had when it was suspended.
    ///
    /// # Errors
    /// The motion diverges, or the histories belong to another run.
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

    /// Runs until the motion has settled, to the end of the scenario's duration, or until `control` stops it. Samples and snapshots are handed over
    /// to `keep` block by block, so that the run's memory does not grow with its duration. All of them are handed over before the run ends, except by
    /// an error or a cancellation.
    ///
    /// # Errors
    /// The motion diverges or a block cannot be kept.
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
