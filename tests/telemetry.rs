//! Traces reach a collector: a small HTTP server here, which keeps the bodies that it is sent.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Longest that a trace may take on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(60);

struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Takes requests and passes on path and body of each.
fn collector() -> (String, Receiver<(String, Vec<u8>)>) {
    fn answer(connection: &TcpStream, bodies: &Sender<(String, Vec<u8>)>) -> std::io::Result<()> {
        let mut reader = BufReader::new(connection.try_clone()?);
        loop {
            let (mut first, mut length) = (String::new(), 0);
            if reader.read_line(&mut first)? == 0 {
                return Ok(());
            }
            loop {
                let mut line = String::new();
                reader.read_line(&mut line)?;
                if line.trim().is_empty() {
                    break;
                }
                if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                    length = value.trim().parse().unwrap();
                }
            }
            let mut body = vec![0; length];
            reader.read_exact(&mut body)?;
            // The test may be over.
            let _ = bodies.send((first.split(' ').nth(1).unwrap().to_owned(), body));
            (&*connection).write_all(
                b"HTTP/1.1 200 OK\r\nContent-Type: application/x-protobuf\r\nContent-Length: 0\r\n\r\n",
            )?;
        }
    }
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for connection in listener.incoming() {
            let (connection, sender) = (connection.unwrap(), sender.clone());
            std::thread::spawn(move || answer(&connection, &sender));
        }
    });
    (address, receiver)
}

fn command(data: &Path, collector: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_drillsweep"));
    command
        .args(arguments)
        .arg("--data")
        .arg(data)
        .env("OTEL_EXPORTER_OTLP_ENDPOINT", collector)
        .env("OTEL_BSP_SCHEDULE_DELAY", "50")
        // Traces do not depend on the log's filter.
        .env("DRILLSWEEP_LOG", "off,drillsweep_server::serve=info")
        .env("NO_COLOR", "1");
    command
}

/// Waits until the traces of a service have had all of these texts, which are in protobuf what they are; in one body or in
/// several.
fn wait_for(bodies: &Receiver<(String, Vec<u8>)>, service: &str, texts: &[&str]) {
    let deadline = Instant::now() + PATIENCE;
    let mut missing = texts.to_vec();
    while !missing.is_empty() {
        let left = deadline.saturating_duration_since(Instant::now());
        let (path, body) = bodies.recv_timeout(left).unwrap_or_else(|_| panic!("no trace has {missing:?}"));
        assert_eq!(path, "/v1/traces");
        let has = |text: &str| body.windows(text.len()).any(|window| window == text.as_bytes());
        if has(service) {
            missing.retain(|text| !has(text));
        }
    }
}

/// The name of a span: in protobuf its length comes before it, and no other text has that there.
fn named(name: &str) -> String {
    format!("{}{name}", char::from(name.len() as u8))
}

#[test]
fn spans_of_requests_and_of_points_arrive() {
    let data = tempfile::tempdir().unwrap();
    let (address, bodies) = collector();
    let mut server = command(data.path(), &address, &["serve", "--listen", "127.0.0.1:0"]);
    let mut server = Process(server.stderr(Stdio::piped()).spawn().unwrap());
    let mut log = BufReader::new(server.0.stderr.take().unwrap());
    let mut line = String::new();
    let service = loop {
        line.clear();
        assert!(log.read_line(&mut line).unwrap() > 0, "the server ended before it listened");
        if let Some(at) = line.find("http://") {
            break line[at..].split_whitespace().next().unwrap().to_owned();
        }
    };
    std::thread::spawn(move || std::io::copy(&mut log, &mut std::io::sink()));
    let path = "/v1/sweeps/a-sweep-that-nobody-has";
    assert!(ureq::get(format!("{service}{path}")).call().is_err());
    wait_for(&bodies, "drillsweep-server", &[&named("request"), "http.path", path, "http.status"]);

    let set = json!({
        "duration": 0.1,
        "accuracy": "draft",
        "recording.spectrum_windows": [],
        "recording.orbit_window": null,
    });
    let run = json!({ "preset": "paper-200m", "set": set });
    let run: Value =
        ureq::post(format!("{service}/v1/runs")).send_json(run).unwrap().body_mut().read_json().unwrap();
    let point = format!("{service}/v1/sweeps/{}/points/1", run["id"].as_str().unwrap());
    let point: Value = ureq::get(point).call().unwrap().body_mut().read_json().unwrap();
    let worker = command(data.path(), &address, &["worker", "--drain"]).status().unwrap();
    assert!(worker.success());
    let key = &point["key"].as_str().unwrap()[..12];
    wait_for(
        &bodies,
        "drillsweep-worker",
        &["point claimed", key, &named("point"), &named("compute"), &named("store")],
    );
}
