//! Life of the service, from listening to drained.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;

use drillsweep_api::PHYSICS_VERSION;
use drillsweep_store::{Store, StoreError, TokensPresent};
use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio::time::{Instant, MissedTickBehavior};

use crate::app::{App, Config};
use crate::garbage::collect_garbage;
use crate::listen::{ConnectionCounts, serve_connections};
use crate::route::metrics;
use crate::route::status::WORKER_SILENCE;
use crate::router;

/// Default address: this machine only.
pub const DEFAULT_ADDRESS: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 7340);

/// Listeners of the service.
#[derive(Debug)]
pub struct Listeners {
    /// For the API.
    pub api: TcpListener,
    /// For `/metrics`, which needs no token: only Prometheus should reach it.
    pub metrics: Option<TcpListener>,
}

impl Listeners {
    /// Checks that the API is not open to other machines without authentication.
    ///
    /// # Errors
    /// [`ServeError::OpenToOthers`] if it is; otherwise when the listener or the store fails.
    pub async fn check(&self, store: &Store) -> Result<(), ServeError> {
        let address = self.api.local_addr().map_err(ServeError::Listener)?;
        if !address.ip().is_loopback() && store.tokens_present().await? != TokensPresent::Valid {
            return Err(ServeError::OpenToOthers(address));
        }
        Ok(())
    }
}

/// Error of starting or running the service.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The listener failed.
    #[error("the HTTP listener failed")]
    Listener(#[source] std::io::Error),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Others could reach the service without authentication.
    #[error(
        "will not listen on {0}: no valid token exists, so any client could submit and cancel. Create one with \
         `drillsweep token create --owner NAME --scope admin`, or listen on 127.0.0.1"
    )]
    OpenToOthers(SocketAddr),
    /// Open requests did not end in time.
    #[error("requests were still open {0:?} after the service was asked to stop")]
    DrainTimeout(Duration),
}

/// Serves until `shutdown` completes, then ends long polls and event streams at once and waits for open requests.
///
/// # Errors
/// A listener fails, others could reach the service though no valid token exists, or requests do not
/// end within [`Config::drain_timeout`].
pub async fn serve(
    listeners: Listeners,
    store: Store,
    config: Config,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> Result<(), ServeError> {
    listeners.check(&store).await?;
    let address = listeners.api.local_addr().map_err(ServeError::Listener)?;
    if let Some(listener) = &listeners.metrics {
        let address = listener.local_addr().map_err(ServeError::Listener)?;
        tracing::info!("metrics at http://{address}/metrics");
    }
    tracing::info!("listening on http://{address}");
    let drain_timeout = config.drain_timeout;
    let (stop, stopping) = watch::channel(false);
    let mut stopped = stopping.clone();
    let app = App::new(store, config, stopping);
    let reaper = tokio::spawn(reap_expired_leases(app.clone()));
    let collector = tokio::spawn(collect_garbage(app.clone()));
    let observed = listeners.metrics.map(|listener| {
        let routes = metrics::router(app.clone());
        let limits = app.config.connections.clone();
        tokio::spawn(async move {
            serve_connections(listener, routes, &limits, ConnectionCounts::default(), std::future::pending())
                .await
        })
    });
    let limits = app.config.connections.clone();
    let counts = app.metrics.connections.clone();
    let serving = serve_connections(listeners.api, router::routes(&app), &limits, counts, async move {
        shutdown.await;
        // The receivers cannot all be gone: the router holds one.
        let _ = stop.send(true);
    });
    let drained = async {
        let _ = stopped.wait_for(|stopping| *stopping).await;
        tokio::time::sleep(drain_timeout).await;
    };
    let result = tokio::select! {
        () = serving => Ok(()),
        () = drained => Err(ServeError::DrainTimeout(drain_timeout)),
    };
    reaper.abort();
    collector.abort();
    if let Some(observed) = observed {
        observed.abort();
    }
    result
}

/// Time after which a hidden sweep counts as abandoned if no points of it are stored or deleted.
const LEFT_BEHIND: Duration = Duration::from_secs(60);

/// Queues points of dead workers again at intervals until the service stops. Workers do so when they claim; this keeps states correct while
/// there are no workers.
async fn reap_expired_leases(mut app: App) {
    // Workers of an earlier version that start with the service need time to register.
    let outdated_from = Instant::now() + WORKER_SILENCE;
    let mut ticks = tokio::time::interval(app.config.reap_interval);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            // An error means that the service has ended.
            _ = app.stopping.wait_for(|stopping| *stopping) => return,
        }
        match app.store.reap_expired().await {
            Ok(0) => {}
            Ok(number) => {
                tracing::warn!(number, "leases have expired; their points are queued again");
            }
            Err(error) => tracing::error!(%error, "the search for expired leases failed"),
        }
        match app.store.finish_partial_changes(LEFT_BEHIND.as_millis() as i64).await {
            Ok(0) => {}
            Ok(number) => {
                tracing::warn!(number, "half-stored, half-cancelled or half-deleted sweeps were finished")
            }
            Err(error) => tracing::error!(%error, "the search for half-finished sweeps failed"),
        }
        if Instant::now() < outdated_from {
            continue;
        }
        match app.store.end_outdated(PHYSICS_VERSION.into(), WORKER_SILENCE.as_millis() as i64).await {
            Ok(0) => {}
            Ok(number) => tracing::warn!(
                number,
                physics_version = PHYSICS_VERSION,
                "points of earlier physics versions have failed: no worker computes them any more"
            ),
            Err(error) => tracing::error!(%error, "the search for points of earlier physics versions failed"),
        }
    }
}
