//! The largest sweep: a hundred thousand points through the whole service, on a file in the temporary directory, without
//! the network.
//!
//! `DRILLSWEEP_BENCH_BESIDE` names a command that runs meanwhile, once a core and as nice as workers are: with one that simulates,
//! this is what the service does while all cores are busy.

use std::cell::Cell;
use std::process::{Child, Command, Stdio};

use axum::Router;
use axum::body::{Body, Bytes};
use axum::http::{Request, header};
use divan::Bencher;
use drillsweep_server::{Config, router};
use drillsweep_store::{Role, Store, StoreConfig};
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::runtime::Runtime;
use tokio::sync::watch;
use tower::ServiceExt;

fn main() {
    let _load = Load::start();
    divan::main();
}

/// Processes that keep the cores busy, until this is dropped.
struct Load(Vec<Child>);

impl Load {
    fn start() -> Self {
        let Ok(beside) = std::env::var("DRILLSWEEP_BENCH_BESIDE") else { return Load(Vec::new()) };
        let cores = std::thread::available_parallelism().expect("a number of cores").get();
        let start = |_| {
            let mut command = Command::new("nice");
            command
                .args(["-n", "10"])
                .args(beside.split_whitespace())
                .stdin(Stdio::null())
                .stdout(Stdio::null());
            command.spawn().expect("a command")
        };
        Load((0..cores).map(start).collect())
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        for child in &mut self.0 {
            let ended = child.try_wait().expect("a state");
            assert!(ended.is_none(), "what should keep a core busy had ended: {ended:?}");
            child.kill().expect("killed");
            child.wait().expect("ended");
        }
    }
}

struct Service {
    runtime: Runtime,
    routes: Router,
    _stop: watch::Sender<bool>,
    _directory: TempDir,
}

impl Service {
    fn new() -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .enable_all()
            .build()
            .expect("a runtime");
        let config = StoreConfig::in_directory(directory.path(), Role::Server);
        let store = runtime.block_on(Store::open(&config)).expect("a store");
        let (stop, stopping) = watch::channel(false);
        let mut config = Config::default();
        config.owner_limits.open_points = u64::MAX;
        let routes = router(store, config, stopping);
        Service { runtime, routes, _stop: stop, _directory: directory }
    }

    fn send(&self, request: Request<Body>) -> Bytes {
        self.runtime.block_on(async {
            let response = self.routes.clone().oneshot(request).await.expect("an answer");
            assert!(response.status().is_success(), "{}", response.status());
            response.into_body().collect().await.expect("a body").to_bytes()
        })
    }

    fn get(&self, path: &str) -> Bytes {
        self.send(Request::get(path).body(Body::empty()).expect("a request"))
    }

    /// Submits a sweep of a hundred thousand points that differ from those of any other `number`.
    fn submit(&self, number: u32) -> String {
        let body = json!({"preset": "paper-200m", "design": "sobol", "samples": 100_000, "seed": number, "axes": {
            "flow_rate": {"from": 0.01, "to": 0.06},
            "mud_density": {"from": 1200, "to": 2100},
            "operation.rotation_speed_rpm": {"from": 60, "to": 180}
        }});
        let request = Request::post("/v1/sweeps")
            .header(header::CONTENT_TYPE, "application/json")
            .body(Body::from(body.to_string()))
            .expect("a request");
        let sweep: Value = serde_json::from_slice(&self.send(request)).expect("a sweep");
        sweep["id"].as_str().expect("an id").to_owned()
    }
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn submit(bencher: Bencher) {
    let service = Service::new();
    let number = Cell::new(0);
    bencher.bench_local(|| {
        number.set(number.get() + 1);
        service.submit(number.get())
    });
}

/// The largest page of points there is, from the middle of the sweep.
#[divan::bench(sample_count = 100, sample_size = 1)]
fn page_of_points(bencher: Bencher) {
    let service = Service::new();
    let id = service.submit(1);
    bencher.bench_local(|| service.get(&format!("/v1/sweeps/{id}/points?limit=500&cursor=50000")));
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn one_point(bencher: Bencher) {
    let service = Service::new();
    let id = service.submit(1);
    bencher.bench_local(|| service.get(&format!("/v1/sweeps/{id}/points/50000")));
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn sweep_and_its_counts(bencher: Bencher) {
    let service = Service::new();
    let id = service.submit(1);
    bencher.bench_local(|| service.get(&format!("/v1/sweeps/{id}")));
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn page_of_sweeps(bencher: Bencher) {
    let service = Service::new();
    service.submit(1);
    bencher.bench_local(|| service.get("/v1/sweeps?limit=500"));
}
