//! The OpenAPI document.

use std::path::Path;

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use drillsweep_api::ProblemKind;
use drillsweep_server::OPENAPI_JSON;
use drillsweep_store::{NewToken, TokenScope, TokenSecret};
use drillsweep_table::tables;
use serde_json::Value;

use crate::bench::Bench;

/// `DRILLSWEEP_WRITE_OPENAPI=1 cargo nextest run -p drillsweep-server -E 'test(the_committed_document)'` rewrites the file.
#[test]
fn the_committed_document_matches_the_annotations() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../api/openapi.json");
    if std::env::var_os("DRILLSWEEP_WRITE_OPENAPI").is_some() {
        std::fs::write(&path, &*OPENAPI_JSON).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(
        committed == *OPENAPI_JSON,
        "api/openapi.json is out of date; this test's comment says how to write it"
    );
}

#[tokio::test]
async fn the_service_serves_the_document_as_it_is_committed() {
    let committed = include_str!("../../../api/openapi.json");
    let served = Bench::new().await.get("/openapi.json").await;
    assert_eq!(served.headers[header::CONTENT_TYPE], "application/json");
    assert_eq!(served.text(), committed);
    assert_eq!(served.json()["openapi"], "3.1.0");
}

#[test]
fn every_reference_leads_somewhere_and_every_operation_is_described() {
    let document: Value = serde_json::from_str(&OPENAPI_JSON).unwrap();
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

/// A numeric field of a scenario: its path, the unit that its schema names, and what its description says.
struct Field {
    path: String,
    unit: Option<String>,
    description: String,
}

fn numeric_fields(document: &Value, schema: &Value, path: &str, fields: &mut Vec<Field>) {
    if let Some(reference) = schema["$ref"].as_str() {
        let schema = document.pointer(reference.strip_prefix('#').unwrap()).unwrap();
        return numeric_fields(document, schema, path, fields);
    }
    let kinds = &schema["type"];
    if ["number", "integer"].iter().any(|kind| kinds == kind || kinds[0] == *kind) {
        let text = |name: &str| schema[name].as_str().map(str::to_owned);
        let description = text("description").unwrap_or_default();
        fields.push(Field { path: path.to_owned(), unit: text("x-unit"), description });
        return;
    }
    for (name, schema) in schema["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        numeric_fields(document, schema, &path, fields);
    }
    for forms in ["oneOf", "anyOf", "allOf"] {
        for schema in schema[forms].as_array().into_iter().flatten() {
            numeric_fields(document, schema, path, fields);
        }
    }
    if schema["items"].is_object() {
        numeric_fields(document, &schema["items"], path, fields);
    }
}

#[test]
fn every_number_of_a_scenario_is_in_the_vocabulary_with_the_unit_that_its_description_names() {
    let document: Value = serde_json::from_str(&OPENAPI_JSON).unwrap();
    let mut fields = Vec::new();
    numeric_fields(&document, &document["components"]["schemas"]["Scenario"], "", &mut fields);
    assert!(fields.len() > 60, "{}", fields.len());
    for Field { path, unit, description } in fields {
        assert!(drillsweep_quantity::of(&path).is_some(), "{path} is not in the vocabulary");
        assert_eq!(unit.as_deref(), drillsweep_quantity::unit(&path), "{path}");
        let named = description.split_once("\\[").and_then(|(_, rest)| rest.split_once("\\]"));
        if let Some((named, _)) = named {
            assert_eq!(unit.as_deref(), Some(named), "{path}: {description}");
        }
    }
}

#[test]
fn the_columns_of_every_table_are_described() {
    let document: Value = serde_json::from_str(&OPENAPI_JSON).unwrap();
    for layout in tables::ALL.iter().filter(|layout| layout.name != "spectra") {
        let path = format!("/paths/~1v1~1sweeps~1{{id}}~1points~1{{n}}~1{}/get/description", layout.name);
        let description = document.pointer(&path).and_then(Value::as_str).unwrap();
        for quantity in layout.columns {
            assert!(!quantity.meaning.is_empty());
            assert!(description.contains(&format!("| `{}` | ", quantity.name)), "{}", quantity.name);
        }
    }
}

#[tokio::test]
async fn the_vocabulary_is_served_without_a_token() {
    let bench = Bench::new().await;
    let secret = TokenSecret::generate().unwrap();
    let token =
        NewToken { secret: &secret, owner: "anne", name: None, scope: TokenScope::Read, lifetime_ms: None };
    bench.store.create_token(&token).await.unwrap();
    bench.get("/v1/queue").await.problem(401, "unauthorized");
    let answer = bench.get("/v1/quantities").await;
    let served = answer.json();
    assert_eq!(served, drillsweep_quantity::json());
    let density = &served["mud_density"];
    assert_eq!((&density["unit"], &density["field"]["unit"]), (&"kg/m3".into(), &"ppg".into()));
    // A pound in a gallon of 231 cubic inches.
    let size = 0.453_592_37 / (231.0 * 0.0254_f64.powi(3));
    assert!((density["field"]["size"].as_f64().unwrap() / size - 1.0).abs() < 1e-12);
    let again = Request::get("/v1/quantities").header(header::IF_NONE_MATCH, &answer.headers[header::ETAG]);
    assert_eq!(bench.send(again.body(Body::empty()).unwrap()).await.status, StatusCode::NOT_MODIFIED);
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
async fn the_document_is_shown_as_pages_without_a_token() {
    let bench = Bench::new().await;
    let secret = TokenSecret::generate().unwrap();
    let token =
        NewToken { secret: &secret, owner: "anne", name: None, scope: TokenScope::Read, lifetime_ms: None };
    bench.store.create_token(&token).await.unwrap();
    assert_eq!(bench.get("/v1/sweeps").await.status, 401);
    let page = bench.get("/docs").await;
    assert_eq!(page.headers["content-type"], "text/html; charset=utf-8");
    // All that the page loads comes with it.
    let text = page.text().to_owned();
    let files: Vec<&str> = text.split('"').filter(|part| part.starts_with("/web/")).collect();
    assert!(files.len() >= 4, "{files:?}");
    for file in &files {
        assert_eq!(bench.get(file).await.status, 200, "{file}");
    }
    assert!(!text.contains("http:") && !text.contains("https:") && !text.contains("//"), "{text}");
    let script = files.iter().find(|file| file.ends_with("docs.js")).unwrap();
    assert!(bench.get(script).await.text().contains("/openapi.json"));
}
