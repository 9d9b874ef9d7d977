//! Time of a list of sweeps, and memory of the service, while clients download histories and the table of a large sweep over
//! the network of this machine: a row of the table for each number of clients.
//!
//! `cargo bench -p drillsweep-server --bench downloads`. The clients are in the same process: their memory, 64 KiB each, is counted too.

#![expect(clippy::print_stdout, reason = "what is measured is printed")]

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::os::unix::process::CommandExt as _;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use axum::body::Body;
use axum::http::{Request, header};
use drillsweep_server::{Config, Listeners, router, serve};
use drillsweep_store::{Claim, NewArtifact, NewResult, Role, Store, StoreConfig};
use drillsweep_table::{Column, Table, parquet};
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Runtime;
use tokio::sync::watch;
use tower::ServiceExt;

/// Numbers of clients that download.
const CLIENTS: [usize; 4] = [0, 12, 50, 200];

/// Time for which lists of sweeps are requested during the downloads, and the pause between two of them.
const MEASURED: Duration = Duration::from_secs(20);
const PAUSE: Duration = Duration::from_millis(5);

/// Recorded nodes, and samples at 1 kHz.
const NODES: u32 = 40;
const SAMPLES: u32 = 60_000;

/// Points of the sweep whose table is asked for, and fields of their summaries.
const POINTS: u32 = 20_000;
const FIELDS: u32 = 50;

/// Settings that the program makes for itself when it serves: glibc reads them at the start only.
const ALLOCATOR: [(&str, &str); 2] = [("MALLOC_ARENA_MAX", "2"), ("MALLOC_MMAP_THRESHOLD_", "1048576")];

fn main() {
    if ALLOCATOR.iter().any(|(setting, _)| std::env::var_os(setting).is_none()) {
        let program = std::env::current_exe().expect("this program");
        let missing = ALLOCATOR.into_iter().filter(|(setting, _)| std::env::var_os(setting).is_none());
        let error = Command::new(program).args(std::env::args_os().skip(1)).envs(missing).exec();
        panic!("this program does not start again: {error}");
    }
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    // Other clients than that of the lists compete for this machine's cores as little as if they were on others.
    let clients = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .on_thread_start(|| {
            rustix::process::nice(19).expect("Linux");
        })
        .build()
        .expect("a runtime");
    runtime.block_on(measure(&clients));
}

async fn measure(others: &Runtime) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let config = StoreConfig::in_directory(directory.path(), Role::Server);
    let store = Store::open(&config).await.expect("a store");
    let point = finished(&store).await;
    let sweep = large(&store).await;
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    let listeners = Listeners { api: listener, metrics: None };
    tokio::spawn(serve(listeners, store, Config::default(), std::future::pending()));
    println!("clients | list p50 [ms] | list p99 [ms] | peak memory [MB] | downloaded [MB] | refused");
    for clients in CLIENTS {
        // Peak memory counts from here on.
        std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
        let is_over = Arc::new(AtomicBool::new(false));
        let (bytes, refused) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
        let downloads: Vec<_> = (0..clients)
            .map(|client| {
                let (is_over, bytes, refused) = (is_over.clone(), bytes.clone(), refused.clone());
                let path = match client % 5 {
                    0 => format!("{point}/history?format=csv"),
                    1 => format!("{point}/history?format=npz"),
                    2 => format!("{point}/artifacts/history"),
                    3 => format!("{sweep}/table?format=csv"),
                    _ => format!("{point}/orbit?node=7&format=json"),
                };
                others.spawn(async move {
                    while !is_over.load(Ordering::Relaxed) {
                        if !download(address, &path, &bytes, &is_over).await {
                            refused.fetch_add(1, Ordering::Relaxed);
                        }
                    }
                })
            })
            .collect();
        let mut times = Vec::new();
        let first = Instant::now();
        while first.elapsed() < MEASURED {
            tokio::time::sleep(PAUSE).await;
            let begin = Instant::now();
            assert!(download(address, "/v1/sweeps", &AtomicU64::new(0), &AtomicBool::new(false)).await);
            times.push(begin.elapsed().as_secs_f64() * 1e3);
        }
        is_over.store(true, Ordering::Relaxed);
        for download in downloads {
            download.await.expect("it ends");
        }
        times.sort_by(f64::total_cmp);
        println!(
            "{clients:7} | {:13.1} | {:13.1} | {:16} | {:15} | {}",
            times[times.len() / 2],
            times[times.len() * 99 / 100],
            peak_kilobytes() / 1000,
            bytes.load(Ordering::Relaxed) / 1_000_000,
            refused.load(Ordering::Relaxed)
        );
    }
}

/// Reads an answer to its end, or until it is over, and counts its bytes; false where it is refused.
async fn download(address: SocketAddr, path: &str, bytes: &AtomicU64, is_over: &AtomicBool) -> bool {
    let mut connection = TcpStream::connect(address).await.expect("connected");
    let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    connection.write_all(request.as_bytes()).await.expect("sent");
    let mut buffer = vec![0; 64 << 10];
    let mut count = connection.read(&mut buffer).await.expect("answered");
    let is_served = buffer.starts_with(b"HTTP/1.1 200");
    while count > 0 && !is_over.load(Ordering::Relaxed) {
        bytes.fetch_add(count as u64, Ordering::Relaxed);
        count = connection.read(&mut buffer).await.expect("answered");
    }
    is_served
}

/// Makes a sweep of one point with a history that no compression makes smaller, and gives the point's path.
async fn finished(store: &Store) -> String {
    let sweep = submit(store, &json!({"preset": "paper-200m"})).await;
    let claim = claim(store).await;
    let mut artifacts = Vec::new();
    for (name, table) in [("history", history()), ("statics", statics())] {
        let bytes = parquet::write(&table).expect("a table");
        artifacts.push(NewArtifact {
            name: name.to_owned(),
            media_type: "application/vnd.apache.parquet".to_owned(),
            bytes: bytes.len().try_into().expect("small"),
            row_count: table.rows().try_into().expect("few"),
            blob: store.put_blob(bytes).await.expect("stored"),
        });
    }
    let result =
        NewResult { summary_json: "{}", provenance_json: "{}", artifacts: &artifacts, is_repeatable: true };
    assert!(store.finish_done(&claim.lease, &result).await.expect("stored"));
    format!("{sweep}/points/1")
}

/// Makes a sweep of many points, each with a summary of the usual size, and gives the sweep's path.
async fn large(store: &Store) -> String {
    let axes = json!({"flow_rate": {"from": 0.01, "to": 0.06}, "mud_density": {"from": 1200, "to": 2100}});
    let request = json!({"preset": "paper-200m", "design": "sobol", "samples": POINTS, "axes": axes});
    let sweep = submit(store, &request).await;
    for point in 0..POINTS {
        let claim = claim(store).await;
        let field = |k: u32| (format!("orbit_largest_radius_{k}"), 0.037 / f64::from(point + k + 1));
        let summary: BTreeMap<String, f64> = (0..FIELDS).map(field).collect();
        let summary = json!(summary).to_string();
        let result =
            NewResult { summary_json: &summary, provenance_json: "{}", artifacts: &[], is_repeatable: true };
        assert!(store.finish_done(&claim.lease, &result).await.expect("stored"));
    }
    sweep
}

async fn claim(store: &Store) -> Claim {
    let version = drillsweep_api::PHYSICS_VERSION.into();
    store.claim("bench", version, 60_000).await.expect("a claim").expect("a point waits")
}

/// Submits a sweep, and gives its path.
async fn submit(store: &Store, request: &Value) -> String {
    let (_stop, stopping) = watch::channel(false);
    let routes = router(store.clone(), Config::default(), stopping);
    let request = Request::post("/v1/sweeps")
        .header(header::CONTENT_TYPE, "application/json")
        .body(Body::from(request.to_string()))
        .expect("a request");
    let answer = routes.oneshot(request).await.expect("answered");
    let body = answer.into_body().collect().await.expect("read").to_bytes();
    let sweep: Value = serde_json::from_slice(&body).expect("JSON");
    format!("/v1/sweeps/{}", sweep["id"].as_str().expect("an id"))
}

fn history() -> Table {
    let mut state: u64 = 1;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 * 1e-9
    };
    let time = (0..SAMPLES).map(|sample| f64::from(sample) / 1000.0).collect();
    let mut table = Table::default().with("time", Column::Number(time));
    for node in 1..=NODES {
        for quantity in ["u", "v", "w", "theta_z", "u_rate", "v_rate", "w_rate", "theta_z_rate"] {
            table.push(format!("{quantity}_{node}"), Column::Single((0..SAMPLES).map(|_| next()).collect()));
        }
    }
    table
}

fn statics() -> Table {
    Table::default()
        .with("node", Column::Integer((1..=NODES).map(|node| Some(node.into())).collect()))
        .with("measured_depth", Column::Number((0..NODES).map(f64::from).collect()))
}

fn peak_kilobytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}
