//! A service over a store in a temporary directory, and a worker that stores tables made up here.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, Method, Request, StatusCode, header};
use axum::response::Response;
use drillsweep_server::{Config, router};
use drillsweep_store::{Claim, NewArtifact, NewResult, ObjectsLocation, Role, Store, StoreConfig};
use drillsweep_table::{Column, Table, parquet};
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::sync::watch;
use tower::ServiceExt;

use crate::schema;

pub(crate) struct Bench {
    pub(crate) store: Store,
    pub(crate) stop: watch::Sender<bool>,
    routes: Router,
    directory: TempDir,
}

pub(crate) struct Answer {
    pub(crate) status: StatusCode,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Bytes,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {:?}", self.body))
    }

    /// The body, which must be a problem document of this kind.
    pub(crate) fn problem(&self, status: u16, slug: &str) -> Value {
        let problem = self.json();
        assert_eq!(self.status, status, "{problem}");
        assert_eq!(self.headers[header::CONTENT_TYPE], "application/problem+json");
        assert_eq!(problem["type"], format!("urn:drillsweep:problem:{slug}"), "{problem}");
        assert_eq!(problem["status"], status);
        let id = self.headers["x-request-id"].to_str().unwrap();
        assert_eq!(problem["instance"], format!("urn:drillsweep:request:{id}"));
        problem
    }

    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(&self.body).unwrap()
    }
}

impl Bench {
    pub(crate) async fn new() -> Self {
        Bench::with(Config::default()).await
    }

    pub(crate) async fn with(config: Config) -> Self {
        let directory = TempDir::new().unwrap();
        let store = Store::open(&StoreConfig::in_directory(directory.path(), Role::Server)).await.unwrap();
        let (stop, stopping) = watch::channel(false);
        let config = Config { poll_interval: Duration::from_millis(10), ..config };
        Bench { routes: router(store.clone(), config, stopping), store, stop, directory }
    }

    /// Serves the same store by another configuration.
    pub(crate) fn reconfigure(&mut self, config: Config) {
        self.routes = router(self.store.clone(), config, self.stop.subscribe());
    }

    /// The same store as one sees it whose clock is ahead.
    pub(crate) async fn later(&self, offset: Duration) -> Store {
        let config = StoreConfig::in_directory(self.directory.path(), Role::Server);
        let clock_offset_ms = i64::try_from(offset.as_millis()).unwrap();
        Store::open(&StoreConfig { clock_offset_ms, ..config }).await.unwrap()
    }

    /// From now on the blobs are in a bucket of a service that does not run.
    pub(crate) async fn lose_object_store(&mut self) {
        // No service has this port.
        let settings = [
            ("endpoint", "http://127.0.0.1:1"),
            ("allow_http", "true"),
            ("access_key_id", "tests"),
            ("secret_access_key", "tests"),
        ];
        let objects = ObjectsLocation::S3 {
            bucket: "tests".to_owned(),
            prefix: String::new(),
            settings: settings.map(|(name, value)| (name.to_owned(), value.to_owned())).into(),
        };
        let config = StoreConfig::in_directory(self.directory.path(), Role::Server).with_objects(objects);
        self.store = Store::open(&config).await.unwrap();
        self.reconfigure(Config::default());
    }

    pub(crate) async fn send(&self, request: Request<Body>) -> Answer {
        let (parts, body) = request.into_parts();
        let sent = body.collect().await.unwrap().to_bytes();
        let (method, path) = (parts.method.clone(), parts.uri.path().to_owned());
        let request = Request::from_parts(parts, Body::from(sent.clone()));
        let response = self.routes.clone().oneshot(request).await.unwrap();
        let (parts, body) = response.into_parts();
        let body = body.collect().await.unwrap().to_bytes();
        schema::check(&method, &path, &sent, parts.status, &body);
        Answer { status: parts.status, headers: parts.headers, body }
    }

    /// An answer whose body is not read yet.
    pub(crate) async fn open(&self, path: &str) -> Response {
        self.begin(Request::get(path).body(Body::empty()).unwrap()).await
    }

    /// The same for any request.
    pub(crate) async fn begin(&self, request: Request<Body>) -> Response {
        self.routes.clone().oneshot(request).await.unwrap()
    }

    pub(crate) async fn get(&self, path: &str) -> Answer {
        self.send(Request::get(path).body(Body::empty()).unwrap()).await
    }

    pub(crate) async fn post(&self, path: &str, body: Value) -> Answer {
        self.send(json_request(Method::POST, path, body.to_string())).await
    }

    pub(crate) async fn patch(&self, path: &str, body: Value) -> Answer {
        self.send(json_request(Method::PATCH, path, body.to_string())).await
    }

    /// Submits a sweep and gives its id.
    pub(crate) async fn submit(&self, body: Value) -> String {
        let answer = self.post("/v1/sweeps", body).await;
        assert_eq!(answer.status, StatusCode::CREATED, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    }

    /// The file of a blob.
    pub(crate) fn blob_file(&self, hash: &str) -> PathBuf {
        self.directory.path().join("blobs").join(&hash[..2]).join(&hash[2..4]).join(hash)
    }

    /// The file of a table of a point.
    pub(crate) async fn blob_file_of(&self, sweep: &str, point: u32, table: &str) -> PathBuf {
        let list = self.get(&format!("{sweep}/points/{point}/artifacts")).await.json();
        let entries = list["artifacts"].as_array().unwrap();
        let entry = entries.iter().find(|entry| entry["name"] == table).unwrap();
        self.blob_file(entry["hash"].as_str().unwrap())
    }

    pub(crate) async fn claim(&self) -> Claim {
        let physics_version = drillsweep_api::PHYSICS_VERSION.into();
        self.store.claim("bench", physics_version, 60_000).await.unwrap().expect("a point waits")
    }

    /// Claims the next point and ends it with the tables of [`tables`].
    pub(crate) async fn succeed(&self) {
        self.succeed_with(1e-9).await;
    }

    /// The same with a number of one's own in the summary.
    pub(crate) async fn succeed_with(&self, residual: f64) {
        let tables = tables();
        let tables: Vec<_> = tables.iter().map(|(name, table)| (*name, table)).collect();
        self.succeed_with_tables(residual, &tables).await;
    }

    /// The same with tables of one's own.
    pub(crate) async fn succeed_with_tables(&self, residual: f64, tables: &[(&str, &Table)]) {
        let claim = self.claim().await;
        let scenario =
            drillsweep_api::compose(&claim.scenario.base_json, &claim.scenario.changes_json).unwrap();
        let mut artifacts = Vec::new();
        for (name, table) in tables {
            let bytes = parquet::write(table).unwrap();
            artifacts.push(NewArtifact {
                name: (*name).to_owned(),
                media_type: "application/vnd.apache.parquet".to_owned(),
                bytes: bytes.len().try_into().unwrap(),
                row_count: table.rows().try_into().unwrap(),
                blob: self.store.put_blob(bytes).await.unwrap(),
            });
        }
        let summary = json!({"steps": 10_000, "density_seen": scenario.mud.map(|mud| mud.density), "residual": residual, "resolved_hz": 200.0,
            "orbit_radius_rms_49": 1e-3});
        let provenance = json!({"version": "bench"});
        let result = NewResult {
            summary_json: &summary.to_string(),
            provenance_json: &provenance.to_string(),
            artifacts: &artifacts,
            is_repeatable: true,
        };
        assert!(self.store.finish_done(&claim.lease, &result).await.unwrap());
    }

    /// Claims the next point and ends it as diverged.
    pub(crate) async fn diverge(&self) {
        let claim = self.claim().await;
        let error =
            json!({"class": "physical", "reason": "the state is not finite", "time": 1.25, "node": 49});
        assert!(self.store.finish_failed(&claim.lease, &error.to_string()).await.unwrap());
    }
}

pub(crate) fn json_request(method: Method, path: &str, body: String) -> Request<Body> {
    Request::builder()
        .method(method)
        .uri(path)
        .header(header::CONTENT_TYPE, "application/json")
        .body(Body::from(body))
        .unwrap()
}

/// Rate of the made-up recording \[Hz\].
pub(crate) const RATE: f64 = 1000.0;

/// Duration of the made-up recording \[s\].
pub(crate) const DURATION: f64 = 10.0;

/// The recorded nodes with their measured depths \[m\].
pub(crate) const NODES: [(u32, f64); 2] = [(10, 11.72), (49, 57.73)];

/// Node 49 turns forward with 30 mm at 2 Hz and backward with 10 mm at 3 Hz about (4, 3) mm; node 10 rests.
fn tables() -> Vec<(&'static str, Table)> {
    let samples = (RATE * DURATION) as usize;
    let time: Vec<f64> = (0..samples).map(|k| k as f64 / RATE).collect();
    let of_time = |f: fn(f64) -> f64| Column::Number(time.iter().map(|t| f(*t)).collect());
    let mut history = Table::default();
    history.push("time", Column::Number(time.clone()));
    history.push("u_10", of_time(|_| 0.01));
    history.push("v_10", of_time(|_| 0.0));
    history.push("u_49", of_time(|t| 0.004 + 0.03 * (2.0 * TAU * t).cos() + 0.01 * (3.0 * TAU * t).cos()));
    history.push("v_49", of_time(|t| 0.003 + 0.03 * (2.0 * TAU * t).sin() - 0.01 * (3.0 * TAU * t).sin()));

    let mut statics = Table::default();
    statics.push("node", Column::Integer([1, 10, 49, 50].map(Some).to_vec()));
    statics.push("measured_depth", Column::Number(vec![0.0, NODES[0].1, NODES[1].1, 59.2]));

    let mut profile = Table::default();
    profile.push("element", Column::Integer([1, 2].map(Some).to_vec()));
    profile.push("friction_coefficient", Column::Number(vec![0.0192, f64::NAN]));
    profile.push("regime", Column::Text(["laminar", "turbulent"].map(|text| Some(text.to_owned())).to_vec()));
    vec![("history", history), ("statics", statics), ("profile", profile)]
}
