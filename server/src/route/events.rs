//! Stream of the events of a sweep (WHATWG HTML section 9.2, server-sent events).

use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;

use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{PointEvent, Sweep};
use drillsweep_store::Changes;
use serde::Deserialize;
use tokio::time::Instant;

use crate::answer::error::{Error, Result};
use crate::answer::extract::{Path, Query, value};
use crate::answer::records;
use crate::app::App;
use crate::app::shares::Share;
use crate::guard::caller::Caller;
use crate::openapi::answers::Problems;
use crate::route::sweeps::{PROGRESS_INTERVAL, state};

const LAST_EVENT_ID: &str = "last-event-id";

/// Number of events read from the store at once.
const PAGE: i64 = 500;

/// Pause of a client before it reconnects.
const RETRY: Duration = Duration::from_secs(2);

/// Query of a stream.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct EventsQuery {
    /// Replaces the header `Last-Event-ID` for clients that cannot set headers; the header has precedence.
    #[serde(default, deserialize_with = "value::whole")]
    after: Option<u64>,
}

/// Follow a sweep: a stream of events
///
/// Events `point` (data: `PointEvent`) report changed states of points and of reference runs; events `sweep` (data: `Sweep`, without its
/// request) the sweep as a whole: at the beginning, after each batch of changes, and every two seconds during progress. Without
/// `Last-Event-ID` the stream begins now; with it, after that event; with 0, at the first event that is kept. It ends with the event
/// `sweep` in which everything is final, whose id is above that of the last `point`. A client that reconnects after that is answered 204,
/// after which a browser's EventSource stops.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/events",
    tag = "sweeps",
    operation_id = "follow_sweep",
    params(
        ("id" = String, Path, description = "Identifier of the sweep"),
        EventsQuery,
        ("Last-Event-ID" = Option<u64>, Header, description = "`id` of the last event that was seen."),
    ),
    responses(
        (status = 200, description = "The stream", body = String, content_type = "text/event-stream"),
        (status = 204, description = "There are no further events"),
        Problems
    )
)]
pub(crate) async fn follow(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    Query(query): Query<EventsQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let after = last_seen(&headers, query.after)?;
    let Some(version) = app.store.sweep_version(&id).await? else { return Err(records::no_such_sweep(&id)) };
    let sequence = after.unwrap_or(version);
    // A finished sweep's version is above its last event: a client that has seen only that event still gets the end.
    if sequence >= version
        && after.is_some()
        && state(&app, &id).await?.finished.is_some()
        && app.store.events(&id, sequence, 1).await?.is_empty()
    {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let permit = app.streams.take(caller.budget())?;
    let changes = app.store.sweep_changes().await;
    let follower = Follower {
        app,
        changes,
        id,
        sequence,
        seen: None,
        version: None,
        pending: VecDeque::new(),
        has_ended: false,
        _permit: permit,
    };
    let stream = futures::stream::unfold(follower, Follower::next);
    Ok(Sse::new(stream).keep_alive(KeepAlive::default()).into_response())
}

/// `id` of the last event that a client has seen, from the header or else the query.
fn last_seen(headers: &HeaderMap, after: Option<u64>) -> Result<Option<i64>> {
    let after = match headers.get(LAST_EVENT_ID) {
        None => after,
        Some(value) => {
            let text = value.to_str().unwrap_or_default();
            let number = text.parse().map_err(|_| {
                Error::parameter("Last-Event-ID", Some(text), "must be the `id` of an event: a whole number")
            })?;
            Some(number)
        }
    };
    Ok(after.map(|after: u64| i64::try_from(after).unwrap_or(i64::MAX)))
}

/// State of one stream. It holds nothing of the store between two reads, and reads further events when the client has taken the last ones,
/// so that a slow client costs its place alone.
struct Follower {
    app: App,
    changes: Changes,
    id: String,
    /// Number of the last event sent.
    sequence: i64,
    /// The sweep as last sent, and the time of its reading.
    seen: Option<(Sweep, Instant)>,
    version: Option<i64>,
    pending: VecDeque<Event>,
    has_ended: bool,
    _permit: Share,
}

impl Follower {
    async fn next(mut self) -> Option<(std::result::Result<Event, Infallible>, Self)> {
        let mut stopping = self.app.stopping.clone();
        loop {
            if *stopping.borrow() {
                return None;
            }
            if let Some(event) = self.pending.pop_front() {
                return Some((Ok(event), self));
            }
            if self.has_ended {
                return None;
            }
            if let Err(error) = self.look().await {
                tracing::warn!(
                    ?error,
                    sweep = self.id,
                    "an event stream ends early; its client may reconnect"
                );
                return None;
            }
            if self.pending.is_empty() && !self.has_ended {
                tokio::select! {
                    () = self.changes.wait(self.app.config.poll_interval) => {}
                    // An error means that the service has ended.
                    _ = stopping.wait_for(|stopping| *stopping) => return None,
                }
            }
        }
    }

    /// Reads changes since the last call.
    async fn look(&mut self) -> Result<()> {
        let Some(version) = self.app.store.sweep_version(&self.id).await? else {
            // The sweep was deleted.
            self.has_ended = true;
            return Ok(());
        };
        let is_stale = |(_, read): &(Sweep, Instant)| read.elapsed() >= PROGRESS_INTERVAL;
        if self.version == Some(version) && !self.seen.as_ref().is_none_or(is_stale) {
            return Ok(());
        }
        let events = self.app.store.events(&self.id, self.sequence, PAGE).await?;
        for event in &events {
            self.sequence = event.seq;
            let data = PointEvent {
                ordinals: event.ordinals.clone(),
                verifies: event.verifies.clone(),
                state: records::point_state(event.state),
                at: records::timestamp(event.at)?,
            };
            self.push("point", &data)?;
        }
        if events.len() as i64 == PAGE {
            return Ok(());
        }
        // The version was read before the events, so that all events up to it have been sent.
        self.sequence = self.sequence.max(version);
        let sweep = state(&self.app, &self.id).await?;
        if sweep.finished.is_some() && self.app.store.sweep_version(&self.id).await? != Some(version) {
            // The sweep ended meanwhile: the next call sends its last events first.
            return Ok(());
        }
        self.has_ended = sweep.finished.is_some();
        if self.seen.as_ref().is_none_or(|(seen, _)| *seen != sweep) {
            self.push("sweep", &sweep)?;
        }
        (self.version, self.seen) = (Some(version), Some((sweep, Instant::now())));
        Ok(())
    }

    fn push(&mut self, name: &str, data: &impl serde::Serialize) -> Result<()> {
        let json = serde_json::to_string(data).map_err(|error| Error::internal(&error))?;
        let event = Event::default().event(name).id(self.sequence.to_string()).retry(RETRY);
        self.pending.push_back(event.data(json));
        Ok(())
    }
}
