//! Control of a sweep by its owner after submitting it.

use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use serde_json::{Value, json};

use crate::bench::{Answer, Bench, json_request};

#[tokio::test]
async fn a_paused_sweep_says_so_and_goes_on_when_resumed() {
    let bench = Bench::new().await;
    let id =
        bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.02]}}})).await;
    let paused = bench.post(&format!("/v1/sweeps/{id}/pause"), json!({})).await.json();
    assert_eq!(paused["state"], "paused");
    let resumed = bench.post(&format!("/v1/sweeps/{id}/resume"), json!({})).await.json();
    assert_eq!(resumed["state"], "running");
    for _ in 0..2 {
        bench.succeed().await;
    }
    let path = format!("/v1/sweeps/{id}");
    assert_eq!(bench.get(&path).await.json()["state"], "completed");
    bench.post("/v1/sweeps/none/pause", json!({})).await.problem(404, "not-found");
}

#[tokio::test]
async fn editable_fields_of_a_sweep_change_alone_or_together() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m", "name": "a", "tags": ["x", "campaign-7"]})).await;
    let path = format!("/v1/sweeps/{id}");
    let sweep = bench.get(&path).await.json();
    assert_eq!((&sweep["name"], &sweep["tags"]), (&json!("a"), &json!(["campaign-7", "x"])));
    let sweep = bench.patch(&path, json!({"priority": 4, "tags": []})).await.json();
    assert_eq!((&sweep["name"], &sweep["priority"]), (&json!("a"), &json!(4)));
    assert!(sweep.get("tags").is_none());
    let sweep = bench.patch(&path, json!({"name": null})).await.json();
    assert!(sweep.get("name").is_none());
    let sweep = bench.patch(&path, json!({"pinned": true, "expires": "2100-01-02T03:04:05Z"})).await.json();
    assert_eq!(
        (&sweep["pinned"], &sweep["expires"], &sweep["priority"]),
        (&json!(true), &json!("2100-01-02T03:04:05Z"), &json!(4))
    );
    let sweep = bench.patch(&path, json!({"expires": null})).await.json();
    assert_eq!((sweep.get("expires"), &sweep["pinned"]), (None, &json!(true)));
    bench.patch(&path, json!({"expires": "tomorrow"})).await.problem(400, "malformed-body");
    let problem = bench
        .patch(&path, json!({"name": "", "priority": 99, "tags": [""]}))
        .await
        .problem(422, "invalid-request");
    let pointers: Vec<_> =
        problem["errors"].as_array().unwrap().iter().map(|error| &error["pointer"]).collect();
    assert_eq!(pointers, ["/name", "/priority", "/tags/0"]);
    bench.patch(&path, json!({"owner": "bert"})).await.problem(400, "malformed-body");
    bench.patch("/v1/sweeps/none", json!({})).await.problem(404, "not-found");
}

#[tokio::test]
async fn points_are_added_over_the_parameters_of_the_sweep() {
    let bench = Bench::new().await;
    let id =
        bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.03]}}})).await;
    let path = format!("/v1/sweeps/{id}/points");
    // A finer grid as a whole: the two points that are there stay as they are.
    let finer = json!({"axes": {"mud.flow_rate": {"from": 0.01, "to": 0.03, "count": 3, "scale": "linear"}}});
    let sweep = bench.post(&path, finer.clone()).await.json();
    assert_eq!(
        (&sweep["counts"]["total"], &sweep["appended"]),
        (&json!(3), &json!([{"design": "grid", "axes": finer["axes"]}]))
    );
    let points = bench.get(&path).await.json();
    let added = &points["points"][2];
    assert_eq!(added["ordinal"], 3);
    // Under the name that the sweep has for it, whatever the new points are asked for by.
    let flow_rate = added["parameters"]["flow_rate"].as_f64().unwrap();
    assert!((flow_rate - 0.02).abs() < 1e-15);
    assert_eq!(added["parameters"].as_object().unwrap().len(), 2);
    assert_eq!(bench.get(&format!("{path}/3")).await.json()["scenario"]["mud"]["flow_rate"], flow_rate);
    let drawn = json!({"design": "sobol", "samples": 4, "axes": {"flow_rate": {"from": 0.01, "to": 0.03}}});
    assert_eq!(bench.post(&path, drawn).await.json()["counts"]["total"], 7);

    let other = json!({"axes": {"mud_density": {"values": [1300]}}});
    let problem = bench.post(&path, other).await.problem(422, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/axes");
    bench.post(&format!("/v1/sweeps/{id}/cancel"), json!({})).await;
    bench.post(&path, finer).await.problem(409, "conflict");
    bench.post("/v1/sweeps/none/points", json!({})).await.problem(404, "not-found");
}

#[tokio::test]
async fn sweeps_are_listed_by_tag_and_state() {
    let bench = Bench::new().await;
    let tagged = bench.submit(json!({"preset": "paper-200m", "tags": ["campaign-7", "x"]})).await;
    let other = bench.submit(json!({"preset": "paper-200m", "tags": ["campaign"]})).await;
    bench.post(&format!("/v1/sweeps/{other}/pause"), json!({})).await;
    let listed = async |query: &str| -> Vec<String> {
        let page = bench.get(&format!("/v1/sweeps?{query}")).await.json();
        let ids = page["sweeps"].as_array().unwrap().iter();
        ids.map(|sweep| sweep["id"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(listed("tag=campaign-7").await, [tagged.as_str()]);
    assert_eq!(listed("tag=campaign").await, [other.as_str()]);
    assert_eq!(listed("state=running").await, [tagged]);
    assert_eq!(listed("state=paused").await, [other]);
}

#[tokio::test]
async fn the_cache_is_used_refreshed_or_all_there_is() {
    let bench = Bench::new().await;
    let body = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.02]}}});
    let first = bench.submit(body.clone()).await;
    bench.succeed().await;
    let problem = bench.post("/v1/sweeps?cache=only", body.clone()).await.problem(409, "no-result");
    assert!(
        problem["detail"]
            .as_str()
            .unwrap()
            .ends_with("1 of 2 points have not been computed, and cache=only computes none: 2")
    );
    bench.succeed().await;
    for query in ["", "?cache=reuse", "?cache=only"] {
        let sweep = bench.post(&format!("/v1/sweeps{query}"), body.clone()).await.json();
        assert_eq!(
            (&sweep["counts"]["succeeded"], &sweep["state"]),
            (&json!(2), &json!("completed")),
            "{query}"
        );
    }
    let known = async |query: &str| {
        bench.post(&format!("/v1/sweeps?dry_run=true{query}"), body.clone()).await.json()["known"].clone()
    };
    assert_eq!((known("").await, known("&cache=refresh").await), (json!(2), json!(0)));
    // Another policy is another request.
    let keyed = async |query: &str| {
        let mut request = json_request(Method::POST, &format!("/v1/sweeps{query}"), body.to_string());
        request.headers_mut().insert("idempotency-key", "once".parse().unwrap());
        bench.send(request).await
    };
    assert_eq!(keyed("").await.status, 201);
    keyed("?cache=refresh").await.problem(422, "idempotency-key-reused");
    let sweep = bench.post("/v1/sweeps?cache=refresh", body.clone()).await.json();
    assert_eq!(sweep["counts"]["queued"], 2);
    // What was there is served until the new result is.
    let profile = format!("/v1/sweeps/{first}/points/1/profile");
    assert_eq!(bench.get(&profile).await.status, 200);
    assert_eq!(bench.post("/v1/sweeps?cache=only", body.clone()).await.status, 201);
    for _ in 0..2 {
        bench.succeed().await;
    }
    assert_eq!(bench.get(&profile).await.status, 200);
    assert_eq!(bench.get(&format!("/v1/sweeps/{first}")).await.json()["state"], "completed");
    bench.post("/v1/sweeps?cache=none", body).await.problem(400, "invalid-parameter");
}

#[tokio::test]
async fn dead_work_is_listed_over_all_sweeps() {
    let bench = Bench::new().await;
    let mut ids = Vec::new();
    for (owner, flow_rate) in [("anne", 0.01), ("bert", 0.02)] {
        let body = json!({"preset": "paper-200m", "owner": owner, "set": {"mud.flow_rate": flow_rate}});
        ids.push(bench.submit(body).await);
        bench.diverge().await;
    }
    let page = bench.get("/v1/failures").await.json();
    assert_eq!(page["failures"].as_array().unwrap().len(), 2);
    let path = "/v1/failures?owner=bert&class=physical&limit=1";
    let page = bench.get(path).await.json();
    let failure = &page["failures"][0];
    assert_eq!(
        (&failure["sweep"], &failure["owner"], &failure["ordinal"], &failure["error"]["node"]),
        (&json!(ids[1]), &json!("bert"), &json!(1), &json!(49))
    );
    assert_eq!(failure["links"]["self"], format!("/v1/sweeps/{}/points/1", ids[1]));
    assert!(page.get("next").is_none());
    assert_eq!(bench.get("/v1/failures?class=crash").await.json()["failures"], json!([]));

    let first = bench.get("/v1/failures?limit=1").await.json();
    let next = first["next"].as_str().unwrap();
    let second = bench.get(&format!("/v1/failures?limit=1&cursor={next}")).await.json();
    let seen: std::collections::BTreeSet<_> =
        [&first, &second].map(|page| page["failures"][0]["sweep"].as_str().unwrap()).into();
    assert_eq!(seen, ids.iter().map(String::as_str).collect());
    assert!(second.get("next").is_none());
    for query in ["cursor=1", "cursor=x.1.y", "class=unlucky", "limit=501"] {
        bench.get(&format!("/v1/failures?{query}")).await.problem(400, "invalid-parameter");
    }
}

async fn change_if(bench: &Bench, path: &str, tag: &str, body: Value) -> Answer {
    let mut request = json_request(Method::PATCH, path, body.to_string());
    request.headers_mut().insert(header::IF_MATCH, tag.parse().unwrap());
    bench.send(request).await
}

#[tokio::test]
async fn a_change_of_an_outdated_revision_is_refused() {
    let bench = Bench::new().await;
    let id =
        bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.02]}}})).await;
    let path = format!("/v1/sweeps/{id}");
    let read = bench.get(&path).await;
    let tag = read.headers[header::ETAG].to_str().unwrap().to_owned();
    let again = bench.send(
        axum::http::Request::get(&path)
            .header("if-none-match", &tag)
            .body(axum::body::Body::empty())
            .unwrap(),
    );
    assert_eq!(again.await.status, StatusCode::NOT_MODIFIED);

    // A point that goes on changes the answer and its tag, but is nobody's decision.
    bench.succeed().await;
    let current = bench.get(&path).await.headers[header::ETAG].to_str().unwrap().to_owned();
    assert_ne!(current, tag);
    let changed = change_if(&bench, &path, &tag, json!({"name": "anne's"})).await;
    assert_eq!(changed.status, StatusCode::OK, "{}", changed.text());
    let late = change_if(&bench, &path, &tag, json!({"name": "bob's"})).await;
    late.problem(412, "precondition-failed");
    assert_eq!(bench.get(&path).await.json()["name"], "anne's");
    // The answer to a change has the tag for the next one.
    let tag = changed.headers[header::ETAG].to_str().unwrap().to_owned();
    assert_eq!(
        change_if(&bench, &path, &format!("\"other\", {tag}"), json!({"priority": 3})).await.status,
        200
    );
    assert_eq!(change_if(&bench, &path, "*", json!({"priority": 4})).await.status, 200);
    for void in ["\"other\"", "", &format!("W/{tag}")] {
        change_if(&bench, &path, void, json!({"priority": 5})).await.problem(412, "precondition-failed");
    }
    change_if(&bench, "/v1/sweeps/none", "*", json!({"priority": 5})).await.problem(404, "not-found");
}

#[tokio::test]
async fn a_time_that_is_over_is_refused() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let path = format!("/v1/sweeps/{id}");
    let problem =
        bench.patch(&path, json!({"expires": "2020-01-01T00:00:00Z"})).await.problem(422, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/expires");
    assert!(problem["errors"][0]["detail"].as_str().unwrap().contains("in the future"), "{problem}");
    assert_eq!(bench.patch(&path, json!({"expires": "2999-01-01T00:00:00Z"})).await.status, StatusCode::OK);
}

#[tokio::test]
async fn a_sweep_is_deleted_when_that_is_meant() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let path = format!("/v1/sweeps/{id}");
    let delete = async |query: &str| {
        let request = axum::http::Request::delete(format!("{path}{query}"));
        bench.send(request.body(axum::body::Body::empty()).unwrap()).await
    };
    delete("").await.problem(409, "conflict");
    bench.succeed().await;
    assert_eq!(bench.patch(&path, json!({"pinned": true})).await.status, StatusCode::OK);
    let problem = delete("").await.problem(409, "conflict");
    assert!(problem["detail"].as_str().unwrap().contains("pinned"), "{problem}");
    assert_eq!(bench.patch(&path, json!({"pinned": false})).await.status, StatusCode::OK);
    let told = delete("?dry_run=true").await.json();
    assert_eq!((&told["dry_run"], &told["points"], &told["results"]), (&json!(true), &json!(1), &json!(1)));
    assert!(told["bytes"].as_u64().unwrap() > 0);
    assert_eq!(bench.get(&path).await.status, StatusCode::OK);
    assert_eq!(delete("").await.json()["dry_run"], false);
    bench.get(&path).await.problem(404, "not-found");
    delete("").await.problem(404, "not-found");

    let retention = bench.get("/v1/retention").await.json();
    assert_eq!((&retention["recordings_days"], &retention["last"]), (&json!(30.0), &Value::Null));
    let policy = drillsweep_server::RetentionConfig::default().policy;
    bench.store.collect_garbage(&policy, false).await.unwrap();
    let last = bench.get("/v1/retention").await.json()["last"].clone();
    assert_eq!(last["deleted"]["results"], 1, "{last}");
    let time = |name: &str| last[name].as_str().unwrap().parse::<jiff::Timestamp>().unwrap();
    assert!(time("ended") >= time("started"), "{last}");
}

#[tokio::test]
async fn a_list_is_unchanged_until_one_of_its_sweeps_changes() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m", "owner": "ann"})).await;
    let tag = bench.get("/v1/sweeps?owner=ann").await.headers[header::ETAG].clone();
    let again = async || {
        let request = Request::get("/v1/sweeps?owner=ann").header(header::IF_NONE_MATCH, &tag);
        bench.send(request.body(Body::empty()).unwrap()).await.status
    };
    assert_eq!(again().await, StatusCode::NOT_MODIFIED);
    bench.submit(json!({"preset": "paper-200m", "owner": "bob"})).await;
    assert_eq!(again().await, StatusCode::NOT_MODIFIED);
    bench.succeed().await;
    assert_eq!(again().await, StatusCode::OK, "a point of {id} has ended");
}
