//! Backends of the blob store.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, UNIX_EPOCH};

use object_store::aws::{AmazonS3, AmazonS3Builder, AmazonS3ConfigKey, S3ConditionalPut};
use object_store::client::ClientConfigKey;
use object_store::local::LocalFileSystem;
use object_store::path::Path as ObjectPath;
use object_store::prefix::PrefixStore;
use object_store::{BackoffConfig, ObjectStore, RetryConfig};

use crate::blob::certificate::Connector;
use crate::blob::counted::Counted;
use crate::blob::location::ObjectsLocation;
use crate::blob::metrics::ObjectMetrics;
use crate::blob::object::StoredObject;
use crate::error::{Result, StoreError};

/// Bytes that are read at once of an object in a directory if it is read from its beginning to its end. The object store's own
/// stream hands out 8 KiB at a time, each from another thread, which takes longer than hashing them.
const DIRECTORY_STRETCH: u64 = 1 << 20;

/// The same in a bucket, with a request for each.
const S3_STRETCH: u64 = 8 << 20;

/// A request that is never done: what bounds it is how long nothing comes.
const NO_TIMEOUT: &str = "365days";

/// Timeouts and retries of requests to a service.
struct RetryLimits {
    /// Time for which a failed request is retried.
    retry: Duration,
    /// Longest wait between two tries.
    pause: Duration,
    /// Longest silence within an answer, counted from the beginning of the request.
    silence: &'static str,
}

/// Limits of reads, for which a client waits.
const SHORT: RetryLimits =
    RetryLimits { retry: Duration::from_secs(10), pause: Duration::from_secs(1), silence: "10s" };

/// Limits of writes of results that took minutes to compute: they outlast a restart of the service.
const LONG: RetryLimits =
    RetryLimits { retry: Duration::from_secs(60), pause: Duration::from_secs(3), silence: "30s" };

/// Limits of probes that only identify the service.
const ONCE: RetryLimits = RetryLimits { retry: Duration::ZERO, pause: Duration::ZERO, silence: "5s" };

/// Directory or bucket of the objects, with all that differs between them. The stores are the same one but for the limits of their retries.
#[derive(Debug, Clone)]
pub(super) struct Backend {
    /// Client for requests for which a client waits.
    pub(super) objects: Arc<dyn ObjectStore>,
    /// Client for writing results.
    pub(super) uploads: Arc<dyn ObjectStore>,
    /// Client for a single try; `None` for a directory.
    pub(super) once: Option<Arc<dyn ObjectStore>>,
    /// Bytes that are read at once if an object is read from its beginning to its end.
    pub(super) stretch: u64,
    /// None of a bucket.
    directory: Option<PathBuf>,
}

impl Backend {
    /// # Errors
    /// A directory cannot be made, or the settings of a service are wrong. No request is sent to it.
    pub(super) fn open(location: &ObjectsLocation, metrics: &ObjectMetrics) -> Result<Self> {
        match location {
            ObjectsLocation::Directory(path) => Self::in_directory(path, metrics),
            ObjectsLocation::S3 { bucket, prefix, settings } => {
                Self::in_bucket(bucket, prefix, settings, metrics)
            }
        }
    }

    fn in_directory(directory: &Path, metrics: &ObjectMetrics) -> Result<Self> {
        std::fs::create_dir_all(directory)
            .map_err(|source| StoreError::Directory { path: directory.display().to_string(), source })?;
        let files = LocalFileSystem::new_with_prefix(directory)?.with_fsync(true);
        let objects: Arc<dyn ObjectStore> = Arc::new(Counted::new(files, metrics.clone()));
        Ok(Self {
            uploads: objects.clone(),
            objects,
            once: None,
            stretch: DIRECTORY_STRETCH,
            directory: Some(directory.to_owned()),
        })
    }

    fn in_bucket(
        bucket: &str,
        prefix: &str,
        settings: &BTreeMap<String, String>,
        metrics: &ObjectMetrics,
    ) -> Result<Self> {
        // An error says that there is one already, which will do.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let open = |limits: &RetryLimits| -> Result<Arc<dyn ObjectStore>> {
            let bucket = PrefixStore::new(s3(bucket, settings, limits)?, prefix);
            Ok(Arc::new(Counted::new(bucket, metrics.clone())))
        };
        Ok(Self {
            objects: open(&SHORT)?,
            uploads: open(&LONG)?,
            once: Some(open(&ONCE)?),
            stretch: S3_STRETCH,
            directory: None,
        })
    }

    /// Parts of uploads that were begun before a time \[ms since the epoch\] and not finished, as a killed worker leaves them in a
    /// directory. The object store does not list them. Those in a bucket are for the bucket's rule about incomplete uploads to delete
    /// (`AbortIncompleteMultipartUpload`).
    pub(super) async fn unfinished_uploads(&self, cutoff: i64) -> Result<Vec<StoredObject>> {
        let Some(directory) = self.directory.clone() else {
            return Ok(Vec::new());
        };
        let path = directory.display().to_string();
        let walking = tokio::task::spawn_blocking(move || {
            let mut found = Vec::new();
            visit_unfinished(&directory, &ObjectPath::default(), cutoff, &mut found).map(|()| found)
        });
        let walked = walking.await.map_err(std::io::Error::other).flatten();
        walked.map_err(|source| StoreError::Directory { path, source })
    }
}

/// Deletes a file; one that is gone already is no matter.
pub(super) fn delete_file(file: &Path) -> Result<()> {
    match std::fs::remove_file(file) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(StoreError::Directory { path: file.display().to_string(), source })
        }
        _ => Ok(()),
    }
}

/// A bucket, with its settings from the environment.
fn s3(bucket: &str, settings: &BTreeMap<String, String>, limits: &RetryLimits) -> Result<AmazonS3> {
    let retry = RetryConfig {
        backoff: BackoffConfig {
            init_backoff: Duration::from_millis(100),
            max_backoff: limits.pause,
            base: 2.0,
        },
        // The time decides.
        max_retries: usize::MAX,
        retry_timeout: limits.retry,
    };
    let mut builder = AmazonS3Builder::from_env()
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::Timeout), NO_TIMEOUT)
        .with_config(AmazonS3ConfigKey::Client(ClientConfigKey::ReadTimeout), limits.silence)
        .with_retry(retry)
        .with_http_connector(Connector)
        .with_conditional_put(S3ConditionalPut::ETagMatch)
        // Objects are deleted one at a time, which every service knows how to do.
        .with_disable_bulk_delete(true)
        .with_bucket_name(bucket);
    for (name, value) in settings {
        builder = builder.with_config(name.parse()?, value);
    }
    Ok(builder.build()?)
}

/// Finds the unfinished uploads in a folder and below. Files may go while it looks.
fn visit_unfinished(
    directory: &Path,
    folder: &ObjectPath,
    cutoff: i64,
    found: &mut Vec<StoredObject>,
) -> std::io::Result<()> {
    for entry in std::fs::read_dir(directory)? {
        let entry = entry?;
        let name = entry.file_name();
        let (Some(name), Some(metadata)) = (name.to_str(), still_there(entry.metadata())?) else { continue };
        if metadata.is_dir() {
            visit_unfinished(&entry.path(), &folder.clone().join(name), cutoff, found)?;
            continue;
        }
        let modified = metadata.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
        let is_old = i64::try_from(modified.as_millis()).is_ok_and(|modified| modified < cutoff);
        // `object_store` uploads to the object's path with `#` and a number after it.
        let Some((object, number)) = name.rsplit_once('#') else { continue };
        let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
        if is_old && is_number {
            found.push(StoredObject {
                path: folder.clone().join(object),
                bytes: metadata.len(),
                unfinished: Some(entry.path()),
            });
        }
    }
    Ok(())
}

/// `None` if the file does not exist any more.
fn still_there<T>(found: std::io::Result<T>) -> std::io::Result<Option<T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}
