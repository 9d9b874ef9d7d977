//! Leases: rights to write about work items.

use crate::engine::query::{Query, query};
use crate::engine::sql;
use crate::work::state::WorkKey;

/// The right to write about one work item: void once it is claimed again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lease {
    /// The work item.
    pub key: WorkKey,
    /// Grows with every claim of the work item: a write under an older one changes nothing.
    pub fencing_token: i64,
    /// The worker that holds it.
    pub worker: String,
}

/// Outcome of a lease renewal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Renewal {
    /// The lease is extended.
    Held,
    /// The lease is extended, and a cancellation is requested.
    CancelRequested,
    /// The work item was claimed again: nothing that is computed now will be taken.
    Lost,
}

impl Lease {
    /// Statement that extends it: returns the cancel flag; no row if it is lost.
    pub(crate) fn renewing(&self, lease_ms: i64, progress: f64) -> Query {
        query(sql::lease::RENEW)
            .bind(self.key.as_slice())
            .bind(self.fencing_token)
            .bind(&self.worker)
            .bind(progress)
            .bind(lease_ms)
    }
}

impl Renewal {
    /// Outcome from the cancel flag of a renewal; `None` means that the lease was lost.
    pub(crate) fn of(cancel_requested: Option<bool>) -> Self {
        match cancel_requested {
            None => Renewal::Lost,
            Some(false) => Renewal::Held,
            Some(true) => Renewal::CancelRequested,
        }
    }
}
