//! Statistics of the orbits of a window.

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::view::node::Choice;
use drillsweep_api::view::statistics::StatisticsTable;
use drillsweep_quantity::UnitChoice;
use drillsweep_table::tables::STATISTICS;
use serde::Deserialize;

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{Answer, Form, TableFormat};
use crate::answer::recordings::{Recording, mark_cut};
use crate::app::App;
use crate::openapi::answers::{Conditional, Problems, TableResponse};
use crate::route::results::{PointPath, check_window, file_name};

/// Query of statistics.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct StatisticsQuery {
    /// A recorded node, 1 at the top; absent, like `depth`, means all of them.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    node: Option<u32>,
    /// Measured depth \[m\] of a recorded node, to within half an element.
    #[serde(default, deserialize_with = "value::number")]
    depth: Option<f64>,
    /// Take the recorded node nearest to `depth`, however far.
    #[serde(default, deserialize_with = "value::truth")]
    nearest: bool,
    /// Start of the window \[s\], included.
    #[serde(default, deserialize_with = "value::number")]
    from: Option<f64>,
    /// End of the window \[s\], not included.
    #[serde(default, deserialize_with = "value::number")]
    to: Option<f64>,
    /// Format of the table; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<TableFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
    /// Only these columns, separated by commas.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>)]
    fields: Option<Vec<String>>,
}

/// Statistics of orbits over a window
///
/// A row a recorded node, from all samples of the half-open window; the attribute `samples` is their number.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/statistics",
    tag = "points",
    operation_id = "get_statistics",
    params(PointPath, StatisticsQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<StatisticsQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    check_window(query.from, query.to)?;
    let choice = match (query.node, query.depth) {
        (None, None) if !query.nearest => None,
        (node, depth) => Some(Choice::from_parameters(node, depth, query.nearest)?),
    };
    let recording = Recording::load(&app.store, &id, n).await?;
    let tag = Tag::of(&form, &(recording.blobs(), &query));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.view(form.format.memory(recording.memory_of_orbit().await?)).await?;
    place
        .answer(move || {
            let choices = match choice {
                Some(choice) => vec![choice],
                None => {
                    let nodes = recording.nodes(recording.history.open()?.layout())?;
                    nodes.into_iter().map(|recorded| Choice::Node(recorded.node)).collect()
                }
            };
            let mut table = StatisticsTable::default();
            let mut cut_at = None;
            for choice in choices {
                let motion = recording.motion_of(choice, query.from, query.to)?;
                cut_at = motion.cut_at;
                table.push(motion.node, motion.measured_depth, &motion.columns())?;
            }
            let file_name = file_name(&id, n, STATISTICS.name);
            let table = mark_cut(table.finish(), cut_at);
            Answer::of_table(table, query.fields.as_deref(), form, &file_name, Some(tag))
        })
        .await
}
