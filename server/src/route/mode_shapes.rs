//! Shapes of the modes of a point's string.

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::ProblemDetails;
use drillsweep_api::analysis::HIGHEST_MODE_HZ;
use drillsweep_api::mode_shapes::{ModeKind, ShapesRequest};
use drillsweep_chart::mode_shapes;
use drillsweep_quantity::UnitChoice;
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

/// Query of the shapes of modes.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShapesQuery {
    /// Modes from this frequency \[Hz\]; 0 unless given.
    #[serde(default, deserialize_with = "value::number")]
    #[param(minimum = 0.0)]
    from_hz: Option<f64>,
    /// Modes up to this frequency \[Hz\]; 20 unless given.
    #[serde(default, deserialize_with = "value::number")]
    #[param(exclusive_minimum = 0.0, maximum = 50.0)]
    to_hz: Option<f64>,
    /// Component with most of the kinetic energy, by its name, or its kind with its number from the top.
    component: Option<String>,
    /// Main motion.
    #[param(inline)]
    kind: Option<ModeKind>,
    /// Measured depth \[m\] from which the largest kinetic energy lies.
    #[serde(default, deserialize_with = "value::number")]
    from_depth: Option<f64>,
    /// Measured depth \[m\] to which the largest kinetic energy lies.
    #[serde(default, deserialize_with = "value::number")]
    to_depth: Option<f64>,
    /// Format of the table, or of a picture of the first eight modes; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by commas. Absent means the kept
    /// units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field")]
    units: Option<UnitChoice>,
}

impl ShapesQuery {
    fn request(&self) -> Result<ShapesRequest> {
        let band_hz = [self.from_hz.unwrap_or(0.0), self.to_hz.unwrap_or(20.0)];
        if !(0.0..band_hz[1]).contains(&band_hz[0]) || band_hz[1] > HIGHEST_MODE_HZ {
            let detail = format!("must be 0 <= from_hz < to_hz, and at most {HIGHEST_MODE_HZ}");
            return Err(ProblemDetails::invalid_parameter("to_hz", None, detail).into());
        }
        let depths = (self.from_depth.is_some() || self.to_depth.is_some())
            .then(|| [self.from_depth.unwrap_or(0.0), self.to_depth.unwrap_or(f64::INFINITY)]);
        Ok(ShapesRequest { band_hz, component: self.component.clone(), kind: self.kind, depths })
    }
}

/// Shapes of a point's modes along the string
///
/// Lateral, axial and torsional motion of every node in each mode of a band of frequencies, relative to the largest of the string: a row for each mode and node,
/// of the first 100 modes. They may be chosen by the component or the depth with most of the kinetic energy and by their main motion.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/mode_shapes",
    tag = "points",
    operation_id = "get_mode_shapes",
    params(PointPath, ShapesQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<ShapesQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    /// Bytes of a row, in memory and in writing.
    const OF_ROW: u64 = 400;
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let request = query.request()?;
    let point = point(&app, &id, n).await?;
    let tag = Tag::of(&form, &("mode_shapes", &point.key, &query));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.expansions.enter(caller.budget(), MEMORY_OF_EQUILIBRIUM).await?;
    let (table, _memory): (Table, _) =
        place.run(move |_: &mut Work| Ok(request.table(&point.scenario)?)).await?;
    let place = app.view(form.format.memory(OF_ROW * table.rows() as u64)).await?;
    place
        .answer(move || {
            let draw = |table: &Table, units: &UnitChoice| mode_shapes(table, "Shapes of modes", units);
            Answer::of_table_or_picture(table, None, form, &file_name(&id, n, "mode-shapes"), Some(tag), draw)
        })
        .await
}
