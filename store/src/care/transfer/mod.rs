//! Transfer of a store to another one, between any engines and object stores.
//!
//! Blobs go first: they are named by their content, so present ones are not copied again, and an interrupted transfer resumes. Rows follow
//! unchanged in one transaction, counters and events included, and are compared with the source before the commit: a partial store is never
//! visible. Effects of triggers are in the rows already; the only triggers on inserts notify waiting processes.

mod table;

use std::time::Duration;

use futures::{StreamExt, TryStreamExt, stream};

use self::table::Table;
use crate::blob_id::BlobId;
use crate::engine::database::Transaction;
use crate::engine::location::DatabaseLocation;
use crate::engine::query::query;
use crate::engine::role::Role;
use crate::engine::sql;
use crate::error::StoreError;
use crate::store::{Store, StoreConfig};

/// Tables that are carried over, each after those that it refers to.
const TABLES: &[&str] = &[
    "scenario",
    "work",
    "owner_turn",
    "sweep",
    "appended",
    "idempotency",
    "point",
    "event",
    "result",
    "artifact",
    "machine_speed",
    "collection",
    "token",
];

/// Tables that are left behind: workers, sessions, and blobs that are being written or deleted.
#[cfg(test)]
const LEFT: &[&str] = &["removal", "session", "upload", "worker"];

/// Silence after which a worker counts as gone: it renews its entry several times within that.
const WORKER_SILENCE: Duration = Duration::from_secs(100);

/// Names of blobs that are in memory at once.
const PAGE: i64 = 10_000;

/// Blobs that are copied at the same time; a large one has a part of some megabytes in memory.
const AT_ONCE: usize = 8;

/// Treatment of a source that others use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceUse {
    /// It is refused while workers are at it.
    Idle,
    /// The store is copied as of this moment, without later changes.
    Running,
}

/// Progress of a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransferProgress {
    /// Blobs are being copied, or were there.
    Blobs {
        /// Number done.
        done: u64,
        /// Number in all.
        of: u64,
    },
    /// The rows of a table are being copied.
    Rows(&'static str),
    /// Rows of a table of the new store are being compared with those that they come from.
    Compared(&'static str),
}

/// Report of a transfer.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TransferReport {
    /// Rows by table.
    pub rows: Vec<(&'static str, u64)>,
    /// Blobs that rows name.
    pub blobs: u64,
    /// Number of those that were present already, and whole.
    pub blobs_present: u64,
    /// Size of those that were copied.
    pub bytes_copied: u64,
    /// Work items that were leased, and were given back.
    pub released: u64,
    /// Blobs that the old store has lost, one text with the reason each. The new store lacks them.
    pub lost: Vec<String>,
}

/// Errors of a transfer. The new store has no rows then.
#[derive(Debug, thiserror::Error)]
pub enum TransferError {
    /// Both are one database.
    #[error("the store cannot be copied to itself")]
    Itself,
    /// The new one holds something.
    #[error("the target database is in use: it has rows in the table {0}; it must be empty")]
    NotEmpty(&'static str),
    /// Workers are at the old one.
    #[error(
        "the store is in use: {workers} workers sent a heartbeat in the last {} s, and {leases} points are running; \
         stop them first",
        WORKER_SILENCE.as_secs()
    )]
    InUse {
        /// Leases that have not run out.
        leases: u64,
        /// Workers with a recent heartbeat.
        workers: u64,
    },
    /// The old one is of another version of this program.
    #[error(
        "the table {0} of the store has another schema than this version of the program: open the store by this version once, as `drillsweep serve` does"
    )]
    OtherSchema(&'static str),
    /// The rows written are not those read.
    #[error("the table {0} of the new store differs from that of the old one; nothing was kept")]
    Differs(&'static str),
    /// A database or an object store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Copies a store to another one without rows. The source is read in one snapshot; neither its data nor its schema changes, except that
/// pending changes of work items are applied first. An interrupted transfer resumes: whole blobs are not copied again, rows are. Leased
/// work arrives as released, with its fencing token.
///
/// # Errors
/// One of the stores is unsuitable or fails. A lost blob is no error, but [reported](TransferReport::lost).
pub async fn transfer(
    source: &StoreConfig,
    target: &StoreConfig,
    source_use: SourceUse,
    progress: &mut dyn FnMut(TransferProgress),
) -> Result<TransferReport, TransferError> {
    if is_same(&source.database, &target.database) {
        return Err(TransferError::Itself);
    }
    let source = Store::open_read_only(source).await?;
    let mut snapshot = source.database.read_applied().await?;
    let tables = tables(&mut snapshot).await?;
    if source_use == SourceUse::Idle {
        refuse_use(&mut snapshot).await?;
    }
    let target = Store::open(&StoreConfig { role: Role::Server, ..target.clone() }).await?;
    let mut empty = target.database.read().await?;
    let target_tables = self::tables(&mut empty).await?;
    for (table, target) in tables.iter().zip(&target_tables) {
        if !table.is_like(target) {
            return Err(TransferError::OtherSchema(table.name));
        }
    }
    refuse_rows(&target_tables, &mut empty).await?;
    empty.rollback().await?;

    let mut report = TransferReport::default();
    copy_blobs(&source, &mut snapshot, &target, &mut report, progress).await?;
    let mut writing = target.write().await?;
    // Somebody may have come meanwhile.
    refuse_rows(&target_tables, &mut writing).await?;
    let mut sums = Vec::new();
    for (table, target) in tables.iter().zip(&target_tables) {
        progress(TransferProgress::Rows(table.name));
        sums.push(table.copy(&mut snapshot, target, &mut writing).await?);
    }
    for (target, sum) in target_tables.iter().zip(&sums) {
        progress(TransferProgress::Compared(target.name));
        if target.sum(&mut writing).await? != *sum {
            return Err(TransferError::Differs(target.name));
        }
        report.rows.push((target.name, sum.rows));
    }
    report.released = query(sql::transfer::RELEASE).execute(&mut writing).await?;
    writing.commit().await?;
    snapshot.rollback().await?;
    source.close().await;
    target.close().await;
    Ok(report)
}

/// True if two locations name one database. One database under two names is refused for its rows.
fn is_same(source: &DatabaseLocation, target: &DatabaseLocation) -> bool {
    match (source, target) {
        (DatabaseLocation::Sqlite(source), DatabaseLocation::Sqlite(target)) => {
            source == target
                || matches!((source.canonicalize(), target.canonicalize()), (Ok(source), Ok(target)) if source == target)
        }
        (DatabaseLocation::Postgres(_), DatabaseLocation::Postgres(_)) => {
            source.with_secrets() == target.with_secrets()
        }
        _ => false,
    }
}

/// The tables as a database has them.
async fn tables(tx: &mut Transaction) -> Result<Vec<Table>, StoreError> {
    let mut tables = Vec::new();
    for name in TABLES {
        tables.push(Table::read(name, tx).await?);
    }
    Ok(tables)
}

async fn refuse_use(snapshot: &mut Transaction) -> Result<(), TransferError> {
    let silence = i64::try_from(WORKER_SILENCE.as_millis()).unwrap_or(i64::MAX);
    let (leases, workers): (i64, i64) = query(sql::transfer::USERS).bind(silence).one(&mut *snapshot).await?;
    let (leases, workers) = (leases.unsigned_abs(), workers.unsigned_abs());
    match leases + workers {
        0 => Ok(()),
        _ => Err(TransferError::InUse { leases, workers }),
    }
}

async fn refuse_rows(tables: &[Table], tx: &mut Transaction) -> Result<(), TransferError> {
    for table in tables {
        if !table.is_empty(tx).await? {
            return Err(TransferError::NotEmpty(table.name));
        }
    }
    Ok(())
}

async fn copy_blobs(
    source: &Store,
    snapshot: &mut Transaction,
    target: &Store,
    report: &mut TransferReport,
    progress: &mut dyn FnMut(TransferProgress),
) -> Result<(), StoreError> {
    let of: i64 = query(sql::transfer::COUNT_BLOBS).scalar(&mut *snapshot).await?;
    let of = of.unsigned_abs();
    let mut last = String::new();
    loop {
        progress(TransferProgress::Blobs { done: report.blobs, of });
        let page: Vec<String> =
            query(sql::transfer::BLOBS).bind(&last).bind(PAGE).scalars(&mut *snapshot).await?;
        let Some(end) = page.last() else { return Ok(()) };
        last.clone_from(end);
        let copy = async |name: String| match copy_blob(source, target, &name).await {
            Ok(copied) => Ok((copied, None)),
            Err(error) if error.is_damage() => Ok((None, Some(format!("blob {name}: {error}")))),
            Err(error) => Err(error),
        };
        let mut copies = stream::iter(page).map(copy).buffer_unordered(AT_ONCE);
        while let Some((copied, lost)) = copies.try_next().await? {
            report.blobs += 1;
            match (copied, lost) {
                (Some(bytes), _) => report.bytes_copied += bytes,
                (None, Some(lost)) => report.lost.push(lost),
                (None, None) => report.blobs_present += 1,
            }
            progress(TransferProgress::Blobs { done: report.blobs, of });
        }
    }
}

/// Gives the size of a blob that was copied; none of one that was there.
async fn copy_blob(source: &Store, target: &Store, name: &str) -> Result<Option<u64>, StoreError> {
    target.blobs().copy_from(source.blobs(), name.parse::<BlobId>()?).await
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use sqlx::Row as _;

    use super::*;
    use crate::engine::database::Database;

    #[tokio::test]
    async fn every_table_is_carried_or_left_on_purpose_and_after_those_that_it_refers_to() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(&StoreConfig::in_directory(directory.path(), Role::Server)).await.unwrap();
        let Database::Sqlite(pool, _) = &store.database else { panic!("a directory has a SQLite file") };
        let schema: BTreeSet<String> = sqlx::query_scalar(
            "SELECT name FROM sqlite_schema WHERE type = 'table'
             AND name NOT LIKE '\\_sqlx%' ESCAPE '\\' AND name NOT LIKE 'sqlite\\_%' ESCAPE '\\'",
        )
        .fetch_all(pool)
        .await
        .unwrap()
        .into_iter()
        .collect();
        let known: BTreeSet<String> = TABLES.iter().chain(LEFT).map(|name| (*name).to_owned()).collect();
        assert_eq!(schema, known);
        for (place, table) in TABLES.iter().enumerate() {
            let parents = sqlx::query("SELECT \"table\" FROM pragma_foreign_key_list($1)").bind(*table);
            for parent in parents.fetch_all(pool).await.unwrap() {
                let parent: String = parent.get(0);
                assert!(TABLES[..place].contains(&parent.as_str()), "{table} comes before {parent}");
            }
        }
    }
}
