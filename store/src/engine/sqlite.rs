//! The embedded engine: a SQLite file.

use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
    SqliteTransaction,
};
use sqlx::{AssertSqlSafe, Connection as _, Executor as _};
use tokio::sync::{Mutex, OwnedMutexGuard};

use crate::engine::migration;
use crate::engine::role::Role;
use crate::error::{Result, StoreError};

/// Lock that only one writer of this process holds at a time.
pub(crate) type Writers = Arc<Mutex<()>>;

/// Time for which a writer waits for another one.
const BUSY_TIMEOUT: Duration = Duration::from_secs(30);

/// Bytes to which the write-ahead log is cut back.
const JOURNAL_SIZE_LIMIT: &str = "67108864";

/// Rows that the thread of a connection reads ahead of their reader: a page of most lists at once. With few, both threads wait for each
/// other all the time, which on a busy machine takes a hundred times as long as the reading.
const ROWS_AHEAD: usize = 500;

/// Pages that a connection keeps, in KiB (hence the sign). A large submission touches the indexes of keys, which are hashes, all
/// over: with SQLite's 2 MB it would read and write the same pages again and again.
const SERVER_CACHE: &str = "-16384";

/// The same for a worker, which handles a point at a time.
const WORKER_CACHE: &str = "-8192";

/// Opens the file, makes it if it is missing, and brings its schema up to date. Any number of processes may do so at once.
pub(crate) async fn open(path: &Path, role: Role, clock_offset_ms: i64) -> Result<SqlitePool> {
    if let Some(directory) = path.parent().filter(|path| !path.as_os_str().is_empty()) {
        std::fs::create_dir_all(directory)
            .map_err(|source| StoreError::Directory { path: directory.display().to_string(), source })?;
    }
    let options = SqliteConnectOptions::new()
        .filename(path)
        .create_if_missing(true)
        .journal_mode(SqliteJournalMode::Wal)
        .busy_timeout(BUSY_TIMEOUT)
        .row_buffer_size(ROWS_AHEAD)
        .foreign_keys(true)
        .synchronous(match role {
            Role::Server => SqliteSynchronous::Full,
            Role::Worker => SqliteSynchronous::Normal,
        })
        .pragma("journal_size_limit", JOURNAL_SIZE_LIMIT)
        .pragma(
            "cache_size",
            match role {
                Role::Server => SERVER_CACHE,
                Role::Worker => WORKER_CACHE,
            },
        );
    refuse_network_file_system(path)?;
    let connections = match role {
        Role::Server => 4,
        Role::Worker => 2,
    };
    let opening = lock_opening(path).await?;
    // SQLite ends a transaction by itself when the disk is full. sqlx does not notice, its own rollback fails, and it
    // would refuse every further transaction on that connection: such a one is closed instead of handed out.
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
    migration::sqlite().run(&pool).await?;
    drop(opening);
    Ok(pool)
}

/// Refuses a file that other machines have, too: SQLite's locks and its shared memory do not reach them, and the file would be damaged.
fn refuse_network_file_system(path: &Path) -> Result<()> {
    let directory = path.parent().filter(|path| !path.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let kind = rustix::fs::statfs(directory)
        .map_err(|error| StoreError::Directory {
            path: directory.display().to_string(),
            source: error.into(),
        })?
        .f_type;
    match network_file_system(kind as u64) {
        Some(name) => Err(StoreError::NetworkFileSystem { path: path.to_owned(), name }),
        None => Ok(()),
    }
}

/// The network file system that Linux reports as this number in `statfs`; none if it is on a disk of this machine. From linux/magic.h
/// and the file systems' own sources.
fn network_file_system(kind: u64) -> Option<&'static str> {
    Some(match kind & 0xffff_ffff {
        0x6969 => "NFS",
        0xff53_4d42 | 0xfe53_4d42 | 0x517b => "SMB",
        0x00c3_6400 => "Ceph",
        0x0bd0_0bd0 => "Lustre",
        0x4750_4653 => "GPFS",
        0x1983_0326 => "BeeGFS",
        0x5346_414f | 0x6b41_4653 => "AFS",
        0x0102_1997 => "9P",
        0x7461_636f => "OCFS2",
        0x0116_1970 => "GFS2",
        _ => return None,
    })
}

/// Opens the file read-only: nothing is made or changed, so that a copy on a read-only medium can be read.
pub(crate) async fn open_read_only(path: &Path) -> Result<SqlitePool> {
    let mut log = OsString::from(path);
    log.push("-wal");
    let options = SqliteConnectOptions::new()
        .filename(path)
        .read_only(true)
        // SQLite would make files for its write-ahead log even to read. Whoever writes has one already.
        .immutable(!Path::new(&log).exists())
        .busy_timeout(BUSY_TIMEOUT);
    Ok(SqlitePoolOptions::new().max_connections(1).connect_with(options).await?)
}

/// A transaction that takes the write lock at once: a deferred one fails with "database is locked" however long the busy
/// timeout is.
///
/// Within a process writers take turns in the order in which they ask: SQLite's own waiting is trying again after a while,
/// by which one that writes time after time would get in before one that waits.
pub(crate) async fn write(
    pool: &SqlitePool,
    writers: &Writers,
) -> Result<(SqliteTransaction<'static>, OwnedMutexGuard<()>)> {
    let turn = writers.clone().lock_owned().await;
    let transaction = pool.begin_with("BEGIN IMMEDIATE").await?;
    Ok((transaction, turn))
}

/// Time for which others may open a database before it is opened concurrently; it takes them some milliseconds.
const OPENING_TIMEOUT: Duration = Duration::from_secs(10);

/// Interval of checks for the end of their opening.
const OPENING_POLL: Duration = Duration::from_millis(10);

/// Waits for other processes that are opening the same database. Switching a new file to write-ahead logging fails at once with "database
/// is locked" while another process does the same, regardless of the busy timeout, and sqlx's migrations take no lock on SQLite. The lock
/// ends with the file's handle and with the process. After a timeout others open without it, so that a stopped holder does not block them.
async fn lock_opening(database: &Path) -> Result<File> {
    let mut path = OsString::from(database);
    path.push(".lock");
    let failed = |source| StoreError::Directory { path: path.display().to_string(), source };
    let file = File::create(&path).map_err(failed)?;
    let deadline = Instant::now() + OPENING_TIMEOUT;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_of_this_machine_is_taken_and_a_network_is_not() {
        let directory = tempfile::tempdir().unwrap();
        refuse_network_file_system(&directory.path().join("drillsweep.sqlite")).unwrap();
        // ext4, tmpfs, overlayfs, XFS, btrfs.
        for local in [0xef53, 0x0102_1994, 0x794c_7630, 0x5846_5342, 0x9123_683e] {
            assert_eq!(network_file_system(local), None, "{local:x}");
        }
        assert_eq!(network_file_system(0x6969), Some("NFS"));
        // On some machines the number is signed.
        assert_eq!(network_file_system(0xff53_4d42_u32 as i32 as u64), Some("SMB"));
    }
}
