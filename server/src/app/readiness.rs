//! Result of the last check of the store.

use tokio::sync::Mutex;
use tokio::time::Instant;

/// Time of the last successful check.
#[derive(Default)]
pub(crate) struct Readiness(pub(crate) Mutex<Option<Instant>>);
