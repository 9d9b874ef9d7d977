//! Recomputation of results whose blobs are lost or damaged.

use crate::blob_id::BlobId;
use crate::care::check::CheckReport;
use crate::engine::database::Transaction;
use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::order::{PLACE_OF_A_POINT, end_of_order};
use crate::work::state::{WorkKey, WorkState, work_key};

/// Outcome of repairing a result that has lost a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repair {
    /// Its work is queued: every sweep that has it counts it as queued until a new result takes the place of this one.
    Queued,
    /// Its work is waiting or under way already.
    UnderWay,
    /// Its work was queued for the same loss before, and has ended without a new result.
    TriedBefore,
    /// It is of this physics version, which no worker computes any more.
    OtherNumbers(i64),
    /// It has another table in that place by now, or none.
    Replaced,
}

/// Result of repairs after a check, as numbers of work items.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RepairReport {
    /// Work items that are computed again.
    pub queued: u64,
    /// Work items that were queued or under way already.
    pub under_way: u64,
    /// Work items of another physics version, which no worker computes any more.
    pub other_numbers: u64,
}

/// Treatment of work that was queued for the same loss before.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tries {
    Once,
    Again,
}

impl Store {
    /// Queues work again whose result names a [damaged](crate::StoreError::is_damage) blob: once for a result, so that reads of an
    /// irreparable table do not occupy workers repeatedly. `physics_version` is that of the workers.
    ///
    /// # Errors
    /// The database fails.
    pub async fn queue_damaged(&self, key: &WorkKey, blob: BlobId, physics_version: i64) -> Result<Repair> {
        let mut tx = self.write().await?;
        let names_blob: bool = query(sql::repair::NAMES_BLOB)
            .bind(key.as_slice())
            .bind(blob.to_string())
            .scalar(&mut tx)
            .await?;
        if !names_blob {
            return Ok(Repair::Replaced);
        }
        let repair = queue(&mut tx, key, physics_version, Tries::Once).await?;
        tx.commit().await?;
        if repair == Repair::Queued {
            let key = blake3::Hash::from_bytes(*key).to_hex();
            tracing::warn!(key = key.as_str(), %blob, "a damaged result is queued for recomputation");
        }
        Ok(repair)
    }

    /// Queues all work again that a check has found without a result or with a damaged one.
    ///
    /// # Errors
    /// The database fails.
    pub async fn repair(&self, found: &CheckReport, physics_version: i64) -> Result<RepairReport> {
        let mut report = RepairReport::default();
        let mut tx = self.write().await?;
        let mut keys = found.without_result.clone();
        for blob in &found.damaged {
            let works: Vec<(Vec<u8>, String)> =
                query(sql::repair::WORKS_OF_BLOB).bind(blob).rows(&mut tx).await?;
            for (key, _) in works {
                keys.push(work_key(&key)?);
            }
        }
        keys.sort_unstable();
        keys.dedup();
        for key in &keys {
            match queue(&mut tx, key, physics_version, Tries::Again).await? {
                Repair::Queued => report.queued += 1,
                Repair::OtherNumbers(_) => report.other_numbers += 1,
                Repair::UnderWay | Repair::TriedBefore | Repair::Replaced => report.under_way += 1,
            }
        }
        tx.commit().await?;
        Ok(report)
    }
}

/// Marks a result as damaged and queues its work behind what its owner has in the queue.
async fn queue(tx: &mut Transaction, key: &WorkKey, physics_version: i64, tries: Tries) -> Result<Repair> {
    let marked = query(sql::repair::MARK).bind(key.as_slice()).execute(&mut *tx).await?;
    let (owner, state, version): (String, String, i64) =
        query(sql::repair::WORK).bind(key.as_slice()).one(&mut *tx).await?;
    if version != physics_version {
        return Ok(Repair::OtherNumbers(version));
    }
    if WorkState::parse(&state)?.stage().is_open() {
        return Ok(Repair::UnderWay);
    }
    if marked == 0 && tries == Tries::Once {
        return Ok(Repair::TriedBefore);
    }
    let order = end_of_order(tx, &owner).await?;
    query(sql::repair::QUEUE)
        .bind(key.as_slice())
        .bind(order.last + PLACE_OF_A_POINT)
        .execute(&mut *tx)
        .await?;
    Ok(Repair::Queued)
}
