//! The service as a whole: what its handlers share, and its life from listening to drained.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use drillsweep_store::Store;
use tokio::net::TcpListener;
use tokio::sync::watch;

use crate::{maintenance, router};

/// Where the service listens unless told otherwise: this machine only, since there are no tokens yet.
pub const DEFAULT_ADDRESS: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 7340);

/// How the service keeps house.
#[derive(Debug, Clone)]
pub struct Config {
    /// How often points of dead workers are given back to the queue.
    pub reap_interval: Duration,
    /// How often a long poll looks for a change.
    pub poll_interval: Duration,
    /// How long open requests may take to end once the service is told to stop.
    pub drain_timeout: Duration,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            reap_interval: Duration::from_secs(5),
            poll_interval: Duration::from_millis(200),
            drain_timeout: Duration::from_secs(10),
        }
    }
}

/// What the handlers share.
#[derive(Clone)]
pub(crate) struct App {
    pub(crate) store: Store,
    pub(crate) config: Arc<Config>,
    /// Turns true when the service is told to stop; long polls end on it.
    pub(crate) stopping: watch::Receiver<bool>,
}

/// Why the service ended early.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The listener failed.
    #[error("the HTTP listener failed")]
    Listener(#[source] std::io::Error),
    /// Open requests did not end in time.
    #[error("requests were still open {0:?} after the service was told to stop")]
    DrainTimeout(Duration),
}

/// Serves until `shutdown` completes, then ends long polls at once and waits for open requests.
///
/// # Errors
/// When the listener fails, or requests do not end within [`Config::drain_timeout`].
pub async fn serve(
    listener: TcpListener,
    store: Store,
    config: Config,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> Result<(), ServeError> {
    let drain_timeout = config.drain_timeout;
    let (stop, stopping) = watch::channel(false);
    let reaper =
        tokio::spawn(maintenance::reap_expired_leases(store.clone(), config.reap_interval, stopping.clone()));
    let mut stopped = stopping.clone();
    let routes = router::router(store, config, stopping);
    let serving = axum::serve(listener, routes).with_graceful_shutdown(async move {
        shutdown.await;
        // The receivers cannot all be gone: the router holds one.
        let _ = stop.send(true);
    });
    let drained = async {
        let _ = stopped.wait_for(|stopping| *stopping).await;
        tokio::time::sleep(drain_timeout).await;
    };
    let result = tokio::select! {
        result = serving => result.map_err(ServeError::Listener),
        () = drained => Err(ServeError::DrainTimeout(drain_timeout)),
    };
    reaper.abort();
    result
}
