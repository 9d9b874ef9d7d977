//! Errors of a point's computation.

use drillsweep_scenario::{FailureClass, PointError, StartFriction};
use drillsweep_sim::solve::model::ModelError;
use drillsweep_sim::solve::modes::Stability;
use drillsweep_sim::solve::run::TransientError;
use drillsweep_sim::solve::statics::StaticsError;
use drillsweep_study::cost::StudyError;
use serde_json::{Map, json};

use crate::encode::ArtifactError;

/// Errors that leave a point without a result.
#[derive(Debug, thiserror::Error)]
pub enum ComputeError {
    /// The scenario cannot be read or is out of range; the server refuses such requests, so it is of another version.
    #[error("the scenario is not valid: {0}")]
    Invalid(String),
    /// No model can be built.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// There is no equilibrium.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// There is no equilibrium to start the second of two compared runs from.
    #[error("equilibrium of the start with friction {}: {error}", .friction.name())]
    OtherStart {
        /// Its friction.
        friction: StartFriction,
        /// Its error.
        error: StaticsError,
    },
    /// The run in time cannot be set up.
    #[error(transparent)]
    Transient(TransientError),
    /// The run in time failed, with whether the scenario's own instability explains it.
    #[error("{error}; {}", verdict(.error, .stability.as_deref()))]
    Run {
        /// Observed failure.
        error: TransientError,
        /// The verdict of the linearised equations; absent if they could not be judged.
        stability: Option<Box<Stability>>,
    },
    /// A cost study has no reference to compare with.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// Recordings cannot be written or read back.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// It takes more memory than this worker may have.
    #[error("it needs about {:.1} GB of memory; the worker's limit is {:.1} GB", *.needed as f64 / 1e9, *.limit as f64 / 1e9)]
    TooLarge {
        /// Memory that it takes \[bytes\].
        needed: u64,
        /// Memory that the worker may have \[bytes\].
        limit: u64,
    },
    /// Its thread cannot be started.
    #[error("its thread cannot be started: {0}")]
    Thread(#[source] std::io::Error),
    /// It was asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// Verdict in words on an instability of the scenario as the cause of a failed run.
fn verdict(error: &TransientError, stability: Option<&Stability>) -> String {
    match (error, stability) {
        (TransientError::Diverged { time, .. }, Some(stability)) => stability.of_divergence_at(*time),
        (_, Some(stability)) => stability.to_string(),
        (_, None) => {
            "the modes about the equilibrium, which would show an instability, were not found".into()
        }
    }
}

impl ComputeError {
    /// True if another worker may get a result: one of a newer version, with a repaired database, with room on its disk, or with more memory.
    pub(crate) fn is_of_this_worker(&self) -> bool {
        matches!(
            self,
            ComputeError::Invalid(_)
                | ComputeError::Artifact(_)
                | ComputeError::TooLarge { .. }
                | ComputeError::Thread(_)
                | ComputeError::Transient(TransientError::Histories(_))
        )
    }

    /// The error as the service shows it: class, reason, and time and node if there are any.
    pub fn to_point_error(&self) -> PointError {
        let class =
            if self.is_of_this_worker() { FailureClass::Infrastructure } else { FailureClass::Physical };
        let error = PointError::new(class, self.to_string());
        let number = |node: Option<usize>| node.and_then(|node| u32::try_from(node).ok());
        match self {
            ComputeError::Run { error: failure, stability } => {
                let (time, node) = match failure {
                    TransientError::Diverged { time, node, .. } => (Some(*time), number(Some(*node))),
                    _ => (None, None),
                };
                let explains = |stability: &Stability| Some(stability.explains_divergence_at(time?));
                let is_explained = stability.as_deref().and_then(explains);
                let details = Map::from_iter([
                    ("stability".to_owned(), json!(stability)),
                    ("is_explained_by_instability".to_owned(), json!(is_explained)),
                ]);
                PointError { time, node, details, ..error }
            }
            // A failure before the first step has the time of that step.
            ComputeError::Statics(failure) | ComputeError::OtherStart { error: failure, .. } => {
                PointError { time: Some(0.0), node: number(Some(failure.node())), ..error }
            }
            ComputeError::Transient(failure) => {
                PointError { time: Some(0.0), node: number(failure.node()), ..error }
            }
            _ => error,
        }
    }
}
