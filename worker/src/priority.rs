//! Priority of the threads that compute: on Linux each thread has a niceness of its own, which the threads that it starts inherit.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::Builder;

use rustix::process::{getpriority_process, setpriority_process};
use rustix::thread::gettid;
use tokio::sync::oneshot;

/// Added to the niceness of a computing thread: the heartbeat, claims, the store and a server on the same machine take precedence.
const NICENESS: i32 = 10;

/// Reasons why a computation returned nothing.
#[derive(Debug)]
pub(crate) enum NotComputed {
    /// Its thread cannot be started.
    NotStarted(io::Error),
    /// It panicked.
    Panicked(Box<dyn Any + Send>),
}

/// Runs a computation at low priority, on a thread of its own: those of the async runtime are shared with input and output, and a
/// process without privileges cannot raise a thread's priority again.
pub(crate) async fn compute_at_low_priority<T: Send + 'static>(
    computation: impl FnOnce() -> T + Send + 'static,
) -> Result<T, NotComputed> {
    let (sender, computed) = oneshot::channel();
    let compute = move || {
        lower();
        // The receiver may be gone: nobody waits for the result.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(computation)));
    };
    Builder::new().name("compute".to_owned()).spawn(compute).map_err(NotComputed::NotStarted)?;
    match computed.await {
        Ok(computed) => computed.map_err(NotComputed::Panicked),
        Err(dropped) => Err(NotComputed::Panicked(Box::new(dropped.to_string()))),
    }
}

/// Number of threads of a parallel computation, which are started at low priority if there are none.
pub(crate) fn parallel_threads() -> usize {
    // An error says that they have been started.
    let _ = rayon::ThreadPoolBuilder::new().start_handler(|_| lower()).build_global();
    rayon::current_num_threads()
}

/// Lowers the priority of this thread.
fn lower() {
    let thread = Some(gettid());
    let lowered =
        getpriority_process(thread).and_then(|niceness| setpriority_process(thread, niceness + NICENESS));
    if let Err(error) = lowered {
        tracing::warn!(%error, "a computing thread cannot lower its priority");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_that_compute_alone_are_of_low_priority() {
        let niceness = || getpriority_process(Some(gettid())).unwrap();
        let usual = niceness();
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        let low = (usual + NICENESS).min(19);
        assert_eq!(runtime.block_on(compute_at_low_priority(niceness)).unwrap(), low);
        parallel_threads();
        assert!(rayon::broadcast(|_| niceness()).iter().all(|found| *found == low));
        assert_eq!(niceness(), usual);
    }

    #[test]
    fn panic_of_a_computation_is_returned() {
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        let panicking = compute_at_low_priority(|| assert!(std::hint::black_box(false), "as it must"));
        let Err(NotComputed::Panicked(panic)) = runtime.block_on(panicking) else { panic!("it returned") };
        assert_eq!(panic.downcast_ref::<&str>(), Some(&"as it must"));
    }
}
