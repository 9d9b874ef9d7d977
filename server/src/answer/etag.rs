//! ETags: of bodies that clients keep a copy of, and of sweeps, on which conditional changes depend.

use std::fmt::Debug;
use std::fs::File;
use std::io;
use std::sync::LazyLock;

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{ProblemKind, Sweep};
use headers::{ETag, HeaderMapExt as _, IfNoneMatch};
use serde::Serialize;

use crate::answer::error::{Error, Result};
use crate::answer::json::Json;

/// Hash of the program's file, since another build of the same version may write other bodies. If the file cannot be read, each start counts
/// as another program.
static PROGRAM: LazyLock<String> = LazyLock::new(|| match hash_of_program() {
    Ok(hash) => hash.to_hex().to_string(),
    Err(error) => {
        tracing::warn!(%error, "the executable cannot be read: ETags change at the next start");
        uuid::Uuid::now_v7().to_string()
    }
});

fn hash_of_program() -> io::Result<blake3::Hash> {
    let mut hasher = blake3::Hasher::new();
    // On Linux the running file: another one may have taken its path since the start.
    let file = File::open("/proc/self/exe").or_else(|_| File::open(std::env::current_exe()?))?;
    hasher.update_reader(file)?;
    Ok(hasher.finalize())
}

/// `ETag` of a body, a weak one, since it may be compressed on its way.
#[derive(Debug, Clone)]
pub(crate) struct Tag(String);

impl Tag {
    /// Tag of a body that depends on nothing but these values (hashes of stored contents, parameters of the request), its format and the
    /// program. It is known before the body, which need not be made for a client that has a copy.
    pub(crate) fn of(format: impl Debug, depends_on: &impl Debug) -> Self {
        let depends_on = (&*PROGRAM, format, depends_on);
        Self::of_hash(&blake3::hash(format!("{depends_on:?}").as_bytes()))
    }

    pub(crate) fn of_hash(hash: &blake3::Hash) -> Self {
        Self(format!("W/\"{}\"", hash.to_hex()))
    }

    /// Text of the header.
    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }

    /// The answer 304 if the request names a copy with this tag; `None` otherwise. `If-None-Match: *` does not show that an answer exists,
    /// so that the body has to be made.
    pub(crate) fn unchanged(&self, headers: &HeaderMap) -> Option<Response> {
        let known = headers.typed_get::<IfNoneMatch>().filter(|known| *known != IfNoneMatch::any())?;
        let tag: ETag = self.0.parse().ok()?;
        if known.precondition_passes(&tag) {
            return None;
        }
        Some(self.on(StatusCode::NOT_MODIFIED.into_response()))
    }

    /// Adds the tag to a response, with headers that let clients keep the body and have them revalidate it: points may be recomputed, and
    /// sweeps progress.
    pub(crate) fn on(&self, mut response: Response) -> Response {
        let headers = response.headers_mut();
        if let Ok(tag) = self.0.parse() {
            headers.insert(header::ETAG, tag);
        }
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
        headers.insert(header::VARY, HeaderValue::from_static("accept"));
        response
    }
}

/// JSON with a hash of it as `ETag`: a client that polls is answered 304 while nothing has changed.
pub(crate) struct Hashed<T>(pub(crate) T);

impl<T: Serialize> IntoResponse for Hashed<T> {
    fn into_response(self) -> Response {
        match serde_json::to_vec(&self.0) {
            Ok(body) => {
                let tag = Tag::of_hash(&blake3::hash(&body));
                let media_type = HeaderValue::from_static("application/json");
                tag.on(([(header::CONTENT_TYPE, media_type)], body).into_response())
            }
            Err(error) => Error::internal(&error).into_response(),
        }
    }
}

/// A sweep with its revision and a hash of the answer as `ETag`: the revision changes with its owner's changes, the hash with every point.
pub(crate) struct Tagged(pub(crate) Sweep);

impl IntoResponse for Tagged {
    fn into_response(self) -> Response {
        let body = match serde_json::to_vec(&self.0) {
            Ok(body) => body,
            Err(error) => return Error::internal(&error).into_response(),
        };
        let hash = blake3::hash(&body).to_hex();
        match HeaderValue::try_from(format!("\"{}-{}\"", self.0.revision, &hash[..16])) {
            Ok(tag) => {
                let media_type = HeaderValue::from_static("application/json");
                ([(header::CONTENT_TYPE, media_type), (header::ETAG, tag)], body).into_response()
            }
            Err(_) => Json(self.0).into_response(),
        }
    }
}

/// Revision that `If-Match` requires; `None` if it requires none. Only the revision counts: progress of the points since the tag was read is
/// no reason to refuse a change.
///
/// # Errors
/// No tag of the header has the current revision (412).
pub(crate) fn expected_revision(headers: &HeaderMap, current: u64) -> Result<Option<i64>> {
    let mut tags = headers.get_all(header::IF_MATCH).iter().peekable();
    if tags.peek().is_none() {
        return Ok(None);
    }
    let tags = tags.map(|value| value.to_str().unwrap_or_default()).flat_map(|list| list.split(','));
    // A weak tag never matches (RFC 9110 section 13.1.1).
    let revision =
        |tag: &str| tag.strip_prefix('"')?.strip_suffix('"')?.split('-').next()?.parse::<u64>().ok();
    for tag in tags.map(str::trim) {
        if tag == "*" {
            return Ok(None);
        }
        if revision(tag) == Some(current) {
            return Ok(i64::try_from(current).ok());
        }
    }
    Err(changed_meanwhile(current))
}

/// Problem of a change that expects another revision.
pub(crate) fn changed_meanwhile(current: u64) -> Error {
    let detail = format!("the sweep now has revision {current}; read it again and repeat the change");
    Error::new(ProblemKind::PreconditionFailed, detail)
}
