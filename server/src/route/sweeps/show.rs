//! A sweep, at once or after a long poll.

use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use drillsweep_api::{LIMITS, Sweep};
use serde::Deserialize;
use tokio::time::Instant;

use crate::answer::error::Result;
use crate::answer::etag::Tagged;
use crate::answer::extract::{Path, Query, value};
use crate::app::App;
use crate::guard::caller::Caller;
use crate::openapi::answers::Problems;
use crate::route::sweeps::{PROGRESS_INTERVAL, load_findings, state};

/// Query of a sweep.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShowQuery {
    /// Longest wait before the answer, at most 60 s: `30s`, `500ms`, or seconds as a number.
    #[serde(default, deserialize_with = "value::span")]
    #[param(value_type = Option<String>, example = "30s")]
    wait: Option<Duration>,
    /// Condition that ends the wait early.
    #[serde(default)]
    #[param(inline)]
    until: Until,
}

/// Condition that a long poll waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Until {
    /// Any change of state, counts or progress, or of the worker that queued points wait for.
    #[default]
    Change,
    /// Every point is final, and every reference run that verifies one.
    Completed,
}

/// A sweep: its state, counts and progress
///
/// With `wait` the answer is held back until the sweep changes, so that a script needs no polling loop. A sweep whose points are all final
/// is returned at once.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}",
    tag = "sweeps",
    operation_id = "get_sweep",
    params(("id" = String, Path, description = "Identifier of the sweep"), ShowQuery),
    responses(
        (status = 200, description = "The sweep in its present state", body = Sweep,
            headers(("ETag" = String, description = "Of this answer; `If-Match` takes it as the sweep's revision"))),
        Problems
    )
)]
pub(crate) async fn show(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    Query(query): Query<ShowQuery>,
) -> Result<Tagged> {
    let sweep = load_findings(&app, &id).await?;
    match query.wait {
        Some(wait) => {
            let _share = app.polls.take(caller.budget())?;
            Ok(Tagged(wait_for(&app, sweep, wait, query.until).await?))
        }
        None => Ok(Tagged(sweep)),
    }
}

async fn wait_for(app: &App, before: Sweep, wait: Duration, until: Until) -> Result<Sweep> {
    let start = Instant::now();
    let deadline = start + wait.min(Duration::from_secs(LIMITS.wait_seconds));
    let mut stopping = app.stopping.clone();
    let mut changes = app.store.sweep_changes().await;
    let seen = |sweep: &Sweep| {
        let verification = sweep.verification.as_ref().map(|verification| verification.counts);
        (sweep.state, sweep.counts, verification, sweep.progress.to_bits(), sweep.waiting_for.clone())
    };
    let (mut sweep, mut version, mut read) = (before.clone(), None, start);
    while sweep.finished.is_none() && (until == Until::Completed || seen(&sweep) == seen(&before)) {
        let now = Instant::now();
        if now >= deadline {
            break;
        }
        tokio::select! {
            () = changes.wait(app.config.poll_interval) => {}
            () = tokio::time::sleep_until(deadline) => {}
            // An error means that the service has ended.
            _ = stopping.wait_for(|stopping| *stopping) => break,
        }
        // The version shows new states cheaply; progress within a point does not raise it.
        let current = app.store.sweep_version(&before.id).await?;
        if version != Some(current) || read.elapsed() >= PROGRESS_INTERVAL {
            sweep = state(app, &before.id).await?;
            (version, read) = (Some(current), Instant::now());
        }
    }
    match seen(&sweep) == seen(&before) {
        true => Ok(before),
        false => load_findings(app, &before.id).await,
    }
}
