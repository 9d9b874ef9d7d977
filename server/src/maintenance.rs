//! Work that the service does by itself.

use std::time::Duration;

use drillsweep_store::Store;
use tokio::sync::watch;
use tokio::time::MissedTickBehavior;

/// Gives the points of dead workers back to the queue, time after time, until the service stops. Workers do
/// the same when they claim; this keeps what clients see right when there are none.
pub(crate) async fn reap_expired_leases(
    store: Store,
    interval: Duration,
    mut stopping: watch::Receiver<bool>,
) {
    let mut ticks = tokio::time::interval(interval);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            // An error means that the service is gone.
            _ = stopping.wait_for(|stopping| *stopping) => return,
        }
        match store.reap_expired().await {
            Ok(0) => {}
            Ok(number) => tracing::warn!(number, "leases have run out; their points wait for a worker again"),
            Err(error) => tracing::error!(%error, "expired leases could not be looked for"),
        }
    }
}
