//! Status of the service: workers, queue, limits and retention.

use std::time::Duration;

use axum::extract::State;
use drillsweep_api::{Collection, LIMITS, Limits, Queue, Retention, Worker, WorkerList};
use drillsweep_store::WorkerRecord;
use drillsweep_table::tables::HISTORY;

use crate::answer::error::Result;
use crate::answer::json::Json;
use crate::answer::records::{read, timestamp};
use crate::app::App;
use crate::app::retention::RetentionConfig;
use crate::openapi::answers::Problems;

/// Silence after which workers are not listed any more: five times the interval of a lease's renewal.
pub(crate) const WORKER_SILENCE: Duration = Duration::from_secs(100);

/// Worker processes
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

/// Queue of all sweeps
#[utoipa::path(
    get,
    path = "/v1/queue",
    tag = "service",
    operation_id = "get_queue",
    responses((status = 200, description = "Numbers of queued and of running points", body = Queue), Problems)
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

/// Retention of data, and the last garbage collection
#[utoipa::path(
    get,
    path = "/v1/retention",
    tag = "service",
    operation_id = "get_retention",
    responses((status = 200, description = "The ages and the last collection", body = Retention), Problems)
)]
pub(crate) async fn retention(State(app): State<App>) -> Result<Json<Retention>> {
    const DAY_SECONDS: f64 = 86_400.0;
    let last = match app.store.last_collection().await? {
        None => None,
        Some(last) => Some(Collection {
            started: timestamp(last.started)?,
            ended: last.ended.map(timestamp).transpose()?,
            deleted: last.deleted_json.as_deref().map(read).transpose()?,
        }),
    };
    let RetentionConfig { policy, interval } = &app.config.retention;
    let recordings = policy.artifact_ages.get(HISTORY.name).unwrap_or(&policy.other_artifacts);
    Ok(Json(Retention {
        interval_seconds: interval.map(|interval| interval.as_secs_f64()),
        recordings_days: recordings.as_secs_f64() / DAY_SECONDS,
        tables_days: policy.other_artifacts.as_secs_f64() / DAY_SECONDS,
        events_days: policy.events.as_secs_f64() / DAY_SECONDS,
        last,
    }))
}

/// Limits of requests
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
