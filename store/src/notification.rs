//! Hearing of changes without asking all the time.
//!
//! PostgreSQL tells its clients of changes when they are committed (`NOTIFY`, by the triggers of the schema); a word may be lost with a
//! connection, so that whoever waits looks now and then all the same. SQLite tells nobody: there the looks are what it goes by.

use std::sync::Arc;
use std::time::Duration;

use sqlx::PgPool;
use sqlx::postgres::PgListener;
use tokio::sync::{Mutex, watch};

use crate::connection::Store;
use crate::database::Database;

/// The channels, as the triggers name them.
const WORK: &str = "drillsweep_work";
const SWEEPS: &str = "drillsweep_sweeps";

/// How much longer it is between two looks where changes are told of.
const LOOKS_ARE_RARER: u32 = 5;

/// The least that a wait takes where changes are told of: of many at once one is told.
const PAUSE: Duration = Duration::from_millis(20);

/// How long it is before another try where the server cannot be listened to.
const RETRY: Duration = Duration::from_secs(2);

/// Changes of one kind, for one who waits for them. What happens between two waits ends the next one at once.
#[derive(Debug)]
pub struct Changes(Option<watch::Receiver<()>>);

impl Changes {
    /// Waits for the next change, or until it is time to look whether there was one: after `look` where nobody tells of changes, and
    /// after five times as long where somebody does. Whatever ends it, there may be nothing new.
    pub async fn wait(&mut self, look: Duration) {
        match &mut self.0 {
            None => tokio::time::sleep(look).await,
            Some(told) => {
                tokio::time::sleep(PAUSE).await;
                // An error means that nobody listens any more: then looks alone are what is left.
                let _ = tokio::time::timeout(LOOKS_ARE_RARER * look, async {
                    if told.changed().await.is_err() {
                        tokio::time::sleep(look).await;
                    }
                })
                .await;
            }
        }
    }
}

/// Who listens for all that wait in this process; nobody before somebody has asked.
#[derive(Debug, Clone, Default)]
pub(crate) struct Listening(Arc<Mutex<Option<Told>>>);

/// What was told, by channel.
#[derive(Debug)]
struct Told {
    work: watch::Sender<()>,
    sweeps: watch::Sender<()>,
    task: tokio::task::JoinHandle<()>,
}

impl Drop for Told {
    fn drop(&mut self) {
        self.task.abort();
    }
}

impl Listening {
    /// Stops listening, so that the connection goes back to the pool.
    pub(crate) async fn stop(&self) {
        self.0.lock().await.take();
    }
}

impl Store {
    /// What may have given workers something to do.
    pub async fn work_changes(&self) -> Changes {
        self.changes(|told| told.work.subscribe()).await
    }

    /// Changes of the states of sweeps' points.
    pub async fn sweep_changes(&self) -> Changes {
        self.changes(|told| told.sweeps.subscribe()).await
    }

    async fn changes(&self, of: impl Fn(&Told) -> watch::Receiver<()>) -> Changes {
        let Database::Postgres(pool) = &self.database else { return Changes(None) };
        let mut listening = self.listening.0.lock().await;
        let told = listening.get_or_insert_with(|| {
            let (work, sweeps) = (watch::Sender::new(()), watch::Sender::new(()));
            let task = tokio::spawn(listen(pool.clone(), work.clone(), sweeps.clone()));
            Told { work, sweeps, task }
        });
        Changes(Some(of(told)))
    }
}

/// Listens for as long as the process runs, over a connection of the pool.
async fn listen(pool: PgPool, work: watch::Sender<()>, sweeps: watch::Sender<()>) {
    while !pool.is_closed() {
        let error = listen_until_it_fails(&pool, &work, &sweeps).await;
        tracing::warn!(?error, "the database tells of no changes; they are looked for");
        tokio::time::sleep(RETRY).await;
    }
}

async fn listen_until_it_fails(
    pool: &PgPool,
    work: &watch::Sender<()>,
    sweeps: &watch::Sender<()>,
) -> sqlx::Result<()> {
    let mut listener = PgListener::connect_with(pool).await?;
    listener.listen_all([WORK, SWEEPS]).await?;
    loop {
        // What was said before somebody listened, and after a lost connection was made anew, is not known.
        let told = listener.try_recv().await?;
        let channel = told.as_ref().map(|told| told.channel());
        if channel != Some(SWEEPS) {
            work.send_replace(());
        }
        if channel != Some(WORK) {
            sweeps.send_replace(());
        }
    }
}
