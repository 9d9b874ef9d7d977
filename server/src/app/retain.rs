//! How long data are kept, and how often the service sees to that.

use std::collections::BTreeMap;
use std::time::Duration;

use drillsweep_store::RetentionPolicy;
use drillsweep_table::quantity::tables::HISTORY;
use tokio::time::MissedTickBehavior;

use crate::app::App;

const DAY: Duration = Duration::from_secs(86_400);

/// How often it is looked whether a collection is due.
const LOOK: Duration = Duration::from_secs(60);

/// How long data are kept, and who sees to that.
#[derive(Debug, Clone)]
pub struct Retaining {
    /// What is kept for how long.
    pub policy: RetentionPolicy,
    /// Time from one collection to the next; none where the service does not collect.
    pub interval: Option<Duration>,
}

impl Default for Retaining {
    /// Recordings (histories; orbits and spectra are cut from them) are kept for 30 days, other tables for a year, events for 30 days.
    fn default() -> Self {
        let policy = RetentionPolicy {
            artifact_ages: BTreeMap::from([(HISTORY.name.to_owned(), 30 * DAY)]),
            other_artifacts: 365 * DAY,
            events: 30 * DAY,
            blob_grace: DAY,
        };
        Retaining { policy, interval: None }
    }
}

/// Deletes what need not be kept, time after time, until the service stops. The time is counted from the last collection, whoever made
/// it; without one, from the service's first start, so that nothing is deleted before an operator has read what would be.
pub(crate) async fn collect(mut app: App) {
    let Some(interval) = app.config.retention.interval else { return };
    tracing::info!(every = ?interval, policy = ?app.config.retention.policy, "what need not be kept is deleted");
    let started = app.store.now_ms().await;
    let mut ticks = tokio::time::interval(LOOK.min(interval));
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            // An error means that the service is gone.
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
            Ok(garbage) => tracing::info!(deleted = %garbage.to_json(), "a collection has ended"),
            Err(error) => tracing::error!(%error, "a collection failed; what it had deleted stays deleted"),
        }
    }
}
