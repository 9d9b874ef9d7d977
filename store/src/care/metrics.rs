//! Metrics of a store in a registry.

use std::fmt;

use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeLabelSet, EncodeMetric};
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::Registry;

use crate::engine::connections::ConnectionNumbers;
use crate::engine::database::Database;
use crate::store::Store;
use crate::work::state::WorkState;

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct StateLabel {
    state: &'static str,
}

impl Store {
    /// Enters the counts of this process's use of the store in a registry.
    pub fn register_metrics(&self, registry: &mut Registry) {
        let states = [WorkState::Queued, WorkState::Dead].map(WorkState::as_str);
        self.metrics.register(registry, states);
        registry.register_collector(Box::new(OpenConnections(self.database.clone())));
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
            family.get_or_create(&StateLabel { state }).set(i64::from(number));
        }
        let help = "Connections to the database, by their use";
        family.encode(encoder.encode_descriptor("database_connections", help, None, family.metric_type())?)
    }
}
