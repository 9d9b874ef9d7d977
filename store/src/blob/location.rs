//! Location of the object store.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use object_store::path::Path as ObjectPath;

/// Scheme of a location in S3.
const S3: &str = "s3://";

/// Location of the object store: `DIRECTORY` or `s3://BUCKET[/PREFIX]`. It is shown as it is written, and never with a secret.
#[derive(Clone, PartialEq, Eq)]
pub enum ObjectsLocation {
    /// A directory, which is made if there is none.
    Directory(PathBuf),
    /// A bucket of a service that speaks the S3 protocol. Credentials, region and endpoint are taken from the environment
    /// (`AWS_ACCESS_KEY_ID`, `AWS_SECRET_ACCESS_KEY`, `AWS_REGION`, `AWS_ENDPOINT_URL`, `AWS_ALLOW_HTTP`).
    S3 {
        /// The bucket, which must exist.
        bucket: String,
        /// Prefix of the names of all objects, without slashes at its ends; empty for the whole bucket.
        prefix: String,
        /// Settings in the place of the environment's, by the names of `object_store` (`endpoint`, `access_key_id`). No text of a
        /// location has any: they are for programs that cannot change their environment.
        settings: BTreeMap<String, String>,
    },
}

/// Errors of reading the location of an object store.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LocationError {
    /// There is nothing.
    #[error("the location of the objects is empty: give a directory or s3://BUCKET/PREFIX")]
    Empty,
    /// A URL of something else.
    #[error("objects cannot be stored at {0}: give a directory or s3://BUCKET/PREFIX")]
    Scheme(String),
    /// No bucket can have such a name. It is not repeated, for it may be a secret that was written before it.
    #[error(
        "the name of a bucket has 3 to 63 lower-case letters, digits, dots and hyphens; credentials and the endpoint are given \
         in the environment (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_ENDPOINT_URL)"
    )]
    Bucket,
    /// The prefix has characters or segments that a name cannot have.
    #[error("objects cannot have names that begin with {prefix:?}: {reason}")]
    Prefix {
        /// The prefix.
        prefix: String,
        /// Reason why it is invalid.
        reason: String,
    },
}

impl FromStr for ObjectsLocation {
    type Err = LocationError;

    fn from_str(text: &str) -> Result<Self, LocationError> {
        if let Some(rest) = text.strip_prefix(S3) {
            return s3(rest);
        }
        if text.is_empty() {
            return Err(LocationError::Empty);
        }
        match text.split_once(':') {
            Some((scheme, rest)) if rest.starts_with("//") || scheme.eq_ignore_ascii_case("s3") => {
                Err(LocationError::Scheme(format!("{scheme}:")))
            }
            _ => Ok(ObjectsLocation::Directory(PathBuf::from(text))),
        }
    }
}

/// A bucket and a prefix.
fn s3(text: &str) -> Result<ObjectsLocation, LocationError> {
    let (bucket, prefix) = text.split_once('/').unwrap_or((text, ""));
    let is_end =
        |byte: Option<&u8>| byte.is_some_and(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit());
    let bytes = bucket.as_bytes();
    let is_bucket = (3..=63).contains(&bytes.len())
        && is_end(bytes.first())
        && is_end(bytes.last())
        && bytes.iter().all(|byte| is_end(Some(byte)) || matches!(byte, b'.' | b'-'));
    if !is_bucket {
        return Err(LocationError::Bucket);
    }
    let prefix = prefix.trim_end_matches('/');
    let refused = |reason: String| LocationError::Prefix { prefix: prefix.to_owned(), reason };
    if prefix.starts_with('/') {
        return Err(refused("it begins with a slash".to_owned()));
    }
    if prefix.contains(['?', '#']) {
        return Err(refused("it has a query".to_owned()));
    }
    ObjectPath::parse(prefix).map_err(|error| refused(error.to_string()))?;
    Ok(ObjectsLocation::S3 {
        bucket: bucket.to_owned(),
        prefix: prefix.to_owned(),
        settings: BTreeMap::new(),
    })
}

impl fmt::Display for ObjectsLocation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ObjectsLocation::Directory(path) => write!(formatter, "{}", path.display()),
            ObjectsLocation::S3 { bucket, prefix, .. } if prefix.is_empty() => {
                write!(formatter, "{S3}{bucket}")
            }
            ObjectsLocation::S3 { bucket, prefix, .. } => write!(formatter, "{S3}{bucket}/{prefix}"),
        }
    }
}

/// As it is displayed: settings may hold secrets.
impl fmt::Debug for ObjectsLocation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<ObjectsLocation, LocationError> {
        text.parse()
    }

    fn bucket(bucket: &str, prefix: &str) -> ObjectsLocation {
        ObjectsLocation::S3 {
            bucket: bucket.to_owned(),
            prefix: prefix.to_owned(),
            settings: BTreeMap::new(),
        }
    }

    #[test]
    fn directories_and_buckets_are_read_and_shown_as_they_are_written() {
        for path in ["/var/lib/drillsweep/blobs", "data/blobs", ".", "a:b", "C:blobs"] {
            assert_eq!(parsed(path), Ok(ObjectsLocation::Directory(PathBuf::from(path))));
            assert_eq!(parsed(path).map(|location| location.to_string()).as_deref(), Ok(path));
        }
        for (text, location, shown) in [
            ("s3://results", bucket("results", ""), "s3://results"),
            ("s3://results/", bucket("results", ""), "s3://results"),
            ("s3://results/team/a", bucket("results", "team/a"), "s3://results/team/a"),
            ("s3://my.results-2/team/", bucket("my.results-2", "team"), "s3://my.results-2/team"),
        ] {
            assert_eq!(parsed(text), Ok(location.clone()), "{text}");
            assert_eq!(location.to_string(), shown);
            assert_eq!(parsed(shown), Ok(location));
        }
    }

    #[test]
    fn anything_else_is_refused_for_its_reason() {
        assert_eq!(parsed(""), Err(LocationError::Empty));
        for text in [
            "gs://results/team",
            "file:///var/lib",
            "https://s3.example.com/results",
            "s3:results",
            "S3://results",
        ] {
            assert!(matches!(parsed(text), Err(LocationError::Scheme(_))), "{text}");
        }
        for text in [
            "s3://",
            "s3:///team",
            "s3://ab",
            "s3://Results",
            "s3://-results",
            "s3://results-",
            "s3://re_sults",
        ] {
            assert_eq!(parsed(text), Err(LocationError::Bucket), "{text}");
        }
        for text in ["s3://results//team", "s3://results/a//b", "s3://results/../a", "s3://results/a?b=c"] {
            assert!(matches!(parsed(text), Err(LocationError::Prefix { .. })), "{text}");
        }
    }

    #[test]
    fn no_secret_is_shown() {
        let error =
            parsed("s3://AKIDEXAMPLE:verysecret@results/team").expect_err("there are credentials in it");
        assert!(!error.to_string().contains("secret"), "{error}");
        let mut location = bucket("results", "");
        if let ObjectsLocation::S3 { settings, .. } = &mut location {
            settings.insert("secret_access_key".to_owned(), "verysecret".to_owned());
        }
        assert_eq!(format!("{location} {location:?}"), "s3://results s3://results");
    }
}
