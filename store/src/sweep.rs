//! Sweeps and their points: submitting, reading, cancelling, retrying.

use sqlx::{FromRow, Sqlite, Transaction};

use crate::connection::{Store, now};
use crate::error::{Result, StoreError};

/// Content hash of a point: equal keys, equal results.
pub type WorkKey = [u8; 32];

/// Virtual time that one point costs its owner; the claim order is by virtual time, so that owners take turns
/// however many points each has (start-time fair queueing).
const COST_OF_A_POINT: i64 = 1_000;

/// A sweep to store.
#[derive(Debug, Clone)]
pub struct NewSweep {
    /// Identifier, a UUID of version 7.
    pub id: String,
    /// A name for people.
    pub name: Option<String>,
    /// Whose share of the workers it counts against.
    pub owner: String,
    /// The request as JSON.
    pub request_json: String,
    /// Higher goes first.
    pub priority: i64,
    /// The client's idempotency key with the hash of the request's body.
    pub idempotency_key: Option<(String, [u8; 32])>,
    /// The points, ordinals from 1.
    pub points: Vec<NewPoint>,
}

/// A point of a sweep to store.
#[derive(Debug, Clone)]
pub struct NewPoint {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Content hash.
    pub work_key: WorkKey,
    /// The scenario as JSON text.
    pub scenario_json: String,
    /// Version of the numbers that the key was made for.
    pub physics_version: i64,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SubmitOutcome {
    /// It is stored.
    Created,
    /// The same request was stored before under the same idempotency key, as this sweep.
    Known(String),
}

/// Where a work item stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WorkState {
    /// A retry that is not due yet.
    Waiting,
    /// Ready to be claimed.
    Queued,
    /// A worker has it.
    Leased,
    /// Its result is stored.
    Done,
    /// It ended without a result, for good.
    Failed,
    /// Its workers died too often.
    Dead,
    /// Nobody wants it any more.
    Cancelled,
}

impl WorkState {
    /// The name in the database.
    pub fn as_str(self) -> &'static str {
        match self {
            WorkState::Waiting => "waiting",
            WorkState::Queued => "queued",
            WorkState::Leased => "leased",
            WorkState::Done => "done",
            WorkState::Failed => "failed",
            WorkState::Dead => "dead",
            WorkState::Cancelled => "cancelled",
        }
    }

    fn parse(text: &str) -> Result<Self> {
        Ok(match text {
            "waiting" => WorkState::Waiting,
            "queued" => WorkState::Queued,
            "leased" => WorkState::Leased,
            "done" => WorkState::Done,
            "failed" => WorkState::Failed,
            "dead" => WorkState::Dead,
            "cancelled" => WorkState::Cancelled,
            other => return Err(StoreError::Corrupt(format!("work state {other:?}"))),
        })
    }
}

/// Points of a sweep by the state of their work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StateCounts {
    /// All points.
    pub total: i64,
    /// Waiting for a retry or for a worker.
    pub queued: i64,
    /// Under way.
    pub running: i64,
    /// With a result.
    pub done: i64,
    /// Failed, or given up because workers died.
    pub failed: i64,
    /// Cancelled.
    pub cancelled: i64,
}

/// A stored sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRecord {
    /// Identifier.
    pub id: String,
    /// A name for people.
    pub name: Option<String>,
    /// Whose share of the workers it counts against.
    pub owner: String,
    /// The request as JSON.
    pub request_json: String,
    /// Higher goes first.
    pub priority: i64,
    /// Raised with every change of one of its points.
    pub version: i64,
    /// True once it was cancelled.
    pub is_cancelled: bool,
    /// When it was submitted \[ms since the epoch\].
    pub created: i64,
    /// When its last point became final \[ms since the epoch\].
    pub finished: Option<i64>,
    /// Points by state.
    pub counts: StateCounts,
    /// Sum of the points' progress, each 0 to 1.
    pub progress: f64,
}

/// A stored point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointRecord {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Content hash.
    pub work_key: WorkKey,
    /// The scenario as JSON text.
    pub scenario_json: String,
    /// Where its work stands.
    pub state: WorkState,
    /// Simulated time over duration, 0 to 1.
    pub progress: f64,
    /// How often a worker has started it.
    pub attempts: i64,
    /// Why it failed, as JSON.
    pub error_json: Option<String>,
    /// Scalar results as a JSON object.
    pub summary_json: Option<String>,
    /// Where and how it was computed, as a JSON object.
    pub provenance_json: Option<String>,
}

/// A point's row of the sweep's table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRecord {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Where its work stands.
    pub state: WorkState,
    /// Scalar results as a JSON object.
    pub summary_json: Option<String>,
    /// Why it failed, as JSON.
    pub error_json: Option<String>,
}

/// A stored array or table of a result.
#[derive(Debug, Clone, PartialEq, Eq, FromRow)]
pub struct Artifact {
    /// Name within the result.
    pub name: String,
    /// Media type of the blob.
    pub media_type: String,
    /// Name of the blob.
    pub blob: String,
    /// Size of the blob.
    pub bytes: i64,
    /// Rows of the table.
    pub row_count: i64,
}

#[derive(FromRow)]
struct SweepRow {
    id: String,
    name: Option<String>,
    owner: String,
    request: String,
    priority: i64,
    total: i64,
    version: i64,
    cancelled: i64,
    created: i64,
    finished: Option<i64>,
}

#[derive(FromRow)]
struct PointRow {
    ordinal: i64,
    parameters: String,
    key: Vec<u8>,
    scenario: String,
    state: String,
    progress: f64,
    starts: i64,
    error: Option<String>,
    summary: Option<String>,
    provenance: Option<String>,
}

impl PointRow {
    fn record(self) -> Result<PointRecord> {
        Ok(PointRecord {
            ordinal: self.ordinal,
            parameters_json: self.parameters,
            work_key: work_key(&self.key)?,
            scenario_json: self.scenario,
            state: WorkState::parse(&self.state)?,
            progress: self.progress,
            attempts: self.starts,
            error_json: self.error,
            summary_json: self.summary,
            provenance_json: self.provenance,
        })
    }
}

pub(crate) fn work_key(bytes: &[u8]) -> Result<WorkKey> {
    bytes.try_into().map_err(|_| StoreError::Corrupt(format!("work key of {} bytes", bytes.len())))
}

impl Store {
    /// Stores a sweep with all its points in one transaction. Work that is known is not done again: a finished point
    /// counts at once, a failed one stays failed, a cancelled one is queued again.
    ///
    /// # Errors
    /// When the idempotency key was used for another request, or the database fails.
    pub async fn submit_sweep(&self, sweep: &NewSweep) -> Result<SubmitOutcome> {
        let mut tx = self.write().await?;
        if let Some((key, body_hash)) = &sweep.idempotency_key {
            let known: Option<(Vec<u8>, String)> =
                sqlx::query_as("SELECT body_hash, sweep_id FROM idempotency WHERE owner = ?1 AND key = ?2")
                    .bind(&sweep.owner)
                    .bind(key)
                    .fetch_optional(&mut *tx)
                    .await?;
            if let Some((known_hash, sweep_id)) = known {
                if known_hash != body_hash {
                    return Err(StoreError::IdempotencyConflict);
                }
                return Ok(SubmitOutcome::Known(sweep_id));
            }
        }
        let now: i64 = sqlx::query_scalar(concat!("SELECT ", now!()))
            .bind(self.clock_offset_ms)
            .fetch_one(&mut *tx)
            .await?;
        sqlx::query(
            "INSERT INTO sweep (id, name, owner, request, priority, total, created) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
        )
        .bind(&sweep.id)
        .bind(&sweep.name)
        .bind(&sweep.owner)
        .bind(&sweep.request_json)
        .bind(sweep.priority)
        .bind(sweep.points.len() as i64)
        .bind(now)
        .execute(&mut *tx)
        .await?;
        if let Some((key, body_hash)) = &sweep.idempotency_key {
            sqlx::query(
                "INSERT INTO idempotency (owner, key, body_hash, sweep_id, created) VALUES (?1, ?2, ?3, ?4, ?5)",
            )
            .bind(&sweep.owner)
            .bind(key)
            .bind(body_hash.as_slice())
            .bind(&sweep.id)
            .bind(now)
            .execute(&mut *tx)
            .await?;
        }
        let mut vtime = start_of_virtual_time(&mut tx, &sweep.owner).await?;
        for point in &sweep.points {
            vtime += COST_OF_A_POINT;
            sqlx::query(
                "INSERT INTO work (key, physics_version, scenario, owner, state, priority, vtime, ready_at, created)
                 VALUES (?1, ?2, ?3, ?4, 'queued', ?5, ?6, ?7, ?7)
                 ON CONFLICT (key) DO UPDATE SET
                     state = CASE state WHEN 'cancelled' THEN 'queued' ELSE state END,
                     attempt = attempt + (state = 'cancelled'),
                     vtime = CASE state WHEN 'cancelled' THEN excluded.vtime ELSE vtime END,
                     error = CASE state WHEN 'cancelled' THEN NULL ELSE error END,
                     priority = max(priority, excluded.priority),
                     cancel_requested = 0",
            )
            .bind(point.work_key.as_slice())
            .bind(point.physics_version)
            .bind(&point.scenario_json)
            .bind(&sweep.owner)
            .bind(sweep.priority)
            .bind(vtime)
            .bind(now)
            .execute(&mut *tx)
            .await?;
            sqlx::query(
                "INSERT INTO point (sweep_id, ordinal, parameters, work_key) VALUES (?1, ?2, ?3, ?4)",
            )
            .bind(&sweep.id)
            .bind(point.ordinal)
            .bind(&point.parameters_json)
            .bind(point.work_key.as_slice())
            .execute(&mut *tx)
            .await?;
        }
        sqlx::query(
            "INSERT INTO owner_clock (owner, vtime) VALUES (?1, ?2)
             ON CONFLICT (owner) DO UPDATE SET vtime = excluded.vtime",
        )
        .bind(&sweep.owner)
        .bind(vtime)
        .execute(&mut *tx)
        .await?;
        self.close_if_finished(&mut tx, &sweep.id).await?;
        tx.commit().await?;
        Ok(SubmitOutcome::Created)
    }

    /// A sweep with its counts; none if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn sweep(&self, id: &str) -> Result<Option<SweepRecord>> {
        let row: Option<SweepRow> = sqlx::query_as(
            "SELECT id, name, owner, request, priority, total, version, cancelled, created, finished
             FROM sweep WHERE id = ?1",
        )
        .bind(id)
        .fetch_optional(&self.pool)
        .await?;
        match row {
            None => Ok(None),
            Some(row) => Ok(Some(self.with_counts(row).await?)),
        }
    }

    /// Sweeps, newest first, of one owner or of all, before the sweep `before`.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn sweeps(
        &self,
        owner: Option<&str>,
        before: Option<&str>,
        limit: i64,
    ) -> Result<Vec<SweepRecord>> {
        let rows: Vec<SweepRow> = sqlx::query_as(
            "SELECT id, name, owner, request, priority, total, version, cancelled, created, finished
             FROM sweep WHERE (?1 IS NULL OR owner = ?1) AND (?2 IS NULL OR id < ?2) ORDER BY id DESC LIMIT ?3",
        )
        .bind(owner)
        .bind(before)
        .bind(limit)
        .fetch_all(&self.pool)
        .await?;
        let mut sweeps = Vec::with_capacity(rows.len());
        for row in rows {
            sweeps.push(self.with_counts(row).await?);
        }
        Ok(sweeps)
    }

    /// A number that rises with every change of the sweep's points; none if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn sweep_version(&self, id: &str) -> Result<Option<i64>> {
        Ok(sqlx::query_scalar("SELECT version FROM sweep WHERE id = ?1")
            .bind(id)
            .fetch_optional(&self.pool)
            .await?)
    }

    /// Points of a sweep after the ordinal `after`, in one state or in any.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn points(
        &self,
        sweep_id: &str,
        states: &[WorkState],
        after: i64,
        limit: i64,
    ) -> Result<Vec<PointRecord>> {
        let names: Vec<&str> = states.iter().map(|state| state.as_str()).collect();
        // A list of fixed names, checked against the state with a comma on both sides.
        let wanted = if names.is_empty() { None } else { Some(format!(",{},", names.join(","))) };
        let rows: Vec<PointRow> = sqlx::query_as(
            "SELECT p.ordinal, p.parameters, w.key, w.scenario, w.state, w.progress, w.starts, w.error,
                    NULL AS summary, NULL AS provenance
             FROM point p JOIN work w ON w.key = p.work_key
             WHERE p.sweep_id = ?1 AND p.ordinal > ?2 AND (?3 IS NULL OR instr(?3, ',' || w.state || ',') > 0)
             ORDER BY p.ordinal LIMIT ?4",
        )
        .bind(sweep_id)
        .bind(after)
        .bind(wanted)
        .bind(limit)
        .fetch_all(&self.pool)
        .await?;
        rows.into_iter().map(PointRow::record).collect()
    }

    /// One point with its summary; none if there is no such point.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn point(&self, sweep_id: &str, ordinal: i64) -> Result<Option<PointRecord>> {
        let row: Option<PointRow> = sqlx::query_as(
            "SELECT p.ordinal, p.parameters, w.key, w.scenario, w.state, w.progress, w.starts, w.error,
                    r.summary, r.provenance
             FROM point p JOIN work w ON w.key = p.work_key LEFT JOIN result r ON r.work_key = w.key
             WHERE p.sweep_id = ?1 AND p.ordinal = ?2",
        )
        .bind(sweep_id)
        .bind(ordinal)
        .fetch_optional(&self.pool)
        .await?;
        row.map(PointRow::record).transpose()
    }

    /// One row a point, for the sweep's table, in order.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn table_rows(&self, sweep_id: &str) -> Result<Vec<TableRecord>> {
        type Row = (i64, String, String, Option<String>, Option<String>);
        let rows: Vec<Row> = sqlx::query_as(
            "SELECT p.ordinal, p.parameters, w.state, r.summary, w.error
             FROM point p JOIN work w ON w.key = p.work_key LEFT JOIN result r ON r.work_key = w.key
             WHERE p.sweep_id = ?1 ORDER BY p.ordinal",
        )
        .bind(sweep_id)
        .fetch_all(&self.pool)
        .await?;
        rows.into_iter()
            .map(|(ordinal, parameters_json, state, summary_json, error_json)| {
                Ok(TableRecord {
                    ordinal,
                    parameters_json,
                    state: WorkState::parse(&state)?,
                    summary_json,
                    error_json,
                })
            })
            .collect()
    }

    /// Artifacts of a result, by name; none before it is there.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn artifacts(&self, key: &WorkKey) -> Result<Vec<Artifact>> {
        Ok(sqlx::query_as(
            "SELECT name, media_type, blob, bytes, row_count FROM artifact WHERE work_key = ?1 ORDER BY name",
        )
        .bind(key.as_slice())
        .fetch_all(&self.pool)
        .await?)
    }

    /// How many of the given keys have a result already.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn known_results(&self, keys: &[WorkKey]) -> Result<u64> {
        let mut known = 0;
        for key in keys {
            let found: Option<i64> = sqlx::query_scalar("SELECT 1 FROM result WHERE work_key = ?1")
                .bind(key.as_slice())
                .fetch_optional(&self.pool)
                .await?;
            known += u64::from(found.is_some());
        }
        Ok(known)
    }

    /// Cancels a sweep: its points that no other live sweep wants are cancelled, those under way as soon as their
    /// worker hears of it. False if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn cancel_sweep(&self, id: &str) -> Result<bool> {
        let mut tx = self.write().await?;
        let changed = sqlx::query("UPDATE sweep SET cancelled = 1, version = version + 1 WHERE id = ?1")
            .bind(id)
            .execute(&mut *tx)
            .await?
            .rows_affected();
        if changed == 0 {
            return Ok(false);
        }
        let unwanted: Vec<(Vec<u8>, String)> = sqlx::query_as(
            "SELECT w.key, w.state FROM work w
             WHERE w.key IN (SELECT work_key FROM point WHERE sweep_id = ?1)
               AND w.state IN ('waiting', 'queued', 'leased')
               AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                               WHERE p.work_key = w.key AND s.cancelled = 0)",
        )
        .bind(id)
        .fetch_all(&mut *tx)
        .await?;
        for (key, state) in unwanted {
            let key = work_key(&key)?;
            if WorkState::parse(&state)? == WorkState::Leased {
                sqlx::query("UPDATE work SET cancel_requested = 1 WHERE key = ?1")
                    .bind(key.as_slice())
                    .execute(&mut *tx)
                    .await?;
            } else {
                self.set_state(&mut tx, &key, WorkState::Cancelled).await?;
            }
        }
        self.close_if_finished(&mut tx, id).await?;
        tx.commit().await?;
        Ok(true)
    }

    /// Queues the failed and cancelled points of a sweep again; tells how many, or none if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn retry_sweep(&self, id: &str) -> Result<Option<u64>> {
        let mut tx = self.write().await?;
        let changed = sqlx::query(
            "UPDATE sweep SET cancelled = 0, finished = NULL, version = version + 1 WHERE id = ?1",
        )
        .bind(id)
        .execute(&mut *tx)
        .await?
        .rows_affected();
        if changed == 0 {
            return Ok(None);
        }
        let keys: Vec<Vec<u8>> = sqlx::query_scalar(
            "SELECT DISTINCT key FROM work
             WHERE key IN (SELECT work_key FROM point WHERE sweep_id = ?1) AND state IN ('failed', 'dead', 'cancelled')",
        )
        .bind(id)
        .fetch_all(&mut *tx)
        .await?;
        for key in &keys {
            sqlx::query(
                "UPDATE work SET error = NULL, crash_count = 0, failure_count = 0, progress = 0, cancel_requested = 0,
                                 attempt = attempt + 1 WHERE key = ?1",
            )
            .bind(key)
            .execute(&mut *tx)
            .await?;
            self.set_state(&mut tx, &work_key(key)?, WorkState::Queued).await?;
        }
        sqlx::query("UPDATE work SET cancel_requested = 0 WHERE key IN (SELECT work_key FROM point WHERE sweep_id = ?1)")
            .bind(id)
            .execute(&mut *tx)
            .await?;
        self.close_if_finished(&mut tx, id).await?;
        tx.commit().await?;
        Ok(Some(keys.len() as u64))
    }

    async fn with_counts(&self, row: SweepRow) -> Result<SweepRecord> {
        let groups: Vec<(String, i64, f64)> = sqlx::query_as(
            "SELECT w.state, count(*), total(CASE w.state WHEN 'done' THEN 1.0 ELSE w.progress END)
             FROM point p JOIN work w ON w.key = p.work_key WHERE p.sweep_id = ?1 GROUP BY w.state",
        )
        .bind(&row.id)
        .fetch_all(&self.pool)
        .await?;
        let mut counts = StateCounts { total: row.total, ..StateCounts::default() };
        let mut progress = 0.0;
        for (state, number, part) in groups {
            progress += part;
            *match WorkState::parse(&state)? {
                WorkState::Waiting | WorkState::Queued => &mut counts.queued,
                WorkState::Leased => &mut counts.running,
                WorkState::Done => &mut counts.done,
                WorkState::Failed | WorkState::Dead => &mut counts.failed,
                WorkState::Cancelled => &mut counts.cancelled,
            } += number;
        }
        Ok(SweepRecord {
            id: row.id,
            name: row.name,
            owner: row.owner,
            request_json: row.request,
            priority: row.priority,
            version: row.version,
            is_cancelled: row.cancelled != 0,
            created: row.created,
            finished: row.finished,
            counts,
            progress,
        })
    }

    /// Moves a work item to a state and tells every sweep that has it.
    pub(crate) async fn set_state(
        &self,
        tx: &mut Transaction<'static, Sqlite>,
        key: &WorkKey,
        state: WorkState,
    ) -> Result<()> {
        sqlx::query("UPDATE work SET state = ?2 WHERE key = ?1")
            .bind(key.as_slice())
            .bind(state.as_str())
            .execute(&mut **tx)
            .await?;
        self.announce(tx, key, state).await
    }

    /// Tells every sweep that has the work item of its new state: version, event, end.
    pub(crate) async fn announce(
        &self,
        tx: &mut Transaction<'static, Sqlite>,
        key: &WorkKey,
        state: WorkState,
    ) -> Result<()> {
        sqlx::query(
            "UPDATE sweep SET version = version + 1 WHERE id IN (SELECT sweep_id FROM point WHERE work_key = ?1)",
        )
        .bind(key.as_slice())
        .execute(&mut **tx)
        .await?;
        sqlx::query(concat!(
            "INSERT INTO event (sweep_id, seq, kind, work_key, at)
             SELECT id, version, ?2, ?3, ",
            now!(),
            " FROM sweep WHERE id IN (SELECT sweep_id FROM point WHERE work_key = ?3)"
        ))
        .bind(self.clock_offset_ms)
        .bind(state.as_str())
        .bind(key.as_slice())
        .execute(&mut **tx)
        .await?;
        if matches!(state, WorkState::Done | WorkState::Failed | WorkState::Dead | WorkState::Cancelled) {
            let sweeps: Vec<String> =
                sqlx::query_scalar("SELECT DISTINCT sweep_id FROM point WHERE work_key = ?1")
                    .bind(key.as_slice())
                    .fetch_all(&mut **tx)
                    .await?;
            for sweep in sweeps {
                self.close_if_finished(tx, &sweep).await?;
            }
        }
        Ok(())
    }

    /// Notes the end of a sweep whose points are all final.
    async fn close_if_finished(&self, tx: &mut Transaction<'static, Sqlite>, id: &str) -> Result<()> {
        sqlx::query(concat!(
            "UPDATE sweep SET finished = ",
            now!(),
            " WHERE id = ?2 AND finished IS NULL AND NOT EXISTS (
                 SELECT 1 FROM point p JOIN work w ON w.key = p.work_key
                 WHERE p.sweep_id = ?2 AND w.state IN ('waiting', 'queued', 'leased'))"
        ))
        .bind(self.clock_offset_ms)
        .bind(id)
        .execute(&mut **tx)
        .await?;
        Ok(())
    }
}

/// Where a new sweep's virtual time starts: not before what is being served now, nor before the owner's last point.
async fn start_of_virtual_time(tx: &mut Transaction<'static, Sqlite>, owner: &str) -> Result<i64> {
    Ok(sqlx::query_scalar(
        "SELECT max(
             coalesce((SELECT min(vtime) FROM work WHERE state = 'queued'), 0),
             coalesce((SELECT vtime FROM owner_clock WHERE owner = ?1
                       AND EXISTS (SELECT 1 FROM work WHERE owner = ?1 AND state IN ('queued', 'waiting', 'leased'))), 0))",
    )
    .bind(owner)
    .fetch_one(&mut **tx)
    .await?)
}
