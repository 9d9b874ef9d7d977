//! Submitting a sweep.

use sqlx::{QueryBuilder, Sqlite, Transaction};

use crate::connection::{Store, now};
use crate::error::{Result, StoreError};
use crate::state::WorkKey;

/// Virtual time that one point costs its owner; the claim order is by virtual time, so that owners take turns
/// however many points each has (start-time fair queueing).
pub(crate) const COST_OF_A_POINT: i64 = 1_000;

/// Rows of one statement: enough that the calls do not count, few enough for the parameters that SQLite takes.
const ROWS_AT_ONCE: usize = 1_000;

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
    /// The scenario that the points change, as JSON text.
    pub base_json: String,
    /// Version of the numbers that the keys were made for.
    pub physics_version: i64,
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
    /// What it changes in the base scenario, as a JSON object by path.
    pub changes_json: String,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SubmitOutcome {
    /// It is stored.
    Created,
    /// The same request was stored before under the same idempotency key, as this sweep.
    Known(String),
}

impl Store {
    /// Stores a sweep with all its points in one transaction. Work that is known is not done again: a finished point
    /// counts at once, a failed one stays failed, a cancelled one is queued again.
    ///
    /// # Errors
    /// When the idempotency key was used for another request, or the database fails.
    pub async fn submit_sweep(&self, sweep: &NewSweep) -> Result<SubmitOutcome> {
        let mut tx = self.write().await?;
        if let Some(known) = known_sweep(&mut tx, sweep).await? {
            return Ok(SubmitOutcome::Known(known));
        }
        let now: i64 = sqlx::query_scalar(concat!("SELECT ", now!()))
            .bind(self.clock_offset_ms)
            .fetch_one(&mut *tx)
            .await?;
        insert_sweep(&mut tx, sweep, now).await?;
        let base = insert_base(&mut tx, &sweep.base_json).await?;
        let mut vtime = start_of_virtual_time(&mut tx, &sweep.owner).await?;
        for points in sweep.points.chunks(ROWS_AT_ONCE) {
            insert_work(&mut tx, sweep, points, base, vtime, now).await?;
            insert_points(&mut tx, &sweep.id, points).await?;
            vtime += COST_OF_A_POINT * points.len() as i64;
        }
        count_points(&mut tx, &sweep.id, now).await?;
        tx.commit().await?;
        Ok(SubmitOutcome::Created)
    }

    /// How many of the given keys have a result already.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn known_results(&self, keys: &[WorkKey]) -> Result<u64> {
        let mut known = 0;
        for keys in keys.chunks(ROWS_AT_ONCE) {
            let mut query = QueryBuilder::new("SELECT count(*) FROM result WHERE work_key IN (");
            let mut list = query.separated(", ");
            for key in keys {
                list.push_bind(key.as_slice());
            }
            query.push(")");
            let found: i64 = query.build_query_scalar().fetch_one(&self.pool).await?;
            known += found.unsigned_abs();
        }
        Ok(known)
    }
}

/// The sweep that was stored before under the same idempotency key.
async fn known_sweep(tx: &mut Transaction<'static, Sqlite>, sweep: &NewSweep) -> Result<Option<String>> {
    let Some((key, body_hash)) = &sweep.idempotency_key else { return Ok(None) };
    let known: Option<(Vec<u8>, String)> =
        sqlx::query_as("SELECT body_hash, sweep_id FROM idempotency WHERE owner = ?1 AND key = ?2")
            .bind(&sweep.owner)
            .bind(key)
            .fetch_optional(&mut **tx)
            .await?;
    match known {
        None => Ok(None),
        Some((known_hash, _)) if known_hash != body_hash => Err(StoreError::IdempotencyConflict),
        Some((_, id)) => Ok(Some(id)),
    }
}

async fn insert_sweep(tx: &mut Transaction<'static, Sqlite>, sweep: &NewSweep, now: i64) -> Result<()> {
    sqlx::query(
        "INSERT INTO sweep (id, name, owner, request, priority, points, created) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
    )
    .bind(&sweep.id)
    .bind(&sweep.name)
    .bind(&sweep.owner)
    .bind(&sweep.request_json)
    .bind(sweep.priority)
    .bind(sweep.points.len() as i64)
    .bind(now)
    .execute(&mut **tx)
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
        .execute(&mut **tx)
        .await?;
    }
    Ok(())
}

/// Where a new sweep's virtual time starts: not before what is being served now, nor before the owner's last point.
pub(crate) async fn start_of_virtual_time(tx: &mut Transaction<'static, Sqlite>, owner: &str) -> Result<i64> {
    Ok(sqlx::query_scalar(
        "SELECT max(
             coalesce((SELECT min(vtime) FROM work WHERE state IN ('waiting', 'queued', 'leased')), 0),
             coalesce((SELECT max(vtime) FROM work
                       WHERE owner = ?1 AND state IN ('waiting', 'queued', 'leased')), 0))",
    )
    .bind(owner)
    .fetch_one(&mut **tx)
    .await?)
}

/// Stores a base scenario by the hash of its text, unless it is there.
async fn insert_base(tx: &mut Transaction<'static, Sqlite>, text: &str) -> Result<[u8; 32]> {
    let hash = *blake3::hash(text.as_bytes()).as_bytes();
    sqlx::query("INSERT INTO scenario (hash, text) VALUES (?1, ?2) ON CONFLICT (hash) DO NOTHING")
        .bind(hash.as_slice())
        .bind(text)
        .execute(&mut **tx)
        .await?;
    Ok(hash)
}

async fn insert_work(
    tx: &mut Transaction<'static, Sqlite>,
    sweep: &NewSweep,
    points: &[NewPoint],
    base: [u8; 32],
    vtime: i64,
    now: i64,
) -> Result<()> {
    let mut query = QueryBuilder::new(
        "INSERT INTO work (key, changes, vtime, base, physics_version, owner, state, priority, ready_at, created, changed) ",
    );
    query.push_values((1..).zip(points), |mut row, (number, point)| {
        row.push_bind(point.work_key.as_slice())
            .push_bind(&point.changes_json)
            .push_bind(vtime + COST_OF_A_POINT * number)
            .push_bind(base.to_vec())
            .push_bind(sweep.physics_version)
            .push_bind(&sweep.owner)
            .push("'queued'")
            .push_bind(sweep.priority)
            .push_bind(now)
            .push_bind(now)
            .push_bind(now);
    });
    // Work that is known keeps its row, but for three things: it is taken up again if it was cancelled, it goes as
    // early as the most urgent sweep that wants it, and it is not cancelled any more.
    query.push(
        " ON CONFLICT (key) DO UPDATE SET
             state = CASE state WHEN 'cancelled' THEN 'queued' ELSE state END,
             changed = CASE state WHEN 'cancelled' THEN excluded.changed ELSE changed END,
             owner = CASE state WHEN 'cancelled' THEN excluded.owner ELSE owner END,
             vtime = CASE state WHEN 'cancelled' THEN excluded.vtime ELSE vtime END,
             error = CASE state WHEN 'cancelled' THEN NULL ELSE error END,
             progress = CASE state WHEN 'cancelled' THEN 0 ELSE progress END,
             priority = CASE state WHEN 'cancelled' THEN excluded.priority ELSE max(priority, excluded.priority) END,
             cancel_requested = 0
         WHERE state = 'cancelled'
            OR (state IN ('waiting', 'queued', 'leased') AND (cancel_requested <> 0 OR priority < excluded.priority))",
    );
    query.build().execute(&mut **tx).await?;
    Ok(())
}

async fn insert_points(
    tx: &mut Transaction<'static, Sqlite>,
    sweep_id: &str,
    points: &[NewPoint],
) -> Result<()> {
    let mut query = QueryBuilder::new("INSERT INTO point (sweep_id, ordinal, parameters, work_key) ");
    query.push_values(points, |mut row, point| {
        row.push_bind(sweep_id)
            .push_bind(point.ordinal)
            .push_bind(&point.parameters_json)
            .push_bind(point.work_key.as_slice());
    });
    query.build().execute(&mut **tx).await?;
    Ok(())
}

/// Counts the points of a new sweep once; from then on the counts follow the work.
async fn count_points(tx: &mut Transaction<'static, Sqlite>, id: &str, now: i64) -> Result<()> {
    sqlx::query(
        "UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled, finished) = (
             SELECT coalesce(sum(w.state IN ('waiting', 'queued')), 0),
                    coalesce(sum(w.state = 'leased'), 0),
                    coalesce(sum(w.state = 'done'), 0),
                    coalesce(sum(w.state IN ('failed', 'dead')), 0),
                    coalesce(sum(w.state = 'cancelled'), 0),
                    CASE WHEN coalesce(sum(w.state IN ('waiting', 'queued', 'leased')), 0) = 0 THEN ?2 END
             FROM point p JOIN work w ON w.key = p.work_key WHERE p.sweep_id = ?1)
         WHERE id = ?1",
    )
    .bind(id)
    .bind(now)
    .execute(&mut **tx)
    .await?;
    Ok(())
}
