//! Arrays, by the hash of their bytes.

use std::ops::Range;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use bytes::Bytes;
use object_store::local::LocalFileSystem;
use object_store::path::Path as ObjectPath;
use object_store::{ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload};

use crate::error::{Result, StoreError};

/// A blob's name: the BLAKE3 hash of its bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BlobId(blake3::Hash);

/// Content-addressed objects in a local directory. A blob is written before the row that names it, and writing
/// the same bytes again changes nothing.
#[derive(Debug, Clone)]
pub struct BlobStore {
    objects: Arc<dyn ObjectStore>,
}

impl BlobStore {
    pub(crate) fn open(directory: &Path) -> Result<Self> {
        std::fs::create_dir_all(directory)
            .map_err(|source| StoreError::Directory { path: directory.display().to_string(), source })?;
        let objects = LocalFileSystem::new_with_prefix(directory)?.with_fsync(true);
        Ok(Self { objects: Arc::new(objects) })
    }

    /// Writes a blob, durably, unless it is there.
    ///
    /// # Errors
    /// When the object store fails.
    pub async fn put(&self, bytes: Vec<u8>) -> Result<BlobId> {
        let id = BlobId::of(&bytes);
        let options = PutOptions { mode: PutMode::Create, ..PutOptions::default() };
        match self.objects.put_opts(&id.path(), PutPayload::from(bytes), options).await {
            Ok(_) | Err(object_store::Error::AlreadyExists { .. }) => Ok(id),
            Err(error) => Err(error.into()),
        }
    }

    /// Reads a whole blob. What a disk has damaged is not passed on.
    ///
    /// # Errors
    /// When it is not there or is not what was written, or the object store fails.
    pub async fn get(&self, id: BlobId) -> Result<Bytes> {
        let content = self.objects.get(&id.path()).await?.bytes().await?;
        if BlobId::of(&content) != id {
            return Err(StoreError::Corrupt(format!("blob {id}, whose content is not what its name says")));
        }
        Ok(content)
    }

    /// Reads a range of a blob's bytes, cut off at its end.
    ///
    /// # Errors
    /// When it is not there, the range begins beyond its end or is empty, or the object store fails.
    pub async fn get_range(&self, id: BlobId, bytes: Range<u64>) -> Result<Bytes> {
        Ok(self.objects.get_range(&id.path(), bytes).await?)
    }

    /// Writes, reads and deletes a scratch object: a full or read-only disk shows here.
    pub(crate) async fn probe(&self, content: Bytes) -> Result<()> {
        let path = ObjectPath::from(format!("probe/{}", blake3::hash(&content).to_hex()));
        self.objects.put(&path, PutPayload::from(content.clone())).await?;
        let read = self.objects.get(&path).await?.bytes().await?;
        self.objects.delete(&path).await?;
        if read != content {
            return Err(StoreError::Corrupt("a scratch object came back changed".to_owned()));
        }
        Ok(())
    }
}

impl BlobId {
    /// The name of a content.
    pub(crate) fn of(bytes: &[u8]) -> Self {
        BlobId(blake3::hash(bytes))
    }

    /// Two levels of folders keep directories small.
    fn path(&self) -> ObjectPath {
        let hex = self.0.to_hex();
        ObjectPath::from(format!("{}/{}/{hex}", &hex[..2], &hex[2..4]))
    }
}

impl std::fmt::Display for BlobId {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0.to_hex())
    }
}

impl FromStr for BlobId {
    type Err = StoreError;

    fn from_str(text: &str) -> Result<Self> {
        blake3::Hash::from_hex(text).map(BlobId).map_err(|_| StoreError::Corrupt(format!("blob id {text:?}")))
    }
}
