//! Errors of the store.

use std::error::Error as _;
use std::io::{self, ErrorKind};
use std::path::PathBuf;
use std::str::FromStr;

use object_store::client::HttpError;
use sqlx::migrate::MigrateError;

use crate::blob_id::BlobId;

/// The store's results.
pub type Result<T> = std::result::Result<T, StoreError>;

/// Error of the store.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The database failed or is busy beyond the timeout.
    #[error("database: {0}")]
    Database(#[from] sqlx::Error),
    /// The database's server has a certificate of an authority that is not trusted, of another name, or out of date.
    #[error(
        "the certificate of the database's server is not accepted: {0}; its URL names a private authority by sslrootcert=FILE, or the environment \
         by SSL_CERT_FILE"
    )]
    Untrusted(rustls::Error),
    /// The schema could not be brought up to date.
    #[error("database schema: {0}")]
    Migration(#[source] MigrateError),
    /// Another version of this program made the schema: its migrations are not those of this one.
    #[error(
        "database schema: written by a version of drillsweep that this one cannot read ({0}); start with a new \
         database, or use that version"
    )]
    OtherSchema(#[source] MigrateError),
    /// The object store failed.
    #[error("object store: {0}")]
    Blob(#[source] object_store::Error),
    /// The object store has a certificate of an authority that is not trusted, of another name, or out of date.
    #[error(
        "the certificate of the object store is not accepted: {0}; the environment names the file of a private authority by SSL_CERT_FILE"
    )]
    UntrustedObjects(rustls::Error),
    /// A result names a blob that is not there, or not any more: it must be written again.
    #[error("the blob {0} of a result is missing")]
    BlobMissing(String),
    /// The content of a blob has changed since it was written.
    #[error("the content of the blob {0} does not match its hash")]
    BlobDamaged(BlobId),
    /// A range of bytes is empty, or begins beyond the end of the blob.
    #[error("the range is outside of the blob {0}")]
    NoSuchRange(BlobId),
    /// A directory could not be made, or the database's lock file not taken.
    #[error("{path}: {source}")]
    Directory {
        /// The directory or file.
        path: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A text is the location of neither a database nor an object store.
    #[error("{0}")]
    Location(String),
    /// SQLite's locks do not reach other machines: on a file system that several have it would damage its file.
    #[error(
        "{} is on {name}, a network file system, on which SQLite would damage its file: put it on a disk of this machine, or give --database postgres://... for several",
        path.display()
    )]
    NetworkFileSystem {
        /// The file.
        path: PathBuf,
        /// Common name of the file system.
        name: &'static str,
    },
    /// A file outside the store, which is to be stored or fetched into, cannot be read or written.
    #[error("a local file: {0}")]
    LocalFile(#[source] io::Error),
    /// A stored value is not what this program writes.
    #[error("the database holds an unexpected value: {0}")]
    Corrupt(String),
    /// The system has no random numbers.
    #[error("random numbers: {0}")]
    Random(String),
    /// An idempotency key was used for another request.
    #[error("the idempotency key belongs to another request")]
    IdempotencyConflict,
    /// The sweep that an idempotency key was used for is just being stored.
    #[error("the sweep of this idempotency key is still being stored")]
    Arriving,
    /// A sweep was not stored in time and was removed.
    #[error("storing the sweep took too long, and it was removed as abandoned")]
    TakenAway,
}

impl StoreError {
    /// True if the disk or the object store has no room: the same call succeeds once it has.
    pub fn is_full(&self) -> bool {
        if let StoreError::Database(sqlx::Error::Database(error)) = self {
            return match engine_code(error.as_ref()) {
                // SQLITE_FULL with its extended codes.
                EngineCode::Sqlite(code) => code & 0xff == 13,
                // disk_full.
                EngineCode::Postgres(code) => code == "53100",
                EngineCode::None => false,
            };
        }
        /// Answers of full services of the S3 protocol: Ceph and SeaweedFS (a quota), MinIO, and others by the status 507.
        const FULL: [&str; 3] = ["<Code>QuotaExceeded<", "<Code>XMinioStorageFull<", "status code: 507"];
        self.answer_has(&FULL)
            || self.cause(|error: &io::Error| {
                matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
            })
    }

    /// True if the object store did not answer, broke off, or reported that it is unavailable: the same call may succeed later.
    /// A blob that was requested is not lost. A certificate that is not accepted is such a case: it may be renewed.
    pub fn is_unavailable(&self) -> bool {
        /// Errors of the service, and too many requests: in the status or in the body of a success.
        const UNABLE: [&str; 4] =
            ["status code: 5", "status code: 429", "status code: 408", "returned error response: "];
        if let StoreError::UntrustedObjects(_) = self {
            return true;
        }
        matches!(self, StoreError::Blob(_))
            && !self.is_full()
            && (self.cause(|_: &HttpError| true) || self.answer_has(&UNABLE))
    }

    /// True if a blob is lost: missing, changed, or on an unreadable part of the disk. A retry cannot help; its content has to be
    /// recomputed.
    pub fn is_damage(&self) -> bool {
        /// The errno of a failed read on Linux and other Unix systems.
        const EIO: i32 = 5;
        match self {
            StoreError::BlobDamaged(_) => true,
            // A bucket that is not there is the wrong one, and an upload that is not there was ended: nothing is lost.
            StoreError::Blob(object_store::Error::NotFound { .. }) => {
                !self.answer_has(&["<Code>NoSuchBucket<", "<Code>NoSuchUpload<"])
            }
            StoreError::Blob(_) => self.cause(|error: &io::Error| error.raw_os_error() == Some(EIO)),
            _ => false,
        }
    }

    /// True if a cause of this type satisfies the condition.
    fn cause<E: std::error::Error + 'static>(&self, is_such: impl Fn(&E) -> bool) -> bool {
        let mut cause = self.source();
        while let Some(error) = cause {
            if error.downcast_ref().is_some_and(&is_such) {
                return true;
            }
            cause = error.source();
        }
        false
    }

    /// True if a service's answer has any of these texts. `object_store` does not hand out status and body otherwise.
    fn answer_has(&self, texts: &[&str]) -> bool {
        let StoreError::Blob(error) = self else {
            return false;
        };
        let text = error.to_string();
        texts.iter().any(|part| text.contains(part))
    }

    /// True if the same call may succeed a moment later: the database was busy, or did not answer.
    pub fn is_busy(&self) -> bool {
        match self {
            StoreError::Database(error) | StoreError::Migration(MigrateError::Execute(error)) => {
                is_passing(error)
            }
            StoreError::Arriving | StoreError::TakenAway => true,
            _ => false,
        }
    }
}

impl From<MigrateError> for StoreError {
    fn from(error: MigrateError) -> Self {
        match error {
            MigrateError::VersionMismatch(_) | MigrateError::VersionMissing(_) => {
                StoreError::OtherSchema(error)
            }
            error => StoreError::Migration(error),
        }
    }
}

impl From<object_store::Error> for StoreError {
    fn from(error: object_store::Error) -> Self {
        match untrusted_certificate(&error) {
            Some(refused) => StoreError::UntrustedObjects(refused.clone()),
            None => StoreError::Blob(error),
        }
    }
}

/// Here and not with the type, since errors name blobs.
impl FromStr for BlobId {
    type Err = StoreError;

    fn from_str(text: &str) -> Result<Self> {
        blake3::Hash::from_hex(text)
            .map(BlobId::from)
            .map_err(|_| StoreError::Corrupt(format!("blob id {text:?}")))
    }
}

/// Reason for which a server's certificate was not accepted, if that caused an error.
pub(crate) fn untrusted_certificate<'e>(
    error: &'e (dyn std::error::Error + 'static),
) -> Option<&'e rustls::Error> {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if let Some(refused @ rustls::Error::InvalidCertificate(_)) = error.downcast_ref() {
            return Some(refused);
        }
        // An error of input and output names the source of what it wraps, and not what it wraps.
        cause = match error.downcast_ref::<io::Error>().and_then(io::Error::get_ref) {
            Some(wrapped) => Some(wrapped),
            None => error.source(),
        };
    }
    None
}

/// True if a database may succeed a moment later.
fn is_passing(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Database(error) => match engine_code(error.as_ref()) {
            // SQLITE_BUSY and SQLITE_LOCKED with their extended codes.
            EngineCode::Sqlite(code) => matches!(code & 0xff, 5 | 6),
            // Conflicts of transactions, waits for locks that took too long, and a server that starts, stops or has no
            // connection left.
            EngineCode::Postgres(code) => {
                matches!(code.as_str(), "40001" | "40P01" | "55P03" | "53300" | "57P01" | "57P02" | "57P03")
            }
            EngineCode::None => false,
        },
        // A connection that could not be made, or broke off, and not one that was refused.
        sqlx::Error::Io(error) => refused_certificate(error).is_none(),
        sqlx::Error::PoolTimedOut => true,
        // A PostgreSQL server that can make no process for a connection says so before any request, while the client
        // looks for one letter about encryption.
        sqlx::Error::Protocol(told) => told.contains("SSLRequest"),
        _ => false,
    }
}

/// Reason for which the certificate of a database's server was refused, if that caused an error.
fn refused_certificate(error: &io::Error) -> Option<&rustls::Error> {
    error.get_ref()?.downcast_ref()
}

/// Error of a failed attempt to connect.
pub(crate) fn not_connected(error: sqlx::Error) -> StoreError {
    if let sqlx::Error::Io(cause) = &error
        && let Some(reason) = refused_certificate(cause)
    {
        return StoreError::Untrusted(reason.clone());
    }
    error.into()
}

/// An engine's own word for what went wrong.
enum EngineCode {
    /// SQLite's extended result code.
    Sqlite(i64),
    /// PostgreSQL's five characters of SQLSTATE.
    Postgres(String),
    /// None of these.
    None,
}

fn engine_code(error: &dyn sqlx::error::DatabaseError) -> EngineCode {
    let Some(code) = error.code() else { return EngineCode::None };
    if error.try_downcast_ref::<sqlx::sqlite::SqliteError>().is_some() {
        return code.parse().map_or(EngineCode::None, EngineCode::Sqlite);
    }
    EngineCode::Postgres(code.into_owned())
}
