//! Counts of requests to the object store.

use std::time::Instant;

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

/// Upper bounds \[s\] of the histogram of requests to the object store.
const OBJECT_SECONDS: [f64; 9] = [0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 10.0, 30.0, 60.0];

/// Requests to the object store.
#[derive(Debug, Clone)]
pub(crate) struct ObjectMetrics {
    requests: Family<RequestLabels, Histogram>,
    bytes: Family<OperationLabel, Counter>,
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

impl Default for ObjectMetrics {
    fn default() -> Self {
        Self {
            requests: Family::new_with_constructor(|| Histogram::new(OBJECT_SECONDS)),
            bytes: Family::default(),
        }
    }
}

impl ObjectMetrics {
    /// Enters the counts in a registry.
    pub(crate) fn register(&self, registry: &mut Registry) {
        for operation in ["put", "get", "head"] {
            for outcome in ["succeeded", "failed"] {
                drop(self.requests.get_or_create(&RequestLabels { operation, outcome }));
            }
        }
        registry.register_with_unit(
            "object_request_duration",
            "Time of requests to the object store, retries included, to the first byte of the answer",
            Unit::Seconds,
            self.requests.clone(),
        );
        registry.register_with_unit(
            "object_transfer",
            "Content read from the object store and written to it",
            Unit::Bytes,
            self.bytes.clone(),
        );
    }

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
