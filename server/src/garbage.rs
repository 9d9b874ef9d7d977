//! Task of periodic garbage collection.

use std::time::Duration;

use tokio::time::MissedTickBehavior;

use crate::app::App;

/// Interval of checks for a due collection.
const LOOK: Duration = Duration::from_secs(60);

/// Collects garbage at intervals until the service stops. The interval counts from the last collection of any process, or from the first
/// start of a service, so that operators can read the dry run before anything is deleted.
pub(crate) async fn collect_garbage(mut app: App) {
    let Some(interval) = app.config.retention.interval else { return };
    tracing::info!(
        every_hours = interval.as_secs_f64() / 3600.0,
        "expired data are deleted at this interval (ages: GET /v1/retention)"
    );
    let started = app.store.now_ms().await;
    let mut ticks = tokio::time::interval(LOOK.min(interval));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            // An error means that the service has ended.
            _ = app.stopping.wait_for(|stopping| *stopping) => return,
        }
        let last = match app.store.last_collection().await {
            Ok(last) => last.map(|last| last.started),
            Err(error) => {
                tracing::error!(%error, "the time of the last collection cannot be read");
                continue;
            }
        };
        let since = last.or(started.as_ref().ok().copied()).unwrap_or_default();
        let is_due = app.store.now_ms().await.is_ok_and(|now| {
            u128::try_from(now.saturating_sub(since)).is_ok_and(|passed| passed >= interval.as_millis())
        });
        if !is_due {
            continue;
        }
        match app.store.collect_garbage(&app.config.retention.policy, false).await {
            Ok(garbage) => {
                app.metrics.collected(true);
                tracing::info!(deleted = %garbage.to_json(), "a collection has ended");
            }
            Err(error) => {
                app.metrics.collected(false);
                tracing::error!(%error, "a collection failed; what it had deleted stays deleted");
            }
        }
    }
}
