//! Requests of the tests against the schemas of the OpenAPI document: a body that the server takes, its schema takes, and one that the
//! server finds malformed, its schema does not.

use std::sync::LazyLock;

use axum::http::{Method, StatusCode};
use drillsweep_api::ProblemKind;
use drillsweep_server::OPENAPI_JSON;
use jsonschema::Validator;
use serde_json::Value;

/// The schema of an operation's body.
struct Operation {
    method: String,
    path: String,
    body: Validator,
}

static OPERATIONS: LazyLock<Vec<Operation>> = LazyLock::new(|| {
    let document: Value = serde_json::from_str(&OPENAPI_JSON).unwrap();
    let mut operations = Vec::new();
    for (path, methods) in document["paths"].as_object().unwrap() {
        for (method, operation) in methods.as_object().unwrap() {
            let mut schema = operation["requestBody"]["content"]["application/json"]["schema"].clone();
            if schema.is_null() {
                continue;
            }
            // What its references name.
            schema["components"] = document["components"].clone();
            operations.push(Operation {
                method: method.to_uppercase(),
                path: path.clone(),
                body: jsonschema::draft202012::options()
                    .should_validate_formats(true)
                    .build(&schema)
                    .unwrap(),
            });
        }
    }
    operations
});

/// Compares what the server made of a body with what its schema makes of it.
pub(crate) fn check(method: &Method, path: &str, body: &[u8], status: StatusCode, answer: &[u8]) {
    let Some(operation) = OPERATIONS
        .iter()
        .find(|operation| operation.method == method.as_str() && is_of(path, &operation.path))
    else {
        return;
    };
    let Ok(instance) = serde_json::from_slice::<Value>(body) else { return };
    let is_malformed = || {
        let problem: Value = serde_json::from_slice(answer).unwrap_or_default();
        // A schema sees one of two members of the same name.
        let is_twice = problem["detail"].as_str().is_some_and(|detail| detail.contains("is given twice"));
        problem["type"] == ProblemKind::MalformedBody.uri() && !is_twice
    };
    if status.is_success() {
        let errors: Vec<String> = operation
            .body
            .iter_errors(&instance)
            .map(|error| format!("{}: {error}", error.instance_path()))
            .collect();
        assert!(errors.is_empty(), "{method} {path} took what its schema refuses: {instance}\n{errors:#?}");
    } else if status == StatusCode::BAD_REQUEST && is_malformed() {
        assert!(
            !operation.body.is_valid(&instance),
            "{method} {path} finds malformed what its schema takes: {instance}\n{}",
            String::from_utf8_lossy(answer)
        );
    } else if status == StatusCode::UNPROCESSABLE_ENTITY && is_about_form(answer) {
        assert!(
            !operation.body.is_valid(&instance),
            "{method} {path} refuses a form that its schema takes: {instance}\n{}",
            String::from_utf8_lossy(answer)
        );
    }
}

/// True if all errors of a request stand at members whose schema states all their bounds. Other refused requests could not be
/// simulated, or contradict another member.
fn is_about_form(answer: &[u8]) -> bool {
    const COMPLETE: [&str; 6] = ["/name", "/owner", "/tags", "/priority", "/samples", "/seed"];
    let problem: Value = serde_json::from_slice(answer).unwrap_or_default();
    let errors = problem["errors"].as_array().map_or(&[][..], Vec::as_slice);
    let is_complete = |error: &Value| {
        let pointer = error["pointer"].as_str().unwrap_or_default();
        COMPLETE.iter().any(|member| pointer == *member || pointer.starts_with(&format!("{member}/")))
    };
    !errors.is_empty() && errors.iter().all(is_complete)
}

/// True if a path is one of a template such as `/v1/sweeps/{id}`.
fn is_of(path: &str, template: &str) -> bool {
    let path = path.split('?').next().unwrap_or_default();
    let (path, template): (Vec<_>, Vec<_>) = (path.split('/').collect(), template.split('/').collect());
    path.len() == template.len() && path.iter().zip(&template).all(|(a, b)| b.starts_with('{') || a == b)
}
