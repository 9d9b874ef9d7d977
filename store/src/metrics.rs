//! Counts of a process's use of the store, for operators.

use std::fmt;
use std::time::Instant;

use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeLabelSet, EncodeMetric};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

use crate::connection::Store;
use crate::database::{ConnectionNumbers, Database};
use crate::state::WorkState;

/// Upper bounds \[s\] of the histogram of requests to the object store.
const OBJECT_SECONDS: [f64; 9] = [0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 10.0, 30.0, 60.0];

/// Counts of all stores that a process opens with one [`StoreConfig`](crate::StoreConfig). Cheap to clone: clones count together.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    expired_leases: Family<StateLabel, Counter>,
    pub(crate) objects: ObjectMetrics,
}

/// Requests to the object store.
#[derive(Debug, Clone)]
pub(crate) struct ObjectMetrics {
    requests: Family<RequestLabels, Histogram>,
    bytes: Family<OperationLabel, Counter>,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct StateLabel {
    state: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct OperationLabel {
    operation: &'static str,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RequestLabels {
    operation: &'static str,
    outcome: &'static str,
}

impl Store {
    /// Enters the counts of this process's use of the store in a registry.
    pub fn register_metrics(&self, registry: &mut Registry) {
        self.metrics.register(registry);
        registry.register_collector(Box::new(OpenConnections(self.database.clone())));
    }
}

impl Metrics {
    fn register(&self, registry: &mut Registry) {
        // An alert on an increase needs the zero before it.
        for state in [WorkState::Queued, WorkState::Dead] {
            drop(self.expired_leases.get_or_create(&StateLabel { state: state.as_str().to_owned() }));
        }
        registry.register(
            "expired_leases",
            "Leases of silent workers that this process has ended, by the state of their work after that",
            self.expired_leases.clone(),
        );
        for operation in ["put", "get", "head"] {
            for outcome in ["succeeded", "failed"] {
                drop(self.objects.requests.get_or_create(&RequestLabels { operation, outcome }));
            }
        }
        registry.register_with_unit(
            "object_request_duration",
            "Time of requests to the object store, retries included, to the first byte of what is read",
            Unit::Seconds,
            self.objects.requests.clone(),
        );
        registry.register_with_unit(
            "object_transfer",
            "Content read from the object store and written to it",
            Unit::Bytes,
            self.objects.bytes.clone(),
        );
    }

    pub(crate) fn lease_expired(&self, state: &str) {
        self.expired_leases.get_or_create(&StateLabel { state: state.to_owned() }).inc();
    }
}

impl Default for ObjectMetrics {
    fn default() -> Self {
        Self {
            requests: Family::new_with_constructor(|| Histogram::new(OBJECT_SECONDS)),
            bytes: Family::default(),
        }
    }
}

impl ObjectMetrics {
    pub(crate) fn request<T>(
        &self,
        operation: &'static str,
        begun: Instant,
        answer: &object_store::Result<T>,
    ) {
        let outcome = match answer {
            Ok(_) => "succeeded",
            Err(object_store::Error::NotFound { .. }) => "absent",
            Err(object_store::Error::AlreadyExists { .. }) => "present",
            Err(_) => "failed",
        };
        let labels = RequestLabels { operation, outcome };
        self.requests.get_or_create(&labels).observe(begun.elapsed().as_secs_f64());
    }

    pub(crate) fn transfer(&self, operation: &'static str, bytes: u64) {
        self.bytes.get_or_create(&OperationLabel { operation }).inc_by(bytes);
    }
}

/// Connections to a database, counted when they are read.
struct OpenConnections(Database);

impl fmt::Debug for OpenConnections {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("OpenConnections").finish_non_exhaustive()
    }
}

impl Collector for OpenConnections {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> fmt::Result {
        let ConnectionNumbers { open, idle } = self.0.connections();
        let family = Family::<StateLabel, Gauge>::default();
        for (state, number) in [("idle", idle), ("used", open.saturating_sub(idle))] {
            family.get_or_create(&StateLabel { state: state.to_owned() }).set(i64::from(number));
        }
        let help = "Connections to the database, by their use";
        family.encode(encoder.encode_descriptor("database_connections", help, None, family.metric_type())?)
    }
}
