//! Object store: content-addressed objects in a directory or a bucket.

use std::fs::File;
use std::io::Write;
use std::ops::Range;
use std::sync::Arc;

use bytes::Bytes;
use futures::TryStreamExt;
use object_store::path::Path as ObjectPath;
use object_store::{MultipartUpload, ObjectMeta, ObjectStoreExt, PutMode, PutOptions, PutPayload};

use crate::blob::backend::{self, Backend};
use crate::blob::file::{NamedFile, PART, changed, read_part, send_file};
use crate::blob::hash_tree::{self, HashTree, HashTreeBuilder, HashTrees};
use crate::blob::location::ObjectsLocation;
use crate::blob::metrics::ObjectMetrics;
use crate::blob::object::{SCRATCH, StoredObject, path_of};
use crate::blob_id::BlobId;
use crate::error::{Result, StoreError};

/// Content-addressed objects in a local directory or a bucket. A blob is written before the row that names it. Writing the same bytes again
/// changes nothing, unless the stored ones are damaged: then it repairs them.
///
/// Requests to a service that does not answer are retried, reads for 10 s, [`put`](Self::put) and [`put_file`](Self::put_file) for 60 s,
/// and then fail as [unavailable](StoreError::is_unavailable). A refused certificate is an error at once.
#[derive(Debug, Clone)]
pub struct BlobStore {
    backend: Backend,
    trees: Arc<HashTrees>,
}

impl BlobStore {
    /// Opens the object store at a location; a missing directory is made. The presence of a bucket is not tested.
    ///
    /// # Errors
    /// A directory cannot be made, or settings of the service in the environment are wrong or missing.
    pub fn open(location: &ObjectsLocation) -> Result<Self> {
        Self::counted(location, &ObjectMetrics::default())
    }

    /// The same, its requests counted.
    pub(crate) fn counted(location: &ObjectsLocation, metrics: &ObjectMetrics) -> Result<Self> {
        Ok(Self { backend: Backend::open(location, metrics)?, trees: Arc::default() })
    }

    /// Writes a blob, durably, unless it is present. Existing content is read, and replaced atomically if its hash differs or it cannot be
    /// read.
    ///
    /// # Errors
    /// The object store fails.
    pub async fn put(&self, bytes: Vec<u8>) -> Result<BlobId> {
        let id = BlobId::of(&bytes);
        self.put_as(id, PutPayload::from(bytes)).await?;
        Ok(id)
    }

    async fn put_as(&self, id: BlobId, payload: PutPayload) -> Result<()> {
        match self.write(id, payload.clone(), PutMode::Create).await {
            Ok(()) => return Ok(()),
            Err(StoreError::Blob(object_store::Error::AlreadyExists { .. })) => {}
            // A request that breaks off may have been carried out, and is not sent again by itself.
            Err(error) if error.is_unavailable() => {}
            Err(error) => return Err(error),
        }
        if self.is_to_be_written(id).await? {
            self.write(id, payload, PutMode::Overwrite).await?;
        }
        Ok(())
    }

    /// Writes a file as a blob, as [`put`](Self::put) writes bytes; a large one is never in memory as a whole. Gives its size
    /// \[bytes\], too. The file's own position does not matter.
    ///
    /// # Errors
    /// The file cannot be read or the object store fails.
    pub async fn put_file(&self, file: &File) -> Result<(BlobId, u64)> {
        let file = NamedFile::read(file).await?;
        self.put_named(&file).await?;
        Ok((file.id, file.bytes))
    }

    /// The same of a file whose name is known.
    ///
    /// # Errors
    /// The file cannot be read or has changed, or the object store fails.
    pub async fn put_named(&self, NamedFile { file, id, bytes }: &NamedFile) -> Result<()> {
        if *bytes < PART as u64 {
            let whole = read_part(file, 0).await?;
            if BlobId::of(&whole) != *id {
                return Err(changed());
            }
            return self.put_as(*id, PutPayload::from(whole)).await;
        }
        if !self.is_to_be_written(*id).await? {
            return Ok(());
        }
        let mut upload = self.backend.uploads.put_multipart(&path_of(*id)).await?;
        let sent = send_file(upload.as_mut(), file, *bytes, *id).await;
        self.end_upload(*id, upload, sent).await
    }

    /// Completes an upload whose parts have all been sent, and takes any other one back.
    async fn end_upload(
        &self,
        id: BlobId,
        mut upload: Box<dyn MultipartUpload>,
        sent: Result<()>,
    ) -> Result<()> {
        if let Err(error) = sent {
            // Uploads that cannot be aborted are left to the collector, or to the bucket's rule. A service that was waited for in vain
            // is not waited for again.
            if !error.is_unavailable() {
                let _ = upload.abort().await;
            }
            return Err(error);
        }
        if let Err(error) = upload.complete().await {
            // The answer may have been lost. Asked again, the service knows no such upload.
            if self.is_to_be_written(id).await? {
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Copies a blob from another store, unless it is present and whole here. Content that does not match its hash is not copied, and a
    /// large blob is never in memory as a whole. Returns its size \[bytes\]; `None` if it was present.
    ///
    /// # Errors
    /// [Damage](StoreError::is_damage) if the other store has lost it; else when either object store fails.
    pub(crate) async fn copy_from(&self, other: &BlobStore, id: BlobId) -> Result<Option<u64>> {
        if !self.is_to_be_written(id).await? {
            return Ok(None);
        }
        let length = other.length(id).await?;
        if length < PART as u64 {
            self.put_as(id, PutPayload::from(other.get(id).await?)).await?;
        } else {
            let mut upload = self.backend.uploads.put_multipart(&path_of(id)).await?;
            let sent = other.send(id, length, upload.as_mut()).await;
            self.end_upload(id, upload, sent).await?;
        }
        Ok(Some(length))
    }

    /// Sends a blob of this many bytes to an upload, part by part, and fails at its end if its hash is not its name.
    async fn send(&self, id: BlobId, length: u64, upload: &mut dyn MultipartUpload) -> Result<()> {
        let (path, mut hasher) = (path_of(id), blake3::Hasher::new());
        while hasher.count() < length {
            let range = hasher.count()..length.min(hasher.count() + PART as u64);
            let part = self.backend.objects.get_range(&path, range).await?;
            if part.is_empty() {
                return Err(StoreError::BlobDamaged(id));
            }
            hasher.update(&part);
            upload.put_part(PutPayload::from(part)).await?;
        }
        if BlobId::from(hasher.finalize()) != id {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(())
    }

    async fn write(&self, id: BlobId, payload: PutPayload, mode: PutMode) -> Result<()> {
        let options = PutOptions { mode, ..PutOptions::default() };
        self.backend.uploads.put_opts(&path_of(id), payload, options).await?;
        Ok(())
    }

    /// True if a blob is missing or damaged.
    async fn is_to_be_written(&self, id: BlobId) -> Result<bool> {
        match self.verify(id).await {
            Ok(_) => Ok(false),
            Err(error) if error.is_unavailable() => Err(error),
            Err(StoreError::Blob(object_store::Error::NotFound { .. })) => Ok(true),
            Err(error) => {
                tracing::warn!(%error, blob = %id, "a stored blob is replaced");
                Ok(true)
            }
        }
    }

    /// Reads a blob without keeping it, and gives its size \[bytes\].
    ///
    /// # Errors
    /// As [`get`](Self::get).
    pub async fn verify(&self, id: BlobId) -> Result<u64> {
        let mut hasher = blake3::Hasher::new();
        let length = self.length(id).await?;
        self.read_through(id, length, |bytes| {
            hasher.update(bytes);
        })
        .await?;
        if BlobId::from(hasher.finalize()) != id {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(hasher.count())
    }

    /// Reads a whole blob and verifies its hash.
    ///
    /// # Errors
    /// The blob is missing or damaged, or the object store fails.
    pub async fn get(&self, id: BlobId) -> Result<Bytes> {
        let content = self.backend.objects.get(&path_of(id)).await?.bytes().await?;
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
        let length = self.length(id).await?;
        let (mut hasher, mut written) = (blake3::Hasher::new(), Ok(()));
        let take = |bytes: &[u8]| {
            hasher.update(bytes);
            written = std::mem::replace(&mut written, Ok(())).and_then(|()| file.write_all(bytes));
        };
        self.read_through(id, length, take).await?;
        written.map_err(StoreError::LocalFile)?;
        if BlobId::from(hasher.finalize()) != id {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(file)
    }

    /// Reads a range of a blob's bytes, up to its end, verified as in [`get`](Self::get): the first range of a blob requires a read of the
    /// whole, later ones only the groups of the hash tree that they touch.
    ///
    /// # Errors
    /// The blob is missing or damaged, the range begins beyond its end or is empty, or the object store
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
        let content = match self.backend.objects.get_range(&path_of(id), groups.clone()).await {
            Ok(content) => content,
            Err(error) => {
                let error = StoreError::from(error);
                if error.is_unavailable() {
                    return Err(error);
                }
                // An object that is too short has no such range.
                return Err(self.verify(id).await.err().unwrap_or(error));
            }
        };
        if content.len() as u64 != groups.end - groups.start || !tree.holds(groups.start, &content) {
            return Err(StoreError::BlobDamaged(id));
        }
        Ok(cut(&content, bytes.start - groups.start..bytes.end.min(groups.end) - groups.start))
    }

    /// The hashes of a blob's groups; none if it is no larger than one.
    async fn hash_tree(&self, id: BlobId) -> Result<Option<Arc<HashTree>>> {
        if let Some(tree) = self.trees.get(id) {
            return Ok(Some(tree));
        }
        let length = self.length(id).await?;
        if length <= hash_tree::GROUP {
            return Ok(None);
        }
        let mut builder = HashTreeBuilder::new();
        self.read_through(id, length, |bytes| builder.update(bytes)).await?;
        let tree = Arc::new(builder.finish(id).ok_or(StoreError::BlobDamaged(id))?);
        self.trees.keep(id, tree.clone());
        Ok(Some(tree))
    }

    /// Reads an object of this many bytes from its beginning to its end.
    async fn read_through(&self, id: BlobId, length: u64, mut take: impl FnMut(&[u8])) -> Result<()> {
        let path = path_of(id);
        let mut start = 0;
        while start < length {
            let end = length.min(start + self.backend.stretch);
            take(&self.backend.objects.get_range(&path, start..end).await?);
            start = end;
        }
        Ok(())
    }

    /// Size of a blob \[bytes\].
    async fn length(&self, id: BlobId) -> Result<u64> {
        let path = path_of(id);
        match self.backend.objects.head(&path).await {
            Ok(meta) => Ok(meta.size),
            // The answer to this request has no body that would distinguish a missing object from a missing bucket.
            Err(object_store::Error::NotFound { .. }) => Ok(self.backend.objects.get(&path).await?.meta.size),
            Err(error) => Err(error.into()),
        }
    }

    /// Blobs and scratch objects that were written before a time \[ms since the epoch\]. Files of others are not among
    /// them.
    pub(crate) async fn objects_before(&self, cutoff: i64) -> Result<Vec<StoredObject>> {
        let is_old = async |meta: ObjectMeta| {
            let object = StoredObject { path: meta.location, bytes: meta.size, unfinished: None };
            let is_ours = object.blob().is_some() || object.path.prefix_matches(&ObjectPath::from(SCRATCH));
            Ok((is_ours && meta.last_modified.timestamp_millis() < cutoff).then_some(object))
        };
        Ok(self.backend.objects.list(None).try_filter_map(is_old).try_collect().await?)
    }

    /// Deletes an object, or the part of one; one that is gone already is no matter.
    pub(crate) async fn delete(&self, object: &StoredObject) -> Result<()> {
        if let Some(file) = &object.unfinished {
            return backend::delete_file(file);
        }
        match self.backend.objects.delete(&object.path).await {
            Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Parts of uploads that were begun before a time \[ms since the epoch\] and not finished. None of a bucket, whose own rule deletes
    /// them.
    pub(crate) async fn unfinished_uploads(&self, cutoff: i64) -> Result<Vec<StoredObject>> {
        self.backend.unfinished_uploads(cutoff).await
    }

    /// Requests a missing object from a bucket's service, once.
    ///
    /// # Errors
    /// Its certificate is not accepted. Other errors, and a missing answer, do not count.
    pub(crate) async fn check_certificate(&self) -> Result<()> {
        let Some(once) = &self.backend.once else { return Ok(()) };
        match once.head(&ObjectPath::from(SCRATCH)).await.map_err(StoreError::from) {
            Err(error @ StoreError::UntrustedObjects(_)) => Err(error),
            _ => Ok(()),
        }
    }

    /// Writes, reads and deletes a scratch object: a full or read-only disk shows here.
    pub(crate) async fn probe(&self, content: Bytes) -> Result<()> {
        let path = ObjectPath::from(format!("{SCRATCH}/{}", blake3::hash(&content).to_hex()));
        self.backend.objects.put(&path, PutPayload::from(content.clone())).await?;
        let read = self.backend.objects.get(&path).await?.bytes().await?;
        self.backend.objects.delete(&path).await?;
        if read != content {
            return Err(StoreError::Corrupt("a scratch object came back changed".to_owned()));
        }
        Ok(())
    }
}

/// A part of some bytes, up to their end.
fn cut(bytes: &Bytes, range: Range<u64>) -> Bytes {
    let place = |at: u64| usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len());
    bytes.slice(place(range.start)..place(range.end))
}
