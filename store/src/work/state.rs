//! The state machine of work: states of work items, transitions, and counts of a sweep's points by state.

use crate::error::{Result, StoreError};

/// Content hash of a point: equal keys, equal results.
pub type WorkKey = [u8; 32];

/// State of a work item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WorkState {
    /// A retry that is not due yet.
    Waiting,
    /// Ready to be claimed.
    Queued,
    /// A worker has it.
    Leased,
    /// Its result is stored.
    Done,
    /// It ended without a result, for good.
    Failed,
    /// Its workers died too often.
    Dead,
    /// No sweep needs it any more.
    Cancelled,
}

/// A work item's state as far as the sweeps that have it count it: the database's column `stage`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Waiting for a retry or for a worker.
    Queued,
    /// Under way.
    Running,
    /// With a result.
    Done,
    /// Failed, or dead because workers died on it.
    Failed,
    /// Cancelled.
    Cancelled,
}

/// A way from one state to another. The database refuses all others, by a trigger.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The state before.
    pub from: WorkState,
    /// The state after.
    pub to: WorkState,
    /// Event that causes it.
    pub cause: &'static str,
}

/// All transitions from one state to another. Work that was to be recomputed and ends without a new result goes back to done,
/// since the result from before stays.
pub const TRANSITIONS: &[Transition] = {
    use WorkState::{Cancelled, Dead, Done, Failed, Leased, Queued, Waiting};
    &[
        Transition { from: Queued, to: Leased, cause: "a worker claims it" },
        Transition { from: Queued, to: Cancelled, cause: "no sweep wants it any more" },
        Transition {
            from: Queued,
            to: Done,
            cause: "its earlier result stays, since no sweep wants it or no worker computes it any more",
        },
        Transition { from: Queued, to: Failed, cause: "no worker computes its physics version any more" },
        Transition { from: Leased, to: Done, cause: "its result is stored, or its earlier one stays" },
        Transition {
            from: Leased,
            to: Failed,
            cause: "the simulation failed or took too long, or the infrastructure failed a fifth time",
        },
        Transition { from: Leased, to: Dead, cause: "a third worker died" },
        Transition { from: Leased, to: Cancelled, cause: "it stops, and no sweep wants it any more" },
        Transition { from: Leased, to: Waiting, cause: "the infrastructure failed" },
        Transition { from: Leased, to: Queued, cause: "the worker gives it back or dies" },
        Transition { from: Waiting, to: Queued, cause: "the retry is due" },
        Transition { from: Waiting, to: Cancelled, cause: "no sweep wants it any more" },
        Transition {
            from: Waiting,
            to: Done,
            cause: "its earlier result stays, since no sweep wants it or no worker computes it any more",
        },
        Transition { from: Waiting, to: Failed, cause: "no worker computes its physics version any more" },
        Transition {
            from: Done,
            to: Queued,
            cause: "a sweep requests to recompute it, or a table of its result is lost",
        },
        Transition { from: Failed, to: Queued, cause: "retried, or a sweep requests to recompute it" },
        Transition { from: Dead, to: Queued, cause: "retried, or a sweep requests to recompute it" },
        Transition { from: Cancelled, to: Queued, cause: "retried, or a sweep wants it" },
    ]
};

/// Points of a sweep by the stage of their work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StateCounts {
    /// All points.
    pub total: i64,
    /// At [`Stage::Queued`].
    pub queued: i64,
    /// At [`Stage::Running`].
    pub running: i64,
    /// At [`Stage::Done`].
    pub done: i64,
    /// At [`Stage::Failed`].
    pub failed: i64,
    /// At [`Stage::Cancelled`].
    pub cancelled: i64,
}

impl StateCounts {
    /// Number of those whose state does not change by itself.
    pub(crate) fn final_ones(&self) -> i64 {
        self.done + self.failed + self.cancelled
    }
}

impl Stage {
    /// True if work at this stage is open: still to be computed, or under way. The state of other work is final, and changes
    /// only on request. The database's column `is_open`.
    pub fn is_open(self) -> bool {
        matches!(self, Stage::Queued | Stage::Running)
    }

    /// The name in the database.
    pub fn as_str(self) -> &'static str {
        match self {
            Stage::Queued => "queued",
            Stage::Running => "running",
            Stage::Done => "done",
            Stage::Failed => "failed",
            Stage::Cancelled => "cancelled",
        }
    }
}

impl WorkState {
    /// All of them.
    pub const ALL: [WorkState; 7] = [
        WorkState::Waiting,
        WorkState::Queued,
        WorkState::Leased,
        WorkState::Done,
        WorkState::Failed,
        WorkState::Dead,
        WorkState::Cancelled,
    ];

    /// Stage as which sweeps count the work.
    pub fn stage(self) -> Stage {
        match self {
            WorkState::Waiting | WorkState::Queued => Stage::Queued,
            WorkState::Leased => Stage::Running,
            WorkState::Done => Stage::Done,
            WorkState::Failed | WorkState::Dead => Stage::Failed,
            WorkState::Cancelled => Stage::Cancelled,
        }
    }

    /// True if there is a [transition](TRANSITIONS) to another state.
    pub fn may_become(self, other: WorkState) -> bool {
        TRANSITIONS.iter().any(|transition| transition.from == self && transition.to == other)
    }

    /// The name in the database.
    pub fn as_str(self) -> &'static str {
        match self {
            WorkState::Waiting => "waiting",
            WorkState::Queued => "queued",
            WorkState::Leased => "leased",
            WorkState::Done => "done",
            WorkState::Failed => "failed",
            WorkState::Dead => "dead",
            WorkState::Cancelled => "cancelled",
        }
    }

    pub(crate) fn parse(text: &str) -> Result<Self> {
        WorkState::ALL
            .into_iter()
            .find(|state| state.as_str() == text)
            .ok_or_else(|| StoreError::Corrupt(format!("work state {text:?}")))
    }
}

pub(crate) fn work_key(bytes: &[u8]) -> Result<WorkKey> {
    bytes.try_into().map_err(|_| StoreError::Corrupt(format!("work key of {} bytes", bytes.len())))
}
