//! Sweeps: submitting, following, changing, extending, stopping and retrying them, and their table.

use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::view::points::PointsTable;
use drillsweep_api::{
    AppendRequest, ColumnList, DryRun, Expansion, FieldProblem, LIMITS, PHYSICS_VERSION, PointKeys,
    ProblemDetails, ProblemKind, RunRequest, Sweep, SweepDeletion, SweepList, SweepPatch, SweepRequest,
    SweepState, check_patch, expand, expand_added, sample,
};
use drillsweep_chart as chart;
use drillsweep_store::{
    Addition, AppendOutcome, CachePolicy, ChangeOutcome, DeleteOutcome, NewSweep, NewVerification,
    SubmitOutcome, SweepChanges, SweepFilter, WorkState,
};
use drillsweep_table::quantity::{Name, tables};
use indexmap::{IndexMap, IndexSet};
use jiff::Timestamp;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use tokio::runtime::Handle;
use tokio::time::Instant;

use crate::answer::artifact;
use crate::answer::blocking::to_the_end;
use crate::answer::error::{Error, Result};
use crate::answer::extract::{self, Path, Query, value};
use crate::answer::format::{Answer, Format, PictureFormat, Tag};
use crate::answer::json::Json;
use crate::answer::records;
use crate::answer::stored::Stored;
use crate::answer::tag::{Tagged, changed_meanwhile, expected_revision};
use crate::app::App;
use crate::app::expansions::{Memory, Work};
use crate::guard::audit::Owner;
use crate::guard::caller::Caller;
use crate::guard::quota;
use crate::openapi::answers::{Conditional, PictureResponse, Problems};
use crate::route::status::WORKER_SILENCE;
use crate::route::verification::{Verified, memory_of_points};
use crate::route::waiting::note_waiting;

const IDEMPOTENCY_KEY: &str = "idempotency-key";

/// How often a long poll looks for progress within points; workers report it every 20 s.
pub(crate) const PROGRESS_INTERVAL: Duration = Duration::from_secs(2);

/// How a submission is meant.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SubmitQuery {
    /// True answers with the points that the request would become, and stores nothing.
    #[serde(default, deserialize_with = "value::truth")]
    dry_run: bool,
    /// Policy for points that were computed before, by anyone.
    #[serde(default)]
    #[param(inline)]
    cache: Cache,
}

/// Policy for points that were computed before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Cache {
    /// Their results are taken; the others are computed.
    #[default]
    Reuse,
    /// All points are recomputed, failed ones too. The old results stay until new ones replace them, for all sweeps of
    /// the owner that have the points; these are running again meanwhile. Sweeps of other owners keep theirs.
    Refresh,
    /// Their results are taken, and nothing is computed: a sweep with points that nobody has computed yet is refused (409),
    /// and the answer names them.
    Only,
}

/// Submit a sweep
///
/// The points are the scenario at every combination of the axes' values, the first axis varying slowest.
/// Everything that is wrong with the request or any of its points is reported at once.
#[utoipa::path(
    post,
    path = "/v1/sweeps",
    tag = "sweeps",
    operation_id = "create_sweep",
    request_body = SweepRequest,
    params(
        SubmitQuery,
        ("Idempotency-Key" = Option<String>, Header, description = "A key of the client's choice, such as a UUID. \
            The same request sent again with the same key is answered with the sweep that it made the first time."),
    ),
    responses(
        (status = 201, description = "The sweep is stored and queued", body = Sweep,
            headers(("Location" = String, description = "The sweep"))),
        (status = 200, description = "With `dry_run`: what the request would become", body = DryRun),
        Problems,
    )
)]
pub(crate) async fn create(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(query): Query<SubmitQuery>,
    headers: HeaderMap,
    body: extract::Body,
) -> Result<Response> {
    submit::<SweepRequest>(app, &caller, body, &query, &headers).await
}

/// Submit a single run
///
/// A sweep of one point: the answer is that sweep, the result is at its point 1.
#[utoipa::path(
    post,
    path = "/v1/runs",
    tag = "sweeps",
    operation_id = "create_run",
    request_body = RunRequest,
    params(
        SubmitQuery,
        ("Idempotency-Key" = Option<String>, Header, description = "As for a sweep."),
    ),
    responses(
        (status = 201, description = "The run is stored and queued", body = Sweep,
            headers(("Location" = String, description = "The sweep of one point"))),
        (status = 200, description = "With `dry_run`: what the request would become", body = DryRun),
        Problems,
    )
)]
pub(crate) async fn create_run(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(query): Query<SubmitQuery>,
    headers: HeaderMap,
    body: extract::Body,
) -> Result<Response> {
    submit::<RunRequest>(app, &caller, body, &query, &headers).await
}

async fn submit<R: DeserializeOwned + Into<SweepRequest>>(
    app: App,
    caller: &Caller,
    body: extract::Body,
    query: &SubmitQuery,
    headers: &HeaderMap,
) -> Result<Response> {
    let idempotency_key = idempotency_key(headers)?.map(|key| (key, request_hash(&body.bytes, query.cache)));
    let cache = match query.cache {
        Cache::Reuse => CachePolicy::Reuse,
        Cache::Refresh => CachePolicy::Refresh,
        Cache::Only => CachePolicy::Only,
    };
    let expanded = expand_body(&app, caller, &body, {
        let caller = caller.clone();
        move |request: R, work, memory| {
            let mut request: SweepRequest = request.into();
            request.owner = caller.submits_as(request.owner)?;
            if let Err(needed) = make_room(work, memory, &request) {
                return Ok(Err(needed));
            }
            let expansion = expand(&request, &|| work.check())?;
            let new_sweep = records::new_sweep(&request, &expansion, cache, idempotency_key.clone())?;
            Ok(Ok((expansion, new_sweep)))
        }
    });
    let ((expansion, new_sweep), memory) = expanded.await?;
    let kept = (body, memory);
    if query.dry_run {
        drop(new_sweep);
        let answer = Json(plan(&app, caller, expansion, cache).await?).into_response();
        drop(kept);
        return Ok(answer);
    }
    if cache != CachePolicy::Only {
        let added = new_sweep.points.len() + new_sweep.verification.runs.len();
        quota::check_open_points(&app, &new_sweep.owner, added).await?;
    }
    let store = app.store.clone();
    let (new_sweep, outcome) = to_the_end(async move {
        let outcome = store.submit_sweep(&new_sweep).await?;
        drop(kept);
        Ok((new_sweep, outcome))
    })
    .await?;
    let id = match outcome {
        SubmitOutcome::Created => new_sweep.id,
        SubmitOutcome::Known(id) => id,
        SubmitOutcome::NotComputed { points, verifications } => {
            return Err(not_computed(&new_sweep, &points, &verifications));
        }
    };
    let sweep = Sweep { warnings: expansion.warnings, ..load(&app, &id).await? };
    let location = HeaderValue::try_from(&sweep.links.this).map_err(|error| Error::internal(&error))?;
    let owner = Extension(Owner(sweep.owner.clone()));
    Ok((StatusCode::CREATED, [(header::LOCATION, location)], owner, Tagged(sweep)).into_response())
}

/// Memory of an expanded point until it is stored \[bytes\].
const MEMORY_OF_POINT: usize = 700;

/// Processor time of expanding a point: twice that of the slowest presets, whose meshes follow from the scenario.
const TIME_OF_POINT: Duration = Duration::from_micros(300);

/// Takes memory and processor time for all points of a request, next to what reading it takes \[bytes\].
///
/// # Errors
/// The memory that the request takes, if so much is not free.
fn make_room(work: &mut Work, of_reading: usize, request: &SweepRequest) -> std::result::Result<(), usize> {
    let points = request.point_count().unwrap_or(usize::MAX).min(LIMITS.points_per_sweep);
    let needed = of_reading + points * MEMORY_OF_POINT;
    if !work.grow(needed) {
        return Err(needed);
    }
    work.allow(TIME_OF_POINT * points as u32);
    Ok(())
}

/// Reads a body and expands its request in a place for expansions. Where the place has less memory than the request turns out to take,
/// `expand` returns how much, and all is done again in a place of that size.
async fn expand_body<R: DeserializeOwned, T: Send + 'static>(
    app: &App,
    caller: &Caller,
    body: &extract::Body,
    expand: impl Fn(R, &mut Work, usize) -> Result<std::result::Result<T, usize>> + Clone + Send + 'static,
) -> Result<(T, Memory)> {
    let of_reading = extract::memory_of_reading(body.bytes.len());
    let mut memory = of_reading;
    loop {
        let place = app.expansions.enter(caller.budget(), memory).await?;
        let (bytes, expand) = (body.bytes.clone(), expand.clone());
        let expanded = place.run(move |work| expand(extract::read_json(&bytes)?, work, of_reading)).await?;
        match expanded {
            (Ok(expanded), memory) => return Ok((expanded, memory)),
            (Err(needed), _) => memory = needed,
        }
    }
}

/// The problem that a sweep which computes nothing has points without an outcome.
fn not_computed(sweep: &NewSweep, points: &[i64], verifications: &[i64]) -> Error {
    const NAMED: usize = 20;
    let of = |what: &str, missing: &[i64], total: usize| {
        let mut named: Vec<String> = missing.iter().take(NAMED).map(i64::to_string).collect();
        if missing.len() > NAMED {
            named.push("...".to_owned());
        }
        let number = missing.len();
        format!(
            "{number} of {total} {what} have not been computed, and cache=only computes none: {}",
            named.join(", ")
        )
    };
    let detail = match points {
        [] => of("reference runs that verify points", verifications, sweep.verification.runs.len()),
        _ => of("points", points, sweep.points.len()),
    };
    Error::new(ProblemKind::NoResult, detail)
}

async fn plan(app: &App, caller: &Caller, expansion: Expansion, cache: CachePolicy) -> Result<DryRun> {
    let known = async |keys: PointKeys| match cache {
        CachePolicy::Refresh => Ok(0),
        CachePolicy::Reuse | CachePolicy::Only => app.store.known_results(&keys).await,
    };
    let keys_of = |expansion: Option<&Expansion>| {
        let points = expansion.into_iter().flat_map(|expansion| &expansion.points);
        points.map(|point| (point.key, point.fuller_key)).collect::<PointKeys>()
    };
    let known_points = known(keys_of(Some(&expansion))).await?;
    let known_references = known(keys_of(expansion.verification.as_deref())).await?;
    let place = app.expansions.enter(caller.budget(), 0).await?;
    let ((expansion, by_accuracy), _) = place
        .run(move |_| {
            let by_accuracy = expansion.keys_by_accuracy();
            Ok((expansion, by_accuracy))
        })
        .await?;
    let known_at = match by_accuracy {
        Some(by_accuracy) => {
            let mut counts = IndexMap::new();
            for (name, keys) in by_accuracy {
                counts.insert(name.to_owned(), known(keys).await?);
            }
            Some(counts)
        }
        None => None,
    };
    let speed = app.store.machine_speed(i64::from(PHYSICS_VERSION)).await?;
    let workers = app.store.workers(WORKER_SILENCE.as_millis() as i64).await?.len();
    let place = app.expansions.enter(caller.budget(), 0).await?;
    let plan = move |_: &mut Work| {
        let speed = speed.as_deref();
        Ok(DryRun::new(&expansion, known_points, known_references, known_at, speed, workers))
    };
    Ok(place.run(plan).await?.0)
}

/// Hash that distinguishes two requests with the same key.
fn request_hash(body: &[u8], cache: Cache) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(body);
    match cache {
        Cache::Reuse => {}
        // No JSON text has such an end.
        Cache::Refresh => _ = hasher.update(b"\0refresh"),
        Cache::Only => _ = hasher.update(b"\0only"),
    }
    *hasher.finalize().as_bytes()
}

/// The key under which a submission may be repeated: a text of visible ASCII.
fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>> {
    let Some(value) = headers.get(IDEMPOTENCY_KEY) else { return Ok(None) };
    let key = value.to_str().unwrap_or_default();
    if key.is_empty() || key.len() > 255 {
        return Err(Error::parameter("Idempotency-Key", None, "must have 1 to 255 visible ASCII characters"));
    }
    Ok(Some(key.to_owned()))
}

/// Which sweeps are listed.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ListQuery {
    /// Entries in a page; absent means 50.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1, maximum = 500)]
    limit: Option<u32>,
    /// `next` of the page before.
    #[param(min_length = 1)]
    cursor: Option<String>,
    /// Only sweeps of this owner.
    owner: Option<String>,
    /// Only sweeps in this state.
    #[param(inline)]
    state: Option<SweepState>,
    /// Only sweeps with this text in their name, in whatever case.
    name: Option<String>,
    /// Only sweeps with this tag.
    tag: Option<String>,
    /// Only sweeps whose identifier begins like this.
    id: Option<String>,
}

/// The sweeps, newest first
#[utoipa::path(
    get,
    path = "/v1/sweeps",
    tag = "sweeps",
    operation_id = "list_sweeps",
    params(ListQuery),
    responses((status = 200, description = "A page of sweeps", body = SweepList), Problems)
)]
pub(crate) async fn list(State(app): State<App>, Query(query): Query<ListQuery>) -> Result<Json<SweepList>> {
    let limit = extract::page_size(query.limit)?;
    if let Some(cursor) = query.cursor.as_deref().filter(|cursor| uuid::Uuid::parse_str(cursor).is_err()) {
        return Err(Error::parameter("cursor", Some(cursor), "must be `next` of the page before"));
    }
    // One more than asked for shows whether there is a next page.
    let filter = SweepFilter {
        owner: query.owner.as_deref(),
        state: query.state.map(SweepState::as_str),
        name: query.name.as_deref(),
        tag: query.tag.as_deref(),
        id: query.id.as_deref(),
    };
    let mut records = app.store.sweeps(&filter, query.cursor.as_deref(), i64::from(limit) + 1).await?;
    let is_last = records.len() <= limit as usize;
    records.truncate(limit as usize);
    let next = records.last().filter(|_| !is_last).map(|record| record.id.clone());
    let mut sweeps: Vec<Sweep> = records.iter().map(records::sweep).collect::<Result<_>>()?;
    note_waiting(&app, &mut sweeps).await?;
    Ok(Json(SweepList { sweeps, next }))
}

/// Requests by which points were added that an answer has: who adds them one by one has thousands, and is answered every time.
const APPENDED_SHOWN: i64 = 100;

/// The sweep with its counts. What verifying its points has shown is left out: that takes their results to tell, too much for each
/// look at a sweep that is followed.
pub(crate) async fn load(app: &App, id: &str) -> Result<Sweep> {
    load_with(app, id, APPENDED_SHOWN).await
}

/// The sweep with what verifying its points has shown.
async fn load_findings(app: &App, id: &str) -> Result<Sweep> {
    with_findings(app, load(app, id).await?).await
}

/// The sweep with all that was ever asked for, and all that it has shown.
pub(crate) async fn load_whole(app: &App, id: &str) -> Result<Sweep> {
    with_findings(app, load_with(app, id, i64::MAX).await?).await
}

async fn load_with(app: &App, id: &str, appended: i64) -> Result<Sweep> {
    let Some(record) = app.store.sweep(id).await? else { return Err(records::no_such_sweep(id)) };
    let mut sweep = records::sweep_with_requests(&record, &app.store.appended_requests(id, appended).await?)?;
    note_waiting(app, std::slice::from_mut(&mut sweep)).await?;
    Ok(sweep)
}

async fn with_findings(app: &App, mut sweep: Sweep) -> Result<Sweep> {
    if let Some(verification) = &mut sweep.verification {
        let findings = Verified::load(&app.store, &sweep.id).await?.findings;
        verification.worst = findings.worst_orbit_size();
        verification.warnings = findings.warnings;
    }
    Ok(sweep)
}

/// Whether and for what a request waits.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShowQuery {
    /// Waits so long, at most 60 s, before it answers: `30s`, `500ms`, or seconds as a number.
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
/// With `wait` the answer is held back until something changes, so that a script needs no polling loop of
/// its own. A sweep whose points are all final is answered at once.
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
            // An error means that the service is gone.
            _ = stopping.wait_for(|stopping| *stopping) => break,
        }
        // The version shows new states cheaply; progress within a point does not raise it.
        let current = app.store.sweep_version(&before.id).await?;
        if version != Some(current) || read.elapsed() >= PROGRESS_INTERVAL {
            sweep = load(app, &before.id).await?;
            (version, read) = (Some(current), Instant::now());
        }
    }
    match seen(&sweep) == seen(&before) {
        true => Ok(before),
        false => load_findings(app, &before.id).await,
    }
}

/// Cancel a sweep
///
/// Queued points are cancelled at once, running ones within a heartbeat of their worker, and so are the reference runs that
/// verify some. What another sweep wants too goes on for that sweep. Cancelling again changes nothing.
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

/// Retry the failed and cancelled points of a sweep, and reference runs that verify some
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
/// Its queued points are not started any more, but for those that another sweep wants; running ones continue to their end.
/// Pausing again changes nothing.
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

/// Let a paused sweep go on
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
/// Absent fields stay as they are. A new priority holds for the points that wait, too. With `If-Match` nothing is changed of a sweep that
/// somebody else has changed meanwhile (412); that its points have gone on does not count.
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
    let current = load(&app, &id).await?.revision;
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
        ChangeOutcome::OtherRevision => Err(changed_meanwhile(load(&app, &id).await?.revision)),
        ChangeOutcome::NoSuchSweep => Err(records::no_such_sweep(&id)),
    }
}

/// The problem that a sweep's time is over before it is set.
fn already_past(expires: Timestamp, now: Timestamp) -> Error {
    let problem = FieldProblem {
        pointer: Some("/expires".to_owned()),
        parameter: None,
        got: Some(expires.to_string().into()),
        detail: format!("must be in the future, after {now}; to delete the sweep now, use DELETE"),
    };
    ProblemDetails::invalid_request(vec![problem]).into()
}

/// Whether a deletion is meant.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeleteQuery {
    /// True answers with what would be deleted, and deletes nothing.
    #[serde(default, deserialize_with = "value::truth")]
    dry_run: bool,
}

/// Delete a sweep
///
/// Its points, events and requests are gone at once; results that no other sweep has go with the next collection, and so do their
/// tables. A sweep that is pinned, or has points that are not final, is not deleted (409).
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
    let current = load(&app, &id).await?.revision;
    let expected = expected_revision(&headers, current)?;
    let refused = |detail: String| Err(Error::new(ProblemKind::Conflict, detail));
    let (store, deleted) = (app.store.clone(), id.clone());
    match to_the_end(async move { store.delete_sweep(&deleted, expected, dry_run).await }).await? {
        DeleteOutcome::Deleted { points, results, bytes } => {
            Ok(Json(SweepDeletion { dry_run, points, results, bytes }))
        }
        DeleteOutcome::Pinned => refused(format!("sweep {id} is pinned; take the pin away first")),
        DeleteOutcome::Unfinished => {
            refused(format!("sweep {id} has points that are not final; cancel it first, or wait for them"))
        }
        DeleteOutcome::OtherRevision => Err(changed_meanwhile(load(&app, &id).await?.revision)),
        DeleteOutcome::NoSuchSweep => Err(records::no_such_sweep(&id)),
    }
}

/// Add points to a sweep
///
/// Points of the sweep's scenario with other values of its parameters, by any design; their numbers go on from its last
/// point. Points that the sweep has already are skipped, so that a finer grid may be asked for as a whole, and the same
/// request again changes nothing. Of the added points as many are verified as make up the `verify` of the whole sweep.
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/points",
    tag = "sweeps",
    operation_id = "append_points",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    request_body = AppendRequest,
    responses((status = 200, description = "The sweep with the new points", body = Sweep), Problems)
)]
pub(crate) async fn append(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    body: extract::Body,
) -> Result<Json<Sweep>> {
    let sweep = load(&app, &id).await?;
    let Some(original) = sweep.request else {
        return Err(Error::internal("a sweep was read without its request"));
    };
    let verify = original.verify;
    let expanded = expand_body(&app, &caller, &body, move |added: AppendRequest, work, memory| {
        let request_json = records::write(&added)?;
        let request = added.of(&original)?;
        if let Err(needed) = make_room(work, memory, &request) {
            return Ok(Err(needed));
        }
        let expansion = expand_added(&request, &original, &|| work.check())?;
        let points = records::new_points(&expansion)?;
        Ok(Ok((request_json, expansion, points)))
    });
    let ((request_json, expansion, points), _memory) = expanded.await?;
    let (expansion, verification) = match verify {
        None => (expansion, NewVerification::default()),
        Some(verify) => {
            let lacking = app.store.lacking_points(&id, &points).await?;
            let verified = sweep.verification.as_ref().map_or(0, |verification| verification.counts.total);
            let total = sweep.counts.total as usize + lacking.len();
            let place = app.expansions.enter(caller.budget(), 0).await?;
            let verify = move |work: &mut Work| {
                let sample = sample(verify, total, verified as usize, lacking.len());
                // Ordinals of the expansion count from 1.
                let sample: Vec<usize> =
                    sample.into_iter().map(|index| lacking[index] as usize - 1).collect();
                let references = expansion.references(&sample, &|| work.check())?;
                let verification = records::new_verification(&references)?;
                Ok((expansion, verification))
            };
            place.run(verify).await?.0
        }
    };
    quota::check_open_points(&app, &sweep.owner, points.len() + verification.runs.len()).await?;
    let base_json = records::write(&expansion.base)?;
    let addition = Addition {
        base_json: &base_json,
        physics_version: PHYSICS_VERSION.into(),
        points: &points,
        verification: &verification,
        request_json: &request_json,
    };
    let most = LIMITS.points_per_sweep as u64;
    match app.store.append_points(&id, &addition, most).await? {
        AppendOutcome::Added(_) => {}
        AppendOutcome::NoSuchSweep => return Err(records::no_such_sweep(&id)),
        AppendOutcome::Cancelled => {
            return Err(Error::new(
                ProblemKind::Conflict,
                format!("sweep {id} is cancelled; retry it first"),
            ));
        }
        AppendOutcome::OtherNumbers(version) => {
            let detail = format!(
                "the points of sweep {id} are of physics version {version}, and this service computes version \
                 {PHYSICS_VERSION}: points of both in one sweep would not compare; submit a new one"
            );
            return Err(Error::new(ProblemKind::Conflict, detail));
        }
        AppendOutcome::TooMany(total) => {
            let detail = format!("the sweep would have {total} points; a sweep has at most {most}");
            return Err(Error::new(ProblemKind::Conflict, detail));
        }
    }
    Ok(Json(Sweep { warnings: expansion.warnings, ..load(&app, &id).await? }))
}

/// How the table of a sweep is served.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SweepTableQuery {
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Only these columns, separated by commas; of a picture, what it shows.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>)]
    fields: Option<Vec<String>>,
    /// Of a map: how the values of its parameters are placed; absent means `even`.
    #[param(inline)]
    spacing: Option<MapSpacing>,
    /// Of a picture: parameters that it holds, each with one of its values in the units of the table, separated by commas:
    /// `mud.density:1200,operation.weight_on_bit:-50000`. Of the others a map is over the first two; further ones are held at the
    /// first value that they have. The picture says at which.
    #[serde(default, deserialize_with = "value::assignments")]
    #[param(value_type = Option<String>)]
    slice: Option<Vec<(String, f64)>>,
}

/// How a map places the values of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MapSpacing {
    /// At equal distances, whatever the values.
    #[default]
    Even,
    /// As far apart as the values are.
    ToScale,
}

impl From<MapSpacing> for chart::Spacing {
    fn from(spacing: MapSpacing) -> Self {
        match spacing {
            MapSpacing::Even => chart::Spacing::Even,
            MapSpacing::ToScale => chart::Spacing::ToScale,
        }
    }
}

/// One row a point: its parameters and the scalars of its result
///
/// Points without a result have their row too, with empty fields; `state` and `error` say why. Points that the request's `verify`
/// has chosen have the bias of each statistic against the reference, as `bias_orbit_radius_rms_49`; where biases exceed what the
/// accuracy promises, the attribute `warnings` says so. A picture shows the columns in `fields` over the parameters that vary: lines
/// over one of them, a map of the first column over two, with diamonds at verified points; with more, a slice. Words, such as `state`
/// and `stable`, have a colour each. A column of a node is shown with its depth, where that is the same in all of the sweep.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/table",
    tag = "sweeps",
    operation_id = "get_sweep_table",
    params(("id" = String, Path, description = "Identifier of the sweep"), SweepTableQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn table(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(SweepTableQuery { format, fields, spacing, slice }): Query<SweepTableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let format = Format::choose(format, &headers)?;
    let spacing = spacing.unwrap_or_default();
    let slice = slice.unwrap_or_default();
    let Some(sweep) = app.store.sweep(&id).await? else { return Err(records::no_such_sweep(&id)) };
    // The version is raised with every change of a point, and of a run that verifies one.
    let key = Tag::of(format, &("map", &id, sweep.version, &sweep.name, &fields, spacing, &slice));
    let mut view = chart::SweepView { spacing: spacing.into(), slice, ..Default::default() };
    let memory = memory_of_points(&app, &id, sweep.counts.total.unsigned_abs()).await?;
    let verified = Verified::load(&app.store, &id).await?;
    let nodes = match format.is_picture() {
        true => nodes_of(fields.as_deref().unwrap_or_default()),
        false => Vec::new(),
    };
    let statics = match nodes.is_empty() {
        true => None,
        false => statics_of_first(&app, &id).await?,
    };
    let (runtime, store) = (Handle::current(), app.store.clone());
    app.answer(format, key.as_str(), memory, move || {
        // A picture shows more than the columns that are asked for.
        let table = match &fields {
            Some(fields) if !format.is_picture() => PointsTable::keeping(fields.iter().map(String::as_str)),
            _ => PointsTable::default(),
        };
        let points = verified.points(table, &store, &id, &runtime)?;
        let parameters: IndexSet<String> = points.parameters().map(str::to_owned).collect();
        if let Some(statics) = statics
            && !parameters.iter().any(|name| moves_nodes(name))
        {
            // A picture without depths is better than none.
            view.places = artifact::depths(&statics, &nodes).unwrap_or_default();
        }
        let mut table = points.finish();
        let findings = &verified.findings;
        if !findings.warnings.is_empty() {
            table = table.attribute("warnings", findings.warnings.clone());
        }
        let (fields, title) = (fields.as_deref(), sweep.name.as_deref().unwrap_or_default());
        Answer::of_table_or_picture(table, fields, format, &format!("sweep-{id}"), None, |table| {
            chart::sweep(table, &parameters, fields, findings, title, &view)
        })
    })
    .await
}

/// The nodes that columns are of by number.
fn nodes_of(fields: &[String]) -> Vec<u32> {
    let node = |name: &String| u32::try_from(Name::parse(name)?.place?.node()?).ok();
    fields.iter().filter_map(node).collect()
}

/// The equilibrium of the first point that has a result and has kept it.
async fn statics_of_first(app: &App, id: &str) -> Result<Option<Stored>> {
    let first = app.store.points(id, &[WorkState::Done], 0, 1).await?;
    let ordinal = first.first().and_then(|point| u32::try_from(point.ordinal).ok());
    match ordinal {
        Some(n) => artifact::stored_if_any(&app.store, id, n, tables::STATICS.name).await,
        None => Ok(None),
    }
}

/// Whether a node of one number may lie elsewhere where this parameter has another value: the mesh follows from the string and its wall.
fn moves_nodes(parameter: &str) -> bool {
    let of_what = parameter.split(['.', '[']).next();
    of_what.is_some_and(|of_what| ["string", "mesh", "contact"].contains(&of_what))
}

/// The columns of the table of a sweep, without their values
///
/// In their order, with kinds and units: those of the points as they are now. What a name stands for says `GET /v1/quantities`.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/table/columns",
    tag = "sweeps",
    operation_id = "list_sweep_table_columns",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    responses((status = 200, description = "The columns", body = ColumnList), Problems)
)]
pub(crate) async fn columns(State(app): State<App>, Path(id): Path<String>) -> Result<Json<ColumnList>> {
    let Some(sweep) = app.store.sweep(&id).await? else { return Err(records::no_such_sweep(&id)) };
    if let Some(columns) = app.columns.get(&id, sweep.version) {
        return Ok(Json(columns));
    }
    let place = app.view(memory_of_points(&app, &id, sweep.counts.total.unsigned_abs()).await?).await?;
    let verified = Verified::load(&app.store, &id).await?;
    let runtime = Handle::current();
    place
        .run(move || {
            let points = verified.points(PointsTable::keeping([]), &app.store, &id, &runtime)?;
            let columns = ColumnList::of(&points.finish());
            app.columns.put(id, sweep.version, columns.clone());
            Ok(Json(columns))
        })
        .await
}
