//! Changes of a sweep: cancelling, retrying, pausing, changing and deleting it.

use axum::extract::State;
use axum::http::HeaderMap;
use drillsweep_api::{
    FieldProblem, ProblemDetails, ProblemKind, Sweep, SweepDeletion, SweepPatch, check_patch,
};
use drillsweep_store::{ChangeOutcome, DeleteOutcome, SweepChanges};
use jiff::Timestamp;
use serde::Deserialize;

use crate::answer::blocking::to_the_end;
use crate::answer::error::{Error, Result};
use crate::answer::etag::{Tagged, changed_meanwhile, expected_revision};
use crate::answer::extract::{self, Path, Query, value};
use crate::answer::json::Json;
use crate::answer::records;
use crate::app::App;
use crate::openapi::answers::Problems;
use crate::route::sweeps::{load, state};

/// Cancel a sweep
///
/// Queued points and reference runs are cancelled at once, running ones within a heartbeat of their worker. Points that another sweep
/// shares continue for that sweep. Cancelling again changes nothing.
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/cancel",
    tag = "sweeps",
    operation_id = "cancel_sweep",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    responses((status = 200, description = "The sweep in its present state", body = Sweep), Problems)
)]
pub(crate) async fn cancel(State(app): State<App>, Path(id): Path<String>) -> Result<Json<Sweep>> {
    let (store, cancelled) = (app.store.clone(), id.clone());
    to_the_end(async move { store.cancel_sweep(&cancelled).await }).await?;
    Ok(Json(load(&app, &id).await?))
}

/// Retry the failed and cancelled points and reference runs of a sweep
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/retry",
    tag = "sweeps",
    operation_id = "retry_sweep",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    responses((status = 200, description = "The sweep in its present state", body = Sweep), Problems)
)]
pub(crate) async fn retry(State(app): State<App>, Path(id): Path<String>) -> Result<Json<Sweep>> {
    app.store.retry_sweep(&id).await?;
    Ok(Json(load(&app, &id).await?))
}

/// Pause a sweep
///
/// Its queued points are not started any more, except for those that another sweep shares; running ones continue to their end. Pausing
/// again changes nothing.
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/pause",
    tag = "sweeps",
    operation_id = "pause_sweep",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    responses((status = 200, description = "The sweep in its present state", body = Sweep), Problems)
)]
pub(crate) async fn pause(State(app): State<App>, Path(id): Path<String>) -> Result<Json<Sweep>> {
    app.store.pause_sweep(&id, true).await?;
    Ok(Json(load(&app, &id).await?))
}

/// Resume a paused sweep
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/resume",
    tag = "sweeps",
    operation_id = "resume_sweep",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    responses((status = 200, description = "The sweep in its present state", body = Sweep), Problems)
)]
pub(crate) async fn resume(State(app): State<App>, Path(id): Path<String>) -> Result<Json<Sweep>> {
    app.store.pause_sweep(&id, false).await?;
    Ok(Json(load(&app, &id).await?))
}

/// Change name, tags, priority, pin or expiry of a sweep
///
/// Absent fields remain. A new priority also applies to queued points. With `If-Match` a sweep that was changed meanwhile is not changed
/// (412); progress of its points does not count.
#[utoipa::path(
    patch,
    path = "/v1/sweeps/{id}",
    tag = "sweeps",
    operation_id = "change_sweep",
    params(
        ("id" = String, Path, description = "Identifier of the sweep"),
        ("If-Match" = Option<String>, Header, description = "The `ETag` of the sweep as it was read."),
    ),
    request_body = SweepPatch,
    responses(
        (status = 200, description = "The sweep in its present state", body = Sweep,
            headers(("ETag" = String, description = "As of a sweep that is read"))),
        Problems
    )
)]
pub(crate) async fn change(
    State(app): State<App>,
    Path(id): Path<String>,
    headers: HeaderMap,
    extract::Json(patch): extract::Json<SweepPatch>,
) -> Result<Tagged> {
    check_patch(&patch)?;
    let current = state(&app, &id).await?.revision;
    let expected = expected_revision(&headers, current)?;
    if let Some(Some(expires)) = patch.expires {
        let now = records::timestamp(app.store.now_ms().await?)?;
        if expires <= now {
            return Err(already_past(expires, now));
        }
    }
    let changes = SweepChanges {
        name: patch.name,
        priority: patch.priority.map(i64::from),
        tags_json: patch.tags.as_ref().map(records::write).transpose()?,
        is_pinned: patch.pinned,
        expires: patch.expires.map(|expires| expires.map(Timestamp::as_millisecond)),
    };
    match app.store.change_sweep(&id, &changes, expected).await? {
        ChangeOutcome::Changed => Ok(Tagged(load(&app, &id).await?)),
        ChangeOutcome::OtherRevision => Err(changed_meanwhile(state(&app, &id).await?.revision)),
        ChangeOutcome::NoSuchSweep => Err(records::no_such_sweep(&id)),
    }
}

/// Problem of an expiry in the past.
fn already_past(expires: Timestamp, now: Timestamp) -> Error {
    let problem = FieldProblem {
        pointer: Some("/expires".to_owned()),
        parameter: None,
        got: Some(expires.to_string().into()),
        detail: format!("must be in the future, after {now}; to delete the sweep now, use DELETE"),
    };
    ProblemDetails::invalid_request(vec![problem]).into()
}

/// Query of a deletion.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeleteQuery {
    /// True returns the extent of the deletion, and deletes nothing.
    #[serde(default, deserialize_with = "value::truth")]
    dry_run: bool,
}

/// Delete a sweep
///
/// Its points, events and requests are deleted at once, results that no other sweep has, and their tables, with the next garbage
/// collection. A sweep that is pinned, or has points that are not final, is not deleted (409).
#[utoipa::path(
    delete,
    path = "/v1/sweeps/{id}",
    tag = "sweeps",
    operation_id = "delete_sweep",
    params(
        ("id" = String, Path, description = "Identifier of the sweep"),
        DeleteQuery,
        ("If-Match" = Option<String>, Header, description = "The `ETag` of the sweep as it was read."),
    ),
    responses((status = 200, description = "The deletion that is made, or would be", body = SweepDeletion), Problems)
)]
pub(crate) async fn delete(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(DeleteQuery { dry_run }): Query<DeleteQuery>,
    headers: HeaderMap,
) -> Result<Json<SweepDeletion>> {
    let current = state(&app, &id).await?.revision;
    let expected = expected_revision(&headers, current)?;
    let refused = |detail: String| Err(Error::new(ProblemKind::Conflict, detail));
    let (store, deleted) = (app.store.clone(), id.clone());
    match to_the_end(async move { store.delete_sweep(&deleted, expected, dry_run).await }).await? {
        DeleteOutcome::Deleted { points, results, bytes } => {
            Ok(Json(SweepDeletion { dry_run, points, results, bytes }))
        }
        DeleteOutcome::Pinned => refused(format!("sweep {id} is pinned; unpin it first")),
        DeleteOutcome::Unfinished => {
            refused(format!("sweep {id} has points that are not final; cancel it first, or wait for them"))
        }
        DeleteOutcome::OtherRevision => Err(changed_meanwhile(state(&app, &id).await?.revision)),
        DeleteOutcome::NoSuchSweep => Err(records::no_such_sweep(&id)),
    }
}
