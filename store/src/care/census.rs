//! Numbers of everything, for operators.

use std::time::Duration;

use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::state::WorkState;

/// Counts of rows and bytes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Census {
    /// Work items that are not final, by state; `held` counts those of paused sweeps alone.
    pub work: Vec<(&'static str, i64)>,
    /// Points of all sweeps, by state.
    pub points: Vec<(&'static str, i64)>,
    /// Sweeps.
    pub sweeps: i64,
    /// Workers with a heartbeat within the given time.
    pub workers: i64,
    /// Age of the oldest work item that is ready \[ms\].
    pub oldest_queued_ms: i64,
    /// Size of the database.
    pub database_bytes: i64,
    /// Size of its write-ahead log.
    pub write_ahead_log_bytes: i64,
    /// Results that were recomputed and differ.
    pub disagreements: i64,
    /// Size of all artifacts, those that share a blob counted each time.
    pub artifact_bytes: i64,
}

impl Store {
    /// Counts everything; workers silent for longer than `silence` do not count. Its cost grows with the number of
    /// open work items, sweeps and artifacts, not with that of points.
    ///
    /// # Errors
    /// The database fails.
    pub async fn census(&self, silence: Duration) -> Result<Census> {
        self.apply_left_transitions().await;
        let depths = self.queue_depths().await?;
        type Sums = (i64, i64, i64, i64, i64, i64);
        let (sweeps, queued, running, done, failed, cancelled): Sums =
            query(sql::census::SWEEPS).one(&self.database).await?;
        let oldest_queued_ms: i64 = query(sql::census::OLDEST_QUEUED).scalar(&self.database).await?;
        let artifact_bytes: i64 = query(sql::census::ARTIFACT_BYTES).scalar(&self.database).await?;
        let disagreements: i64 = query(sql::census::DISAGREEMENTS).scalar(&self.database).await?;
        let workers = self.workers(silence.as_millis() as i64).await?.len() as i64;
        let size = |suffix: &str| {
            let Some(path) = &self.database_path else { return 0 };
            let mut path = path.clone().into_os_string();
            path.push(suffix);
            // The log is not there before the first write and after a clean end.
            std::fs::metadata(path).map_or(0, |metadata| metadata.len() as i64)
        };
        Ok(Census {
            work: vec![
                (WorkState::Waiting.as_str(), depths.waiting),
                (WorkState::Queued.as_str(), depths.queued),
                ("held", depths.held),
                (WorkState::Leased.as_str(), depths.leased),
            ],
            points: vec![
                ("queued", queued),
                ("running", running),
                ("succeeded", done),
                ("failed", failed),
                ("cancelled", cancelled),
            ],
            sweeps,
            workers,
            oldest_queued_ms,
            database_bytes: size(""),
            write_ahead_log_bytes: size("-wal"),
            disagreements,
            artifact_bytes,
        })
    }
}
