//! Torque and drag of a point's string over bit depth, and friction factors from measurements.

use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::torque_drag::{Broomstick, DragMode, DragSettings, FrictionFit, FrictionRequest};
use drillsweep_chart::broomstick;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::HOOK_LOAD;
use drillsweep_table::Table;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{self, Path, Query, value};
use crate::answer::format::{Answer, Form, PictureFormat};
use crate::answer::json::Json;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::{Conditional, PictureResponse, Problems};
use crate::route::analysis::{MEMORY_OF_EQUILIBRIUM, point};
use crate::route::results::{PointPath, file_name};

/// Query of torque and drag.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct TorqueDragQuery {
    /// Motions of the string, separated by commas: `pick_up`, `slack_off`, `rotate`, `drill`, `slide`, `ream`; absent means the first three.
    #[serde(default = "usual_modes", deserialize_with = "modes")]
    #[param(value_type = Option<String>, example = "pick_up,slack_off,rotate,drill")]
    modes: Vec<DragMode>,
    /// Bit depths \[m\]: numbers separated by commas, or `FROM:TO:COUNT`; absent means 40 to that of the scenario. For a bit above the end of the
    /// string pipe is missing at the top.
    #[serde(default, deserialize_with = "value::list")]
    #[param(value_type = Option<String>, example = "50:200:4")]
    depths: Vec<f64>,
    /// Friction factors of the whole hole, likewise; absent means the dynamic friction of each hole section.
    #[serde(default, deserialize_with = "value::list")]
    #[param(value_type = Option<String>, example = "0.2,0.25,0.3")]
    friction: Vec<f64>,
    /// Weight of top drive and travelling block \[N\], part of the hook load.
    #[serde(default, deserialize_with = "value::number")]
    travelling_weight: Option<f64>,
    /// Axial speed of the mode `ream` \[m/s\], downhole positive.
    #[serde(default, deserialize_with = "value::number")]
    axial_speed: Option<f64>,
    /// True for the equilibria of the finite elements in place of the soft string: with bending stiffness, clearance and the flow of the mud, at some 0.1 s a case,
    /// 60 at most. Without `depths`, at the scenario's bit depth.
    #[serde(default)]
    stiff: bool,
    /// Format of the table, or of a picture of `field`; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by commas. CSV then has
    /// units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,hook_load:kN")]
    units: Option<UnitChoice>,
    /// Column that a picture shows, hook load unless given.
    field: Option<String>,
}

fn usual_modes() -> Vec<DragMode> {
    vec![DragMode::PickUp, DragMode::SlackOff, DragMode::Rotate]
}

fn modes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<DragMode>, D::Error> {
    let names = value::names(deserializer)?.unwrap_or_default();
    let mode = |name: &String| {
        let known = || DragMode::ALL.map(DragMode::name).join(", ");
        DragMode::named(name).ok_or_else(|| D::Error::custom(format!("must be some of {}", known())))
    };
    names.iter().map(mode).collect()
}

/// Torque and drag of a point's string over bit depth
///
/// Hook load and surface torque of a soft string, without bending stiffness, on the axis of the hole in still mud, or of the stiff one, with margins to yield, overpull and buckling: a row for
/// each motion, friction factor and bit depth, 5000 at most. Pictures show lines over depth, a broomstick.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/torque_drag",
    tag = "points",
    operation_id = "get_torque_drag",
    params(PointPath, TorqueDragQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<TorqueDragQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    /// Bytes of a case, in memory and in writing.
    const OF_CASE: u64 = 512;
    /// Processor time of all cases of a stiff string, as of 60 searches of a whole well's equilibrium at half a second each.
    const OF_STIFF_CASES: Duration = Duration::from_secs(30);
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(&form, &("torque_drag", &point.key, &query));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let TorqueDragQuery { modes, depths, friction, travelling_weight, axial_speed, stiff, field, .. } = query;
    let settings = DragSettings { travelling_weight: travelling_weight.unwrap_or(0.0), axial_speed };
    let broom = Broomstick { modes, depths, friction, settings, is_stiff: stiff };
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let (table, _memory): (Table, _) = place
        .run(move |work: &mut Work| {
            if broom.is_stiff {
                work.allow(OF_STIFF_CASES);
            }
            Ok(broom.table(&point.scenario, &|| work.check())?)
        })
        .await?;
    let place = app.view(form.format.memory(OF_CASE * table.rows() as u64)).await?;
    place
        .answer(move || {
            let column = field.as_deref().unwrap_or(HOOK_LOAD.name);
            let draw =
                |table: &Table, units: &UnitChoice| broomstick(table, column, "Torque and drag", units);
            let name = file_name(&id, n, "torque-drag");
            Answer::of_table_or_picture(table, None, form, &name, Some(tag), draw)
        })
        .await
}

/// Friction factors from measured hook loads and torques
///
/// Fits the friction factor of each hole section that the points reach by least squares, with standard errors and the residual of every point, on the soft
/// string of this point. Nothing is stored.
#[utoipa::path(
    post,
    path = "/v1/sweeps/{id}/points/{n}/friction",
    tag = "points",
    operation_id = "fit_friction",
    params(PointPath),
    request_body = FrictionRequest,
    responses((status = 200, description = "The factors", body = FrictionFit), Problems)
)]
pub(crate) async fn fit(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    extract::Json(request): extract::Json<FrictionRequest>,
) -> Result<Json<FrictionFit>> {
    let point = point(&app, &id, n).await?;
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    Ok(Json(place.run(move |_: &mut Work| Ok(request.fit(&point.scenario)?)).await?.0))
}
