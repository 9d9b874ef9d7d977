//! The whole system as real processes: sweeps end to end, workers and servers killed for real.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

mod commands;
mod diagnosis;
mod disk;
mod faults;
mod hostile;
mod migrate;
mod remote;
#[path = "../store/tests/servers/mod.rs"]
#[allow(dead_code, reason = "of the store's tests")]
mod servers;
mod tls;
mod up;
mod upgrade;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

/// Longest that any state may take to be reached on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(180);

/// The binary that cargo built for these tests.
const BINARY: &str = env!("CARGO_BIN_EXE_drillsweep");

/// A process that does not outlive its test.
struct Process(Child);

impl Process {
    fn signal(&self, signal: Signal) {
        kill_process(Pid::from_raw(self.0.id() as i32).unwrap(), signal).unwrap();
    }

    fn kill(mut self) {
        self.signal(Signal::KILL);
        self.0.wait().unwrap();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start(data: &Path, arguments: &[&str]) -> (Process, BufReader<std::process::ChildStderr>) {
    let mut child = Command::new(BINARY)
        .args(arguments)
        .arg("--data")
        .arg(data)
        .env("DRILLSWEEP_LOG", "info")
        .env("NO_COLOR", "1")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let log = BufReader::new(child.stderr.take().unwrap());
    (Process(child), log)
}

/// Starts a role that listens and returns its address; its log is read on, so that the pipe never fills.
fn listen(data: &Path, arguments: &[&str]) -> (Process, String) {
    let (process, mut log) = start(data, &[arguments, &["--listen", "127.0.0.1:0"]].concat());
    let mut line = String::new();
    let address = loop {
        line.clear();
        assert!(log.read_line(&mut line).unwrap() > 0, "the server ended before it listened");
        if let Some(at) = line.find("http://") {
            break line[at..].split_whitespace().next().unwrap().to_owned();
        }
    };
    drain(log);
    (process, address)
}

/// A worker whose lease outlasts the test, however loaded the machine is.
fn worker(data: &Path) -> Process {
    let (process, log) = start(data, &["worker", "--lease-seconds", "600"]);
    drain(log);
    process
}

/// A worker that simulates a second per second at most: its points last, however fast the machine is. It sends heartbeats every third
/// of its lease.
fn slow_worker(data: &Path, lease_seconds: &str) -> Process {
    let (process, log) = start(data, &["worker", "--lease-seconds", lease_seconds, "--pace", "1"]);
    drain(log);
    process
}

fn drain(mut log: BufReader<std::process::ChildStderr>) {
    std::thread::spawn(move || std::io::copy(&mut log, &mut std::io::sink()));
}

fn get(url: &str) -> Value {
    ureq::get(url).call().unwrap().body_mut().read_json().unwrap()
}

fn post(url: &str, body: &Value) -> Value {
    ureq::post(url).send_json(body).unwrap().body_mut().read_json().unwrap()
}

/// A sweep of the paper's string over `seconds` of simulated time.
fn submit(server: &str, seconds: f64, changes: &Value) -> String {
    let mut set = json!({
        "duration": seconds,
        "recording.spectrum_windows": [],
        "recording.orbit_window": null,
        // Many short steps, so that a point lasts.
        "accuracy": {"integrator": "generalized_alpha", "step": 5e-4},
    });
    set.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
    let request =
        json!({ "preset": "paper-200m", "set": set, "axes": { "flow_rate": { "values": [0.01, 0.02] } } });
    post(&format!("{server}/v1/sweeps"), &request)["id"].as_str().unwrap().to_owned()
}

/// Long-polls the sweep until `reached`, for as long as it goes on: other programs may have the cores.
fn wait(server: &str, sweep: &str, reached: impl Fn(&Value) -> bool) -> Value {
    let (mut last, mut deadline) = (Value::Null, Instant::now() + PATIENCE);
    loop {
        let state = get(&format!("{server}/v1/sweeps/{sweep}?wait=1s"));
        if reached(&state) {
            return state;
        }
        if (&state["counts"], &state["progress"]) != (&last["counts"], &last["progress"]) {
            deadline = Instant::now() + PATIENCE;
        }
        assert!(Instant::now() < deadline, "not reached: {state}");
        last = state;
    }
}

fn completed(sweep: &Value) -> bool {
    sweep["state"] != "running"
}

#[test]
fn a_token_opens_the_service_to_other_machines_and_shows_in_no_log() {
    let data = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        Command::new(BINARY).args(arguments).arg("--data").arg(data.path()).output().unwrap()
    };
    let open = ["serve", "--listen", "0.0.0.0:0"];
    let refused = run(&open);
    assert!(!refused.status.success());
    let reason = String::from_utf8(refused.stderr).unwrap();
    assert!(reason.contains("will not listen on 0.0.0.0") && reason.contains("token create"), "{reason}");

    let created = run(&["token", "create", "--owner", "anne", "--expires", "1h"]);
    let token = String::from_utf8(created.stdout).unwrap().trim().to_owned();
    assert!(token.starts_with("dsw_") && token.len() == 68, "{token}");
    let listed: Value = serde_json::from_slice(&run(&["token", "list", "--json"]).stdout).unwrap();
    assert_eq!(listed[0]["owner"], "anne");
    assert_eq!(listed[0]["state"], "valid");

    let log = data.path().join("log");
    let server = Command::new(BINARY)
        .args(open)
        .arg("--data")
        .arg(data.path())
        .env("DRILLSWEEP_LOG", "trace")
        .env("NO_COLOR", "1")
        .stderr(std::fs::File::create(&log).unwrap())
        .spawn()
        .unwrap();
    let server = Process(server);
    let deadline = Instant::now() + PATIENCE;
    let port = loop {
        let text = std::fs::read_to_string(&log).unwrap();
        if let Some((_, after)) = text.split_once("http://0.0.0.0:") {
            let digits: String = after.chars().take_while(char::is_ascii_digit).collect();
            // The line may be written in parts.
            if after.len() > digits.len() {
                break digits;
            }
        }
        assert!(Instant::now() < deadline, "{text}");
        std::thread::sleep(Duration::from_millis(20));
    };
    let url = format!("http://127.0.0.1:{port}/v1/sweeps");
    assert!(matches!(ureq::get(&url).call(), Err(ureq::Error::StatusCode(401))));
    let sweep: Value = ureq::post(&url)
        .header("authorization", format!("Bearer {token}"))
        .send_json(json!({ "preset": "paper-200m" }))
        .unwrap()
        .body_mut()
        .read_json()
        .unwrap();
    assert_eq!(sweep["owner"], "anne");
    drop(server);
    let text = std::fs::read_to_string(&log).unwrap();
    assert!(text.contains("/v1/sweeps"), "the log says what was asked for");
    assert!(!text.contains(&token) && !text.contains(&token[4..]), "and not with which token");
}

#[test]
fn outputs_decide_which_tables_are_kept_and_change_no_number() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "2"]);
    let run = |outputs: &Value| {
        let windows = json!([{"from": 0.1, "to": 0.3}, {"from": 0.25, "to": 0.5}]);
        let set = json!({"duration": 0.5, "accuracy": "draft", "recording.spectrum_windows": windows,
            "recording.orbit_window": {"from": 0.1, "to": 0.5}});
        let request = json!({"preset": "paper-200m", "set": set, "outputs": outputs});
        post(&format!("{server}/v1/runs"), &request)["id"].as_str().unwrap().to_owned()
    };
    let part =
        json!({"orbits": {"nodes": [{"node": 49}], "window": {"from": 0.2, "to": 0.4}, "decimation": 4}});
    // The parts before the whole, which would serve for them.
    let [orbits, spectra, summary, full] =
        [part, "spectra".into(), "summary".into(), "full".into()].map(|outputs| {
            let id = run(&outputs);
            assert_eq!(wait(&server, &id, completed)["counts"]["succeeded"], 1);
            format!("{server}/v1/sweeps/{id}/points/1")
        });
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    let problem = |url: &str| {
        let mut answer = agent.get(url).call().unwrap();
        assert!(answer.status().is_client_error(), "{url}");
        answer.body_mut().read_json::<Value>().unwrap()
    };

    let rows = [&orbits, &spectra, &summary, &full].map(|point| get(point)["summary"].clone());
    assert!(rows.iter().all(|row| *row == rows[3]), "the same row to the last bit");
    for table in ["profile", "statics", "lines", "contacts", "loads", "energy"] {
        let of = |point: &String| get(&format!("{point}/{table}"));
        assert!(of(&orbits) == of(&full) && of(&spectra) == of(&full), "{table}");
        assert_eq!(problem(&format!("{summary}/{table}"))["type"], "urn:drillsweep:problem:no-such-table");
    }

    let history = |query: &str| get(query)["columns"].clone();
    let (kept, whole) =
        (history(&format!("{orbits}/history")), history(&format!("{full}/history?node=49&from=0.2&to=0.4")));
    assert_eq!(kept["time"].as_array().unwrap().len(), 50, "every fourth of 200 samples");
    for (name, values) in kept.as_object().unwrap() {
        let every_fourth: Vec<&Value> = whole[name].as_array().unwrap().iter().step_by(4).collect();
        assert_eq!(values.as_array().unwrap().iter().collect::<Vec<_>>(), every_fourth, "{name}");
    }
    assert_eq!(kept.as_object().unwrap().len(), whole.as_object().unwrap().len());

    for weighting in ["rectangular", "hann"] {
        let query = format!("spectrum?node=49&from=0.25&to=0.5&range_hz=200&window={weighting}");
        let (kept, cut) = (get(&format!("{spectra}/{query}")), get(&format!("{full}/{query}")));
        assert_eq!(kept["columns"]["frequency"].as_array().unwrap().len(), 101, "every 4 Hz to 200 Hz");
        for (name, largest_error) in [("frequency", 1e-9), ("amplitude", 3e-7), ("peak_to_peak", 3e-7)] {
            let of = |table: &Value| -> Vec<f64> {
                table["columns"][name]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|value| value.as_f64().unwrap())
                    .collect()
            };
            let (kept, cut) = (of(&kept), of(&cut));
            // Either is rounded to single precision, the one before the transform, the other after it.
            let scale = cut.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            for (kept, cut) in kept.iter().zip(&cut) {
                assert!((kept - cut).abs() <= largest_error * scale, "{weighting} {name}: {kept} {cut}");
            }
        }
        let (kept, cut) = (&kept["attributes"], &cut["attributes"]);
        assert_eq!(kept["window"], weighting);
        for name in ["node", "measured_depth", "samples"] {
            assert!(!kept[name].is_null() && kept[name] == cut[name], "{name}: {kept} {cut}");
        }
    }
    let no_window = problem(&format!("{spectra}/spectrum?node=49"));
    assert_eq!(no_window["type"], "urn:drillsweep:problem:window-not-kept", "{no_window}");
    assert!(no_window["detail"].as_str().unwrap().contains("0.1 to 0.3 s, 0.25 to 0.5 s"), "{no_window}");
    assert_eq!(problem(&format!("{spectra}/orbit?node=49"))["type"], "urn:drillsweep:problem:no-such-table");
    assert_eq!(
        problem(&format!("{orbits}/orbit?node=10"))["type"],
        "urn:drillsweep:problem:node-not-recorded"
    );

    // The whole result serves for any part of it.
    let another = run(&json!({"orbits": {"decimation": 2}}));
    let at_once = get(&format!("{server}/v1/sweeps/{another}"));
    assert_eq!(at_once["counts"]["succeeded"], 1, "{at_once}");
}

#[test]
fn sweep_over_rest_gives_the_numbers_of_a_run_without_a_server() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "2"]);
    let id = submit(&server, 0.5, &json!({"accuracy": "draft"}));
    let sweep = wait(&server, &id, completed);
    assert_eq!(sweep["counts"]["succeeded"], 2, "{sweep}");

    let alone = Command::new(BINARY)
        .args(["simulate", "paper-200m", "--json", "--accuracy", "draft", "--set", "duration=0.5"])
        .args(["--set", "recording.spectrum_windows=[]", "--set", "recording.orbit_window=null"])
        .args(["--set", "mud.flow_rate=0.02"])
        .output()
        .unwrap();
    assert!(alone.status.success());
    let alone: Value = serde_json::from_slice(&alone.stdout).unwrap();
    let point = get(&format!("{server}/v1/sweeps/{id}/points/2"));
    for (name, value) in point["summary"].as_object().unwrap() {
        assert_eq!(value, &alone[name], "{name}: the same bits wherever a point runs");
    }

    let workers = get(&format!("{server}/v1/workers"));
    let of_host = |worker: &&Value| worker["id"] == point["provenance"]["worker"];
    let worker =
        workers["workers"].as_array().unwrap().iter().find(of_host).expect("a worker that is listed");
    assert_eq!(point["provenance"]["host"], worker["host"]);
    for time in ["started", "ended"] {
        let text = point["provenance"][time].as_str().unwrap();
        assert!(text.starts_with("20") && text.ends_with('Z'), "UTC: {text}");
    }

    // The density of the annulus' mud can be read off the pressures of the profile: hydrostatics dominate.
    let profile = get(&format!("{server}/v1/sweeps/{id}/points/1/profile"));
    assert_eq!(profile["columns"]["friction_coefficient"].as_array().unwrap().len(), 296);
    let orbit = get(&format!("{server}/v1/sweeps/{id}/points/1/orbit?node=49&from=0.1&to=0.3"));
    assert_eq!(orbit["columns"]["u"].as_array().unwrap().len(), 200, "half-open window at 1 kHz");
    let spectrum = get(&format!("{server}/v1/sweeps/{id}/points/1/spectrum?node=49&from=0&to=0.5"));
    assert!(spectrum["columns"]["frequency"].as_array().unwrap().len() > 2);
}

#[test]
fn killed_workers_points_are_taken_over_when_their_leases_end() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    let id = submit(&server, 4.0, &json!({}));
    let doomed = slow_worker(data.path(), "2");
    wait(&server, &id, |sweep| sweep["counts"]["running"] == 1 && sweep["progress"].as_f64().unwrap() > 0.0);
    doomed.kill();
    let attempts = || {
        let attempts_of =
            |n| get(&format!("{server}/v1/sweeps/{id}/points/{n}"))["attempts"].as_u64().unwrap();
        attempts_of(1) + attempts_of(2)
    };
    let of_doomed = attempts();
    let _heir = worker(data.path());
    let sweep = wait(&server, &id, completed);
    assert_eq!(sweep["counts"]["succeeded"], 2, "{sweep}");
    assert_eq!(attempts(), of_doomed + 2, "each point is started once more");
}

#[test]
fn points_of_a_killed_child_are_taken_over_without_waiting_for_its_lease() {
    let data = tempfile::tempdir().unwrap();
    // No lease of an hour ends while the test has patience.
    let (_server, server) = listen(data.path(), &["serve"]);
    let slow = ["up", "--workers", "1", "--lease-seconds", "3600", "--listen", "127.0.0.1:0"];
    let mut up = Command::new(BINARY);
    up.args(slow).arg("--data").arg(data.path()).env("DRILLSWEEP_PACE", "1").stderr(Stdio::null());
    let _up = Process(up.spawn().unwrap());
    let id = submit(&server, 20.0, &json!({}));
    wait(&server, &id, |sweep| sweep["counts"]["running"] == 1);
    let workers = get(&format!("{server}/v1/workers"));
    let process = workers["workers"][0]["process"].as_i64().unwrap() as i32;
    kill_process(Pid::from_raw(process).unwrap(), Signal::KILL).unwrap();
    let again = |sweep: &Value| {
        sweep["counts"]["running"] == 1
            && get(&format!("{server}/v1/sweeps/{id}/points/1"))["attempts"].as_u64().unwrap() == 2
    };
    wait(&server, &id, again);
    post(&format!("{server}/v1/sweeps/{id}/cancel"), &json!({}));
}

#[test]
fn killed_server_loses_nothing() {
    let data = tempfile::tempdir().unwrap();
    let (first, address) = listen(data.path(), &["serve"]);
    let id = submit(&address, 0.2, &json!({}));
    first.kill();
    let (_second, server) = listen(data.path(), &["serve"]);
    let sweep = get(&format!("{server}/v1/sweeps/{id}"));
    assert_eq!(sweep["counts"]["queued"], 2, "{sweep}");
    let _worker = worker(data.path());
    let sweep = wait(&server, &id, completed);
    assert_eq!(sweep["counts"]["succeeded"], 2, "{sweep}");
}

#[test]
fn stopped_worker_gives_its_point_back_untried() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    let id = submit(&server, 60.0, &json!({}));
    let mut stopping = slow_worker(data.path(), "600");
    wait(&server, &id, |sweep| sweep["counts"]["running"] == 1);
    stopping.signal(Signal::TERM);
    assert!(stopping.0.wait().unwrap().success(), "a stopped worker ends in order");
    let sweep = get(&format!("{server}/v1/sweeps/{id}"));
    assert_eq!(sweep["counts"]["queued"], 2, "{sweep}");
    for n in 1..=2 {
        assert_eq!(get(&format!("{server}/v1/sweeps/{id}/points/{n}"))["attempts"], 0);
    }
}

#[test]
fn suspended_point_goes_on_elsewhere_to_the_same_bits() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    let run = |server: &str| -> String {
        let set =
            json!({ "duration": 6.0, "recording.spectrum_windows": [], "recording.orbit_window": null });
        let run = post(&format!("{server}/v1/runs"), &json!({ "preset": "paper-200m", "set": set }));
        run["id"].as_str().unwrap().to_owned()
    };
    let id = run(&server);
    let mut first = slow_worker(data.path(), "9");
    wait(&server, &id, |sweep| sweep["progress"].as_f64().unwrap() > 0.0);
    first.signal(Signal::TERM);
    assert!(first.0.wait().unwrap().success(), "a stopped worker ends in order");
    let point = format!("{server}/v1/sweeps/{id}/points/1");
    assert_eq!(get(&point)["attempts"], 0, "the attempt is given back");
    let (mut second, log) = start(data.path(), &["worker", "--drain"]);
    drain(log);
    wait(&server, &id, completed);
    assert!(second.0.wait().unwrap().success(), "a worker that drains ends by itself");
    let resumed = get(&point);
    assert_eq!(resumed["provenance"]["resumed"], true, "{resumed}");

    let other = tempfile::tempdir().unwrap();
    let (_up, alone) = listen(other.path(), &["up", "--workers", "1"]);
    let uninterrupted = run(&alone);
    wait(&alone, &uninterrupted, completed);
    let whole = get(&format!("{alone}/v1/sweeps/{uninterrupted}/points/1"));
    assert_eq!(whole["provenance"]["resumed"], false);
    assert_eq!(whole["summary"], resumed["summary"]);
    // The names of blobs are the hashes of their bytes.
    let blobs = |data: &Path| -> std::collections::BTreeMap<String, u64> {
        let mut found = std::collections::BTreeMap::new();
        let mut folders = vec![data.join("blobs")];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let entry = entry.unwrap();
                match entry.file_type().unwrap().is_dir() {
                    true => folders.push(entry.path()),
                    false => {
                        let size = entry.metadata().unwrap().len();
                        found.insert(entry.file_name().into_string().unwrap(), size);
                    }
                }
            }
        }
        found
    };
    let (whole, resumed) = (blobs(other.path()), blobs(data.path()));
    assert!(whole.len() >= 4, "{whole:?}");
    assert!(whole.iter().all(|(name, size)| resumed.get(name) == Some(size)), "{whole:?} {resumed:?}");
}

#[test]
fn worker_ends_when_its_time_is_over_and_gives_its_point_back() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    let id = submit(&server, 60.0, &json!({}));
    let (mut worker, log) = start(data.path(), &["worker", "--max-runtime", "2s", "--pace", "1"]);
    drain(log);
    assert!(worker.0.wait().unwrap().success());
    let sweep = get(&format!("{server}/v1/sweeps/{id}"));
    assert_eq!(sweep["counts"]["queued"], 2, "{sweep}");
    assert_eq!(get(&format!("{server}/v1/sweeps/{id}/points/1"))["attempts"], 0);
}

#[test]
fn point_that_takes_too_long_fails_and_its_retry_goes_on_from_there() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    let set = json!({ "duration": 60.0, "recording.spectrum_windows": [], "recording.orbit_window": null, "accuracy": "draft" });
    let run = post(&format!("{server}/v1/runs"), &json!({ "preset": "paper-200m", "set": set }));
    let id = run["id"].as_str().unwrap().to_owned();
    let (mut worker, log) =
        start(data.path(), &["worker", "--point-timeout", "2s", "--pace", "1", "--drain"]);
    drain(log);
    assert!(worker.0.wait().unwrap().success());
    let point = get(&format!("{server}/v1/sweeps/{id}/points/1"));
    assert_eq!(point["error"]["class"], "timeout", "{point}");
    assert!(point["error"]["reason"].as_str().unwrap().contains("2 s"), "{point}");
    assert_eq!(post(&format!("{server}/v1/sweeps/{id}/retry"), &json!({}))["counts"]["queued"], 1);
}

#[test]
fn cancelled_sweep_stops_its_running_point() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    let id = submit(&server, 60.0, &json!({}));
    let _worker = slow_worker(data.path(), "2");
    wait(&server, &id, |sweep| sweep["counts"]["running"] == 1);
    post(&format!("{server}/v1/sweeps/{id}/cancel"), &json!({}));
    let sweep = wait(&server, &id, |sweep| sweep["counts"]["cancelled"] == 2);
    assert_eq!(sweep["state"], "cancelled", "{sweep}");
}

#[test]
fn point_without_an_equilibrium_ends_as_failed_with_node_and_reason() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = listen(data.path(), &["serve"]);
    // Without its wall the string is buckled by the weight on bit.
    let id = submit(&server, 60.0, &json!({ "effects.contact": "off" }));
    let _worker = worker(data.path());
    let sweep = wait(&server, &id, completed);
    assert_eq!(sweep["counts"]["failed"], 2, "{sweep}");
    let error = get(&format!("{server}/v1/sweeps/{id}/points/1"))["error"].clone();
    assert_eq!(error["class"], "physical", "{error}");
    assert!(error["node"].as_u64().is_some_and(|node| (1..=297).contains(&node)), "{error}");
    assert!(error["reason"].as_str().unwrap().contains("no equilibrium"), "{error}");
}

#[test]
fn cost_study_over_rest_is_served_as_numbers_lines_and_charts() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "1"]);
    let study = json!({
        "duration": 0.1,
        "presets": [],
        "methods": [
            {"integrator": "generalized_alpha", "steps": [1e-3, 5e-4]},
            {"integrator": "rk4", "steps": [2.5e-5, 1e-4]},
        ],
    });
    let request = json!({ "preset": "paper-200m", "set": { "cost_study": study } });
    let run = post(&format!("{server}/v1/runs"), &request);
    let id = run["id"].as_str().unwrap().to_owned();
    let sweep = wait(&server, &id, completed);
    assert_eq!(sweep["counts"]["succeeded"], 1, "{sweep}");
    let path = format!("{server}/v1/sweeps/{id}/points/1");

    let report = get(&format!("{path}/cost"));
    let methods = report["methods"].as_array().unwrap();
    let of = |integrator: &str| -> Vec<&Value> {
        methods.iter().filter(|row| row["integrator"] == integrator).collect()
    };
    let error = |row: &Value| row["errors"]["trajectory"].as_f64().unwrap();
    // Finer steps are nearer and dearer; the explicit method beyond its limit is said to be so, and spoils nothing.
    let alpha = of("generalized_alpha");
    assert!(error(alpha[1]) < error(alpha[0]) && error(alpha[0]) < 0.1, "{report}");
    assert!(alpha[1]["steps"].as_u64() > alpha[0]["steps"].as_u64());
    assert!(error(of("rk4")[0]) < error(alpha[1]), "{report}");
    assert!(of("rk4")[1]["failure"].as_str().unwrap().contains("stability limit"), "{report}");
    // Its reference is two methods, and over so short a time they agree.
    let references: Vec<_> =
        report["references"].as_array().unwrap().iter().map(|row| &row["integrator"]).collect();
    assert_eq!(references, ["rk4", "esdirk4"]);
    let agreement = &report["agreements"][0];
    assert_eq!((&agreement["quantity"], &agreement["has_reference"]), (&json!("orbit_size"), &json!(true)));
    assert!(get(&path)["summary"]["cost_cpu_time_orbit_size_2_percent"].as_f64().unwrap() > 0.0);

    let text = |query: &str| {
        ureq::get(format!("{path}/cost?{query}")).call().unwrap().body_mut().read_to_vec().unwrap()
    };
    assert_eq!(String::from_utf8(text("format=csv")).unwrap().lines().count(), 1 + 2 + 4);
    let svg = String::from_utf8(text("format=svg&measure=trajectory")).unwrap();
    assert!(svg.contains("<svg") && svg.contains("generalized-alpha"));
    assert_eq!(&text("format=png")[..8], b"\x89PNG\r\n\x1a\n");
    // A plain run has no study, and says so.
    let plain = submit(&server, 0.05, &json!({}));
    wait(&server, &plain, completed);
    let missing = ureq::get(format!("{server}/v1/sweeps/{plain}/points/1/cost")).call();
    assert!(matches!(missing, Err(ureq::Error::StatusCode(404))), "{missing:?}");
}
