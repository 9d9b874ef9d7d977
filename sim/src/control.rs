//! The handle by which a caller watches and stops a run.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Shared between a run and whoever watches it. A run looks at it once every recording interval.
#[derive(Debug, Default)]
pub struct Control {
    cancel: AtomicBool,
    suspend: AtomicBool,
    simulated_time: AtomicU64,
}

impl Control {
    /// A handle that asks for nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the run to end without a result.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Asks the run to end with a checkpoint from which it can go on.
    pub fn suspend(&self) {
        self.suspend.store(true, Ordering::Relaxed);
    }

    /// Whether a cancel was asked for.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Whether a checkpoint was asked for.
    pub fn is_suspended(&self) -> bool {
        self.suspend.load(Ordering::Relaxed)
    }

    /// Simulated time reached \[s\].
    pub fn simulated_time(&self) -> f64 {
        f64::from_bits(self.simulated_time.load(Ordering::Relaxed))
    }

    pub(crate) fn report(&self, simulated_time: f64) {
        self.simulated_time.store(simulated_time.to_bits(), Ordering::Relaxed);
    }
}
