//! The points of a sweep.

use axum::extract::State;
use axum::response::{IntoResponse, Response};
use drillsweep_api::{
    FailureClass, FailureList, PointDetail, PointList, PointRow, PointState, SelectedPointList,
};
use drillsweep_store::{FailureFilter, FailurePlace};
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::answer::error::{Error, Result};
use crate::answer::extract::{self, Path, Query, value};
use crate::answer::json::Json;
use crate::answer::records;
use crate::app::App;
use crate::openapi::answers::{PointPageResponse, Problems};
use crate::route::results::PointPath;

/// Which points are listed.
#[derive(Deserialize, utoipa::IntoParams)]
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
    #[param(min_length = 1)]
    cursor: Option<String>,
    /// Only these fields of each point, separated by commas.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>, example = "ordinal,state")]
    fields: Option<Vec<String>>,
}

/// The points of a sweep, in order
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points",
    tag = "points",
    operation_id = "list_points",
    params(("id" = String, Path, description = "Identifier of the sweep"), ListQuery),
    responses(PointPageResponse, Problems)
)]
pub(crate) async fn list(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(query): Query<ListQuery>,
) -> Result<Response> {
    let limit = extract::page_size(query.limit)?;
    if let Some(unknown) =
        query.fields.iter().flatten().find(|name| !PointRow::FIELDS.contains(&name.as_str()))
    {
        let detail = format!("must be some of {}", PointRow::FIELDS.join(", "));
        return Err(Error::parameter("fields", Some(unknown), detail));
    }
    let after =
        match &query.cursor {
            None => 0,
            Some(cursor) => cursor.parse().ok().filter(|ordinal| *ordinal > 0).ok_or_else(|| {
                Error::parameter("cursor", Some(cursor), "must be `next` of the page before")
            })?,
        };
    if app.store.sweep_version(&id).await?.is_none() {
        return Err(records::no_such_sweep(&id));
    }
    let states = query.state.map_or_else(Vec::new, records::work_states);
    // One more than asked for shows whether there is a next page.
    let mut records = app.store.points(&id, &states, after, i64::from(limit) + 1).await?;
    let is_last = records.len() <= limit as usize;
    records.truncate(limit as usize);
    let next = records.last().filter(|_| !is_last).map(|record| record.ordinal.to_string());
    let points: Vec<PointRow> =
        records.iter().map(|record| records::point_row(&id, record)).collect::<Result<_>>()?;
    match query.fields {
        None => Ok(Json(PointList { points, next }).into_response()),
        Some(fields) => {
            let points = points.iter().map(|row| select(row, &fields)).collect::<Result<_>>()?;
            Ok(Json(SelectedPointList { points, next }).into_response())
        }
    }
}

fn select(row: &PointRow, fields: &[String]) -> Result<Map<String, Value>> {
    let mut whole = match serde_json::to_value(row) {
        Ok(Value::Object(fields)) => fields,
        Ok(_) => Map::new(),
        Err(error) => return Err(Error::internal(&error)),
    };
    Ok(fields.iter().filter_map(|name| Some((name.clone(), whole.remove(name)?))).collect())
}

/// Which failures are listed.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct FailuresQuery {
    /// Only points of sweeps of this owner.
    owner: Option<String>,
    /// Only points that failed in this way.
    #[param(inline)]
    class: Option<FailureClass>,
    /// Entries in a page; absent means 50.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1, maximum = 500)]
    limit: Option<u32>,
    /// `next` of the page before.
    #[param(min_length = 1)]
    cursor: Option<String>,
}

/// The failed points of all sweeps, the latest first
///
/// Points that failed for good, or that brought down three workers (class `crash`). `POST /v1/sweeps/{id}/retry` queues those
/// of a sweep again. Reference runs that only verify a point are at `GET /v1/sweeps/{id}/verification`.
#[utoipa::path(
    get,
    path = "/v1/failures",
    tag = "points",
    operation_id = "list_failures",
    params(FailuresQuery),
    responses((status = 200, description = "A page of points", body = FailureList), Problems)
)]
pub(crate) async fn failures(
    State(app): State<App>,
    Query(query): Query<FailuresQuery>,
) -> Result<Json<FailureList>> {
    let limit = extract::page_size(query.limit)?;
    let after = query.cursor.as_deref().map(failure_place).transpose()?;
    let filter =
        FailureFilter { owner: query.owner.as_deref(), class: query.class.map(FailureClass::as_str) };
    // One more than asked for shows whether there is a next page.
    let mut records = app.store.failures(&filter, after.as_ref(), i64::from(limit) + 1).await?;
    let is_last = records.len() <= limit as usize;
    records.truncate(limit as usize);
    let next = records.last().filter(|_| !is_last).map(|record| {
        let FailurePlace { at, sweep_id, ordinal } = record.place();
        format!("{at}.{ordinal}.{sweep_id}")
    });
    let failures = records.iter().map(records::failure).collect::<Result<_>>()?;
    Ok(Json(FailureList { failures, next }))
}

fn failure_place(cursor: &str) -> Result<FailurePlace> {
    let mut parts = cursor.splitn(3, '.');
    let mut number = || parts.next().and_then(|part| part.parse().ok());
    let (at, ordinal) = (number(), number());
    match (at, ordinal, parts.next()) {
        (Some(at), Some(ordinal), Some(sweep)) => {
            Ok(FailurePlace { at, sweep_id: sweep.to_owned(), ordinal })
        }
        _ => Err(Error::parameter("cursor", Some(cursor), "must be `next` of the page before")),
    }
}

/// One point: state, parameters, summary, provenance
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}",
    tag = "points",
    operation_id = "get_point",
    params(PointPath),
    responses((status = 200, description = "The point in its present state", body = PointDetail), Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
) -> Result<Json<PointDetail>> {
    let Some(record) = app.store.point(&id, n.into()).await? else {
        return Err(records::no_such_point(&app.store, &id, n).await?);
    };
    let artifacts = app.store.artifacts(&record.work_key).await?;
    let tables = artifacts
        .into_iter()
        .filter(|artifact| artifact.expired.is_none())
        .map(|artifact| artifact.name)
        .collect();
    Ok(Json(records::point_detail(&id, &record, tables)?))
}
