//! Lines of the log about requests.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use axum::http::{Method, header};
use drillsweep_store::TokenScope;
use serde_json::json;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

use crate::bench::Bench;
use crate::trust::{send, token};

/// Fields of one line of the log; `message` is its text.
#[derive(Default)]
struct Line(BTreeMap<&'static str, String>);

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        self.0.insert(field.name(), format!("{value:?}"));
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        self.0.insert(field.name(), value.to_owned());
    }
}

/// Log of this thread.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<Line>>>);

impl Log {
    /// A field of all lines of a text, in their order.
    fn of(&self, text: &str, field: &str) -> Vec<Option<String>> {
        let lines = self.0.lock().unwrap();
        let found = lines.iter().filter(|line| line.0.get("message").is_some_and(|message| message == text));
        found.map(|line| line.0.get(field).cloned()).collect()
    }
}

impl Subscriber for Log {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && metadata.target().starts_with("drillsweep_server")
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, event: &Event<'_>) {
        let mut line = Line::default();
        event.record(&mut line);
        self.0.lock().unwrap().push(line);
    }

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

#[tokio::test]
async fn changes_are_logged_with_their_callers_and_reads_and_refusals_are_not() {
    let bench = Bench::new().await;
    let anne = token(&bench, "anne", TokenScope::Submit).await;
    let reader = token(&bench, "bob", TokenScope::Read).await;
    let log = Log::default();
    let _logging = tracing::subscriber::set_default(log.clone());
    let begun = Instant::now();
    let run = json!({"preset": "paper-200m"});
    let made = send(&bench, &anne, Method::POST, "/v1/sweeps", run.clone()).await;
    let read = send(&bench, &anne, Method::GET, "/v1/sweeps", json!({})).await;
    let dry = send(&bench, &anne, Method::POST, "/v1/sweeps?dry_run=true", run.clone()).await;
    let refused = send(&bench, &reader, Method::POST, "/v1/sweeps", run).await;
    let poll = format!("{}?wait=100ms&until=completed", made.headers[header::LOCATION].to_str().unwrap());
    let held = send(&bench, &anne, Method::GET, &poll, json!({})).await;
    let took = begun.elapsed();
    let statuses =
        [made.status, read.status, dry.status, refused.status, held.status].map(|code| code.as_u16());
    assert_eq!(statuses, [201, 200, 200, 403, 200]);

    for (field, value) in [
        ("owner", "anne"),
        ("token.id", &anne.id()),
        ("http.method", "POST"),
        ("http.target", "/v1/sweeps"),
        ("http.status", "201"),
        ("made", made.headers[header::LOCATION].to_str().unwrap()),
    ] {
        assert_eq!(log.of("changed", field), [Some(value.to_owned())], "{field}");
    }
    assert_eq!(log.of("answered", "http.status"), statuses.map(|code| Some(code.to_string())));
    let latencies = log.of("answered", "latency_ms");
    let latencies: Vec<f64> = latencies.iter().flatten().map(|latency| latency.parse().unwrap()).collect();
    assert!(latencies[4] >= 100.0, "{latencies:?}");
    assert!(latencies.iter().sum::<f64>() <= took.as_secs_f64() * 1e3, "{latencies:?}");
}
