//! Real processes on one file, some of them killed at work: nothing is lost, nothing is done twice.
//!
//! This target has no test harness, so that the program can start itself as its own workers.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking and tells what it saw"
)]

use std::collections::BTreeSet;
use std::env;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use drillsweep_store::{
    BlobId, CachePolicy, NewArtifact, NewPoint, NewResult, NewSweep, NewVerification, Renewal, Role, Store,
    StoreConfig, SubmitOutcome, WorkState,
};

const POINTS: i64 = 1_000;
/// Rounds in which every worker is killed; one without follows.
const ROUNDS: usize = 3;
const LEASE_MS: i64 = 60_000;

const KILLED: &str = "killed_workers_lose_and_double_nothing";
const TESTS: [&str; 2] = [KILLED, "processes_may_open_a_new_file_at_once"];

/// Set for the processes that work; it names their directory.
const DIRECTORY: &str = "DRILLSWEEP_TEST_DIRECTORY";
const CLOCK: &str = "DRILLSWEEP_TEST_CLOCK";
const NAME: &str = "DRILLSWEEP_TEST_NAME";
const HANG: &str = "DRILLSWEEP_TEST_HANG";

/// Line that a worker prints when it waits to be killed.
const HANGS: &str = "hangs";

fn main() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    if let Ok(directory) = env::var(DIRECTORY) {
        let clock = env::var(CLOCK).unwrap().parse().unwrap();
        runtime.block_on(work(Path::new(&directory), clock, &env::var(NAME).unwrap()));
        return;
    }
    // As much of the usual harness as its runners ask for: a list of names, and a choice among them.
    let arguments: Vec<String> = env::args().skip(1).collect();
    let has = |flag: &str| arguments.iter().any(|argument| argument == flag);
    let names: Vec<&String> = arguments.iter().filter(|argument| !argument.starts_with("--")).collect();
    for name in TESTS {
        if has("--list") {
            if !has("--ignored") {
                println!("{name}: test");
            }
        } else if names.is_empty() || names.iter().any(|part| name.contains(part.as_str())) {
            match name {
                KILLED => runtime.block_on(killed_workers_lose_and_double_nothing()),
                _ => runtime.block_on(processes_may_open_a_new_file_at_once()),
            }
            println!("test {name} ... ok");
        }
    }
}

async fn open(directory: &Path, clock_offset_ms: i64) -> Store {
    let mut config = StoreConfig::in_directory(directory, Role::Worker);
    config.clock_offset_ms = clock_offset_ms;
    Store::open(&config).await.unwrap()
}

/// A worker: claims and finishes until nothing is ready, and tells of every result that was taken.
async fn work(directory: &Path, clock: i64, name: &str) {
    let store = open(directory, clock).await;
    let (hang, hang_at) = match env::var(HANG).unwrap().split_once(' ') {
        Some((step, count)) => (step.to_owned(), count.parse().unwrap()),
        None => (String::new(), 0),
    };
    for count in 1.. {
        let Some(claim) = store.claim(name, 1, LEASE_MS).await.unwrap() else { break };
        if hang == "claimed" && count == hang_at {
            hang_until_killed();
        }
        let content = claim.scenario.changes_json.as_bytes().to_vec();
        let reserved = store.reserve(&claim.lease, LEASE_MS, &[BlobId::of(&content)]).await.unwrap();
        assert_eq!(reserved, Renewal::Held);
        let artifact = NewArtifact {
            name: "history".to_owned(),
            media_type: "application/octet-stream".to_owned(),
            bytes: content.len() as i64,
            row_count: 1,
            blob: store.blobs().put(content).await.unwrap(),
        };
        if hang == "stored" && count == hang_at {
            hang_until_killed();
        }
        let artifacts = &[artifact];
        let result = NewResult { summary_json: "{}", provenance_json: "{}", artifacts, is_repeatable: true };
        assert!(store.finish_done(&claim.lease, &result).await.unwrap());
        tell(&claim.scenario.changes_json);
    }
}

fn hang_until_killed() {
    tell(HANGS);
    loop {
        std::thread::park();
    }
}

fn tell(line: &str) {
    let mut output = std::io::stdout();
    writeln!(output, "{line}").unwrap();
    output.flush().unwrap();
}

/// Moment at which a worker is killed.
#[derive(Clone, Copy)]
enum Kill {
    /// Never: it ends by itself.
    Never,
    /// After it has reported this many points, wherever it then is.
    AfterTelling(usize),
    /// At its n-th point, after the step of this name.
    At(&'static str, usize),
}

fn start(directory: &Path, clock: i64, name: &str, kill: Kill) -> Child {
    let hang = match kill {
        Kill::At(step, count) => format!("{step} {count}"),
        Kill::Never | Kill::AfterTelling(_) => String::new(),
    };
    Command::new(env::current_exe().unwrap())
        .env(DIRECTORY, directory)
        .env(CLOCK, clock.to_string())
        .env(NAME, name)
        .env(HANG, hang)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Output and end of a worker.
#[derive(Default)]
struct Heard {
    told: Vec<String>,
    was_killed: bool,
    hung: bool,
}

/// Listens to a worker until it ends, or kills it as planned.
fn listen(mut worker: Child, kill: Kill) -> Heard {
    let mut heard = Heard::default();
    let mut output = BufReader::new(worker.stdout.take().unwrap());
    let mut line = String::new();
    while output.read_line(&mut line).unwrap() > 0 {
        if line.trim_end() == HANGS {
            heard.hung = true;
            worker.kill().unwrap();
        } else if line.ends_with('\n') {
            heard.told.push(line.trim_end().to_owned());
        }
        if matches!(kill, Kill::AfterTelling(lines) if heard.told.len() == lines) {
            worker.kill().unwrap();
        }
        line.clear();
    }
    let status = worker.wait().unwrap();
    heard.was_killed = status.code().is_none();
    assert!(status.success() || heard.was_killed, "a worker failed: {status}");
    heard
}

async fn killed_workers_lose_and_double_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let store = open(directory.path(), 0).await;
    let points = (1..=POINTS).map(|ordinal| NewPoint {
        ordinal,
        parameters_json: "{}".to_owned(),
        work_key: key(ordinal),
        fuller_key: None,
        changes_json: ordinal.to_string(),
    });
    let sweep = NewSweep {
        id: "s".to_owned(),
        name: None,
        owner: "anne".to_owned(),
        request_json: "{}".to_owned(),
        priority: 0,
        varied_json: r#"["flow_rate"]"#.to_owned(),
        tags_json: "[]".to_owned(),
        cache: CachePolicy::Reuse,
        idempotency_key: None,
        base_json: "{}".to_owned(),
        physics_version: 1,
        points: points.collect(),
        verification: NewVerification::default(),
    };
    assert_eq!(store.submit_sweep(&sweep).await.unwrap(), SubmitOutcome::Created);

    let mut told: Vec<String> = Vec::new();
    let (mut killed, mut hung) = (0, 0);
    for round in 0..=ROUNDS {
        // In each round the leases of those who were killed in the last one have run out.
        let clock = round as i64 * 2 * LEASE_MS;
        // A point that was under way at a kill comes first in the next round, and nobody is killed before its tenth
        // point: so no point is under way at three kills, which would end it.
        let plans = if round == ROUNDS {
            [Kill::Never; 4]
        } else {
            [
                Kill::AfterTelling(20 + round),
                Kill::AfterTelling(30 + round),
                Kill::At("claimed", 10 + round),
                Kill::At("stored", 15 + round),
            ]
        };
        let listeners: Vec<_> = plans
            .into_iter()
            .enumerate()
            .map(|(worker, kill)| {
                let child = start(directory.path(), clock, &format!("{round} {worker}"), kill);
                std::thread::spawn(move || listen(child, kill))
            })
            .collect();
        for listener in listeners {
            let heard = listener.join().unwrap();
            told.extend(heard.told);
            killed += i64::from(heard.was_killed);
            hung += i64::from(heard.hung);
        }
    }

    let record = store.sweep("s").await.unwrap().unwrap();
    assert_eq!((record.counts.done, record.finished.is_some()), (POINTS, true));
    let distinct: BTreeSet<_> = told.iter().collect();
    assert_eq!(distinct.len(), told.len(), "no result was taken twice");
    let mut attempts = 0;
    for point in store.points("s", &[], 0, POINTS).await.unwrap() {
        assert_eq!(point.state, WorkState::Done);
        attempts += point.attempts;
        let artifacts = store.artifacts(&point.work_key).await.unwrap();
        let blob = store.blobs().get(artifacts[0].blob.parse().unwrap()).await.unwrap();
        assert_eq!(blob, point.ordinal.to_string().as_bytes(), "every row's blob is whole");
    }
    println!("{killed} kills, {hung} of them at a known step; {attempts} attempts, {} told", told.len());
    assert_eq!(hung, 2 * ROUNDS as i64);
    // A point is begun again for every worker that was killed at it, and for no other reason. The kills at an unknown
    // step may fall between two points, or between a result and the telling of it.
    assert!((POINTS + hung..=POINTS + killed).contains(&attempts));
    assert!((POINTS - (killed - hung)..=POINTS).contains(&(told.len() as i64)));
}

async fn processes_may_open_a_new_file_at_once() {
    for _ in 0..5 {
        let directory = tempfile::tempdir().unwrap();
        let path: PathBuf = directory.path().join("new");
        let children: Vec<_> =
            (0..8).map(|number| start(&path, 0, &number.to_string(), Kill::Never)).collect();
        for child in children {
            assert!(listen(child, Kill::Never).told.is_empty());
        }
        assert_eq!(open(&path, 0).await.queue_depths().await.unwrap(), Default::default());
    }
}

fn key(ordinal: i64) -> [u8; 32] {
    let mut key = [7; 32];
    key[..8].copy_from_slice(&ordinal.to_be_bytes());
    key
}
