//! Blobs for rows to come.
//!
//! A blob is written before the row that names it, and no lock is held while it is: an object store may be slow, and everybody would wait
//! for it. Instead the blob is reserved, for an hour. The collector deletes what no row names and nobody has reserved, and notes that it
//! is about to; whoever wants to reserve such a blob waits until it is gone, and writes it again.

use std::fs::File;
use std::time::Duration;

use serde_json::Value;

use crate::blob::{BlobId, NamedFile};
use crate::connection::Store;
use crate::database::Transaction;
use crate::error::{Result, StoreError};
use crate::query::query;
use crate::sql;

/// How long a reservation holds \[ms\]: from before a blob is written until the row that names it is stored.
const RESERVED_MS: i64 = 3_600_000;

/// How often it is looked whether a blob has been deleted.
const POLL: Duration = Duration::from_millis(50);

impl Store {
    /// Writes a blob for a result or a checkpoint that is about to be stored, as [`BlobStore::put`](crate::BlobStore::put) does. It is
    /// kept for an hour, and from then on as long as a row names it.
    ///
    /// # Errors
    /// When the database or the object store fails.
    pub async fn put_blob(&self, bytes: Vec<u8>) -> Result<BlobId> {
        self.reserve(BlobId::of(&bytes)).await?;
        self.blobs().put(bytes).await
    }

    /// The same of a file; a large one is never in memory as a whole. Gives its size \[bytes\], too.
    ///
    /// # Errors
    /// When the file cannot be read, or the database or the object store fails.
    pub async fn put_blob_file(&self, file: &File) -> Result<(BlobId, u64)> {
        let file = NamedFile::read(file).await?;
        self.reserve(file.id).await?;
        self.blobs().put_named(file).await
    }

    /// Reserves a blob, once nobody is deleting it.
    async fn reserve(&self, blob: BlobId) -> Result<()> {
        let name = blob.to_string();
        loop {
            let reserve = query(sql::upload::RESERVE).bind(&name).bind(RESERVED_MS);
            if !reserve.rows::<(String,)>(&self.database).await?.is_empty() {
                return Ok(());
            }
            // Until the note of it runs out, if whoever was deleting it has died.
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
        query(sql::upload::UNRESERVED).bind(names.to_string()).scalars(&mut *tx).await?;
    match missing.into_iter().next() {
        Some(blob) => Err(StoreError::BlobMissing(blob)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connection::{Role, StoreConfig};

    #[tokio::test]
    async fn who_wants_a_blob_that_is_being_deleted_waits_and_writes_it_again() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(&StoreConfig::in_directory(directory.path(), Role::Worker)).await.unwrap();
        let blob = BlobId::of(b"history");
        let note = || query(sql::retention::BEGIN_REMOVAL).bind(blob.to_string()).bind(600_000);
        let until: i64 = note().scalar(&store.database).await.unwrap();
        let others: Option<i64> = note().first_scalar(&store.database).await.unwrap();
        assert_eq!(others, None, "one at a time deletes it");
        let mut writing = Box::pin(store.put_blob(b"history".to_vec()));
        assert!(tokio::time::timeout(4 * POLL, &mut writing).await.is_err(), "it may vanish at any time");
        let end = |until: i64| query(sql::retention::END_REMOVAL).bind(blob.to_string()).bind(until);
        assert_eq!(end(until + 1).execute(&store.database).await.unwrap(), 0, "only its own note");
        assert_eq!(end(until).execute(&store.database).await.unwrap(), 1);
        assert_eq!(writing.await.unwrap(), blob);
        assert!(store.blobs().get(blob).await.is_ok());
    }
}
