//! A run's whole state as bytes.

use drillsweep_scenario::Scenario;
use serde::{Deserialize, Serialize};

use super::contact_statistics::ContactStatistics;
use super::loads::LoadBlocks;
use crate::PHYSICS_VERSION;
use crate::key::canonical_json;
use crate::math::signal::Course;
use crate::solve::step::error_estimate::ErrorSum;
use crate::solve::step::state::State;
use crate::solve::step::work::Work;
use crate::solve::step::{ContactIterations, EnergyRow, TransientError};

/// State of a run without its scratch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Progress<const D: usize> {
    /// Ticks of the grid completed.
    pub(super) ticks: u64,
    /// Wanted level of the next step.
    pub(super) level: u32,
    /// The highest level that the energy ledger allows.
    pub(super) ceiling: u32,
    pub(super) state: State<D>,
    pub(super) work: Work,
    pub(super) iterations: ContactIterations,
    pub(super) errors: ErrorSum,
    pub(super) rejected: u64,
    /// Steps of the shortest length that left more than the tolerance.
    pub(super) unresolved: u64,
    /// The shortest and the longest step made \[s\].
    pub(super) step_range: [f64; 2],
    pub(super) steps: u64,
    pub(super) contacts: Vec<ContactStatistics>,
    pub(super) energy: Vec<EnergyRow>,
    /// Loads of the last ninety seconds, or of a fixed window.
    pub(super) loads: LoadBlocks,
    /// Motion that shows whether the run has settled.
    pub(super) course: Course,
    /// Starts of the run's twin, with their ticks, the earliest first: at the start of a fixed orbit window, or every ten seconds of the longest
    /// settled one.
    pub(super) twin_starts: Vec<(u64, Checkpoint)>,
}

/// State from which a suspended run continues to the same bits, without its recorded samples: the caller keeps both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    physics_version: u32,
    scenario: String,
    /// Encoded progress, for the degrees of freedom that the scenario solves for.
    progress: Vec<u8>,
}

/// Reason for which a checkpoint cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CheckpointError {
    /// The bytes are not a checkpoint.
    #[error("not a checkpoint: {0}")]
    Malformed(#[from] postcard::Error),
    /// Written by a version of the model with other numbers.
    #[error("the checkpoint is of physics version {found}, this program has {PHYSICS_VERSION}")]
    OtherPhysicsVersion {
        /// The checkpoint's version.
        found: u32,
    },
    /// Written for another scenario.
    #[error("the checkpoint belongs to another scenario")]
    OtherScenario,
    /// The run itself cannot be set up.
    #[error(transparent)]
    Run(#[from] TransientError),
}

impl Checkpoint {
    pub(super) fn new<const D: usize>(scenario: &Scenario, progress: &Progress<D>) -> Self {
        Self {
            physics_version: PHYSICS_VERSION,
            scenario: canonical_json(scenario),
            progress: encoded(progress),
        }
    }

    /// The checkpoint as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        encoded(self)
    }

    /// A checkpoint from bytes.
    ///
    /// # Errors
    /// The bytes are not a checkpoint.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        Ok(postcard::from_bytes(bytes)?)
    }

    /// The progress in it, if it is of this scenario and of a string of `nodes` nodes.
    pub(super) fn progress_for<const D: usize>(
        &self,
        scenario: &Scenario,
        nodes: usize,
    ) -> Result<Progress<D>, CheckpointError> {
        if self.physics_version != PHYSICS_VERSION {
            return Err(CheckpointError::OtherPhysicsVersion { found: self.physics_version });
        }
        if self.scenario != canonical_json(scenario) {
            return Err(CheckpointError::OtherScenario);
        }
        let progress: Progress<D> = postcard::from_bytes(&self.progress)?;
        let State { displacement, velocity, acceleration, .. } = &progress.state;
        let lengths = [displacement.nodes(), velocity.nodes(), acceleration.nodes(), progress.contacts.len()];
        if lengths != [nodes; 4] {
            return Err(CheckpointError::OtherScenario);
        }
        Ok(progress)
    }
}

fn encoded(value: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(value).expect("numbers and vectors always encode")
}
