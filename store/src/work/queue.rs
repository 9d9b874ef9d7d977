//! The queue: claiming work, keeping the lease, ending it.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::blob_id::BlobId;
use crate::engine::database::Transaction;
use crate::engine::query::{Query, ROWS_AT_ONCE, Statement, query};
use crate::engine::sql;
use crate::engine::throttle::LOOK_EVERY;
use crate::error::{Result, StoreError};
use crate::store::Store;
use crate::work::lease::{Lease, Renewal};
use crate::work::reservation::require_reserved;
use crate::work::scenario::ScenarioText;
use crate::work::state::work_key;

/// Deaths of workers after which a point is given up: a poison point must not kill a fleet.
const CRASH_LIMIT: i64 = 3;

/// Tries that infrastructure (disk, object store, database) is given.
const INFRASTRUCTURE_TRIES: i64 = 5;

/// Least wait before the first of these retries \[ms\]; it doubles each time. Up to half as much again is added by chance,
/// so that points which failed together, as when a disk was full, do not come back together.
const FIRST_RETRY_MS: i64 = 5_000;

/// Longest wait before the last of these retries \[ms\].
const LONGEST_RETRY_MS: i64 = (FIRST_RETRY_MS << (INFRASTRUCTURE_TRIES - 2)) * 3 / 2;

/// Work handed to a worker.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Lease that every later write about it must carry.
    pub lease: Lease,
    /// The scenario.
    pub scenario: ScenarioText,
    /// Checkpoint of an earlier attempt.
    pub checkpoint: Option<BlobId>,
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
    /// Ready, but of paused sweeps alone.
    pub held: i64,
    /// Under way.
    pub leased: i64,
}

/// Outcome of a result whose worker claims the next work item.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// True if the result is stored; false if the lease was lost.
    pub is_stored: bool,
    /// The next work item, if the result is stored and one was ready at once.
    pub next: Option<Claim>,
}

/// A result to store.
#[derive(Debug, Clone, Copy)]
pub struct NewResult<'a> {
    /// Scalar results as a JSON object.
    pub summary_json: &'a str,
    /// Provenance of the result, as a JSON object.
    pub provenance_json: &'a str,
    /// Its artifacts.
    pub artifacts: &'a [NewArtifact],
    /// True if summary and artifacts are equal whenever the work is done; false if they hold computing times.
    pub is_repeatable: bool,
}

/// The result that a new one takes the place of.
struct Earlier {
    summary: String,
    provenance: String,
    disagrees: bool,
    blobs: BTreeMap<String, String>,
}

impl Earlier {
    async fn read(tx: &mut Transaction, key: &[u8]) -> Result<Option<Self>> {
        let row: Option<(String, String, bool)> =
            query(sql::queue::EARLIER_RESULT).bind(key).first(&mut *tx).await?;
        let Some((summary, provenance, disagrees)) = row else { return Ok(None) };
        let blobs: Vec<(String, String)> = query(sql::queue::EARLIER_BLOBS).bind(key).rows(&mut *tx).await?;
        Ok(Some(Self { summary, provenance, disagrees, blobs: blobs.into_iter().collect() }))
    }

    /// Parts of a new result that differ from this one: `summary`, and names of artifacts.
    fn differences(&self, result: &NewResult<'_>) -> Vec<String> {
        let mut blobs = self.blobs.clone();
        let mut differences = Vec::new();
        if self.summary != result.summary_json {
            differences.push("summary".to_owned());
        }
        for artifact in result.artifacts {
            if blobs.remove(&artifact.name) != Some(artifact.blob.to_string()) {
                differences.push(artifact.name.clone());
            }
        }
        // Blobs that the new one lacks.
        differences.extend(blobs.into_keys());
        differences
    }
}

impl Store {
    /// Hands out the next work item of the worker's physics version; none if nothing is ready. Owners take turns; of the
    /// owner whose turn it is the most urgent goes first, then the order of requests.
    ///
    /// # Errors
    /// The database fails.
    pub async fn claim(&self, worker: &str, physics_version: i64, lease_ms: i64) -> Result<Option<Claim>> {
        let claim = || claiming(worker, physics_version, lease_ms).rows_of_change(&self.database);
        let has_looked = self.reap_now_and_then().await?;
        let mut rows = claim().await?;
        if rows.is_empty() && !has_looked && self.reap().await?.is_some() {
            rows = claim().await?;
        }
        claimed(rows, worker)
    }

    /// The same in a transaction.
    pub(crate) async fn claim_in(
        &self,
        tx: &mut Transaction,
        worker: &str,
        physics_version: i64,
        lease_ms: i64,
    ) -> Result<Option<Claim>> {
        claimed(claiming(worker, physics_version, lease_ms).rows(tx).await?, worker)
    }

    /// Extends a lease, stores the progress (0 to 1) and reports a requested cancellation.
    ///
    /// # Errors
    /// The database fails.
    pub async fn renew(&self, lease: &Lease, lease_ms: i64, progress: f64) -> Result<Renewal> {
        Ok(Renewal::of(lease.renewing(lease_ms, progress).first_scalar(&self.database).await?))
    }

    /// Stores a result. False if the lease was lost: then nothing is written.
    ///
    /// A recomputed result replaces the earlier one, with its artifacts. If it should be equal and is not, `disagreement` in its provenance
    /// permanently records the difference and the provenance of the earlier result.
    ///
    /// # Errors
    /// The database fails, or a blob is not there.
    pub async fn finish_done(&self, lease: &Lease, result: &NewResult<'_>) -> Result<bool> {
        let finish = with_result(query(sql::queue::FINISH_AT_ONCE), lease, result);
        match finish.rows_of_change::<(String,)>(&self.database).await?.into_iter().next() {
            Some((outcome,)) => is_done(&outcome),
            None => self.replace_result(lease, result).await,
        }
    }

    /// Stores a result, as [`finish_done`](Self::finish_done), and hands the same worker its next work item of a physics version, as
    /// [`claim`](Self::claim): on PostgreSQL by one message and in one transaction. If nothing is ready it does not look for leases that
    /// have run out: `claim` does.
    ///
    /// # Errors
    /// The database fails, or a blob is not there.
    pub async fn finish_and_claim(
        &self,
        lease: &Lease,
        result: &NewResult<'_>,
        physics_version: i64,
        lease_ms: i64,
    ) -> Result<Finished> {
        self.reap_now_and_then().await?;
        let finish = with_result(query(sql::queue::FINISH_AND_CLAIM), lease, result);
        let rows = finish.bind(lease_ms).bind(physics_version).rows::<FinishedRow>(&self.database).await?;
        let Some((outcome, key, fencing_token, base_json, changes_json, checkpoint)) =
            rows.into_iter().next().filter(|(outcome, ..)| outcome != "earlier")
        else {
            if !self.replace_result(lease, result).await? {
                return Ok(Finished { is_stored: false, next: None });
            }
            // The result stays stored whatever becomes of this.
            let next = self.claim(&lease.worker, physics_version, lease_ms).await.unwrap_or_else(|error| {
                tracing::warn!(%error, "no work can be claimed after a result");
                None
            });
            return Ok(Finished { is_stored: true, next });
        };
        let is_stored = is_done(&outcome)?;
        let row = key.zip(fencing_token).zip(base_json.zip(changes_json));
        let row = row.map(|((key, token), (base, changes))| (key, token, base, changes, checkpoint));
        Ok(Finished { is_stored, next: claimed(row.into_iter().collect(), &lease.worker)? })
    }

    /// Stores a result if there is an earlier one, or if statements are no messages, step by step. False if the lease was lost.
    async fn replace_result(&self, lease: &Lease, result: &NewResult<'_>) -> Result<bool> {
        let key = lease.key.as_slice();
        let mut tx = self.write_one().await?;
        let finished: Vec<i64> = query(sql::queue::FINISH)
            .bind(key)
            .bind(lease.fencing_token)
            .bind(&lease.worker)
            .scalars(&mut tx)
            .await?;
        let Some(&now) = finished.first() else { return Ok(false) };
        let earlier = Earlier::read(&mut tx, key).await?;
        query(sql::queue::DELETE_RESULT).bind(key).execute(&mut tx).await?;
        query(sql::queue::INSERT_RESULT)
            .bind(key)
            .bind(result.summary_json)
            .bind(result.provenance_json)
            .bind(now)
            .execute(&mut tx)
            .await?;
        require_reserved(&mut tx, result.artifacts.iter().map(|artifact| artifact.blob)).await?;
        for artifact in result.artifacts {
            query(sql::queue::INSERT_ARTIFACT)
                .bind(key)
                .bind(&artifact.name)
                .bind(&artifact.media_type)
                .bind(artifact.blob.to_string())
                .bind(artifact.bytes)
                .bind(artifact.row_count)
                .execute(&mut tx)
                .await?;
        }
        if let Some(earlier) = earlier.filter(|_| result.is_repeatable) {
            let differences = earlier.differences(result).join(", ");
            if !differences.is_empty() {
                let key = blake3::Hash::from_bytes(lease.key).to_hex();
                tracing::warn!(
                    key = key.as_str(),
                    differences,
                    "a recomputed result differs from the earlier one"
                );
                note_disagreement(&mut tx, lease.key.as_slice(), &differences, &earlier.provenance).await?;
            } else if earlier.disagrees {
                keep_disagreement(&mut tx, lease.key.as_slice(), &earlier.provenance).await?;
            }
        }
        tx.commit().await?;
        self.database.apply_transitions().await;
        Ok(true)
    }

    /// Ends a work item without a result, for good. False if the lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn finish_failed(&self, lease: &Lease, error_json: &str) -> Result<bool> {
        self.leave(sql::queue::FAIL, lease, error_json).await
    }

    /// Ends a work item that was cancelled. If it has been requested again since, it goes back to the queue instead. False if the
    /// lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn finish_cancelled(&self, lease: &Lease, error_json: &str) -> Result<bool> {
        self.leave(sql::queue::CANCEL, lease, error_json).await
    }

    /// Stores the checkpoint of the work, a blob that is written before; the next claim returns it. False if the lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn keep_checkpoint(&self, lease: &Lease, blob: BlobId) -> Result<bool> {
        let mut tx = self.write_one().await?;
        require_reserved(&mut tx, [blob]).await?;
        let changed = query(sql::queue::KEEP_CHECKPOINT)
            .bind(lease.key.as_slice())
            .bind(lease.fencing_token)
            .bind(&lease.worker)
            .bind(blob.to_string())
            .execute(&mut tx)
            .await?;
        tx.commit().await?;
        Ok(changed == 1)
    }

    /// Stores a note about the worker of a lease, for the failure of its point if the worker dies: the text after "the last one", such as
    /// "was ended by signal 9". False if the lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn note_worker(&self, lease: &Lease, note: &str) -> Result<bool> {
        self.leave(sql::queue::NOTE_WORKER, lease, note).await
    }

    /// Gives work back after it brought its worker down in a way that the worker survived, such as a panic: that counts
    /// as a death of the worker, and after three the work is given up. False if the lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn crashed(&self, lease: &Lease, error_json: &str) -> Result<bool> {
        let changed = query(sql::queue::CRASH)
            .bind(lease.key.as_slice())
            .bind(lease.fencing_token)
            .bind(&lease.worker)
            .bind(error_json)
            .bind(CRASH_LIMIT)
            .execute_change(&self.database)
            .await?;
        Ok(changed == 1)
    }

    /// Releases work without counting an attempt, as when a worker has to stop. Work with a requested cancellation ends cancelled. False if
    /// the lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn release(&self, lease: &Lease) -> Result<bool> {
        let changed = query(sql::queue::RELEASE)
            .bind(lease.key.as_slice())
            .bind(lease.fencing_token)
            .bind(&lease.worker)
            .execute_change(&self.database)
            .await?;
        Ok(changed == 1)
    }

    /// Gives work back after the infrastructure failed: retried with increasing delays, and failed at the fifth time.
    /// False if the lease was lost.
    ///
    /// # Errors
    /// The database fails.
    pub async fn retry_later(&self, lease: &Lease, error_json: &str) -> Result<bool> {
        let changed = query(sql::queue::RETRY_LATER)
            .bind(lease.key.as_slice())
            .bind(lease.fencing_token)
            .bind(&lease.worker)
            .bind(error_json)
            .bind(INFRASTRUCTURE_TRIES)
            .bind(FIRST_RETRY_MS)
            .execute_change(&self.database)
            .await?;
        Ok(changed == 1)
    }

    /// Ends expired leases and queues retries that are due. Returns the number of expired leases.
    ///
    /// A clock that was set back delays nothing: a lease or wait that ends later than it would from now on is shortened. Such leases get
    /// their full length from now, within which a living worker renews them.
    ///
    /// # Errors
    /// The database fails.
    pub async fn reap_expired(&self) -> Result<u64> {
        Ok(self.reap().await?.unwrap_or(0))
    }

    /// The same unless this process, or another one of the same server, has searched recently. True if it has searched.
    async fn reap_now_and_then(&self) -> Result<bool> {
        let is_due = self.reaping.is_due()
            && query(sql::queue::BEGIN_TO_LOOK)
                .bind(LOOK_EVERY.as_millis() as i64)
                .scalar(&self.database)
                .await?;
        if is_due {
            self.reap().await?;
        }
        Ok(is_due)
    }

    /// Ends expired leases and queues due retries; `None` if nothing was due.
    async fn reap(&self) -> Result<Option<u64>> {
        // Most of the time there is nothing: look before taking the write lock.
        let is_due: bool =
            query(sql::queue::IS_ANYTHING_DUE).bind(LONGEST_RETRY_MS).scalar(&self.database).await?;
        if !is_due {
            return Ok(None);
        }
        // Several work items at once, and so alone.
        let mut tx = self.write().await?;
        let too_long = query(sql::queue::SHORTEN_LEASES).execute(&mut tx).await?;
        if too_long > 0 {
            tracing::warn!(leases = too_long, "the clock was set back; leases are counted from now");
        }
        let expired: Vec<(String, i64, Option<String>, Option<String>)> =
            query(sql::queue::END_LEASES).bind(CRASH_LIMIT).rows(&mut tx).await?;
        query(sql::queue::WAKE).bind(LONGEST_RETRY_MS).execute(&mut tx).await?;
        tx.commit().await?;
        for (state, crashes, owner, note) in &expired {
            self.metrics.lease_expired(state);
            tracing::warn!(worker = owner.as_deref().unwrap_or("?"), crashes, state, note, "lease expired");
        }
        Ok(Some(expired.len() as u64))
    }

    /// Ends waiting work of an earlier physics version that no worker with a heartbeat within the last `silence_ms` computes. Returns the
    /// number of work items.
    ///
    /// # Errors
    /// The database fails; work ended until then stays ended.
    pub async fn end_outdated(&self, physics_version: i64, silence_ms: i64) -> Result<u64> {
        let mut ended = 0;
        loop {
            // Most of the time there is nothing: look before taking the write lock.
            let is_anything: bool = query(sql::queue::IS_ANYTHING_OUTDATED)
                .bind(physics_version)
                .bind(silence_ms)
                .scalar(&self.database)
                .await?;
            if !is_anything {
                return Ok(ended);
            }
            let mut tx = self.write().await?;
            ended += query(sql::queue::END_OUTDATED)
                .bind(physics_version)
                .bind(silence_ms)
                .bind(ROWS_AT_ONCE as i64)
                .execute(&mut tx)
                .await?;
            tx.commit().await?;
        }
    }

    /// Work items that are not final, by state.
    ///
    /// # Errors
    /// The database fails.
    pub async fn queue_depths(&self) -> Result<QueueDepths> {
        let (waiting, queued, held, leased) = query(sql::queue::DEPTHS).one(&self.database).await?;
        Ok(QueueDepths { waiting, queued, held, leased })
    }

    /// Number of an owner's work items that are not final.
    ///
    /// # Errors
    /// The database fails.
    pub async fn open_work(&self, owner: &str) -> Result<u64> {
        let number: i64 = query(sql::queue::OPEN_WORK).bind(owner).scalar(&self.database).await?;
        Ok(number.unsigned_abs())
    }

    /// Runs a statement about a lease whose fourth parameter is a text. False if the lease was lost.
    async fn leave(&self, statement: Statement, lease: &Lease, text: &str) -> Result<bool> {
        let changed = query(statement)
            .bind(lease.key.as_slice())
            .bind(lease.fencing_token)
            .bind(&lease.worker)
            .bind(text)
            .execute_change(&self.database)
            .await?;
        Ok(changed == 1)
    }
}

fn artifacts_json(artifacts: &[NewArtifact]) -> String {
    let artifacts = artifacts.iter().map(|artifact| {
        json!({
            "name": artifact.name,
            "media_type": artifact.media_type,
            "blob": artifact.blob.to_string(),
            "bytes": artifact.bytes,
            "row_count": artifact.row_count,
        })
    });
    Value::Array(artifacts.collect()).to_string()
}

/// The parameters of a statement that stores a result: lease, summary, provenance, artifacts.
fn with_result(statement: Query, lease: &Lease, result: &NewResult<'_>) -> Query {
    statement
        .bind(lease.key.as_slice())
        .bind(lease.fencing_token)
        .bind(&lease.worker)
        .bind(result.summary_json)
        .bind(result.provenance_json)
        .bind(artifacts_json(result.artifacts))
}

/// True if a result was stored, by the database's word for the outcome.
fn is_done(outcome: &str) -> Result<bool> {
    match outcome.strip_prefix("missing ") {
        Some(blob) => Err(StoreError::BlobMissing(blob.to_owned())),
        None => Ok(outcome == "done"),
    }
}

fn claiming(worker: &str, physics_version: i64, lease_ms: i64) -> Query {
    query(sql::queue::CLAIM).bind(worker).bind(lease_ms).bind(physics_version)
}

/// Key, fencing token, base, changes, checkpoint.
type ClaimedRow = (Vec<u8>, i64, String, String, Option<String>);

/// Outcome of a result, and the same of the next work item if there is one.
type FinishedRow = (String, Option<Vec<u8>>, Option<i64>, Option<String>, Option<String>, Option<String>);

fn claimed(rows: Vec<ClaimedRow>, worker: &str) -> Result<Option<Claim>> {
    let Some((key, fencing_token, base_json, changes_json, checkpoint)) = rows.into_iter().next() else {
        return Ok(None);
    };
    let lease = Lease { key: work_key(&key)?, fencing_token, worker: worker.to_owned() };
    let checkpoint = checkpoint.as_deref().map(str::parse).transpose()?;
    Ok(Some(Claim { lease, scenario: ScenarioText { base_json, changes_json }, checkpoint }))
}

/// Marks a result as other than the one before.
async fn note_disagreement(
    tx: &mut Transaction,
    key: &[u8],
    differences: &str,
    earlier_provenance: &str,
) -> Result<()> {
    query(sql::queue::NOTE_DISAGREEMENT)
        .bind(key)
        .bind(differences)
        .bind(earlier_provenance)
        .execute(&mut *tx)
        .await?;
    Ok(())
}

/// Marks a result as one of which another has been seen, though the last two agree.
async fn keep_disagreement(tx: &mut Transaction, key: &[u8], earlier_provenance: &str) -> Result<()> {
    query(sql::queue::KEEP_DISAGREEMENT).bind(key).bind(earlier_provenance).execute(&mut *tx).await?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outcomes of `finish_work` (`store/sql/postgres/queue.sql`).
    #[test]
    fn a_result_is_stored_if_the_database_reports_it_done() {
        assert!(is_done("done").expect("an outcome"));
        assert!(!is_done("lost").expect("an outcome"));
        let missing = is_done("missing 0a1b");
        assert!(matches!(&missing, Err(StoreError::BlobMissing(blob)) if blob == "0a1b"), "{missing:?}");
    }
}
