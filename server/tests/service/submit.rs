//! Submitting sweeps and runs.

use axum::http::{Method, StatusCode, header};
use serde_json::{Value, json};

use crate::bench::{Bench, json_request};

fn grid() -> Value {
    json!({"name": "grid", "preset": "paper-200m", "axes": {
        "flow_rate": {"values": [0.01, 0.04, 0.06]},
        "mud_density": {"from": 1200, "to": 2100, "count": 4}
    }})
}

#[tokio::test]
async fn a_sweep_is_stored_with_all_its_points() {
    let bench = Bench::new().await;
    let answer = bench.post("/v1/sweeps", grid()).await;
    assert_eq!(answer.status, StatusCode::CREATED);
    let sweep = answer.json();
    assert_eq!(answer.headers[header::LOCATION], sweep["links"]["self"].as_str().unwrap());
    assert_eq!(sweep["state"], "running");
    assert_eq!(sweep["counts"]["total"], 12);
    assert_eq!(sweep["counts"]["queued"], 12);
    assert_eq!(sweep["progress"], 0.0);
    assert_eq!(sweep["request"]["axes"]["flow_rate"], grid()["axes"]["flow_rate"]);

    let points =
        bench.get(&format!("{}/points?limit=5", sweep["links"]["self"].as_str().unwrap())).await.json();
    let of_page = |page: &Value| -> Vec<(u64, f64, f64)> {
        let points = page["points"].as_array().unwrap().iter();
        let row = |point: &Value| {
            let parameters = &point["parameters"];
            let number = |name: &str| parameters[name].as_f64().unwrap();
            (point["ordinal"].as_u64().unwrap(), number("flow_rate"), number("mud_density"))
        };
        points.map(row).collect()
    };
    assert_eq!(
        of_page(&points),
        [(1, 0.01, 1200.0), (2, 0.01, 1500.0), (3, 0.01, 1800.0), (4, 0.01, 2100.0), (5, 0.04, 1200.0)]
    );
    let rest = format!(
        "{}?limit=500&cursor={}",
        sweep["links"]["points"].as_str().unwrap(),
        points["next"].as_str().unwrap()
    );
    let rest = bench.get(&rest).await.json();
    assert_eq!(of_page(&rest).len(), 7);
    assert_eq!(of_page(&rest)[6], (12, 0.06, 2100.0));
    assert_eq!(rest["next"], Value::Null);

    // What a worker gets is the scenario with everything applied.
    let claim = bench.claim().await;
    let mud = drillsweep_api::compose(&claim.scenario.base_json, &claim.scenario.changes_json)
        .unwrap()
        .mud
        .unwrap();
    assert_eq!((mud.flow_rate, mud.density), (0.01, 1200.0));
}

#[tokio::test]
async fn a_run_is_a_sweep_of_one_point() {
    let bench = Bench::new().await;
    let answer =
        bench.post("/v1/runs", json!({"preset": "paper-200m", "set": {"mud.flow_rate": 0.04}})).await;
    assert_eq!(answer.status, StatusCode::CREATED);
    let sweep = answer.json();
    assert_eq!(sweep["counts"]["total"], 1);
    let point = bench.get(&format!("{}/points/1", sweep["links"]["self"].as_str().unwrap())).await.json();
    assert_eq!(point["scenario"]["mud"]["flow_rate"], 0.04);
    assert_eq!(point["state"], "queued");
    assert_eq!(point["key"].as_str().unwrap().len(), 64);
    let with_axes = json!({"preset": "paper-200m", "axes": {}});
    bench.post("/v1/runs", with_axes).await.problem(400, "malformed-body");
}

#[tokio::test]
async fn a_dry_run_returns_the_points_and_stores_nothing() {
    let bench = Bench::new().await;
    bench.submit(json!({"preset": "paper-200m"})).await;
    bench.succeed().await;
    let answer = bench.post("/v1/sweeps?dry_run=true", grid()).await;
    assert_eq!(answer.status, StatusCode::OK);
    let plan = answer.json();
    assert_eq!(plan["total"], 12);
    assert_eq!(plan["known"], 1, "the base case is point 1 and has a result");
    assert_eq!(plan["known_at"], json!({"draft": 0, "standard": 1, "reference": 0}));
    assert_eq!(plan["points"][11]["parameters"], json!({"flow_rate": 0.06, "mud_density": 2100.0}));
    assert_eq!(bench.get("/v1/sweeps").await.json()["sweeps"].as_array().unwrap().len(), 1);
    let wrong = json!({"preset": "paper-200m", "set": {"mud.flow_index": -1}});
    bench.post("/v1/sweeps?dry_run=true", wrong).await.problem(422, "invalid-request");
}

#[tokio::test]
async fn listed_points_keep_the_order_of_their_columns_in_any_number_format() {
    let bench = Bench::new().await;
    for priority in ["2", "2.0"] {
        let body = format!(
            r#"{{"preset": "paper-200m", "priority": {priority}, "design": "list", "points": [{{"mud_density": 1200.0, "flow_rate": 0.02}}]}}"#
        );
        let answer = bench.send(json_request(Method::POST, "/v1/sweeps?dry_run=true", body)).await;
        assert_eq!(answer.status, StatusCode::OK);
        let columns = r#""parameters":{"mud_density":1200.0,"flow_rate":0.02}"#;
        assert!(answer.text().contains(columns), "{}", answer.text());
    }
}

#[tokio::test]
async fn a_point_that_is_known_is_not_computed_again() {
    let bench = Bench::new().await;
    bench.submit(json!({"preset": "paper-200m"})).await;
    bench.succeed().await;
    let again = bench.submit(json!({"preset": "paper-200m", "owner": "somebody else"})).await;
    let sweep = bench.get(&format!("/v1/sweeps/{again}")).await.json();
    assert_eq!(sweep["state"], "completed");
    assert_eq!(sweep["counts"]["succeeded"], 1);
}

#[tokio::test]
async fn an_idempotency_key_makes_one_sweep_of_one_request() {
    let bench = Bench::new().await;
    let submit = async |body: &Value| {
        let mut request = json_request(Method::POST, "/v1/sweeps", body.to_string());
        request.headers_mut().insert("idempotency-key", "5c1b".parse().unwrap());
        bench.send(request).await
    };
    let first = submit(&grid()).await;
    let again = submit(&grid()).await;
    assert_eq!(again.status, StatusCode::CREATED);
    assert_eq!(first.json()["id"], again.json()["id"]);
    assert_eq!(bench.get("/v1/sweeps").await.json()["sweeps"].as_array().unwrap().len(), 1);
    submit(&json!({"preset": "paper-200m"})).await.problem(422, "idempotency-key-reused");
}

#[tokio::test]
async fn every_problem_of_a_request_is_reported_at_once() {
    let bench = Bench::new().await;
    let body = json!({
        "preset": "paper-200m",
        "priority": 99,
        "set": {"mud.flow_index": -1, "duration": "long"},
        "axes": {"flow_rate": {"values": [0.01, -0.04]}}
    });
    let problem = bench.post("/v1/sweeps", body).await.problem(422, "invalid-request");
    let pointers: Vec<_> =
        problem["errors"].as_array().unwrap().iter().map(|error| &error["pointer"]).collect();
    assert_eq!(
        pointers,
        ["/priority", "/set/duration"],
        "a change that cannot be made comes before validation"
    );

    let body = json!({
        "preset": "paper-200m",
        "priority": 99,
        "set": {"mud.flow_index": -1},
        "axes": {"flow_rate": {"values": [0.01, -0.04]}}
    });
    let problem = bench.post("/v1/sweeps", body).await.problem(422, "invalid-request");
    let errors = problem["errors"].as_array().unwrap();
    let error_at = |pointer: &str| errors.iter().find(|error| error["pointer"] == pointer);
    assert_eq!(error_at("/priority").unwrap()["got"], 99);
    assert_eq!(error_at("/set/mud.flow_index").unwrap()["got"], -1);
    assert_eq!(error_at("/axes/flow_rate/values/1").unwrap()["got"], -0.04);
    assert_eq!(errors.len(), 3, "{problem}");
    assert_eq!(bench.get("/v1/sweeps").await.json()["sweeps"], json!([]));
}

/// To JSON Schema 2.0 is an integer, and MATLAB's and R's numbers may be written so.
#[tokio::test]
async fn whole_numbers_may_be_written_with_a_decimal_point() {
    let bench = Bench::new().await;
    let count = |count: &str| {
        format!(
            r#"{{"preset": "paper-200m", "axes": {{"flow_rate": {{"from": 0.01, "to": 0.04, "count": {count}}}}}}}"#
        )
    };
    for text in ["3", "3.0", "30e-1"] {
        let request = json_request(Method::POST, "/v1/sweeps?dry_run=true", count(text));
        assert_eq!(bench.send(request).await.json()["total"], 3, "{text}");
    }
    let request = json_request(Method::POST, "/v1/sweeps", count("2.5"));
    bench.send(request).await.problem(400, "malformed-body");
}

#[tokio::test]
async fn names_and_tags_of_control_characters_are_refused_by_schema_and_server() {
    let bench = Bench::new().await;
    for (member, value) in
        [("name", json!("a\u{7}b")), ("tags", json!(["a\u{1b}b"])), ("owner", json!("a\nb"))]
    {
        let mut body = json!({"preset": "paper-200m"});
        body[member] = value;
        let problem = bench.post("/v1/sweeps", body).await.problem(422, "invalid-request");
        assert!(
            problem["errors"][0]["pointer"].as_str().unwrap().starts_with(&format!("/{member}")),
            "{problem}"
        );
    }
}

#[tokio::test]
async fn a_body_of_another_form_is_refused_at_its_place() {
    let bench = Bench::new().await;
    for (body, pointer, words) in [
        (r#"{"preset": "paper-200m", "axis": {}}"#, "/axis", "there is no field `axis`"),
        (r#"{"preset": 200}"#, "/preset", "must be a string"),
        (r#"{"axes": {"flow_rate": {"from": 1, "count": 2}}}"#, "/axes/flow_rate", "`to`"),
        (r#"{"axes": {"flow_rate": {"values": [1, [2]]}}}"#, "/axes/flow_rate", "must be a number"),
        (r#"{"preset": "#, "", "EOF"),
        (r#"{"preset": "paper-200m"} {}"#, "", "trailing"),
        (r#" [null, "anne"]"#, "", "must be an object"),
        // Serde would take lists for structs and objects for names.
        (r#"{"axes": {"flow_rate": [0.01, 0.02]}}"#, "/axes/flow_rate", "must be an object with `values`"),
        (r#"{"axes": {"flow_rate": [[0.01, 0.02]]}}"#, "/axes/flow_rate", "must be an object with `values`"),
        (r#"{"design": {"grid": null}}"#, "/design", "must be the name alone"),
        (r#"{"outputs": {"full": null}}"#, "/outputs", "must be the name alone"),
        (
            r#"{"axes": {"flow_rate": {"from": 1, "to": 2, "scale": {"log": null}}}}"#,
            "/axes/flow_rate/scale",
            "must be the name alone",
        ),
        (r#"{"scenario": {"damping": [0.03, 0.00003]}}"#, "/scenario/damping", "must be an object"),
        (
            r#"{"axes": {"mud_density": {"from": 1, "to": 2, "count": 3, "scale": null}}}"#,
            "/axes/mud_density/scale",
            "a name",
        ),
        (r#"{"preset": "paper-200m", "outputs": 3}"#, "/outputs", "a name, or an object"),
        (r#"{"outputs": {"orbits": {"nodes": "all"}}}"#, "/outputs/orbits/nodes", "must be a list"),
        (r#"{"outputs": {"orbits": {"decimation": 1.5}}}"#, "/outputs/orbits/decimation", "a whole number"),
        (r#"{"design": "grad"}"#, "/design", "must be `grid`, `zip`"),
        (r#"{"preset": "a", "preset": "b"}"#, "", "`preset` is given twice"),
        // Also beside a number that is read in another way, and where any name is a member.
        (r#"{"priority": 2.0, "preset": "a", "preset": "b"}"#, "", "`preset` is given twice"),
        (r#"{"axes": {"mud.density": {"values": [1]}, "mud.density": {"values": [2]}}}"#, "/axes", "twice"),
        (r#"{"scenario": {"mud": {"density": 1, "density": 2}}}"#, "/scenario/mud", "twice"),
    ] {
        let request = json_request(Method::POST, "/v1/sweeps", body.to_owned());
        let problem = bench.send(request).await.problem(400, "malformed-body");
        let error = &problem["errors"][0];
        let found = error["pointer"].as_str().unwrap();
        assert!(found.starts_with(pointer), "{body}: {problem}");
        assert!(error["detail"].as_str().unwrap().contains(words), "{body}: {problem}");
    }
}

#[tokio::test]
async fn a_pipe_of_the_catalogue_is_the_section_that_its_name_gives() {
    let bench = Bench::new().await;
    let pipes = bench.get("/v1/pipes").await.json()["pipes"].as_array().unwrap().clone();
    let name = "5\" 19.5# S-135 NC50";
    let pipe = pipes.iter().find(|pipe| pipe["name"] == name).unwrap();
    assert_eq!(pipe["outer_diameter"], 0.127);
    let key = async |mut section: serde_json::Value| {
        section["count"] = json!(9);
        section["length"] = json!(9.5);
        let set = json!({"string.sections[1]": section});
        let id = bench.submit(json!({"preset": "paper-200m", "set": set})).await;
        bench.get(&format!("/v1/sweeps/{id}/points/1")).await.json()["key"].clone()
    };
    assert_eq!(key(json!({"pipe": name})).await, key(pipe.clone()).await);
}
