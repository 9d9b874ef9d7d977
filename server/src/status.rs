//! What the service says about itself.

use axum::Json;
use axum::extract::State;
use drillsweep_api::{LIMITS, Limits, Queue, Worker, WorkerList};
use drillsweep_store::WorkerRecord;

use crate::app::App;
use crate::convert::timestamp;
use crate::error::Result;
use crate::openapi::Problems;

/// Workers that have been silent for longer \[ms\] are not listed: five times the lease's renewal.
const WORKER_SILENCE_MS: i64 = 100_000;

/// The worker processes
#[utoipa::path(
    get,
    path = "/v1/workers",
    tag = "service",
    operation_id = "list_workers",
    responses((status = 200, description = "Workers heard of lately, oldest first", body = WorkerList), Problems)
)]
pub(crate) async fn workers(State(app): State<App>) -> Result<Json<WorkerList>> {
    let worker = |record: WorkerRecord| {
        Ok(Worker {
            id: record.id,
            host: record.host,
            process: record.process,
            version: record.version,
            physics_version: record.physics_version,
            started: timestamp(record.started)?,
            seen: timestamp(record.last_seen)?,
        })
    };
    let records = app.store.workers(WORKER_SILENCE_MS).await?;
    Ok(Json(WorkerList { workers: records.into_iter().map(worker).collect::<Result<_>>()? }))
}

/// The queue over all sweeps
#[utoipa::path(
    get,
    path = "/v1/queue",
    tag = "service",
    operation_id = "get_queue",
    responses((status = 200, description = "How much waits and how much is under way", body = Queue), Problems)
)]
pub(crate) async fn queue(State(app): State<App>) -> Result<Json<Queue>> {
    let depths = app.store.queue_depths().await?;
    Ok(Json(Queue {
        queued: depths.queued.unsigned_abs(),
        waiting_for_retry: depths.waiting.unsigned_abs(),
        running: depths.leased.unsigned_abs(),
    }))
}

/// The bounds of what the service accepts
#[utoipa::path(
    get,
    path = "/v1/limits",
    tag = "service",
    operation_id = "get_limits",
    responses((status = 200, description = "The limits", body = Limits), Problems)
)]
pub(crate) async fn limits() -> Json<Limits> {
    Json(LIMITS)
}
