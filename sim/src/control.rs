//! The handle by which a caller watches and stops a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Shared between a run and its observers. A run reads it once every recording interval.
///
/// Several runs that are watched as one each take a [`Control::part`]: a request to one is a request to all, and their
/// simulated times add up.
#[derive(Debug, Default)]
pub struct Control {
    shared: Arc<Shared>,
    /// Simulated time of this part's own run, as bits.
    own_time: AtomicU64,
}

#[derive(Default)]
struct Shared {
    cancel: AtomicBool,
    suspend: AtomicBool,
    simulated_time: AtomicU64,
    observer: Option<Observer>,
}

type Observer = Box<dyn Fn(&Control, f64) + Send + Sync>;

impl Control {
    /// A handle without requests.
    pub fn new() -> Self {
        Self::default()
    }

    /// A handle whose runs call `observer` with their simulated time \[s\] whenever they could be suspended, ten times a second
    /// of simulated time, and continue when it returns. It can stop a run at a certain time, or hold it there.
    pub fn observed_by(observer: impl Fn(&Control, f64) + Send + Sync + 'static) -> Self {
        let shared = Shared { observer: Some(Box::new(observer)), ..Shared::default() };
        Self { shared: Arc::new(shared), own_time: AtomicU64::default() }
    }

    /// A handle for one more run that is watched and stopped with this one.
    pub fn part(&self) -> Self {
        Self { shared: self.shared.clone(), own_time: AtomicU64::default() }
    }

    /// Requests that the run end without a result.
    pub fn cancel(&self) {
        self.shared.cancel.store(true, Ordering::Relaxed);
    }

    /// Requests that the run end with a checkpoint from which it can continue.
    pub fn suspend(&self) {
        self.shared.suspend.store(true, Ordering::Relaxed);
    }

    /// True if a cancellation was requested.
    pub fn is_cancelled(&self) -> bool {
        self.shared.cancel.load(Ordering::Relaxed)
    }

    /// True if a checkpoint was requested.
    pub fn is_suspended(&self) -> bool {
        self.shared.suspend.load(Ordering::Relaxed)
    }

    /// Simulated time reached \[s\], of all runs together.
    pub fn simulated_time(&self) -> f64 {
        f64::from_bits(self.shared.simulated_time.load(Ordering::Relaxed))
    }

    /// Notifies the observer, if there is one, that this handle's run has come to a time \[s\] at which it could be suspended.
    pub(crate) fn reach(&self, simulated_time: f64) {
        if let Some(observer) = &self.shared.observer {
            observer(self, simulated_time);
        }
    }

    /// Takes in the simulated time of this handle's run \[s\].
    pub(crate) fn report(&self, simulated_time: f64) {
        let before = f64::from_bits(self.own_time.swap(simulated_time.to_bits(), Ordering::Relaxed));
        let add = |total: u64| Some((f64::from_bits(total) + (simulated_time - before)).to_bits());
        // The update never declines, so it never fails.
        let _ = self.shared.simulated_time.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
    }
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { cancel, suspend, simulated_time, observer: _ } = self;
        formatter
            .debug_struct("Shared")
            .field("cancel", cancel)
            .field("suspend", suspend)
            .field("simulated_time", &f64::from_bits(simulated_time.load(Ordering::Relaxed)))
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_stopped_together_and_their_times_add_up() {
        let whole = Control::new();
        let (a, b) = (whole.part(), whole.part());
        a.report(1.0);
        b.report(0.5);
        a.report(1.5);
        assert_eq!(whole.simulated_time(), 2.0);
        assert!(!a.is_cancelled() && !b.is_suspended());
        whole.cancel();
        b.suspend();
        assert!(a.is_cancelled() && a.is_suspended() && whole.is_suspended());
    }
}
