//! Changes among all sweeps, found once and sent to every event stream.

use std::collections::HashSet;
use std::sync::Arc;

use tokio::sync::{Mutex, MutexGuard, broadcast};

/// Batches that a stream may be behind before it is given up; its client resumes.
const BACKLOG: usize = 64;

/// Changes found at one look at the store.
#[derive(Debug, Default)]
pub(crate) struct News {
    /// The store's time before the look \[ms since the epoch\]: what changed before it was found by then.
    pub(crate) at: i64,
    /// Sweeps as they are now.
    pub(crate) changed: Vec<Told>,
    /// Sweeps that are no longer there.
    pub(crate) deleted: Vec<String>,
}

/// A sweep as streams tell of it, and what they choose by.
#[derive(Debug, Clone)]
pub(crate) struct Told {
    pub(crate) id: String,
    pub(crate) version: i64,
    pub(crate) owner: String,
    pub(crate) tags: Vec<String>,
    /// A `Sweep`, as JSON.
    pub(crate) json: String,
}

/// Where news come in and go out; nobody looks for any before a stream is open.
#[derive(Debug, Default)]
pub(crate) struct Feed(Mutex<Option<Watched>>);

#[derive(Debug)]
struct Watched {
    sender: broadcast::Sender<Arc<News>>,
    /// Sweeps that were there when streams joined, and at which nobody has looked since.
    listed: HashSet<String>,
}

impl Feed {
    /// The place of who looks for news; it is held while that begins or ends.
    pub(crate) async fn place(&self) -> Place<'_> {
        Place(self.0.lock().await)
    }
}

/// The place of who looks for news.
pub(crate) struct Place<'a>(MutexGuard<'a, Option<Watched>>);

impl Place<'_> {
    /// The news from now on, if somebody looks for them.
    pub(crate) fn join(&self) -> Option<broadcast::Receiver<Arc<News>>> {
        self.0.as_ref().map(|watched| watched.sender.subscribe())
    }

    /// Has the next look tell also of these sweeps, though they may be gone by then.
    pub(crate) fn list(&mut self, sweeps: impl IntoIterator<Item = String>) {
        if let Some(watched) = self.0.as_mut() {
            watched.listed.extend(sweeps);
        }
    }

    /// Takes the sweeps that were listed since the last call.
    pub(crate) fn take_listed(&mut self) -> HashSet<String> {
        self.0.as_mut().map(|watched| std::mem::take(&mut watched.listed)).unwrap_or_default()
    }

    /// Begins: where news go in, and where the first stream gets them.
    pub(crate) fn begin(&mut self) -> (broadcast::Sender<Arc<News>>, broadcast::Receiver<Arc<News>>) {
        let (sender, receiver) = broadcast::channel(BACKLOG);
        *self.0 = Some(Watched { sender: sender.clone(), listed: HashSet::new() });
        (sender, receiver)
    }

    /// Ends; streams that are still open end as well, once the looker's own sender is gone.
    pub(crate) fn end(&mut self) {
        *self.0 = None;
    }
}
