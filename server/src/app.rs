//! The service as a whole: what its handlers share, and its life from listening to drained.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use drillsweep_store::{Store, StoreError, TokensPresent};
use tokio::net::TcpListener;
use tokio::sync::{Semaphore, watch};

use crate::health::Readiness;
use crate::limit::{OwnerLimits, RequestLimiter};
use crate::metrics::{self, Metrics};
use crate::{maintenance, router};

/// Where the service listens unless told otherwise: this machine only.
pub const DEFAULT_ADDRESS: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 7340);

/// Event streams that may be open at once; each looks at the store some times a second.
pub(crate) const EVENT_STREAMS: usize = 1_000;

/// How the service keeps house.
#[derive(Debug, Clone)]
pub struct Config {
    /// How often points of dead workers are given back to the queue.
    pub reap_interval: Duration,
    /// How often a long poll looks for a change.
    pub poll_interval: Duration,
    /// How long open requests may take to end once the service is told to stop.
    pub drain_timeout: Duration,
    /// What one owner may ask for.
    pub owner_limits: OwnerLimits,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            reap_interval: Duration::from_secs(5),
            poll_interval: Duration::from_millis(200),
            drain_timeout: Duration::from_secs(10),
            owner_limits: OwnerLimits::default(),
        }
    }
}

/// Where the service listens.
#[derive(Debug)]
pub struct Listeners {
    /// For the API.
    pub api: TcpListener,
    /// For `/metrics`, which needs no token: to be reached by the operator's Prometheus only.
    pub metrics: Option<TcpListener>,
}

/// What the handlers share.
#[derive(Clone)]
pub(crate) struct App {
    pub(crate) store: Store,
    pub(crate) config: Arc<Config>,
    /// Turns true when the service is told to stop; long polls and event streams end on it.
    pub(crate) stopping: watch::Receiver<bool>,
    pub(crate) limiter: Arc<RequestLimiter>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) readiness: Arc<Readiness>,
    /// Places for event streams.
    pub(crate) streams: Arc<Semaphore>,
}

impl App {
    pub(crate) fn new(store: Store, config: Config, stopping: watch::Receiver<bool>) -> Self {
        App {
            store,
            stopping,
            limiter: Arc::new(RequestLimiter::new(&config.owner_limits)),
            metrics: Arc::new(Metrics::new()),
            readiness: Arc::default(),
            streams: Arc::new(Semaphore::new(EVENT_STREAMS)),
            config: Arc::new(config),
        }
    }
}

/// Why the service ended early, or did not begin.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The listener failed.
    #[error("the HTTP listener failed")]
    Listener(#[source] std::io::Error),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Others could reach the service, and nothing would tell them apart.
    #[error(
        "will not listen on {0}: no valid token exists, so that anybody who reaches it could submit and cancel. Make one \
         with `drillsweep token create --owner NAME --scope admin`, or listen on 127.0.0.1"
    )]
    OpenToOthers(SocketAddr),
    /// Open requests did not end in time.
    #[error("requests were still open {0:?} after the service was told to stop")]
    DrainTimeout(Duration),
}

/// Serves until `shutdown` completes, then ends long polls and event streams at once and waits for open requests.
///
/// # Errors
/// When a listener fails, when others could reach the service though no valid token exists, or when requests do not
/// end within [`Config::drain_timeout`].
pub async fn serve(
    listeners: Listeners,
    store: Store,
    config: Config,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> Result<(), ServeError> {
    let address = listeners.api.local_addr().map_err(ServeError::Listener)?;
    if !address.ip().is_loopback() && store.tokens_present().await? != TokensPresent::Valid {
        return Err(ServeError::OpenToOthers(address));
    }
    if let Some(listener) = &listeners.metrics {
        let address = listener.local_addr().map_err(ServeError::Listener)?;
        tracing::info!("metrics at http://{address}/metrics");
    }
    tracing::info!("listening on http://{address}");
    let drain_timeout = config.drain_timeout;
    let (stop, stopping) = watch::channel(false);
    let mut stopped = stopping.clone();
    let app = App::new(store, config, stopping);
    let reaper = tokio::spawn(maintenance::reap_expired_leases(app.clone()));
    let observed = listeners.metrics.map(|listener| {
        let routes = metrics::router(app.clone());
        tokio::spawn(async move { axum::serve(listener, routes).await })
    });
    let serving = axum::serve(listeners.api, router::routes(&app)).with_graceful_shutdown(async move {
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
    if let Some(observed) = observed {
        observed.abort();
    }
    result
}
