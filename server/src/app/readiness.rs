//! Whether the store works, as far as anybody has looked.

use tokio::sync::Mutex;
use tokio::time::Instant;

/// When the store was last seen to work.
#[derive(Default)]
pub(crate) struct Readiness(pub(crate) Mutex<Option<Instant>>);
