//! Counts of a process's use of the store, for operators.

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::registry::Registry;

use crate::blob::metrics::ObjectMetrics;

/// Counts of all stores that a process opens with one [`StoreConfig`](crate::StoreConfig). Cheap to clone: clones count together.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    expired_leases: Family<StateLabel, Counter>,
    pub(crate) objects: ObjectMetrics,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct StateLabel {
    state: String,
}

impl Metrics {
    /// Enters the counts in a registry; `states` are those that work can have after an expired lease.
    pub(crate) fn register(&self, registry: &mut Registry, states: [&str; 2]) {
        // An alert on an increase needs the zero before it.
        for state in states {
            drop(self.expired_leases.get_or_create(&StateLabel { state: state.to_owned() }));
        }
        registry.register(
            "expired_leases",
            "Leases that expired and were ended by this process, by the resulting state of their work",
            self.expired_leases.clone(),
        );
        self.objects.register(registry);
    }

    pub(crate) fn lease_expired(&self, state: &str) {
        self.expired_leases.get_or_create(&StateLabel { state: state.to_owned() }).inc();
    }
}
