//! ETags of sweeps, on which conditional changes depend, and of lists.

use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{ProblemKind, Sweep};
use serde::Serialize;

use crate::answer::error::{Error, Result};
use crate::answer::json::Json;

/// A sweep with its tag: its revision, and a hash of all that is told, which changes with every point.
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

/// JSON with a hash of it as `ETag`: a client that polls is answered 304 while nothing has changed.
pub(crate) struct Hashed<T>(pub(crate) T);

impl<T: Serialize> IntoResponse for Hashed<T> {
    fn into_response(self) -> Response {
        let body = match serde_json::to_vec(&self.0) {
            Ok(body) => body,
            Err(error) => return Error::internal(&error).into_response(),
        };
        // Weak, since the body may be compressed on its way.
        let tag = match HeaderValue::try_from(format!("W/\"{}\"", blake3::hash(&body).to_hex())) {
            Ok(tag) => tag,
            Err(error) => return Error::internal(&error).into_response(),
        };
        let headers = [
            (header::CONTENT_TYPE, HeaderValue::from_static("application/json")),
            (header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache")),
            (header::ETAG, tag),
        ];
        (headers, body).into_response()
    }
}

/// The revision that `If-Match` asks for; none where it asks for no particular one. Points that went on since the tag was read are no
/// reason to refuse a change, so that only the revision counts.
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

/// The problem that a sweep is not what the client knows.
pub(crate) fn changed_meanwhile(current: u64) -> Error {
    let detail = format!("the sweep is at revision {current} by now; read it again and decide on what it is");
    Error::new(ProblemKind::PreconditionFailed, detail)
}
