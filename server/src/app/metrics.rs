//! What is counted for operators, as Prometheus text.

use std::sync::Mutex;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

use axum::http::{Method, StatusCode};
use drillsweep_store::Census;
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

use crate::answer::error::{Error, Result};

/// The media type of [`Metrics::text`].
pub(crate) const TEXT: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Upper ends \[s\] of the ranges in which requests are counted by their duration.
const REQUEST_SECONDS: [f64; 10] = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 2.0, 10.0];

/// What is counted.
pub(crate) struct Metrics {
    registry: Mutex<Registry>,
    requests: Family<RequestLabels, Histogram>,
    streams: Gauge,
    pub(crate) expired_leases: Counter,
    census: CensusGauges,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RequestLabels {
    method: &'static str,
    route: String,
    status: u16,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct StateLabel {
    state: &'static str,
}

/// What the database knows, read when it is asked for.
#[derive(Default)]
struct CensusGauges {
    work: Family<StateLabel, Gauge>,
    points: Family<StateLabel, Gauge>,
    sweeps: Gauge,
    workers: Gauge,
    oldest_queued: Gauge<f64, AtomicU64>,
    database: Gauge,
    write_ahead_log: Gauge,
    disagreements: Gauge,
    artifacts: Gauge,
}

impl Metrics {
    pub(crate) fn new() -> Self {
        let mut registry = Registry::with_prefix("drillsweep");
        let requests =
            Family::<RequestLabels, Histogram>::new_with_constructor(|| Histogram::new(REQUEST_SECONDS));
        let (streams, expired_leases, census) =
            (Gauge::default(), Counter::default(), CensusGauges::default());
        registry.register("event_streams", "Event streams that are open", streams.clone());
        registry.register_with_unit(
            "http_request_duration",
            "Time from a request's headers to its answer's headers, by route",
            Unit::Seconds,
            requests.clone(),
        );
        registry.register(
            "expired_leases",
            "Expired leases of silent workers that this process has found",
            expired_leases.clone(),
        );
        census.register(&mut registry);
        Metrics { registry: Mutex::new(registry), requests, streams, expired_leases, census }
    }

    /// Counts a request by the route that answered it.
    pub(crate) fn count(&self, method: &Method, route: String, status: StatusCode, duration: Duration) {
        let labels = RequestLabels { method: method_name(method), route, status: status.as_u16() };
        self.requests.get_or_create(&labels).observe(duration.as_secs_f64());
    }

    /// Everything that is counted, with what the database knows and the number of event streams that are open.
    pub(crate) fn text(&self, census: &Census, streams: usize) -> Result<String> {
        let registry = self.registry.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        self.streams.set(streams as i64);
        self.census.set(census);
        let mut text = String::new();
        encode(&mut text, &registry).map_err(|error| Error::internal(&error))?;
        Ok(text)
    }
}

impl CensusGauges {
    fn register(&self, registry: &mut Registry) {
        registry.register(
            "work",
            "Work items by state; points that share a result are one",
            self.work.clone(),
        );
        registry.register("points", "Points of all sweeps, by state", self.points.clone());
        registry.register("sweeps", "Sweeps that are stored", self.sweeps.clone());
        registry.register("workers", "Workers with a recent heartbeat", self.workers.clone());
        registry.register_with_unit(
            "oldest_queued",
            "Age of the point that has waited longest for a worker",
            Unit::Seconds,
            self.oldest_queued.clone(),
        );
        registry.register_with_unit("database", "Size of the database", Unit::Bytes, self.database.clone());
        registry.register_with_unit(
            "database_write_ahead_log",
            "Size of the database's write-ahead log",
            Unit::Bytes,
            self.write_ahead_log.clone(),
        );
        registry.register(
            "results_that_disagree",
            "Results that were recomputed and differ from the earlier ones; 0 where all is well",
            self.disagreements.clone(),
        );
        registry.register_with_unit(
            "artifacts",
            "Size of the tables of all results, those that are shared counted each time",
            Unit::Bytes,
            self.artifacts.clone(),
        );
    }

    fn set(&self, census: &Census) {
        for (family, counts) in [(&self.work, &census.work), (&self.points, &census.points)] {
            for (state, number) in counts {
                family.get_or_create(&StateLabel { state }).set(*number);
            }
        }
        self.sweeps.set(census.sweeps);
        self.workers.set(census.workers);
        self.oldest_queued.set(census.oldest_queued_ms as f64 * 1e-3);
        self.database.set(census.database_bytes);
        self.write_ahead_log.set(census.write_ahead_log_bytes);
        self.disagreements.set(census.disagreements);
        self.artifacts.set(census.artifact_bytes);
    }
}

/// A client may make up methods; the metrics must not grow by them.
fn method_name(method: &Method) -> &'static str {
    match *method {
        Method::GET => "GET",
        Method::HEAD => "HEAD",
        Method::POST => "POST",
        Method::PATCH => "PATCH",
        Method::PUT => "PUT",
        Method::DELETE => "DELETE",
        Method::OPTIONS => "OPTIONS",
        _ => "other",
    }
}
