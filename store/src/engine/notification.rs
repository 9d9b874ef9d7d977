//! Notifications of changes, so that waiting processes need not poll often.
//!
//! PostgreSQL notifies its listeners when a transaction commits (`NOTIFY`, by the triggers of the schema). A notification may be lost with
//! a connection, so polling continues at a lower rate. SQLite has no notifications: there all processes poll.

use std::sync::Arc;
use std::time::Duration;

use sqlx::PgPool;
use sqlx::postgres::PgListener;
use tokio::sync::{Mutex, watch};

use crate::engine::database::Database;

/// The channels, as the triggers name them.
const WORK: &str = "drillsweep_work";
const SWEEPS: &str = "drillsweep_sweeps";

/// Factor of the polling interval if there are notifications.
const POLLING_SLOWDOWN: u32 = 5;

/// The shortest wait if there are notifications: many at once count as one.
const SHORTEST_WAIT: Duration = Duration::from_millis(20);

/// The wait before listening is tried again after it failed.
const RETRY: Duration = Duration::from_secs(2);

/// Notifications of one kind for one waiter. One that arrives between two waits ends the next wait at once.
#[derive(Debug)]
pub struct Changes(Option<watch::Receiver<()>>);

impl Changes {
    /// Waits for the next notification, or until it is time to poll: after `poll_interval` if there are no notifications, and after
    /// five times as long if there are. Nothing need have changed when it returns.
    pub async fn wait(&mut self, poll_interval: Duration) {
        match &mut self.0 {
            None => tokio::time::sleep(poll_interval).await,
            Some(notified) => {
                tokio::time::sleep(SHORTEST_WAIT).await;
                // An error means that listening has ended: polling is left.
                let _ = tokio::time::timeout(POLLING_SLOWDOWN * poll_interval, async {
                    if notified.changed().await.is_err() {
                        tokio::time::sleep(poll_interval).await;
                    }
                })
                .await;
            }
        }
    }
}

/// The one listener of all waiters of a store, created by the first waiter.
#[derive(Debug, Clone, Default)]
pub(crate) struct Listening(Arc<Mutex<Option<Listener>>>);

/// A task that listens, and its receivers, by channel.
#[derive(Debug)]
struct Listener {
    work: watch::Sender<()>,
    sweeps: watch::Sender<()>,
    task: tokio::task::JoinHandle<()>,
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.task.abort();
    }
}

impl Listening {
    /// Notifications of work that may have become ready to be claimed.
    pub(crate) async fn work_changes(&self, database: &Database) -> Changes {
        self.changes(database, |listener| listener.work.subscribe()).await
    }

    /// Notifications of changes of sweeps and of their points.
    pub(crate) async fn sweep_changes(&self, database: &Database) -> Changes {
        self.changes(database, |listener| listener.sweeps.subscribe()).await
    }

    /// Stops listening, so that the connection goes back to the pool.
    pub(crate) async fn stop(&self) {
        self.0.lock().await.take();
    }

    async fn changes(&self, database: &Database, of: impl Fn(&Listener) -> watch::Receiver<()>) -> Changes {
        let Database::Postgres(connections) = database else { return Changes(None) };
        let mut listening = self.0.lock().await;
        let listener = listening.get_or_insert_with(|| {
            let (work, sweeps) = (watch::Sender::new(()), watch::Sender::new(()));
            let task = tokio::spawn(listen(connections.pool().clone(), work.clone(), sweeps.clone()));
            Listener { work, sweeps, task }
        });
        Changes(Some(of(listener)))
    }
}

/// Listens until the pool is closed, over one of its connections.
async fn listen(pool: PgPool, work: watch::Sender<()>, sweeps: watch::Sender<()>) {
    while !pool.is_closed() {
        let error = listen_until_it_fails(&pool, &work, &sweeps).await;
        tracing::warn!(?error, "notifications of the database are interrupted; polling goes on");
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
        // None after a reconnect: what was notified meanwhile is lost, and so everybody is notified.
        let notification = listener.try_recv().await?;
        let channel = notification.as_ref().map(|notification| notification.channel());
        if channel != Some(SWEEPS) {
            work.send_replace(());
        }
        if channel != Some(WORK) {
            sweeps.send_replace(());
        }
    }
}
