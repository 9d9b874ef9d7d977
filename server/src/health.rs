//! Whether the service lives, and whether it can work.

use axum::Json;
use axum::extract::State;
use drillsweep_api::Health;

use crate::app::App;
use crate::error::Result;
use crate::openapi::Problems;

/// Whether the process answers at all
#[utoipa::path(
    get,
    path = "/livez",
    tag = "service",
    operation_id = "is_alive",
    responses((status = 200, description = "It does", body = Health), Problems)
)]
pub(crate) async fn alive() -> Json<Health> {
    Json(Health { status: "ok".to_owned() })
}

/// Whether the service can work: the database answers
#[utoipa::path(
    get,
    path = "/readyz",
    tag = "service",
    operation_id = "is_ready",
    responses((status = 200, description = "It can", body = Health), Problems)
)]
pub(crate) async fn ready(State(app): State<App>) -> Result<Json<Health>> {
    app.store.now_ms().await?;
    Ok(Json(Health { status: "ok".to_owned() }))
}
