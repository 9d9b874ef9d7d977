//! Submission and dry runs of sweeps and single runs.

use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{
    DryRun, Expansion, PHYSICS_VERSION, PointKeys, ProblemKind, RunRequest, Sweep, SweepRequest, expand,
};
use drillsweep_store::{CachePolicy, NewSweep, SubmitOutcome};
use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::answer::blocking::to_the_end;
use crate::answer::error::{Error, Result};
use crate::answer::etag::Tagged;
use crate::answer::extract::{self, Query, value};
use crate::answer::json::Json;
use crate::answer::records;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::audit::Owner;
use crate::guard::caller::Caller;
use crate::guard::quota;
use crate::openapi::answers::Problems;
use crate::route::status::WORKER_SILENCE;
use crate::route::sweeps::expand::{expand_body, make_room};
use crate::route::sweeps::load;

const IDEMPOTENCY_KEY: &str = "idempotency-key";

/// Query of a submission.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SubmitQuery {
    /// True returns the points and the plan of the request, and stores nothing.
    #[serde(default, deserialize_with = "value::truth")]
    dry_run: bool,
    /// Policy for points that were computed before, for any owner.
    #[serde(default)]
    #[param(inline)]
    cache: Cache,
}

/// Policy for points that were computed before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Cache {
    /// Known results are used; other points are computed.
    #[default]
    Reuse,
    /// All points are recomputed, including failed ones. Old results remain until new ones replace them, in all sweeps of the owner with
    /// these points, which are running meanwhile. Sweeps of other owners keep theirs.
    Refresh,
    /// Known results are used, and nothing is computed: a sweep with points without a result is refused (409), with their numbers.
    Only,
}

/// Submit a sweep
///
/// The points are the scenario at every combination of the axes' values, the first axis varying slowest. All errors of the request and its
/// points are reported together.
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
        (status = 200, description = "With `dry_run`: the plan of the request", body = DryRun),
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
        (status = 200, description = "With `dry_run`: the plan of the request", body = DryRun),
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
            let request: SweepRequest = request.into();
            let mut request = request.in_model_signs();
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

/// Problem of points without a result in a submission with `cache=only`.
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

/// Hash of a request, which distinguishes requests with the same key.
fn request_hash(body: &[u8], cache: Cache) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(body);
    match cache {
        Cache::Reuse => {}
        // No JSON text ends like this.
        Cache::Refresh => _ = hasher.update(b"\0refresh"),
        Cache::Only => _ = hasher.update(b"\0only"),
    }
    *hasher.finalize().as_bytes()
}

/// Idempotency key of a submission: visible ASCII characters.
fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>> {
    let Some(value) = headers.get(IDEMPOTENCY_KEY) else { return Ok(None) };
    let key = value.to_str().unwrap_or_default();
    if key.is_empty() || key.len() > 255 {
        return Err(Error::parameter("Idempotency-Key", None, "must have 1 to 255 visible ASCII characters"));
    }
    Ok(Some(key.to_owned()))
}
