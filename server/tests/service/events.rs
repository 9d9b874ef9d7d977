//! Following a sweep as a stream of events.

use std::time::Duration;

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use drillsweep_server::{Config, Listeners, serve};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::time::timeout;

use crate::bench::Bench;

/// Far less than a stream would stay open, far more than an answer takes.
const SOON: Duration = Duration::from_secs(20);

fn three_points() -> Value {
    json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.02, 0.04]}}})
}

/// The events of a stream that has ended: name, id and data of each.
fn parse(text: &str) -> Vec<(String, u64, Value)> {
    let blocks = text.split("\n\n").filter(|block| block.lines().any(|line| line.starts_with("data:")));
    let event = |block: &str| {
        let field =
            |name: &str| block.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default().trim();
        (
            field("event:").to_owned(),
            field("id:").parse().unwrap(),
            serde_json::from_str(field("data:")).unwrap(),
        )
    };
    blocks.map(event).collect()
}

async fn stream(bench: &Bench, id: &str, last_seen: Option<u64>) -> Vec<(String, u64, Value)> {
    let mut request = Request::get(format!("/v1/sweeps/{id}/events"));
    if let Some(last_seen) = last_seen {
        request = request.header("last-event-id", last_seen);
    }
    let answer =
        timeout(SOON, bench.send(request.body(Body::empty()).unwrap())).await.expect("the stream ends");
    assert_eq!(answer.headers[header::CONTENT_TYPE], "text/event-stream");
    parse(answer.text())
}

#[tokio::test]
async fn a_stream_reports_every_change_and_ends_with_the_sweep() {
    let bench = Bench::new().await;
    let id = bench.submit(three_points()).await;
    let work = async {
        bench.succeed().await;
        bench.diverge().await;
        bench.succeed().await;
    };
    let (events, ()) = tokio::join!(stream(&bench, &id, Some(0)), work);
    let of_points: Vec<_> = events.iter().filter(|(name, ..)| name == "point").collect();
    let told: Vec<_> = of_points.iter().map(|(_, _, data)| (&data["ordinals"][0], &data["state"])).collect();
    let expected =
        [(1, "running"), (1, "succeeded"), (2, "running"), (2, "failed"), (3, "running"), (3, "succeeded")];
    assert_eq!(told.len(), expected.len());
    let mut ordinals = std::collections::BTreeSet::new();
    for ((ordinal, state), (_, expected)) in told.iter().zip(expected) {
        assert_eq!(*state, expected);
        ordinals.insert(ordinal.as_u64().unwrap());
    }
    assert_eq!(ordinals.len(), 3, "three different points");
    assert!(events.windows(2).all(|pair| pair[0].1 <= pair[1].1), "ids rise");
    let (name, last, sweep) = events.last().unwrap();
    assert_eq!((name.as_str(), &sweep["state"]), ("sweep", &json!("completed")));
    assert_eq!(sweep["counts"]["succeeded"], 2);

    // From the middle on nothing is told twice, and from the end on nothing at all.
    let middle = of_points[3].1;
    let rest = stream(&bench, &id, Some(middle)).await;
    let rest_of_points: Vec<_> = rest.iter().filter(|(name, ..)| name == "point").cloned().collect();
    assert_eq!(rest_of_points, of_points[4..].iter().map(|event| (*event).clone()).collect::<Vec<_>>());
    // Who was cut off between the last point and the end hears of the end.
    let last_point = of_points[5].1;
    assert!(last_point < *last);
    let end = stream(&bench, &id, Some(last_point)).await;
    assert_eq!(end, [(name.clone(), *last, sweep.clone())]);
    let request = Request::get(format!("/v1/sweeps/{id}/events?after={last}")).body(Body::empty()).unwrap();
    assert_eq!(bench.send(request).await.status, StatusCode::NO_CONTENT);
    // Without a last event the stream begins with the sweep as it stands.
    let fresh = stream(&bench, &id, None).await;
    assert_eq!(fresh.len(), 1);
    assert_eq!(fresh[0].2["state"], "completed");
    bench.get("/v1/sweeps/none/events").await.problem(404, "not-found");
}

#[tokio::test]
async fn a_batch_larger_than_a_page_is_reported_whole() {
    let bench = Bench::new().await;
    let values: Vec<f64> = (0..700).map(|k| 0.01 + 1e-5 * f64::from(k)).collect();
    let id = bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": values}}})).await;
    bench.store.cancel_sweep(&id).await.unwrap();
    let events = stream(&bench, &id, Some(0)).await;
    let ordinals: std::collections::BTreeSet<u64> = events
        .iter()
        .filter(|(name, ..)| name == "point")
        .map(|(_, _, data)| data["ordinals"][0].as_u64().unwrap())
        .collect();
    assert_eq!(ordinals, (1..=700).collect());
}

#[tokio::test]
async fn twenty_open_streams_do_not_hold_the_service_up() {
    let bench = Bench::new().await;
    let id = bench.submit(three_points()).await;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (stop, stopped) = oneshot::channel::<()>();
    let shutdown = async {
        let _ = stopped.await;
    };
    let listeners = Listeners { api: listener, metrics: None };
    let service = tokio::spawn(serve(listeners, bench.store.clone(), Config::default(), shutdown));
    let mut connections = Vec::new();
    for _ in 0..20 {
        let mut connection = TcpStream::connect(address).await.unwrap();
        let request = format!("GET /v1/sweeps/{id}/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
        connection.write_all(request.as_bytes()).await.unwrap();
        let mut seen = String::new();
        while !seen.contains("event: sweep") {
            let mut buffer = [0; 4096];
            let length = timeout(SOON, connection.read(&mut buffer)).await.unwrap().unwrap();
            assert!(length > 0, "{seen}");
            seen.push_str(std::str::from_utf8(&buffer[..length]).unwrap());
        }
        connections.push(connection);
    }
    stop.send(()).unwrap();
    // Streams that held it up would end in an error after its patience of 10 s.
    timeout(SOON, service).await.expect("the service ends").unwrap().unwrap();
    for mut connection in connections {
        let mut rest = Vec::new();
        timeout(SOON, connection.read_to_end(&mut rest)).await.expect("the stream ends").unwrap();
    }
}

#[tokio::test]
async fn a_thousand_streams_are_open_at_most() {
    let bench = Bench::new().await;
    let path = format!("/v1/sweeps/{}/events", bench.submit(three_points()).await);
    let mut open = Vec::new();
    for _ in 0..1000 {
        let answer = bench.open(&path).await;
        assert_eq!(answer.status(), StatusCode::OK);
        open.push(answer);
    }
    bench.get(&path).await.problem(503, "unavailable");
    open.pop();
    assert_eq!(bench.open(&path).await.status(), StatusCode::OK);
}
