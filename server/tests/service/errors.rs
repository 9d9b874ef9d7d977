//! Answers to requests that cannot be served.

use axum::body::Body;
use axum::http::{Method, Request, header};
use drillsweep_api::LIMITS;
use serde_json::json;

use crate::bench::{Bench, json_request};

#[tokio::test]
async fn a_missing_resource_is_answered_with_a_problem() {
    let bench = Bench::new().await;
    bench.get("/v2/sweeps").await.problem(404, "no-such-route");
    bench.get("/v1/sweeps/unknown").await.problem(404, "not-found");
    bench.get("/v1/sweeps/unknown/table").await.problem(404, "not-found");
    bench.get("/v1/sweeps/unknown/points").await.problem(404, "not-found");
    bench.get("/v1/scenarios/unknown").await.problem(404, "not-found");
    bench.post("/v1/sweeps/unknown/cancel", json!({})).await.problem(404, "not-found");
    bench.post("/v1/sweeps/unknown/retry", json!({})).await.problem(404, "not-found");
    let answer = bench.send(Request::delete("/v1/sweeps").body(Body::empty()).unwrap()).await;
    answer.problem(405, "method-not-allowed");
    let mut allowed: Vec<_> = answer.headers[header::ALLOW].to_str().unwrap().split(',').collect();
    allowed.sort_unstable();
    assert_eq!(allowed, ["GET", "HEAD", "POST"]);
}

#[tokio::test]
async fn a_wrong_parameter_is_named_with_valid_ones() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    for (path, name, got, words) in [
        ("?wait=soon", "wait", "soon", "30s"),
        ("?wait=-1s", "wait", "-1s", "30s"),
        ("?until=done", "until", "done", "`change` or `completed`"),
        ("?wiat=3s", "wiat", "3s", "`wait`"),
        ("/points?limit=0", "limit", "0", "whole number of 1 or more"),
        ("/points?limit=501", "limit", "501", "at most 500"),
        ("/points?cursor=x", "cursor", "x", "next"),
        ("/points?cursor=-1", "cursor", "-1", "next"),
        ("/points?cursor=0", "cursor", "0", "next"),
        ("/points?state=done", "state", "done", "`succeeded`"),
        ("/points/one", "n", "one", "whole number"),
        ("/points/1/orbit?node=x", "node", "x", "whole number"),
        ("/points/1/orbit?node=49&from=5&to=2", "to", "2", "greater than from"),
        ("/points/1/orbit?node=49&max_points=3", "max_points", "3", "4 or more"),
        ("/points/1/orbit?node=49&from=NaN", "from", "NaN", "number"),
        ("/points/1/spectrum?node=49&window=blackman", "window", "blackman", "`rectangular` or `hann`"),
        ("/points/1/spectrum?node=49&range_hz=0", "range_hz", "0", "greater than 0"),
        ("/points/1/profile?format=xlsx", "format", "xlsx", "`parquet`"),
        ("/points/1/statics?format=svg", "format", "svg", "`npz`"),
        ("/points?fields=ordinal,colour", "fields", "colour", "parameters"),
        ("/table?fields=colour", "fields", "colour", "mud_density"),
        ("/events?after=-1", "after", "-1", "whole number"),
    ] {
        let problem = bench.get(&format!("/v1/sweeps/{id}{path}")).await.problem(400, "invalid-parameter");
        let error = &problem["errors"][0];
        assert_eq!(error["parameter"], name, "{path}: {problem}");
        assert_eq!(error["got"], got, "{path}: {problem}");
        assert!(error["detail"].as_str().unwrap().contains(words), "{path}: {problem}");
    }
    bench.get(&format!("/v1/sweeps/{id}/points/1/orbit")).await.problem(400, "invalid-parameter");
    bench
        .get(&format!("/v1/sweeps/{id}/points/1/orbit?node=1&depth=2"))
        .await
        .problem(400, "invalid-parameter");
}

#[tokio::test]
async fn a_body_that_is_too_large_or_of_another_type_is_refused() {
    let bench = Bench::new().await;
    let large = format!("{{\"name\": \"{}\"}}", "x".repeat(LIMITS.body_bytes));
    bench.send(json_request(Method::POST, "/v1/sweeps", large)).await.problem(413, "body-too-large");
    let form = Request::post("/v1/sweeps")
        .header(header::CONTENT_TYPE, "application/x-www-form-urlencoded")
        .body(Body::from("{\"preset\": \"paper-200m\"}"))
        .unwrap();
    bench.send(form).await.problem(415, "unsupported-media-type");
    let untyped = Request::post("/v1/sweeps").body(Body::from("{\"preset\": \"paper-200m\"}")).unwrap();
    bench.send(untyped).await.problem(415, "unsupported-media-type");
}

#[tokio::test]
async fn a_table_is_not_served_in_formats_that_there_are_not() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let request = Request::get(format!("/v1/sweeps/{id}/table")).header(header::ACCEPT, "image/webp");
    bench.send(request.body(Body::empty()).unwrap()).await.problem(406, "not-acceptable");
}

#[tokio::test]
async fn a_page_of_another_site_cannot_submit() {
    let bench = Bench::new().await;
    let mut request = json_request(Method::POST, "/v1/sweeps", "{\"preset\": \"paper-200m\"}".to_owned());
    request.headers_mut().insert("sec-fetch-site", "cross-site".parse().unwrap());
    bench.send(request).await.problem(403, "cross-site");
}

#[tokio::test]
async fn a_failure_of_the_store_is_not_disclosed_to_the_client() {
    let bench = Bench::new().await;
    bench.store.close().await;
    let problem = bench.get("/v1/sweeps").await.problem(500, "internal");
    let text = problem.to_string().to_lowercase();
    assert!(!text.contains("pool") && !text.contains("sql"), "{text}");
    bench.get("/readyz").await.problem(503, "unavailable");
    assert_eq!(bench.get("/livez").await.json(), json!({"status": "ok"}));
}

#[tokio::test]
async fn the_service_describes_itself() {
    let bench = Bench::new().await;
    assert_eq!(bench.get("/readyz").await.json(), json!({"status": "ok"}));
    assert_eq!(bench.get("/v1/limits").await.json()["points_per_sweep"], 100_000);
    assert_eq!(bench.get("/v1/workers").await.json(), json!({"workers": []}));
    bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.04]}}})).await;
    bench.claim().await;
    let queue = bench.get("/v1/queue").await.json();
    assert_eq!(queue, json!({"queued": 1, "paused": 0, "waiting_for_retry": 0, "running": 1}));
    let scenarios = bench.get("/v1/scenarios").await.json();
    for entry in scenarios["scenarios"].as_array().unwrap() {
        let detail = bench.get(entry["link"].as_str().unwrap()).await.json();
        assert_eq!(detail["name"], entry["name"]);
        assert_eq!(detail["scenario"]["name"], entry["name"]);
    }
}

#[tokio::test]
async fn a_scenario_file_is_read_in_either_format() {
    let bench = Bench::new().await;
    let read = async |format: &str, text: &str| {
        bench.post("/v1/scenarios", json!({"format": format, "text": text})).await
    };
    let preset = bench.get("/v1/scenarios/paper-200m").await.json()["scenario"].clone();
    assert_eq!(read("json", &preset.to_string()).await.json()["scenario"], preset);
    let toml = include_str!("../../../scenario/presets/paper-200m.toml");
    assert_eq!(read("toml", toml).await.json()["scenario"], preset);
    let changed = read("toml", "preset = \"paper-200m\"\n[set]\n\"mud.density\" = 1500.0").await.json();
    assert_eq!(changed, json!({"preset": "paper-200m", "set": {"mud.density": 1500.0}}));
    for (format, text, words) in [
        ("toml", "name = ", "line 1"),
        ("json", "{\"name\": 3", "not JSON"),
        ("toml", "preset = \"paper-200m\"\nsets = 1", "sets"),
    ] {
        let answer = read(format, text).await;
        let problem = answer.problem(422, "invalid-request");
        assert_eq!(problem["errors"][0]["pointer"], "/text");
        let detail = problem["errors"][0]["detail"].as_str().unwrap();
        assert!(detail.contains(words), "{detail}");
    }
}

#[tokio::test]
async fn overlong_and_encoded_requests_are_refused_with_problems() {
    let bench = Bench::new().await;
    let long = format!("/v1/sweeps?name={}", "x".repeat(8 * 1024));
    bench.get(&long).await.problem(414, "target-too-long");
    let heavy =
        Request::get("/v1/sweeps").header("x-padding", "x".repeat(32 * 1024)).body(Body::empty()).unwrap();
    bench.send(heavy).await.problem(431, "header-too-large");
    let encoded = Request::post("/v1/sweeps")
        .header(header::CONTENT_TYPE, "application/json")
        .header(header::CONTENT_ENCODING, "gzip")
        .body(Body::from("{\"preset\": \"paper-200m\"}"))
        .unwrap();
    bench.send(encoded).await.problem(415, "unsupported-media-type");
}

#[tokio::test]
async fn problems_of_malformed_bodies_name_no_types() {
    let bench = Bench::new().await;
    for (body, pointer, words) in [
        (
            json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [true]}}}),
            "/axes/flow_rate/values/0",
            "number",
        ),
        (
            json!({"preset": "paper-200m", "axes": {"flow_rate": {"from": 0.01, "to": 0.04, "count": "3"}}}),
            "/axes/flow_rate/count",
            "a whole number, 0 or more",
        ),
        (json!({"preset": 3}), "/preset", "a string"),
        (json!({"scenario": "paper-200m"}), "/scenario", "an object"),
        (json!({"preset": "paper-200m", "tags": "x"}), "/tags", "a list"),
        (json!({"preset": "paper-200m", "set": 3}), "/set", "an object"),
    ] {
        let problem = bench.post("/v1/sweeps", body).await.problem(400, "malformed-body");
        let detail = problem["errors"][0]["detail"].as_str().unwrap();
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
        assert!(detail.contains(words), "{problem}");
        for name in ["f64", "u32", "struct", "enum", "Vec", "sequence"] {
            assert!(!detail.contains(name), "{problem}");
        }
    }
}

#[tokio::test]
async fn cursors_and_control_characters_that_nothing_gave_out_are_refused() {
    let bench = Bench::new().await;
    let problem = bench.get("/v1/sweeps?cursor=zzz").await.problem(400, "invalid-parameter");
    assert_eq!(problem["errors"][0]["parameter"], "cursor");
    let hostile = json!({"preset": "paper-200m", "name": "a\u{1b}]0;b\u{7}"});
    let problem = bench.post("/v1/sweeps", hostile).await.problem(422, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/name");
}

#[tokio::test]
async fn html_pages_are_isolated_by_headers() {
    let answer = Bench::new().await.get("/docs").await;
    assert_eq!(answer.headers["x-frame-options"], "DENY");
    assert_eq!(answer.headers["x-content-type-options"], "nosniff");
    let policy = answer.headers["content-security-policy"].to_str().unwrap();
    for rule in ["default-src 'none'", "script-src 'self'", "frame-ancestors 'none'"] {
        assert!(policy.contains(rule), "{policy}");
    }
}

#[tokio::test]
async fn requests_that_exclude_identity_get_gzip_or_are_refused_before_any_work() {
    let bench = Bench::new().await;
    let ask = |method: &str, path: &str, accepted: &str| {
        let request = Request::builder().method(method).uri(path).header(header::ACCEPT_ENCODING, accepted);
        let request = request.header(header::CONTENT_TYPE, "application/json");
        request.body(Body::from(if method == "POST" { r#"{"preset": "paper-200m"}"# } else { "" })).unwrap()
    };
    for accepted in ["identity;q=0", "*;q=0", "br, identity;q=0", "gzip;q=0, identity;q=0", "br, *;q=0.0"] {
        let problem = bench.send(ask("POST", "/v1/sweeps", accepted)).await.problem(406, "not-acceptable");
        assert!(problem["detail"].as_str().unwrap().contains("gzip"), "{problem}");
    }
    assert_eq!(bench.get("/v1/sweeps").await.json()["sweeps"], serde_json::json!([]));

    // Too small to be worth compressing, and compressed all the same.
    let plain = bench.send(ask("GET", "/v1/sweeps", "gzip")).await;
    assert!(!plain.headers.contains_key(header::CONTENT_ENCODING));
    for accepted in ["gzip, identity;q=0", "gzip;q=0.1, *;q=0", "identity;q=0, *", "X-GZIP, IDENTITY;q=0.000"]
    {
        for path in ["/v1/sweeps", "/v1/no-such-route"] {
            let answer = bench.send(ask("GET", path, accepted)).await;
            assert_eq!(answer.headers[header::CONTENT_ENCODING], "gzip", "{accepted} at {path}");
            assert!(answer.body.starts_with(b"\x1f\x8b"), "{accepted} at {path}");
        }
    }
    for accepted in ["", "identity", "br", "*;q=0, identity", "br;q=1, identity;q=0.001"] {
        let answer = bench.send(ask("GET", "/v1/sweeps", accepted)).await;
        assert_eq!(answer.body, plain.body, "{accepted}");
    }
}
