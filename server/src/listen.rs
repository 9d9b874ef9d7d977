//! Connections: how many there may be, how long they may take to say what they want, and to take what they get.

use std::collections::HashMap;
use std::io;
use std::net::{IpAddr, Ipv6Addr};
use std::pin::{Pin, pin};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::Sleep;

/// Wait after the system had no room for a connection, as when it has no file descriptors left.
const NO_ROOM: Duration = Duration::from_millis(100);

/// How many connections there may be, and how long they may take.
#[derive(Debug, Clone)]
pub struct ConnectionLimits {
    /// Connections at once that may ask for anything.
    pub total: usize,
    /// Connections at once beyond these, for health checks and short questions about the service only.
    pub reserve: usize,
    /// Connections at once of one address, or of one network of IPv6 (/64). Those of this machine are not counted: behind a proxy all
    /// requests come from there.
    pub per_address: usize,
    /// Of the reserve, connections at once of one address, be it this machine's.
    pub reserve_per_address: usize,
    /// Time from the connection, or the end of the answer before, to the last of a request's headers.
    pub headers: Duration,
    /// The same in the reserve, where others wait.
    pub reserve_headers: Duration,
    /// Time from a request's headers to the last byte of its body.
    pub body: Duration,
    /// Time in which a client that is being answered must take something. Event streams and long polls that have nothing to send are
    /// not cut off by it.
    pub write: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        ConnectionLimits {
            total: 2_000,
            reserve: 100,
            per_address: 200,
            reserve_per_address: 20,
            headers: Duration::from_secs(15),
            reserve_headers: Duration::from_secs(2),
            body: Duration::from_secs(60),
            write: Duration::from_secs(60),
        }
    }
}

/// Marks the requests of connections in the reserve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InReserve;

/// Serves connections until `shutdown` completes, then lets open requests end. A connection beyond the limits is closed at once.
pub(crate) async fn serve_connections(
    listener: TcpListener,
    routes: Router,
    limits: &ConnectionLimits,
    shutdown: impl Future<Output = ()>,
) {
    let places = Arc::new(Places::new(limits.clone()));
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
            tracing::debug!(%address, "a connection beyond the limits is closed");
            continue;
        };
        let is_reserve = place.is_reserve;
        let routes = if is_reserve { routes.clone().layer(Extension(InReserve)) } else { routes.clone() };
        let mut builder = http1::Builder::new();
        builder
            .timer(TokioTimer::new())
            .header_read_timeout(if is_reserve { limits.reserve_headers } else { limits.headers })
            .keep_alive(!is_reserve);
        let stream = TokioIo::new(Patient { stream, patience: limits.write, waiting: None });
        let connection = builder.serve_connection(stream, TowerToHyperService::new(routes));
        let connection = connections.watch(connection);
        tokio::spawn(async move {
            if let Err(error) = connection.await {
                tracing::debug!(%error, %address, "a connection ended early");
            }
            drop(place);
        });
    }
    drop(listener);
    connections.shutdown().await;
}

/// Places for connections.
struct Places {
    limits: ConnectionLimits,
    general: Arc<Semaphore>,
    reserve: Arc<Semaphore>,
    /// Connections by address: all of them, and those in the reserve.
    taken: Mutex<HashMap<IpAddr, (usize, usize)>>,
}

/// A connection's place; free again when it is dropped.
struct Place {
    places: Arc<Places>,
    address: IpAddr,
    is_reserve: bool,
    _permit: OwnedSemaphorePermit,
}

impl Places {
    fn new(limits: ConnectionLimits) -> Self {
        Places {
            general: Arc::new(Semaphore::new(limits.total)),
            reserve: Arc::new(Semaphore::new(limits.reserve)),
            limits,
            taken: Mutex::default(),
        }
    }

    fn take(self: &Arc<Self>, address: IpAddr) -> Option<Place> {
        let address = network(address);
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let (all, in_reserve) = taken.get(&address).copied().unwrap_or_default();
        if all >= self.limits.per_address && !address.is_loopback() {
            return None;
        }
        let (permit, is_reserve) = match self.general.clone().try_acquire_owned() {
            Ok(permit) => (permit, false),
            Err(_) if in_reserve >= self.limits.reserve_per_address => return None,
            Err(_) => (self.reserve.clone().try_acquire_owned().ok()?, true),
        };
        taken.insert(address, (all + 1, in_reserve + usize::from(is_reserve)));
        Some(Place { places: self.clone(), address, is_reserve, _permit: permit })
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.places.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((all, in_reserve)) = taken.get_mut(&self.address) {
            *all -= 1;
            *in_reserve -= usize::from(self.is_reserve);
            if *all == 0 {
                taken.remove(&self.address);
            }
        }
    }
}

/// What counts as one address: an address of IPv4, a /64 of IPv6, which is what one customer gets at least.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) if !address.is_loopback() => {
            IpAddr::V6(Ipv6Addr::from_bits(address.to_bits() >> 64 << 64))
        }
        address => address,
    }
}

/// A connection that is given up when its client takes nothing of an answer for too long.
struct Patient {
    stream: TcpStream,
    patience: Duration,
    /// Until when the client has to take something that waits for it.
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
        let limits = ConnectionLimits {
            total: 4,
            reserve: 2,
            per_address: 3,
            reserve_per_address: 1,
            ..ConnectionLimits::default()
        };
        Arc::new(Places::new(limits))
    }

    fn address(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    #[test]
    fn one_address_cannot_have_all_places() {
        let places = places();
        let greedy = address("192.0.2.1");
        let held: Vec<Place> = (0..3).map(|_| places.take(greedy).expect("a place")).collect();
        assert!(places.take(greedy).is_none());
        assert!(places.take(address("192.0.2.2")).is_some_and(|place| !place.is_reserve));
        drop(held);
        assert!(places.take(greedy).is_some());
        assert!(places.taken.lock().expect("sound").is_empty());
    }

    #[test]
    fn what_is_beyond_all_places_gets_one_of_the_reserve_each() {
        let places = places();
        let local = address("127.0.0.1");
        let held: Vec<Place> = (0..4).map(|_| places.take(local).expect("a place")).collect();
        assert!(held.iter().all(|place| !place.is_reserve));
        let reserved = places.take(local).expect("a place in the reserve");
        assert!(reserved.is_reserve);
        assert!(places.take(local).is_none());
        let other = places.take(address("192.0.2.1")).expect("another place in the reserve");
        assert!(other.is_reserve);
        assert!(places.take(address("192.0.2.2")).is_none());
        drop(reserved);
        assert!(places.take(address("192.0.2.2")).is_some_and(|place| place.is_reserve));
    }

    #[test]
    fn addresses_of_one_network_count_as_one() {
        assert_eq!(network(address("2001:db8:1:2::3")), network(address("2001:db8:1:2:4:5:6:7")));
        assert_ne!(network(address("2001:db8:1:2::3")), network(address("2001:db8:1:3::3")));
        assert_eq!(network(address("::ffff:192.0.2.1")), address("192.0.2.1"));
        assert!(network(address("::1")).is_loopback());
    }
}
