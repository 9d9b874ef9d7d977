//! Work that must not end with its request, or that occupies a processor.

use drillsweep_store::StoreError;

use crate::answer::error::{Error, Result};

/// Completes an operation of several steps in the store, even if the client goes away meanwhile.
pub(crate) async fn to_the_end<T: Send + 'static>(
    work: impl Future<Output = Result<T, StoreError>> + Send + 'static,
) -> Result<T> {
    Ok(tokio::spawn(work).await.map_err(|error| Error::internal(&error))??)
}

/// Runs work that occupies a processor for longer than a request may hold a thread of the runtime.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> Result<T> {
    tokio::task::spawn_blocking(work).await.map_err(|error| Error::internal(&error))?
}

/// Niceness of threads that write large answers, so that short ones do not wait for them; the same as of workers.
const NICENESS: i32 = 10;

/// Starts a thread of low priority that writes a large answer.
pub(crate) fn beside(work: impl FnOnce() + Send + 'static) -> Result<()> {
    let thread = std::thread::Builder::new().name("large-answer".to_owned());
    let spawned = thread.spawn(|| {
        // Only Linux has a niceness by thread; elsewhere it would change the whole process.
        if cfg!(target_os = "linux") {
            let _ = rustix::process::nice(NICENESS);
        }
        work();
    });
    spawned.map(drop).map_err(|_| Error::unavailable("no further thread can be started"))
}
