//! Several servers and workers on one PostgreSQL database and one bucket, all of which fail in their turn.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use drillsweep_store::ObjectsLocation;
use rustix::process::Signal;
use serde_json::{Value, json};

use crate::faults::{Logged, bytes, checked, command, last_claim, points, request, serve, submit};
use crate::servers::postgres::Server as Postgres;
use crate::servers::seaweed::Seaweed;
use crate::{BINARY, PATIENCE, completed, wait};

/// Half a second a point at least: those who are spared between two faults do not finish most of it.
const PACE: &str = "18";

/// What all processes have in common, wherever they run.
pub(crate) struct Site {
    pub(crate) postgres: Postgres,
    pub(crate) objects: Seaweed,
    scratch: tempfile::TempDir,
}

impl Site {
    pub(crate) fn new() -> Self {
        Site { postgres: Postgres::start(), objects: Seaweed::start(), scratch: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let location = self.objects.location(&self.objects.address(), "team");
        let ObjectsLocation::S3 { settings, .. } = &location else { panic!("a bucket") };
        let mut command = Command::new(BINARY);
        command.args(arguments).arg("--data").arg(self.scratch.path());
        command
            .env("DRILLSWEEP_DATABASE", self.postgres.url())
            .env("DRILLSWEEP_OBJECTS", location.to_string());
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
        let server = Logged::start(&mut self.command(&["serve", "--listen", "127.0.0.1:0"]));
        let address = server.address();
        (server, address)
    }

    pub(crate) fn worker(&self) -> Logged {
        Logged::start(&mut self.command(&["worker", "--lease-seconds", "2", "--pace", PACE]))
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
            let deadline = Instant::now() + PATIENCE;
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

#[test]
fn everything_fails_in_its_turn_and_the_numbers_are_those_of_an_undisturbed_machine() {
    let request = request(9.0, 3, 4);
    let calm = tempfile::tempdir().unwrap();
    let mut undisturbed =
        Logged::start(&mut command(calm.path(), &["up", "--workers", "2", "--listen", "127.0.0.1:0"]));
    let calm_server = undisturbed.address();
    let calm_sweep = submit(&calm_server, &request);
    wait(&calm_server, &calm_sweep, completed);
    undisturbed.kill();

    let mut site = Site::new();
    let ((mut first, first_address), (_second, address)) = (site.serve(), site.serve());
    let sweep = submit(&first_address, &request);
    let follower = Follower::start(vec![first_address, address.clone()], &sweep);
    let mut workers = [site.worker(), site.worker()];
    let under_way = |worker: &Logged| worker.wait_for(|log| last_claim(log).filter(|token| *token <= 2));
    for fault in 0..5 {
        // A worker dies at each, in the middle of a point. A point is given up after three dead workers: none is made to lose
        // more than two.
        under_way(&workers[fault % 2]);
        std::mem::replace(&mut workers[fault % 2], site.worker()).kill();
        under_way(&workers[(fault + 1) % 2]);
        match fault {
            0 => site.cut_connections(),
            1 => {
                site.postgres.kill();
                site.postgres.resume();
            }
            2 => first.kill(),
            3 => {
                site.objects.kill();
                site.objects.restart();
            }
            _ => {
                // Cut off for longer than its lease: it wakes up when another one may have its point.
                let sleeper = &workers[(fault + 1) % 2];
                sleeper.process.signal(Signal::STOP);
                std::thread::sleep(Duration::from_secs(5));
                sleeper.process.signal(Signal::CONT);
            }
        }
    }
    let mut ended = wait_through_faults(&address, &sweep);
    if ended["counts"]["failed"] != 0 {
        // A worker that took up a point between the look and the kill may make it a third death.
        for point in points(&address, &sweep).iter().filter(|point| point["state"] == "failed") {
            assert_eq!(point["error"]["class"], "crash", "{point}");
        }
        crate::post(&format!("{address}/v1/sweeps/{sweep}/retry"), &json!({}));
        ended = wait_through_faults(&address, &sweep);
    }
    assert_eq!(ended["counts"]["succeeded"], 12, "{ended}");
    let attempts: u64 =
        points(&address, &sweep).iter().map(|point| point["attempts"].as_u64().unwrap()).sum();
    assert!(attempts > 12, "the faults did not hit: {attempts} attempts");
    let states = follower.states();
    let ends = states.iter().filter(|state| *state == "succeeded").count();
    assert_eq!(ends, 12, "each end is told once, whichever server tells it: {states:?}");

    let (calm_again, calm_server) = serve(calm.path(), None);
    let table = |server: &str, sweep: &str| bytes(&format!("{server}/v1/sweeps/{sweep}/table?format=csv"));
    assert!(table(&address, &sweep) == table(&calm_server, &calm_sweep), "the numbers differ");
    for n in 1..=12 {
        for name in ["profile", "history"] {
            let of = |server: &str, sweep: &str| {
                bytes(&format!("{server}/v1/sweeps/{sweep}/points/{n}/{name}?format=parquet"))
            };
            assert!(of(&address, &sweep) == of(&calm_server, &calm_sweep), "{name} of point {n} differs");
        }
    }
    drop(calm_again);
    assert_eq!(checked(&mut site.command(&["check", "--json"])), (12, vec![]), "every point is done once");
    let report = site.command(&["check", "--json"]).output().unwrap();
    let report: Value = serde_json::from_slice(&report.stdout).unwrap();
    let stored = site.objects.files("team").iter().filter(|file| !file.name.contains("probe")).count() as u64;
    assert_eq!(Some(stored), report["blobs"].as_u64(), "what is stored is what results name");
}

/// Long-polls the sweep until it has ended, though the server may be without its database now and then.
fn wait_through_faults(server: &str, sweep: &str) -> Value {
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
