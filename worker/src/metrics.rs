//! Counts of a worker, for operators.

use std::time::Duration;

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

/// Upper bounds \[s\] of the histogram of attempts.
const ATTEMPT_SECONDS: [f64; 10] = [0.1, 0.5, 2.0, 10.0, 30.0, 60.0, 300.0, 1800.0, 7200.0, 43200.0];

/// End of an attempt at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Its result is stored.
    Succeeded,
    /// Failed for good.
    Failed,
    /// Cancelled by its owner.
    Cancelled,
    /// Given back with a checkpoint.
    Suspended,
    /// Given back after a failure of the infrastructure.
    Retried,
    /// The simulation panicked.
    Crashed,
    /// Its lease was lost, or nothing could be stored while it lasted.
    Lost,
}

impl Outcome {
    const ALL: [Outcome; 7] = [
        Outcome::Succeeded,
        Outcome::Failed,
        Outcome::Cancelled,
        Outcome::Suspended,
        Outcome::Retried,
        Outcome::Crashed,
        Outcome::Lost,
    ];

    fn as_str(self) -> &'static str {
        match self {
            Outcome::Succeeded => "succeeded",
            Outcome::Failed => "failed",
            Outcome::Cancelled => "cancelled",
            Outcome::Suspended => "suspended",
            Outcome::Retried => "retried",
            Outcome::Crashed => "crashed",
            Outcome::Lost => "lost",
        }
    }
}

/// Counts of a worker.
#[derive(Debug, Clone)]
pub(crate) struct Metrics {
    attempts: Family<OutcomeLabel, Histogram>,
    claims: Family<AttemptLabel, Counter>,
    running: Gauge,
    pub(crate) store_failures: Counter,
    pub(crate) heartbeat_failures: Counter,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct OutcomeLabel {
    outcome: &'static str,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct AttemptLabel {
    attempt: &'static str,
}

impl Default for Metrics {
    fn default() -> Self {
        Self {
            attempts: Family::new_with_constructor(|| Histogram::new(ATTEMPT_SECONDS)),
            claims: Family::default(),
            running: Gauge::default(),
            store_failures: Counter::default(),
            heartbeat_failures: Counter::default(),
        }
    }
}

impl Metrics {
    pub(crate) fn register(&self, registry: &mut Registry) {
        // A rate over all outcomes needs the zeros of those that are not there yet.
        for outcome in Outcome::ALL {
            drop(self.attempts.get_or_create(&OutcomeLabel { outcome: outcome.as_str() }));
        }
        registry.register_with_unit(
            "attempt_duration",
            "Time from the claim of a point to its end at this worker, by outcome",
            Unit::Seconds,
            self.attempts.clone(),
        );
        registry.register(
            "claims",
            "Points claimed, for the first time or after an earlier attempt",
            self.claims.clone(),
        );
        registry.register("running", "Points that are computed", self.running.clone());
        registry.register(
            "store_failures",
            "Claims and ends of points that could not be written, and were tried again",
            self.store_failures.clone(),
        );
        registry.register(
            "heartbeat_failures",
            "Heartbeats that could not be written",
            self.heartbeat_failures.clone(),
        );
    }

    /// Counts a claim by its fencing token, which is 1 at the first.
    pub(crate) fn claimed(&self, fencing_token: i64) {
        let attempt = if fencing_token > 1 { "later" } else { "first" };
        self.claims.get_or_create(&AttemptLabel { attempt }).inc();
        self.running.set(1);
    }

    pub(crate) fn ended(&self, outcome: Outcome, duration: Duration) {
        let label = OutcomeLabel { outcome: outcome.as_str() };
        self.attempts.get_or_create(&label).observe(duration.as_secs_f64());
        self.running.set(0);
    }
}
