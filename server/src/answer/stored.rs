//! Stored tables: read in verified ranges, and recomputed if storage has lost them.

use std::io;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::body::{Body, Bytes};
use drillsweep_api::{PHYSICS_VERSION, ProblemKind};
use drillsweep_store::{Artifact, BlobId, BlobStore, Repair, Store, StoreError, WorkKey};
use drillsweep_table::parquet::{self, ReadAt, StoredTable};
use drillsweep_table::{Table, TableError};
use tokio::runtime::Handle;
use tokio::sync::mpsc;

use crate::answer::chunk::{self, Allowance, Chunk};
use crate::answer::error::{Error, Result};
use crate::answer::records;

/// Length of the ranges in which files are read, verified and sent \[bytes\]: the unit of verification of the store.
const PART: u64 = 256 << 10;

/// Memory for sending a stored file \[bytes\]: a range that is sent, and the next one.
pub(crate) const MEMORY_OF_FILE: u64 = 2 * PART;

/// A table of a result; nothing of it is in memory.
#[derive(Clone)]
pub(crate) struct Stored {
    store: Store,
    key: WorkKey,
    name: String,
    rows: u64,
    file: StoredFile,
}

/// File of a table, for blocking reads.
#[derive(Clone)]
pub(crate) struct StoredFile {
    blobs: BlobStore,
    blob: BlobId,
    length: u64,
    handle: Handle,
    /// Error of the last failed read, which Parquet's errors do not carry.
    failure: Arc<Mutex<Option<StoreError>>>,
}

impl ReadAt for StoredFile {
    fn length(&self) -> u64 {
        self.length
    }

    fn read_at(&self, range: Range<u64>) -> io::Result<Bytes> {
        self.handle.block_on(self.blobs.get_range(self.blob, range)).map_err(|error| {
            let failed = io::Error::other(error.to_string());
            *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            failed
        })
    }
}

impl Stored {
    /// A table of a result, unless it has expired.
    pub(crate) fn new(store: &Store, key: &WorkKey, artifact: Artifact) -> Result<Self> {
        check_age(&artifact)?;
        let file = StoredFile {
            blobs: store.blobs().clone(),
            blob: artifact.blob.parse()?,
            length: artifact.bytes.unsigned_abs(),
            handle: Handle::current(),
            failure: Arc::default(),
        };
        let rows = artifact.row_count.unsigned_abs();
        Ok(Self { store: store.clone(), key: *key, name: artifact.name, rows, file })
    }

    /// Hash of its contents.
    pub(crate) fn blob(&self) -> BlobId {
        self.file.blob
    }

    /// Length of the file \[bytes\].
    pub(crate) fn length(&self) -> u64 {
        self.file.length
    }

    /// The number of rows.
    pub(crate) fn rows(&self) -> u64 {
        self.rows
    }

    /// Memory for reading it piece by piece \[bytes\].
    pub(crate) async fn memory(&self) -> Result<u64> {
        self.memory_of(u64::MAX).await
    }

    /// Memory for reading so many of its columns piece by piece \[bytes\].
    pub(crate) async fn memory_of(&self, columns: u64) -> Result<u64> {
        let end = self.range(self.length().saturating_sub(parquet::FOOTER_END)..self.length()).await?;
        Ok(parquet::memory(self.length(), &end, self.rows, columns))
    }

    /// All bytes, of a small file.
    pub(crate) async fn whole(&self) -> Result<Bytes> {
        match self.file.blobs.get(self.file.blob).await {
            Ok(bytes) => Ok(bytes),
            Err(error) => Err(self.lost(error).await),
        }
    }

    /// A range of the bytes.
    pub(crate) async fn range(&self, range: Range<u64>) -> Result<Bytes> {
        match self.file.blobs.get_range(self.file.blob, range).await {
            Ok(bytes) => Ok(bytes),
            Err(error) => Err(self.lost(error).await),
        }
    }

    /// Verifies all bytes.
    pub(crate) async fn verify(&self) -> Result<()> {
        match self.file.blobs.verify(self.file.blob).await {
            Ok(_) => Ok(()),
            Err(error) => Err(self.lost(error).await),
        }
    }

    /// The ranges in which a range of the bytes is read.
    pub(crate) fn parts(range: Range<u64>) -> impl Iterator<Item = Range<u64>> {
        let mut next = range.start;
        std::iter::from_fn(move || {
            let part = next..range.end.min((next / PART + 1) * PART);
            next = part.end;
            (!part.is_empty()).then_some(part)
        })
    }

    /// A body of a range of the bytes, read as the client takes them. The first bytes are read before the answer begins, so that damage
    /// there is a problem; damage further on breaks the body off. A range that is read at once takes no place; any other holds its place to
    /// its end.
    pub(crate) async fn body<H: Send + 'static>(
        self,
        range: Range<u64>,
        place: impl Future<Output = Result<(H, Allowance)>>,
    ) -> Result<Body> {
        let mut parts = Self::parts(range).peekable();
        let Some(first) = parts.next() else { return Ok(Body::empty()) };
        if parts.peek().is_none() {
            return Ok(self.range(first).await?.into());
        }
        let (held, mut allowance) = place.await?;
        let first = Chunk::One(self.range(first).await?);
        let (sender, receiver) = mpsc::channel(1);
        tokio::spawn(async move {
            let _held = held;
            while let Some(part) = parts.next() {
                let bytes = (part.end - part.start) as usize;
                let Some(room) = allowance.room(&sender, bytes).await else { return };
                let next = match self.range(part).await {
                    Ok(bytes) if parts.peek().is_none() => Ok(Chunk::Last(bytes)),
                    Ok(bytes) => Ok(Chunk::One(bytes)),
                    Err(error) => Err(error),
                };
                let is_broken = next.is_err();
                room.send(next);
                if is_broken {
                    return;
                }
            }
        });
        Ok(chunk::body(Some(first), receiver))
    }

    /// The table for reads of its parts. Blocks.
    pub(crate) fn open(&self) -> Result<StoredTable<StoredFile>> {
        StoredTable::open(self.file.clone()).map_err(|error| self.problem(error))
    }

    /// Some columns, or all of them, of all rows, with numbers in double precision. Blocks.
    pub(crate) fn read(&self, columns: Option<&[&str]>) -> Result<Table> {
        let stored = self.open()?;
        let all: Vec<&str> = stored.layout().columns.keys().map(String::as_str).collect();
        let table = stored.read(columns.unwrap_or(&all), 0..stored.rows());
        Ok(table.map_err(|error| self.problem(error))?.widened())
    }

    /// Problem of a failed read. If storage has lost the table, its point is queued again, and the problem reports that. Blocks.
    pub(crate) fn problem(&self, error: TableError) -> Error {
        let failure = self.file.failure.lock().unwrap_or_else(PoisonError::into_inner).take();
        match failure {
            Some(failure) => self.file.handle.block_on(self.lost(failure)),
            None => error.into(),
        }
    }

    async fn lost(&self, error: StoreError) -> Error {
        if !error.is_damage() {
            return error.into();
        }
        tracing::error!(%error, table = self.name, "a stored table is damaged");
        match self.store.queue_damaged(&self.key, self.file.blob, PHYSICS_VERSION.into()).await {
            Ok(repair) => damaged(&self.name, repair),
            Err(error) => error.into(),
        }
    }
}

/// Refuses an expired table.
pub(crate) fn check_age(artifact: &Artifact) -> Result<()> {
    let Some(expired) = artifact.expired else { return Ok(()) };
    let detail = format!(
        "the table {} expired at {}; the summary is kept, and a sweep submitted with ?cache=refresh recomputes the point",
        artifact.name,
        records::timestamp(expired)?
    );
    Err(Error::new(ProblemKind::Expired, detail))
}

/// Retry-After of a table whose point is computed again: a run takes minutes.
const RECOMPUTING: Duration = Duration::from_secs(30);

/// Problem of a lost table, with its repair.
fn damaged(name: &str, repair: Repair) -> Error {
    let is_lost = format!("the stored table {name} is missing or damaged");
    let consequence = match repair {
        Repair::Queued | Repair::UnderWay => {
            let detail = format!("{is_lost}; its point is being recomputed, try again later");
            return Error::temporary(ProblemKind::Recomputing, detail, RECOMPUTING);
        }
        Repair::TriedBefore => {
            "recomputing its point failed, with the reason in the point's `error`; submit it again to retry"
                .to_owned()
        }
        Repair::OtherNumbers(version) => format!(
            "it is of physics version {version}, which no worker computes any more: submit the scenario again, for \
             version {PHYSICS_VERSION}"
        ),
        Repair::Replaced => return Error::unavailable("a table was replaced while it was read"),
    };
    Error::new(ProblemKind::Damaged, format!("{is_lost}; {consequence}"))
}
