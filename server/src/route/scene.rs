//! Plan and modes of a point, which follow from its scenario alone. Both search an equilibrium, as dry runs do, and take their turn
//! with these.

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use drillsweep_api::scene::{self, HIGHEST_MODE_HZ, Modes, Plan};
use drillsweep_api::{PHYSICS_VERSION, PointDetail};
use serde::{Deserialize, Deserializer};

use crate::answer::error::Result;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{Format, Tag};
use crate::answer::json::Json;
use crate::answer::records;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::{Conditional, Problems};
use crate::route::results::PointPath;

/// Memory of an equilibrium with its modes, for a string of usual length \[bytes\].
pub(crate) const MEMORY_OF_EQUILIBRIUM: usize = 16 << 20;

/// Plan of a point's scenario
///
/// As a dry run plans it: every effect with whether it takes part and why, the mesh, steps and processor times at each accuracy, and what
/// the equilibrium shows.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/plan",
    tag = "points",
    operation_id = "get_plan",
    params(PointPath, Conditional),
    responses((status = 200, description = "The plan", body = Plan), (status = 304, description = "The copy is right"), Problems)
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
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let plan = move |_: &mut Work| Ok(scene::plan(&point.scenario, speed.as_deref())?);
    let (plan, _memory): (Plan, _) = place.run(plan).await?;
    Ok(tag.on(Json(plan).into_response()))
}

/// Which modes are wanted.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModesQuery {
    /// Modes up to this frequency \[Hz\].
    #[serde(default = "default_range", deserialize_with = "range")]
    #[param(default = 20.0, exclusive_minimum = 0.0, maximum = 50.0)]
    to_hz: f64,
}

fn default_range() -> f64 {
    20.0
}

fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let range = value::number(deserializer)?.filter(|range| *range > 0.0 && *range <= HIGHEST_MODE_HZ);
    let detail = || format!("must be a number greater than 0, and at most {HIGHEST_MODE_HZ}");
    range.ok_or_else(|| serde::de::Error::custom(detail()))
}

/// The modes of vibration of a point about its equilibrium
///
/// Frequencies, growth, what moves most and where: of the equations of motion linearised about the equilibrium, its contacts closed and
/// sliding. They say where lines of a spectrum may come from; the motion of a run, which lifts off and sticks, need not keep to them.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/modes",
    tag = "points",
    operation_id = "get_modes",
    params(PointPath, ModesQuery, Conditional),
    responses((status = 200, description = "The modes, by frequency", body = Modes), (status = 304, description = "The copy is right"), Problems)
)]
pub(crate) async fn modes(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(ModesQuery { to_hz }): Query<ModesQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(Format::Json, &("modes", &point.key, to_hz));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let modes = move |_: &mut Work| Ok(scene::modes_up_to(&point.scenario, to_hz)?);
    let (modes, _memory): (Modes, _) = place.run(modes).await?;
    Ok(tag.on(Json(modes).into_response()))
}

async fn point(app: &App, id: &str, n: u32) -> Result<PointDetail> {
    let Some(record) = app.store.point(id, n.into()).await? else {
        return Err(records::no_such_point(&app.store, id, n).await?);
    };
    records::point_detail(id, &record, Vec::new())
}
