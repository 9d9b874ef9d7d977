//! Arrays, by the hash of their bytes.

use std::fs::File;
use std::io::Write;
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use bytes::Bytes;
use futures::TryStreamExt;
use object_store::local::LocalFileSystem;
use object_store::path::Path as ObjectPath;
use object_store::{ObjectMeta, ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload};

use crate::error::{Result, StoreError};
use crate::hash_tree::{self, HashTree, HashTreeBuilder, HashTrees};

/// Bytes of a large file that are in memory at once.
const PART: usize = 8 << 20;

/// Bytes that are read at once where a content is read from its beginning to its end. The object store's own stream hands out 8 KiB at a
/// time, each from another thread, which takes longer than hashing them.
const STRETCH: u64 = 1 << 20;

/// The folder of scratch objects.
const SCRATCH: &str = "probe";

/// A blob's name: the BLAKE3 hash of its bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BlobId(blake3::Hash);

/// Content-addressed objects in a local directory. A blob is written before the row that names it. Writing the same bytes
/// again changes nothing, unless they were damaged meanwhile: then it mends them.
#[derive(Debug, Clone)]
pub struct BlobStore {
    objects: Arc<dyn ObjectStore>,
    directory: PathBuf,
    trees: Arc<HashTrees>,
}

/// An object as it lies in the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StoredObject {
    path: ObjectPath,
    pub(crate) bytes: u64,
}

impl StoredObject {
    /// The name of the blob that it is; none of a scratch object.
    pub(crate) fn blob(&self) -> Option<String> {
        let name = self.path.filename()?;
        let id: BlobId = name.parse().ok()?;
        (id.path() == self.path).then(|| name.to_owned())
    }
}

impl BlobStore {
    pub(crate) fn open(directory: &Path) -> Result<Self> {
        std::fs::create_dir_all(directory)
            .map_err(|source| StoreError::Directory { path: directory.display().to_string(), source })?;
        let objects = LocalFileSystem::new_with_prefix(directory)?.with_fsync(true);
        Ok(Self { objects: Arc::new(objects), directory: directory.to_owned(), trees: Arc::default() })
    }

    /// Writes a blob, durably, unless it is there. What is there under its name is read, and replaced in one step where it
    /// is not what the name says, or cannot be read.
    ///
    /// # Errors
    /// When the object store fails.
    pub async fn put(&self, bytes: Vec<u8>) -> Result<BlobId> {
        let id = BlobId::of(&bytes);
        let payload = PutPayload::from(bytes);
        match self.write(id, payload.clone(), PutMode::Create).await {
            Err(object_store::Error::AlreadyExists { .. }) => {}
            written => return Ok(written.map(|()| id)?),
        }
        if let Err(error) = self.verify(id).await {
            tracing::warn!(%error, blob = %id, "a stored blob is replaced");
            self.write(id, payload, PutMode::Overwrite).await?;
        }
        Ok(id)
    }

    /// Writes a file as a blob, as [`put`](Self::put) writes bytes; a large one is never in memory as a whole. Gives its size
    /// \[bytes\], too. The file's own position does not matter.
    ///
    /// # Errors
    /// When the file cannot be read or the object store fails.
    pub async fn put_file(&self, file: &File) -> Result<(BlobId, u64)> {
        let file = Arc::new(file.try_clone().map_err(StoreError::LocalFile)?);
        let mut hasher = blake3::Hasher::new();
        let read = async |from: u64| {
            let file = file.clone();
            let part = tokio::task::spawn_blocking(move || read_part(&file, from)).await;
            part.map_err(std::io::Error::other).flatten().map_err(StoreError::LocalFile)
        };
        let first = read(0).await?;
        if first.len() < PART {
            let bytes = first.len() as u64;
            return Ok((self.put(first).await?, bytes));
        }
        let mut part = first;
        while !part.is_empty() {
            hasher.update(&part);
            part = read(hasher.count()).await?;
        }
        let (id, bytes) = (BlobId(hasher.finalize()), hasher.count());
        if self.contains(id).await? {
            match self.verify(id).await {
                Ok(_) => return Ok((id, bytes)),
                Err(error) => tracing::warn!(%error, blob = %id, "a stored blob is replaced"),
            }
        }
        let mut upload = self.objects.put_multipart(&id.path()).await?;
        let mut written = 0;
        while written < bytes {
            let part = read(written).await?;
            written += part.len() as u64;
            let is_changed = part.is_empty();
            let sent = if is_changed { Ok(()) } else { upload.put_part(PutPayload::from(part)).await };
            if is_changed || sent.is_err() {
                // What cannot be taken back is left to the collector.
                let _ = upload.abort().await;
                sent?;
                return Err(StoreError::LocalFile(std::io::Error::other("the file became shorter")));
            }
        }
        upload.complete().await?;
        Ok((id, bytes))
    }

    async fn write(&self, id: BlobId, payload: PutPayload, mode: PutMode) -> object_store::Result<()> {
        let options = PutOptions { mode, ..PutOptions::default() };
        self.objects.put_opts(&id.path(), payload, options).await.map(drop)
    }

    /// Reads a blob without keeping it, and gives its size \[bytes\].
    ///
    /// # Errors
    /// As [`get`](Self::get).
    pub async fn verify(&self, id: BlobId) -> Result<u64> {
        let mut hasher = blake3::Hasher::new();
        let length = self.objects.head(&id.path()).await?.size;
        self.read_through(id, length, |bytes| {
            hasher.update(bytes);
        })
        .await?;
        if hasher.finalize() != id.0 {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(hasher.count())
    }

    /// Reads a whole blob. What a disk has damaged is not passed on.
    ///
    /// # Errors
    /// When it is not there or is not what was written, or the object store fails.
    pub async fn get(&self, id: BlobId) -> Result<Bytes> {
        let content = self.objects.get(&id.path()).await?.bytes().await?;
        if BlobId::of(&content) != id {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(content)
    }

    /// Reads a whole blob into an empty file.
    ///
    /// # Errors
    /// As [`get`](Self::get), and when the file cannot be written.
    pub async fn get_into(&self, id: BlobId, mut file: File) -> Result<File> {
        let length = self.objects.head(&id.path()).await?.size;
        let (mut hasher, mut written) = (blake3::Hasher::new(), Ok(()));
        let take = |bytes: &[u8]| {
            hasher.update(bytes);
            written = std::mem::replace(&mut written, Ok(())).and_then(|()| file.write_all(bytes));
        };
        self.read_through(id, length, take).await?;
        written.map_err(StoreError::LocalFile)?;
        if hasher.finalize() != id.0 {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(file)
    }

    /// Reads a range of a blob's bytes, cut off at its end. Only what was verified is handed out, as in [`get`](Self::get): the
    /// first range of a blob takes a reading of the whole, any other one the groups of the hash tree that it touches.
    ///
    /// # Errors
    /// When the blob is not there or is not what was written, the range begins beyond its end or is empty, or the object store
    /// fails.
    pub async fn get_range(&self, id: BlobId, bytes: Range<u64>) -> Result<Bytes> {
        let Some(tree) = self.hash_tree(id).await? else {
            // In one group: the whole is no more to read.
            let whole = self.get(id).await?;
            let length = whole.len() as u64;
            let range =
                (!bytes.is_empty() && bytes.start < length).then(|| bytes.start..bytes.end.min(length));
            return Ok(cut(&whole, range.ok_or(StoreError::NoSuchRange(id))?));
        };
        let groups = tree.whole_groups(&bytes).ok_or(StoreError::NoSuchRange(id))?;
        let content = match self.objects.get_range(&id.path(), groups.clone()).await {
            Ok(content) => content,
            // A file that is too short has no such range.
            Err(error) => return Err(self.verify(id).await.err().unwrap_or(error.into())),
        };
        if content.len() as u64 != groups.end - groups.start || !tree.holds(groups.start, &content) {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(cut(&content, bytes.start - groups.start..bytes.end.min(groups.end) - groups.start))
    }

    /// The hashes of a blob's groups; none where it is no larger than one.
    async fn hash_tree(&self, id: BlobId) -> Result<Option<Arc<HashTree>>> {
        if let Some(tree) = self.trees.get(id) {
            return Ok(Some(tree));
        }
        let length = self.objects.head(&id.path()).await?.size;
        if length <= hash_tree::GROUP {
            return Ok(None);
        }
        let mut builder = HashTreeBuilder::new();
        self.read_through(id, length, |bytes| builder.update(bytes)).await?;
        let tree = Arc::new(builder.finish(id).ok_or(StoreError::BlobDamaged(id))?);
        self.trees.keep(id, tree.clone());
        Ok(Some(tree))
    }

    /// Reads an object of so many bytes from its beginning to its end.
    async fn read_through(&self, id: BlobId, length: u64, mut take: impl FnMut(&[u8])) -> Result<()> {
        let path = id.path();
        for start in (0..length).step_by(STRETCH as usize) {
            take(&self.objects.get_range(&path, start..length.min(start + STRETCH)).await?);
        }
        Ok(())
    }

    /// Whether a blob is there.
    pub(crate) async fn contains(&self, id: BlobId) -> Result<bool> {
        match self.objects.head(&id.path()).await {
            Ok(_) => Ok(true),
            Err(object_store::Error::NotFound { .. }) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Blobs and scratch objects that were written before a time \[ms since the epoch\]. Files of others are not among
    /// them.
    pub(crate) async fn objects_before(&self, cutoff: i64) -> Result<Vec<StoredObject>> {
        let is_old = async |meta: ObjectMeta| {
            let object = StoredObject { path: meta.location, bytes: meta.size };
            let is_ours = object.blob().is_some() || object.path.prefix_matches(&ObjectPath::from(SCRATCH));
            Ok((is_ours && meta.last_modified.timestamp_millis() < cutoff).then_some(object))
        };
        Ok(self.objects.list(None).try_filter_map(is_old).try_collect().await?)
    }

    /// Deletes an object; one that is gone already is no matter.
    pub(crate) async fn delete(&self, object: &StoredObject) -> Result<()> {
        match self.objects.delete(&object.path).await {
            Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Sizes of the parts of uploads that were begun before a time \[ms since the epoch\] and never finished, as a
    /// killed worker leaves them; they are deleted if so wanted. The object store does not list them.
    pub(crate) async fn unfinished_uploads(&self, cutoff: i64, is_deleting: bool) -> Result<Vec<u64>> {
        let directory = self.directory.clone();
        let failed = |source| StoreError::Directory { path: self.directory.display().to_string(), source };
        let walking = tokio::task::spawn_blocking(move || {
            let mut sizes = Vec::new();
            visit_unfinished(&directory, cutoff, is_deleting, &mut sizes).map(|()| sizes)
        });
        walking.await.map_err(std::io::Error::other).flatten().map_err(failed)
    }

    /// Writes, reads and deletes a scratch object: a full or read-only disk shows here.
    pub(crate) async fn probe(&self, content: Bytes) -> Result<()> {
        let path = ObjectPath::from(format!("{SCRATCH}/{}", blake3::hash(&content).to_hex()));
        self.objects.put(&path, PutPayload::from(content.clone())).await?;
        let read = self.objects.get(&path).await?.bytes().await?;
        self.objects.delete(&path).await?;
        if read != content {
            return Err(StoreError::Corrupt("a scratch object came back changed".to_owned()));
        }
        Ok(())
    }
}

/// A part of a file, shorter at its end.
fn read_part(file: &File, from: u64) -> std::io::Result<Vec<u8>> {
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
}

/// A part of some bytes; what lies beyond their end is left out.
fn cut(bytes: &Bytes, range: Range<u64>) -> Bytes {
    let place = |at: u64| usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len());
    bytes.slice(place(range.start)..place(range.end))
}

fn visit_unfinished(
    directory: &Path,
    cutoff: i64,
    is_deleting: bool,
    sizes: &mut Vec<u64>,
) -> std::io::Result<()> {
    for entry in std::fs::read_dir(directory)? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        if metadata.is_dir() {
            visit_unfinished(&entry.path(), cutoff, is_deleting, sizes)?;
            continue;
        }
        let modified = metadata.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
        let is_old = i64::try_from(modified.as_millis()).is_ok_and(|modified| modified < cutoff);
        // `object_store` uploads to the object's path with `#` and a number after it.
        let name = entry.file_name();
        let is_upload = name.to_str().and_then(|name| name.rsplit_once('#')).is_some_and(|(_, number)| {
            !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
        });
        if is_old && is_upload {
            if is_deleting {
                std::fs::remove_file(entry.path())?;
            }
            sizes.push(metadata.len());
        }
    }
    Ok(())
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

impl From<blake3::Hash> for BlobId {
    fn from(hash: blake3::Hash) -> Self {
        BlobId(hash)
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
