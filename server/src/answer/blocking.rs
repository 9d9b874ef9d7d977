//! Work that takes the processor.

use crate::answer::error::{Error, Result};

/// Runs what takes the processor for longer than a request may hold a thread of the runtime.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> Result<T> {
    tokio::task::spawn_blocking(work).await.map_err(|error| Error::internal(&error))?
}
