//! The queue: claiming work, keeping the lease, ending it.

use crate::blob::BlobId;
use crate::connection::{Store, now};
use crate::error::Result;
use crate::sweep::{WorkKey, WorkState, work_key};

/// Deaths of workers after which a point is given up: a poison point must not kill a fleet.
const CRASH_LIMIT: i64 = 3;

/// Tries that infrastructure (disk, object store, database) is given.
const INFRASTRUCTURE_TRIES: i64 = 5;

/// Wait before the first of these retries \[ms\]; it doubles each time.
const FIRST_RETRY_MS: i64 = 5_000;

/// Work handed to a worker.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// What every later write about it must carry.
    pub lease: Lease,
    /// The scenario as JSON text.
    pub scenario_json: String,
}

/// The right to write about one work item: void once another attempt has begun.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lease {
    /// The work item.
    pub key: WorkKey,
    /// Fencing token: the number of this attempt.
    pub attempt: i64,
    /// The worker that holds it.
    pub worker: String,
}

/// What a worker learns when it renews its lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Renewal {
    /// The lease is extended.
    Held,
    /// The lease is extended, and nobody wants the result any more.
    CancelRequested,
    /// The lease has gone to another attempt: nothing that is computed now will be taken.
    Lost,
}

/// Why a work item ended without a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureClass {
    /// The simulation itself; it would happen again.
    Physical,
    /// It ran longer than allowed.
    Timeout,
    /// It was cancelled.
    Cancelled,
}

/// An artifact of a result, its blob already written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewArtifact {
    /// Name within the result.
    pub name: String,
    /// Media type of the blob.
    pub media_type: String,
    /// The blob.
    pub blob: BlobId,
    /// Size of the blob.
    pub bytes: i64,
    /// Rows of the table.
    pub row_count: i64,
}

/// Work items by state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct QueueDepths {
    /// Retries that are not due.
    pub waiting: i64,
    /// Ready to be claimed.
    pub queued: i64,
    /// Under way.
    pub leased: i64,
}

impl Store {
    /// Hands out the next work item of the worker's physics version; none if nothing is ready.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn claim(&self, worker: &str, physics_version: i64, lease_ms: i64) -> Result<Option<Claim>> {
        self.reap_expired().await?;
        let mut tx = self.write().await?;
        let row: Option<(Vec<u8>, i64, String)> = sqlx::query_as(concat!(
            "UPDATE work SET state = 'leased', attempt = attempt + 1, starts = starts + 1, lease_owner = ?2,
                    lease_until = ",
            now!(),
            " + ?3, progress = 0, started = ",
            now!(),
            " WHERE key = (SELECT key FROM work WHERE state = 'queued' AND physics_version = ?4
                           ORDER BY priority DESC, vtime, key LIMIT 1)
              RETURNING key, attempt, scenario"
        ))
        .bind(self.clock_offset_ms)
        .bind(worker)
        .bind(lease_ms)
        .bind(physics_version)
        .fetch_optional(&mut *tx)
        .await?;
        let Some((key, attempt, scenario_json)) = row else { return Ok(None) };
        let key = work_key(&key)?;
        self.announce(&mut tx, &key, WorkState::Leased).await?;
        tx.commit().await?;
        Ok(Some(Claim { lease: Lease { key, attempt, worker: worker.to_owned() }, scenario_json }))
    }

    /// Extends a lease, stores the progress (0 to 1) and brings a cancellation back.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn renew(&self, lease: &Lease, lease_ms: i64, progress: f64) -> Result<Renewal> {
        let cancel_requested: Option<i64> = sqlx::query_scalar(concat!(
            "UPDATE work SET lease_until = ",
            now!(),
            " + ?2, progress = ?3
              WHERE key = ?4 AND attempt = ?5 AND lease_owner = ?6 AND state = 'leased'
              RETURNING cancel_requested"
        ))
        .bind(self.clock_offset_ms)
        .bind(lease_ms)
        .bind(progress)
        .bind(lease.key.as_slice())
        .bind(lease.attempt)
        .bind(&lease.worker)
        .fetch_optional(&self.pool)
        .await?;
        Ok(match cancel_requested {
            None => Renewal::Lost,
            Some(0) => Renewal::Held,
            Some(_) => Renewal::CancelRequested,
        })
    }

    /// Stores a result. False if the lease was lost: then nothing is written.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn finish_done(
        &self,
        lease: &Lease,
        summary_json: &str,
        provenance_json: &str,
        artifacts: &[NewArtifact],
    ) -> Result<bool> {
        let mut tx = self.write().await?;
        if !self.end_lease(&mut tx, lease, "done", None).await? {
            return Ok(false);
        }
        let key = lease.key.as_slice();
        sqlx::query("DELETE FROM result WHERE work_key = ?1").bind(key).execute(&mut *tx).await?;
        sqlx::query(concat!(
            "INSERT INTO result (work_key, summary, provenance, created) VALUES (?2, ?3, ?4, ",
            now!(),
            ")"
        ))
        .bind(self.clock_offset_ms)
        .bind(key)
        .bind(summary_json)
        .bind(provenance_json)
        .execute(&mut *tx)
        .await?;
        for artifact in artifacts {
            sqlx::query(
                "INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count) VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            )
            .bind(key)
            .bind(&artifact.name)
            .bind(&artifact.media_type)
            .bind(artifact.blob.to_string())
            .bind(artifact.bytes)
            .bind(artifact.row_count)
            .execute(&mut *tx)
            .await?;
        }
        self.announce(&mut tx, &lease.key, WorkState::Done).await?;
        tx.commit().await?;
        Ok(true)
    }

    /// Ends a work item without a result, for good. False if the lease was lost.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn finish_failed(&self, lease: &Lease, class: FailureClass, error_json: &str) -> Result<bool> {
        let state = match class {
            FailureClass::Physical | FailureClass::Timeout => WorkState::Failed,
            FailureClass::Cancelled => WorkState::Cancelled,
        };
        let mut tx = self.write().await?;
        if !self.end_lease(&mut tx, lease, state.as_str(), Some(error_json)).await? {
            return Ok(false);
        }
        self.announce(&mut tx, &lease.key, state).await?;
        tx.commit().await?;
        Ok(true)
    }

    /// Gives work back untried, as when a worker is told to stop. False if the lease was lost.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn release(&self, lease: &Lease) -> Result<bool> {
        let mut tx = self.write().await?;
        if !self.end_lease(&mut tx, lease, "queued", None).await? {
            return Ok(false);
        }
        sqlx::query("UPDATE work SET starts = starts - 1, progress = 0 WHERE key = ?1")
            .bind(lease.key.as_slice())
            .execute(&mut *tx)
            .await?;
        self.announce(&mut tx, &lease.key, WorkState::Queued).await?;
        tx.commit().await?;
        Ok(true)
    }

    /// Gives work back after the infrastructure failed: tried again later and later, given up after five times.
    /// False if the lease was lost.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn retry_later(&self, lease: &Lease, error_json: &str) -> Result<bool> {
        let mut tx = self.write().await?;
        if !self.end_lease(&mut tx, lease, "waiting", Some(error_json)).await? {
            return Ok(false);
        }
        let failures: i64 = sqlx::query_scalar(concat!(
            "UPDATE work SET failure_count = failure_count + 1, progress = 0, ready_at = ",
            now!(),
            " + (?2 << failure_count) WHERE key = ?3 RETURNING failure_count"
        ))
        .bind(self.clock_offset_ms)
        .bind(FIRST_RETRY_MS)
        .bind(lease.key.as_slice())
        .fetch_one(&mut *tx)
        .await?;
        let state = if failures >= INFRASTRUCTURE_TRIES { WorkState::Failed } else { WorkState::Waiting };
        self.set_state(&mut tx, &lease.key, state).await?;
        tx.commit().await?;
        Ok(true)
    }

    /// Takes work back from workers that are silent beyond their lease, and wakes retries that are due. Tells how
    /// many leases had run out.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn reap_expired(&self) -> Result<u64> {
        // Most of the time there is nothing: look before taking the write lock.
        let idle: i64 = sqlx::query_scalar(concat!(
            "SELECT NOT EXISTS (SELECT 1 FROM work WHERE state = 'leased' AND lease_until < ",
            now!(),
            ") AND NOT EXISTS (SELECT 1 FROM work WHERE state = 'waiting' AND ready_at <= ",
            now!(),
            ")"
        ))
        .bind(self.clock_offset_ms)
        .fetch_one(&self.pool)
        .await?;
        if idle != 0 {
            return Ok(0);
        }
        let mut tx = self.write().await?;
        let expired: Vec<(Vec<u8>, i64, i64, Option<String>)> = sqlx::query_as(concat!(
            "UPDATE work SET crash_count = crash_count + 1, progress = 0, lease_until = NULL
             WHERE state = 'leased' AND lease_until < ",
            now!(),
            " RETURNING key, crash_count, cancel_requested, lease_owner"
        ))
        .bind(self.clock_offset_ms)
        .fetch_all(&mut *tx)
        .await?;
        for (key, crashes, cancel_requested, owner) in &expired {
            let key = work_key(key)?;
            let state = if *cancel_requested != 0 {
                WorkState::Cancelled
            } else if *crashes >= CRASH_LIMIT {
                sqlx::query("UPDATE work SET error = ?2 WHERE key = ?1")
                    .bind(key.as_slice())
                    .bind(format!(
                        "{{\"class\":\"crash\",\"reason\":\"{crashes} workers went silent while they simulated it\"}}"
                    ))
                    .execute(&mut *tx)
                    .await?;
                WorkState::Dead
            } else {
                WorkState::Queued
            };
            tracing::warn!(
                worker = owner.as_deref().unwrap_or("?"),
                crashes,
                state = state.as_str(),
                "lease ran out"
            );
            self.set_state(&mut tx, &key, state).await?;
        }
        let due: Vec<Vec<u8>> = sqlx::query_scalar(concat!(
            "SELECT key FROM work WHERE state = 'waiting' AND ready_at <= ",
            now!()
        ))
        .bind(self.clock_offset_ms)
        .fetch_all(&mut *tx)
        .await?;
        for key in due {
            self.set_state(&mut tx, &work_key(&key)?, WorkState::Queued).await?;
        }
        tx.commit().await?;
        Ok(expired.len() as u64)
    }

    /// Work items that are not final, by state.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn queue_depths(&self) -> Result<QueueDepths> {
        let rows: Vec<(String, i64)> = sqlx::query_as(
            "SELECT state, count(*) FROM work WHERE state IN ('waiting', 'queued', 'leased') GROUP BY state",
        )
        .fetch_all(&self.pool)
        .await?;
        let mut depths = QueueDepths::default();
        for (state, number) in rows {
            match state.as_str() {
                "waiting" => depths.waiting = number,
                "queued" => depths.queued = number,
                _ => depths.leased = number,
            }
        }
        Ok(depths)
    }

    /// Leaves the lease for another state, if it is still held.
    async fn end_lease(
        &self,
        tx: &mut sqlx::Transaction<'static, sqlx::Sqlite>,
        lease: &Lease,
        state: &str,
        error_json: Option<&str>,
    ) -> Result<bool> {
        let changed = sqlx::query(concat!(
            "UPDATE work SET state = ?2, error = ?3, lease_until = NULL, finished = ",
            now!(),
            ", progress = CASE ?2 WHEN 'done' THEN 1.0 ELSE progress END
              WHERE key = ?4 AND attempt = ?5 AND lease_owner = ?6 AND state = 'leased'"
        ))
        .bind(self.clock_offset_ms)
        .bind(state)
        .bind(error_json)
        .bind(lease.key.as_slice())
        .bind(lease.attempt)
        .bind(&lease.worker)
        .execute(&mut **tx)
        .await?
        .rows_affected();
        Ok(changed == 1)
    }
}
