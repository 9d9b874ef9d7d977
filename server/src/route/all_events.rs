//! All sweeps as one stream of events.

use std::collections::{HashMap, VecDeque};
use std::convert::Infallible;
use std::sync::Arc;

use axum::Extension;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use drillsweep_api::DeletedSweep;
use serde::Deserialize;
use tokio::sync::broadcast;

use crate::answer::error::Result;
use crate::answer::extract::{Query, value};
use crate::answer::records;
use crate::app::App;
use crate::app::feed::{News, Told};
use crate::app::shares::Share;
use crate::guard::caller::Caller;
use crate::openapi::answers::Problems;
use crate::route::events::{RETRY, last_seen};
use crate::route::feed;

/// By how much earlier than the last event a resumed stream begins \[ms\]: a change has the time at which it was begun, and is seen
/// when it is stored, which takes long for a sweep of many points.
const OVERLAP: i64 = 300_000;

/// Of which sweeps a stream tells, and where it begins.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct AllEventsQuery {
    /// Only sweeps of this owner.
    owner: Option<String>,
    /// Only sweeps with this tag.
    tag: Option<String>,
    /// As the header `Last-Event-ID`, for clients that cannot set headers; the header wins.
    #[serde(default, deserialize_with = "value::whole")]
    after: Option<u64>,
}

/// Follow all sweeps: a stream of events
///
/// Events `sweep` (data: `Sweep`, as lists have it) tell of a sweep that is new or has changed, at most one a second of each, with the
/// progress of running ones every two seconds; `deleted` (data: `DeletedSweep`) of one that is gone. The stream begins with the sweeps
/// that are not final, and has no end. An `id` is a time: a stream that is resumed by it, at whichever server, begins also with the
/// sweeps that have become final since, some minutes before included. Of what else was missed it does not tell: deletions, and
/// changes of finished sweeps (name, tags, pin, expiry); who shows a list reads it again.
#[utoipa::path(
    get,
    path = "/v1/events",
    tag = "sweeps",
    operation_id = "follow_all_sweeps",
    params(
        AllEventsQuery,
        ("Last-Event-ID" = Option<u64>, Header, description = "`id` of the last event that was seen."),
    ),
    responses(
        (status = 200, description = "The stream", body = String, content_type = "text/event-stream"),
        Problems
    )
)]
pub(crate) async fn follow(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(AllEventsQuery { owner, tag, after }): Query<AllEventsQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let after = last_seen(&headers, after)?;
    let permit = app.streams.take(caller.budget())?;
    let news = feed::join(&app).await?;
    let now = app.store.now_ms().await?;
    let since = after.map_or(i64::MAX, |after| after.saturating_sub(OVERLAP));
    let unread = app.store.sweeps_since(since).await?.into();
    let follower = Follower {
        app,
        news,
        owner,
        tag,
        unread,
        // While there are some to be read, a resumed stream that breaks off is to begin again where it began.
        sequence: after.unwrap_or(now).min(now),
        begun: now,
        read: HashMap::new(),
        read_at: now,
        pending: VecDeque::new(),
        _permit: permit,
    };
    let stream = futures::stream::unfold(follower, Follower::next);
    Ok(Sse::new(stream).keep_alive(KeepAlive::default()).into_response())
}

/// One client's place in the events of all sweeps. What it begins with is read as the client takes it.
struct Follower {
    app: App,
    news: broadcast::Receiver<Arc<News>>,
    owner: Option<String>,
    tag: Option<String>,
    /// Sweeps that the stream begins with and that were not read yet.
    unread: VecDeque<String>,
    /// Up to when everything has been told \[ms since the epoch\].
    sequence: i64,
    /// When it began \[ms since the epoch\].
    begun: i64,
    /// Versions of the sweeps that it began with, and when the last was read \[ms since the epoch\]: what news from before that tell of
    /// them may be older.
    read: HashMap<String, i64>,
    read_at: i64,
    pending: VecDeque<Pending>,
    _permit: Share,
}

/// An event to be sent.
struct Pending {
    name: &'static str,
    id: i64,
    json: String,
}

impl Follower {
    async fn next(mut self) -> Option<(std::result::Result<Event, Infallible>, Self)> {
        let mut stopping = self.app.stopping.clone();
        loop {
            if *stopping.borrow() {
                return None;
            }
            if let Some(Pending { name, id, json }) = self.pending.pop_front() {
                let event = Event::default().event(name).id(id.to_string()).retry(RETRY);
                return Some((Ok(event.data(json)), self));
            }
            if !self.unread.is_empty() {
                if let Err(error) = self.read_next().await {
                    tracing::warn!(
                        ?error,
                        "an event stream of all sweeps ends early; its client may reconnect"
                    );
                    return None;
                }
                continue;
            }
            let news = tokio::select! {
                news = self.news.recv() => news,
                // An error means that the service is gone.
                _ = stopping.wait_for(|stopping| *stopping) => return None,
            };
            // Neither a stream that is too far behind nor one without news goes on: its client resumes.
            let told = self.tell(&*news.ok()?);
            if let Err(error) = told {
                tracing::warn!(?error, "an event stream of all sweeps ends early; its client may reconnect");
                return None;
            }
        }
    }

    /// Reads the next of the sweeps that the stream begins with.
    async fn read_next(&mut self) -> Result<()> {
        let ids: Vec<String> = self.unread.drain(..self.unread.len().min(feed::PAGE)).collect();
        let borrowed: Vec<&str> = ids.iter().map(String::as_str).collect();
        let mut sweeps = feed::read(&self.app, &borrowed).await?;
        for id in ids {
            let Some((version, sweep)) = sweeps.remove(&id) else { continue };
            let told = feed::told(version, &sweep)?;
            self.read.insert(id, version);
            self.tell_of(&told);
        }
        if self.unread.is_empty() {
            self.read_at = self.app.store.now_ms().await?;
            self.sequence = self.begun;
            // Who has seen the last of them has seen them all.
            if let Some(last) = self.pending.back_mut() {
                last.id = self.begun;
            }
        }
        Ok(())
    }

    fn tell(&mut self, news: &News) -> Result<()> {
        self.sequence = self.sequence.max(news.at);
        if news.at > self.read_at {
            self.read.clear();
        }
        for told in &news.changed {
            if self.read.get(&told.id).is_none_or(|read| *read <= told.version) {
                self.tell_of(told);
            }
        }
        for id in &news.deleted {
            self.push("deleted", records::write(&DeletedSweep { id: id.clone() })?);
        }
        Ok(())
    }

    fn tell_of(&mut self, told: &Told) {
        let is_owners = self.owner.as_ref().is_none_or(|owner| *owner == told.owner);
        if is_owners && self.tag.as_ref().is_none_or(|tag| told.tags.contains(tag)) {
            self.push("sweep", told.json.clone());
        }
    }

    fn push(&mut self, name: &'static str, json: String) {
        self.pending.push_back(Pending { name, id: self.sequence, json });
    }
}
