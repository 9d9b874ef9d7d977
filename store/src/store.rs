//! Store: database and object store of a process, and how they are opened.

use std::path::{Path, PathBuf};

use crate::blob::location::ObjectsLocation;
use crate::blob::store::BlobStore;
use crate::engine::database::{Database, Transaction};
use crate::engine::location::DatabaseLocation;
use crate::engine::notification::{Changes, Listening};
use crate::engine::query::query;
use crate::engine::role::Role;
use crate::engine::sql;
use crate::engine::throttle::Throttle;
use crate::error::Result;
use crate::metrics::Metrics;

/// Location of the store, and role of the process that opens it.
#[derive(Debug, Clone)]
pub struct StoreConfig {
    /// The queue and the index of results.
    pub database: DatabaseLocation,
    /// The object store.
    pub objects: ObjectsLocation,
    /// Role of the process that opens it.
    pub role: Role,
    /// Offset of the database's clock \[ms\]: zero except in tests.
    pub clock_offset_ms: i64,
    /// Counts its use.
    pub metrics: Metrics,
}

impl StoreConfig {
    /// A SQLite file and the blobs in one directory; opening the store creates them if they are missing.
    pub fn in_directory(directory: &Path, role: Role) -> Self {
        Self {
            database: DatabaseLocation::Sqlite(directory.join("drillsweep.sqlite")),
            objects: ObjectsLocation::Directory(directory.join("blobs")),
            role,
            clock_offset_ms: 0,
            metrics: Metrics::default(),
        }
    }

    /// The same with the blobs somewhere else.
    #[must_use]
    pub fn with_objects(self, objects: ObjectsLocation) -> Self {
        Self { objects, ..self }
    }

    /// True if a store exists; opening makes one otherwise. A database server counts as existing until it is opened.
    pub fn exists(&self) -> bool {
        match &self.database {
            DatabaseLocation::Sqlite(path) => path.exists(),
            DatabaseLocation::Postgres(_) => true,
        }
    }
}

/// The queue, the index of results and the object store. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Store {
    pub(crate) database: Database,
    /// The file of the embedded engine.
    pub(crate) database_path: Option<PathBuf>,
    pub(crate) listening: Listening,
    pub(crate) reaping: Throttle,
    pub(crate) applying: Throttle,
    pub(crate) metrics: Metrics,
    blobs: BlobStore,
}

impl Store {
    /// Opens the store and brings its schema up to date. Any number of processes may do so at once.
    ///
    /// # Errors
    /// A directory cannot be made, or the database cannot be opened or migrated.
    pub async fn open(config: &StoreConfig) -> Result<Self> {
        Self::with(config, Database::open(&config.database, config.role, config.clock_offset_ms).await?)
    }

    /// Opens the store read-only: nothing is made or changed, so that a copy on a read-only medium can be read.
    ///
    /// # Errors
    /// The database cannot be opened.
    pub async fn open_read_only(config: &StoreConfig) -> Result<Self> {
        Self::with(config, Database::open_read_only(&config.database).await?)
    }

    fn with(config: &StoreConfig, database: Database) -> Result<Self> {
        let database_path = match &config.database {
            DatabaseLocation::Sqlite(path) => Some(path.clone()),
            DatabaseLocation::Postgres(_) => None,
        };
        Ok(Self {
            database,
            database_path,
            listening: Listening::default(),
            reaping: Throttle::default(),
            applying: Throttle::default(),
            metrics: config.metrics.clone(),
            blobs: BlobStore::counted(&config.objects, &config.metrics.objects)?,
        })
    }

    /// The object store.
    pub fn blobs(&self) -> &BlobStore {
        &self.blobs
    }

    /// Checks the certificate of an object store that is reached by TLS. A store that does not answer is no error here.
    ///
    /// # Errors
    /// [`StoreError::UntrustedObjects`](crate::StoreError::UntrustedObjects) if it is refused.
    pub async fn check_certificate(&self) -> Result<()> {
        self.blobs.check_certificate().await
    }

    /// Closes all connections; a write-ahead log is folded in.
    pub async fn close(&self) {
        self.listening.stop().await;
        self.database.close().await;
    }

    /// A transaction during which no other one changes the state of a work item, a point or a sweep.
    pub(crate) async fn write(&self) -> Result<Transaction> {
        self.database.write().await
    }

    /// A transaction that changes the state of one work item and what belongs to it, concurrently with others that do so.
    pub(crate) async fn write_one(&self) -> Result<Transaction> {
        self.database.write_one().await
    }

    /// Notifications of work that may have become ready to be claimed.
    pub async fn work_changes(&self) -> Changes {
        self.listening.work_changes(&self.database).await
    }

    /// Notifications of changes of sweeps and of their points.
    pub async fn sweep_changes(&self) -> Changes {
        self.listening.sweep_changes(&self.database).await
    }

    /// Applies the consequences for others of changes of work items whose processes died before; called before such data is read.
    pub(crate) async fn apply_left_transitions(&self) {
        if self.applying.is_due() {
            self.database.apply_transitions().await;
        }
    }

    /// Milliseconds since the epoch by the database's clock.
    ///
    /// # Errors
    /// The database fails.
    pub async fn now_ms(&self) -> Result<i64> {
        query(sql::clock::NOW).scalar(&self.database).await
    }
}
