//! Plan, modes and hydraulics of a point, which follow from its scenario alone, and its diagnosis. All search an equilibrium, and take places for expansions, as dry runs
//! do.

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use drillsweep_api::analysis::{self, Circuit, Diagnosis, HIGHEST_MODE_HZ, Modes, Plan};
use drillsweep_api::in_units::InUnits;
use drillsweep_api::judgement::{Judgement, LimitChanges, Line, OperatingLimits};
use drillsweep_api::{PHYSICS_VERSION, PointDetail, ProblemDetails};
use drillsweep_quantity::UnitChoice;
use drillsweep_table::tables;
use serde::{Deserialize, Deserializer, Serialize};

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::Format;
use crate::answer::json::Json;
use crate::answer::{recordings, records};
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::{Conditional, Problems};
use crate::route::results::PointPath;

/// Memory of an equilibrium with its modes, for a string of usual length \[bytes\].
pub(crate) const MEMORY_OF_EQUILIBRIUM: usize = 16 << 20;

/// Plan of a point's scenario
///
/// As in a dry run: effects with their decisions and reasons, mesh, steps and processor times at each accuracy, and findings about the
/// equilibrium.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/plan",
    tag = "points",
    operation_id = "get_plan",
    params(PointPath, Conditional),
    responses((status = 200, description = "The plan", body = Plan), (status = 304, description = "The copy is current"), Problems)
)]
pub(crate) async fn plan(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    headers: HeaderMap,
) -> Result<Response> {
    let point = point(&app, &id, n).await?;
    let speed = app.store.machine_speed(i64::from(PHYSICS_VERSION)).await?;
    let tag = Tag::of(Format::Json, &("plan", &point.key, &speed));
    computed(&app, &caller, &headers, tag, move || analysis::plan(&point.scenario, speed.as_deref())).await
}

/// Answer with a document that an equilibrium gives, in a place for expansions, unless the caller's copy is current.
async fn computed<T: Serialize + Send + 'static>(
    app: &App,
    caller: &Caller,
    headers: &HeaderMap,
    tag: Tag,
    compute: impl FnOnce() -> std::result::Result<T, Box<ProblemDetails>> + Send + 'static,
) -> Result<Response> {
    if let Some(unchanged) = tag.unchanged(headers) {
        return Ok(unchanged);
    }
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let (document, _memory): (T, _) = place.run(move |_: &mut Work| Ok(compute()?)).await?;
    Ok(tag.on(Json(document).into_response()))
}

/// Query of the modes.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModesQuery {
    /// Modes up to this frequency \[Hz\].
    #[serde(default = "default_range", deserialize_with = "range")]
    #[param(default = 20.0, exclusive_minimum = 0.0, maximum = 50.0)]
    to_hz: f64,
    /// Units of depths: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by
    /// commas; a member `units` of the answer then names them. Absent means the kept units.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,measured_depth:m")]
    units: Option<UnitChoice>,
}

fn default_range() -> f64 {
    20.0
}

fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let range = value::number(deserializer)?.filter(|range| *range > 0.0 && *range <= HIGHEST_MODE_HZ);
    let detail = || format!("must be a number greater than 0, and at most {HIGHEST_MODE_HZ}");
    range.ok_or_else(|| serde::de::Error::custom(detail()))
}

/// Modes of vibration of a point about its equilibrium
///
/// Frequencies, growth, and the largest motion with its place, from the equations of motion linearised about the equilibrium, its contacts
/// closed and sliding. They are candidates for spectral lines; a run, in which contacts lift off and stick, may deviate from them.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/modes",
    tag = "points",
    operation_id = "get_modes",
    params(PointPath, ModesQuery, Conditional),
    responses((status = 200, description = "The modes, by frequency", body = Modes), (status = 304, description = "The copy is current"), Problems)
)]
pub(crate) async fn modes(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(ModesQuery { to_hz, units }): Query<ModesQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let point = point(&app, &id, n).await?;
    let units = units.unwrap_or_default();
    let tag = Tag::of(Format::Json, &("modes", &point.key, to_hz, &units));
    computed(&app, &caller, &headers, tag, move || {
        Ok(InUnits::new(analysis::modes_up_to(&point.scenario, to_hz)?, &units))
    })
    .await
}

/// Pressures of the mud's circuit at a point
///
/// Losses by part of the string, standpipe pressure and equivalent circulating density at every node, by the formulas of the eccentric and of the concentric
/// annulus, each at rest and turning, and by API RP 13D. The lists of parts and depths are in the order of `columns`.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/hydraulics",
    tag = "points",
    operation_id = "get_hydraulics",
    params(PointPath, Conditional),
    responses((status = 200, description = "The circuit", body = Circuit), (status = 304, description = "The copy is current"), Problems)
)]
pub(crate) async fn hydraulics(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    headers: HeaderMap,
) -> Result<Response> {
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(Format::Json, &("hydraulics", &point.key));
    computed(&app, &caller, &headers, tag, move || analysis::hydraulics(&point.scenario)).await
}

/// Query of a diagnosis.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct DiagnosisQuery {
    /// Changes of the service's limits: `COLUMN:VALUE` in the column's unit or with a unit, or `COLUMN:off`, separated by commas. A column with a limit that is exceeded
    /// makes the point `over_limit`; `bit_stick_slip_severity`, `backward_whirl_fraction`, `forward_whirl_fraction` and `largest_shock_rate_10g`
    /// decide classes of their own.
    #[serde(default, deserialize_with = "value::limits")]
    #[param(value_type = Option<String>, example = "bit_stick_slip_severity:0.5,largest_side_force:20000")]
    limits: LimitChanges,
    /// Units of evidence, limits, depths and amplitudes: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by
    /// commas; a member `units` of the answer then names them. Absent means the kept units.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,measured_depth:m")]
    units: Option<UnitChoice>,
}

/// Diagnosis of a point: class of its motion, and causes of its spectral lines
///
/// The class is the most severe of the findings, each in words with the columns that it rests on. Limits apply without a new run. Each line
/// of the recorded nodes' spectra has its cause: torsion of the string, rotation, rolling on the wall, a combination, or a mode of the
/// equilibrium; a line without a cause says so.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/diagnosis",
    tag = "points",
    operation_id = "get_diagnosis",
    params(PointPath, DiagnosisQuery, Conditional),
    responses((status = 200, description = "The diagnosis", body = Diagnosis), (status = 304, description = "The copy is current"), Problems)
)]
pub(crate) async fn diagnosis(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(DiagnosisQuery { limits, units }): Query<DiagnosisQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let limits = app.config.operating_limits.with(&limits);
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(Format::Json, &("diagnosis", &point.key, &point.summary, &limits, &units));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let diagnosis = diagnose(&app, &caller, &id, point, &limits).await?;
    Ok(tag.on(Json(InUnits::new(diagnosis, &units.unwrap_or_default())).into_response()))
}

/// Diagnosis of a point that has failed or has a result.
///
/// # Errors
/// The point has neither, with its state.
pub(super) async fn diagnose(
    app: &App,
    caller: &Caller,
    id: &str,
    point: PointDetail,
    limits: &OperatingLimits,
) -> Result<Diagnosis> {
    if let Some(error) = &point.row.error {
        let judgement = Judgement::of_failure(&error.reason, limits);
        return Ok(Diagnosis { judgement, lines: Vec::new() });
    }
    let n = point.row.ordinal;
    // Reports the state of a point without a result.
    recordings::result_key(&app.store, id, n).await?;
    let lines = recordings::stored_if_any(&app.store, id, n, tables::LINES.name).await?;
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let limits = limits.clone();
    let diagnose = move |_: &mut Work| {
        let lines = lines.map(|lines| lines.read(None)).transpose()?.and_then(|table| Line::of_table(&table));
        let summary = point.summary.unwrap_or_default();
        Ok(analysis::diagnosis(&point.scenario, &summary, lines, &limits)?)
    };
    let (diagnosis, _memory): (Diagnosis, _) = place.run(diagnose).await?;
    Ok(diagnosis)
}

/// A point with its scenario, without the names of its tables.
pub(super) async fn point(app: &App, id: &str, n: u32) -> Result<PointDetail> {
    let Some(record) = app.store.point(id, n.into()).await? else {
        return Err(records::no_such_point(&app.store, id, n).await?);
    };
    records::point_detail(id, &record, Vec::new())
}
