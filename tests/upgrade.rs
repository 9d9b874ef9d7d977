//! Server and workers of different versions side by side, as while a fleet is brought up to date: `--physics-version` makes a worker of
//! another version of this program, and points of another one are made in the database, as an earlier server stored them.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use drillsweep_sim::PHYSICS_VERSION;
use rustix::process::Signal;
use serde_json::{Value, json};

use crate::faults::{Logged, checked, points, request, submit};
use crate::servers::postgres::Server as Postgres;
use crate::{BINARY, PATIENCE, completed, get, wait};

const EARLIER: u32 = PHYSICS_VERSION - 1;

/// A service on PostgreSQL, with its objects in a directory.
struct Service {
    postgres: Postgres,
    data: tempfile::TempDir,
}

impl Service {
    fn new() -> Self {
        Service { postgres: Postgres::start(), data: tempfile::tempdir().unwrap() }
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(BINARY);
        command.args(arguments).arg("--data").arg(self.data.path());
        command.env("DRILLSWEEP_DATABASE", self.postgres.url());
        command
    }

    fn worker(&self, version: u32, pace: &str) -> Logged {
        let version = version.to_string();
        let arguments = ["worker", "--physics-version", &version, "--lease-seconds", "5", "--pace", pace];
        Logged::start(&mut self.command(&arguments))
    }

    /// The worker that a point's result names.
    fn computed_by(&self, server: &str, sweep: &str, point: usize) -> String {
        let result = get(&format!("{server}/v1/sweeps/{sweep}/points/{point}"));
        result["provenance"]["worker"].as_str().unwrap_or_else(|| panic!("{result}")).to_owned()
    }
}

/// The identifier under which a worker has registered itself.
fn id(worker: &Logged) -> String {
    worker.wait_for(|log| {
        let line = log.lines().find(|line| line.contains("worker ready"))?;
        Some(line.split("worker=").nth(1)?.split_whitespace().next()?.to_owned())
    })
}

/// Version that a sweep waits for, and those that are there.
fn waiting_for(server: &str, sweep: &str) -> Value {
    let waiting = &get(&format!("{server}/v1/sweeps/{sweep}"))["waiting_for"];
    if waiting.is_null() {
        return Value::Null;
    }
    json!([waiting["physics_version"], waiting["worker_physics_versions"]])
}

fn reach<T>(mut look: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(Instant::now() < deadline, "not reached");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn workers_compute_points_of_their_version_and_a_sweep_names_the_missing_one() {
    let service = Service::new();
    let server = Logged::start(&mut service.command(&["serve", "--listen", "127.0.0.1:0"]));
    let address = server.address();

    // A sweep that the earlier server has stored.
    let before = submit(&address, &request(4.0, 1, 3));
    service.postgres.query(&format!("UPDATE work SET physics_version = {EARLIER}"));
    assert_eq!(waiting_for(&address, &before), json!([EARLIER, []]), "nobody is there");
    let mut earlier = service.worker(EARLIER, "0.5");
    let id_of_earlier = id(&earlier);

    // The server is of the new version, and no worker is yet.
    let after = submit(&address, &request(0.5, 2, 1));
    assert_eq!(waiting_for(&address, &after), json!([PHYSICS_VERSION, [EARLIER]]));
    assert_eq!(waiting_for(&address, &before), Value::Null);
    let mut watch = Command::new(BINARY);
    watch.args(["watch", &after, "--server", &address]).stdin(Stdio::null());
    let watching = Logged::start(&mut watch);
    let missing = format!(
        "queued points wait for a worker of physics version {PHYSICS_VERSION}: workers with a heartbeat in the last \
         100 s compute version {EARLIER}"
    );
    watching.wait_for(|log| log.contains(&missing).then_some(()));
    let shown = Command::new(BINARY).args(["show", &after, "--server", &address]).output().unwrap();
    assert!(String::from_utf8(shown.stdout).unwrap().contains(&missing));
    // It has begun what is its own; what is not stays where it is.
    reach(|| points(&address, &before).iter().any(|point| point["state"] == "running").then_some(()));
    assert!(points(&address, &after).iter().all(|point| point["attempts"] == 0));

    // A new worker beside it.
    let newer = service.worker(PHYSICS_VERSION, "1000");
    let ended = wait(&address, &after, completed);
    assert_eq!((&ended["counts"]["succeeded"], &ended["waiting_for"]), (&json!(2), &Value::Null));
    for point in 1..=2 {
        assert_eq!(service.computed_by(&address, &after, point), id(&newer));
    }

    // The earlier one is stopped in the middle of a point, which stays with its version.
    earlier.process.signal(Signal::TERM);
    assert!(earlier.process.0.wait().unwrap().success());
    let left = reach(|| {
        let sweep = get(&format!("{address}/v1/sweeps/{before}"));
        (sweep["counts"]["running"] == 0).then_some(sweep)
    });
    assert!(left["counts"]["queued"].as_u64() >= Some(1), "{left}");
    assert_eq!(waiting_for(&address, &before), json!([EARLIER, [PHYSICS_VERSION]]));

    // Another one of it goes on.
    let again = service.worker(EARLIER, "1000");
    let ended = wait(&address, &before, completed);
    assert_eq!((&ended["counts"]["succeeded"], &ended["waiting_for"]), (&json!(3), &Value::Null));
    let of_its_version = [id_of_earlier, id(&again)];
    for point in 1..=3 {
        let by = service.computed_by(&address, &before, point);
        assert!(of_its_version.contains(&by), "{by} computed point {point}");
    }
    assert_eq!(service.computed_by(&address, &before, 3), of_its_version[1]);
    for sweep in [&before, &after] {
        assert!(points(&address, sweep).iter().all(|point| point["attempts"] == 1));
    }
    assert_eq!(checked(&mut service.command(&["check", "--json"])), (5, vec![]));
}
