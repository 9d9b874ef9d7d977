//! Work that the service does by itself.

use tokio::time::MissedTickBehavior;

use crate::app::App;

/// Gives the points of dead workers back to the queue, time after time, until the service stops. Workers do
/// the same when they claim; this keeps what clients see right when there are none.
pub(crate) async fn reap_expired_leases(mut app: App) {
    let mut ticks = tokio::time::interval(app.config.reap_interval);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            // An error means that the service is gone.
            _ = app.stopping.wait_for(|stopping| *stopping) => return,
        }
        match app.store.reap_expired().await {
            Ok(0) => {}
            Ok(number) => {
                app.metrics.expired_leases.inc_by(number);
                tracing::warn!(number, "leases have run out; their points wait for a worker again");
            }
            Err(error) => tracing::error!(%error, "expired leases could not be looked for"),
        }
    }
}
