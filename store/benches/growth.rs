//! Growth of the queue: a sweep of many points, and many workers that claim, renew their lease as they reserve a small blob, write
//! it and finish, and compute nothing, while others submit and look.
//!
//! `cargo bench -p drillsweep-store --bench growth -- --engine postgres --points 1000000 --workers 200 --seconds 120`
//!
//! With `--compute-ms` each worker waits for so long before it finishes a point, so that all together claim no more than the workers
//! over that time.

#![expect(clippy::print_stdout, reason = "a report")]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use drillsweep_store::{
    BlobId, CachePolicy, DatabaseLocation, NewArtifact, NewPoint, NewResult, NewSweep, NewVerification,
    Renewal, Role, Store, StoreConfig, SweepFilter,
};

#[path = "../tests/servers/mod.rs"]
#[allow(dead_code, reason = "of the tests")]
mod servers;

/// A server as one would run it, and not as the tests do: what it has confirmed is on the disk.
const SETTINGS: &[&str] =
    &["fsync=on", "full_page_writes=on", "max_connections=800", "shared_buffers=512MB", "max_wal_size=4GB"];

const SWEEP: &str = "0190";

/// Warm-up of the workers before the measurement. With its first points each of their connections reads the schema, plans its
/// statements and maps the server's memory, and what was submitted is vacuumed and analyzed for the first time, after which all plan anew.
const WARM_UP: Duration = Duration::from_secs(60);

/// Parameters of the measurement.
struct Plan {
    engine: String,
    points: i64,
    workers: usize,
    /// Duration of the measurement \[s\].
    seconds: u64,
    /// Time for which a worker keeps each point before it finishes it.
    compute: Duration,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str, default: &str| {
        let found = arguments.windows(2).find(|pair| pair[0] == name).map(|pair| pair[1].clone());
        found.unwrap_or_else(|| default.to_owned())
    };
    let number = |name: &str, default: &str| value(name, default).parse::<i64>().expect("a number");
    let plan = Plan {
        engine: value("--engine", "postgres"),
        points: number("--points", "100000"),
        workers: usize::try_from(number("--workers", "200")).expect("a number of workers"),
        seconds: number("--seconds", "30").unsigned_abs(),
        compute: Duration::from_millis(number("--compute-ms", "0").unsigned_abs()),
    };
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let directory = tempfile::tempdir().expect("a temporary directory");
    let mut config = StoreConfig::in_directory(directory.path(), Role::Server);
    let server = (plan.engine == "postgres").then(|| servers::postgres::Server::start_with(SETTINGS));
    if let Some(server) = &server {
        config.database = server.url().parse::<DatabaseLocation>().expect("a URL");
    }
    let Plan { engine, points, workers, compute, .. } = &plan;
    println!("{engine}: {points} points, {workers} workers that have a point for {compute:?}");
    runtime.block_on(run(&plan, &config, server.as_ref()));
    let bytes = match &server {
        Some(server) => {
            server.query("CHECKPOINT");
            server.query("SELECT pg_database_size(current_database())").parse::<f64>().expect("a size")
        }
        None => {
            let file = directory.path().join("drillsweep.sqlite");
            std::fs::metadata(file).expect("the file").len() as f64
        }
    };
    println!("database: {:.0} MB, {:.0} bytes a point", bytes / 1e6, bytes / plan.points as f64);
    runtime.shutdown_background();
}

async fn run(plan: &Plan, config: &StoreConfig, server: Option<&servers::postgres::Server>) {
    let store = Store::open(config).await.expect("a store");
    let is_over = Arc::new(AtomicBool::new(false));

    let large = sweep(SWEEP, "anne", plan.points);
    let others = tokio::spawn(submit_concurrently(store.clone(), is_over.clone()));
    let began = Instant::now();
    let spent = Spent::now(server);
    store.submit_sweep(&large).await.expect("submitted");
    println!("submit: {:.1} s", began.elapsed().as_secs_f64());
    spent.report("a submitted point", plan.points as f64, began.elapsed(), server);
    is_over.store(true, Ordering::Relaxed);
    report("another owner's submit meanwhile", others.await.expect("it ends"));

    is_over.store(false, Ordering::Relaxed);
    let finished = Arc::new(AtomicU64::new(0));
    let mut workers = Vec::new();
    for number in 0..plan.workers {
        let config = StoreConfig { role: Role::Worker, ..config.clone() };
        let store = Store::open(&config).await.expect("a store");
        workers.push(tokio::spawn(work(store, number, plan.compute, is_over.clone(), finished.clone())));
    }
    tokio::time::sleep(WARM_UP).await;
    let readers = tokio::spawn(read_concurrently(store.clone(), plan.points, is_over.clone()));
    let began = Instant::now();
    let spent = Spent::now(server);
    let before = finished.load(Ordering::Relaxed);
    tokio::time::sleep(Duration::from_secs(plan.seconds)).await;
    is_over.store(true, Ordering::Relaxed);
    let points = (finished.load(Ordering::Relaxed) - before) as f64;
    println!("claims and finishes: {:.0} a second", points / began.elapsed().as_secs_f64());
    spent.report("a point", points, began.elapsed(), server);
    let mut waits = Waits::default();
    for worker in workers {
        let Waits { claims, finishes } = worker.await.expect("it ends");
        waits.claims.extend(claims);
        waits.finishes.extend(finishes.into_iter().filter(|(at, _)| *at >= began));
    }
    report("a first claim, of all at once", waits.claims);
    report("a result and the next claim", waits.finishes.into_iter().map(|(_, wait)| wait).collect());
    let readings = readers.await.expect("it ends");
    report("a page of sweeps", readings.lists);
    report("a page of 100 points", readings.pages);
    report("500 rows of the table", readings.tables);
    report("a sweep's version", readings.versions);
}

/// Processor time up to a moment, of the database's server and of this process, in which all clients are.
struct Spent {
    server: Duration,
    clients: Duration,
}

impl Spent {
    fn now(server: Option<&servers::postgres::Server>) -> Self {
        Self {
            server: server.map_or(Duration::ZERO, |server| family_time(server.process())),
            clients: own_time(std::process::id()).map_or(Duration::ZERO, |(_, time)| time),
        }
    }

    /// Prints the processor time spent since then per point, and the share of the machine's cores that it took.
    fn report(&self, what: &str, points: f64, elapsed: Duration, server: Option<&servers::postgres::Server>) {
        let now = Self::now(server);
        let of_server = (now.server - self.server).as_secs_f64();
        let of_clients = (now.clients - self.clients).as_secs_f64();
        let cores = std::thread::available_parallelism().map_or(1, usize::from) as f64;
        println!(
            "processor time for {what}: {:.3} ms of the server and {:.3} ms of the clients; {:.0} % of {cores} cores",
            of_server * 1e3 / points,
            of_clients * 1e3 / points,
            (of_server + of_clients) / elapsed.as_secs_f64() / cores * 100.0
        );
    }
}

/// Processor time of a process and of its children, those that have ended too.
fn family_time(parent: u32) -> Duration {
    let processes = std::fs::read_dir("/proc").into_iter().flatten().filter_map(Result::ok);
    let numbers = processes.filter_map(|process| process.file_name().to_str()?.parse().ok());
    let of_family =
        |number: u32| own_time(number).filter(|(its_parent, _)| number == parent || *its_parent == parent);
    numbers.filter_map(of_family).map(|(_, time)| time).sum()
}

/// Parent of a process, and its processor time with that of the children that it has waited for; none of one that has ended.
fn own_time(process: u32) -> Option<(u32, Duration)> {
    /// Unit in which Linux counts times, on all machines that this runs on.
    const TICK: Duration = Duration::from_millis(10);
    let line = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // After the name, which may have any signs in it.
    let fields: Vec<&str> = line.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: u32 = fields.get(11..15)?.iter().filter_map(|ticks| ticks.parse::<u32>().ok()).sum();
    Some((fields.get(1)?.parse().ok()?, TICK * ticks))
}

/// Another owner's sweeps of one point, one after the other.
async fn submit_concurrently(store: Store, is_over: Arc<AtomicBool>) -> Vec<Duration> {
    let mut times = Vec::new();
    while !is_over.load(Ordering::Relaxed) {
        let own = sweep(&format!("0191-{:09}", times.len()), "bob", 1);
        let began = Instant::now();
        store.submit_sweep(&own).await.expect("submitted");
        times.push(began.elapsed());
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    times
}

/// Waiting times of readers.
#[derive(Default)]
struct Readings {
    lists: Vec<Duration>,
    pages: Vec<Duration>,
    tables: Vec<Duration>,
    versions: Vec<Duration>,
}

async fn read_concurrently(store: Store, points: i64, is_over: Arc<AtomicBool>) -> Readings {
    let mut readings = Readings::default();
    let mut after = 0;
    while !is_over.load(Ordering::Relaxed) {
        let began = Instant::now();
        store.sweeps(&SweepFilter::default(), None, 50).await.expect("a list");
        readings.lists.push(began.elapsed());
        // All over the sweep, by steps that share no divisor with its size.
        after = (after + 7_919) % points;
        let began = Instant::now();
        store.points(SWEEP, &[], after, 100).await.expect("a page");
        readings.pages.push(began.elapsed());
        let began = Instant::now();
        store.table_rows(SWEEP, after, 500).await.expect("a page");
        readings.tables.push(began.elapsed());
        let began = Instant::now();
        store.sweep_version(SWEEP).await.expect("a version");
        readings.versions.push(began.elapsed());
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    readings
}

/// Waiting times of a worker for the database.
#[derive(Default)]
struct Waits {
    /// Waits for its first point.
    claims: Vec<Duration>,
    /// Instants of finishing, with the waits for a result to be stored and the next point to be claimed.
    finishes: Vec<(Instant, Duration)>,
}

/// A worker that computes nothing.
async fn work(
    store: Store,
    number: usize,
    compute: Duration,
    is_over: Arc<AtomicBool>,
    finished: Arc<AtomicU64>,
) -> Waits {
    let name = format!("worker {number}");
    let summary = format!(r#"{{"rows":"{:>500}"}}"#, "");
    let mut waits = Waits::default();
    let mut next = None;
    while !is_over.load(Ordering::Relaxed) {
        let claim = match next.take() {
            Some(claim) => claim,
            None => {
                let began = Instant::now();
                let Some(claim) = store.claim(&name, 1, 60_000).await.expect("claimed") else { break };
                waits.claims.push(began.elapsed());
                claim
            }
        };
        if !compute.is_zero() {
            tokio::time::sleep(compute).await;
        }
        let content = claim.lease.key.to_vec();
        let blob = BlobId::of(&content);
        let renewal = store.reserve(&claim.lease, 60_000, &[blob]).await.expect("renewed");
        assert_eq!(renewal, Renewal::Held, "nobody else has it");
        store.blobs().put(content).await.expect("written");
        let artifact = NewArtifact {
            name: "history".to_owned(),
            media_type: "application/vnd.apache.parquet".to_owned(),
            blob,
            bytes: 32,
            row_count: 1,
        };
        let result = NewResult {
            summary_json: &summary,
            provenance_json: "{}",
            artifacts: &[artifact],
            is_repeatable: true,
        };
        let began = Instant::now();
        let done = store.finish_and_claim(&claim.lease, &result, 1, 60_000).await.expect("finished");
        waits.finishes.push((began, began.elapsed()));
        assert!(done.is_stored, "nobody else has it");
        finished.fetch_add(1, Ordering::Relaxed);
        next = done.next;
    }
    if let Some(claim) = next {
        assert!(store.release(&claim.lease).await.expect("given back"), "nobody else has it");
    }
    waits
}

/// A sweep whose texts are as long as real ones.
fn sweep(id: &str, owner: &str, points: i64) -> NewSweep {
    let point = |ordinal: i64| NewPoint {
        ordinal,
        parameters_json: format!(r#"{{"flow_rate":0.03,"mud_density":{ordinal}}}"#),
        changes_json: format!(r#"{{"mud.flow_rate":0.03,"mud.density":{ordinal}}}"#),
        work_key: *blake3::hash(format!("{id} {ordinal}").as_bytes()).as_bytes(),
        fuller_key: None,
    };
    NewSweep {
        id: id.to_owned(),
        name: None,
        owner: owner.to_owned(),
        request_json: "{}".to_owned(),
        priority: 0,
        varied_json: r#"["flow_rate"]"#.to_owned(),
        tags_json: "[]".to_owned(),
        cache: CachePolicy::Reuse,
        idempotency_key: None,
        base_json: format!("{:>3000}", "{}"),
        physics_version: 1,
        points: (1..=points).map(point).collect(),
        verification: NewVerification::default(),
    }
}

fn report(what: &str, mut times: Vec<Duration>) {
    times.sort_unstable();
    let at = |share: f64| {
        let index = (share * times.len() as f64) as usize;
        times.get(index.min(times.len().saturating_sub(1))).map_or(0.0, |time| time.as_secs_f64() * 1e3)
    };
    println!(
        "{what}: {:.1} ms median, {:.1} ms p99, {:.1} ms longest ({})",
        at(0.5),
        at(0.99),
        at(1.0),
        times.len()
    );
}
