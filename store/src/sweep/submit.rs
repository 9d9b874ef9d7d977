//! Submitting a sweep.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use serde_json::{Value, json};

use crate::engine::database::Transaction;
use crate::engine::query::{ROWS_AT_ONCE, Session, Statement, query};
use crate::engine::sql;
use crate::error::{Result, StoreError};
use crate::store::Store;
use crate::work::order::{Order, PLACE_OF_A_POINT, POINTS_AT_ONCE, end_of_order};
use crate::work::state::{WorkKey, work_key};

/// Points of a sweep from which on the tables are counted again for the planner; it does so itself within a minute or so.
const ANALYZED_FROM: usize = 10_000;

/// A sweep to store.
#[derive(Debug, Clone)]
pub struct NewSweep {
    /// Identifier, a UUID of version 7.
    pub id: String,
    /// A name for people.
    pub name: Option<String>,
    /// Owner, whose share of the workers it counts against.
    pub owner: String,
    /// The request as JSON.
    pub request_json: String,
    /// Names of the parameters that it varies, as a JSON array.
    pub varied_json: String,
    /// Higher goes first.
    pub priority: i64,
    /// Words to find it by, as a JSON array.
    pub tags_json: String,
    /// Policy for points whose result is known.
    pub cache: CachePolicy,
    /// The client's idempotency key with the hash of the request's body.
    pub idempotency_key: Option<(String, [u8; 32])>,
    /// The scenario that the points change, as JSON text.
    pub base_json: String,
    /// Version of the numbers that the keys were made for.
    pub physics_version: i64,
    /// The points, ordinals from 1.
    pub points: Vec<NewPoint>,
    /// The reference runs that verify some of them.
    pub verification: NewVerification,
}

/// A point of a sweep to store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewPoint {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Content hash.
    pub work_key: WorkKey,
    /// Key of work whose result has all that this point requests, and more: if that result is there it is taken, and nothing computed.
    pub fuller_key: Option<WorkKey>,
    /// Changes to the base scenario, as a JSON object by path.
    pub changes_json: String,
}

/// Runs that verify points of a sweep; none unless there are some.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NewVerification {
    /// The scenario that the runs change, as JSON text.
    pub base_json: String,
    /// The runs, each with the ordinal of the point that it verifies.
    pub runs: Vec<NewPoint>,
}

/// Points to add to a sweep.
#[derive(Debug, Clone, Copy)]
pub struct Addition<'a> {
    /// The scenario that the points change, as JSON text.
    pub base_json: &'a str,
    /// Version of the numbers that the keys were made for.
    pub physics_version: i64,
    /// The points, ordinals from 1: the order in which they get theirs in the sweep.
    pub points: &'a [NewPoint],
    /// The runs that verify some of them, by the ordinals of `points`; those of points that the sweep has already are left out.
    pub verification: &'a NewVerification,
    /// The request as JSON.
    pub request_json: &'a str,
}

/// Policy for points that were computed before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CachePolicy {
    /// Their result is taken.
    #[default]
    Reuse,
    /// They are recomputed, failed ones too. The old result stays until a new one takes its place; if sweeps of other owners have
    /// it, it stays theirs, and the new one is this sweep's.
    Refresh,
    /// Their result is taken, or that they failed; a sweep with other points is not stored.
    Only,
}

/// Outcome of adding points to a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AppendOutcome {
    /// Number of points added; the sweep had the others already.
    Added(u64),
    /// The sweep would have this many points, which is too many; nothing is changed.
    TooMany(u64),
    /// The sweep is cancelled; nothing is changed.
    Cancelled,
    /// The sweep's points are of this version of the numbers, the new ones of another; nothing is changed.
    OtherNumbers(i64),
    /// There is no such sweep.
    NoSuchSweep,
}

/// Sweep and owner whose work is inserted, and how.
struct Wanted<'a> {
    sweep_id: &'a str,
    order: Order,
    owner: &'a str,
    priority: i64,
    physics_version: i64,
    cache: CachePolicy,
    is_paused: bool,
}

/// Role of a row of the table `point`.
#[derive(Clone, Copy)]
enum Role {
    /// A point of the sweep.
    Point,
    /// The run that verifies a point.
    Verification,
}

/// Outcome of a submission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SubmitOutcome {
    /// It is stored.
    Created,
    /// The same request was stored before under the same idempotency key, as this sweep.
    Known(String),
    /// Under [`CachePolicy::Only`]: some have not been computed, and nothing is stored.
    NotComputed {
        /// Ordinals of points.
        points: Vec<i64>,
        /// Ordinals of points whose verification has not been computed.
        verifications: Vec<i64>,
    },
}

impl Store {
    /// Stores a sweep with all its points. It is visible once all of them are stored; a large one does not block other writers, and its
    /// first points may be computed before. Known work is reused, unless the sweep requests recomputation: a finished point counts at once,
    /// a failed one stays failed, a cancelled one is queued again.
    ///
    /// If the call is dropped, [`finish_partial_changes`](Self::finish_partial_changes) removes the remains.
    ///
    /// # Errors
    /// The idempotency key was used for another request, or the database fails.
    pub async fn submit_sweep(&self, sweep: &NewSweep) -> Result<SubmitOutcome> {
        if sweep.cache == CachePolicy::Only {
            let mut connection = self.database.read().await?;
            if let Some(known) = known_sweep(&mut connection, sweep).await? {
                return Ok(SubmitOutcome::Known(known));
            }
            let points = with_fuller(&mut connection, &sweep.points).await?;
            let runs = with_fuller(&mut connection, &sweep.verification.runs).await?;
            let points = not_computed(&mut connection, &points).await?;
            let verifications = not_computed(&mut connection, &runs).await?;
            if !points.is_empty() || !verifications.is_empty() {
                return Ok(SubmitOutcome::NotComputed { points, verifications });
            }
        }
        let mut tx = self.write().await?;
        if let Some(known) = known_sweep(&mut tx, sweep).await? {
            return Ok(SubmitOutcome::Known(known));
        }
        let now: i64 = query(sql::clock::NOW).scalar(&mut tx).await?;
        insert_sweep(&mut tx, sweep, now).await?;
        let order = end_of_order(&mut tx, &sweep.owner).await?;
        match self.store_points(tx, sweep, order, now).await {
            Ok(()) => Ok(SubmitOutcome::Created),
            Err(error) => {
                // Its remains are hidden, and if this fails too they are taken away later.
                if let Err(error) = self.take_away(&sweep.id).await {
                    tracing::warn!(%error, sweep = sweep.id, "a partially stored sweep is left to a later cleanup");
                }
                Err(error)
            }
        }
    }

    /// Stores the points of a hidden sweep in parts, so that other writers wait for one part at most, and shows it.
    async fn store_points(
        &self,
        mut tx: Transaction,
        sweep: &NewSweep,
        order: Order,
        now: i64,
    ) -> Result<()> {
        let wanted = Wanted {
            sweep_id: &sweep.id,
            order,
            owner: &sweep.owner,
            priority: sweep.priority,
            physics_version: sweep.physics_version,
            cache: sweep.cache,
            is_paused: false,
        };
        let at_once = POINTS_AT_ONCE as usize;
        let points = sweep.points.chunks(at_once).map(|rows| (Role::Point, &sweep.base_json, rows));
        let runs = sweep.verification.runs.chunks(at_once);
        let runs = runs.map(|rows| (Role::Verification, &sweep.verification.base_json, rows));
        let mut place = order.last;
        let mut is_first = true;
        for (role, base_json, rows) in points.chain(runs) {
            if !is_first {
                // A crash may lose parts of a hidden sweep, which no answer has reported. Showing it makes all of it durable.
                tx.commit_for_now().await?;
                tx = self.write().await?;
                still_hidden(&mut tx, sql::submit::KEEP_HIDDEN, &sweep.id).await?;
            }
            is_first = false;
            let (rows, copied) = match sweep.cache {
                CachePolicy::Reuse | CachePolicy::Only => (with_fuller(&mut tx, rows).await?, Vec::new()),
                CachePolicy::Refresh => apart(&mut tx, sweep, rows).await?,
            };
            let base = insert_base(&mut tx, base_json).await?;
            insert_work(&mut tx, &wanted, base, &rows, place, now).await?;
            copy_results(&mut tx, &copied).await?;
            insert_points(&mut tx, &sweep.id, role, &rows).await?;
            count(&mut tx, &sweep.id, role, &rows, now).await?;
            place += PLACE_OF_A_POINT * rows.len() as i64;
        }
        if sweep.points.len() >= ANALYZED_FROM {
            // Before it is seen, so that it is read by plans for its size, and while others may write. It can be read without.
            tx.commit_for_now().await?;
            if let Err(error) = query(sql::submit::ANALYZE).execute(&self.database).await {
                tracing::warn!(%error, "the planner's statistics could not be updated");
            }
            tx = self.write().await?;
        }
        still_hidden(&mut tx, sql::submit::SHOW, &sweep.id).await?;
        tx.commit().await
    }

    /// Ordinals of the points that a sweep lacks: those that [`append_points`](Self::append_points) would add.
    ///
    /// # Errors
    /// The database fails.
    pub async fn lacking_points(&self, sweep_id: &str, points: &[NewPoint]) -> Result<Vec<i64>> {
        let mut connection = self.database.read().await?;
        Ok(lacking(&mut connection, sweep_id, points).await?.iter().map(|point| point.ordinal).collect())
    }

    /// Adds points to a sweep, but for those that it has already; their ordinals are given here, going on from its last
    /// point. The request is noted with the sweep's own, unless the sweep has all of its points. A sweep has at most
    /// `limit` points.
    ///
    /// # Errors
    /// The database fails.
    pub async fn append_points(
        &self,
        sweep_id: &str,
        addition: &Addition<'_>,
        limit: u64,
    ) -> Result<AppendOutcome> {
        let Addition { base_json, physics_version, points, verification, request_json } = *addition;
        let mut tx = self.write().await?;
        let sweep: Option<(String, i64, i64, bool, bool)> =
            query(sql::submit::EXTENDED_SWEEP).bind(sweep_id).first(&mut tx).await?;
        let Some((owner, priority, known, cancelled, paused)) = sweep else {
            return Ok(AppendOutcome::NoSuchSweep);
        };
        if cancelled {
            return Ok(AppendOutcome::Cancelled);
        }
        let version: Option<i64> =
            query(sql::submit::VERSION_OF_POINTS).bind(sweep_id).first_scalar(&mut tx).await?;
        if let Some(other) = version.filter(|version| *version != physics_version) {
            return Ok(AppendOutcome::OtherNumbers(other));
        }
        let mut fresh = lacking(&mut tx, sweep_id, points).await?;
        if fresh.is_empty() {
            return Ok(AppendOutcome::Added(0));
        }
        let mut ordinals = HashMap::new();
        for (point, ordinal) in fresh.iter_mut().zip(known + 1..) {
            ordinals.insert(point.ordinal, ordinal);
            point.ordinal = ordinal;
        }
        let renumbered =
            |run: &NewPoint| Some(NewPoint { ordinal: *ordinals.get(&run.ordinal)?, ..run.clone() });
        let runs: Vec<NewPoint> = verification.runs.iter().filter_map(renumbered).collect();
        let runs = with_fuller(&mut tx, &runs).await?;
        let total = known.unsigned_abs() + fresh.len() as u64;
        if total > limit {
            return Ok(AppendOutcome::TooMany(total));
        }
        let now: i64 = query(sql::clock::NOW).scalar(&mut tx).await?;
        let wanted = Wanted {
            sweep_id,
            order: end_of_order(&mut tx, &owner).await?,
            owner: &owner,
            priority,
            physics_version,
            cache: CachePolicy::Reuse,
            is_paused: paused,
        };
        insert(&mut tx, &wanted, (base_json, &fresh), (&verification.base_json, &runs), now).await?;
        query(sql::submit::INSERT_APPENDED).bind(sweep_id).bind(request_json).execute(&mut tx).await?;
        query(sql::submit::SET_POINTS).bind(sweep_id).bind(total as i64).execute(&mut tx).await?;
        for (role, rows) in [(Role::Point, fresh.as_slice()), (Role::Verification, &runs)] {
            count(&mut tx, sweep_id, role, rows, now).await?;
        }
        tx.commit().await?;
        Ok(AppendOutcome::Added(fresh.len() as u64))
    }

    /// The requests by which points were added to a sweep: the last `limit` of them with at most so much text as `bytes`, in their
    /// order.
    ///
    /// # Errors
    /// The database fails.
    pub async fn appended_requests(&self, sweep_id: &str, limit: i64, bytes: i64) -> Result<Vec<String>> {
        let appended = query(sql::submit::APPENDED).bind(sweep_id).bind(limit).bind(bytes);
        let mut requests: Vec<String> = appended.scalars(&self.database).await?;
        requests.reverse();
        Ok(requests)
    }

    /// Length of all requests by which points were added to a sweep \[bytes\].
    ///
    /// # Errors
    /// The database fails.
    pub async fn appended_bytes(&self, sweep_id: &str) -> Result<i64> {
        query(sql::submit::APPENDED_BYTES).bind(sweep_id).scalar(&self.database).await
    }

    /// Number of points that have a result already, of their own or by fuller work: their keys with that of the latter.
    ///
    /// # Errors
    /// The database fails.
    pub async fn known_results(&self, keys: &[(WorkKey, Option<WorkKey>)]) -> Result<u64> {
        let mut known = 0;
        for keys in keys.chunks(ROWS_AT_ONCE) {
            let fuller: Vec<WorkKey> = keys.iter().filter_map(|(_, fuller)| *fuller).collect();
            let fuller = fuller_results(&self.database, &fuller).await?;
            let own: Vec<&WorkKey> = keys
                .iter()
                .filter(|(_, key)| key.is_none_or(|key| !fuller.contains(&key)))
                .map(|(key, _)| key)
                .collect();
            known += (keys.len() - own.len()) as u64;
            let found: i64 =
                query(sql::submit::KNOWN_RESULTS).bind(list_of(own)).scalar(&self.database).await?;
            known += found.unsigned_abs();
        }
        Ok(known)
    }
}

/// The sweep that was stored before under the same idempotency key.
async fn known_sweep(tx: &mut Transaction, sweep: &NewSweep) -> Result<Option<String>> {
    let Some((key, body_hash)) = &sweep.idempotency_key else { return Ok(None) };
    let known: Option<(Vec<u8>, String, bool)> =
        query(sql::submit::KNOWN_SWEEP).bind(&sweep.owner).bind(key).first(&mut *tx).await?;
    match known {
        None => Ok(None),
        Some((known_hash, ..)) if known_hash != body_hash => Err(StoreError::IdempotencyConflict),
        Some((_, _, true)) => Err(StoreError::Arriving),
        Some((_, id, false)) => Ok(Some(id)),
    }
}

async fn insert_sweep(tx: &mut Transaction, sweep: &NewSweep, now: i64) -> Result<()> {
    query(sql::submit::INSERT_SWEEP)
        .bind(&sweep.id)
        .bind(sweep.name.as_deref())
        .bind(&sweep.owner)
        .bind(&sweep.request_json)
        .bind(sweep.priority)
        .bind(sweep.points.len() as i64)
        .bind(now)
        .bind(&sweep.tags_json)
        .bind(sweep.cache == CachePolicy::Refresh)
        .bind(&sweep.varied_json)
        .execute(&mut *tx)
        .await?;
    if let Some((key, body_hash)) = &sweep.idempotency_key {
        query(sql::submit::INSERT_IDEMPOTENCY_KEY)
            .bind(&sweep.owner)
            .bind(key)
            .bind(body_hash.as_slice())
            .bind(&sweep.id)
            .bind(now)
            .execute(&mut *tx)
            .await?;
    }
    Ok(())
}

/// Keys as statements take them: a JSON array of hexadecimal digits.
fn list_of<'k>(keys: impl IntoIterator<Item = &'k WorkKey>) -> String {
    keys.into_iter().map(hexadecimal).collect::<Value>().to_string()
}

fn hexadecimal(key: &WorkKey) -> String {
    blake3::Hash::from_bytes(*key).to_string()
}

/// The points, those for which fuller work has a result as points of that work.
async fn with_fuller<'p>(
    connection: &mut Transaction,
    points: &'p [NewPoint],
) -> Result<Cow<'p, [NewPoint]>> {
    let mut all = Cow::from(points);
    for (start, chunk) in (0..).step_by(ROWS_AT_ONCE).zip(points.chunks(ROWS_AT_ONCE)) {
        let fuller: Vec<WorkKey> = chunk.iter().filter_map(|point| point.fuller_key).collect();
        let found = fuller_results(&mut *connection, &fuller).await?;
        for (index, point) in (start..).zip(chunk) {
            if let Some(key) = point.fuller_key.filter(|key| found.contains(key)) {
                all.to_mut()[index].work_key = key;
            }
        }
    }
    Ok(all)
}

/// The points, those whose results sweeps of other owners have as points of work of their own; and the keys of both.
async fn apart<'p>(
    tx: &mut Transaction,
    sweep: &NewSweep,
    points: &'p [NewPoint],
) -> Result<(Cow<'p, [NewPoint]>, Vec<(WorkKey, WorkKey)>)> {
    let keys = list_of(points.iter().map(|point| &point.work_key));
    let found: Vec<Vec<u8>> =
        query(sql::submit::OTHERS_RESULTS).bind(keys).bind(&sweep.owner).scalars(&mut *tx).await?;
    let found: HashSet<&[u8]> = found.iter().map(Vec::as_slice).collect();
    let (mut all, mut keys) = (Cow::from(points), Vec::new());
    for (index, point) in points.iter().enumerate() {
        if found.contains(point.work_key.as_slice()) {
            let own = key_apart(&point.work_key, &sweep.id);
            keys.push((point.work_key, own));
            all.to_mut()[index].work_key = own;
        }
    }
    Ok((all, keys))
}

/// The key of work that a sweep has for itself, of the scenario of another key.
fn key_apart(key: &WorkKey, sweep_id: &str) -> WorkKey {
    *blake3::Hasher::new().update(key).update(sweep_id.as_bytes()).finalize().as_bytes()
}

/// Gives work that a sweep has for itself the results that it is to recompute, to be shown and compared.
async fn copy_results(tx: &mut Transaction, keys: &[(WorkKey, WorkKey)]) -> Result<()> {
    if keys.is_empty() {
        return Ok(());
    }
    let pairs: Value = keys.iter().map(|(from, to)| json!([hexadecimal(from), hexadecimal(to)])).collect();
    for statement in [sql::submit::COPY_RESULTS, sql::submit::COPY_ARTIFACTS] {
        query(statement).bind(pairs.to_string()).execute(&mut *tx).await?;
    }
    Ok(())
}

/// Keys of work that has a result with all its tables, and is not being recomputed.
async fn fuller_results<'c>(session: impl Into<Session<'c>>, keys: &[WorkKey]) -> Result<HashSet<WorkKey>> {
    if keys.is_empty() {
        return Ok(HashSet::new());
    }
    let found: Vec<Vec<u8>> = query(sql::submit::FULLER_RESULTS).bind(list_of(keys)).scalars(session).await?;
    found.iter().map(|key| work_key(key)).collect()
}

/// Ordinals of the points that have neither a result nor failed.
async fn not_computed(tx: &mut Transaction, points: &[NewPoint]) -> Result<Vec<i64>> {
    let mut missing = Vec::new();
    for points in points.chunks(ROWS_AT_ONCE) {
        let keys = points.iter().map(|point| &point.work_key);
        let known: Vec<Vec<u8>> =
            query(sql::submit::KNOWN_WORK).bind(list_of(keys)).scalars(&mut *tx).await?;
        let known: HashSet<&[u8]> = known.iter().map(Vec::as_slice).collect();
        let is_missing = |point: &&NewPoint| !known.contains(point.work_key.as_slice());
        missing.extend(points.iter().filter(is_missing).map(|point| point.ordinal));
    }
    Ok(missing)
}

/// The points that a sweep has not, each once; those for which fuller work has a result as points of that work.
async fn lacking(connection: &mut Transaction, sweep_id: &str, points: &[NewPoint]) -> Result<Vec<NewPoint>> {
    let points = with_fuller(connection, points).await?;
    let apart = |key: &WorkKey| key_apart(key, sweep_id);
    let keys: Vec<WorkKey> =
        points.iter().flat_map(|point| [point.work_key, apart(&point.work_key)]).collect();
    let known: HashSet<WorkKey> = points_of(connection, sweep_id, &keys)
        .await?
        .iter()
        .map(|key| work_key(key))
        .collect::<Result<_>>()?;
    let keys = points.iter().map(|point| point.work_key);
    let mut seen: HashSet<WorkKey> =
        keys.filter(|key| known.contains(key) || known.contains(&apart(key))).collect();
    Ok(points.iter().filter(|point| seen.insert(point.work_key)).cloned().collect())
}

/// The given keys that the sweep has points of.
async fn points_of(connection: &mut Transaction, sweep_id: &str, keys: &[WorkKey]) -> Result<Vec<Vec<u8>>> {
    let mut found = Vec::new();
    for keys in keys.chunks(ROWS_AT_ONCE) {
        found.extend(
            query(sql::submit::POINTS_OF)
                .bind(sweep_id)
                .bind(list_of(keys))
                .scalars(&mut *connection)
                .await?,
        );
    }
    Ok(found)
}

/// Stores a base scenario by the hash of its text, unless it is there.
async fn insert_base(tx: &mut Transaction, text: &str) -> Result<[u8; 32]> {
    let hash = *blake3::hash(text.as_bytes()).as_bytes();
    query(sql::submit::INSERT_SCENARIO).bind(hash.as_slice()).bind(text).execute(&mut *tx).await?;
    Ok(hash)
}

/// Stores points of a sweep, the runs that verify some of them, and the work behind both, at the end of its owner's order:
/// the points first. Each with the base that they change.
async fn insert(
    tx: &mut Transaction,
    wanted: &Wanted<'_>,
    points: (&str, &[NewPoint]),
    verification: (&str, &[NewPoint]),
    now: i64,
) -> Result<()> {
    let mut place = wanted.order.last;
    for (role, (base_json, rows)) in [(Role::Point, points), (Role::Verification, verification)] {
        if rows.is_empty() {
            continue;
        }
        let base = insert_base(tx, base_json).await?;
        for rows in rows.chunks(ROWS_AT_ONCE) {
            insert_work(tx, wanted, base, rows, place, now).await?;
            insert_points(tx, wanted.sweep_id, role, rows).await?;
            place += PLACE_OF_A_POINT * rows.len() as i64;
        }
    }
    Ok(())
}

async fn insert_work(
    tx: &mut Transaction,
    wanted: &Wanted<'_>,
    base: [u8; 32],
    points: &[NewPoint],
    place: i64,
    now: i64,
) -> Result<()> {
    let rows = points.iter().map(|point| json!([hexadecimal(&point.work_key), point.changes_json]));
    query(sql::submit::INSERT_WORK)
        .bind(rows.collect::<Value>().to_string())
        .bind(place)
        .bind(PLACE_OF_A_POINT)
        .bind(base.as_slice())
        .bind(wanted.physics_version)
        .bind(wanted.owner)
        .bind(wanted.is_paused)
        .bind(wanted.priority)
        .bind(now)
        .bind(wanted.cache == CachePolicy::Refresh)
        .bind(wanted.order.first)
        .execute(&mut *tx)
        .await?;
    Ok(())
}

async fn insert_points(tx: &mut Transaction, sweep_id: &str, role: Role, points: &[NewPoint]) -> Result<()> {
    let rows = points
        .iter()
        .map(|point| json!([point.ordinal, hexadecimal(&point.work_key), point.parameters_json]));
    query(sql::submit::INSERT_POINTS)
        .bind(sweep_id)
        .bind(matches!(role, Role::Verification))
        .bind(rows.collect::<Value>().to_string())
        .execute(&mut *tx)
        .await?;
    Ok(())
}

/// Counts points of a sweep that are new, or runs that verify points; from then on the counts follow the work.
async fn count(tx: &mut Transaction, id: &str, role: Role, rows: &[NewPoint], now: i64) -> Result<()> {
    let ordinals: Value = rows.iter().map(|row| row.ordinal).collect();
    query(sql::submit::COUNT)
        .bind(id)
        .bind(ordinals.to_string())
        .bind(now)
        .bind(matches!(role, Role::Verification))
        .execute(&mut *tx)
        .await?;
    Ok(())
}

/// Runs a statement about a sweep that is hidden while its points are stored.
async fn still_hidden(tx: &mut Transaction, statement: Statement, id: &str) -> Result<()> {
    match query(statement).bind(id).execute(&mut *tx).await? {
        1 => Ok(()),
        _ => Err(StoreError::TakenAway),
    }
}
