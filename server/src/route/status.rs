//! What the service says about itself.

use std::time::Duration;

use axum::Json;
use axum::extract::State;
use drillsweep_api::{LIMITS, Limits, Queue, Worker, WorkerList};
use drillsweep_store::WorkerRecord;

use crate::answer::document::Problems;
use crate::answer::error::Result;
use crate::answer::records::timestamp;
use crate::app::App;

/// Workers that have been silent for longer are not listed: five times the lease's renewal.
pub(crate) const WORKER_SILENCE: Duration = Duration::from_secs(100);

/// The worker processes
#[utoipa::path(
    get,
    path = "/v1/workers",
    tag = "service",
    operation_id = "list_workers",
    responses((status = 200, description = "Workers with a recent heartbeat, oldest first", body = WorkerList), Problems)
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
    let records = app.store.workers(WORKER_SILENCE.as_millis() as i64).await?;
    Ok(Json(WorkerList { workers: records.into_iter().map(worker).collect::<Result<_>>()? }))
}

/// The queue over all sweeps
#[utoipa::path(
    get,
    path = "/v1/queue",
    tag = "service",
    operation_id = "get_queue",
    responses((status = 200, description = "How much is queued and how much is running", body = Queue), Problems)
)]
pub(crate) async fn queue(State(app): State<App>) -> Result<Json<Queue>> {
    let depths = app.store.queue_depths().await?;
    Ok(Json(Queue {
        queued: depths.queued.unsigned_abs(),
        paused: depths.held.unsigned_abs(),
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
pub(crate) async fn limits(State(app): State<App>) -> Json<Limits> {
    let owner = &app.config.owner_limits;
    Json(Limits {
        requests_per_second: owner.requests_per_second.get(),
        request_burst: owner.request_burst.get(),
        open_points_per_owner: owner.open_points,
        ..LIMITS
    })
}
