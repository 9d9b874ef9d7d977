//! Faults that a service meets in years of work, made to happen: kills, sleep, full disks, points that kill whoever
//! simulates them, starved processors, clocks that are set.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde_json::{Value, json};

use crate::servers::small_disk::SmallDisk;
use crate::{BINARY, PATIENCE, Process, completed, get, post, wait, worker};

const WORKER_KILLS: usize = 20;
const SERVER_KILLS: usize = 5;

/// A process whose log is kept.
pub(crate) struct Logged {
    pub(crate) process: Process,
    log: Arc<Mutex<String>>,
}

impl Logged {
    pub(crate) fn start(command: &mut Command) -> Self {
        let command = command.env("DRILLSWEEP_LOG", "info").env("NO_COLOR", "1");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap());
        let log = Arc::new(Mutex::new(String::new()));
        let kept = log.clone();
        std::thread::spawn(move || {
            for line in lines.lines().map_while(Result::ok) {
                let mut log = kept.lock().unwrap();
                log.push_str(&line);
                log.push('\n');
            }
        });
        Logged { process: Process(child), log }
    }

    /// Waits until the log gives something.
    pub(crate) fn wait_for<T>(&self, found: impl Fn(&str) -> Option<T>) -> T {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let log = self.log.lock().unwrap().clone();
            if let Some(found) = found(&log) {
                return found;
            }
            assert!(Instant::now() < deadline, "not logged in time:\n{log}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The address on which it listens.
    pub(crate) fn address(&self) -> String {
        self.wait_for(|log| Some(log[log.find("http://")?..].split_whitespace().next()?.to_owned()))
    }
}

impl Logged {
    /// Its log so far.
    pub(crate) fn log(&self) -> String {
        self.log.lock().unwrap().clone()
    }

    pub(crate) fn kill(&mut self) {
        self.process.signal(Signal::KILL);
        self.process.0.wait().unwrap();
    }
}

impl Drop for Logged {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{}", self.log.lock().unwrap());
        }
    }
}

pub(crate) fn command(data: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(BINARY);
    command.args(arguments).arg("--data").arg(data);
    command
}

/// A server on a port of its choice, or on the one that it had before.
pub(crate) fn serve(data: &Path, address: Option<&str>) -> (Logged, String) {
    let listen = address.map_or("127.0.0.1:0", |address| address.trim_start_matches("http://"));
    let server = Logged::start(&mut command(data, &["serve", "--listen", listen]));
    let address = server.address();
    (server, address)
}

/// A request for runs of the paper's string over `seconds`.
pub(crate) fn request(seconds: f64, flow_rates: usize, densities: usize) -> Value {
    let values = |from: f64, by: f64, count| (0..count).map(|i| from + by * i as f64).collect::<Vec<_>>();
    json!({
        "preset": "paper-200m",
        "set": {
            "duration": seconds,
            // Many short steps, so that a point lasts.
            "accuracy": {"integrator": "generalized_alpha", "step": 5e-4},
            "recording.spectrum_windows": [],
            "recording.orbit_window": null,
        },
        "axes": {
            "flow_rate": {"values": values(0.01, 0.01, flow_rates)},
            "mud_density": {"values": values(1200.0, 100.0, densities)},
        },
    })
}

pub(crate) fn submit(server: &str, request: &Value) -> String {
    post(&format!("{server}/v1/sweeps"), request)["id"].as_str().unwrap().to_owned()
}

pub(crate) fn points(server: &str, sweep: &str) -> Vec<Value> {
    get(&format!("{server}/v1/sweeps/{sweep}/points?limit=500"))["points"].as_array().unwrap().clone()
}

pub(crate) fn bytes(url: &str) -> Vec<u8> {
    ureq::get(url).call().unwrap().body_mut().read_to_vec().unwrap()
}

/// Report of `drillsweep check`: the number of results, and the problems.
fn check(data: &Path) -> (u64, Vec<Value>) {
    checked(&mut command(data, &["check", "--json"]))
}

pub(crate) fn checked(command: &mut Command) -> (u64, Vec<Value>) {
    let output = command.stderr(Stdio::inherit()).output().unwrap();
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    (report["results"].as_u64().unwrap(), report["problems"].as_array().unwrap().clone())
}

/// A worker whose points are known, so that it can be killed at one of them; they last, however fast the machine is: it
/// simulates `pace` seconds per second at most.
fn known_worker(data: &Path, pace: &str) -> Logged {
    Logged::start(&mut command(data, &["worker", "--lease-seconds", "2", "--pace", pace]))
}

/// The wall clock of processes, to be set while they run.
pub(crate) struct Clock {
    directory: tempfile::TempDir,
}

impl Clock {
    pub(crate) fn new() -> Self {
        let clock = Clock { directory: tempfile::tempdir().unwrap() };
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/clock_shift.c");
        let mut compiler = Command::new("cc");
        compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(clock.library()).arg(source);
        assert!(compiler.status().unwrap().success());
        clock.set(0);
        clock
    }

    fn library(&self) -> PathBuf {
        self.directory.path().join("clock_shift.so")
    }

    fn file(&self) -> PathBuf {
        self.directory.path().join("seconds")
    }

    /// Puts a process that is yet to be started under this clock.
    pub(crate) fn rules(&self, mut command: Command) -> Command {
        command.env("LD_PRELOAD", self.library()).env("CLOCK_SHIFT_FILE", self.file());
        command
    }

    /// Sets the shift from the machine's clock \[s\]; positive is ahead.
    pub(crate) fn set(&self, seconds: i64) {
        // In one step: nobody reads half a number.
        let written = self.directory.path().join("next");
        std::fs::write(&written, seconds.to_string()).unwrap();
        std::fs::rename(&written, self.file()).unwrap();
    }

    fn serve(&self, data: &Path) -> (Logged, String) {
        let server = Logged::start(&mut self.rules(command(data, &["serve", "--listen", "127.0.0.1:0"])));
        let address = server.address();
        (server, address)
    }

    fn worker(&self, data: &Path, lease_seconds: &str) -> Logged {
        let worker = ["worker", "--lease-seconds", lease_seconds, "--pace", "10"];
        Logged::start(&mut self.rules(command(data, &worker)))
    }
}

/// The fencing token of the point that it claimed last.
pub(crate) fn last_claim(log: &str) -> Option<u64> {
    let line = log.lines().rfind(|line| line.contains("point claimed"))?;
    line.split("fencing_token=").nth(1)?.split(|sign: char| !sign.is_ascii_digit()).next()?.parse().ok()
}

#[test]
fn the_log_names_callers_of_submissions_and_cancellations() {
    let data = tempfile::tempdir().unwrap();
    let (server, address) = serve(data.path(), None);
    let mut wanted = request(1.0, 1, 1);
    wanted["owner"] = json!("anne");
    let sweep = submit(&address, &wanted);
    post(&format!("{address}/v1/sweeps/{sweep}/cancel"), &json!({}));
    let line_with = |words: [String; 3]| {
        server.wait_for(|log| {
            let has_all = |line: &&str| words.iter().all(|word| line.contains(word.as_str()));
            log.lines().find(has_all).map(str::to_owned)
        })
    };
    line_with([
        "owner=\"anne\"".to_owned(),
        "peer=\"127.0.0.1:".to_owned(),
        format!("made=\"/v1/sweeps/{sweep}\""),
    ]);
    line_with(["changed".to_owned(), "peer=\"127.0.0.1:".to_owned(), format!("/v1/sweeps/{sweep}/cancel")]);
}

#[test]
fn storm_of_kills_loses_nothing_and_changes_no_number() {
    // Half a second a point at least: those who are spared between two kills do not finish most of it.
    const PACE: &str = "18";
    let request = request(9.0, 4, 4);
    let (calm, stormy) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let undisturbed =
        Logged::start(&mut command(calm.path(), &["up", "--workers", "2", "--listen", "127.0.0.1:0"]));
    let calm_server = undisturbed.address();
    let calm_sweep = submit(&calm_server, &request);
    wait(&calm_server, &calm_sweep, completed);

    let (mut server, address) = serve(stormy.path(), None);
    let sweep = submit(&address, &request);
    let mut workers = [known_worker(stormy.path(), PACE), known_worker(stormy.path(), PACE)];
    let mut repeated = Vec::new();
    for kill in 0..WORKER_KILLS {
        let doomed = &mut workers[kill % 2];
        // A point is given up after three dead workers: none is made to lose more than two.
        doomed.wait_for(|log| last_claim(log).filter(|token| *token <= 2));
        // At different stages of the work.
        std::thread::sleep(Duration::from_millis(37 * kill as u64 % 300));
        doomed.wait_for(|log| last_claim(log).filter(|token| *token <= 2));
        std::mem::replace(doomed, known_worker(stormy.path(), PACE)).kill();
        if (kill + 1) % (WORKER_KILLS / SERVER_KILLS) == 0 {
            // Killed while it takes a submission, which is then sent again under the same key.
            let key = format!("storm-{kill}");
            let url = format!("{address}/v1/sweeps");
            let send = {
                let (url, key, request) = (url.clone(), key.clone(), request.clone());
                move || ureq::post(&url).header("idempotency-key", &key).send_json(&request)
            };
            let sending = std::thread::spawn(send.clone());
            server.kill();
            let _lost_or_not = sending.join().unwrap();
            server = serve(stormy.path(), Some(&address)).0;
            let again: Value = send().unwrap().body_mut().read_json().unwrap();
            repeated.push(again["id"].as_str().unwrap().to_owned());
        }
    }
    let mut ended = wait(&address, &sweep, completed);
    if ended["counts"]["failed"] != 0 {
        // A worker that took up a point between the look and the kill may make it a third death.
        for point in points(&address, &sweep).iter().filter(|point| point["state"] == "failed") {
            assert_eq!(
                (&point["error"]["class"], &point["attempts"]),
                (&json!("crash"), &json!(3)),
                "{point}"
            );
        }
        post(&format!("{address}/v1/sweeps/{sweep}/retry"), &json!({}));
        ended = wait(&address, &sweep, completed);
    }
    assert_eq!(ended["counts"]["succeeded"], 16, "{ended}");
    let attempts: u64 =
        points(&address, &sweep).iter().map(|point| point["attempts"].as_u64().unwrap()).sum();
    assert!(attempts >= 16 + 10, "the kills did not hit: {attempts} attempts");

    let sweeps = get(&format!("{address}/v1/sweeps"))["sweeps"].as_array().unwrap().len();
    assert_eq!(sweeps, 1 + SERVER_KILLS, "one sweep a key");
    for id in &repeated {
        assert_eq!(wait(&address, id, completed)["counts"]["succeeded"], 16, "of the same work");
    }
    collect_orphans(stormy.path());
    let table = |server: &str, sweep: &str| bytes(&format!("{server}/v1/sweeps/{sweep}/table?format=csv"));
    assert_eq!(
        table(&address, &sweep),
        table(&calm_server, &calm_sweep),
        "the same numbers to the last digit"
    );
    for n in 1..=16 {
        for name in ["profile", "statics", "history", "lines", "contacts", "loads", "energy"] {
            let of = |server: &str, sweep: &str| {
                bytes(&format!("{server}/v1/sweeps/{sweep}/points/{n}/{name}?format=parquet"))
            };
            assert!(of(&address, &sweep) == of(&calm_server, &calm_sweep), "{name} of point {n} differs");
        }
    }
    assert_eq!(check(stormy.path()), (16, vec![]), "every point is done once");
}

/// Runs the garbage collector two hours later, and finds nothing left that no result names.
fn collect_orphans(data: &Path) {
    let blobs = data.join("blobs");
    // The next worker uploads the same blobs as the killed one, and names them: these two are not named.
    let orphan = blobs.join("00/00").join("0".repeat(64));
    std::fs::create_dir_all(orphan.parent().unwrap()).unwrap();
    std::fs::write(&orphan, b"orphan").unwrap();
    std::fs::write(blobs.join("00/00/0123#1"), b"half of an orphan").unwrap();

    let clock = Clock::new();
    clock.set(2 * HOUR);
    let collected = clock.rules(command(data, &["gc", "--json", "--grace-hours", "1"])).output().unwrap();
    let report: Value = serde_json::from_slice(&collected.stdout).unwrap();
    assert!(
        report["blobs"].as_u64() >= Some(1) && report["unfinished_uploads"].as_u64() >= Some(1),
        "{report}"
    );
    assert_eq!(
        (&report["results"], &report["artifacts"]),
        (&json!(0), &json!(0)),
        "nothing has reached its age"
    );
    // All that results name is there, and as many files as that.
    let mut check = command(data, &["check", "--json"]);
    let report: Value = serde_json::from_slice(&check.output().unwrap().stdout).unwrap();
    assert_eq!(report["problems"], json!([]));
    assert_eq!(Some(files(&blobs).len() as u64), report["blobs"].as_u64(), "{:?}", files(&blobs));
}

#[test]
fn worker_that_slept_past_its_lease_changes_nothing_when_it_wakes() {
    let data = tempfile::tempdir().unwrap();
    let (_server, address) = serve(data.path(), None);
    let sweep = submit(&address, &request(6.0, 1, 1));
    let sleeper = known_worker(data.path(), "1");
    sleeper.wait_for(last_claim);
    sleeper.process.signal(Signal::STOP);
    let _heir = worker(data.path());
    let ended = wait(&address, &sweep, completed);
    assert_eq!(ended["counts"]["succeeded"], 1, "{ended}");
    let result = get(&format!("{address}/v1/sweeps/{sweep}/points/1"));
    assert_eq!(result["attempts"], 2, "{result}");

    sleeper.process.signal(Signal::CONT);
    // Its heartbeat learns of it, or its write does, whichever comes first.
    sleeper
        .wait_for(|log| log.contains("LeaseLost").then_some(()).or(log.contains("lease lost").then_some(())));
    // It goes on with other work when it is the only one left.
    drop(_heir);
    let next = submit(&address, &request(0.5, 2, 1));
    assert_eq!(wait(&address, &next, completed)["counts"]["succeeded"], 2);
    assert_eq!(get(&format!("{address}/v1/sweeps/{sweep}/points/1")), result, "the first result stands");
    assert_eq!(check(data.path()), (3, vec![]));
}

const HOUR: i64 = 3_600;

#[test]
fn clock_that_jumps_to_and_fro_while_a_sweep_runs_loses_nothing() {
    let (data, clock) = (tempfile::tempdir().unwrap(), Clock::new());
    let (_server, address) = clock.serve(data.path());
    let sweep = submit(&address, &request(10.0, 3, 4));
    // Nothing happens to the sweep yet: a long poll lasts as long as it was asked to.
    let polling = {
        let url = format!("{address}/v1/sweeps/{sweep}?wait=2s");
        std::thread::spawn(move || {
            let start = Instant::now();
            (get(&url), start.elapsed())
        })
    };
    for hours in [1, -1].into_iter().cycle().take_while(|_| !polling.is_finished()) {
        clock.set(hours * HOUR);
        std::thread::sleep(Duration::from_millis(50));
    }
    let (polled, time) = polling.join().unwrap();
    assert_eq!(polled["counts"]["queued"], 12);
    assert!((Duration::from_secs(2)..Duration::from_secs(30)).contains(&time), "{time:?}");

    clock.set(0);
    let workers = [clock.worker(data.path(), "9"), clock.worker(data.path(), "9")];
    let claims = || {
        let claims = |worker: &Logged| worker.log.lock().unwrap().matches("point claimed").count();
        workers.iter().map(claims).sum::<usize>()
    };
    let jumps = [1, 0, -1, 0];
    for hours in jumps {
        // Somebody has begun a point since the last jump, and more are to come.
        let before = claims();
        workers[0].wait_for(|_| (claims() > before).then_some(()));
        assert_eq!(get(&format!("{address}/v1/sweeps/{sweep}"))["state"], "running");
        clock.set(hours * HOUR);
    }
    let ended = wait(&address, &sweep, completed);
    assert_eq!(ended["counts"]["succeeded"], 12, "{ended}");
    let attempts: u64 =
        points(&address, &sweep).iter().map(|point| point["attempts"].as_u64().unwrap()).sum();
    // Set forward, the clock ends the leases of both workers; set back, none.
    let forwards = [0, 1, 0, -1].iter().zip(jumps).filter(|(from, to)| *to > **from).count() as u64;
    assert!((12..=12 + 2 * forwards).contains(&attempts), "{attempts} attempts");

    // The register follows the clock, both ways.
    for hours in [1, 0] {
        clock.set(hours * HOUR);
        let now = jiff::Timestamp::now().as_second() + hours * HOUR;
        workers[0].wait_for(|_| {
            let listed = get(&format!("{address}/v1/workers"))["workers"].as_array().unwrap().clone();
            let seen = |worker: &Value| {
                worker["seen"].as_str().unwrap().parse::<jiff::Timestamp>().unwrap().as_second()
            };
            let is_current = |worker: &Value| (now..now + PATIENCE.as_secs() as i64).contains(&seen(worker));
            (listed.len() == 2 && listed.iter().all(is_current)).then_some(())
        });
    }
    assert_eq!(check(data.path()), (12, vec![]));
}

#[test]
fn point_of_a_dead_worker_does_not_wait_for_a_clock_set_back() {
    let (data, clock) = (tempfile::tempdir().unwrap(), Clock::new());
    let (_server, address) = clock.serve(data.path());
    let sweep = submit(&address, &request(6.0, 1, 1));
    let mut doomed = clock.worker(data.path(), "3");
    doomed.wait_for(last_claim);
    // Stopped, it cannot renew its lease by the new time.
    doomed.process.signal(Signal::STOP);
    clock.set(-HOUR);
    doomed.kill();
    let _heir = clock.worker(data.path(), "600");
    let ended = wait(&address, &sweep, completed);
    assert_eq!(ended["counts"]["succeeded"], 1, "{ended}");
    assert_eq!(get(&format!("{address}/v1/sweeps/{sweep}/points/1"))["attempts"], 2);
    let listed = get(&format!("{address}/v1/workers"))["workers"].as_array().unwrap().len();
    assert_eq!(listed, 1, "the dead one is not listed");
    assert_eq!(check(data.path()), (1, vec![]));
}

#[test]
fn token_goes_by_the_clock_and_opens_nothing_when_it_has_expired() {
    let (data, clock) = (tempfile::tempdir().unwrap(), Clock::new());
    let create = ["token", "create", "--owner", "anne", "--expires", "1h"];
    let token = String::from_utf8(command(data.path(), &create).output().unwrap().stdout).unwrap();
    let (_server, address) = clock.serve(data.path());
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    let status = |authorization: Option<&str>| {
        let request = agent.get(format!("{address}/v1/sweeps"));
        let request =
            authorization.into_iter().fold(request, |request, text| request.header("authorization", text));
        request.call().unwrap().status().as_u16()
    };
    let bearer = format!("Bearer {}", token.trim());
    for (seconds, expected) in [(0, 200), (HOUR, 401), (-HOUR, 200), (0, 200)] {
        clock.set(seconds);
        assert_eq!(status(Some(&bearer)), expected, "{seconds} s");
        assert_eq!(status(None), 401, "{seconds} s");
    }
}

#[test]
fn poison_point_is_given_up_and_the_fleet_survives() {
    let data = tempfile::tempdir().unwrap();
    // A worker may have 1.5 GB; a study keeps its runs in memory, and two million samples of ten nodes need 1.3 GB at once in
    // each of two: the allocation aborts.
    let limited = r#"ulimit -v 1500000; exec "$0" "$@""#;
    let up = ["up", "--workers", "2", "--listen", "127.0.0.1:0"];
    let mut command = Command::new("sh");
    command.args(["-c", limited, BINARY]).args(up).arg("--data").arg(data.path());
    let up = Logged::start(&mut command);
    let address = up.address();
    let mut deadly = request(2_000.0, 1, 1);
    deadly["set"]["recording.nodes"] = (2..12).map(|node| json!({"node": node})).collect();
    let rk4 = json!({"integrator": "rk4", "steps": [5e-5]});
    deadly["set"]["cost_study"] = json!({"presets": [], "methods": [rk4]});
    let poison = submit(&address, &deadly);
    let harmless = submit(&address, &request(0.5, 2, 2));

    let ended = wait(&address, &poison, completed);
    assert_eq!(ended["counts"]["failed"], 1, "{ended}");
    let point = &points(&address, &poison)[0];
    assert_eq!((&point["error"]["class"], &point["attempts"]), (&json!("crash"), &json!(3)), "{point}");
    assert!(up.log.lock().unwrap().contains("memory allocation"), "the workers died of something else");
    // SIGABRT.
    assert!(
        point["error"]["reason"]
            .as_str()
            .unwrap()
            .contains("the last one aborted (signal 6), as when a memory allocation fails"),
        "{point}"
    );
    assert_eq!(wait(&address, &harmless, completed)["counts"]["succeeded"], 4);
    let after = submit(&address, &request(0.5, 1, 3));
    assert_eq!(wait(&address, &after, completed)["counts"]["succeeded"], 3);
}

/// The niceness of a process' threads, by their names.
fn niceness_of_threads(process: u32) -> BTreeMap<String, i32> {
    let thread = |entry: std::io::Result<std::fs::DirEntry>| {
        let stat = std::fs::read_to_string(entry.unwrap().path().join("stat")).ok()?;
        // The name is in parentheses; the niceness is the nineteenth field.
        let (name, fields) = stat.split_once('(')?.1.rsplit_once(") ")?;
        Some((name.to_owned(), fields.split(' ').nth(16)?.parse().unwrap()))
    };
    std::fs::read_dir(format!("/proc/{process}/task")).unwrap().filter_map(thread).collect()
}

#[test]
fn leases_of_five_seconds_last_while_other_programs_take_all_cores() {
    /// A process that takes all the time it gets.
    fn burn() -> Process {
        Process(Command::new("sh").args(["-c", "while :; do :; done"]).spawn().unwrap())
    }
    let data = tempfile::tempdir().unwrap();
    let (_server, address) = serve(data.path(), None);
    // The third worker finds nothing to do and takes over whatever runs out.
    let arguments = ["worker", "--lease-seconds", "5", "--pace", "5"];
    let workers: Vec<_> = (0..3).map(|_| Logged::start(&mut command(data.path(), &arguments))).collect();
    for worker in &workers {
        worker.wait_for(|log| log.contains("worker ready").then_some(()));
    }
    let cores = std::thread::available_parallelism().unwrap().get();
    let _burners: Vec<_> = (0..cores).map(|_| burn()).collect();
    let sweep = submit(&address, &request(600.0, 2, 1));
    let mut seen = [Vec::new(), Vec::new()];
    let deadline = Instant::now() + PATIENCE;
    while seen.iter().any(|progress| progress.len() < 4) {
        for (point, seen) in points(&address, &sweep).iter().zip(&mut seen) {
            let progress = point["progress"].as_f64().unwrap();
            if seen.last() != Some(&progress) {
                seen.push(progress);
            }
            assert!(point["attempts"].as_u64().unwrap() <= 1, "its lease expired: {point}");
        }
        assert!(Instant::now() < deadline, "no heartbeats: {seen:?}");
        std::thread::sleep(Duration::from_millis(100));
    }
    let usual = rustix::process::getpriority_process(None).unwrap();
    let mut computing = 0;
    for worker in &workers {
        assert!(!worker.log.lock().unwrap().contains("lease expired"));
        let mut threads = niceness_of_threads(worker.process.0.id());
        if let Some(niceness) = threads.remove("compute") {
            assert_eq!(niceness, (usual + 10).min(19));
            computing += 1;
        }
        assert!(threads.contains_key("heartbeat"), "{threads:?}");
        assert!(
            threads.values().all(|niceness| *niceness == usual),
            "computing alone gives way: {threads:?}"
        );
    }
    assert_eq!(computing, 2);
}

#[test]
fn full_disk_is_reported_and_loses_nothing() {
    let disk = SmallDisk::new(48);
    // SQLite wants to see it under its own name.
    let inside = |arguments: &[&str]| {
        let mut command = disk.command_inside(BINARY);
        command.args(arguments).arg("--data").arg(disk.mount_point());
        command
    };
    let up = ["up", "--workers", "1", "--lease-seconds", "2", "--listen", "127.0.0.1:0"];
    let up = Logged::start(&mut inside(&up));
    let address = up.address();
    let first = submit(&address, &request(0.5, 2, 1));
    wait(&address, &first, completed);
    let before = bytes(&format!("{address}/v1/sweeps/{first}/table"));

    // No room at all: a submission is refused and leaves nothing behind, what is there can be read.
    disk.fill_but(0);
    let long = request(20.0, 1, 1);
    let refused = ureq::post(format!("{address}/v1/sweeps"))
        .config()
        .http_status_as_error(false)
        .build()
        .send_json(&long)
        .unwrap();
    let problem: Value = refused.into_body().read_json().unwrap();
    assert_eq!(problem["status"], 507, "{problem}");
    assert_eq!(problem["type"], "urn:drillsweep:problem:storage-full", "{problem}");
    assert_eq!(get(&format!("{address}/v1/sweeps"))["sweeps"].as_array().unwrap().len(), 1);
    assert_eq!(bytes(&format!("{address}/v1/sweeps/{first}/table")), before);

    // Room for the database, but not for a result: the point is tried again later, and says why.
    disk.fill_but(512 << 10);
    let sweep = submit(&address, &long);
    let deadline = Instant::now() + PATIENCE;
    let waiting = loop {
        let point = points(&address, &sweep).remove(0);
        if !point["error"].is_null() {
            break point;
        }
        assert!(Instant::now() < deadline, "{point}");
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!(waiting["error"]["class"], "infrastructure", "{waiting}");
    assert!(waiting["error"]["reason"].as_str().unwrap().contains("No space left"), "{waiting}");
    assert!(waiting["state"] == "queued" || waiting["state"] == "running", "{waiting}");

    disk.make_room();
    assert_eq!(wait(&address, &sweep, completed)["counts"]["succeeded"], 1);
    assert_eq!(bytes(&format!("{address}/v1/sweeps/{first}/table")), before);
    assert_eq!(checked(&mut inside(&["check", "--json"])), (3, vec![]));
    assert_eq!(half_written(&disk.path().join("blobs")), Vec::<PathBuf>::new());
}

#[test]
fn damaged_result_is_reported_and_computed_again() {
    let data = tempfile::tempdir().unwrap();
    let (_server, address) = serve(data.path(), None);
    let working = worker(data.path());
    let sweep = submit(&address, &request(0.2, 1, 1));
    wait(&address, &sweep, completed);
    working.kill();
    let whole: Vec<(PathBuf, Vec<u8>)> = files(&data.path().join("blobs"))
        .into_iter()
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect();
    for (path, content) in &whole {
        let mut content = content.clone();
        let middle = content.len() / 2;
        content[middle] ^= 1;
        std::fs::write(path, content).unwrap();
    }
    let fetched = data.path().join("fetched");
    let mut fetch = Command::new(BINARY);
    fetch.args(["fetch", &sweep, "--server", &address, "--output"]).arg(&fetched);
    assert!(!fetch.output().unwrap().status.success());
    let missing: Value =
        serde_json::from_slice(&std::fs::read(fetched.join("missing.json")).unwrap()).unwrap();
    assert!(missing[0]["reason"].as_str().unwrap().contains("table profile"), "{missing}");
    assert!(fetched.join("table.parquet").exists() && fetched.join("point-0001/point.json").exists());

    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    for query in ["profile", "history?format=parquet", "orbit?node=49", "spectrum?node=49"] {
        let mut answer = agent.get(format!("{address}/v1/sweeps/{sweep}/points/1/{query}")).call().unwrap();
        assert_eq!(answer.status(), 503, "{query}");
        assert_eq!(answer.headers()["retry-after"], "30");
        let problem: Value = answer.body_mut().read_json().unwrap();
        assert_eq!(problem["type"], "urn:drillsweep:problem:recomputing", "{problem}");
    }
    assert_eq!(get(&format!("{address}/v1/sweeps/{sweep}"))["counts"]["queued"], 1);
    assert_eq!(check(data.path()).1.len(), 7, "the tables of the point");

    let _worker = worker(data.path());
    wait(&address, &sweep, completed);
    for (path, content) in &whole {
        assert!(std::fs::read(path).unwrap() == *content, "{} is not as it was", path.display());
    }
    assert_eq!(check(data.path()), (1, vec![]));
    assert!(fetch.output().unwrap().status.success());
    assert!(!fetched.join("missing.json").exists());

    // Without a reader, a check finds and repairs it.
    std::fs::write(&whole[0].0, b"").unwrap();
    assert_eq!(checked(command(data.path(), &["check", "--json"]).arg("--repair")).1.len(), 1);
    wait(&address, &sweep, completed);
    assert_eq!(check(data.path()), (1, vec![]));
}

/// All files below a directory.
pub(crate) fn files(directory: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// Files that a write left behind before it was done.
fn half_written(directory: &Path) -> Vec<PathBuf> {
    // A blob is named by 64 hexadecimal digits.
    let is_whole =
        |path: &PathBuf| path.file_name().unwrap().len() == 64 && path.metadata().unwrap().len() > 0;
    files(directory).into_iter().filter(|path| !is_whole(path)).collect()
}
