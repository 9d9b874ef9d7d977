//! The OpenAPI document.

use std::path::Path;

use drillsweep_api::ProblemKind;
use drillsweep_server::openapi_json;
use drillsweep_store::{NewToken, TokenScope, TokenSecret};
use serde_json::Value;

use crate::bench::Bench;

/// `DRILLSWEEP_WRITE_OPENAPI=1 cargo test -p drillsweep-server openapi` writes the file anew.
#[tokio::test]
async fn the_committed_document_is_the_one_that_is_served() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../api/openapi.json");
    if std::env::var_os("DRILLSWEEP_WRITE_OPENAPI").is_some() {
        std::fs::write(&path, openapi_json()).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(
        committed == openapi_json(),
        "api/openapi.json is out of date; this test's comment says how to write it"
    );
    let served = Bench::new().await.get("/openapi.json").await;
    assert_eq!(served.text(), committed);
}

#[test]
fn every_route_is_documented() {
    let document: Value = serde_json::from_str(openapi_json()).unwrap();
    assert_eq!(document["openapi"], "3.1.0");
    let paths = document["paths"].as_object().unwrap();
    let point = "/v1/sweeps/{id}/points/{n}";
    let mut documented: Vec<_> = paths
        .iter()
        .flat_map(|(path, operations)| {
            operations.as_object().unwrap().keys().map(move |method| format!("{method} {path}"))
        })
        .collect();
    documented.sort();
    let mut expected: Vec<String> = [
        "post /v1/sweeps",
        "get /v1/sweeps",
        "get /v1/sweeps/{id}",
        "post /v1/sweeps/{id}/cancel",
        "post /v1/sweeps/{id}/retry",
        "patch /v1/sweeps/{id}",
        "post /v1/sweeps/{id}/pause",
        "post /v1/sweeps/{id}/resume",
        "post /v1/sweeps/{id}/points",
        "get /v1/sweeps/{id}/points",
        "get /v1/failures",
        "get /v1/sweeps/{id}/table",
        "get /v1/sweeps/{id}/verification",
        "get /v1/sweeps/{id}/events",
        "get /v1/sweeps/{id}/export",
        "post /v1/runs",
        "get /v1/scenarios",
        "get /v1/scenarios/{name}",
        "get /v1/workers",
        "get /v1/queue",
        "get /v1/limits",
        "get /openapi.json",
        "get /livez",
        "get /readyz",
    ]
    .map(str::to_owned)
    .into();
    expected.push(format!("get {point}"));
    expected.push(format!("get {point}/artifacts"));
    expected.push(format!("get {point}/artifacts/{{name}}"));
    for table in ["profile", "statics", "history", "orbit", "spectrum", "contacts", "energy", "cost"] {
        expected.push(format!("get {point}/{table}"));
    }
    expected.sort();
    assert_eq!(documented, expected);
}

#[test]
fn every_reference_leads_somewhere_and_every_operation_is_described() {
    let document: Value = serde_json::from_str(openapi_json()).unwrap();
    let mut references = Vec::new();
    collect_references(&document, &mut references);
    assert!(!references.is_empty());
    for reference in references {
        let pointer = reference.strip_prefix('#').unwrap();
        assert!(document.pointer(pointer).is_some(), "{reference} leads nowhere");
    }
    for (path, operations) in document["paths"].as_object().unwrap() {
        for operation in operations.as_object().unwrap().values() {
            assert!(operation["summary"].is_string(), "{path} has no summary");
            assert!(
                operation["responses"]["default"]["content"]["application/problem+json"].is_object(),
                "{path}"
            );
            for parameter in operation["parameters"].as_array().into_iter().flatten() {
                assert!(parameter["description"].is_string(), "{path}: {parameter}");
            }
        }
    }
}

fn collect_references(value: &Value, references: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            for (name, member) in members {
                match member {
                    Value::String(reference) if name == "$ref" => references.push(reference.clone()),
                    member => collect_references(member, references),
                }
            }
        }
        Value::Array(entries) => entries.iter().for_each(|entry| collect_references(entry, references)),
        _ => {}
    }
}

#[test]
fn problem_kinds_have_error_statuses() {
    for kind in ProblemKind::ALL {
        assert!((400..600).contains(&kind.status()), "{kind:?}");
    }
}

#[tokio::test]
async fn people_read_the_document_as_pages_without_a_token() {
    let bench = Bench::new().await;
    let secret = TokenSecret::generate().unwrap();
    let token =
        NewToken { secret: &secret, owner: "anne", name: None, scope: TokenScope::Read, lifetime_ms: None };
    bench.store.create_token(&token).await.unwrap();
    assert_eq!(bench.get("/v1/sweeps").await.status, 401);
    let start = bench.get("/docs").await;
    assert_eq!(
        (start.status.as_u16(), start.headers["location"].to_str().unwrap()),
        (308, "/docs/index.html")
    );
    let index = bench.get("/docs/index.html").await;
    assert_eq!(index.headers["content-type"], "text/html");
    // All that the page loads is beside it.
    let text = index.text().to_owned();
    let files: Vec<&str> = text
        .split('"')
        .filter(|part| part.ends_with(".js") || part.ends_with(".css") || part.ends_with(".png"))
        .map(|part| part.trim_start_matches("./"))
        .collect();
    assert!(files.len() >= 3 && files.iter().all(|file| !file.contains('/')), "{files:?}");
    for file in files {
        assert_eq!(bench.get(&format!("/docs/{file}")).await.status, 200, "{file}");
    }
    assert!(bench.get("/docs/swagger-initializer.js").await.text().contains("/openapi.json"));
    bench.get("/docs/nothing.js").await.problem(404, "no-such-route");
}
