//! Probe of the queue and of the blobs.

use bytes::Bytes;

use crate::engine::query::query;
use crate::engine::sql;
use crate::error::{Result, StoreError};
use crate::store::Store;

/// A version of the numbers that no worker has, so that no worker meets the scratch row.
const NO_PHYSICS: i64 = -1;

impl Store {
    /// Queues a scratch work item, claims it by the statement that workers use, and takes both back; then writes,
    /// reads and deletes a scratch blob. Nothing is left, or visible to others.
    ///
    /// # Errors
    /// The database or the object store cannot be written or do not give back what was written.
    pub async fn probe(&self) -> Result<()> {
        let scratch = format!("probe {}", self.now_ms().await?);
        let key = blake3::hash(scratch.as_bytes());
        let mut tx = self.write().await?;
        query(sql::probe::INSERT_SCENARIO).bind(key.as_bytes().as_slice()).execute(&mut tx).await?;
        query(sql::probe::INSERT_TURN).execute(&mut tx).await?;
        query(sql::probe::INSERT_WORK)
            .bind(key.as_bytes().as_slice())
            .bind(NO_PHYSICS)
            .execute(&mut tx)
            .await?;
        let claimed = self.claim_in(&mut tx, "probe", NO_PHYSICS, 1_000).await?;
        tx.rollback().await?;
        if claimed.is_none_or(|claim| claim.lease.key != *key.as_bytes()) {
            return Err(StoreError::Corrupt("a work item that was queued could not be claimed".to_owned()));
        }
        self.blobs().probe(Bytes::from(scratch)).await
    }
}
