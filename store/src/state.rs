//! Where a work item stands, and how many points of a sweep stand where.

use crate::error::{Result, StoreError};

/// Content hash of a point: equal keys, equal results.
pub type WorkKey = [u8; 32];

/// Where a work item stands.
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
    /// Nobody wants it any more.
    Cancelled,
}

/// Points of a sweep by the state of their work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StateCounts {
    /// All points.
    pub total: i64,
    /// Waiting for a retry or for a worker.
    pub queued: i64,
    /// Under way.
    pub running: i64,
    /// With a result.
    pub done: i64,
    /// Failed, or given up because workers died.
    pub failed: i64,
    /// Cancelled.
    pub cancelled: i64,
}

impl StateCounts {
    /// Those whose state will not change by itself.
    pub(crate) fn final_ones(&self) -> i64 {
        self.done + self.failed + self.cancelled
    }
}

impl WorkState {
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
        Ok(match text {
            "waiting" => WorkState::Waiting,
            "queued" => WorkState::Queued,
            "leased" => WorkState::Leased,
            "done" => WorkState::Done,
            "failed" => WorkState::Failed,
            "dead" => WorkState::Dead,
            "cancelled" => WorkState::Cancelled,
            other => return Err(StoreError::Corrupt(format!("work state {other:?}"))),
        })
    }
}

pub(crate) fn work_key(bytes: &[u8]) -> Result<WorkKey> {
    bytes.try_into().map_err(|_| StoreError::Corrupt(format!("work key of {} bytes", bytes.len())))
}
