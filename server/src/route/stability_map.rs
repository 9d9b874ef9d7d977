//! Stability map of a point's bit and drive.

use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::stability_map::{AxialTop, StabilityRequest, table};
use drillsweep_chart::stability_map;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::GROWING_MOTIONS;
use drillsweep_table::Table;
use serde::Deserialize;

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{Answer, Form, PictureFormat};
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::{Conditional, PictureResponse, Problems};
use crate::route::analysis::{MEMORY_OF_EQUILIBRIUM, point};
use crate::route::results::{PointPath, file_name};

/// Query of a stability map.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct StabilityQuery {
    /// Speeds of rotation \[rpm\]: numbers separated by commas, or `FROM:TO:COUNT`; absent means 60 to 200 in steps of 2.
    #[serde(default, deserialize_with = "value::list")]
    #[param(value_type = Option<String>, example = "60:200:71")]
    speeds: Vec<f64>,
    /// Weights on bit \[N\], positive: compression; numbers separated by commas, or `FROM:TO:COUNT`; absent means that of the scenario. Speeds times weights are 10000 at
    /// most.
    #[serde(default, deserialize_with = "value::list")]
    #[param(value_type = Option<String>, example = "2e4:2e5:19")]
    weights: Vec<f64>,
    /// Axial condition of the top; `advance` unless given.
    #[param(inline)]
    axial_top: Option<AxialTop>,
    /// Format of the table, or of a picture of `field`; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by commas. Absent means the kept
    /// units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,stability_weight:kN")]
    units: Option<UnitChoice>,
    /// Column that a picture shows, growing motions unless given.
    field: Option<String>,
}

/// Stability map of a point's bit and drive
///
/// Number of motions of bit and string that grow, growth and frequency of the fastest, from the linear equations with the law of the point's bit: a row for each
/// rotation speed and weight on bit. The place of the string is the equilibrium of the point. The bit needs a law other than `constant`.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/stability_map",
    tag = "points",
    operation_id = "get_stability_map",
    params(PointPath, StabilityQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<StabilityQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    /// Bytes of a row, in memory and in writing.
    const OF_ROW: u64 = 300;
    /// Processor time of all points, as of 10,000 at 1 ms each.
    const OF_POINTS: Duration = Duration::from_secs(15);
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let request = StabilityRequest {
        speeds: query.speeds.clone(),
        weights: query.weights.clone(),
        axial_top: query.axial_top.unwrap_or_default(),
    };
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(&form, &("stability_map", &point.key, &query));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let (table, _memory): (Table, _) = place
        .run(move |work: &mut Work| {
            work.allow(OF_POINTS);
            Ok(table(&request.map(&point.scenario, &|| work.check())?.points))
        })
        .await?;
    let place = app.view(form.format.memory(OF_ROW * table.rows() as u64)).await?;
    place
        .answer(move || {
            let column = query.field.as_deref().unwrap_or(GROWING_MOTIONS.name);
            let draw =
                |table: &Table, units: &UnitChoice| stability_map(table, column, "Stability map", units);
            let name = file_name(&id, n, "stability-map");
            Answer::of_table_or_picture(table, None, form, &name, Some(tag), draw)
        })
        .await
}
