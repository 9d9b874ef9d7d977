//! The points of a sweep.

use axum::Json;
use axum::extract::State;
use drillsweep_api::{PointDetail, PointList, PointState};
use serde::Deserialize;
use utoipa::IntoParams;

use crate::app::App;
use crate::convert;
use crate::error::{Error, Result};
use crate::extract::{self, Path, Query, value};
use crate::openapi::Problems;
use crate::results::PointPath;

/// Which points are listed.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ListQuery {
    /// Only points in this state.
    #[param(inline)]
    state: Option<PointState>,
    /// Entries in a page; absent means 50.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1, maximum = 500)]
    limit: Option<u32>,
    /// `next` of the page before.
    cursor: Option<String>,
}

/// The points of a sweep, in order
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points",
    tag = "points",
    operation_id = "list_points",
    params(("id" = String, Path, description = "Identifier of the sweep"), ListQuery),
    responses((status = 200, description = "A page of points", body = PointList), Problems)
)]
pub(crate) async fn list(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(query): Query<ListQuery>,
) -> Result<Json<PointList>> {
    let limit = extract::page_size(query.limit)?;
    let after = match &query.cursor {
        None => 0,
        Some(cursor) => cursor
            .parse()
            .map_err(|_| Error::parameter("cursor", Some(cursor), "must be `next` of the page before"))?,
    };
    if app.store.sweep_version(&id).await?.is_none() {
        return Err(convert::no_such_sweep(&id));
    }
    let states = query.state.map_or(&[][..], convert::work_states);
    // One more than asked for tells whether there is a next page.
    let mut records = app.store.points(&id, states, after, i64::from(limit) + 1).await?;
    let is_last = records.len() <= limit as usize;
    records.truncate(limit as usize);
    let next = records.last().filter(|_| !is_last).map(|record| record.ordinal.to_string());
    let points = records.iter().map(|record| convert::point_row(&id, record)).collect::<Result<_>>()?;
    Ok(Json(PointList { points, next }))
}

/// One point: state, parameters, summary, provenance
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}",
    tag = "points",
    operation_id = "get_point",
    params(PointPath),
    responses((status = 200, description = "The point as it stands", body = PointDetail), Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
) -> Result<Json<PointDetail>> {
    let Some(record) = app.store.point(&id, n.into()).await? else {
        return Err(convert::no_such_point(&app.store, &id, n).await?);
    };
    let artifacts = app.store.artifacts(&record.work_key).await?;
    let tables = artifacts.into_iter().map(|artifact| artifact.name).collect();
    Ok(Json(convert::point_detail(&id, &record, tables)?))
}
