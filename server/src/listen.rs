//! Connections: how many there may be, how long they may take to say what they want, and to take what they get.

use std::collections::{HashMap, VecDeque};
use std::io;
use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use axum::http::{Request, StatusCode};
use drillsweep_api::problem::PROBLEM_MEDIA_TYPE;
use drillsweep_api::{ProblemDetails, ProblemKind};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::gauge::Gauge;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio::time::Sleep;
use tower::ServiceExt as _;

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
    /// Of the reserve, connections at once of one address, be it this machine's. A connection that has asked nothing yet makes room for
    /// one that comes.
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

/// From where a request comes: a client's address, or that of a proxy before the server.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peer(pub(crate) SocketAddr);

/// Numbers of connections.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConnectionCounts {
    /// Open ones.
    pub(crate) open: Gauge,
    /// Those closed at once, since the start.
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
            counts.refused.inc();
            tracing::debug!(%address, "a connection beyond the limits is closed");
            continue;
        };
        let reserved = place.reserved.clone();
        let is_reserve = reserved.is_some();
        let asking = reserved.clone();
        let routes = routes.clone().map_request(move |mut request: Request<Incoming>| {
            request.extensions_mut().insert(Peer(address));
            if let Some(reserved) = &asking {
                reserved.has_asked.store(true, Ordering::Relaxed);
                request.extensions_mut().insert(InReserve);
            }
            request
        });
        let mut builder = http1::Builder::new();
        builder
            .timer(TokioTimer::new())
            .header_read_timeout(if is_reserve { limits.reserve_headers } else { limits.headers })
            .keep_alive(!is_reserve);
        let stream = TokioIo::new(Patient { stream, patience: limits.write, waiting: None, refusal: None });
        let connection = builder.serve_connection(stream, TowerToHyperService::new(routes));
        let connection = connections.watch(connection);
        let open = Open::new(counts.open.clone());
        tokio::spawn(async move {
            let outdone = async {
                match &reserved {
                    Some(reserved) => reserved.outdone.notified().await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                ended = connection => if let Err(error) = ended {
                    tracing::debug!(%error, %address, "a connection ended early");
                },
                () = outdone => tracing::debug!(%address, "a connection that asks nothing makes room"),
            }
            drop((place, open));
        });
    }
    drop(listener);
    connections.shutdown().await;
}

/// An open connection in a gauge.
struct Open(Gauge);

impl Open {
    fn new(gauge: Gauge) -> Self {
        gauge.inc();
        Self(gauge)
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        self.0.dec();
    }
}

/// Places for connections.
struct Places {
    limits: ConnectionLimits,
    general: Arc<Semaphore>,
    taken: Mutex<Taken>,
}

#[derive(Default)]
struct Taken {
    /// Connections by address.
    by_address: HashMap<IpAddr, usize>,
    /// Those in the reserve, in the order in which they came.
    reserve: Vec<Arc<Reserved>>,
}

/// A connection in the reserve.
struct Reserved {
    address: IpAddr,
    has_asked: AtomicBool,
    /// Another connection has taken the place of this one.
    outdone: Notify,
}

/// A connection's place; free again when it is dropped.
struct Place {
    places: Arc<Places>,
    address: IpAddr,
    /// None outside the reserve.
    reserved: Option<Arc<Reserved>>,
    _permit: Option<OwnedSemaphorePermit>,
}

impl Places {
    fn new(limits: ConnectionLimits) -> Self {
        Places { general: Arc::new(Semaphore::new(limits.total)), limits, taken: Mutex::default() }
    }

    fn take(self: &Arc<Self>, address: IpAddr) -> Option<Place> {
        let address = network(address);
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let all = taken.by_address.get(&address).copied().unwrap_or_default();
        if all >= self.limits.per_address && !address.is_loopback() {
            return None;
        }
        let permit = self.general.clone().try_acquire_owned().ok();
        let reserved = match permit {
            Some(_) => None,
            None => Some(self.reserve(&mut taken, address)?),
        };
        taken.by_address.insert(address, all + 1);
        Some(Place { places: self.clone(), address, reserved, _permit: permit })
    }

    /// A place in the reserve. Where all are taken, the oldest connection that has asked nothing yet loses its own: who opens many and
    /// stays silent must not keep out who asks.
    fn reserve(&self, taken: &mut Taken, address: IpAddr) -> Option<Arc<Reserved>> {
        let of_address = |reserved: &Reserved| reserved.address == address;
        let own = taken.reserve.iter().filter(|reserved| of_address(reserved)).count();
        let has_its_share = own >= self.limits.reserve_per_address;
        if has_its_share || taken.reserve.len() >= self.limits.reserve {
            let silent = taken.reserve.iter().position(|reserved| {
                !reserved.has_asked.load(Ordering::Relaxed) && (!has_its_share || of_address(reserved))
            });
            taken.reserve.remove(silent?).outdone.notify_one();
        }
        let reserved =
            Arc::new(Reserved { address, has_asked: AtomicBool::new(false), outdone: Notify::new() });
        taken.reserve.push(reserved.clone());
        Some(reserved)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.places.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(reserved) = &self.reserved {
            taken.reserve.retain(|other| !Arc::ptr_eq(other, reserved));
        }
        if let Some(all) = taken.by_address.get_mut(&self.address) {
            *all -= 1;
            if *all == 0 {
                taken.by_address.remove(&self.address);
            }
        }
    }
}

/// Network that counts as one address: an address of IPv4, a /64 of IPv6, which is what one customer gets at least.
pub(crate) fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) if !address.is_loopback() => {
            IpAddr::V6(Ipv6Addr::from_bits(address.to_bits() >> 64 << 64))
        }
        address => address,
    }
}

/// A connection that is given up when its client takes nothing of an answer for too long, and on which no refusal is without a problem.
struct Patient {
    stream: TcpStream,
    patience: Duration,
    /// Until when the client has to take something that waits for it.
    waiting: Option<Pin<Box<Sleep>>>,
    /// Rest of a refusal that stands in for one without a problem.
    refusal: Option<VecDeque<u8>>,
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

    /// Writes a refusal in place of `bytes`, if there is one.
    fn poll_refuse(&mut self, context: &mut Context<'_>, bytes: &[u8]) -> Option<Poll<io::Result<usize>>> {
        if self.refusal.is_none() {
            self.refusal = refusal(bytes).map(VecDeque::from);
        }
        let refusal = self.refusal.as_mut()?;
        let written = loop {
            if refusal.is_empty() {
                break Ok(bytes.len());
            }
            match Pin::new(&mut self.stream).poll_write(context, refusal.make_contiguous()) {
                Poll::Ready(Ok(0)) => break Err(io::ErrorKind::WriteZero.into()),
                Poll::Ready(Ok(count)) => drop(refusal.drain(..count)),
                Poll::Ready(Err(error)) => break Err(error),
                Poll::Pending => return Some(Poll::Pending),
            }
        };
        self.refusal = None;
        Some(Poll::Ready(written))
    }
}

/// Refusal in place of an answer that the HTTP library itself gives to a request that it does not read to its end: a target or header
/// so long that no route ever sees it. Such an answer has no body.
fn refusal(answer: &[u8]) -> Option<Vec<u8>> {
    let is_bare = || answer.windows(19).any(|window| window.eq_ignore_ascii_case(b"content-length: 0\r\n"));
    let (kind, what) = match answer.get(..12)? {
        b"HTTP/1.1 414" => (ProblemKind::TargetTooLong, "path and query"),
        b"HTTP/1.1 431" => (ProblemKind::HeaderTooLarge, "header fields"),
        _ => return None,
    };
    if !is_bare() {
        return None;
    }
    let problem = ProblemDetails::new(kind, format!("the request's {what} are too long to be read"));
    let body = serde_json::to_string(&problem).ok()?;
    let reason = StatusCode::from_u16(problem.status).ok()?.canonical_reason()?;
    let (status, length) = (problem.status, body.len());
    Some(
        format!(
            "HTTP/1.1 {status} {reason}\r\ncontent-type: {PROBLEM_MEDIA_TYPE}\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n{body}"
        )
        .into_bytes(),
    )
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
        let written = match self.poll_refuse(context, bytes) {
            Some(written) => written,
            None => Pin::new(&mut self.stream).poll_write(context, bytes),
        };
        self.watch(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let first = pieces.first().map_or(&[][..], |piece| piece);
        let written = match self.poll_refuse(context, first) {
            Some(written) => written,
            None => Pin::new(&mut self.stream).poll_write_vectored(context, pieces),
        };
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
        assert!(places.take(address("192.0.2.2")).is_some_and(|place| place.reserved.is_none()));
        drop(held);
        assert!(places.take(greedy).is_some());
        assert!(places.taken.lock().expect("sound").by_address.is_empty());
    }

    /// The reserved place of a connection that has asked for something.
    fn asking(places: &Arc<Places>, from: &str) -> Option<Place> {
        let place = places.take(address(from))?;
        place.reserved.as_ref().expect("a place in the reserve").has_asked.store(true, Ordering::Relaxed);
        Some(place)
    }

    #[test]
    fn what_is_beyond_all_places_gets_one_of_the_reserve_each() {
        let places = places();
        let local = address("127.0.0.1");
        let held: Vec<Place> = (0..4).map(|_| places.take(local).expect("a place")).collect();
        assert!(held.iter().all(|place| place.reserved.is_none()));
        let reserved = asking(&places, "127.0.0.1").expect("a place in the reserve");
        assert!(places.take(local).is_none());
        let _other = asking(&places, "192.0.2.1").expect("another place in the reserve");
        assert!(places.take(address("192.0.2.2")).is_none());
        drop(reserved);
        assert!(places.take(address("192.0.2.2")).is_some_and(|place| place.reserved.is_some()));
    }

    #[test]
    fn who_asks_nothing_makes_room_in_the_reserve() {
        let places = places();
        let _held: Vec<Place> = (0..4).map(|_| places.take(address("127.0.0.1")).expect("a place")).collect();
        let reserve_of = |places: &Places| {
            let taken = places.taken.lock().expect("sound");
            taken.reserve.iter().map(|reserved| reserved.address).collect::<Vec<_>>()
        };
        let silent = places.take(address("127.0.0.1")).expect("a place in the reserve");
        let asking_too = asking(&places, "127.0.0.1").expect("the place of the silent one");
        assert_eq!(reserve_of(&places), [address("127.0.0.1")]);
        drop(silent);
        assert_eq!(reserve_of(&places), [address("127.0.0.1")]);
        let _other = places.take(address("192.0.2.1")).expect("another place in the reserve");
        let _third = places.take(address("192.0.2.2")).expect("the place of the silent one");
        assert_eq!(reserve_of(&places), [address("127.0.0.1"), address("192.0.2.2")]);
        drop(asking_too);
    }

    #[test]
    fn refusals_without_a_problem_get_one() {
        let bare =
            b"HTTP/1.1 431 Request Header Fields Too Large\r\nconnection: close\r\ncontent-length: 0\r\n\r\n";
        let refused = String::from_utf8(refusal(bare).expect("a refusal")).expect("text");
        assert!(refused.starts_with("HTTP/1.1 431 Request Header Fields Too Large\r\n"), "{refused}");
        assert!(refused.contains("urn:drillsweep:problem:header-too-large"), "{refused}");
        for answer in [
            "HTTP/1.1 414 URI Too Long\r\ncontent-length: 120\r\n\r\n{}",
            "HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n",
            "HTTP/1.1 4",
        ] {
            assert_eq!(refusal(answer.as_bytes()), None, "{answer}");
        }
    }

    #[test]
    fn addresses_of_one_network_count_as_one() {
        assert_eq!(network(address("2001:db8:1:2::3")), network(address("2001:db8:1:2:4:5:6:7")));
        assert_ne!(network(address("2001:db8:1:2::3")), network(address("2001:db8:1:3::3")));
        assert_eq!(network(address("::ffff:192.0.2.1")), address("192.0.2.1"));
        assert!(network(address("::1")).is_loopback());
    }
}
