//! The life of `drillsweep up`: a start that fails, a part that fails, the end.

use std::io::{BufRead as _, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;

use crate::faults::{Logged, bytes, command, request, serve, submit};
use crate::{BINARY, PATIENCE, Process, completed, get, post, wait};

impl Logged {
    /// Waits until the process ends by itself.
    fn ended(&mut self) -> ExitStatus {
        self.ended_within(PATIENCE)
    }

    fn ended_within(&mut self, limit: Duration) -> ExitStatus {
        let deadline = Instant::now() + limit;
        loop {
            if let Some(status) = self.process.0.try_wait().unwrap() {
                return status;
            }
            assert!(Instant::now() < deadline, "still running after {limit:?}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// Processes whose command line names a directory.
fn processes_on(directory: &Path) -> Vec<String> {
    let name = directory.to_str().unwrap();
    let command_line = |process: std::io::Result<std::fs::DirEntry>| {
        // A process may end meanwhile.
        let line = std::fs::read(process.ok()?.path().join("cmdline")).ok()?;
        Some(String::from_utf8_lossy(&line).replace('\0', " "))
    };
    let lines = std::fs::read_dir("/proc").unwrap().filter_map(command_line);
    lines.filter(|line| line.contains(name)).collect()
}

#[test]
fn up_that_cannot_start_ends_with_the_reason_and_leaves_no_worker() {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("file");
    std::fs::write(&file, "").unwrap();
    let [data, newer, below_file] = ["data", "newer", "file/data"].map(|name| place.path().join(name));
    let created = command(&newer, &["token", "create", "--owner", "anne"]).output().unwrap();
    assert!(created.status.success());
    let migration = "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
        VALUES (9999, 'of a later version', TRUE, X'00', 0)";
    let changed = Command::new("sqlite3").arg(newer.join("drillsweep.sqlite")).arg(migration).status();
    assert!(changed.unwrap().success());

    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let missing = file.to_str().unwrap().to_owned() + "/token";
    let cannot_listen = format!("cannot listen on {address}");
    for (data, options, reason) in [
        (&data, ["--listen", &address], cannot_listen.as_str()),
        (&data, ["--metrics-listen", &address], &cannot_listen),
        (&data, ["--listen", "0.0.0.0:0"], "will not listen on 0.0.0.0"),
        (&data, ["--admin-token-file", &missing], "Not a directory"),
        (&data, ["--worker-metrics-listen", &address], &cannot_listen),
        (&data, ["--scratch", &missing], "Not a directory"),
        (&data, ["--lease-seconds", "0.5"], "--lease-seconds must be from 1 to 3600, got 0.5"),
        (&below_file, ["--workers", "2"], "Not a directory"),
        (&newer, ["--workers", "2"], "database schema"),
    ] {
        let mut up = command(data, &["up"]);
        if options[0] != "--listen" {
            up.args(["--listen", "127.0.0.1:0"]);
        }
        let mut up = Logged::start(up.args(options));
        assert_eq!(up.ended().code(), Some(1), "{options:?}");
        up.wait_for(|log| log.contains(reason).then_some(()));
        assert!(!up.log().contains("worker ready"), "{options:?}");
        assert_eq!(processes_on(place.path()), Vec::<String>::new(), "{options:?}");
    }
}

#[test]
fn up_ends_with_the_reason_after_losing_a_worker_for_good() {
    let data = tempfile::tempdir().unwrap();
    // A program that is taken away while it runs.
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("drillsweep-{}", std::process::id()));
    std::fs::hard_link(BINARY, &program).unwrap();
    let mut up = Command::new(&program);
    up.args(["up", "--workers", "2", "--listen", "127.0.0.1:0", "--data"]).arg(data.path());
    let mut up = Logged::start(&mut up);
    let server = up.address();
    let workers = || get(&format!("{server}/v1/workers"))["workers"].as_array().unwrap().clone();
    up.wait_for(|_| (workers().len() == 2).then_some(()));
    let process = workers()[0]["process"].as_i64().unwrap() as i32;
    std::fs::remove_file(&program).unwrap();
    kill_process(Pid::from_raw(process).unwrap(), Signal::KILL).unwrap();
    assert_eq!(up.ended().code(), Some(1));
    up.wait_for(|log| log.contains("Error: a worker cannot be started").then_some(()));
    assert_eq!(processes_on(data.path()), Vec::<String>::new());
}

#[test]
fn up_prints_page_and_data_locations_once_it_listens() {
    let place = tempfile::tempdir().unwrap();
    let mut up = Command::new(BINARY);
    up.args(["up", "--workers", "1", "--listen", "0.0.0.0:0", "--data", "here"]).current_dir(place.path());
    let create = ["token", "create", "--owner", "anne", "--data", "here"];
    let created = Command::new(BINARY).args(create).current_dir(place.path()).output().unwrap();
    assert!(created.status.success());
    let mut up = Process(up.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap());
    let lines = BufReader::new(up.0.stdout.take().unwrap()).lines();
    let lines: Vec<String> = lines.map(Result::unwrap).take_while(|line| !line.contains("Ctrl-C")).collect();
    let directory = place.path().canonicalize().unwrap().join("here").display().to_string();
    let shown = |name: &str| {
        let line = lines.iter().find_map(|line| line.trim_start().strip_prefix(name)).unwrap();
        line.trim().to_owned()
    };
    assert!(
        lines[0].contains(env!("CARGO_PKG_VERSION")) && lines[0].contains("physics version"),
        "{lines:?}"
    );
    assert_eq!((shown("data"), shown("workers")), (directory, "1".to_owned()));
    let page = ureq::get(shown("page")).call().unwrap().body_mut().read_to_string().unwrap();
    assert!(page.contains("<html") && page.contains("drillsweep"), "{page}");
    up.signal(Signal::TERM);
    assert!(up.0.wait().unwrap().success());
}

#[test]
fn up_without_workers_serves_those_of_other_processes_until_it_is_stopped() {
    let data = tempfile::tempdir().unwrap();
    let mut up =
        Logged::start(&mut command(data.path(), &["up", "--workers", "0", "--listen", "127.0.0.1:0"]));
    let server = up.address();
    let _worker = crate::worker(data.path());
    let sweep = submit(&server, &request(0.2, 1, 1));
    wait(&server, &sweep, completed);
    up.process.signal(Signal::TERM);
    assert_eq!(up.ended().code(), Some(0));
}

/// Processor time of a process so far \[hundredths of a second, as Linux reports it\].
fn processor_time(process: u32) -> u64 {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let fields: Vec<&str> = stat.rsplit_once(") ").unwrap().1.split(' ').collect();
    // Fields 14 and 15: user and system.
    fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
}

#[test]
fn server_ends_in_time_while_a_request_computes() {
    let data = tempfile::tempdir().unwrap();
    let (mut server, address) = serve(data.path(), None);
    let run = post(&format!("{address}/v1/runs"), &json!({ "preset": "hard/elements-5000" }));
    // Modes of 5,000 elements: minutes, in a thread that cannot be interrupted.
    let url = format!("{address}/v1/sweeps/{}/points/1/modes?to_hz=50", run["id"].as_str().unwrap());
    let process = server.process.0.id();
    let before = processor_time(process);
    let request = std::thread::spawn(move || ureq::get(&url).call().map(|answer| answer.status()));
    server.wait_for(|_| (processor_time(process) > before + 100).then_some(()));
    assert!(!request.is_finished());
    server.process.signal(Signal::TERM);
    // At most 13 s, and a few more on a machine that is busy.
    let status = server.ended_within(Duration::from_secs(20));
    assert!(request.join().unwrap().is_err(), "it was cut off");
    assert_eq!(status.code(), Some(1));
    server.wait_for(|log| log.contains("requests were still open 10s after").then_some(()));
}

/// The value of a metric.
fn value(metrics: &str, name: &str) -> f64 {
    let line = metrics.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
    line.unwrap_or_else(|| panic!("no {name} in {metrics}")).parse().unwrap()
}

#[test]
fn server_and_workers_export_their_counters() {
    let place = tempfile::tempdir().unwrap();
    let free = || TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let (address, of_server, of_worker) = (free(), free(), free());
    let mut up = command(place.path(), &["up", "--workers", "1", "--listen", &address]);
    up.args(["--metrics-listen", &of_server, "--worker-metrics-listen", &of_worker]);
    let up = Logged::start(&mut up);
    up.wait_for(|log| log.contains("worker ready").then_some(()));
    let server = format!("http://{address}");
    let sweep = submit(&server, &request(0.2, 3, 1));
    wait(&server, &sweep, completed);
    // Without its wall the string is buckled by the weight on bit.
    let mut failing = request(0.2, 1, 1);
    failing["set"]["effects.contact"] = json!("off");
    let failing = submit(&server, &failing);
    wait(&server, &failing, |sweep| sweep["counts"]["failed"] == 1);
    let metrics = |address: &str| String::from_utf8(bytes(&format!("http://{address}/metrics"))).unwrap();
    // The worker counts an end after it has stored it.
    let worker = up.wait_for(|_| {
        let worker = metrics(&of_worker);
        (value(&worker, "drillsweep_worker_running") == 0.0).then_some(worker)
    });
    let attempts = |outcome: &str| {
        value(&worker, &format!("drillsweep_worker_attempt_duration_seconds_count{{outcome=\"{outcome}\"}}"))
    };
    assert_eq!(["succeeded", "failed", "lost", "crashed"].map(attempts), [3.0, 1.0, 0.0, 0.0]);
    assert_eq!(value(&worker, "drillsweep_worker_claims_total{attempt=\"first\"}"), 4.0);
    assert_eq!(value(&worker, "drillsweep_worker_heartbeat_failures_total"), 0.0);
    // Tables of three results, and no more bytes than are on the disk.
    let put = value(&worker, "drillsweep_object_transfer_bytes_total{operation=\"put\"}");
    let stored: u64 = crate::faults::files(&place.path().join("blobs"))
        .iter()
        .map(|file| file.metadata().unwrap().len())
        .sum();
    assert_eq!(put, stored as f64);
    let server = metrics(&of_server);
    for metrics in [&server, &worker] {
        assert!(value(metrics, "process_resident_memory_bytes") > 1e6);
        assert!(metrics.contains("drillsweep_build_info{version="));
        assert_eq!(value(metrics, "drillsweep_expired_leases_total{state=\"queued\"}"), 0.0);
        let connections =
            |state: &str| value(metrics, &format!("drillsweep_database_connections{{state=\"{state}\"}}"));
        let open = connections("idle") + connections("used");
        assert!((1.0..=4.0).contains(&open), "{open} connections");
        assert!(metrics.ends_with("# EOF\n"));
    }
}
