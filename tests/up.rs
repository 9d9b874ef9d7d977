//! The life of `drillsweep up`: a start that fails, a part that fails, the end.

use std::io::{BufRead as _, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;

use crate::faults::{Logged, command, serve};
use crate::{BINARY, PATIENCE, Process, get, post};

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
fn up_that_loses_a_worker_for_good_ends_with_the_reason_and_leaves_no_other() {
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
fn up_prints_where_its_page_and_its_data_are_once_it_listens() {
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
