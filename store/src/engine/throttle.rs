//! Throttle of periodic looks into the database.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Interval at which claims look for expired leases and due retries, as long as there is other work, and reads look for changes
/// whose consequences a dead process has left undone: looking costs as much as claiming or reading.
pub(crate) const LOOK_EVERY: Duration = Duration::from_secs(1);

/// Throttle of searches for work without a notification: one a [`LOOK_EVERY`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Throttle(Arc<Mutex<Option<Instant>>>);

impl Throttle {
    /// True if a look is due now.
    pub(crate) fn is_due(&self) -> bool {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = last.is_none_or(|last| last.elapsed() >= LOOK_EVERY);
        if is_due {
            *last = Some(Instant::now());
        }
        is_due
    }
}
