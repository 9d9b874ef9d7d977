//! List of sweeps.

use axum::extract::State;
use drillsweep_api::{Sweep, SweepList, SweepState};
use drillsweep_store::SweepFilter;
use serde::Deserialize;

use crate::answer::error::{Error, Result};
use crate::answer::etag::Hashed;
use crate::answer::extract::{self, Query, value};
use crate::answer::records;
use crate::app::App;
use crate::openapi::answers::{Conditional, Problems};
use crate::route::waiting::note_waiting;

/// Query of the list of sweeps.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ListQuery {
    /// Entries in a page; absent means 50.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1, maximum = 500)]
    limit: Option<u32>,
    /// `next` of the page before.
    #[param(min_length = 1)]
    cursor: Option<String>,
    /// Only sweeps of this owner.
    owner: Option<String>,
    /// Only sweeps in this state.
    #[param(inline)]
    state: Option<SweepState>,
    /// Only sweeps with this text in their name, regardless of case.
    name: Option<String>,
    /// Only sweeps with this tag.
    tag: Option<String>,
    /// Only sweeps whose identifier has this prefix.
    id: Option<String>,
}

/// List sweeps, newest first
///
/// Repeat the `ETag` as `If-None-Match` to poll: the answer is 304 while no listed sweep has changed.
#[utoipa::path(
    get,
    path = "/v1/sweeps",
    tag = "sweeps",
    operation_id = "list_sweeps",
    params(ListQuery, Conditional),
    responses(
        (status = 200, description = "A page of sweeps", body = SweepList, headers(("ETag" = String))),
        (status = 304, description = "The copy is current"),
        Problems
    )
)]
pub(crate) async fn list(
    State(app): State<App>,
    Query(query): Query<ListQuery>,
) -> Result<Hashed<SweepList>> {
    let limit = extract::page_size(query.limit)?;
    if let Some(cursor) = query.cursor.as_deref().filter(|cursor| uuid::Uuid::parse_str(cursor).is_err()) {
        return Err(Error::parameter("cursor", Some(cursor), "must be `next` of the page before"));
    }
    // One more than requested shows if there is a next page.
    let filter = SweepFilter {
        owner: query.owner.as_deref(),
        state: query.state.map(SweepState::as_str),
        name: query.name.as_deref(),
        tag: query.tag.as_deref(),
        id: query.id.as_deref(),
    };
    let mut records = app.store.sweeps(&filter, query.cursor.as_deref(), i64::from(limit) + 1).await?;
    let is_last = records.len() <= limit as usize;
    records.truncate(limit as usize);
    let next = records.last().filter(|_| !is_last).map(|record| record.id.clone());
    let mut sweeps: Vec<Sweep> = records.iter().map(records::sweep).collect::<Result<_>>()?;
    note_waiting(&app, &mut sweeps).await?;
    Ok(Hashed(SweepList { sweeps, next }))
}
