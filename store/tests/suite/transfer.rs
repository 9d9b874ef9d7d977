//! Carrying a store over: all of it arrives, on whichever engines, nothing of it is changed, and nothing else is touched.

use std::collections::BTreeMap;

use drillsweep_store::{
    NewArtifact, NewResult, NewSweep, NewToken, ObjectsLocation, Role, SourceUse, Store, SweepChanges,
    SweepFilter, TokenScope, TokenSecret, TransferError, TransferReport, WorkState, transfer,
};
use sqlx::SqlitePool;
use sqlx::sqlite::SqliteConnectOptions;

use crate::bench::{
    Engine, addition, claim, claim_or_none, finish, key, scenario, states, submit, sweep, sweep_record,
    verified,
};
use crate::garbage::{DAY_MS, collect};
use crate::place::Bucket;
use crate::postgres::{Postgres, claim_and_die};
use crate::sqlite::Sqlite;

type Remote = Postgres<Bucket>;
type Local = Sqlite;

/// More than a part of an upload, and no multiple of one.
const LARGE: usize = (20 << 20) + 7;

#[tokio::test]
async fn a_store_goes_to_a_server_and_a_bucket_and_comes_back_as_it_was() {
    let (local, remote, back) = (Local::new(), Remote::new(), Local::new());
    let secret = fill(&local).await;
    let files = files(&local);

    let report = carry(&local, &remote).await.unwrap();
    assert_eq!((report.lost.len(), report.blobs_present, report.released), (0, 0, 0));
    assert_eq!(remote.objects().len() as u64, report.blobs);
    assert_eq!(self::files(&local), files, "what it was read from is untouched");
    let report_back = carry(&remote, &back).await.unwrap();
    assert_eq!(report_back, report);
    assert_eq!(dump(&back).await, dump(&local).await);
    assert_eq!(contents(&back), contents(&local));

    // Whoever goes on at the server finds what was there.
    let [before, after] = [local.open().await, remote.open().await];
    let filter = SweepFilter::default();
    assert_eq!(
        after.sweeps(&filter, None, 100).await.unwrap(),
        before.sweeps(&filter, None, 100).await.unwrap()
    );
    for id in ["expired", "mixed", "shared", "cancelled", "paused"] {
        let [before, after] = [&before, &after].map(async |store: &Store| {
            let points = store.points(id, &[], 0, 100).await.unwrap();
            let runs = store.verifications(id).await.unwrap();
            (
                points,
                runs,
                store.events(id, 0, 1_000).await.unwrap(),
                store.table_rows(id, 0, 100).await.unwrap(),
            )
        });
        assert_eq!(after.await, before.await, "{id}");
    }
    assert_eq!(after.check().await.unwrap().problems, Vec::<String>::new());
    assert!(after.valid_token(&secret).await.unwrap().is_some());
    // The same under the same key is the same sweep; under another one nothing of it is computed.
    let mut again = mixed();
    let same = after.submit_sweep(&again).await.unwrap();
    assert_eq!(same, before.submit_sweep(&again).await.unwrap());
    (again.id, again.idempotency_key) = ("again".to_owned(), None);
    again.points.truncate(2);
    again.verification.runs.clear();
    submit(&after, &again).await;
    let counts = sweep_record(&after, "again").await.counts;
    assert_eq!((counts.done, counts.queued), (2, 0));
    // Its queue is served, in the order that it had.
    let orders = [before, after].map(async |store: Store| {
        let mut order = Vec::new();
        while let Some(claim) = claim_or_none(&store, "w").await {
            assert!(finish(&store, &claim).await);
            order.push((claim.lease.key, claim.lease.fencing_token, claim.checkpoint.is_some()));
        }
        order
    });
    let [before, after] = orders;
    let (before, after) = (before.await, after.await);
    assert!(before.len() > 2 && before.iter().any(|(.., has_checkpoint)| *has_checkpoint), "{before:?}");
    assert_eq!(after, before);
}

#[tokio::test]
async fn a_store_goes_from_file_to_file_and_from_server_to_server() {
    let (local, other) = (Local::new(), Local::new());
    fill(&local).await;
    carry(&local, &other).await.unwrap();
    assert_eq!(dump(&other).await, dump(&local).await);
    let (first, second, back) = (Remote::new(), Remote::new(), Local::new());
    carry(&local, &first).await.unwrap();
    carry(&first, &second).await.unwrap();
    carry(&second, &back).await.unwrap();
    assert_eq!(dump(&back).await, dump(&local).await);
    assert_eq!(contents(&back), contents(&local));
}

#[tokio::test]
async fn consequences_of_a_change_are_carried_after_its_process_died() {
    let (remote, local) = (Remote::new(), Local::new());
    let store = remote.open().await;
    submit(&store, &sweep("s", 0..3)).await;
    claim_and_die(&remote.database().await).await;
    carry_while(&remote, &local, SourceUse::Running).await.unwrap();
    // The lease is given back, and both changes are told.
    let arrived = local.open().await;
    let told: Vec<_> = arrived.events("s", 0, 10).await.unwrap().iter().map(|event| event.state).collect();
    assert_eq!(told, [WorkState::Leased, WorkState::Queued]);
    assert_eq!(sweep_record(&arrived, "s").await.counts.queued, 3);
}

#[tokio::test]
async fn leased_work_is_carried_as_released_with_its_fencing_token() {
    let (local, remote) = (Local::new(), Remote::new());
    let store = local.open().await;
    submit(&store, &sweep("kept", [1])).await;
    submit(&store, &sweep("dropped", [2])).await;
    let [running, stopping] = [claim(&store, "old").await, claim(&store, "old").await];
    assert!(store.cancel_sweep("dropped").await.unwrap());
    assert_eq!(states(&store, "dropped").await, [WorkState::Leased], "until its worker has heard of it");
    let refused = carry(&local, &remote).await.unwrap_err();
    assert!(matches!(refused, TransferError::InUse { leases: 2, workers: 0 }), "{refused}");

    let running_now = carry_while(&local, &remote, SourceUse::Running).await.unwrap();
    assert_eq!(running_now.released, 2);
    let target = remote.open().await;
    assert_eq!(states(&target, "dropped").await, [WorkState::Cancelled]);
    let counts = sweep_record(&target, "kept").await.counts;
    assert_eq!((counts.queued, counts.running), (1, 0));
    let [before, after] = [&store, &target].map(async |store: &Store| {
        let mut events = store.events("kept", 0, 10).await.unwrap();
        events.extend(store.events("dropped", 0, 10).await.unwrap());
        events.into_iter().map(|event| event.state).collect::<Vec<_>>()
    });
    let (before, after) = (before.await, after.await);
    assert_eq!(before, [WorkState::Leased; 3], "the third tells of the cancellation");
    let [leased, queued, cancelled] = [WorkState::Leased, WorkState::Queued, WorkState::Cancelled];
    assert_eq!(after, [leased, queued, leased, leased, cancelled], "who follows them is told");
    assert!(!finish(&target, &running).await && !finish(&target, &stopping).await, "it is nobody's there");
    let next = claim(&target, "new").await;
    assert_eq!(next.lease.fencing_token, running.lease.fencing_token + 1);
    assert!(finish(&target, &next).await);
    assert!(finish(&store, &running).await, "the old store goes on as if nothing had been");
    assert_eq!(target.check().await.unwrap().problems, Vec::<String>::new());
}

#[tokio::test]
async fn a_store_that_is_there_and_the_store_itself_are_not_written_to() {
    let (local, remote, other) = (Local::new(), Remote::new(), Local::new());
    fill(&local).await;
    for (engine, target) in [(&local, local.config(Role::Server, 0)), (&other, local.config(Role::Server, 0))]
    {
        engine.open().await.close().await;
        let before = dump(&local).await;
        let refused = transfer(&engine.config(Role::Server, 0), &target, SourceUse::Idle, &mut |_| {})
            .await
            .unwrap_err();
        assert!(matches!(refused, TransferError::Itself | TransferError::NotEmpty(_)), "{refused}");
        assert_eq!(dump(&local).await, before);
    }
    carry(&local, &remote).await.unwrap();
    let refused = carry(&local, &remote).await.unwrap_err();
    assert!(matches!(refused, TransferError::NotEmpty("scenario")), "{refused}");
    let [itself, config] = [remote.config(Role::Server, 0), remote.config(Role::Worker, 0)];
    let refused = transfer(&itself, &config, SourceUse::Idle, &mut |_| {}).await.unwrap_err();
    assert!(matches!(refused, TransferError::Itself), "{refused}");
}

#[tokio::test]
async fn a_store_of_another_version_is_refused() {
    let (local, remote) = (Local::new(), Remote::new());
    local.open().await.close().await;
    sqlx::query("ALTER TABLE sweep RENAME COLUMN tags TO labels").execute(&past(&local).await).await.unwrap();
    let refused = carry(&local, &remote).await.unwrap_err();
    assert!(matches!(refused, TransferError::OtherSchema("sweep")), "{refused}");
}

#[tokio::test]
async fn lost_blobs_are_named_and_all_else_is_carried_and_not_twice() {
    let (local, remote) = (Local::new(), Remote::new());
    fill(&local).await;
    let store = local.open().await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    store.close().await;
    let objects = local.objects();
    let large = objects.iter().find(|object| object.bytes == LARGE as u64).unwrap().name.clone();
    let mut small = objects.iter().filter(|object| object.bytes == 32).map(|object| object.name.clone());
    let [gone, there, damaged_there] = [(); 3].map(|()| small.next().unwrap());
    let content = |name: &str| contents(&local)[name].clone();
    let mut changed = content(&large);
    changed[LARGE - 3] ^= 1;
    local.write_object(&large, &changed);
    remote.write_object(&there, &content(&there));
    remote.write_object(&damaged_there, b"half");
    local.delete_object(&gone);
    let version = |name: &str| remote.objects().into_iter().find(|object| object.name == name).unwrap();
    let before = version(&there);

    let report = carry(&local, &remote).await.unwrap();
    let (lost, total) = (&report.lost, objects.len() as u64);
    assert_eq!((report.blobs, report.blobs_present, lost.len()), (total, 1, 2), "{lost:?}");
    for name in [&gone, &large] {
        let blob = name.rsplit('/').next().unwrap();
        assert!(lost.iter().any(|text| text.contains(blob)), "{lost:?}");
    }
    assert_eq!(version(&there), before);
    assert_eq!(remote.objects().len() as u64, total - 2, "nothing damaged was written");
    let target = remote.open().await;
    let found = target.check().await.unwrap();
    assert_eq!(found.problems.len(), 2, "{:?}", found.problems);
    assert_eq!(target.repair(&found, 1).await.unwrap().queued, 2);
}

/// Carries one over to another while nobody is at work.
async fn carry(from: &impl Engine, to: &impl Engine) -> Result<TransferReport, TransferError> {
    carry_while(from, to, SourceUse::Idle).await
}

async fn carry_while(
    from: &impl Engine,
    to: &impl Engine,
    source_use: SourceUse,
) -> Result<TransferReport, TransferError> {
    transfer(&from.config(Role::Worker, 0), &to.config(Role::Worker, 0), source_use, &mut |_| {}).await
}

/// A sweep with points in every final and waiting state, and runs that verify some.
fn mixed() -> NewSweep {
    NewSweep {
        name: Some("Überlagerung \"x\", 'y'\n".to_owned()),
        tags_json: r#"["a","ß"]"#.to_owned(),
        idempotency_key: Some(("once".to_owned(), [7; 32])),
        ..verified(sweep("mixed", 1..=8), &[(1, 101), (3, 103)])
    }
}

/// Something of everything that a store may hold, and nobody at work. Gives a token of it.
async fn fill(engine: &Local) -> TokenSecret {
    let store = engine.open().await;
    submit(&store, &sweep("expired", [40])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let later = engine.after(31 * DAY_MS).await;
    assert_eq!(collect(&later).await.artifacts, 1);
    later.close().await;

    submit(&store, &mixed()).await;
    let error = r#"{"class":"physics","reason":"no equilibrium"}"#;
    for number in 1..=2 {
        assert!(finish(&store, &claim(&store, "w").await).await, "{number}");
    }
    assert!(store.finish_failed(&claim(&store, "w").await.lease, error).await.unwrap());
    for _ in 0..3 {
        // A third death is final.
        let lease = claim_of(&store, 4).await;
        assert!(store.crashed(&lease, error).await.unwrap());
    }
    let lease = claim_of(&store, 5).await;
    assert!(store.retry_later(&lease, error).await.unwrap());
    finish_large(&store).await;
    let lease = claim_of(&store, 7).await;
    let checkpoint = store.put_blob(b"half of it".to_vec()).await.unwrap();
    assert!(store.keep_checkpoint(&lease, checkpoint).await.unwrap());
    assert!(store.note_worker(&lease, "was nearly full").await.unwrap());
    assert!(store.release(&lease).await.unwrap());

    submit(&store, &NewSweep { owner: "bert".to_owned(), priority: 3, ..sweep("shared", [2, 2, 20]) }).await;
    submit(&store, &sweep("cancelled", 21..=22)).await;
    assert!(store.cancel_sweep("cancelled").await.unwrap());
    submit(&store, &sweep("paused", 23..=24)).await;
    assert!(store.pause_sweep("paused", true).await.unwrap());
    let added = sweep("paused", [0, 0, 25]).points;
    let base = scenario("paused", 0).base_json;
    store.append_points("paused", &addition(&base, &added[2..], "{}"), 1_000).await.unwrap();
    let pin = SweepChanges { is_pinned: Some(true), ..SweepChanges::default() };
    store.change_sweep("expired", &pin, None).await.unwrap();
    let secret = TokenSecret::generate().unwrap();
    let token = NewToken {
        secret: &secret,
        owner: "anne",
        name: None,
        scope: TokenScope::Submit,
        lifetime_ms: Some(DAY_MS),
    };
    store.create_token(&token).await.unwrap();
    store.keep_machine_speed("rig", 1, "{}").await.unwrap();
    store.close().await;
    // A number that no decimal fraction of a few digits is.
    let progress = "UPDATE work SET progress = 0.1 + 0.2 WHERE state = 'done'";
    let database = past(engine).await;
    sqlx::query(progress).execute(&database).await.unwrap();
    database.close().await;
    secret
}

/// Claims a certain work item, which is the next one.
async fn claim_of(store: &Store, number: u32) -> drillsweep_store::Lease {
    let claim = claim(store, "w").await;
    assert_eq!(claim.lease.key, key(number), "the order of the queue");
    claim.lease
}

/// Finishes the next work item with a table that is not copied in one piece.
async fn finish_large(store: &Store) {
    let lease = claim_of(store, 6).await;
    let content: Vec<u8> = (0..LARGE as u64).map(|at| ((at * at) >> 7) as u8).collect();
    let artifact = NewArtifact {
        name: "history".to_owned(),
        media_type: "application/vnd.apache.parquet".to_owned(),
        blob: store.put_blob(content).await.unwrap(),
        bytes: LARGE as i64,
        row_count: 1,
    };
    let result =
        NewResult { summary_json: "{}", provenance_json: "{}", artifacts: &[artifact], is_repeatable: true };
    assert!(store.finish_done(&lease, &result).await.unwrap());
}

/// The database past the store.
async fn past(engine: &Local) -> SqlitePool {
    let file = engine.directory().join("drillsweep.sqlite");
    SqlitePool::connect_with(SqliteConnectOptions::new().filename(file)).await.unwrap()
}

/// All rows of all tables but of those that tell who is at work and who has logged in, as SQLite writes their values.
async fn dump(engine: &Local) -> BTreeMap<String, Vec<String>> {
    let database = past(engine).await;
    let tables: Vec<(String, String)> = sqlx::query_as(
        "SELECT m.name, group_concat('quote(' || c.name || ')', ' || '','' || ')
         FROM sqlite_schema m, pragma_table_info(m.name) c
         WHERE m.type = 'table' AND m.name NOT LIKE '\\_sqlx%' ESCAPE '\\' AND m.name NOT LIKE 'sqlite\\_%' ESCAPE '\\'
           AND m.name NOT IN ('worker', 'upload', 'removal', 'session')
         GROUP BY m.name",
    )
    .fetch_all(&database)
    .await
    .unwrap();
    let mut dump = BTreeMap::new();
    for (table, values) in tables {
        let statement = sqlx::AssertSqlSafe(format!("SELECT {values} FROM {table} ORDER BY 1"));
        let rows: Vec<String> = sqlx::query_scalar(statement).fetch_all(&database).await.unwrap();
        assert!(!rows.is_empty(), "{table} has nothing to be carried");
        dump.insert(table, rows);
    }
    database.close().await;
    dump
}

/// The content of every object, by name.
fn contents(engine: &Local) -> BTreeMap<String, Vec<u8>> {
    let ObjectsLocation::Directory(directory) = engine.config(Role::Worker, 0).objects else {
        panic!("objects in a directory")
    };
    let read = |name: &str| std::fs::read(directory.join(name)).unwrap();
    engine.objects().into_iter().map(|object| (object.name.clone(), read(&object.name))).collect()
}

/// All that a store has on the disk, by name.
fn files(engine: &Local) -> BTreeMap<String, Vec<u8>> {
    let mut files = contents(engine);
    for entry in std::fs::read_dir(engine.directory()).unwrap() {
        let path = entry.unwrap().path();
        files.insert(path.display().to_string(), std::fs::read(&path).unwrap());
    }
    files
}
