//! Table of a sweep, as data or picture.

use std::sync::Arc;

use ::drillsweep_chart as chart;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::judgement::LimitChanges;
use drillsweep_api::{ColumnList, DrillString, Signs};
use drillsweep_quantity::columns::CLASS;
use drillsweep_quantity::{Name, UnitChoice};
use drillsweep_store::WorkState;
use drillsweep_table::tables;
use indexmap::IndexSet;
use serde::Deserialize;

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{Answer, Form, PictureFormat};
use crate::answer::json::Json;
use crate::answer::stored::Stored;
use crate::answer::{recordings, records};
use crate::app::App;
use crate::openapi::answers::{Conditional, PictureResponse, Problems};
use crate::route::sweeps::points::TablePoints;

/// Query of the table of a sweep.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SweepTableQuery {
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
    /// Only these columns, separated by commas; of a picture, the columns that it shows.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>)]
    fields: Option<Vec<String>>,
    /// Changes of the service's limits by which `class` is judged: `COLUMN:VALUE` in the column's unit or with a unit, or `COLUMN:off`, separated by commas.
    #[serde(default, deserialize_with = "value::limits")]
    #[param(value_type = Option<String>)]
    limits: LimitChanges,
    /// Signs of `operation.weight_on_bit` and `operation.torque_on_bit`, also in `slice`: with `driller` compression, and torque that opposes clockwise
    /// rotation, are positive.
    #[serde(default)]
    #[param(inline)]
    signs: Signs,
    /// For a map: placement of the values of its parameters; absent means `even`.
    #[param(inline)]
    spacing: Option<MapSpacing>,
    /// For a picture: fixed parameters, each with one of its values, in its kept unit or with a unit, separated by commas:
    /// `mud.density:1200,operation.weight_on_bit:-50000`, `mud.density:10 ppg`. A map spans the first two of the others; further ones are fixed at their first
    /// value, which the picture states.
    #[serde(default, deserialize_with = "value::assignments")]
    #[param(value_type = Option<String>)]
    slice: Option<Vec<(String, f64)>>,
}

/// Placement of the values of a parameter on a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MapSpacing {
    /// Equal distances, regardless of the values.
    #[default]
    Even,
    /// Distances in proportion to the values.
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
/// The `class` of a point is the most severe that applies by the limits. Points without a result have a row with empty fields, and `state` and `error` as the reason. Verified points have the bias of each
/// statistic relative to the reference, such as `bias_orbit_radius_rms_49`; the attribute `warnings` reports biases beyond the promise of
/// the accuracy. A picture shows the columns in `fields` over the parameters that vary: lines over one, a map of the first column over two,
/// with diamonds at verified points; over more, a slice. Categorical columns, such as `state` and `stable`, have a colour for each value. A
/// column of a node is shown with its depth, if that is the same in all of the sweep.
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
    Query(SweepTableQuery { format, units, fields, limits, signs, spacing, slice }): Query<SweepTableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(format, units, &headers)?;
    let format = form.format;
    let limits = app.config.operating_limits.with(&limits);
    let spacing = spacing.unwrap_or_default();
    let slice = slice.unwrap_or_default();
    let Some(sweep) = app.store.sweep(&id).await? else { return Err(records::no_such_sweep(&id)) };
    // Every change of a point or a reference run raises the version.
    let key =
        Tag::of(&form, &("map", &id, sweep.version, &sweep.name, &fields, &limits, signs, spacing, &slice));
    let mut view = chart::SweepView { spacing: spacing.into(), slice, ..Default::default() };
    let (points, verified) = TablePoints::of(&app, &sweep).await?;
    let fields_of_places: Vec<String> = match format.is_picture() {
        true => fields.iter().flatten().filter(|name| has_place(name)).cloned().collect(),
        false => Vec::new(),
    };
    let first = match fields_of_places.is_empty() {
        true => None,
        false => statics_of_first(&app, &id).await?,
    };
    app.answer(format, key.as_str(), points.memory, move || {
        // A picture needs more than the requested columns.
        let (points, classes) = match fields.as_deref().filter(|_| !format.is_picture()) {
            Some(kept) => {
                let is_judged = kept.iter().any(|name| name == CLASS.name);
                points.selected(kept, is_judged.then_some(&limits))?
            }
            None => {
                let points = points.whole()?;
                let classes = points.classes(&limits);
                (Arc::unwrap_or_clone(points), classes)
            }
        };
        let parameters: IndexSet<String> = points.parameters().map(str::to_owned).collect();
        if let Some((statics, string)) = first
            && !parameters.iter().any(|name| moves_nodes(name))
        {
            // Without depths the picture is still useful.
            view.places =
                recordings::places_of_columns(&statics, &string, &fields_of_places).unwrap_or_default();
        }
        let mut table = signs.of_table(points.finish(Some(classes)));
        let findings = &verified.findings;
        if !findings.warnings.is_empty() {
            table = table.attribute("warnings", findings.warnings.clone());
        }
        let (fields, title) = (fields.as_deref(), sweep.name.as_deref().unwrap_or_default());
        Answer::of_table_or_picture(table, fields, form, &format!("sweep-{id}"), None, |table, units| {
            view.units = units.clone();
            chart::sweep(table, &parameters, fields, findings, title, &view)
        })
    })
    .await
}

/// True of a column of one node.
fn has_place(field: &str) -> bool {
    Name::parse(field).is_some_and(|name| name.place.is_some())
}

/// Equilibrium and string of the first point that has a result, if it kept one.
async fn statics_of_first(app: &App, id: &str) -> Result<Option<(Stored, DrillString)>> {
    let first = app.store.points(id, &[WorkState::Done], 0, 1).await?;
    let Some(n) = first.first().and_then(|point| u32::try_from(point.ordinal).ok()) else { return Ok(None) };
    let statics = recordings::stored_if_any(&app.store, id, n, tables::STATICS.name).await?;
    let point = app.store.point(id, n.into()).await?;
    let string = point.map(|point| records::scenario(&point)).transpose()?.map(|scenario| scenario.string);
    Ok(statics.zip(string))
}

/// True if a parameter may move the nodes of the mesh, which follows from the string and its wall.
fn moves_nodes(parameter: &str) -> bool {
    let of_what = parameter.split(['.', '[']).next();
    of_what.is_some_and(|of_what| ["string", "mesh", "contact"].contains(&of_what))
}

/// Columns of the table of a sweep, without values
///
/// Columns in order, with kinds and units, of the present states of the points. `GET /v1/quantities` defines the names.
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
    let (points, _) = TablePoints::of(&app, &sweep).await?;
    let place = app.view(points.memory).await?;
    place
        .run(move || {
            let (points, _) = points.selected(&[], None)?;
            let columns = ColumnList::of(&points.finish(Some(Vec::new())));
            app.columns.put(id, sweep.version, columns.clone());
            Ok(Json(columns))
        })
        .await
}
