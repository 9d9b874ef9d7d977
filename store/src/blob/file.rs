//! Files that become blobs.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::sync::Arc;

use object_store::{MultipartUpload, PutPayload};

use crate::blob_id::BlobId;
use crate::error::{Result, StoreError};

/// Bytes of a large file that are in memory at once.
pub(super) const PART: usize = 8 << 20;

/// A file whose content has been read once, and is known by its name.
#[derive(Debug)]
pub struct NamedFile {
    pub(super) file: Arc<File>,
    pub(super) id: BlobId,
    pub(super) bytes: u64,
}

impl NamedFile {
    /// Reads a file once from its start, independent of its position; a large file is never in memory as a whole.
    ///
    /// # Errors
    /// It cannot be read.
    pub async fn read(file: &File) -> Result<Self> {
        let file = Arc::new(file.try_clone().map_err(StoreError::LocalFile)?);
        let mut hasher = blake3::Hasher::new();
        loop {
            let part = read_part(&file, hasher.count()).await?;
            hasher.update(&part);
            if part.len() < PART {
                break;
            }
        }
        Ok(Self { file, id: BlobId::from(hasher.finalize()), bytes: hasher.count() })
    }

    /// The name of the blob that it becomes.
    #[must_use]
    pub fn id(&self) -> BlobId {
        self.id
    }

    /// Its size.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Sends a file of this many bytes to an upload, part by part, and fails at its end if its hash is not its name.
pub(super) async fn send_file(
    upload: &mut dyn MultipartUpload,
    file: &Arc<File>,
    bytes: u64,
    id: BlobId,
) -> Result<()> {
    let mut hasher = blake3::Hasher::new();
    while hasher.count() < bytes {
        let part = read_part(file, hasher.count()).await?;
        if part.is_empty() {
            return Err(changed());
        }
        hasher.update(&part);
        upload.put_part(PutPayload::from(part)).await?;
    }
    if BlobId::from(hasher.finalize()) != id {
        return Err(changed());
    }
    Ok(())
}

/// A file has changed since it was named.
pub(super) fn changed() -> StoreError {
    StoreError::LocalFile(std::io::Error::other("the file has changed while it was being stored"))
}

/// A part of a file, shorter at its end.
pub(super) async fn read_part(file: &Arc<File>, from: u64) -> Result<Vec<u8>> {
    let file = file.clone();
    let read = move || {
        let mut part = vec![0; PART];
        let mut length = 0;
        while length < PART {
            match file.read_at(&mut part[length..], from + length as u64)? {
                0 => break,
                read => length += read,
            }
        }
        part.truncate(length);
        Ok(part)
    };
    tokio::task::spawn_blocking(read)
        .await
        .map_err(std::io::Error::other)
        .flatten()
        .map_err(StoreError::LocalFile)
}
