//! The commands of the binary, run as people and scripts run them.

use std::io::{BufRead as _, BufReader, Write};
use std::process::{Command, Output, Stdio};

use rustix::process::Signal;
use serde_json::{Value, json};

use crate::{BINARY, Process, listen};

fn run(server: &str, arguments: &[&str]) -> Output {
    Command::new(BINARY)
        .args(arguments)
        .env("DRILLSWEEP_SERVER", server)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

/// Standard output of a command that must succeed.
fn text(server: &str, arguments: &[&str]) -> String {
    let output = run(server, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(server: &str, arguments: &[&str]) -> Value {
    serde_json::from_str(&text(server, arguments)).unwrap()
}

const SHORT: [&str; 8] = [
    "--accuracy",
    "draft",
    "--set",
    "duration=0.2",
    "--set",
    "recording.spectrum_windows=[]",
    "--set",
    "recording.orbit_window=null",
];

#[test]
fn log_is_json_on_request_and_unknown_settings_are_refused() {
    let data = tempfile::tempdir().unwrap();
    let mut server = Command::new(BINARY);
    server.args(["serve", "--listen", "127.0.0.1:0", "--data"]).arg(data.path());
    server.env("DRILLSWEEP_LOG_FORMAT", "json").stderr(Stdio::piped());
    let mut child = server.spawn().unwrap();
    let log = BufReader::new(child.stderr.take().unwrap());
    let _server = Process(child);
    let objects = log.lines().map(|line| serde_json::from_str::<Value>(&line.unwrap()).unwrap());
    let listening =
        objects.into_iter().find(|line| line["message"].as_str().unwrap().starts_with("listening"));
    let listening = listening.expect("it listens");
    assert_eq!(
        (&listening["level"], &listening["target"]),
        (&json!("INFO"), &json!("drillsweep_server::serve"))
    );

    for (name, value) in [("DRILLSWEEP_LOG", "bogus=["), ("DRILLSWEEP_LOG_FORMAT", "xml")] {
        let refused = Command::new(BINARY).arg("scenario").env(name, value).output().unwrap();
        let text = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!refused.status.success() && text.contains(name) && text.contains(value), "{text}");
    }
}

#[test]
fn sweep_is_submitted_watched_listed_shown_and_fetched() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "1"]);
    let submit =
        [&["submit", "paper-200m", "--flow-rate", "0.01:0.03:3", "--name", "three"][..], &SHORT].concat();
    let sweep = json(&server, &[&submit[..], &["--json"]].concat());
    assert_eq!(sweep["counts"]["succeeded"], 3, "{sweep}");
    assert_eq!(sweep["request"]["set"]["accuracy"], "draft");
    let id = sweep["id"].as_str().unwrap();
    assert_eq!(json(&server, &["watch", id, "--json"])["state"], "completed");
    assert_eq!(json(&server, &["list", "--json"])["sweeps"][0]["id"], id);
    assert!(text(&server, &["list"]).lines().nth(1).unwrap().contains("three"));

    let shown = text(&server, &["show", id]);
    assert_eq!(shown.lines().count(), 1 + 1 + 3, "{shown}");
    assert!(shown.lines().last().unwrap().contains("0.03"), "{shown}");
    assert_eq!(json(&server, &["show", id, "--json"])["points"].as_array().unwrap().len(), 3);
    let point = text(&server, &["show", id, "2"]);
    assert!(
        point.contains("flow_rate") && point.contains("m3/s") && point.contains("contact_count"),
        "{point}"
    );

    let output = data.path().join("results");
    let fetch = ["fetch", id, "--output", output.to_str().unwrap(), "--json"];
    let files = json(&server, &fetch);
    let listed = files.as_array().unwrap();
    assert!(listed.iter().all(|file| std::path::Path::new(file.as_str().unwrap()).exists()));
    assert_eq!(listed.len(), 2 + 3 * 8, "the sweep, its table, and a folder a point: {files}");
    // Fetched files stay as they are; missing and empty ones are fetched.
    let (kept, lost) = (output.join("point-0001/profile.parquet"), output.join("point-0001/statics.parquet"));
    let whole = std::fs::read(&lost).unwrap();
    std::fs::write(&kept, "kept").unwrap();
    std::fs::remove_file(&lost).unwrap();
    assert_eq!(json(&server, &fetch), files);
    assert_eq!(std::fs::read(&kept).unwrap(), b"kept");
    assert_eq!(std::fs::read(&lost).unwrap(), whole);
    std::fs::write(&lost, "").unwrap();
    assert_eq!(json(&server, &fetch), files);
    assert_eq!(std::fs::read(&lost).unwrap(), whole);
    // Another sweep's points are not mixed with them.
    let other = [&["submit", "paper-200m", "--flow-rate", "0.01", "--name", "other", "--detach"][..], &SHORT]
        .concat();
    let mixed = run(&server, &["fetch", text(&server, &other).trim(), "--output", output.to_str().unwrap()]);
    assert!(!mixed.status.success());
    assert!(String::from_utf8_lossy(&mixed.stderr).contains(id), "it says whose results are there");

    // The same key is the same sweep; no such sweep is an error.
    let keyed = [&submit[..], &["--idempotency-key", "k", "--detach"]].concat();
    assert_eq!(text(&server, &keyed), text(&server, &keyed));
    assert!(!run(&server, &["show", "../../queue"]).status.success());
}

#[test]
fn sweep_is_cancelled_and_retried_and_its_fate_is_the_exit_status() {
    let data = tempfile::tempdir().unwrap();
    let (_serve, server) = listen(data.path(), &["serve"]);
    let submit = [&["submit", "paper-200m", "--flow-rate", "0.01,0.02", "--detach"][..], &SHORT].concat();
    let id = text(&server, &submit);
    let id = id.trim();
    let output = data.path().join("results");
    let fetch = ["fetch", id, "--output", output.to_str().unwrap()];
    let early = run(&server, &fetch);
    assert!(!early.status.success() && output.join("table.parquet").exists());
    assert!(String::from_utf8_lossy(&early.stderr).contains("2 of 2 points have no result yet"));
    assert!(run(&server, &[&fetch[..], &["--partial"]].concat()).status.success());
    assert_eq!(json(&server, &["cancel", id, "--json"])["state"], "cancelled");
    assert!(!run(&server, &["watch", id]).status.success(), "cancelled points have no result");
    assert!(text(&server, &["retry", id]).contains("2 queued"));
    let status = json(&server, &["status", "--json"]);
    assert_eq!((&status["queue"]["queued"], &status["workers"]), (&json!(2), &json!([])));
    // No worker lives here.
    let data = data.path().to_str().unwrap();
    assert!(run(&server, &["health"]).status.success());
    assert!(!run(&server, &["health", "--worker", "--data", data]).status.success());
    assert!(run(&server, &["worker", "--drain", "--data", data]).status.success());
    assert!(text(&server, &["watch", id]).contains("2 succeeded"));
    let deletion = json(&server, &["delete", id, "--dry-run", "--json"]);
    assert_eq!((&deletion["points"], &deletion["results"]), (&json!(2), &json!(2)));
    text(&server, &["change", id, "--pin"]);
    let pinned = run(&server, &["delete", id]);
    assert!(!pinned.status.success() && String::from_utf8_lossy(&pinned.stderr).contains("is pinned"));
    text(&server, &["change", id, "--unpin"]);
    assert_eq!(json(&server, &["check", "--data", data, "--json"])["results"], 2);
    assert!(text(&server, &["delete", id]).starts_with("deleted"));
    assert!(!run(&server, &["show", id]).status.success());
    assert!(!run(&server, &["check", "--data", "/nowhere"]).status.success());
}

#[test]
fn sweep_is_paused_changed_found_extended_and_resumed() {
    let data = tempfile::tempdir().unwrap();
    let (_serve, server) = listen(data.path(), &["serve"]);
    let submit = [
        &["submit", "paper-200m", "--flow-rate", "0.01,0.03", "--tag", "campaign-7", "--detach"][..],
        &SHORT,
    ]
    .concat();
    let id = text(&server, &submit);
    let id = id.trim();
    assert_eq!(json(&server, &["pause", id, "--json"])["state"], "paused");
    let found = |arguments: &[&str]| {
        let page = json(&server, &[&["list", "--json"], arguments].concat());
        page["sweeps"].as_array().unwrap().iter().any(|sweep| sweep["id"] == id)
    };
    assert!(found(&["--tag", "campaign-7", "--state", "paused"]) && !found(&["--tag", "campaign"]));
    let changes = ["--name", "finer", "--priority", "-3", "--tag", "x", "--pin", "--expires", "90d"];
    let sweep = json(&server, &[&["change", id, "--json"], &changes[..]].concat());
    assert_eq!(
        (&sweep["name"], &sweep["priority"], &sweep["tags"], &sweep["pinned"]),
        (&json!("finer"), &json!(-3), &json!(["x"]), &json!(true))
    );
    let expires: jiff::Timestamp = sweep["expires"].as_str().unwrap().parse().unwrap();
    let days = expires.duration_since(jiff::Timestamp::now()).as_hours();
    assert!((89 * 24..=90 * 24).contains(&days), "{days}");
    let back = ["change", id, "--name", "", "--no-tags", "--unpin", "--expires", "never", "--json"];
    let sweep = json(&server, &back);
    assert_eq!(sweep["pinned"], false);
    assert!(["name", "tags", "expires"].iter().all(|name| sweep.get(name).is_none()), "{sweep}");
    assert!(!run(&server, &["change", id]).status.success(), "nothing to change");
    let appended = json(&server, &["append", id, "--flow-rate", "0.01:0.03:3", "--json"]);
    assert_eq!((&appended["counts"]["total"], &appended["state"]), (&json!(3), &json!("paused")));
    assert_eq!(json(&server, &["resume", id, "--json"])["state"], "running");
}

#[test]
fn points_that_were_given_up_are_listed() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "1"]);
    // Without its wall the string is buckled by the weight on bit.
    let buckled = ["submit", "paper-200m", "--set", "effects.contact=off", "--detach"];
    let id = text(&server, &[&buckled[..], &SHORT].concat());
    let id = id.trim();
    assert!(!run(&server, &["watch", id]).status.success());
    let page = json(&server, &["failures", "--class", "physical", "--json"]);
    assert_eq!(page["failures"][0]["sweep"], id);
    let shown = text(&server, &["failures"]);
    assert!(shown.lines().nth(1).unwrap().contains("no equilibrium"), "{shown}");
    assert_eq!(json(&server, &["failures", "--owner", "nobody", "--json"])["failures"], json!([]));
}

#[test]
fn completions_are_valid_shell_scripts() {
    let script = text("", &["completions", "bash"]);
    assert!(script.contains("submit") && script.contains("--mud-density"));
    let mut bash = Command::new("bash").arg("-n").stdin(Stdio::piped()).spawn().unwrap();
    bash.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
    assert!(bash.wait().unwrap().success());
    for shell in ["zsh", "fish"] {
        assert!(text("", &["completions", shell]).contains("mud-density"));
    }
}

#[test]
fn scenarios_are_listed_and_printed_as_json() {
    assert!(json("", &["scenario", "--json"]).as_array().unwrap().iter().any(|s| s["name"] == "paper-200m"));
    assert_eq!(json("", &["scenario", "paper-200m", "--json"])["mud"]["density"], 1200.0);
}

#[test]
fn a_sample_of_points_is_verified_by_the_reference() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "2"]);
    let verified = |accuracy: &str, number: &str| {
        let accuracy = format!("accuracy={accuracy}");
        let arguments = [
            &["submit", "paper-200m", "--flow-rate", "0.01:0.05:5", "--verify", number, "--json"][..],
            &SHORT[2..],
            &["--set", "recording.rate_hz=500", "--set", &accuracy],
        ];
        json(&server, &arguments.concat())
    };
    // The string is dropped into its motion, and 0.2 s of it a standard step resolves as well as the reference.
    let standard = verified("\"standard\"", "0.4");
    let verification = &standard["verification"];
    assert_eq!((&standard["state"], &verification["counts"]["succeeded"]), (&json!("completed"), &json!(2)));
    let bias = verification["worst"]["bias"].as_f64().unwrap();
    assert!(bias.abs() < 0.02 && verification.get("warnings").is_none(), "{verification}");
    // The same reference runs do for a method that is far too coarse, and promises nothing.
    let coarse = verified(r#"{"integrator": "generalized_alpha", "step": 0.002, "spectral_radius": 0}"#, "2");
    let verification = &coarse["verification"];
    let worst = &verification["worst"];
    assert!(worst["bias"].as_f64().unwrap().abs() > 10.0 * bias.abs(), "{verification} against {bias}");
    assert!(worst.get("promised").is_none() && verification.get("warnings").is_none(), "{verification}");
    let check = json(&server, &["check", "--data", data.path().to_str().unwrap(), "--json"]);
    assert_eq!(check["results"], 5 + 2 + 5, "{check}");

    let id = coarse["id"].as_str().unwrap();
    let shown = text(&server, &["show", id]);
    let said =
        format!("verified by the reference: 2 of 2; bias of {} up to", worst["statistic"].as_str().unwrap());
    assert!(shown.lines().nth(1).unwrap().starts_with(&said), "{shown}");
    let table = ureq::get(format!("{server}/v1/sweeps/{id}/table?format=csv")).call().unwrap();
    let table = table.into_body().read_to_string().unwrap();
    assert!(table.lines().next().unwrap().contains("bias_orbit_radius_rms_49"), "{table}");
    let refused = run(&server, &["submit", "paper-200m", "--verify", "1.5"]);
    assert!(String::from_utf8(refused.stderr).unwrap().contains("/verify"));
}

#[test]
fn several_scenarios_are_studied_by_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("cost");
    let study = ["--presets", "draft", "--methods", "[]", "--threads", "1", "--format", "json"];
    let output_argument = ["--output", output.to_str().unwrap()];
    let scenarios = ["cost", "paper-200m-damped", "closed/building-well"];
    let found = json("", &[&scenarios[..], &SHORT[2..], &study, &output_argument].concat());
    let reports = found["reports"].as_array().unwrap();
    let names: Vec<_> = reports.iter().map(|report| report["scenario"].as_str().unwrap()).collect();
    assert_eq!(names, &scenarios[1..]);
    assert!(reports.iter().all(|report| report["duration"] == 0.2));
    let columns = &found["table"]["columns"];
    assert_eq!(columns["name"], json!(["A", "B", "draft", "A", "B", "draft"]));
    assert_eq!(columns["scenario"][5], "closed/building-well");
    assert!(columns["promise"][5].is_string() && columns["promise"][4].is_null());
    let read = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();
    assert_eq!(read("cost.csv").lines().count(), 1 + 6);
    for (report, folder) in reports.iter().zip(["paper-200m-damped", "closed-building-well"]) {
        assert_eq!(serde_json::from_str::<Value>(&read(&format!("{folder}/cost.json"))).unwrap(), *report);
        assert_eq!(read(&format!("{folder}/cost.csv")).lines().count(), 1 + 3);
    }

    // Invalid scenarios are refused before anything runs.
    let unwritten = folder.path().join("unwritten");
    let output_argument = ["--output", unwritten.to_str().unwrap()];
    let refused = run(
        "",
        &[&["cost", "paper-200m", "paper-200m-dry", "--set", "mud.density=-1"][..], &output_argument]
            .concat(),
    );
    assert!(!refused.status.success() && !unwritten.exists());
}

#[test]
fn sweeps_are_found_by_the_beginning_of_their_identifier_and_by_their_name() {
    let data = tempfile::tempdir().unwrap();
    let (_serve, server) = listen(data.path(), &["serve"]);
    let named = |name: &str| {
        let submit = ["submit", "paper-200m", "--name", name, "--detach"];
        text(&server, &[&submit[..], &SHORT].concat()).trim().to_owned()
    };
    let (first, second) = (named("first"), named("twice"));
    named("twice");
    let found = |text: &str| json(&server, &["show", text, "--json"])["id"].as_str().unwrap().to_owned();
    assert_eq!((found("first"), found(&first)), (first.clone(), first.clone()));
    assert_eq!(found(&second[..35]), second);
    // Identifiers begin with the time: these were made within the same minutes.
    for ambiguous in [&first[..4], "twice"] {
        let output = run(&server, &["show", ambiguous]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && error.contains(&second), "{ambiguous}: {error}");
    }
    assert!(!run(&server, &["show", "third"]).status.success());
}

#[test]
fn a_dry_run_is_a_table_and_a_submission_says_how_to_go_on() {
    let data = tempfile::tempdir().unwrap();
    let (_serve, server) = listen(data.path(), &["serve"]);
    let submit = [&["submit", "paper-200m", "--flow-rate", "0.01:0.04:4"][..], &SHORT].concat();
    let shown = text(&server, &[&submit[..], &["--dry-run"]].concat());
    assert!(shown.starts_with("4 points, 0 with a result already"), "{shown}");
    assert!(
        shown.contains("flow_rate m3/s") && shown.lines().any(|line| line.contains("  0.02  ")),
        "{shown}"
    );
    let whole = json(&server, &[&submit[..], &["--dry-run", "--json"]].concat());
    assert_eq!(whole["points"].as_array().unwrap().len(), 4);
    let output = run(&server, &[&submit[..], &["--detach"]].concat());
    let (id, hints) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(id.lines().count(), 1, "{id}");
    for hint in ["drillsweep watch", "drillsweep fetch", "profile?format=svg"] {
        assert!(hints.lines().any(|line| line.contains(hint) && line.contains(id.trim())), "{hints}");
    }
    let page = format!("page:  {server}/#/sweeps/{}", id.trim());
    assert!(hints.lines().any(|line| line.ends_with(&page)), "{hints}");
}

#[test]
fn output_ends_quietly_at_a_closed_pipe_and_errors_are_messages() {
    // The reading end is closed before the command starts.
    for arguments in [&["scenario", "paper-200m"][..], &["completions", "bash"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(BINARY).args(arguments).stdout(writer).output().unwrap();
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{arguments:?}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }

    let failing = Command::new(BINARY)
        .args(["check", "--data", "/nowhere"])
        .env("RUST_BACKTRACE", "1")
        .env_remove("NO_COLOR")
        .output()
        .unwrap();
    assert_eq!(String::from_utf8(failing.stderr).unwrap(), "Error: there is no store in /nowhere\n");
    for arguments in
        [&["gc"][..], &["token", "list"], &["token", "revoke", "x"], &["check"], &["health", "--worker"]]
    {
        let nowhere = tempfile::tempdir().unwrap().path().join("missing");
        let data = ["--data", nowhere.to_str().unwrap()];
        assert!(!run("127.0.0.1:9", &[arguments, &data].concat()).status.success(), "{arguments:?}");
        assert!(!nowhere.exists(), "{arguments:?} made a store");
    }
    let data = tempfile::tempdir().unwrap();
    let (_serve, server) = listen(data.path(), &["serve"]);
    let host_and_port = server.strip_prefix("http://").unwrap();
    assert!(run(host_and_port, &["health"]).status.success());
    let refused = run(&server, &["submit", "paper-200m", "--set", "mud.density=-1", "--detach"]);
    let error = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(error.matches("must be greater than 0").count(), 1, "{error}");
}

#[test]
fn looking_at_a_store_leaves_no_trace_in_it() {
    let data = tempfile::tempdir().unwrap();
    let (mut serve, server) = listen(data.path(), &["serve"]);
    let submit = [&["submit", "paper-200m", "--detach"][..], &SHORT].concat();
    text(&server, &submit);
    let directory = data.path().to_str().unwrap();
    let files = || {
        let mut names: Vec<_> = std::fs::read_dir(data.path())
            .unwrap()
            .map(|entry| entry.unwrap())
            .map(|entry| (entry.file_name(), entry.metadata().unwrap().modified().unwrap()))
            .collect();
        names.sort();
        names
    };
    assert!(run(&server, &["check", "--data", directory]).status.success(), "beside a running service");
    serve.signal(Signal::TERM);
    assert!(serve.0.wait().unwrap().success());
    let before = files();
    for look in [&["check"][..], &["token", "list"]] {
        assert!(run(&server, &[look, &["--data", directory]].concat()).status.success());
        assert_eq!(files(), before, "{look:?}");
    }
}
