//! Garbage collection by a retention policy.
//!
//! Blobs without a row and without a reservation are deleted after a grace time. The check that a blob is unused and the lock against its
//! reservation are one transaction; the deletion follows outside of it, since an object store may be slow. While the lock lasts the blob
//! cannot be reserved, nor deleted by another collector: a blob that a worker has found to exist cannot vanish, however many collectors run
//! at once.

use std::collections::{BTreeMap, HashSet};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::blob::object::StoredObject;
use crate::engine::database::Transaction;
use crate::engine::query::{Query, query};
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;

/// Blobs that are looked up under one hold of the write lock.
const BATCH: usize = 100;

/// Validity of the note that blobs are being deleted \[ms\].
const REMOVAL_MS: i64 = 600_000;

/// Time for which a collector that has made such a note may delete: one that was stopped for longer deletes no more.
const REMOVAL_TIME: Duration = Duration::from_millis(REMOVAL_MS as u64 / 2);

/// Validity of an idempotency key \[ms\].
const IDEMPOTENCY_MS: i64 = 24 * 3_600_000;

/// Time for which a silent worker stays in the register \[ms\].
const WORKER_MS: i64 = 24 * 3_600_000;

/// Ages at which data expire. Sweeps that are pinned keep everything; summaries and the tables of sweeps are kept as long
/// as their sweeps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RetentionPolicy {
    /// Age at which the artifacts of a name expire.
    pub artifact_ages: BTreeMap<String, Duration>,
    /// Age at which all other artifacts expire.
    pub other_artifacts: Duration,
    /// Age at which events are forgotten.
    pub events: Duration,
    /// Age below which a blob is not deleted, though no row names it: a result may be on its way to its row.
    pub blob_grace: Duration,
}

/// Deletions that were made, or would be.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Garbage {
    /// Expired sweeps.
    pub sweeps: u64,
    /// Results that belonged to no sweep any more.
    pub results: u64,
    /// Artifacts that reached their age; their results keep their summaries.
    pub artifacts: u64,
    /// Scenarios that no work was left of.
    pub scenarios: u64,
    /// Events.
    pub events: u64,
    /// Blobs.
    pub blobs: u64,
    /// Size of the blobs.
    pub blob_bytes: u64,
    /// Parts of uploads that were never finished.
    pub unfinished_uploads: u64,
    /// Size of these parts.
    pub unfinished_bytes: u64,
}

/// Times of the last garbage collection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Collection {
    /// Start of the last one \[ms since the epoch\].
    pub started: i64,
    /// End of the last completed one \[ms since the epoch\].
    pub ended: Option<i64>,
    /// Deletions of that one, as [`Garbage::to_json`] writes them.
    pub deleted_json: Option<String>,
}

impl Garbage {
    /// The numbers as a JSON object, by the names of the fields.
    pub fn to_json(&self) -> Value {
        json!({
            "sweeps": self.sweeps,
            "results": self.results,
            "artifacts": self.artifacts,
            "scenarios": self.scenarios,
            "events": self.events,
            "blobs": self.blobs,
            "blob_bytes": self.blob_bytes,
            "unfinished_uploads": self.unfinished_uploads,
            "unfinished_bytes": self.unfinished_bytes,
        })
    }
}

impl Store {
    /// Deletes expired data and unreferenced blobs, and reports their numbers; a dry run only reports. The time of the last collection is
    /// stored. Each kind of row is deleted in its own transaction, so that other writers wait for one at most.
    ///
    /// # Errors
    /// The database or the object store fails; data deleted until then stay deleted.
    pub async fn collect_garbage(&self, policy: &RetentionPolicy, is_dry_run: bool) -> Result<Garbage> {
        if is_dry_run {
            return self.collect(policy, true).await;
        }
        query(sql::garbage::BEGIN_COLLECTION).scalars::<i64>(&self.database).await?;
        let garbage = self.collect(policy, false).await?;
        query(sql::garbage::END_COLLECTION)
            .bind(garbage.to_json().to_string())
            .execute(&self.database)
            .await?;
        Ok(garbage)
    }

    /// The last collection; none if there was none yet.
    ///
    /// # Errors
    /// The database fails.
    pub async fn last_collection(&self) -> Result<Option<Collection>> {
        let last: Option<(i64, Option<i64>, Option<String>)> =
            query(sql::garbage::LAST_COLLECTION).first(&self.database).await?;
        Ok(last.map(|(started, ended, deleted_json)| Collection { started, ended, deleted_json }))
    }

    async fn collect(&self, policy: &RetentionPolicy, is_dry_run: bool) -> Result<Garbage> {
        let mut garbage = Garbage::default();
        let mut tx = self.write().await?;
        let now: i64 = query(sql::clock::NOW).scalar(&mut tx).await?;
        garbage.sweeps = delete_expired_sweeps(&mut tx, now).await?;
        tx = self.go_on(tx, is_dry_run).await?;
        garbage.results = delete_unwanted_work(&mut tx).await?;
        tx = self.go_on(tx, is_dry_run).await?;
        garbage.scenarios = delete_unused_scenarios(&mut tx).await?;
        tx = self.go_on(tx, is_dry_run).await?;
        garbage.artifacts = expire_artifacts(&mut tx, policy, now).await?;
        tx = self.go_on(tx, is_dry_run).await?;
        garbage.events = delete_old_rows(&mut tx, policy, now).await?;
        let named: HashSet<String> =
            query(sql::garbage::BLOBS_IN_USE).scalars(&mut tx).await?.into_iter().collect();
        if is_dry_run {
            tx.rollback().await?;
        } else {
            tx.commit().await?;
        }

        let cutoff = now.saturating_sub(milliseconds(policy.blob_grace));
        let unnamed = self.blobs().objects_before(cutoff).await?;
        let unnamed: Vec<StoredObject> = unnamed
            .into_iter()
            .filter(|object| object.blob().is_none_or(|blob| !named.contains(&blob)))
            .collect();
        for batch in unnamed.chunks(BATCH) {
            let deleted = if is_dry_run { batch.to_vec() } else { self.delete_unnamed(batch).await? };
            garbage.blobs += deleted.len() as u64;
            garbage.blob_bytes += deleted.iter().map(|object| object.bytes).sum::<u64>();
        }
        for batch in self.blobs().unfinished_uploads(cutoff).await?.chunks(BATCH) {
            let deleted =
                if is_dry_run { self.unreserved(batch).await? } else { self.delete_unnamed(batch).await? };
            garbage.unfinished_uploads += deleted.len() as u64;
            garbage.unfinished_bytes += deleted.iter().map(|object| object.bytes).sum::<u64>();
        }
        if !is_dry_run {
            // Pages that were freed go back to the file system with the next checkpoint of the log.
            query(sql::garbage::TRUNCATE_LOG).scalars::<i64>(&self.database).await?;
        }
        Ok(garbage)
    }

    /// Lets others write between two steps. A dry run undoes them all together in the end.
    async fn go_on(&self, tx: Transaction, is_dry_run: bool) -> Result<Transaction> {
        if is_dry_run {
            return Ok(tx);
        }
        tx.commit().await?;
        self.write().await
    }

    /// Deletes objects without a row and without a reservation, and unfinished uploads without a reservation.
    async fn delete_unnamed(&self, objects: &[StoredObject]) -> Result<Vec<StoredObject>> {
        let began = Instant::now();
        let mut unwanted = Vec::new();
        let mut tx = self.write().await?;
        for object in objects {
            let Some(blob) = object.blob() else {
                unwanted.push((object, None));
                continue;
            };
            let is_wanted = match object.is_upload() {
                true => unreserved(&blob).scalars::<String>(&mut tx).await?.is_empty(),
                false => query(sql::garbage::IS_BLOB_IN_USE).bind(&blob).scalar(&mut tx).await?,
            };
            if is_wanted {
                continue;
            }
            let begin = query(sql::garbage::BEGIN_REMOVAL).bind(&blob).bind(REMOVAL_MS);
            // If another collector deletes it, somebody may write it again as soon as that is done.
            if let Some(until) = begin.first_scalar::<i64>(&mut tx).await? {
                unwanted.push((object, Some((blob, until))));
            }
        }
        tx.commit().await?;
        let mut deleted = Vec::new();
        let mut failure = None;
        for (object, removal) in unwanted {
            if failure.is_none() && began.elapsed() <= REMOVAL_TIME {
                match self.blobs().delete(object).await {
                    Ok(()) => deleted.push(object.clone()),
                    // The object store may still execute the request: the note stays until it runs out.
                    Err(error) => {
                        failure = Some(error);
                        continue;
                    }
                }
            }
            if let Some((blob, until)) = removal {
                query(sql::garbage::END_REMOVAL).bind(blob).bind(until).execute(&self.database).await?;
            }
        }
        failure.map_or(Ok(deleted), Err)
    }

    /// Unfinished uploads, of those given, that are of no reserved blob.
    async fn unreserved(&self, uploads: &[StoredObject]) -> Result<Vec<StoredObject>> {
        let mut found = Vec::new();
        for upload in uploads {
            let is_reserved = match upload.blob() {
                Some(blob) => unreserved(&blob).scalars::<String>(&self.database).await?.is_empty(),
                None => false,
            };
            if !is_reserved {
                found.push(upload.clone());
            }
        }
        Ok(found)
    }
}

/// Gives a blob's name unless it is reserved.
fn unreserved(blob: &str) -> Query {
    query(sql::reservation::UNRESERVED).bind(json!([blob]).to_string())
}

/// Sweeps take their points, events and idempotency keys along.
async fn delete_expired_sweeps(tx: &mut Transaction, now: i64) -> Result<u64> {
    query(sql::garbage::DELETE_SWEEPS).bind(now).execute(&mut *tx).await
}

/// Deletes final work without a point, with its result and artifacts.
async fn delete_unwanted_work(tx: &mut Transaction) -> Result<u64> {
    let results = query(sql::garbage::DELETE_RESULTS).execute(&mut *tx).await?;
    query(sql::garbage::DELETE_WORK).execute(&mut *tx).await?;
    Ok(results)
}

/// Bases that no work changes any more.
async fn delete_unused_scenarios(tx: &mut Transaction) -> Result<u64> {
    query(sql::garbage::DELETE_SCENARIOS).execute(&mut *tx).await
}

/// Marks expired artifacts. An artifact is as young as the youngest sweep that has it.
async fn expire_artifacts(tx: &mut Transaction, policy: &RetentionPolicy, now: i64) -> Result<u64> {
    let names: Vec<String> = query(sql::garbage::ARTIFACT_NAMES).scalars(&mut *tx).await?;
    let mut expired = 0;
    for name in names {
        let age = policy.artifact_ages.get(&name).unwrap_or(&policy.other_artifacts);
        expired += query(sql::garbage::EXPIRE_ARTIFACTS)
            .bind(&name)
            .bind(now)
            .bind(now.saturating_sub(milliseconds(*age)))
            .execute(&mut *tx)
            .await?;
    }
    Ok(expired)
}

/// Deletes expired events, idempotency keys, workers and owners' turns; returns the number of events.
async fn delete_old_rows(tx: &mut Transaction, policy: &RetentionPolicy, now: i64) -> Result<u64> {
    let events = query(sql::garbage::DELETE_EVENTS)
        .bind(now.saturating_sub(milliseconds(policy.events)))
        .execute(&mut *tx)
        .await?;
    for (statement, age) in
        [(sql::garbage::DELETE_IDEMPOTENCY_KEYS, IDEMPOTENCY_MS), (sql::garbage::DELETE_WORKERS, WORKER_MS)]
    {
        query(statement).bind(now - age).execute(&mut *tx).await?;
    }
    query(sql::garbage::DELETE_RESERVATIONS).execute(&mut *tx).await?;
    query(sql::garbage::DELETE_REMOVALS).execute(&mut *tx).await?;
    query(sql::garbage::DELETE_SESSIONS).execute(&mut *tx).await?;
    query(sql::garbage::DELETE_TURNS).execute(&mut *tx).await?;
    Ok(events)
}

fn milliseconds(age: Duration) -> i64 {
    i64::try_from(age.as_millis()).unwrap_or(i64::MAX)
}
