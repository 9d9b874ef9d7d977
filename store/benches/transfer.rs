//! Cost of transferring a store: a sweep whose points all have small results, from a data directory to PostgreSQL and a bucket, and
//! back to a directory.
//!
//! `cargo bench -p drillsweep-store --bench transfer -- --points 100000 --tables 1 --bytes 2000`
//!
//! Times are by the clock, with processor time and the peak of the resident memory of this process alone.

#![expect(clippy::print_stdout, reason = "a report")]

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use drillsweep_store::{
    CachePolicy, DatabaseLocation, NewArtifact, NewPoint, NewResult, NewSweep, NewVerification, Role,
    SourceUse, Store, StoreConfig, TransferProgress, transfer,
};

#[path = "../tests/servers/mod.rs"]
#[allow(dead_code, reason = "of the tests")]
mod servers;

/// As one would run it: what it has confirmed is on the disk.
const SETTINGS: &[&str] = &["fsync=on", "full_page_writes=on", "shared_buffers=512MB", "max_wal_size=1GB"];

/// Workers that fill the store concurrently.
const WORKERS: u64 = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |name: &str, default: u64| {
        let found = arguments.windows(2).find(|pair| pair[0] == name).map(|pair| pair[1].as_str());
        found.map_or(default, |text| text.parse().expect("a number"))
    };
    let (points, tables, bytes) =
        (number("--points", 100_000), number("--tables", 1), number("--bytes", 2_000));
    let directory = tempfile::tempdir().expect("a temporary directory");
    let postgres = servers::postgres::Server::start_with(SETTINGS);
    let bucket = servers::seaweed::Seaweed::start();
    let first = StoreConfig::in_directory(&directory.path().join("first"), Role::Server);
    let service = StoreConfig {
        database: postgres.url().parse::<DatabaseLocation>().expect("a URL"),
        ..first.clone().with_objects(bucket.location(&bucket.address(), "bench"))
    };
    let last = StoreConfig::in_directory(&directory.path().join("last"), Role::Server);
    println!("{points} points with {tables} tables of {bytes} bytes");
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let began = Instant::now();
        fill(&first, points, tables, bytes).await;
        println!("filled in {:.0} s", began.elapsed().as_secs_f64());
        carry("directory to PostgreSQL and a bucket", &first, &service, points).await;
        carry("back to a directory", &service, &last, points).await;
    });
    runtime.shutdown_background();
}

/// Carries a store over and tells what each part of it took.
async fn carry(what: &str, from: &StoreConfig, to: &StoreConfig, points: u64) {
    forget_peak();
    let (began, processor) = (Instant::now(), processor_time());
    let mut parts: Vec<(String, Instant)> = Vec::new();
    let mut show = |progress| {
        let part = match progress {
            TransferProgress::Blobs { .. } => "blobs".to_owned(),
            TransferProgress::Rows(table) => format!("rows of {table}"),
            TransferProgress::Compared(_) => "comparison".to_owned(),
        };
        if parts.last().is_none_or(|(last, _)| *last != part) {
            parts.push((part, Instant::now()));
        }
    };
    let report = transfer(from, to, SourceUse::Idle, &mut show).await.expect("carried over");
    let seconds = began.elapsed().as_secs_f64();
    println!(
        "{what}: {seconds:.1} s, {:.0} points a second, {:.1} s of processor time, at most {:.0} MB of memory, {} blobs of {:.0} MB, {} rows",
        points as f64 / seconds,
        (processor_time() - processor).as_secs_f64(),
        peak() / 1e6,
        report.blobs,
        report.bytes_copied as f64 / 1e6,
        report.rows.iter().map(|(_, rows)| rows).sum::<u64>(),
    );
    let ends = parts.iter().skip(1).map(|(_, at)| *at).chain([Instant::now()]);
    for ((part, at), end) in parts.iter().zip(ends) {
        let took = (end - *at).as_secs_f64();
        if took > 0.005 * seconds {
            println!("  {part}: {took:.1} s");
        }
    }
}

/// Submits a sweep and gives each of its points a result.
async fn fill(config: &StoreConfig, points: u64, tables: u64, bytes: u64) {
    let store = Store::open(config).await.expect("a store");
    let point = |ordinal: u64| NewPoint {
        ordinal: ordinal.cast_signed(),
        parameters_json: format!(r#"{{"flow_rate":0.03,"mud_density":{ordinal}}}"#),
        changes_json: format!(r#"{{"mud.flow_rate":0.03,"mud.density":{ordinal}}}"#),
        work_key: *blake3::hash(&ordinal.to_le_bytes()).as_bytes(),
        fuller_key: None,
    };
    let sweep = NewSweep {
        id: "0190".to_owned(),
        name: None,
        owner: "anne".to_owned(),
        request_json: "{}".to_owned(),
        priority: 0,
        varied_json: r#"["flow_rate"]"#.to_owned(),
        tags_json: "[]".to_owned(),
        cache: CachePolicy::Reuse,
        idempotency_key: None,
        base_json: format!("{:>3000}", "{}"),
        physics_version: 1,
        points: (1..=points).map(point).collect(),
        verification: NewVerification::default(),
    };
    store.submit_sweep(&sweep).await.expect("submitted");
    let next = Arc::new(AtomicU64::new(0));
    let worker = async |number: u64| {
        let config = StoreConfig { role: Role::Worker, ..config.clone() };
        let store = Store::open(&config).await.expect("a store");
        let name = format!("worker {number}");
        let summary = format!(r#"{{"rows":"{:>500}"}}"#, "");
        while let Some(claim) = store.claim(&name, 1, 600_000).await.expect("claimed") {
            let mut artifacts = Vec::new();
            for table in 0..tables {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let mut content = vec![0; usize::try_from(bytes).expect("a size")];
                blake3::Hasher::new().update(&number.to_le_bytes()).finalize_xof().fill(&mut content);
                artifacts.push(NewArtifact {
                    name: format!("table {table}"),
                    media_type: "application/vnd.apache.parquet".to_owned(),
                    blob: store.put_blob(content).await.expect("written"),
                    bytes: bytes.cast_signed(),
                    row_count: 1,
                });
            }
            let result = NewResult {
                summary_json: &summary,
                provenance_json: "{}",
                artifacts: &artifacts,
                is_repeatable: true,
            };
            assert!(store.finish_done(&claim.lease, &result).await.expect("finished"), "nobody else has it");
        }
        store.close().await;
    };
    futures::future::join_all((0..WORKERS).map(worker)).await;
    store.close().await;
}

/// Processor time of this process.
fn processor_time() -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    let fields = stat.rsplit(')').next().expect("a name in parentheses").split_whitespace();
    // utime and stime, in hundredths of a second.
    let ticks: u64 = fields.skip(11).take(2).map(|field| field.parse::<u64>().expect("a number")).sum();
    Duration::from_millis(10 * ticks)
}

/// Begins the peak of the resident memory anew.
fn forget_peak() {
    std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
}

/// Peak of the resident memory of this process \[bytes\].
fn peak() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
    1024.0 * line.split_whitespace().next().expect("a number").parse::<f64>().expect("a number")
}
