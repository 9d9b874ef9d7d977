//! Interface of the methods of integration in time.

use super::adaptive::Tolerances;
use super::energy::Ledger;
use super::error_estimate::ErrorSum;
use super::forces::{ActingForces, Forces};
use super::grid::Grid;
use super::implicit::ContactIterations;
use super::state::State;
use crate::math::linalg::{Four, NodalField};

/// A method of integration in time.
pub(crate) trait Method<const D: usize> {
    /// Advances `state`, whose forces are `acting`, by one step of the level ahead or of a lower one.
    ///
    /// # Errors
    /// No step is short enough.
    fn advance(
        &mut self,
        forces: &Forces<D>,
        ahead: StepAhead<'_>,
        state: &mut State<D>,
        acting: &ActingForces,
        books: Books<'_, D>,
    ) -> Result<StepMade, StepCollapsed>;

    /// Largest normal forces of nodes within the last step \[N\], four side by side; empty if they are those of its ends.
    fn peaks(&self) -> &[Four] {
        &[]
    }

    /// Displacements, velocities and accelerations at the start of the last step, for interpolation of the motion up to its end; absent if steps
    /// end at every sample.
    fn start_of_step(&self) -> Option<[&NodalField<D>; 3]> {
        None
    }
}

/// Step to make.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepAhead<'a> {
    /// Time at its start \[s\].
    pub(crate) time: f64,
    /// Level of the grid, the highest that is allowed.
    pub(crate) level: u32,
    pub(crate) grid: &'a Grid,
    /// Present if the step adapts itself.
    pub(crate) tolerances: Option<&'a Tolerances>,
}

/// Step made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepMade {
    /// Level of the grid.
    pub(crate) level: u32,
    /// Level of the next step that the error suggests; absent with fixed steps.
    pub(crate) next_level: Option<u32>,
    /// Steps within it.
    pub(crate) steps: u64,
    /// The shortest and the longest of them \[s\].
    pub(crate) step_range: [f64; 2],
    /// Steps that left more than the tolerance and were made again.
    pub(crate) rejected: u64,
    /// Steps of the shortest length that left more than the tolerance.
    pub(crate) unresolved: u64,
    pub(crate) iterations: ContactIterations,
}

/// A step of an adaptive method became too short.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepCollapsed;

/// Books that a step's work and error are entered in.
pub(crate) struct Books<'a, const D: usize> {
    pub(crate) ledger: &'a mut Ledger<D>,
    pub(crate) errors: &'a mut ErrorSum,
}
