//! Metrics for operators, as Prometheus text.

use std::sync::PoisonError;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use axum::http::{Method, StatusCode};
use drillsweep_store::{Census, Store};
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

use crate::answer::error::Result;
use crate::exposition::Exposition;
use crate::listen::ConnectionCounts;

/// Upper bounds of the buckets of request durations \[s\].
const REQUEST_SECONDS: [f64; 10] = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 2.0, 10.0];

/// Use of a bounded resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Occupancy {
    /// Held \[bytes\].
    pub(crate) held: u64,
    /// Requests that wait for it.
    pub(crate) waiting: u64,
    /// Requests refused since the start.
    pub(crate) refused: u64,
}

/// Metrics of the service.
pub(crate) struct Metrics {
    exposition: Exposition,
    requests: Family<RequestLabels, Histogram>,
    streams: Gauge,
    pub(crate) connections: ConnectionCounts,
    /// Refused tokens.
    pub(crate) refused_tokens: Counter,
    throttled: Family<OwnerLabel, Counter>,
    collections: Family<OutcomeLabel, Counter>,
    lanes: LaneMetrics,
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

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct OwnerLabel {
    owner: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct OutcomeLabel {
    outcome: &'static str,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct LaneLabel {
    lane: &'static str,
}

/// Gauges of the use of bounded resources.
#[derive(Default)]
struct LaneMetrics {
    held: Family<LaneLabel, Gauge>,
    waiting: Family<LaneLabel, Gauge>,
    refused: Family<LaneLabel, Counter>,
}

impl LaneMetrics {
    fn register(&self, registry: &mut Registry) {
        registry.register_with_unit(
            "lane_held",
            "Memory held by requests, by use",
            Unit::Bytes,
            self.held.clone(),
        );
        registry.register("lane_waiting", "Requests that wait for memory, by use", self.waiting.clone());
        registry.register(
            "lane_refused",
            "Requests refused for lack of memory, by use",
            self.refused.clone(),
        );
    }

    fn set(&self, lanes: &[(&'static str, Occupancy)]) {
        for (lane, occupancy) in lanes {
            let label = LaneLabel { lane };
            self.held.get_or_create(&label).set(occupancy.held as i64);
            self.waiting.get_or_create(&label).set(occupancy.waiting as i64);
            self.refused.get_or_create(&label).inner().store(occupancy.refused, Ordering::Relaxed);
        }
    }
}

/// Gauges of the contents of the database, read on request.
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
    pub(crate) fn new(store: &Store) -> Self {
        let exposition = Exposition::new();
        let mut all = exposition.registry().lock().unwrap_or_else(PoisonError::into_inner);
        let registry = all.sub_registry_with_prefix("drillsweep");
        store.register_metrics(registry);
        let requests =
            Family::<RequestLabels, Histogram>::new_with_constructor(|| Histogram::new(REQUEST_SECONDS));
        let streams = Gauge::default();
        let (lanes, census) = (LaneMetrics::default(), CensusGauges::default());
        registry.register("event_streams", "Open event streams", streams.clone());
        registry.register_with_unit(
            "http_request_duration",
            "Time from a request's headers to its answer's headers, by route",
            Unit::Seconds,
            requests.clone(),
        );
        let connections = ConnectionCounts::default();
        registry.register("connections", "Open connections", connections.open.clone());
        registry.register(
            "connections_refused",
            "Connections refused beyond the limits",
            connections.refused.clone(),
        );
        let refused_tokens = Counter::default();
        registry.register(
            "tokens_refused",
            "Tokens that were unknown, expired or revoked",
            refused_tokens.clone(),
        );
        let throttled = Family::<OwnerLabel, Counter>::default();
        registry.register("throttled", "Requests beyond the rate of their owner", throttled.clone());
        let collections = Family::<OutcomeLabel, Counter>::default();
        // An alert on an increase needs a preceding zero.
        for outcome in ["succeeded", "failed"] {
            drop(collections.get_or_create(&OutcomeLabel { outcome }));
        }
        registry.register(
            "collections",
            "Collections of expired data by this process, by outcome",
            collections.clone(),
        );
        lanes.register(registry);
        census.register(registry);
        drop(all);
        Metrics {
            exposition,
            requests,
            streams,
            connections,
            refused_tokens,
            throttled,
            collections,
            lanes,
            census,
        }
    }

    /// Counts a request by the route that answered it.
    pub(crate) fn count(&self, method: &Method, route: String, status: StatusCode, duration: Duration) {
        let labels = RequestLabels { method: method_name(method), route, status: status.as_u16() };
        self.requests.get_or_create(&labels).observe(duration.as_secs_f64());
    }

    /// Counts a request beyond the rate of its owner.
    pub(crate) fn throttle(&self, owner: &str) {
        self.throttled.get_or_create(&OwnerLabel { owner: owner.to_owned() }).inc();
    }

    /// Counts a collection of expired data.
    pub(crate) fn collected(&self, has_succeeded: bool) {
        let outcome = if has_succeeded { "succeeded" } else { "failed" };
        self.collections.get_or_create(&OutcomeLabel { outcome }).inc();
    }

    /// All metrics, with the contents of the database, the number of open event streams, and the use of lanes.
    pub(crate) fn text(
        &self,
        census: &Census,
        streams: usize,
        lanes: &[(&'static str, Occupancy)],
    ) -> Result<String> {
        self.streams.set(streams as i64);
        self.lanes.set(lanes);
        self.census.set(census);
        self.exposition.text()
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
            "Results that were recomputed and differ from the earlier ones; normally 0",
            self.disagreements.clone(),
        );
        registry.register_with_unit(
            "artifacts",
            "Size of the tables of all results; shared ones count each time",
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

/// Clients can invent methods, which must not add series.
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
