//! A run's whole state as bytes.

use serde::{Deserialize, Serialize};

use super::{Progress, TransientError};
use crate::PHYSICS_VERSION;
use crate::scenario::Scenario;

/// Everything that a suspended run needs to go on to the same bits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    physics_version: u32,
    scenario: Vec<u8>,
    progress: Progress,
}

/// Why a checkpoint cannot be used.
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
    pub(super) fn new(scenario: &Scenario, progress: Progress) -> Self {
        Self { physics_version: PHYSICS_VERSION, scenario: scenario.canonical_bytes(), progress }
    }

    /// The checkpoint as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        postcard::to_stdvec(self).expect("numbers and vectors always encode")
    }

    /// A checkpoint from bytes.
    ///
    /// # Errors
    /// When the bytes are not a checkpoint.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        Ok(postcard::from_bytes(bytes)?)
    }

    pub(super) fn progress_for(self, scenario: &Scenario) -> Result<Progress, CheckpointError> {
        if self.physics_version != PHYSICS_VERSION {
            return Err(CheckpointError::OtherPhysicsVersion { found: self.physics_version });
        }
        if self.scenario != scenario.canonical_bytes() {
            return Err(CheckpointError::OtherScenario);
        }
        Ok(self.progress)
    }
}
