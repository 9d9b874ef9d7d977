//! The vocabulary: what the names of columns and of a scenario's fields stand for.

use std::sync::LazyLock;

use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use drillsweep_table::quantity;
use drillsweep_table::quantity::QuantityEntry;

use crate::answer::error::{Error, Result};
use crate::openapi::answers::{Conditional, Problems};

/// Meaning of columns and fields, with their units
///
/// By name: of columns without the number of a node (`u_49` is `u`) and of a spectrum window (`line_amplitude_49_w1`), and without what an
/// ensemble or a reference makes of them (`ensemble_mean_`, `spread_`, `reference_`, `bias_`; biases are relative, but for frequencies); of a
/// scenario's fields by their path without indices. Needs no token, like this document.
#[utoipa::path(
    get,
    path = "/v1/quantities",
    tag = "service",
    operation_id = "list_quantities",
    params(Conditional),
    security(()),
    responses(
        (status = 200, description = "The vocabulary", body = std::collections::BTreeMap<String, QuantityEntry>),
        (status = 304, description = "The copy is right"),
        Problems
    )
)]
pub(crate) async fn list() -> Result<Response> {
    static TEXT: LazyLock<String> = LazyLock::new(|| quantity::json().to_string());
    static TAG: LazyLock<String> =
        LazyLock::new(|| format!("W/\"{}\"", blake3::hash(TEXT.as_bytes()).to_hex()));
    let tag = HeaderValue::from_str(&TAG).map_err(|error| Error::internal(&error))?;
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("application/json")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
        (header::ETAG, tag),
    ];
    Ok((headers, TEXT.as_str()).into_response())
}
