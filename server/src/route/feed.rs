//! Looking for changes of all sweeps, on behalf of every stream that tells of them: however many are open, the store is asked once.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

use drillsweep_api::{Sweep, SweepState};
use tokio::sync::broadcast;
use tokio::time::Instant;

use crate::answer::error::Result;
use crate::answer::records;
use crate::app::App;
use crate::app::feed::{News, Told};
use crate::route::sweeps::PROGRESS_INTERVAL;
use crate::route::waiting::note_waiting;

/// The least time between two looks: what changes more often is told once, as it is then.
const SHORTEST_INTERVAL: Duration = Duration::from_secs(1);

/// Sweeps that are read at once.
pub(crate) const PAGE: usize = 100;

/// News of all sweeps from now on: every change after this returns, and perhaps some before it.
pub(crate) async fn join(app: &App) -> Result<broadcast::Receiver<Arc<News>>> {
    let mut place = app.feed.place().await;
    if let Some(receiver) = place.join() {
        // The client may show what came since the last look, and is to hear that it is gone even if that is before the next one.
        let marks = app.store.sweep_marks().await?;
        place.list(marks.into_iter().map(|mark| mark.id));
        return Ok(receiver);
    }
    let mut watch = Watch { app: app.clone(), known: HashMap::new(), progress_read: Instant::now() };
    watch.begin().await?;
    let (sender, receiver) = place.begin();
    drop(place);
    tokio::spawn(watch.go_on(sender));
    Ok(receiver)
}

/// Known state of all sweeps.
struct Watch {
    app: App,
    known: HashMap<String, Known>,
    progress_read: Instant,
}

/// A version that no sweep has: what is known as this is told at the next look.
const UNTOLD: i64 = i64::MIN;

/// How far a sweep had come, and, while it was not final, as what it was told: its progress changes without its version.
struct Known {
    version: i64,
    told: Option<Sweep>,
}

impl Watch {
    /// Takes all sweeps as known.
    async fn begin(&mut self) -> Result<()> {
        let marks = self.app.store.sweep_marks().await?;
        let unfinished: Vec<&str> =
            marks.iter().filter(|mark| mark.is_unfinished).map(|mark| mark.id.as_str()).collect();
        let mut sweeps = read(&self.app, &unfinished).await?;
        for mark in marks {
            // One that has changed since the marks were read is known as it was: the next look tells of it.
            let told = sweeps.remove(&mark.id).map(|(_, sweep)| sweep);
            self.known.insert(mark.id, Known { version: mark.version, told });
        }
        Ok(())
    }

    /// Looks again and again, until nobody wants to know, the service stops or the store fails. In that case the streams end, and
    /// their clients resume.
    async fn go_on(mut self, sender: broadcast::Sender<Arc<News>>) {
        let mut changes = self.app.store.sweep_changes().await;
        let mut stopping = self.app.stopping.clone();
        loop {
            let pause = async {
                tokio::time::sleep(SHORTEST_INTERVAL).await;
                changes.wait(self.app.config.poll_interval).await;
            };
            let is_over = tokio::select! {
                () = pause => false,
                _ = stopping.wait_for(|stopping| *stopping) => true,
            };
            let found = if is_over { Ok(None) } else { self.look().await.map(Some) };
            let mut place = self.app.feed.place().await;
            match found {
                Ok(Some(news)) if sender.receiver_count() > 0 => {
                    if !(news.changed.is_empty() && news.deleted.is_empty()) {
                        // An error means that the last stream has just ended.
                        let _ = sender.send(Arc::new(news));
                    }
                }
                Ok(_) => return place.end(),
                Err(error) => {
                    tracing::warn!(
                        ?error,
                        "the event streams of all sweeps end early; clients may reconnect"
                    );
                    return place.end();
                }
            }
        }
    }

    /// Finds the changes since the last look.
    async fn look(&mut self) -> Result<News> {
        let at = self.app.store.now_ms().await?;
        for id in self.app.feed.place().await.take_listed() {
            self.known.entry(id).or_insert(Known { version: UNTOLD, told: None });
        }
        let marks = self.app.store.sweep_marks().await?;
        let is_progress_due = self.progress_read.elapsed() >= PROGRESS_INTERVAL;
        if is_progress_due {
            self.progress_read = Instant::now();
        }
        let is_due = |version: i64, is_unfinished: bool, known: Option<&Known>| {
            known.is_none_or(|known| known.version != version) || (is_progress_due && is_unfinished)
        };
        let due: Vec<&str> = marks
            .iter()
            .filter(|mark| is_due(mark.version, mark.is_unfinished, self.known.get(&mark.id)))
            .map(|mark| mark.id.as_str())
            .collect();
        let mut sweeps = read(&self.app, &due).await?;
        let mut news = News { at, ..News::default() };
        let mut before = std::mem::take(&mut self.known);
        for mark in marks {
            let known = before.remove(&mark.id);
            let known = match sweeps.remove(&mark.id) {
                None => known.unwrap_or(Known { version: mark.version, told: None }),
                Some((version, sweep)) => {
                    if known.is_none_or(|known| known.told.as_ref() != Some(&sweep)) {
                        news.changed.push(told(version, &sweep)?);
                    }
                    Known { version, told: (!is_final(&sweep)).then_some(sweep) }
                }
            };
            self.known.insert(mark.id, known);
        }
        news.deleted = before.into_keys().collect();
        Ok(news)
    }
}

/// Sweeps as lists have them, by identifier, each with its version.
pub(crate) async fn read(app: &App, ids: &[&str]) -> Result<HashMap<String, (i64, Sweep)>> {
    let mut found = HashMap::new();
    for ids in ids.chunks(PAGE) {
        let records = app.store.listed_sweeps(ids).await?;
        let mut sweeps: Vec<Sweep> = records.iter().map(records::sweep).collect::<Result<_>>()?;
        note_waiting(app, &mut sweeps).await?;
        let versions = records.into_iter().map(|record| record.version);
        found.extend(versions.zip(sweeps).map(|(version, sweep)| (sweep.id.clone(), (version, sweep))));
    }
    Ok(found)
}

/// A sweep as streams tell of it.
pub(crate) fn told(version: i64, sweep: &Sweep) -> Result<Told> {
    Ok(Told {
        id: sweep.id.clone(),
        version,
        owner: sweep.owner.clone(),
        tags: sweep.tags.clone(),
        json: records::write(sweep)?,
    })
}

fn is_final(sweep: &Sweep) -> bool {
    matches!(sweep.state, SweepState::Completed | SweepState::Cancelled)
}
