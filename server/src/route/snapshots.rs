//! Snapshots of the whole string.

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::view::history;
use drillsweep_quantity::UnitChoice;
use drillsweep_table::tables;
use serde::Deserialize;

use crate::answer::error::{Error, Result};
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{self, Answer, Form, TableFormat};
use crate::answer::recordings;
use crate::answer::snapshots::Snapshots;
use crate::app::App;
use crate::openapi::answers::{Conditional, Problems, TableResponse};
use crate::route::results::{PointPath, check_window, file_name, whole_file};

/// Query of snapshots.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SnapshotsQuery {
    /// Start of the window \[s\], included.
    #[serde(default, deserialize_with = "value::number")]
    from: Option<f64>,
    /// End of the window \[s\], not included.
    #[serde(default, deserialize_with = "value::number")]
    to: Option<f64>,
    /// Only this node, 1 at the top; absent means all.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    node: Option<u32>,
    /// Largest number of snapshots; every k-th one is kept, with all its nodes. Absent means all.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    max_frames: Option<u32>,
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

impl SnapshotsQuery {
    fn is_whole(&self) -> bool {
        self.node.is_none()
            && self.from.is_none()
            && self.to.is_none()
            && self.max_frames.is_none()
            && self.fields.is_none()
    }
}

/// Snapshots of the whole string in motion
///
/// A row a node, from the top, snapshot after snapshot; kept if the scenario requests them (`recording.snapshots`). Motions that were not
/// solved for have no columns. Attributes: `nodes`, rows of a snapshot (1 for one `node`); `snapshots`, their number in the window before
/// thinning by `max_frames`; `first`, time of the first one \[s\]; `interval` between those returned \[s\].
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/snapshots",
    tag = "points",
    operation_id = "get_snapshots",
    params(PointPath, SnapshotsQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<SnapshotsQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    check_window(query.from, query.to)?;
    let file_name = file_name(&id, n, tables::SNAPSHOTS.name);
    let stored = recordings::stored(&app.store, &id, n, tables::SNAPSHOTS.name).await?;
    if form.is_stored() && query.is_whole() {
        return whole_file(&app, stored, &file_name, &headers).await;
    }
    let statics = recordings::stored(&app.store, &id, n, tables::STATICS.name).await?;
    let snapshots = Snapshots::new(stored, &statics)?;
    let node = query.node.map(|node| node as usize);
    if let Some(node) = node.filter(|node| *node > snapshots.nodes()) {
        let detail = format!("the string has the nodes 1 to {}", snapshots.nodes());
        return Err(Error::parameter("node", Some(&node.to_string()), detail));
    }
    let tag = Tag::of(&form, &(snapshots.stored().blob(), snapshots.nodes(), &query));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let place = app.view(form.format.memory(snapshots.stored().memory().await?)).await?;
    place
        .answer(move || {
            let table = snapshots.stored().open()?;
            let times = snapshots.times(&table)?;
            let frames = times.window(query.from, query.to);
            if frames.is_empty() && times.count > 0 {
                let (name, end) = match query.to.filter(|to| *to <= times.first) {
                    Some(to) => ("to", Some(to)),
                    None => ("from", query.from),
                };
                let got = end.map(|end| end.to_string());
                let valid = format!("the snapshots begin at {} s and end at {} s", times.first, times.last);
                return Err(Error::parameter(name, got.as_deref(), valid));
            }
            let stride = history::stride(frames.len(), query.max_frames.map(|frames| frames as usize));
            let layout = table.layout().clone();
            let layout = layout
                .attribute("snapshots", frames.len())
                .attribute("nodes", if node.is_some() { 1 } else { snapshots.nodes() })
                .attribute("first", times.time(frames.start))
                .attribute("interval", times.interval() * stride as f64);
            let layout = format::select(layout, query.fields.as_deref())?;
            let part = snapshots.part(table, layout, &frames, (node, stride))?;
            Ok(Answer::of_part(snapshots.into_stored(), part, form, &file_name, tag))
        })
        .await
}
