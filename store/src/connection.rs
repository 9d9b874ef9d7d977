//! Opening the store.

use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, Connection as _, Executor as _, Sqlite, SqliteConnection, Transaction};
use tokio::sync::{Mutex, OwnedMutexGuard};

use crate::blob::BlobStore;
use crate::error::{Result, StoreError};
use crate::{migration, sql};

/// How long a writer waits for another one.
const BUSY_TIMEOUT: Duration = Duration::from_secs(30);

/// Bytes to which the write-ahead log is cut back.
const JOURNAL_SIZE_LIMIT: &str = "67108864";

/// Where the store lies and who opens it. Where it lies is for the constructor to say, so that nothing outside this crate
/// depends on an engine.
#[derive(Debug, Clone)]
pub struct StoreConfig {
    /// The SQLite file.
    database_path: PathBuf,
    /// The directory of the object store.
    blob_directory: PathBuf,
    /// Who opens it.
    pub role: Role,
    /// Added to the database's clock \[ms\]: zero but in tests of what time does.
    pub clock_offset_ms: i64,
}

impl StoreConfig {
    /// A SQLite file and the blobs in one directory; what does not exist is made when the store is opened.
    pub fn in_directory(directory: &Path, role: Role) -> Self {
        Self {
            database_path: directory.join("drillsweep.sqlite"),
            blob_directory: directory.join("blobs"),
            role,
            clock_offset_ms: 0,
        }
    }

    /// Whether there is a store already; opening makes one where there is none.
    pub fn exists(&self) -> bool {
        self.database_path.exists()
    }
}

/// Who opens the store; it decides how durable a commit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// What a client was told must survive a power cut.
    Server,
    /// A lost claim or result is only computed again.
    Worker,
}

/// The queue, the index of results and the object store. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Store {
    pub(crate) pool: SqlitePool,
    pub(crate) database_path: PathBuf,
    blobs: BlobStore,
    /// Whose turn it is to write.
    writers: Arc<Mutex<()>>,
}

/// A transaction that writes. It is undone unless it is committed.
pub(crate) struct Writing {
    transaction: Transaction<'static, Sqlite>,
    /// Given up after the transaction: fields are dropped in their order.
    _turn: OwnedMutexGuard<()>,
}

impl Writing {
    pub(crate) async fn commit(self) -> Result<()> {
        Ok(self.transaction.commit().await?)
    }

    pub(crate) async fn rollback(self) -> Result<()> {
        Ok(self.transaction.rollback().await?)
    }
}

impl Deref for Writing {
    type Target = SqliteConnection;

    fn deref(&self) -> &SqliteConnection {
        &self.transaction
    }
}

impl DerefMut for Writing {
    fn deref_mut(&mut self) -> &mut SqliteConnection {
        &mut self.transaction
    }
}

/// Pages that a connection keeps, in KiB (hence the sign). A large submission touches the indexes of keys, which are hashes, all
/// over: with SQLite's 2 MB it would read and write the same pages again and again.
const SERVER_CACHE: &str = "-65536";

/// The same for a worker, which handles a point at a time.
const WORKER_CACHE: &str = "-8192";

impl Store {
    /// Opens the store and brings its schema up to date. Any number of processes may do so at once.
    ///
    /// # Errors
    /// When a directory cannot be made, or the database cannot be opened or migrated.
    pub async fn open(config: &StoreConfig) -> Result<Self> {
        if let Some(directory) = config.database_path.parent().filter(|path| !path.as_os_str().is_empty()) {
            std::fs::create_dir_all(directory)
                .map_err(|source| StoreError::Directory { path: directory.display().to_string(), source })?;
        }
        let options = SqliteConnectOptions::new()
            .filename(&config.database_path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .busy_timeout(BUSY_TIMEOUT)
            .foreign_keys(true)
            .synchronous(match config.role {
                Role::Server => SqliteSynchronous::Full,
                Role::Worker => SqliteSynchronous::Normal,
            })
            .pragma("journal_size_limit", JOURNAL_SIZE_LIMIT)
            .pragma(
                "cache_size",
                match config.role {
                    Role::Server => SERVER_CACHE,
                    Role::Worker => WORKER_CACHE,
                },
            );
        let connections = match config.role {
            Role::Server => 4,
            Role::Worker => 2,
        };
        let opening = lock_opening(&config.database_path).await?;
        // SQLite ends a transaction by itself when the disk is full. sqlx does not notice, its own rollback fails, and it
        // would refuse every further transaction on that connection: such a one is closed instead of handed out.
        let clock_offset_ms = config.clock_offset_ms;
        let pool = SqlitePoolOptions::new()
            .max_connections(connections)
            .after_connect(move |connection, _| {
                Box::pin(async move {
                    if clock_offset_ms != 0 {
                        // On this connection the name stands for this view, before the schema's.
                        let clock = format!(
                            "CREATE TEMP VIEW clock AS SELECT now + {clock_offset_ms} AS now FROM main.clock"
                        );
                        connection.execute(AssertSqlSafe(clock)).await?;
                    }
                    Ok(())
                })
            })
            .before_acquire(|connection, _| Box::pin(async move { Ok(!connection.is_in_transaction()) }))
            .connect_with(options)
            .await?;
        migration::migrations().run(&pool).await?;
        drop(opening);
        let blobs = BlobStore::open(&config.blob_directory)?;
        let database_path = config.database_path.clone();
        Ok(Self { pool, database_path, blobs, writers: Arc::default() })
    }

    /// Opens the store to look at it: nothing of it is made or changed, so that a copy on a read-only medium can be looked at.
    ///
    /// # Errors
    /// When the database cannot be opened.
    pub async fn open_read_only(config: &StoreConfig) -> Result<Self> {
        let mut log = OsString::from(&config.database_path);
        log.push("-wal");
        let options = SqliteConnectOptions::new()
            .filename(&config.database_path)
            .read_only(true)
            // SQLite would make files for its write-ahead log even to read. Whoever writes has one already.
            .immutable(!Path::new(&log).exists())
            .busy_timeout(BUSY_TIMEOUT);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await?;
        let blobs = BlobStore::open(&config.blob_directory)?;
        Ok(Self { pool, database_path: config.database_path.clone(), blobs, writers: Arc::default() })
    }

    /// The object store.
    pub fn blobs(&self) -> &BlobStore {
        &self.blobs
    }

    /// Closes all connections; the write-ahead log is folded in.
    pub async fn close(&self) {
        self.pool.close().await;
    }

    /// A transaction that takes the write lock at once: a deferred one fails with "database is locked" however
    /// long the busy timeout is.
    ///
    /// Within a process writers take turns in the order in which they ask: SQLite's own waiting is trying again after a while,
    /// by which one that writes time after time would get in before one that waits.
    pub(crate) async fn write(&self) -> Result<Writing> {
        let turn = self.writers.clone().lock_owned().await;
        let transaction = self.pool.begin_with("BEGIN IMMEDIATE").await?;
        Ok(Writing { transaction, _turn: turn })
    }

    /// Milliseconds since the epoch by the database's clock.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn now_ms(&self) -> Result<i64> {
        Ok(sqlx::query_scalar(sql::clock::NOW).fetch_one(&self.pool).await?)
    }
}

/// How long others may take to open a database before it is opened beside them; it takes them some milliseconds.
const OPENING_PATIENCE: Duration = Duration::from_secs(10);

/// How often it is looked whether they have.
const OPENING_POLL: Duration = Duration::from_millis(10);

/// Waits for whoever else is opening the same database. Turning a new file to write-ahead logging fails at once with
/// "database is locked" while another process does the same, whatever the busy timeout is, and sqlx's migrations take
/// no lock on SQLite. The lock ends with the file's handle, and with the process; one that was stopped while it held the
/// lock must not keep all others out, so these open without it in the end.
async fn lock_opening(database: &Path) -> Result<File> {
    let mut path = OsString::from(database);
    path.push(".lock");
    let failed = |source| StoreError::Directory { path: path.display().to_string(), source };
    let file = File::create(&path).map_err(failed)?;
    let deadline = Instant::now() + OPENING_PATIENCE;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) if Instant::now() < deadline => {
                tokio::time::sleep(OPENING_POLL).await;
            }
            Err(TryLockError::WouldBlock) => return Ok(file),
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
    }
}
