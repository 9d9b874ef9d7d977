//! Throttle of periodic looks into the database.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often those who claim look whether a lease has run out or a retry is due, as long as there is other work, and those who read
/// whether a process has died before it had done what follows from a change: looking costs as much as claiming or reading.
pub(crate) const LOOK_EVERY: Duration = Duration::from_secs(1);

/// Throttle of looks for something to do that nobody notified a process of: one a [`LOOK_EVERY`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Throttle(Arc<Mutex<Option<Instant>>>);

impl Throttle {
    /// Whether it is time to look again, now.
    pub(crate) fn is_due(&self) -> bool {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = last.is_none_or(|last| last.elapsed() >= LOOK_EVERY);
        if is_due {
            *last = Some(Instant::now());
        }
        is_due
    }
}
