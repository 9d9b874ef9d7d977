//! Reservation of blobs for future rows.
//!
//! A blob is written before the row that names it, without a lock, since an object store may be slow and all writers would wait for it.
//! Instead the blob is reserved for an hour. The collector deletes blobs without a row and without a reservation, and locks each first; a
//! worker waits to reserve such a blob until it is deleted, and writes it again.

use std::collections::BTreeSet;
use std::fs::File;
use std::time::Duration;

use serde_json::{Value, json};

use crate::blob::file::NamedFile;
use crate::blob_id::BlobId;
use crate::engine::database::Transaction;
use crate::engine::query::query;
use crate::engine::sql;
use crate::error::{Result, StoreError};
use crate::store::Store;
use crate::work::lease::{Lease, Renewal};

/// Validity of a reservation \[ms\]: from before a blob is written until the row that names it is stored.
const RESERVED_MS: i64 = 3_600_000;

/// Interval of checks for the deletion of a blob.
const POLL: Duration = Duration::from_millis(50);

impl Store {
    /// Reserves all blobs of a result that is computed, before they are written ([`BlobStore::put`](crate::BlobStore::put)): for an hour, and
    /// from then on as long as a row names them. The lease is extended with them, as by [`renew`](Self::renew): a worker that has lost it need not
    /// write them.
    ///
    /// # Errors
    /// The database fails.
    pub async fn reserve(&self, lease: &Lease, lease_ms: i64, blobs: &[BlobId]) -> Result<Renewal> {
        let names: BTreeSet<String> = blobs.iter().map(BlobId::to_string).collect();
        let wanted = json!(names).to_string();
        loop {
            let at_once = query(sql::reservation::RESERVE_AT_ONCE)
                .bind(lease.key.as_slice())
                .bind(lease.fencing_token)
                .bind(&lease.worker)
                .bind(lease_ms)
                .bind(&wanted)
                .bind(RESERVED_MS);
            let (reserved, renewal) = match at_once.first::<(i64, Option<bool>)>(&self.database).await? {
                Some((reserved, cancel_requested)) => (reserved, Renewal::of(cancel_requested)),
                None => self.reserve_by_steps(lease, lease_ms, &wanted).await?,
            };
            if renewal == Renewal::Lost || reserved == names.len() as i64 {
                return Ok(renewal);
            }
            // Until the note of it runs out, if the collector that was deleting one has died.
            tokio::time::sleep(POLL).await;
        }
    }

    /// The same once, if statements are no messages. Returns the number of reserved blobs.
    async fn reserve_by_steps(&self, lease: &Lease, lease_ms: i64, wanted: &str) -> Result<(i64, Renewal)> {
        let mut tx = self.write_one().await?;
        let renewal = Renewal::of(lease.renewing(lease_ms, 1.0).first_scalar(&mut tx).await?);
        let mut reserved = 0;
        if renewal != Renewal::Lost {
            let reserve = query(sql::reservation::RESERVE).bind(wanted).bind(RESERVED_MS);
            reserved = reserve.scalars::<String>(&mut tx).await?.len() as i64;
        }
        tx.commit().await?;
        Ok((reserved, renewal))
    }

    /// Writes a blob that is about to be named by a row, as [`BlobStore::put`](crate::BlobStore::put) does. It is kept for an hour, and from
    /// then on as long as a row names it.
    ///
    /// # Errors
    /// The database or the object store fails.
    pub async fn put_blob(&self, bytes: Vec<u8>) -> Result<BlobId> {
        self.reserve_one(BlobId::of(&bytes)).await?;
        self.blobs().put(bytes).await
    }

    /// The same of a file; a large one is never in memory as a whole. Gives its size \[bytes\], too.
    ///
    /// # Errors
    /// The file cannot be read, or the database or the object store fails.
    pub async fn put_blob_file(&self, file: &File) -> Result<(BlobId, u64)> {
        let file = NamedFile::read(file).await?;
        self.reserve_one(file.id()).await?;
        self.blobs().put_named(&file).await?;
        Ok((file.id(), file.bytes()))
    }

    /// Reserves a blob, after a running deletion of it has ended.
    async fn reserve_one(&self, blob: BlobId) -> Result<()> {
        let wanted = json!([blob.to_string()]).to_string();
        loop {
            let reserve = query(sql::reservation::RESERVE).bind(&wanted).bind(RESERVED_MS);
            if !reserve.rows::<(String,)>(&self.database).await?.is_empty() {
                return Ok(());
            }
            // Until the note of it runs out, if the collector that was deleting it has died.
            tokio::time::sleep(POLL).await;
        }
    }
}

/// Fails unless all of these blobs are reserved, and so are there, until the end of the transaction.
pub(crate) async fn require_reserved(
    tx: &mut Transaction,
    blobs: impl IntoIterator<Item = BlobId>,
) -> Result<()> {
    let names: Value = blobs.into_iter().map(|blob| blob.to_string()).collect();
    let missing: Vec<String> =
        query(sql::reservation::UNRESERVED).bind(names.to_string()).scalars(&mut *tx).await?;
    match missing.into_iter().next() {
        Some(blob) => Err(StoreError::BlobMissing(blob)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::role::Role;
    use crate::store::StoreConfig;

    #[tokio::test]
    async fn a_write_to_a_blob_under_deletion_waits_and_rewrites_it() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(&StoreConfig::in_directory(directory.path(), Role::Worker)).await.unwrap();
        let blob = BlobId::of(b"history");
        let note = || query(sql::garbage::BEGIN_REMOVAL).bind(blob.to_string()).bind(600_000);
        let until: i64 = note().scalar(&store.database).await.unwrap();
        let others: Option<i64> = note().first_scalar(&store.database).await.unwrap();
        assert_eq!(others, None, "one at a time deletes it");
        let mut writing = Box::pin(store.put_blob(b"history".to_vec()));
        assert!(tokio::time::timeout(4 * POLL, &mut writing).await.is_err(), "it may vanish at any time");
        let end = |until: i64| query(sql::garbage::END_REMOVAL).bind(blob.to_string()).bind(until);
        assert_eq!(end(until + 1).execute(&store.database).await.unwrap(), 0, "only its own note");
        assert_eq!(end(until).execute(&store.database).await.unwrap(), 1);
        assert_eq!(writing.await.unwrap(), blob);
        assert!(store.blobs().get(blob).await.is_ok());
    }
}
