//! Several servers and workers on one PostgreSQL database and one bucket, all of which fail in their turn.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use drillsweep_server::RetentionConfig;
use drillsweep_store::{Metrics, ObjectsLocation, RetentionPolicy, Role, Store, StoreConfig};
use jiff::{SignedDuration, Timestamp};
use serde_json::{Value, json};

use crate::faults::{Clock, Logged, bytes, checked, command, last_claim, points, request, serve, submit};
use crate::servers::postgres::Server as Postgres;
use crate::servers::proxy::{Behaviour, Proxy};
use crate::servers::seaweed::Seaweed;
use crate::{BINARY, PATIENCE, completed, get, wait};

/// Simulated seconds per second of workers that are killed: those who are spared between two faults do not finish most of it.
const PACE: &str = "2";

/// The same of workers in a hurry.
const FULL_SPEED: &str = "1000";

const WORKER_KILLS: usize = 20;

/// Duration of the object store's absence.
const AWAY: Duration = Duration::from_secs(30);

/// Resources that all processes share, wherever they run.
pub(crate) struct Site {
    pub(crate) postgres: Postgres,
    pub(crate) objects: Seaweed,
    /// Proxy to the object store.
    way: Proxy,
    scratch: tempfile::TempDir,
}

impl Site {
    pub(crate) fn new() -> Self {
        let (postgres, objects) = (Postgres::start(), Seaweed::start());
        let way = Proxy::before(&objects.address());
        Site { postgres, objects, way, scratch: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        self.command_by(&self.postgres.url(), self.way.address(), arguments)
    }

    /// A command that reaches database and object store in ways of its own.
    fn command_by(&self, database: &str, objects: &str, arguments: &[&str]) -> Command {
        let location = self.objects.location(objects, "team");
        let ObjectsLocation::S3 { settings, .. } = &location else { panic!("a bucket") };
        let mut command = Command::new(BINARY);
        command.args(arguments).arg("--data").arg(self.scratch.path());
        command.env("DRILLSWEEP_DATABASE", database).env("DRILLSWEEP_OBJECTS", location.to_string());
        for (variable, setting) in [
            ("AWS_ENDPOINT_URL", "endpoint"),
            ("AWS_ALLOW_HTTP", "allow_http"),
            ("AWS_REGION", "region"),
            ("AWS_ACCESS_KEY_ID", "access_key_id"),
            ("AWS_SECRET_ACCESS_KEY", "secret_access_key"),
        ] {
            command.env(variable, &settings[setting]);
        }
        command
    }

    pub(crate) fn serve(&self) -> (Logged, String) {
        self.serve_at("127.0.0.1:0")
    }

    fn serve_at(&self, address: &str) -> (Logged, String) {
        let listen = address.trim_start_matches("http://");
        let server = Logged::start(&mut self.command(&["serve", "--listen", listen]));
        let address = server.address();
        (server, address)
    }

    /// One that is in no hurry.
    pub(crate) fn worker(&self) -> Logged {
        self.worker_at(PACE)
    }

    fn worker_at(&self, pace: &str) -> Logged {
        Logged::start(&mut self.command(&["worker", "--lease-seconds", "2", "--pace", pace]))
    }

    /// Configuration that opens the store as it is after some time.
    fn store(&self, clock_offset_ms: i64) -> StoreConfig {
        StoreConfig {
            database: self.postgres.url().parse().unwrap(),
            objects: self.objects.location(&self.objects.address(), "team"),
            role: Role::Server,
            clock_offset_ms,
            metrics: Metrics::default(),
        }
    }

    /// Ends all connections of all processes.
    fn cut_connections(&self) {
        let cut =
            "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE pid <> pg_backend_pid()
                   AND backend_type = 'client backend'";
        let cut: String = self.postgres.query(cut);
        assert_ne!(cut, "0", "there were connections");
    }
}

/// A client that follows a sweep, at whichever server there is, and goes on after the last event that it has seen.
struct Follower {
    events: Arc<Mutex<BTreeMap<u64, Value>>>,
    thread: std::thread::JoinHandle<()>,
}

impl Follower {
    /// Follows until the sweep has ended.
    fn start(servers: Vec<String>, sweep: &str) -> Self {
        let events: Arc<Mutex<BTreeMap<u64, Value>>> = Arc::default();
        let (kept, sweep) = (events.clone(), sweep.to_owned());
        let thread = std::thread::spawn(move || {
            let deadline = Instant::now() + 2 * PATIENCE;
            for server in servers.iter().cycle() {
                assert!(Instant::now() < deadline, "the sweep did not end: {:?}", kept.lock().unwrap());
                if follow(&format!("{server}/v1/sweeps/{sweep}/events"), &kept) {
                    return;
                }
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        Follower { events, thread }
    }

    /// The new states of points that it has heard of, in their order.
    fn states(self) -> Vec<String> {
        self.thread.join().unwrap();
        let events = self.events.lock().unwrap();
        events.values().filter_map(|event| Some(event["state"].as_str()?.to_owned())).collect()
    }
}

/// Follows one stream to its end. True if that is the sweep's.
fn follow(url: &str, events: &Mutex<BTreeMap<u64, Value>>) -> bool {
    let last = events.lock().unwrap().keys().last().copied().unwrap_or(0);
    let Ok(mut answer) = ureq::get(url).header("Last-Event-ID", &last.to_string()).call() else {
        return false;
    };
    if answer.status() == 204 {
        return true;
    }
    let (mut id, mut kind) = (None, String::new());
    for line in BufReader::new(answer.body_mut().as_reader()).lines().map_while(Result::ok) {
        match line.split_once(": ") {
            Some(("id", number)) => id = number.parse::<u64>().ok(),
            Some(("event", name)) => kind = name.to_owned(),
            Some(("data", text)) if kind == "point" => {
                let event = serde_json::from_str(text).unwrap();
                let known = events.lock().unwrap().insert(id.unwrap(), event);
                assert!(known.is_none(), "an event came twice: {known:?}");
            }
            Some(("data", text)) => {
                let sweep: Value = serde_json::from_str(text).unwrap();
                if sweep["state"].is_string() && sweep["state"] != "running" {
                    return true;
                }
            }
            _ => {}
        }
    }
    false
}

/// Fault in addition to the kill of a worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    /// Nothing else.
    Nothing,
    /// One of the two servers is killed, and started again at the next one.
    Server,
    /// All connections to the database are ended.
    Cut,
    /// The database is killed and started again.
    Database,
    /// The object store answers that it has too much to do, until the next time.
    Overload,
    /// The object store is slow until the next time.
    Slow,
    /// The object store is killed in the middle of a write, and is away for long.
    Objects,
}

/// One for each kill of a worker.
const FAULTS: [Fault; WORKER_KILLS] = {
    use Fault::{Cut, Database, Nothing, Objects, Overload, Server, Slow};
    [
        Nothing, Cut, Server, Slow, Nothing, Server, Database, Nothing, Overload, Server, Nothing, Slow, Cut,
        Server, Nothing, Database, Server, Overload, Nothing, Objects,
    ]
};

#[test]
fn failures_of_every_part_do_not_change_the_numbers() {
    let request = request(9.0, 4, 4);
    let calm = tempfile::tempdir().unwrap();
    let mut undisturbed =
        Logged::start(&mut command(calm.path(), &["up", "--workers", "2", "--listen", "127.0.0.1:0"]));
    let calm_server = undisturbed.address();
    let calm_sweep = submit(&calm_server, &request);
    wait(&calm_server, &calm_sweep, completed);
    undisturbed.kill();

    let mut site = Site::new();
    let mut servers = [site.serve(), site.serve()];
    let addresses = servers.each_ref().map(|(_, address)| address.clone());
    let sweep = submit(&addresses[0], &request);
    let follower = Follower::start(addresses.to_vec(), &sweep);
    let collector = Collector::start(&site);
    let mut workers = [site.worker(), site.worker()];
    let (mut server_kills, mut in_a_hurry) = (0, Vec::new());
    for (kill, fault) in FAULTS.into_iter().enumerate() {
        // A worker dies at each, in the middle of a point. A point is given up after three dead workers: none is made to lose
        // more than two.
        let doomed = &mut workers[kill % 2];
        doomed.wait_for(|log| last_claim(log).filter(|token| *token <= 2));
        std::mem::replace(doomed, site.worker()).kill();
        site.way.set(Behaviour::Pass);
        match fault {
            Fault::Nothing => {}
            Fault::Server => {
                let (server, address) = &mut servers[server_kills % 2];
                server.kill();
                *server = site.serve_at(address).0;
                server_kills += 1;
            }
            Fault::Cut => site.cut_connections(),
            Fault::Database => {
                site.postgres.kill();
                site.postgres.resume();
            }
            Fault::Overload => {
                site.way.set(Behaviour::Refuse("503 Slow Down", "<Error><Code>SlowDown</Code></Error>"));
                // If nobody else asks for anything, this does.
                let readiness = format!("{}/readyz", addresses[0]);
                std::thread::spawn(move || ureq::get(readiness).call().is_ok());
                site.way.wait_for_disturbed(site.way.disturbed() + 2);
            }
            Fault::Slow => site.way.set(Behaviour::Delay(Duration::from_millis(100))),
            Fault::Objects => {
                in_a_hurry.push(site.worker_at(FULL_SPEED));
                site.way.wait_for(site.way.passed() + 100_000);
                site.objects.kill();
                std::thread::sleep(AWAY);
                site.objects.restart();
            }
        }
    }
    assert_eq!(server_kills, 5);
    in_a_hurry.push(site.worker_at(FULL_SPEED));
    let address = &addresses[0];
    let mut ended = wait_through_faults(address, &sweep);
    if ended["counts"]["failed"] != 0 {
        // A worker that took up a point between the look and the kill may make it a third death.
        for point in points(address, &sweep).iter().filter(|point| point["state"] == "failed") {
            assert_eq!(point["error"]["class"], "crash", "{point}");
        }
        crate::post(&format!("{address}/v1/sweeps/{sweep}/retry"), &json!({}));
        ended = wait_through_faults(address, &sweep);
    }
    assert_eq!(ended["counts"]["succeeded"], 16, "{ended}");
    let attempts: u64 = points(address, &sweep).iter().map(|point| point["attempts"].as_u64().unwrap()).sum();
    assert!(attempts >= 16 + 10, "the faults did not hit: {attempts} attempts");
    let states = follower.states();
    let ends = states.iter().filter(|state| *state == "succeeded").count();
    assert_eq!(ends, 16, "each end is told once, whichever server tells it: {states:?}");
    collector.end();
    collect_all(&site);

    let (calm_again, calm_server) = serve(calm.path(), None);
    let table = |server: &str, sweep: &str| bytes(&format!("{server}/v1/sweeps/{sweep}/table?format=csv"));
    assert!(table(address, &sweep) == table(&calm_server, &calm_sweep), "the numbers differ");
    for n in 1..=16 {
        for name in ["profile", "history"] {
            let of = |server: &str, sweep: &str| {
                bytes(&format!("{server}/v1/sweeps/{sweep}/points/{n}/{name}?format=parquet"))
            };
            assert!(of(address, &sweep) == of(&calm_server, &calm_sweep), "{name} of point {n} differs");
        }
    }
    drop(calm_again);
    assert_eq!(checked(&mut site.command(&["check", "--json"])), (16, vec![]), "every point is done once");
    let report = site.command(&["check", "--json"]).output().unwrap();
    let report: Value = serde_json::from_slice(&report.stdout).unwrap();
    let stored = site.objects.files("team").len() as u64;
    assert_eq!(Some(stored), report["blobs"].as_u64(), "what is stored is what results name");
}

#[test]
fn a_worker_cut_off_beyond_its_lease_changes_nothing_afterwards() {
    let site = Site::new();
    let (_server, address) = site.serve();
    let sweep = submit(&address, &request(6.0, 1, 2));
    // Cut off from database and object store alike, it goes on computing.
    let [database, objects] =
        [site.postgres.address(), site.objects.address()].map(|address| Proxy::before(&address));
    let url = site.postgres.url().replace(&site.postgres.address(), database.address());
    let arguments = ["worker", "--lease-seconds", "2", "--pace", "2"];
    let cut_off = Logged::start(&mut site.command_by(&url, objects.address(), &arguments));
    cut_off.wait_for(last_claim);
    database.set(Behaviour::StallAfter(0));
    objects.set(Behaviour::StallAfter(0));
    // Somebody else computes all of it meanwhile.
    let _heir = Logged::start(&mut site.command(&["worker"]));
    let ended = wait(&address, &sweep, completed);
    assert_eq!(ended["counts"]["succeeded"], 2, "{ended}");
    let results = |point: usize| get(&format!("{address}/v1/sweeps/{sweep}/points/{point}"));
    let before = [1, 2].map(results);
    assert_eq!(before.iter().map(|point| point["attempts"].as_u64().unwrap()).sum::<u64>(), 3, "{before:?}");

    // Its earlier message arrives now.
    database.set(Behaviour::Pass);
    objects.set(Behaviour::Pass);
    // Its heartbeat learns of it, or its write does, whichever comes first.
    cut_off
        .wait_for(|log| log.contains("LeaseLost").then_some(()).or(log.contains("lease lost").then_some(())));
    assert!([1, 2].map(results) == before, "the first results stand");
    assert_eq!(checked(&mut site.command(&["check", "--json"])), (2, vec![]));
}

#[test]
fn machines_with_different_clocks_use_that_of_the_database() {
    /// Longer than everything here takes, and than leases; a service of S3 refuses requests that are 15 minutes off.
    const OFF: i64 = 600;
    let (site, ahead, behind) = (Site::new(), Clock::new(), Clock::new());
    ahead.set(OFF);
    behind.set(-OFF);
    let server = Logged::start(&mut ahead.rules(site.command(&["serve", "--listen", "127.0.0.1:0"])));
    let address = server.address();
    // The database tells milliseconds.
    let began = Timestamp::now() - SignedDuration::from_millis(1);
    // Each point lasts for longer than a lease.
    let sweep = submit(&address, &request(12.0, 2, 1));
    let arguments = ["worker", "--lease-seconds", "5", "--pace", "2"];
    let workers = [&ahead, &behind].map(|clock| Logged::start(&mut clock.rules(site.command(&arguments))));
    for worker in &workers {
        worker.wait_for(last_claim);
    }
    let now = |value: &Value| {
        let time: Timestamp = value.as_str().unwrap_or_else(|| panic!("{value}")).parse().unwrap();
        assert!((began..=Timestamp::now()).contains(&time), "{time} is not the database's");
    };
    let listed = get(&format!("{address}/v1/workers"));
    let listed = listed["workers"].as_array().unwrap();
    assert_eq!(listed.len(), 2);
    listed.iter().for_each(|worker| now(&worker["seen"]));
    // Whoever collects garbage does not take what is being stored for old.
    let collected = behind.rules(site.command(&["gc", "--json"])).output().unwrap();
    let collected: Value = serde_json::from_slice(&collected.stdout).unwrap();
    assert_eq!((&collected["blobs"], &collected["artifacts"]), (&json!(0), &json!(0)));

    let ended = wait(&address, &sweep, completed);
    assert_eq!(ended["counts"]["succeeded"], 2, "{ended}");
    now(&ended["created"]);
    now(&ended["finished"]);
    for point in points(&address, &sweep) {
        assert_eq!(point["attempts"], 1, "its lease expired: {point}");
    }
    for process in workers.iter().chain([&server]) {
        assert!(!process.log().contains("lease expired"));
    }
    assert_eq!(checked(&mut site.command(&["check", "--json"])), (2, vec![]));
}

/// Nothing is too young to be deleted.
fn at_once() -> RetentionPolicy {
    RetentionPolicy { blob_grace: Duration::ZERO, ..RetentionConfig::default().policy }
}

/// Collects garbage over and over beside all else.
struct Collector {
    is_over: Arc<AtomicBool>,
    thread: std::thread::JoinHandle<u64>,
}

impl Collector {
    fn start(site: &Site) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let (config, over) = (site.store(0), is_over.clone());
        let thread = std::thread::spawn(move || {
            runtime().block_on(async {
                let store = Store::open(&config).await.unwrap();
                let mut collections = 0;
                while !over.load(Ordering::SeqCst) {
                    // Database and object store are away now and then.
                    collections += u64::from(store.collect_garbage(&at_once(), false).await.is_ok());
                    tokio::time::sleep(Duration::from_millis(50)).await;
                }
                collections
            })
        });
        Collector { is_over, thread }
    }

    fn end(self) {
        self.is_over.store(true, Ordering::SeqCst);
        assert!(self.thread.join().unwrap() > 0, "it was never done");
    }
}

/// Collects garbage once more when nobody has anything reserved any more, and what a collector that was cut off had noted has run out.
fn collect_all(site: &Site) {
    const LATER_MS: i64 = 2 * 3_600_000;
    runtime().block_on(async {
        let store = Store::open(&site.store(LATER_MS)).await.unwrap();
        store.collect_garbage(&at_once(), false).await.unwrap();
        store.close().await;
    });
}

fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap()
}

/// Long-polls the sweep until it has ended, though the server may be without its database now and then.
pub(crate) fn wait_through_faults(server: &str, sweep: &str) -> Value {
    let deadline = Instant::now() + PATIENCE;
    loop {
        let state = ureq::get(format!("{server}/v1/sweeps/{sweep}?wait=1s")).call();
        let state = state.and_then(|mut answer| answer.body_mut().read_json::<Value>());
        match state {
            Ok(state) if completed(&state) => return state,
            last => assert!(Instant::now() < deadline, "not reached: {last:?}"),
        }
    }
}
