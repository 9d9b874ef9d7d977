//! Large answers: written while they are sent, in little memory, and broken off where what they are written from turns out damaged.

use std::net::SocketAddr;

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use drillsweep_server::{Config, Listeners, serve};
use drillsweep_table::{Column, Table, csv, json, npz, parquet};
use http_body_util::BodyExt;
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

use crate::bench::Bench;

/// Samples that no compression makes smaller, of so many nodes at 1 kHz.
fn noise(samples: u32, nodes: u32) -> Table {
    let mut state: u64 = 1;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 * 1e-9
    };
    let mut table =
        Table::default().with("time", Column::Number((0..samples).map(|k| f64::from(k) / 1000.0).collect()));
    for node in 1..=nodes {
        for quantity in ["u", "v", "w", "theta_z", "u_rate", "v_rate", "w_rate", "theta_z_rate"] {
            let values = (0..samples).map(|_| next()).collect();
            table.push(format!("{quantity}_{node}"), Column::Single(values));
        }
    }
    table
}

/// The statics of as many nodes, 1 m apart.
fn statics(nodes: u32) -> Table {
    Table::default()
        .with("node", Column::Integer((1..=nodes).map(|node| Some(node.into())).collect()))
        .with("measured_depth", Column::Number((0..nodes).map(f64::from).collect()))
}

/// A sweep of one point with such a history, and the point's path.
async fn finished(bench: &Bench, history: &Table, nodes: u32) -> String {
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    bench.succeed_with_tables(1e-9, &[("history", history), ("statics", &statics(nodes))]).await;
    format!("/v1/sweeps/{id}/points/1")
}

#[tokio::test]
async fn a_long_history_equals_the_table_in_memory_in_every_format() {
    let bench = Bench::new().await;
    let history = noise(25_000, 3);
    let point = finished(&bench, &history, 3).await;
    let whole = history.clone().attribute("samples", 25_000);
    let window = |table: &Table, rows: std::ops::Range<usize>, stride: usize| {
        let mut cut = Table::default();
        for (name, column) in &table.columns {
            cut.push(name, column.rows(rows.clone().step_by(stride)));
        }
        cut.attribute("samples", rows.len())
    };
    let node = Table {
        columns: whole
            .columns
            .iter()
            .filter(|(name, _)| *name == "time" || name.ends_with("_2"))
            .map(|(name, column)| (name.clone(), column.clone()))
            .collect(),
        ..Table::default()
    };
    let mut of_node = Table::default().attribute("node", 2).attribute("measured_depth", 1.0);
    let part = window(&node, 5_000..22_000, 2);
    (of_node.columns, of_node.units) = (part.columns, part.units);
    let of_node = of_node.attribute("samples", 17_000);
    for (query, expected) in [("", whole), ("node=2&from=5&to=22&max_points=8500&", of_node)] {
        let mut bytes = [const { Vec::new() }; 4];
        csv::write_to(&expected, &mut bytes[0]).unwrap();
        json::write_to(&expected, &mut bytes[1]).unwrap();
        npz::write_to(&expected, &mut bytes[2]).unwrap();
        parquet::write_to(&expected, &mut bytes[3]).unwrap();
        for (format, expected) in ["csv", "json", "npz", "parquet"].into_iter().zip(bytes) {
            let answer = bench.get(&format!("{point}/history?{query}format={format}")).await;
            assert_eq!(answer.status, StatusCode::OK);
            assert!(
                answer.body == expected,
                "{query}{format}: {} bytes for {}",
                answer.body.len(),
                expected.len()
            );
        }
    }
}

#[tokio::test]
async fn a_stored_file_goes_out_with_its_length() {
    let bench = Bench::new().await;
    let history = noise(25_000, 3);
    let point = finished(&bench, &history, 3).await;
    let expected = parquet::write(&history).unwrap();
    for file in ["history?format=parquet", "artifacts/history"] {
        let answer = bench.get(&format!("{point}/{file}")).await;
        assert_eq!(answer.headers[header::CONTENT_LENGTH], expected.len().to_string());
        assert!(answer.body == expected, "{file}");
    }
    // Across the borders of what is verified as one.
    let request = Request::get(format!("{point}/artifacts/history")).header("range", "bytes=100000-900000");
    let answer = bench.send(request.body(Body::empty()).unwrap()).await;
    assert_eq!((answer.status, answer.body.len()), (StatusCode::PARTIAL_CONTENT, 800_001));
    assert!(answer.body == expected[100_000..=900_000]);
}

#[tokio::test]
async fn an_answer_breaks_off_at_damage_and_queues_a_repair() {
    let bench = Bench::new().await;
    let history = noise(25_000, 3);
    let point = finished(&bench, &history, 3).await;
    let sweep = point.strip_suffix("/points/1").unwrap();
    // The first reading verifies all of it; what is damaged later on is found where it is read.
    assert_eq!(bench.get(&format!("{point}/history?max_points=1")).await.status, StatusCode::OK);
    let file = bench.blob_file_of(sweep, 1, "history").await;
    let whole = std::fs::read(&file).unwrap();
    let mut damaged = whole.clone();
    damaged[whole.len() * 3 / 4] ^= 1;
    std::fs::write(&file, damaged).unwrap();
    for ask in ["history?format=csv", "history?format=parquet", "artifacts/history"] {
        let response = bench.open(&format!("{point}/{ask}")).await;
        assert_eq!(response.status(), StatusCode::OK, "{ask}");
        assert!(
            response.into_body().collect().await.is_err(),
            "{ask}: the body must not end as if it were whole"
        );
        let counts = bench.get(sweep).await.json()["counts"].clone();
        assert_eq!(counts["queued"], 1, "{ask}");
    }
    // What is damaged before the first byte is a problem still.
    let mut damaged = whole;
    damaged[10] ^= 1;
    std::fs::write(&file, damaged).unwrap();
    for ask in ["history?format=csv", "history?format=parquet", "artifacts/history", "orbit?node=1"] {
        bench.get(&format!("{point}/{ask}")).await.problem(503, "recomputing");
    }
}

#[tokio::test]
async fn a_picture_of_too_much_is_refused_with_an_alternative() {
    let bench = Bench::new().await;
    let nodes = 41;
    let zeros = Column::Single(vec![0.0; 25_000]);
    let mut history =
        Table::default().with("time", Column::Number((0..25_000).map(|k| f64::from(k) / 1000.0).collect()));
    for node in 1..=nodes {
        history.push(format!("u_{node}"), zeros.clone());
        history.push(format!("v_{node}"), zeros.clone());
    }
    let point = finished(&bench, &history, nodes).await;
    let problem = bench.get(&format!("{point}/history?format=svg")).await.problem(400, "invalid-parameter");
    assert!(problem["detail"].as_str().unwrap().contains("max_points"), "{problem}");
    for less in ["max_points=1000", "node=41", "fields=u_1"] {
        let answer = bench.get(&format!("{point}/history?format=svg&{less}")).await;
        assert_eq!(answer.status, StatusCode::OK, "{less}");
    }
}

/// A line of `/proc/self/status` \[bytes\].
fn memory(line: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|text| text.strip_prefix(line)).unwrap();
    line.trim_start_matches(':').trim().trim_end_matches(" kB").parse::<u64>().unwrap() * 1024
}

/// Reads an answer to its end and gives its length \[bytes\].
async fn download(address: SocketAddr, path: &str) -> usize {
    let mut connection = TcpStream::connect(address).await.unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    connection.write_all(request.as_bytes()).await.unwrap();
    let (mut buffer, mut total) = (vec![0; 64 << 10], 0);
    loop {
        match connection.read(&mut buffer).await.unwrap() {
            0 => return total,
            count => total += count,
        }
    }
}

/// In a process of its own, since peak memory is the process's, with the arenas of glibc's allocator that the documents tell operators to
/// have: with as many as it makes by itself each thread of the pool keeps what its largest answer took.
#[test]
fn a_dozen_downloads_take_bounded_memory() {
    let name = "large::a_dozen_downloads_take_bounded_memory";
    if std::env::var_os(ALONE).is_none() {
        let mut alone = std::process::Command::new(std::env::current_exe().unwrap());
        let alone = alone.args([name, "--exact"]).env(ALONE, "1").env("MALLOC_ARENA_MAX", "2");
        assert!(alone.status().unwrap().success());
        return;
    }
    tokio::runtime::Runtime::new().unwrap().block_on(download_by_the_dozen());
}

/// Set where the test runs alone in its process.
const ALONE: &str = "DRILLSWEEP_TEST_ALONE";

async fn download_by_the_dozen() {
    let bench = Bench::new().await;
    let nodes = 40;
    let samples = 10_000;
    let point = finished(&bench, &noise(samples, nodes), nodes).await;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let config = Config { large_answer_bytes: 32 << 20, ..Config::default() };
    let bound = config.large_answer_bytes as u64 * 3 / 2;
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let running =
        tokio::spawn(serve(Listeners { api: listener, metrics: None }, bench.store.clone(), config, async {
            let _ = stopped.await;
        }));
    std::fs::write("/proc/self/clear_refs", "5").unwrap();
    let before = memory("VmHWM");
    let downloads = (0..12).map(|client| {
        let format = ["csv", "json", "npz"][client % 3];
        tokio::spawn({
            let path = format!("{point}/history?format={format}");
            async move { download(address, &path).await }
        })
    });
    let raw = samples as usize * nodes as usize * 8 * 4;
    for download in downloads.collect::<Vec<_>>() {
        assert!(download.await.unwrap() > raw, "the whole of it has come");
    }
    let taken = memory("VmHWM").saturating_sub(before);
    // The clients, the connections and the threads are in this process too.
    let beside = 24 << 20;
    assert!(taken < bound + beside, "{} MB", taken >> 20);
    stop.send(()).unwrap();
    running.await.unwrap().unwrap();
}

/// Serves the bench's store, and gives the address and what stops the server when it is dropped.
async fn served(bench: &Bench, config: Config) -> (SocketAddr, tokio::sync::oneshot::Sender<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let store = bench.store.clone();
    tokio::spawn(serve(Listeners { api: listener, metrics: None }, store, config, async {
        let _ = stopped.await;
    }));
    (address, stop)
}

/// A client that asks for this and takes nothing but the head of the answer, whose first line is given.
async fn asked(address: SocketAddr, path: &str) -> (TcpStream, String) {
    let mut connection = TcpStream::connect(address).await.unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    connection.write_all(request.as_bytes()).await.unwrap();
    let mut line = Vec::new();
    while !line.ends_with(b"\r\n") {
        line.push(connection.read_u8().await.unwrap());
    }
    (connection, String::from_utf8(line).unwrap().trim_end().to_owned())
}

const OK: &str = "HTTP/1.1 200 OK";
const BUSY: &str = "HTTP/1.1 503 Service Unavailable";

#[tokio::test(flavor = "multi_thread")]
async fn small_answers_do_not_wait_for_slow_clients_of_large_ones() {
    let bench = Bench::new().await;
    let nodes = 40;
    let point = finished(&bench, &noise(10_000, nodes), nodes).await;
    // A request that would have to wait is refused at once, and no client is broken off.
    let config = Config {
        large_answer_bytes: 30 << 20,
        large_answers_waiting: 0,
        large_answer_allowance: std::time::Duration::MAX,
        ..Config::default()
    };
    let (address, _stop) = served(&bench, config).await;
    for (large, small) in
        [("history?format=csv", "statics?format=csv"), ("artifacts/history", "artifacts/statics")]
    {
        let mut slow = Vec::new();
        loop {
            let (connection, status) = asked(address, &format!("{point}/{large}")).await;
            slow.push(connection);
            if status == BUSY {
                break;
            }
            assert_eq!(status, OK);
        }
        assert!(slow.len() > 1, "{large}: somebody is served");
        for _ in 0..100 {
            assert_eq!(asked(address, &format!("{point}/{small}")).await.1, OK, "{small} beside {large}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn an_answer_to_a_stalled_client_is_aborted() {
    let bench = Bench::new().await;
    let nodes = 40;
    let history = noise(10_000, nodes);
    let point = finished(&bench, &history, nodes).await;
    let stored = parquet::write(&history).unwrap().len();
    // Memory for one.
    let config = Config {
        large_answer_bytes: 1 << 20,
        large_answer_allowance: std::time::Duration::from_millis(500),
        ..Config::default()
    };
    let (address, _stop) = served(&bench, config).await;
    for (path, least) in [("history?format=csv", stored * 2), ("artifacts/history", stored)] {
        let path = format!("{point}/{path}");
        let (mut slow, status) = asked(address, &path).await;
        assert_eq!(status, OK);
        assert!(download(address, &path).await > least, "{path}: who comes later has all of it");
        let mut taken = Vec::new();
        // A broken connection may end in an error as well.
        let _ = slow.read_to_end(&mut taken).await;
        assert!(taken.len() < least, "{path}: {} bytes of an answer that was broken off", taken.len());
    }
}
