//! The engine for many machines: a PostgreSQL server, and a directory of objects.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::task::Poll;

use drillsweep_store::{
    NewSweep, Renewal, Role, Store, StoreConfig, StoreError, WorkKey, WorkState, WorkerRecord, with_backoff,
};
use sqlx::AssertSqlSafe;
use sqlx::postgres::PgPool;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt, copy_bidirectional};
use tokio::net::{TcpListener, TcpStream};

use crate::bench::{
    Engine, LEASE_MS, PHYSICS, claim, claim_or_none, finish, finish_and_claim, submit, sweep, sweep_record,
};
use crate::place::{Directory, Object, Place};
use crate::servers::postgres::Server;

/// A server with nothing in it, and a place for the objects.
pub(crate) struct Postgres<P = Directory> {
    server: Server,
    temporary: TempDir,
    place: P,
}

impl<P> Postgres<P> {
    /// The database past the store.
    pub(crate) async fn database(&self) -> PgPool {
        PgPool::connect(&self.server.url()).await.unwrap()
    }
}

impl<P: Place> Engine for Postgres<P> {
    fn new() -> Self {
        Postgres { server: Server::start(), temporary: TempDir::new().unwrap(), place: P::new() }
    }

    fn config(&self, role: Role, clock_offset_ms: i64) -> StoreConfig {
        let mut config = StoreConfig::in_directory(self.temporary.path(), role);
        config.database = self.server.url().parse().unwrap();
        config.objects = self.place.location();
        config.clock_offset_ms = clock_offset_ms;
        config
    }

    fn objects(&self) -> Vec<Object> {
        self.place.objects()
    }

    fn write_object(&self, name: &str, content: &[u8]) {
        self.place.write_object(name, content);
    }

    fn delete_object(&self, name: &str) {
        self.place.delete_object(name);
    }

    fn database_holds(&self, bytes: &[u8]) -> bool {
        holds(&self.server.data(), bytes)
    }
}

/// True if a file in a directory or below has these bytes.
fn holds(directory: &Path, bytes: &[u8]) -> bool {
    std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).any(|path| {
        if path.is_dir() {
            return holds(&path, bytes);
        }
        // The server deletes files whenever it likes.
        std::fs::read(&path).is_ok_and(|file| file.windows(bytes.len()).any(|window| window == bytes))
    })
}

async fn insert_work(database: &PgPool, key: &str, state: &str) -> sqlx::Result<()> {
    let statement =
        "INSERT INTO work (key, physics_version, owner, state, priority, vtime, ready_at, created, changed)
                     VALUES (convert_to($1, 'UTF8'), 1, 'anne', $2, 0, 0, 0, 0, 0)";
    sqlx::query(statement).bind(key).bind(state).execute(database).await.map(drop)
}

#[tokio::test]
async fn the_schema_has_the_states_stages_and_transitions_of_work() {
    let engine = <Postgres>::new();
    engine.open().await.close().await;
    let database = engine.database().await;
    for other in ["", "running", "Queued"] {
        assert!(insert_work(&database, other, other).await.is_err(), "{other:?}");
    }
    for from in WorkState::ALL {
        insert_work(&database, from.as_str(), from.as_str()).await.unwrap();
        let (stage, is_open): (String, bool) =
            sqlx::query_as("SELECT stage, is_open FROM work WHERE state = $1")
                .bind(from.as_str())
                .fetch_one(&database)
                .await
                .unwrap();
        assert_eq!(stage, from.stage().as_str(), "{from:?}");
        assert_eq!(is_open, from.stage().is_open(), "{from:?}");
    }
    for from in WorkState::ALL {
        for to in WorkState::ALL {
            let key = format!("{} to {}", from.as_str(), to.as_str());
            insert_work(&database, &key, from.as_str()).await.unwrap();
            let changed = sqlx::query("UPDATE work SET state = $2 WHERE key = convert_to($1, 'UTF8')")
                .bind(&key)
                .bind(to.as_str())
                .execute(&database)
                .await;
            assert_eq!(changed.is_ok(), from == to || from.may_become(to), "{key}");
        }
    }
}

#[tokio::test]
async fn sweeps_of_an_earlier_schema_get_the_names_of_their_parameters() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    let requests = [
        ("grid", r#"{"axes":{"mud_density":{"values":[1]},"flow_rate":{"from":0,"to":1,"count":2}}}"#),
        (
            "list",
            r#"{"design":"list","points":[{"mud_density":1,"duration":2},{"mud_density":2,"duration":3}]}"#,
        ),
        ("point", r#"{"preset":"paper-200m"}"#),
    ];
    for (id, request) in requests {
        submit(&store, &NewSweep { request_json: request.to_owned(), ..sweep(id, [1]) }).await;
    }
    store.close().await;
    let database = engine.database().await;
    for change in ["ALTER TABLE sweep DROP COLUMN varied", "DELETE FROM _sqlx_migrations WHERE version = 2"] {
        sqlx::query(change).execute(&database).await.unwrap();
    }
    database.close().await;

    let store = engine.open().await;
    for (id, names) in [
        ("grid", vec!["mud_density", "flow_rate"]),
        ("list", vec!["mud_density", "duration"]),
        ("point", vec![]),
    ] {
        let varied: Vec<String> = serde_json::from_str(&sweep_record(&store, id).await.varied_json).unwrap();
        assert_eq!(varied, names, "{id}");
    }
}

#[tokio::test]
async fn a_database_with_another_schema_is_refused() {
    for change in [
        "UPDATE _sqlx_migrations SET checksum = ''",
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
         VALUES (999, 'of a later build', true, '', 0)",
    ] {
        let engine = <Postgres>::new();
        engine.open().await.close().await;
        engine.open().await.close().await;
        sqlx::query(change).execute(&engine.database().await).await.unwrap();
        let opened = Store::open(&engine.config(Role::Worker, 0)).await;
        let Err(error @ StoreError::OtherSchema(_)) = opened else { panic!("{change}: {opened:?}") };
        assert!(!error.is_busy() && error.to_string().contains("start with a new database"), "{error}");
    }
}

#[tokio::test]
async fn waiting_processes_are_notified_of_work_and_changes_of_others() {
    let engine = <Postgres>::new();
    let (waiting, other) = (engine.open().await, engine.open().await);
    let (mut work, mut sweeps) = (waiting.work_changes().await, waiting.sweep_changes().await);
    // Nobody looks by himself within this time: what ends the wait is that somebody tells.
    let look = std::time::Duration::from_secs(36_000);
    let mut heard = Box::pin(async { tokio::join!(work.wait(look), sweeps.wait(look)) });
    let mut number = 0;
    // Again and again, for it takes a moment until somebody listens.
    while tokio::time::timeout(std::time::Duration::from_millis(100), &mut heard).await.is_err() {
        number += 1;
        assert!(number < 300, "nobody heard of anything");
        submit(&other, &sweep(&format!("s{number}"), [number])).await;
        claim(&other, "w").await;
    }
    drop(heard);
    waiting.close().await;
}

#[tokio::test]
async fn a_worker_of_its_own_role_does_its_work_and_nothing_else() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/postgres/worker-role.sql");
    for _ in 0..2 {
        engine.server.run_script(&std::fs::read_to_string(script).unwrap(), &[("role", "drillsweep_worker")]);
    }
    engine.server.query("CREATE USER rig IN ROLE drillsweep_worker");
    let mut config = engine.config(Role::Worker, 0);
    let url = engine.server.url().replace("//drillsweep@", "//rig@");
    config.database = url.parse().unwrap();
    let worker = Store::open(&config).await.unwrap();

    submit(&store, &sweep("s", 0..4)).await;
    worker.register_worker(&record("rig")).await.unwrap();
    worker.keep_machine_speed("rig", PHYSICS, "{}").await.unwrap();
    let finished = finish_and_claim(&worker, &claim(&worker, "rig").await).await;
    assert!(finished.is_stored);
    let suspended = finished.next.expect("another one is ready").lease;
    assert_eq!(worker.renew(&suspended, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
    let blob = worker.put_blob(b"half of it".to_vec()).await.unwrap();
    assert!(worker.keep_checkpoint(&suspended, blob).await.unwrap());
    assert!(worker.note_worker(&suspended, "was nearly full").await.unwrap());
    assert!(worker.release(&suspended).await.unwrap());
    assert!(worker.finish_failed(&claim(&worker, "rig").await.lease, "{}").await.unwrap());
    assert!(worker.retry_later(&claim(&worker, "rig").await.lease, "{}").await.unwrap());
    assert!(worker.crashed(&claim(&worker, "rig").await.lease, "{}").await.unwrap());
    worker.remove_worker("rig").await.unwrap();
    let counts = sweep_record(&store, "s").await.counts;
    assert_eq!((counts.done, counts.failed, counts.queued), (1, 1, 2), "the sweep hears of all of it");

    let past_the_store = PgPool::connect(&url).await.unwrap();
    for forbidden in [
        "SELECT hash FROM token",
        "SELECT request FROM sweep",
        "UPDATE sweep SET priority = 9",
        "DELETE FROM point",
        "INSERT INTO work (key, physics_version, owner, state, priority, vtime, ready_at, created, changed)
         VALUES ('', 1, '', 'queued', 0, 0, 0, 0, 0)",
        "UPDATE work SET owner = 'bert'",
        "UPDATE owner_turn SET vtime = 0",
        "DELETE FROM work",
        "UPDATE artifact SET blob = ''",
        "CREATE TABLE mine (number int)",
    ] {
        let refused = sqlx::query(forbidden).execute(&past_the_store).await.unwrap_err();
        let code = refused.as_database_error().and_then(|error| error.code().map(|code| code.into_owned()));
        assert_eq!(code.as_deref(), Some("42501"), "{forbidden}: {refused}");
    }
    assert!(worker.cancel_sweep("s").await.is_err());
}

#[tokio::test]
async fn changes_lost_by_a_failover_are_repeated_once() {
    let mut engine = <Postgres>::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 0..4)).await;
    let before = claim(&store, "old").await;
    let copy = engine.server.copy();
    // All that follows was confirmed, and will not have happened.
    assert!(finish(&store, &before).await);
    let after = claim(&store, "old").await;
    assert!(finish(&store, &after).await);
    let running = claim(&store, "old").await;
    store.close().await;
    engine.server.fail_over(&copy);

    let store = engine.open().await;
    assert_eq!(sweep_record(&store, "s").await.counts.done, 0);
    // The old worker still works on a point that it does not have, as far as anybody knows.
    assert_eq!(store.renew(&running.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Lost);
    let mut keys = Vec::new();
    while let Some(claim) = claim_or_none(&store, "new").await {
        assert!(!finish(&store, &running).await, "not the old worker's, under whichever number");
        assert!(finish(&store, &claim).await);
        keys.push(claim.lease.key);
    }
    assert!(keys.contains(&after.lease.key) && keys.contains(&running.lease.key) && keys.len() == 3);
    // The first one is the old worker's until its lease ends: it may store it again, or somebody else does.
    assert!(finish(&store, &before).await);
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.done, record.finished.is_some()), (4, true));
    let report = store.check().await.unwrap();
    assert_eq!((report.results, report.problems), (4, vec![]));
}

fn record(id: &str) -> WorkerRecord {
    WorkerRecord {
        id: id.to_owned(),
        host: "rig".to_owned(),
        process: 42,
        version: "0.1.0".to_owned(),
        physics_version: PHYSICS,
        started: 0,
        last_seen: 0,
    }
}

/// A table's columns: name, type, whether it may be absent.
type Columns = Vec<(String, String, bool)>;

/// Claims a point as a worker does that dies before it has applied what follows from that.
pub(crate) async fn claim_and_die(database: &PgPool) {
    let claimed = sqlx::query("SELECT key FROM claim_work('dead', $1, $2)").bind(LEASE_MS).bind(PHYSICS);
    assert_eq!(claimed.fetch_all(database).await.unwrap().len(), 1);
}

async fn pending(database: &PgPool) -> i64 {
    sqlx::query_scalar("SELECT count(*) FROM transition").fetch_one(database).await.unwrap()
}

#[tokio::test]
async fn the_next_process_completes_the_changes_of_a_dead_one() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    let database = engine.database().await;
    submit(&store, &sweep("s", 0..6)).await;
    for round in 1..=4 {
        claim_and_die(&database).await;
        assert_eq!(pending(&database).await, 1);
        // A process looks for it with its first reading, and later every second.
        let reader = engine.open().await;
        match round {
            1 => assert_eq!(sweep_record(&reader, "s").await.counts.running, 1),
            2 => assert_eq!(reader.events("s", 0, 100).await.unwrap().len(), 2),
            3 => drop(claim(&store, "w").await),
            // Cancelling goes by the counts and the versions.
            _ => assert!(store.cancel_sweep("s").await.unwrap()),
        }
        assert_eq!(pending(&database).await, 0, "round {round}");
    }
    let events = store.events("s", 0, 100).await.unwrap();
    let number = |state| events.iter().filter(|event| event.state == state).count();
    // Running ones are requested to stop.
    assert_eq!((number(WorkState::Leased), number(WorkState::Cancelled), events.len()), (5 + 5, 1, 11));
    assert!(events.is_sorted_by_key(|event| event.seq));
    let counts = sweep_record(&store, "s").await.counts;
    assert_eq!((counts.running, counts.cancelled), (5, 1));
}

/// Number of connections of stores that have had a request since a moment, by the database's clock.
async fn asked_since(database: &PgPool, moment: &str) -> i64 {
    let count = "SELECT count(*) FROM pg_stat_activity
                 WHERE application_name = 'drillsweep' AND query_start > $1::text::timestamptz";
    sqlx::query_scalar(count).bind(moment).fetch_one(database).await.unwrap()
}

#[tokio::test]
async fn a_worker_has_one_connection_for_statements_that_follow_each_other() {
    let engine = <Postgres>::new();
    let server = engine.open().await;
    let database = engine.database().await;
    submit(&server, &sweep("s", 0..10)).await;
    let store = Store::open(&engine.config(Role::Worker, 0)).await.unwrap();
    let mut next = Some(claim(&store, "w").await);
    let now: String =
        sqlx::query_scalar("SELECT clock_timestamp()::text").fetch_one(&database).await.unwrap();
    while let Some(claim) = next {
        assert_eq!(store.renew(&claim.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
        next = finish_and_claim(&store, &claim).await.next;
    }
    assert_eq!(asked_since(&database, &now).await, 1);
    assert_eq!(sweep_record(&server, "s").await.counts.done, 10);
}

/// Result of a call; none if it has waited so often before, and is dropped at its next wait.
async fn dropped_at<T>(wait: u32, call: impl Future<Output = T>) -> Option<T> {
    let mut call = std::pin::pin!(call);
    let mut waits = 0;
    std::future::poll_fn(|context| match call.as_mut().poll(context) {
        Poll::Ready(answer) => Poll::Ready(Some(answer)),
        Poll::Pending if waits == wait => Poll::Ready(None),
        Poll::Pending => {
            waits += 1;
            Poll::Pending
        }
    })
    .await
}

#[tokio::test]
async fn a_call_that_is_dropped_leaves_nothing_to_the_next_one() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 0..4)).await;
    let of_s = sweep_record(&store, "s").await;
    let mut dropped = 0;
    for wait in 0_u32..40 {
        // Its rows are no answer to who asks next.
        if let Some(points) = dropped_at(wait, store.points("s", &[], 0, 10)).await {
            assert_eq!(points.unwrap().len(), 4);
        }
        assert_eq!(sweep_record(&store, "s").await.version, of_s.version);
        // Its transaction is over, and done or undone as a whole.
        let two = sweep(&format!("two {wait}"), [1_000 + 2 * wait, 1_001 + 2 * wait]);
        dropped += u32::from(dropped_at(wait, store.submit_sweep(&two)).await.is_none());
        submit(&store, &sweep(&format!("one {wait}"), [2_000 + wait])).await;
        if let Some(stored) = store.sweep(&two.id).await.unwrap() {
            assert_eq!(stored.counts.total, 2, "{}", two.id);
        }
    }
    assert!(dropped > 3, "{dropped}");
}

#[tokio::test]
async fn pending_changes_of_a_dump_are_applied_after_restoring() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    let database = engine.database().await;
    submit(&store, &sweep("s", 0..4)).await;
    claim_and_die(&database).await;
    // Restoring a dump counts transactions from the beginning: all that it names seem to be still to come.
    sqlx::raw_sql(
        "UPDATE transition SET transaction = '4000000000'; UPDATE transitions_applied SET up_to = '4000000000'",
    )
    .execute(&database)
    .await
    .unwrap();
    assert_eq!(sweep_record(&engine.open().await, "s").await.counts.running, 1);
    claim_and_die(&database).await;
    assert_eq!(sweep_record(&engine.open().await, "s").await.counts.running, 2);
}

#[tokio::test]
async fn many_workers_leave_nothing_pending_and_report_every_change_once_in_order() {
    const POINTS: u32 = 400;
    let engine = <Postgres>::new();
    let store = engine.open().await;
    let database = engine.database().await;
    // Each point is one of both.
    submit(&store, &sweep("s", 0..POINTS)).await;
    submit(&store, &sweep("t", (0..POINTS).rev())).await;
    let mut workers = tokio::task::JoinSet::new();
    for number in 0..8 {
        let worker = Store::open(&engine.config(Role::Worker, 0)).await.unwrap();
        workers.spawn(async move {
            let name = format!("worker {number}");
            let mut next = claim_or_none(&worker, &name).await;
            while let Some(claim) = next.take() {
                // Some are given back once.
                if claim.lease.key[3] % 5 == 0 && claim.lease.fencing_token == 1 {
                    assert!(worker.release(&claim.lease).await.unwrap());
                } else if number % 2 == 0 {
                    assert!(finish(&worker, &claim).await);
                } else {
                    let finished = finish_and_claim(&worker, &claim).await;
                    assert!(finished.is_stored);
                    next = finished.next;
                }
                if next.is_none() {
                    next = claim_or_none(&worker, &name).await;
                }
            }
        });
    }
    workers.join_all().await;
    assert_eq!(pending(&database).await, 0, "all workers have returned");

    for id in ["s", "t"] {
        let record = sweep_record(&store, id).await;
        assert_eq!((record.counts.done, record.finished.is_some()), (i64::from(POINTS), true));
        let events = store.events(id, 0, 10_000).await.unwrap();
        let mut histories: BTreeMap<WorkKey, Vec<WorkState>> = BTreeMap::new();
        for event in &events {
            histories.entry(event.work_key).or_default().push(event.state);
        }
        assert_eq!(histories.len(), POINTS as usize);
        for (key, history) in &histories {
            let expected: &[WorkState] = match key[3] % 5 {
                0 => &[WorkState::Leased, WorkState::Queued, WorkState::Leased, WorkState::Done],
                _ => &[WorkState::Leased, WorkState::Done],
            };
            assert_eq!(history, expected, "{id}: {key:?}");
        }
        // Their numbers have no gap, and the end has one of its own.
        let first = events[0].seq;
        assert!((first..).zip(&events).all(|(seq, event)| event.seq == seq));
        assert_eq!(record.version, first + events.len() as i64);
        assert_eq!(record.finished, events.last().map(|event| event.at), "{id}");
    }
    store.close().await;
}

#[tokio::test]
async fn one_of_many_processes_expires_leases() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 0..8)).await;
    let database = engine.database().await;
    let begin = async || -> bool {
        // Nothing takes an hour here.
        sqlx::query_scalar("SELECT begin_to_look(3600000)").fetch_one(&database).await.unwrap()
    };
    let set_back = async |hours: i64| {
        let change = "UPDATE expiry_look SET at = at - $1 * 3600000";
        assert_eq!(sqlx::query(change).bind(hours).execute(&database).await.unwrap().rows_affected(), 1);
    };
    let lost = claim(&store, "lost").await;
    assert!(!begin().await, "who claims has looked");
    set_back(2).await;
    assert!(begin().await);
    assert!(!begin().await);
    // The clock is set back.
    set_back(-2).await;
    assert!(begin().await);
    // While somebody begins to, nobody waits for it.
    set_back(2).await;
    let mut beginning = database.begin_with("BEGIN").await.unwrap();
    let begun: bool =
        sqlx::query_scalar("SELECT begin_to_look(3600000)").fetch_one(&mut *beginning).await.unwrap();
    assert!(begun && !begin().await);
    beginning.commit().await.unwrap();

    let later = engine.after(LEASE_MS + 1).await;
    assert_eq!(claim(&later, "w").await.lease.key, lost.lease.key, "somebody looks when it is time");
}

#[tokio::test]
async fn blobs_named_by_rows_exist_and_stay() {
    let engine = <Postgres>::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 0..3)).await;
    submit(&store, &sweep("t", 0..2)).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let database = engine.database().await;
    let refused = [
        "INSERT INTO point (sweep_id, verifies, ordinal, parameters, work_key)
         SELECT 's', false, 7, '{}', '\\x00'",
        "INSERT INTO point (sweep_id, verifies, ordinal, parameters, work_key)
         SELECT 'none', false, 7, '{}', key FROM work LIMIT 1",
        "INSERT INTO work (key, physics_version, owner, state, priority, vtime, ready_at, created, changed, base)
         VALUES ('\\x00', 1, 'anne', 'queued', 0, 0, 0, 0, 0, '\\x00')",
        "UPDATE point SET work_key = '\\x00'",
        "UPDATE point SET sweep_id = 'none'",
        "UPDATE work SET base = '\\x00'",
        "UPDATE work SET key = '\\x00'",
        "UPDATE sweep SET id = 'none' WHERE id = 's'",
        "UPDATE scenario SET hash = '\\x00'",
        "UPDATE event SET sweep_id = 'none'",
        "DELETE FROM work WHERE state = 'queued'",
        "DELETE FROM scenario",
        "INSERT INTO result (work_key, summary, provenance, created) VALUES ('\\x00', '{}', '{}', 0)",
    ];
    for statement in refused {
        let error = sqlx::query(statement).execute(&database).await.unwrap_err();
        let code = error.as_database_error().and_then(|error| error.code().map(|code| code.into_owned()));
        assert_eq!(code.as_deref(), Some("23503"), "{statement}: {error}");
    }
    // A sweep takes its points and events along, and nobody else's.
    sqlx::query("DELETE FROM sweep WHERE id = 's'").execute(&database).await.unwrap();
    for table in ["point", "event"] {
        let count = AssertSqlSafe(format!(
            "SELECT count(*) FILTER (WHERE sweep_id = 's'), count(*) FILTER (WHERE sweep_id = 't') FROM {table}"
        ));
        let (gone, left): (i64, i64) = sqlx::query_as(count).fetch_one(&database).await.unwrap();
        assert_eq!((gone, left), (0, 2), "{table}");
    }
    assert!(store.check().await.unwrap().problems.is_empty());
}

/// Tables that only PostgreSQL needs, with their indexes: SQLite does at once what follows from a change, and leaves nothing of it in an index;
/// and few processes share it.
const OF_POSTGRES: &str = "('expiry_look', 'queue_start', 'transition', 'transitions_applied')";

/// Indexes that only one of them needs: on PostgreSQL each costs with every claim, and the same rows are found by others.
const INDEXES_OF_SQLITE: &str = "('work_by_base', 'work_open', 'work_open_by_version')";
const INDEXES_OF_POSTGRES: &str = "('work_held')";

#[tokio::test]
async fn both_engines_have_the_same_tables_columns_and_indexes() {
    let engine = <Postgres>::new();
    engine.open().await.close().await;
    let postgres = engine.database().await;
    let file = TempDir::new().unwrap();
    Store::open(&StoreConfig::in_directory(file.path(), Role::Server)).await.unwrap().close().await;
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file.path().join("drillsweep.sqlite"));
    let sqlite = sqlx::SqlitePool::connect_with(options).await.unwrap();

    let rows: Vec<(String, String, String, bool)> = sqlx::query_as(
        "SELECT m.name, c.name, c.type, c.\"notnull\" = 0 FROM sqlite_schema m, pragma_table_xinfo(m.name) c
         WHERE m.type = 'table' AND m.name NOT LIKE '\\_sqlx%' ESCAPE '\\' AND m.name NOT LIKE 'sqlite\\_%' ESCAPE '\\'",
    )
    .fetch_all(&sqlite)
    .await
    .unwrap();
    let of_sqlite = tables(rows);
    let rows: Vec<(String, String, String, bool)> = sqlx::query_as(AssertSqlSafe(format!(
        "SELECT table_name::text, column_name::text, data_type::text, is_nullable = 'YES'
         FROM information_schema.columns JOIN information_schema.tables USING (table_schema, table_name)
         WHERE table_schema = 'public' AND table_type = 'BASE TABLE' AND table_name NOT LIKE '\\_sqlx%'
           AND table_name NOT IN {OF_POSTGRES}",
    )))
    .fetch_all(&postgres)
    .await
    .unwrap();
    assert_eq!(tables(rows), of_sqlite);
    assert!(of_sqlite.len() > 10, "{of_sqlite:?}");

    let mut of_sqlite: Vec<(String, String)> = sqlx::query_as(AssertSqlSafe(format!(
        "SELECT tbl_name, name FROM sqlite_schema
         WHERE type = 'index' AND sql IS NOT NULL AND name NOT IN {INDEXES_OF_SQLITE}",
    )))
    .fetch_all(&sqlite)
    .await
    .unwrap();
    let mut of_postgres: Vec<(String, String)> = sqlx::query_as(AssertSqlSafe(format!(
        "SELECT tablename::text, indexname::text FROM pg_indexes
         WHERE schemaname = 'public' AND indexname NOT LIKE '%\\_pkey' AND indexname NOT LIKE '%\\_key'
           AND tablename NOT IN {OF_POSTGRES} AND indexname NOT IN {INDEXES_OF_POSTGRES}",
    )))
    .fetch_all(&postgres)
    .await
    .unwrap();
    of_sqlite.sort();
    of_postgres.sort();
    assert_eq!(of_postgres, of_sqlite);
}

/// Columns by table, their types by what they hold: an engine's own words are not compared. SQLite has no type for yes and no.
fn tables(rows: Vec<(String, String, String, bool)>) -> BTreeMap<String, Columns> {
    let mut tables: BTreeMap<String, Columns> = BTreeMap::new();
    for (table, column, kind, is_nullable) in rows {
        let kind = match kind.to_lowercase().as_str() {
            "integer" | "bigint" | "boolean" => "integer",
            "real" | "double precision" => "real",
            "blob" | "bytea" => "bytes",
            "text" => "text",
            other => panic!("{table}.{column} is of type {other}"),
        };
        tables.entry(table).or_default().push((column, kind.to_owned(), is_nullable));
    }
    tables.values_mut().for_each(|columns| columns.sort());
    tables
}

conformance!(Postgres);

#[tokio::test]
async fn a_server_without_a_process_for_a_connection_is_retried() {
    /// Message that such a server writes without having read anything (`report_fork_failure_to_client` in its source).
    const NO_PROCESS: &[u8] =
        b"Ecould not fork new process for connection: Resource temporarily unavailable\n\0";
    let engine = <Postgres>::new();
    let address = engine.server.address();
    let door = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = engine.server.url().replace(&address, &door.local_addr().unwrap().to_string());
    assert_ne!(url, engine.server.url());
    let turned_away = Arc::new(AtomicU32::new(0));
    tokio::spawn({
        let turned_away = turned_away.clone();
        async move {
            while let Ok((mut client, _)) = door.accept().await {
                if turned_away.load(Ordering::Relaxed) < 2 {
                    turned_away.fetch_add(1, Ordering::Relaxed);
                    // Read, so that closing does not take back what was written.
                    let _ = client.read(&mut [0; 8]).await;
                    let _ = client.write_all(NO_PROCESS).await;
                    continue;
                }
                let mut server = TcpStream::connect(&address).await.unwrap();
                tokio::spawn(async move { copy_bidirectional(&mut client, &mut server).await });
            }
        }
    });
    let mut config = engine.config(Role::Server, 0);
    config.database = url.parse().unwrap();
    let store = with_backoff(|| Store::open(&config)).await.unwrap();
    assert_eq!(turned_away.load(Ordering::Relaxed), 2);
    submit(&store, &sweep("s", [1])).await;
    store.close().await;
}
