//! Connections: limits on their number, and timeouts.

use std::io;
use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use axum::http::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::gauge::Gauge;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tokio::time::Sleep;
use tower::ServiceExt as _;

/// Pause after a failed accept, as when no file descriptors are left.
const NO_ROOM: Duration = Duration::from_millis(100);

/// Limits on the number of connections, and timeouts.
#[derive(Debug, Clone)]
pub struct ConnectionLimits {
    /// Connections at once for requests of all kinds. Beyond them a new connection replaces the oldest one without a request yet.
    pub total: usize,
    /// Connections at once beyond these, for health checks and short requests about the service only.
    pub reserve: usize,
    /// Connections at once of one address, or of one network of IPv6 (/64). Those of this machine are not counted: behind a proxy all
    /// requests come from there.
    pub per_address: usize,
    /// Time from the connection, or the end of the answer before, to the last of a request's headers.
    pub headers: Duration,
    /// Time from a request's headers to the last byte of its body.
    pub body: Duration,
    /// Time in which a client has to take something of an answer that is ready. Event streams and long polls with nothing to send are not
    /// affected.
    pub write: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        ConnectionLimits {
            total: 2_000,
            reserve: 100,
            per_address: 200,
            headers: Duration::from_secs(15),
            body: Duration::from_secs(60),
            write: Duration::from_secs(60),
        }
    }
}

/// Marker of requests on connections in the reserve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InReserve;

/// Address of the client, or of a proxy before the server.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peer(pub(crate) SocketAddr);

/// Counts of connections.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConnectionCounts {
    /// Open connections.
    pub(crate) open: Gauge,
    /// Connections refused since the start.
    pub(crate) refused: Counter,
}

/// Serves connections until `shutdown` completes, then lets open requests end. A connection beyond the limits is closed at once.
pub(crate) async fn serve_connections(
    listener: TcpListener,
    routes: Router,
    limits: &ConnectionLimits,
    counts: ConnectionCounts,
    shutdown: impl Future<Output = ()>,
) {
    let places = Arc::new(Places::new(limits.clone(), counts.open));
    let connections = GracefulShutdown::new();
    let mut shutdown = pin!(shutdown);
    loop {
        let (stream, address) = tokio::select! {
            accepted = listener.accept() => match accepted {
                Ok(accepted) => accepted,
                Err(error) => {
                    tracing::warn!(%error, "a connection could not be accepted");
                    tokio::time::sleep(NO_ROOM).await;
                    continue;
                }
            },
            () = &mut shutdown => break,
        };
        let Some(place) = places.take(address.ip()) else {
            counts.refused.inc();
            tracing::debug!(%address, "a connection beyond the limits is closed");
            continue;
        };
        let connection = place.connection.clone();
        let routes = routes.clone().map_request(move |mut request: Request<Incoming>| {
            connection.has_requested.store(true, Ordering::Relaxed);
            request.extensions_mut().insert(Peer(address));
            if connection.is_in_reserve {
                request.extensions_mut().insert(InReserve);
            }
            request
        });
        let mut builder = http1::Builder::new();
        builder
            .timer(TokioTimer::new())
            .header_read_timeout(limits.headers)
            .keep_alive(!place.connection.is_in_reserve);
        let stream = TokioIo::new(Patient { stream, patience: limits.write, waiting: None });
        let connection = builder.serve_connection(stream, TowerToHyperService::new(routes));
        let connection = connections.watch(connection);
        tokio::spawn(async move {
            tokio::select! {
                ended = connection => if let Err(error) = ended {
                    tracing::debug!(%error, %address, "a connection ended early");
                },
                () = place.connection.replaced.notified() => {
                    tracing::debug!(%address, "a connection without a request is replaced by another");
                }
            }
            drop(place);
        });
    }
    drop(listener);
    connections.shutdown().await;
}

/// Open connections, within the limits on their number.
struct Places {
    limits: ConnectionLimits,
    /// In order of arrival.
    open: Mutex<Vec<Arc<Connection>>>,
    number: Gauge,
}

/// An open connection.
struct Connection {
    address: IpAddr,
    /// True for connections beyond [`ConnectionLimits::total`], which may make light requests only.
    is_in_reserve: bool,
    has_requested: AtomicBool,
    /// Another connection has taken the place of this one.
    replaced: Notify,
}

/// Place of a connection; free again when it is dropped.
struct Place {
    places: Arc<Places>,
    connection: Arc<Connection>,
}

impl Places {
    fn new(limits: ConnectionLimits, number: Gauge) -> Self {
        Places { limits, open: Mutex::default(), number }
    }

    /// Takes a place. If none is free, the oldest connection without a request loses its own, so that clients that open many connections and
    /// stay silent do not keep others out; if all have requested something, the place is in the reserve.
    fn take(self: &Arc<Self>, address: IpAddr) -> Option<Place> {
        let address = network(address);
        let mut open = self.open();
        let of_address = open.iter().filter(|other| other.address == address).count();
        if of_address >= self.limits.per_address && !address.is_loopback() {
            return None;
        }
        let is_in_reserve = if open.iter().filter(|other| !other.is_in_reserve).count() < self.limits.total {
            false
        } else if let Some(silent) =
            open.iter().position(|other| !other.has_requested.load(Ordering::Relaxed))
        {
            let silent = open.remove(silent);
            silent.replaced.notify_one();
            silent.is_in_reserve
        } else if open.len() < self.limits.total + self.limits.reserve {
            true
        } else {
            return None;
        };
        let connection = Arc::new(Connection {
            address,
            is_in_reserve,
            has_requested: AtomicBool::new(false),
            replaced: Notify::new(),
        });
        open.push(connection.clone());
        self.number.set(open.len() as i64);
        Some(Place { places: self.clone(), connection })
    }

    fn open(&self) -> MutexGuard<'_, Vec<Arc<Connection>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut open = self.places.open();
        open.retain(|other| !Arc::ptr_eq(other, &self.connection));
        self.places.number.set(open.len() as i64);
    }
}

/// Network that counts as one address: an IPv4 address, or an IPv6 /64, the least that a customer gets.
pub(crate) fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) if !address.is_loopback() => {
            IpAddr::V6(Ipv6Addr::from_bits(address.to_bits() >> 64 << 64))
        }
        address => address,
    }
}

/// A connection that ends when its client takes nothing of an answer for too long.
struct Patient {
    stream: TcpStream,
    patience: Duration,
    /// Deadline of the client for the pending write.
    waiting: Option<Pin<Box<Sleep>>>,
}

impl Patient {
    fn watch<T>(&mut self, context: &mut Context<'_>, written: Poll<io::Result<T>>) -> Poll<io::Result<T>> {
        if written.is_ready() {
            self.waiting = None;
            return written;
        }
        let patience = self.patience;
        let waiting = self.waiting.get_or_insert_with(|| Box::pin(tokio::time::sleep(patience)));
        waiting.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncRead for Patient {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

impl AsyncWrite for Patient {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.watch(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, pieces);
        self.watch(context, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> Arc<Places> {
        let limits = ConnectionLimits { total: 4, reserve: 2, per_address: 3, ..ConnectionLimits::default() };
        Arc::new(Places::new(limits, Gauge::default()))
    }

    fn address(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    /// Places of connections of this machine that have requested something.
    fn busy(places: &Arc<Places>, number: usize) -> Vec<Place> {
        let take = |_| {
            let place = places.take(address("127.0.0.1")).expect("a place");
            place.connection.has_requested.store(true, Ordering::Relaxed);
            place
        };
        (0..number).map(take).collect()
    }

    #[test]
    fn one_address_cannot_have_all_places() {
        let places = places();
        let greedy = address("192.0.2.1");
        let held: Vec<Place> = (0..3).map(|_| places.take(greedy).expect("a place")).collect();
        assert!(places.take(greedy).is_none());
        assert!(places.take(address("192.0.2.2")).is_some_and(|place| !place.connection.is_in_reserve));
        drop(held);
        assert!(places.take(greedy).is_some());
        assert!(places.open().is_empty());
    }

    #[test]
    fn connections_beyond_all_busy_ones_are_in_the_reserve() {
        let places = places();
        let held = busy(&places, 6);
        let in_reserve: Vec<bool> = held.iter().map(|place| place.connection.is_in_reserve).collect();
        assert_eq!(in_reserve, [false, false, false, false, true, true]);
        assert!(places.take(address("192.0.2.1")).is_none());
        drop(held);
        assert!(places.take(address("192.0.2.1")).is_some_and(|place| !place.connection.is_in_reserve));
    }

    #[test]
    fn the_oldest_connection_without_a_request_is_replaced() {
        let places = places();
        let of = |places: &Places| places.open().iter().map(|open| open.address).collect::<Vec<_>>();
        let silent = ["192.0.2.1", "192.0.2.2"].map(|from| places.take(address(from)).expect("a place"));
        let held = busy(&places, 2);
        let third = places.take(address("192.0.2.3")).expect("the place of the first");
        assert!(!third.connection.is_in_reserve);
        assert_eq!(of(&places), ["192.0.2.2", "127.0.0.1", "127.0.0.1", "192.0.2.3"].map(address));
        drop(silent);
        assert_eq!(of(&places), ["127.0.0.1", "127.0.0.1", "192.0.2.3"].map(address));
        drop((held, third));
        assert!(places.open().is_empty());
    }

    #[test]
    fn addresses_of_one_network_count_as_one() {
        assert_eq!(network(address("2001:db8:1:2::3")), network(address("2001:db8:1:2:4:5:6:7")));
        assert_ne!(network(address("2001:db8:1:2::3")), network(address("2001:db8:1:3::3")));
        assert_eq!(network(address("::ffff:192.0.2.1")), address("192.0.2.1"));
        assert!(network(address("::1")).is_loopback());
    }
}
