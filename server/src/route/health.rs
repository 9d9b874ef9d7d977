//! Whether the service lives, and whether it can work.

use std::time::Duration;

use axum::extract::State;
use drillsweep_api::{Health, ProblemKind};
use tokio::time::{Instant, timeout};

use crate::answer::error::{Error, Result};
use crate::answer::json::Json;
use crate::app::App;
use crate::openapi::answers::Problems;

/// How long an answer holds: everybody may ask, and each try writes to the disk.
const FRESH: Duration = Duration::from_secs(1);

/// How long the store may take: a writer with a big sweep is given its time.
const PATIENCE: Duration = Duration::from_secs(5);

/// Whether the process answers at all
#[utoipa::path(
    get,
    path = "/livez",
    tag = "service",
    operation_id = "is_alive",
    security(()),
    responses((status = 200, description = "It does", body = Health), Problems)
)]
pub(crate) async fn alive() -> Json<Health> {
    Json(Health { status: "ok".to_owned() })
}

/// Whether the service can work
///
/// A scratch point is queued and claimed as a worker would, and taken back; a scratch blob is written, read and
/// deleted. It is not ready either if submissions wait and none has been expanded for 15 s.
#[utoipa::path(
    get,
    path = "/readyz",
    tag = "service",
    operation_id = "is_ready",
    security(()),
    responses((status = 200, description = "It can", body = Health), Problems)
)]
pub(crate) async fn ready(State(app): State<App>) -> Result<Json<Health>> {
    if app.expansions.is_stuck() {
        return Err(Error::unavailable("expansions of sweeps wait, and none has begun for long"));
    }
    let mut seen = app.readiness.0.lock().await;
    if seen.is_none_or(|instant| instant.elapsed() > FRESH) {
        *seen = None;
        match timeout(PATIENCE, app.store.probe()).await {
            Ok(Ok(())) => *seen = Some(Instant::now()),
            Ok(Err(error)) if error.is_full() => {
                tracing::error!(%error, "the disk is full");
                return Err(Error::new(ProblemKind::Unavailable, "the store's disk is full"));
            }
            Ok(Err(error)) => return Err(Error::unavailable(&error)),
            Err(_) => return Err(Error::unavailable("the store did not answer in time")),
        }
    }
    Ok(Json(Health { status: "ok".to_owned() }))
}
