//! What can go wrong in the store.

use std::error::Error as _;
use std::io::ErrorKind;

/// The store's results.
pub type Result<T> = std::result::Result<T, StoreError>;

/// What can go wrong in the store.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The database failed or is busy beyond its patience.
    #[error("database: {0}")]
    Database(#[from] sqlx::Error),
    /// The schema could not be brought up to date.
    #[error("database schema: {0}")]
    Migration(#[from] sqlx::migrate::MigrateError),
    /// The object store failed.
    #[error("object store: {0}")]
    Blob(#[from] object_store::Error),
    /// A result names a blob that is not there, or not any more: it must be written again.
    #[error("the blob {0} of a result is not there")]
    BlobMissing(String),
    /// A directory could not be made, or the database's lock file not taken.
    #[error("{path}: {source}")]
    Directory {
        /// The directory or file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A stored value is not what this program writes.
    #[error("the database holds an unexpected value: {0}")]
    Corrupt(String),
    /// The system has no random numbers.
    #[error("random numbers: {0}")]
    Random(String),
    /// An idempotency key was used for another request.
    #[error("the idempotency key was used for another request before")]
    IdempotencyConflict,
}

impl StoreError {
    /// True where the disk has no room: the same call succeeds once it has.
    pub fn is_full(&self) -> bool {
        if let StoreError::Database(sqlx::Error::Database(error)) = self {
            // SQLITE_FULL with its extended codes.
            return error
                .code()
                .and_then(|code| code.parse::<i64>().ok())
                .is_some_and(|code| code & 0xff == 13);
        }
        let mut cause = self.source();
        while let Some(error) = cause {
            if let Some(error) = error.downcast_ref::<std::io::Error>() {
                return matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded);
            }
            cause = error.source();
        }
        false
    }

    /// True where the same call may succeed a moment later: the database was busy.
    pub fn is_busy(&self) -> bool {
        match self {
            StoreError::Database(sqlx::Error::Database(error)) => {
                // SQLITE_BUSY and SQLITE_LOCKED with their extended codes.
                error
                    .code()
                    .and_then(|code| code.parse::<i64>().ok())
                    .is_some_and(|code| matches!(code & 0xff, 5 | 6))
            }
            StoreError::Database(sqlx::Error::PoolTimedOut) => true,
            _ => false,
        }
    }
}
