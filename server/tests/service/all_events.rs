//! Following all sweeps as one stream of events.

use std::time::{Duration, Instant};

use axum::Router;
use axum::body::{Body, BodyDataStream};
use axum::http::{Request, StatusCode, header};
use futures::StreamExt;
use serde_json::{Value, json};
use tokio::sync::watch;
use tokio::time::timeout_at;
use tower::ServiceExt;

use crate::bench::Bench;

/// Far longer than any event takes.
const SOON: Duration = Duration::from_secs(20);

/// An event: its name, its id and its data.
type Event = (String, u64, Value);

/// A stream that is read as it comes.
struct Listening {
    body: BodyDataStream,
    text: String,
}

impl Listening {
    async fn to(bench: &Bench, query: &str) -> Self {
        let answer = bench.open(&format!("/v1/events{query}")).await;
        assert_eq!(answer.status(), StatusCode::OK);
        assert_eq!(answer.headers()[header::CONTENT_TYPE], "text/event-stream");
        Listening { body: answer.into_body().into_data_stream(), text: String::new() }
    }

    /// The next event; none once the stream has ended.
    async fn next(&mut self) -> Option<Event> {
        // A silent stream is kept open by comments.
        let latest = tokio::time::Instant::now() + SOON;
        loop {
            while let Some((block, rest)) = self.text.split_once("\n\n") {
                let event = parse(block);
                self.text = rest.to_owned();
                if event.is_some() {
                    return event;
                }
            }
            let piece = timeout_at(latest, self.body.next()).await.expect("something comes")?;
            self.text.push_str(std::str::from_utf8(&piece.unwrap()).unwrap());
        }
    }

    /// Events up to the first one for which `is_last` holds.
    async fn until(&mut self, is_last: impl Fn(&Event) -> bool) -> Vec<Event> {
        let mut events = Vec::new();
        loop {
            events.push(self.next().await.expect("the stream goes on"));
            if is_last(&events[events.len() - 1]) {
                return events;
            }
        }
    }
}

fn parse(block: &str) -> Option<Event> {
    let field = |name: &str| block.lines().find_map(|line| line.strip_prefix(name)).map(str::trim);
    let data = serde_json::from_str(field("data:")?).unwrap();
    Some((field("event:")?.to_owned(), field("id:")?.parse().unwrap(), data))
}

fn points(number: u32, extra: &Value) -> Value {
    let values: Vec<f64> = (0..number).map(|k| 0.01 + 1e-4 * f64::from(k)).collect();
    let mut body = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": values}}});
    body.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
    body
}

/// The event that tells that a sweep is complete.
fn completes(id: &str) -> impl Fn(&Event) -> bool {
    move |(name, _, sweep)| name == "sweep" && sweep["id"] == id && sweep["state"] == "completed"
}

fn ids(events: &[Event]) -> Vec<&str> {
    events.iter().map(|(_, _, sweep)| sweep["id"].as_str().unwrap()).collect()
}

#[tokio::test]
async fn whatever_happens_to_any_sweep_is_told_to_those_who_ask_for_it() {
    let bench = Bench::new().await;
    let mut all = Listening::to(&bench, "").await;
    let mut of_ann = Listening::to(&bench, "?owner=ann").await;
    let mut tagged = Listening::to(&bench, "?tag=base").await;
    let ann = bench.submit(points(1, &json!({"owner": "ann"}))).await;
    let bob = bench.submit(points(2, &json!({"owner": "bob", "tags": ["base"]}))).await;
    for _ in 0..2 {
        bench.succeed().await;
    }
    let events = all.until(completes(&bob)).await;
    assert!(ids(&events).contains(&ann.as_str()));
    assert!(events.iter().all(|(name, ..)| name == "sweep"));
    assert!(events.windows(2).all(|pair| pair[0].1 <= pair[1].1), "ids rise");
    let (_, _, sweep) = &events[events.len() - 1];
    let mut listed = bench.get(&format!("/v1/sweeps?id={bob}")).await.json();
    assert_eq!(*sweep, listed["sweeps"][0].take(), "as the list has it");
    assert!(ids(&of_ann.until(completes(&ann)).await).iter().all(|id| *id == ann));
    assert!(ids(&tagged.until(completes(&bob)).await).iter().all(|id| *id == bob));

    // What people change, of finished sweeps too.
    bench.patch(&format!("/v1/sweeps/{ann}"), json!({"name": "first"})).await;
    let renamed = of_ann.until(|(_, _, sweep)| sweep["name"] == "first").await;
    assert_eq!(renamed.len(), 1);
    let deletion = Request::delete(format!("/v1/sweeps/{ann}")).body(Body::empty()).unwrap();
    assert_eq!(bench.send(deletion).await.status, StatusCode::OK);
    let deleted = all.until(|(name, ..)| name == "deleted").await;
    assert_eq!(deleted[deleted.len() - 1].2, json!({"id": ann}));

    bench.stop.send(true).unwrap();
    for mut stream in [all, of_ann, tagged] {
        while stream.next().await.is_some() {}
    }
}

#[tokio::test]
async fn a_sweep_that_comes_and_goes_between_two_looks_is_told_to_be_gone_to_who_may_show_it() {
    let bench = Bench::new().await;
    // Whose stream has the service look for changes, a second later for the first time.
    let _first = Listening::to(&bench, "").await;
    let sweep = bench.submit(points(1, &json!({}))).await;
    bench.succeed().await;
    let mut second = Listening::to(&bench, "").await;
    let deletion = Request::delete(format!("/v1/sweeps/{sweep}")).body(Body::empty()).unwrap();
    assert_eq!(bench.send(deletion).await.status, StatusCode::OK);
    let events = second.until(|(name, ..)| name == "deleted").await;
    assert_eq!(events[events.len() - 1].2, json!({"id": sweep}));
}

#[tokio::test]
async fn a_stream_begins_with_what_is_not_final_and_is_resumed_at_any_server() {
    let bench = Bench::new().await;
    let before = u64::try_from(bench.store.now_ms().await.unwrap()).unwrap();
    let finished = bench.submit(points(1, &json!({}))).await;
    bench.succeed().await;
    let running = bench.submit(points(3, &json!({}))).await;
    let mut fresh = Listening::to(&bench, "").await;
    let (name, first, sweep) = fresh.next().await.unwrap();
    assert_eq!((name.as_str(), &sweep["id"]), ("sweep", &json!(running)));
    assert!(first >= before);

    // What became final since the last event is told, and what did so long before is not.
    let (_stop, stopping) = watch::channel(false);
    let another =
        drillsweep_server::router(bench.store.clone(), drillsweep_server::Config::default(), stopping);
    for (last_seen, expected) in [
        (before, vec![&finished, &running]),
        (before + 3_600_000, vec![&running]),
        (0, vec![&finished, &running]),
    ] {
        let mut resumed = resume(&another, last_seen).await;
        let events = resumed.until(|(_, _, sweep)| sweep["id"] == running).await;
        assert_eq!(ids(&events), expected);
        // One that breaks off before it has told of all is resumed where it was.
        if let [(_, first, _), (_, last, _)] = events.as_slice() {
            assert_eq!(*first, last_seen);
            assert!(*last > before);
        }
    }
    let wrong = Request::get("/v1/events").header("last-event-id", "x").body(Body::empty()).unwrap();
    bench.send(wrong).await.problem(400, "invalid-parameter");
}

async fn resume(service: &Router, last_seen: u64) -> Listening {
    let request = Request::get("/v1/events").header("last-event-id", last_seen).body(Body::empty()).unwrap();
    let answer = service.clone().oneshot(request).await.unwrap();
    Listening { body: answer.into_body().into_data_stream(), text: String::new() }
}

#[tokio::test]
async fn a_sweep_of_many_fast_points_is_told_of_once_a_second() {
    let bench = Bench::new().await;
    let mut stream = Listening::to(&bench, "").await;
    let start = Instant::now();
    let id = bench.submit(points(150, &json!({}))).await;
    let work = async {
        for _ in 0..150 {
            bench.diverge().await;
        }
    };
    let (events, ()) = tokio::join!(stream.until(completes(&id)), work);
    let looks = start.elapsed().as_secs() as usize + 1;
    assert!(events.len() <= looks, "{} events in {looks} s", events.len());
    assert_eq!(events[events.len() - 1].2["counts"]["failed"], 150);
}

#[tokio::test]
async fn both_kinds_of_streams_share_their_places() {
    let bench = Bench::new().await;
    let id = bench.submit(points(1, &json!({}))).await;
    let of_sweep = format!("/v1/sweeps/{id}/events");
    let mut open = Vec::new();
    for _ in 0..500 {
        for path in ["/v1/events", &of_sweep] {
            let answer = bench.open(path).await;
            assert_eq!(answer.status(), StatusCode::OK);
            open.push(answer);
        }
    }
    bench.get("/v1/events").await.problem(503, "unavailable");
    open.pop();
    Listening::to(&bench, "").await.next().await.unwrap();
}
