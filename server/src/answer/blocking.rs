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

/// Lowers the priority of threads that write large answers, so that short ones do not wait for them: as much as workers do.
const NICENESS: i32 = 10;

/// Starts what writes a large answer on a thread of its own, which gives way to the threads that answer short requests.
pub(crate) fn beside(work: impl FnOnce() + Send + 'static) -> Result<()> {
    let thread = std::thread::Builder::new().name("large-answer".to_owned());
    let spawned = thread.spawn(|| {
        // Only Linux gives a thread a niceness of its own; elsewhere it is that of the process. The answer is written without it, too.
        if cfg!(target_os = "linux") {
            let _ = rustix::process::nice(NICENESS);
        }
        work();
    });
    spawned.map(drop).map_err(|_| Error::unavailable("no further thread can be started"))
}
