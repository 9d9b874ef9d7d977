//! Operating window of a sweep.

use ::drillsweep_chart as chart;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::Signs;
use drillsweep_api::judgement::LimitChanges;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::CLASS;
use serde::Deserialize;

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{Answer, Form, PictureFormat};
use crate::answer::records;
use crate::app::App;
use crate::openapi::answers::{Conditional, PictureResponse, Problems};
use crate::route::sweeps::points::TablePoints;

/// Query of an operating window.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct WindowQuery {
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
    /// Changes of the service's limits: `COLUMN:VALUE` in the column's unit or with a unit, or `COLUMN:off`, separated by commas.
    #[serde(default, deserialize_with = "value::limits")]
    #[param(value_type = Option<String>, example = "bit_stick_slip_severity:0.5,largest_side_force:5 klbf")]
    limits: LimitChanges,
    /// Signs of `operation.weight_on_bit` and `operation.torque_on_bit`, also in `slice`: with `driller` compression, and torque that opposes clockwise
    /// rotation, are positive.
    #[serde(default)]
    #[param(inline)]
    signs: Signs,
    /// For a picture: fixed parameters, each with one of its values, in its kept unit or with a unit, separated by commas.
    #[serde(default, deserialize_with = "value::assignments")]
    #[param(value_type = Option<String>)]
    slice: Option<Vec<(String, f64)>>,
}

/// Operating window: the class of each point over the parameters of the sweep
///
/// A row a point: `ordinal`, parameters, `class`, `class_uncertain` with the reason if the statistics have not settled or the estimated error
/// reaches across a limit, and the finding in words. Limits apply without a new run. The attributes hold the limits and the number of points of
/// each class. A picture is the map of the classes.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/window",
    tag = "sweeps",
    operation_id = "get_window",
    params(("id" = String, Path, description = "Identifier of the sweep"), WindowQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn window(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(WindowQuery { format, units, limits, signs, slice }): Query<WindowQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(format, units, &headers)?;
    let format = form.format;
    let Some(sweep) = app.store.sweep(&id).await? else { return Err(records::no_such_sweep(&id)) };
    let limits = app.config.operating_limits.with(&limits);
    let slice = slice.unwrap_or_default();
    let key = Tag::of(&form, &("window", &id, sweep.version, &sweep.name, &limits, signs, &slice));
    let (points, verified) = TablePoints::of(&app, &sweep).await?;
    app.answer(format, key.as_str(), points.memory, move || {
        let window = points.window(limits)?;
        let parameters = window.parameters().map(str::to_owned).collect();
        let table = signs.of_table(window.finish());
        let fields = format.is_picture().then(|| vec![CLASS.name.to_owned()]);
        let (fields, title) = (fields.as_deref(), sweep.name.as_deref().unwrap_or_default());
        Answer::of_table_or_picture(table, fields, form, &format!("window-{id}"), None, |table, units| {
            let view = chart::SweepView { slice, units: units.clone(), ..Default::default() };
            chart::sweep(table, &parameters, fields, &verified.findings, title, &view)
        })
    })
    .await
}
