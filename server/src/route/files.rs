//! Stored files of a point's result: whole, in ranges, or 304 for current copies.

use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{ArtifactEntry, ArtifactList, ProblemKind};
use headers::{ETag, HeaderMapExt, IfNoneMatch, IfRange};
use serde::Deserialize;

use crate::answer::error::{Error, Result};
use crate::answer::extract::Path;
use crate::answer::json::Json;
use crate::answer::recordings;
use crate::answer::records;
use crate::answer::stored::Stored;
use crate::app::App;
use crate::openapi::answers::Problems;
use crate::route::results::PointPath;

/// Path of a file.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Path)]
pub(crate) struct ArtifactPath {
    /// Identifier of the sweep.
    id: String,
    /// Number of the point in the sweep, from 1.
    #[param(minimum = 1)]
    n: u32,
    /// Name of the file in the list of files, optionally with the extension of its link (`.parquet`, `.json`).
    #[param(example = "history.parquet")]
    name: String,
}

/// Files of a point's result
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/artifacts",
    tag = "points",
    operation_id = "list_artifacts",
    params(PointPath),
    responses((status = 200, description = "Every file, by name", body = ArtifactList), Problems)
)]
pub(crate) async fn list(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
) -> Result<Json<ArtifactList>> {
    let key = recordings::result_key(&app.store, &id, n).await?;
    let entry = |artifact: drillsweep_store::Artifact| {
        Ok(ArtifactEntry {
            link: format!(
                "/v1/sweeps/{id}/points/{n}/artifacts/{}{}",
                artifact.name,
                extension(&artifact.media_type)
            ),
            name: artifact.name,
            media_type: artifact.media_type,
            bytes: artifact.bytes.unsigned_abs(),
            rows: artifact.row_count.unsigned_abs(),
            hash: artifact.blob,
            expired: artifact.expired.map(records::timestamp).transpose()?,
        })
    };
    let artifacts = app.store.artifacts(&key).await?.into_iter().map(entry).collect::<Result<_>>()?;
    Ok(Json(ArtifactList { artifacts }))
}

/// One file of a point's result, byte for byte
///
/// Its `ETag` is the BLAKE3 hash of its contents. `Range` returns one range of bytes; several ranges return the whole file, as RFC 9110
/// allows.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/artifacts/{name}",
    tag = "points",
    operation_id = "get_artifact",
    params(
        ArtifactPath,
        ("Range" = Option<String>, Header, description = "Range of bytes, such as `bytes=0-1023`."),
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of a copy; 304 if it is still current."),
        ("If-Range" = Option<String>, Header, description = "The `ETag` under which `Range` holds."),
    ),
    responses(
        (status = 200, description = "The file", content(
            (Vec<u8> = "application/vnd.apache.parquet"),
            (serde_json::Value = "application/json")
        )),
        (status = 206, description = "The range of it", content(
            (Vec<u8> = "application/vnd.apache.parquet"),
            (Vec<u8> = "application/json")
        )),
        (status = 304, description = "The copy is current"),
        Problems
    )
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(ArtifactPath { id, n, name }): Path<ArtifactPath>,
    headers: HeaderMap,
) -> Result<Response> {
    let key = recordings::result_key(&app.store, &id, n).await?;
    let ending = [PARQUET, JSON].into_iter().find_map(|ending| Some((name.strip_suffix(ending)?, ending)));
    let stored = recordings::find(&app.store, &key, ending.map_or(&name, |(stem, _)| stem)).await?;
    if let Some((stem, ending)) = ending.filter(|(_, ending)| *ending != extension(&stored.media_type)) {
        let detail =
            format!("{stem} is kept as {stem}{}, not as {stem}{ending}", extension(&stored.media_type));
        return Err(Error::new(ProblemKind::NoSuchTable, detail));
    }
    let media_type = HeaderValue::try_from(&stored.media_type).map_err(|error| Error::internal(&error))?;
    let stored = Stored::new(&app.store, &key, stored)?;
    let length = stored.length();
    let tag = format!("\"{}\"", stored.blob());
    let etag: ETag = tag.parse().map_err(|_| Error::internal("a blob's name is no ETag"))?;
    let tag = HeaderValue::try_from(tag).map_err(|error| Error::internal(&error))?;
    if headers.typed_get::<IfNoneMatch>().is_some_and(|known| !known.precondition_passes(&etag)) {
        return Ok((StatusCode::NOT_MODIFIED, [(header::ETAG, tag)]).into_response());
    }
    let is_current = headers.typed_get::<IfRange>().is_none_or(|known| !known.is_modified(Some(&etag), None));
    let range = headers.get(header::RANGE).filter(|_| is_current).and_then(|value| value.to_str().ok());
    let usual: [(HeaderName, HeaderValue); 4] = [
        (header::CONTENT_TYPE, media_type),
        (header::ETAG, tag),
        (header::ACCEPT_RANGES, HeaderValue::from_static("bytes")),
        // The point may be recomputed; revalidation is cheap.
        (header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache")),
    ];
    // Other units are ignored (RFC 9110 section 14.2), and several ranges return the whole file.
    let ranges = range.and_then(|range| http_range_header::parse_range_header(range).ok());
    let Ok(ranges) = ranges.map(|ranges| ranges.validate(length)).transpose() else {
        return Ok(not_satisfiable(length));
    };
    match ranges.as_deref() {
        Some([range]) => {
            let wanted = *range.start()..range.end() + 1;
            let bytes = [(header::CONTENT_LENGTH, HeaderValue::from(wanted.end - wanted.start))];
            let part = format!("bytes {}-{}/{length}", range.start(), range.end());
            let body = stored.body(wanted, app.file()).await?;
            Ok((StatusCode::PARTIAL_CONTENT, usual, bytes, [(header::CONTENT_RANGE, part)], body)
                .into_response())
        }
        _ => {
            let bytes = [(header::CONTENT_LENGTH, HeaderValue::from(length))];
            Ok((usual, bytes, stored.body(0..length, app.file()).await?).into_response())
        }
    }
}

const PARQUET: &str = ".parquet";
const JSON: &str = ".json";

/// Extension of files of a media type.
fn extension(media_type: &str) -> &'static str {
    match media_type {
        "application/json" => JSON,
        _ => PARQUET,
    }
}

fn not_satisfiable(length: u64) -> Response {
    let detail = format!("the file has {length} bytes, none of them in the range");
    let mut response = Error::new(ProblemKind::RangeNotSatisfiable, detail).into_response();
    if let Ok(place) = HeaderValue::try_from(format!("bytes */{length}")) {
        response.headers_mut().insert(header::CONTENT_RANGE, place);
    }
    response
}
