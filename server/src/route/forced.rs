//! Forced response of a point's string over the speed of rotation.

use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::ProblemDetails;
use drillsweep_api::forced::{Excitation, ForcedRequest};
use drillsweep_chart::forced_response;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::FORCED_DISPLACEMENT;
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

/// Query of a forced response.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ForcedQuery {
    /// Speeds of rotation \[rpm\]: numbers separated by commas, or `FROM:TO:COUNT`, 500 at most; absent means 40 to 240 in steps of 1.
    #[serde(default, deserialize_with = "value::list")]
    #[param(value_type = Option<String>, example = "60:180:121")]
    speeds: Vec<f64>,
    /// Measured depth \[m\] of a lateral force that turns with the string; absent means that the unbalance of the scenario excites it.
    #[serde(default, deserialize_with = "value::number")]
    depth: Option<f64>,
    /// Amplitude of the force \[N\]; 1000 unless given.
    #[serde(default, deserialize_with = "value::number")]
    force: Option<f64>,
    /// Cycles of the force in a revolution, such as the number of blades; 1 unless given.
    #[serde(default, deserialize_with = "value::number")]
    per_revolution: Option<f64>,
    /// Format of the table, or of a picture of `field`; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by commas. Absent means the kept
    /// units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,forced_displacement:mm")]
    units: Option<UnitChoice>,
    /// Column that a picture shows, forced displacement unless given.
    field: Option<String>,
}

impl ForcedQuery {
    fn request(&self) -> Result<ForcedRequest> {
        let excitation = match self.depth {
            Some(measured_depth) => Excitation::Turning {
                measured_depth,
                amplitude: self.force.unwrap_or(1000.0),
                per_revolution: self.per_revolution.unwrap_or(1.0),
            },
            None if self.force.is_some() || self.per_revolution.is_some() => {
                let detail = "a force needs its measured depth in m; without `depth` the unbalance of the scenario excites the string";
                return Err(ProblemDetails::invalid_parameter("depth", None, detail).into());
            }
            None => Excitation::Unbalance,
        };
        Ok(ForcedRequest { speeds: self.speeds.clone(), excitation })
    }
}

/// Forced response of a point's string over the speed of rotation
///
/// Largest displacement, acceleration, side force and bending stress of each component, from the linear equations about the equilibrium of the scenario, excited by its
/// unbalance or by a lateral force that turns with the string: a row for each component and speed. Peaks are critical speeds. Contacts that are closed in the
/// equilibrium stay closed.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/forced_response",
    tag = "points",
    operation_id = "get_forced_response",
    params(PointPath, ForcedQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<ForcedQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    /// Bytes of a row, in memory and in writing.
    const OF_ROW: u64 = 512;
    /// Processor time of all speeds, as of 500 on a whole well at some 50 ms each.
    const OF_SPEEDS: Duration = Duration::from_secs(25);
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let request = query.request()?;
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(&form, &("forced_response", &point.key, &query));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let (table, _memory): (Table, _) = place
        .run(move |work: &mut Work| {
            work.allow(OF_SPEEDS);
            Ok(request.table(&point.scenario, &|| work.check())?)
        })
        .await?;
    let place = app.view(form.format.memory(OF_ROW * table.rows() as u64)).await?;
    place
        .answer(move || {
            let column = query.field.as_deref().unwrap_or(FORCED_DISPLACEMENT.name);
            let draw =
                |table: &Table, units: &UnitChoice| forced_response(table, column, "Forced response", units);
            let name = file_name(&id, n, "forced-response");
            Answer::of_table_or_picture(table, None, form, &name, Some(tag), draw)
        })
        .await
}
