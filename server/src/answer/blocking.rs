//! Work that must not end with the request, or that takes the processor.

use drillsweep_store::StoreError;

use crate::answer::error::{Error, Result};

/// Does in the store what takes several steps, to its end even if the client goes away meanwhile.
pub(crate) async fn to_the_end<T: Send + 'static>(
    work: impl Future<Output = Result<T, StoreError>> + Send + 'static,
) -> Result<T> {
    Ok(tokio::spawn(work).await.map_err(|error| Error::internal(&error))??)
}

/// Runs what takes the processor for longer than a request may hold a thread of the runtime.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> Result<T> {
    tokio::task::spawn_blocking(work).await.map_err(|error| Error::internal(&error))?
}
