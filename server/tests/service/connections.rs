//! Clients that hold connections and say nothing, or too slowly, or take nothing: the others are served all the same.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;

use drillsweep_server::{Config, ConnectionLimits, Listeners, serve};
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::time::timeout;

use crate::bench::Bench;

/// Far more than an answer takes.
const SOON: Duration = Duration::from_secs(20);

/// Far more than a test takes.
const NEVER: Duration = Duration::from_secs(3_600);

/// Another address of this machine.
const ATTACKER: IpAddr = IpAddr::V4(Ipv4Addr::new(127, 0, 0, 2));

struct Service {
    bench: Bench,
    address: SocketAddr,
    stop: oneshot::Sender<()>,
    running: JoinHandle<Result<(), drillsweep_server::ServeError>>,
}

impl Service {
    async fn start(connections: ConnectionLimits) -> Self {
        let bench = Bench::new().await;
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel();
        let config = Config { connections, poll_interval: Duration::from_millis(10), ..Config::default() };
        let listeners = Listeners { api: listener, metrics: None };
        let running = tokio::spawn(serve(listeners, bench.store.clone(), config, async {
            let _ = stopped.await;
        }));
        Service { bench, address, stop, running }
    }

    async fn connect(&self, request: &str) -> TcpStream {
        let mut connection = TcpStream::connect(self.address).await.unwrap();
        // One that is closed already may take it or not.
        let _ = connection.write_all(request.as_bytes()).await;
        connection
    }

    /// A connection from elsewhere on which a request is begun and not ended.
    async fn half_open(&self) -> TcpStream {
        self.half_open_from(ATTACKER).await
    }

    async fn half_open_from(&self, address: IpAddr) -> TcpStream {
        let socket = TcpSocket::new_v4().unwrap();
        socket.bind(SocketAddr::new(address, 0)).unwrap();
        let mut connection = socket.connect(self.address).await.unwrap();
        let _ = connection.write_all(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n").await;
        connection
    }

    /// The answer to a request on a connection of its own.
    async fn ask(&self, path: &str) -> String {
        let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        rest(&mut self.connect(&request).await).await
    }

    /// Waits until a request of any kind is answered.
    async fn has_room(&self) {
        let served = async {
            while !self.ask("/v1/sweeps").await.starts_with("HTTP/1.1 200") {
                tokio::task::yield_now().await;
            }
        };
        timeout(SOON, served).await.expect("there is room again");
    }

    async fn end(self) {
        self.stop.send(()).unwrap();
        timeout(SOON, self.running).await.expect("the service ends").unwrap().unwrap();
    }
}

/// Reads until the connection ends.
async fn rest(connection: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    // An end by force is an end.
    let _ = timeout(SOON, connection.read_to_end(&mut bytes)).await.expect("the connection ends");
    String::from_utf8(bytes).unwrap()
}

/// Reads until a text has come.
async fn read_until(connection: &mut TcpStream, text: &str) {
    let mut seen = String::new();
    while !seen.contains(text) {
        let mut buffer = [0; 4096];
        let length = timeout(SOON, connection.read(&mut buffer)).await.expect(text).unwrap();
        assert!(length > 0, "{seen}");
        seen.push_str(std::str::from_utf8(&buffer[..length]).unwrap());
    }
}

#[tokio::test]
async fn half_open_connections_make_room() {
    requests_are_answered_next_to_half_open_connections_of(ATTACKER).await;
}

/// Behind a proxy, and on this machine, all connections have one address.
#[tokio::test]
async fn half_open_connections_of_the_same_address_make_room() {
    requests_are_answered_next_to_half_open_connections_of(IpAddr::V4(Ipv4Addr::LOCALHOST)).await;
}

async fn requests_are_answered_next_to_half_open_connections_of(attacker: IpAddr) {
    let limits = ConnectionLimits { total: 30, reserve: 8, headers: NEVER, ..ConnectionLimits::default() };
    let service = Service::start(limits).await;
    let mut attack = Vec::new();
    for _ in 0..200 {
        attack.push(service.half_open_from(attacker).await);
    }
    for path in ["/livez", "/readyz", "/v1/queue", "/v1/sweeps"] {
        let answer = service.ask(path).await;
        assert!(answer.starts_with("HTTP/1.1 200"), "{path}: {answer}");
    }
    drop(attack);
    service.end().await;
}

#[tokio::test]
async fn busy_connections_leave_room_for_health() {
    let service = Service::start(ConnectionLimits { total: 3, ..ConnectionLimits::default() }).await;
    let id = service.bench.submit(json!({"preset": "paper-200m"})).await;
    let mut streams = Vec::new();
    for _ in 0..3 {
        let request = format!("GET /v1/sweeps/{id}/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
        let mut stream = service.connect(&request).await;
        read_until(&mut stream, "event: sweep").await;
        streams.push(stream);
    }
    for light in ["/livez", "/readyz", "/v1/queue"] {
        let answer = service.ask(light).await;
        assert!(answer.starts_with("HTTP/1.1 200"), "{light}: {answer}");
    }
    let heavy = service.ask("/v1/sweeps").await;
    assert!(heavy.starts_with("HTTP/1.1 503") && heavy.contains("retry-after: "), "{heavy}");
    assert!(heavy.contains("urn:drillsweep:problem:unavailable"), "{heavy}");
    // Once they are gone there is room for everything.
    drop(streams);
    service.has_room().await;
    service.end().await;
}

/// RFC 9110 section 8.6: a length that is known is stated.
#[tokio::test]
async fn an_answer_of_known_length_states_it() {
    let service = Service::start(ConnectionLimits::default()).await;
    let answer = service.ask("/v1/sweeps").await;
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    let length = format!("content-length: {}", body.len());
    assert!(head.lines().any(|line| line == length), "{answer}");
    service.end().await;
}

#[tokio::test]
async fn a_target_too_long_to_be_read_is_refused() {
    let service = Service::start(ConnectionLimits::default()).await;
    let target = format!("GET /v1/sweeps?name={} HTTP/1.1\r\nHost: localhost\r\n\r\n", "x".repeat(70_000));
    let answer = rest(&mut service.connect(&target).await).await;
    assert!(answer.starts_with("HTTP/1.1 414 URI Too Long\r\n"), "{answer}");
    service.end().await;
}

#[tokio::test]
async fn half_open_connections_end_by_themselves() {
    let short = Duration::from_millis(100);
    let limits = ConnectionLimits { headers: short, ..ConnectionLimits::default() };
    let service = Service::start(limits).await;
    let mut begun = service.half_open().await;
    let mut silent = service.connect("").await;
    for connection in [&mut begun, &mut silent] {
        assert!(!rest(connection).await.starts_with("HTTP/1.1 200"));
    }
    // And so does one that is kept open after an answer.
    let mut idle = service.connect("GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n").await;
    assert!(rest(&mut idle).await.starts_with("HTTP/1.1 200"));
    service.end().await;
}

#[tokio::test]
async fn a_body_that_does_not_come_is_given_up() {
    let limits = ConnectionLimits { body: Duration::from_millis(100), ..ConnectionLimits::default() };
    let service = Service::start(limits).await;
    let request = "POST /v1/sweeps HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n\
                   Content-Length: 1000\r\n\r\n{\"preset\": ";
    let mut slow = service.connect(request).await;
    let answer = rest(&mut slow).await;
    assert!(answer.starts_with("HTTP/1.1 408"), "{answer}");
    assert!(answer.contains("urn:drillsweep:problem:request-timeout"), "{answer}");
    service.end().await;
}

#[tokio::test]
async fn streams_and_long_polls_outlast_every_time_limit() {
    let short = Duration::from_millis(200);
    let limits =
        ConnectionLimits { headers: short, body: short, write: short, ..ConnectionLimits::default() };
    let service = Service::start(limits).await;
    let id = service.bench.submit(json!({"preset": "paper-200m"})).await;
    let path = format!("/v1/sweeps/{id}");
    let mut stream = service.connect(&format!("GET {path}/events HTTP/1.1\r\nHost: localhost\r\n\r\n")).await;
    read_until(&mut stream, "event: sweep").await;
    let request = format!("GET {path}?wait=60s&until=completed HTTP/1.1\r\nHost: localhost\r\n\r\n");
    let mut poll = service.connect(&request).await;
    // Ten connections that say nothing, one after the other, are ended by the time limit meanwhile.
    for _ in 0..10 {
        assert!(!rest(&mut service.connect("").await).await.contains("200"));
    }
    service.bench.succeed().await;
    read_until(&mut poll, "\"state\":\"completed\"").await;
    read_until(&mut stream, "\"state\":\"completed\"").await;
    service.end().await;
}

#[tokio::test]
async fn a_client_that_takes_nothing_of_an_answer_is_cut_off() {
    let limits =
        ConnectionLimits { write: Duration::from_millis(200), total: 1, ..ConnectionLimits::default() };
    let service = Service::start(limits).await;
    let requests = "GET /v1/scenarios/paper-200m HTTP/1.1\r\nHost: localhost\r\n\r\n".repeat(2_000);
    let mut greedy = TcpStream::connect(service.address).await.unwrap();
    let (_kept, mut sending) = greedy.split();
    // It asks on and on, more than the buffers of both ends hold, and reads nothing, until nobody listens any more.
    let cut = async { while sending.write_all(requests.as_bytes()).await.is_ok() {} };
    timeout(SOON, cut).await.expect("it is cut off");
    // Its place is free.
    service.has_room().await;
    service.end().await;
}
