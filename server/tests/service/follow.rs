//! Following, cancelling and retrying sweeps.

use std::time::Duration;

use axum::body::Body;
use axum::http::Request;
use drillsweep_api::PHYSICS_VERSION;
use drillsweep_store::WorkerRecord;
use serde_json::{Value, json};
use tokio::time::{Instant, timeout};

use crate::bench::Bench;

fn two_points() -> Value {
    json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.04]}}})
}

/// Longer than anything here takes, shorter than the waits that must end early.
const SOON: Duration = Duration::from_secs(20);

#[tokio::test]
async fn a_sweep_counts_its_points_until_all_are_final() {
    let bench = Bench::new().await;
    let id = bench.submit(two_points()).await;
    let path = format!("/v1/sweeps/{id}");
    bench.succeed().await;
    let sweep = bench.get(&path).await.json();
    assert_eq!(sweep["state"], "running");
    assert_eq!(sweep["progress"], 0.5);
    bench.diverge().await;
    let sweep = bench.get(&path).await.json();
    assert_eq!(sweep["state"], "completed");
    assert_eq!(sweep["progress"], 1.0);
    assert_eq!(
        sweep["counts"],
        json!({"total": 2, "queued": 0, "running": 0, "succeeded": 1, "failed": 1, "cancelled": 0})
    );
    let finished: jiff::Timestamp = sweep["finished"].as_str().unwrap().parse().unwrap();
    let created: jiff::Timestamp = sweep["created"].as_str().unwrap().parse().unwrap();
    assert!(created <= finished);

    let point = bench.get(&format!("{path}/points/2")).await.json();
    assert_eq!(point["state"], "failed");
    assert_eq!(point["attempts"], 1);
    assert_eq!(
        point["error"],
        json!({"class": "physical", "reason": "the state is not finite", "time": 1.25, "node": 49})
    );
    let failed = bench.get(&format!("{path}/points?state=failed")).await.json();
    assert_eq!(failed["points"].as_array().unwrap().len(), 1);
    assert_eq!(failed["points"][0]["ordinal"], 2);
}

#[tokio::test]
async fn a_long_poll_ends_when_something_changes() {
    let bench = Bench::new().await;
    let id = bench.submit(two_points()).await;
    let path = format!("/v1/sweeps/{id}?wait=60s");
    let (waited, ()) =
        timeout(SOON, async { tokio::join!(bench.get(&path), bench.succeed()) }).await.unwrap();
    let sweep = waited.json();
    assert_ne!(sweep["counts"]["queued"], 2, "{sweep}");

    let path = format!("/v1/sweeps/{id}?wait=60s&until=completed");
    let (waited, ()) =
        timeout(SOON, async { tokio::join!(bench.get(&path), bench.succeed()) }).await.unwrap();
    assert_eq!(waited.json()["state"], "completed");
    let again = timeout(SOON, bench.get(&path)).await.expect("a finished sweep is answered at once");
    assert_eq!(again.json()["state"], "completed");
}

#[tokio::test]
async fn a_long_poll_ends_when_its_time_is_over() {
    let bench = Bench::new().await;
    let id = bench.submit(two_points()).await;
    let start = Instant::now();
    let sweep = bench.get(&format!("/v1/sweeps/{id}?wait=300ms")).await.json();
    assert!(start.elapsed() >= Duration::from_millis(300));
    assert_eq!(sweep["state"], "running");
}

#[tokio::test]
async fn a_long_poll_ends_when_the_service_stops() {
    let bench = Bench::new().await;
    let id = bench.submit(two_points()).await;
    let path = format!("/v1/sweeps/{id}?wait=60s");
    let stop = async { bench.stop.send(true).unwrap() };
    let (waited, ()) = timeout(SOON, async { tokio::join!(bench.get(&path), stop) }).await.unwrap();
    assert_eq!(waited.json()["state"], "running");
}

#[tokio::test]
async fn a_cancelled_sweep_can_be_retried() {
    let bench = Bench::new().await;
    let id = bench.submit(two_points()).await;
    bench.diverge().await;
    let post = async |action: &str| {
        let request = Request::post(format!("/v1/sweeps/{id}/{action}")).body(Body::empty()).unwrap();
        bench.send(request).await.json()
    };
    let cancelled = post("cancel").await;
    assert_eq!(cancelled["state"], "cancelled");
    assert_eq!(cancelled["counts"]["cancelled"], 1);
    assert_eq!(cancelled["counts"]["failed"], 1);
    assert_eq!(post("cancel").await["counts"], cancelled["counts"], "again changes nothing");
    let retried = post("retry").await;
    assert_eq!(retried["state"], "running");
    assert_eq!(retried["counts"]["queued"], 2);
    assert_eq!(retried["finished"], Value::Null);
    bench.succeed().await;
    bench.succeed().await;
    assert_eq!(bench.get(&format!("/v1/sweeps/{id}")).await.json()["state"], "completed");
}

#[tokio::test]
async fn sweeps_are_listed_newest_first_in_pages() {
    let bench = Bench::new().await;
    let mut ids = Vec::new();
    for number in 0..5 {
        let owner = if number == 2 { "ann" } else { "bob" };
        ids.push(
            bench.submit(json!({"preset": "paper-200m", "owner": owner, "name": number.to_string()})).await,
        );
    }
    ids.reverse();
    let mut listed = Vec::new();
    let mut path = "/v1/sweeps?limit=2".to_owned();
    loop {
        let page = bench.get(&path).await.json();
        let of_page = page["sweeps"].as_array().unwrap();
        assert!(of_page.len() <= 2);
        listed.extend(of_page.iter().map(|sweep| sweep["id"].as_str().unwrap().to_owned()));
        let Some(next) = page["next"].as_str() else { break };
        path = format!("/v1/sweeps?limit=2&cursor={next}");
    }
    assert_eq!(listed, ids);
    for (filter, expected) in
        [("state=running", 5), ("state=completed", 0), ("name=3&owner=bob", 1), ("name=x", 0)]
    {
        let found = bench.get(&format!("/v1/sweeps?{filter}")).await.json();
        assert_eq!(found["sweeps"].as_array().unwrap().len(), expected, "{filter}");
    }
    let of_ann = bench.get("/v1/sweeps?owner=ann").await.json();
    assert_eq!(of_ann["sweeps"].as_array().unwrap().len(), 1);
    assert_eq!(of_ann["sweeps"][0]["name"], "2");
}

#[tokio::test]
async fn sweeps_have_the_names_of_their_parameters_in_lists_and_alone() {
    let bench = Bench::new().await;
    let axis = json!({"values": [1200, 1300]});
    let grid = json!({"preset": "paper-200m", "axes": {"mud_density": axis, "operation.rotation_speed_rpm": {"values": [120]}}});
    let list =
        json!({"preset": "paper-200m", "design": "list", "points": [{"flow_rate": 0.01, "duration": 2}]});
    for (request, names) in [
        (grid, json!(["mud_density", "operation.rotation_speed_rpm"])),
        (list, json!(["flow_rate", "duration"])),
        (json!({"preset": "paper-200m"}), json!(null)),
    ] {
        let id = bench.submit(request).await;
        assert_eq!(bench.get("/v1/sweeps?limit=1").await.json()["sweeps"][0]["varied"], names);
        assert_eq!(bench.get(&format!("/v1/sweeps/{id}")).await.json()["varied"], names);
    }
}

#[tokio::test]
async fn long_requests_are_left_out_of_answers_and_served_alone() {
    let bench = Bench::new().await;
    let listed = |count: u32| {
        let points: Vec<_> =
            (0..count).map(|number| json!({"flow_rate": 0.01 + 1e-6 * f64::from(number)})).collect();
        json!({"preset": "paper-200m", "owner": "ann", "design": "list", "points": points})
    };
    let path = format!("/v1/sweeps/{}", bench.submit(listed(5_000)).await);
    for answer in ["", "?wait=10ms"] {
        let answer = bench.get(&format!("{path}{answer}")).await;
        assert!(answer.body.len() < 10_000, "{} bytes", answer.body.len());
        let sweep = answer.json();
        assert_eq!((&sweep["request"], &sweep["varied"]), (&json!(null), &json!(["flow_rate"])));
        let request = bench.get(sweep["links"]["request"].as_str().unwrap()).await.json();
        assert_eq!(request["points"], listed(5_000)["points"]);
    }
    let short = bench.submit(listed(3)).await;
    let sweep = bench.get(&format!("/v1/sweeps/{short}")).await.json();
    assert_eq!(sweep["request"], bench.get(&format!("/v1/sweeps/{short}/request")).await.json());
    assert_eq!(bench.get("/v1/sweeps/none/request").await.status, 404);

    // Points are added to the sweep by its stored request.
    let added = json!({"design": "list", "points": [{"flow_rate": 0.05}]});
    let sweep = bench.post(&format!("{path}/points"), added.clone()).await.json();
    assert_eq!(
        (&sweep["counts"]["total"], &sweep["appended"][0]["points"]),
        (&json!(5_001), &added["points"])
    );
}

#[tokio::test]
async fn a_sweep_reports_waiting_for_a_worker_of_its_version() {
    let bench = Bench::new().await;
    let physics = i64::from(PHYSICS_VERSION);
    let id =
        bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.02]}}})).await;
    let path = format!("/v1/sweeps/{id}");
    let waiting = async || bench.get(&path).await.json()["waiting_for"].clone();
    let nobody = waiting().await;
    assert_eq!(
        (&nobody["physics_version"], &nobody["worker_physics_versions"]),
        (&json!(physics), &json!([]))
    );
    assert!(nobody["reason"].as_str().unwrap().contains("no worker has sent a heartbeat"), "{nobody}");

    for version in [physics + 1, physics - 1] {
        bench.store.register_worker(&worker(version)).await.unwrap();
    }
    // One of its own version, but long silent.
    bench.later(Duration::from_secs(110)).await.register_worker(&worker(physics)).await.unwrap();
    let others = waiting().await;
    assert_eq!(others["worker_physics_versions"], json!([physics - 1, physics + 1]));
    assert_eq!(bench.get("/v1/sweeps").await.json()["sweeps"][0]["waiting_for"], others);
    let paused = bench.post(&format!("{path}/pause"), json!({})).await.json();
    assert_eq!(paused["waiting_for"], Value::Null, "it would not begin anyway");
    let resumed = bench.post(&format!("{path}/resume"), json!({})).await.json();
    assert_eq!(resumed["waiting_for"], others);

    // Who waits for a change hears of a worker that comes or goes, whichever comes first after the wait has begun.
    let come_and_go = async {
        loop {
            bench.store.register_worker(&worker(physics)).await.unwrap();
            tokio::time::sleep(Duration::from_secs(3)).await;
            bench.store.remove_worker(&worker(physics).id).await.unwrap();
            tokio::time::sleep(Duration::from_secs(3)).await;
        }
    };
    let poll = format!("{path}?wait=60s");
    let changed = async {
        tokio::select! {
            answer = bench.get(&poll) => answer.json(),
            () = come_and_go => unreachable!("it goes on"),
        }
    };
    assert_eq!(timeout(SOON, changed).await.unwrap()["counts"]["queued"], 2, "nothing else has changed");
    bench.store.register_worker(&worker(physics)).await.unwrap();
    assert_eq!(waiting().await, Value::Null);
}

fn worker(physics_version: i64) -> WorkerRecord {
    WorkerRecord {
        id: format!("worker of {physics_version}"),
        host: "rig".to_owned(),
        process: 42,
        version: "0.1.0".to_owned(),
        physics_version,
        started: 0,
        last_seen: 0,
    }
}
