//! Several threads, each with connections of its own, on one store.

use std::collections::{BTreeSet, HashMap};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};
use std::thread;
use std::time::Duration;

use drillsweep_store::{
    BlobId, Claim, DeleteOutcome, NewArtifact, NewResult, Renewal, RetentionPolicy, Role, Store, StoreConfig,
    SubmitOutcome, WorkKey,
};

use crate::bench::{Engine, LEASE_MS, claim_or_none, finish, json, key, submit, sweep, sweep_record};
use crate::place::object_name;

/// Runs a job on a thread of its own, with its own runtime and its own store.
fn on_a_thread<T: Send + 'static>(
    config: StoreConfig,
    start: &Arc<Barrier>,
    job: impl AsyncFnOnce(Store) -> T + Send + 'static,
) -> thread::JoinHandle<T> {
    let start = start.clone();
    thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        start.wait();
        runtime.block_on(async { job(Store::open(&config).await.unwrap()).await })
    })
}

pub(crate) async fn four_workers_share_a_thousand_points_without_losing_or_doubling_one<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 0..1_000)).await;

    let start = Arc::new(Barrier::new(4));
    let workers: Vec<_> = (0..4)
        .map(|worker| {
            on_a_thread(engine.config(Role::Worker, 0), &start, async move |store| {
                let name = format!("worker {worker}");
                let mut done: Vec<WorkKey> = Vec::new();
                while let Some(claim) = claim_or_none(&store, &name).await {
                    assert_eq!(claim.lease.fencing_token, 1, "nobody else has had it");
                    assert_eq!(store.renew(&claim.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
                    assert!(finish(&store, &claim).await);
                    done.push(claim.lease.key);
                }
                done
            })
        })
        .collect();
    let mut times: HashMap<WorkKey, u32> = HashMap::new();
    for worker in workers {
        for key in worker.join().unwrap() {
            *times.entry(key).or_default() += 1;
        }
    }
    assert!((0..1_000).all(|number| times.get(&key(number)) == Some(&1)), "each point once");
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.done, record.finished.is_some()), (1_000, true));
}

pub(crate) async fn writers_of_every_kind_wait_for_each_other_and_never_find_the_database_locked<
    E: Engine,
>() {
    let engine = E::new();
    let start = Arc::new(Barrier::new(4));
    let mut threads: Vec<thread::JoinHandle<()>> = Vec::new();
    for owner in 0..2_u32 {
        threads.push(on_a_thread(engine.config(Role::Server, 0), &start, async move |store| {
            for round in 0..30 {
                let id = format!("{owner} {round}");
                let first = 1_000 * round;
                // With a key the transaction reads before it writes: what a deferred one fails at.
                let mut sweep = sweep(&id, first..first + 20);
                sweep.idempotency_key = Some((id.clone(), [0; 32]));
                submit(&store, &sweep).await;
                sweep_record(&store, &id).await;
                if round % 3 == 0 {
                    assert!(store.cancel_sweep(&id).await.unwrap());
                    store.retry_sweep(&id).await.unwrap();
                }
            }
        }));
    }
    for worker in 0..2 {
        threads.push(on_a_thread(engine.config(Role::Worker, 0), &start, async move |store| {
            let name = format!("worker {worker}");
            for _ in 0..300 {
                if let Some(claim) = claim_or_none(&store, &name).await {
                    store.renew(&claim.lease, LEASE_MS, 0.5).await.unwrap();
                    assert!(finish(&store, &claim).await);
                }
                store.reap_expired().await.unwrap();
            }
        }));
    }
    for thread in threads {
        thread.join().unwrap();
    }
}

pub(crate) async fn several_may_open_a_new_store_at_once<E: Engine>() {
    for _ in 0..5 {
        let engine = E::new();
        let start = Arc::new(Barrier::new(8));
        let opened: Vec<_> = (0..8)
            .map(|number| {
                let role = if number % 2 == 0 { Role::Server } else { Role::Worker };
                on_a_thread(engine.config(role, 0), &start, async |store| store.queue_depths().await.unwrap())
            })
            .collect();
        for opened in opened {
            assert_eq!(opened.join().unwrap(), drillsweep_store::QueueDepths::default());
        }
    }
}

pub(crate) async fn one_of_several_submissions_with_one_idempotency_key_is_stored<E: Engine>() {
    let engine = E::new();
    let start = Arc::new(Barrier::new(4));
    let outcomes: Vec<_> = (0..4)
        .map(|number| {
            on_a_thread(engine.config(Role::Server, 0), &start, async move |store| {
                let mut sweep = sweep(&format!("s{number}"), 0..50);
                sweep.idempotency_key = Some(("once".to_owned(), [7; 32]));
                store.submit_sweep(&sweep).await.unwrap()
            })
        })
        .collect();
    let outcomes: Vec<_> = outcomes.into_iter().map(|thread| thread.join().unwrap()).collect();
    let winner =
        outcomes.iter().position(|outcome| *outcome == SubmitOutcome::Created).expect("one is stored");
    for (number, outcome) in outcomes.iter().enumerate().filter(|(number, _)| *number != winner) {
        assert_eq!(*outcome, SubmitOutcome::Known(format!("s{winner}")), "submission {number}");
    }
}

/// Points of each sweep that is computed while garbage is collected.
const POINTS: u32 = 80;

/// Contents that all points have in common with others.
const SHARED: u32 = 6;

/// Between two of these sweeps reservations run out, and what no row names by then is garbage.
const BETWEEN_SWEEPS_MS: i64 = 2 * 3_600_000;

pub(crate) async fn no_row_loses_its_blob_while_garbage_is_collected_over_and_over<E: Engine>() {
    const SWEEPS: u32 = 3;
    let engine = E::new();
    for number in 0..SWEEPS {
        // Everybody has the same clock.
        let clock = i64::from(number) * BETWEEN_SWEEPS_MS;
        let store = engine.after(clock).await;
        submit(&store, &sweep(&format!("s{number}"), (0..POINTS).map(|point| number * 1_000 + point))).await;
        let are_done = Arc::new(AtomicBool::new(false));
        let start = Arc::new(Barrier::new(7));
        let config = |role| engine.config(role, clock);
        let writers: Vec<_> = (0..4)
            .map(|writer| {
                let name = format!("writer {writer} of {number}");
                on_a_thread(config(Role::Worker), &start, async move |store| {
                    write_during_collection(&store, &name).await;
                })
            })
            .collect();
        let stranger = {
            let are_done = are_done.clone();
            on_a_thread(config(Role::Worker), &start, async move |store| {
                copy_in(&store, &are_done).await;
            })
        };
        let collectors: Vec<_> = (0..2)
            .map(|collector| {
                let (are_done, earlier) =
                    (are_done.clone(), number.checked_sub(1).filter(|_| collector == 0));
                on_a_thread(config(Role::Server), &start, async move |store| {
                    collect_over_and_over(&store, earlier, &are_done).await
                })
            })
            .collect();
        writers.into_iter().for_each(|writer| writer.join().unwrap());
        are_done.store(true, Ordering::SeqCst);
        stranger.join().unwrap();
        let deleted: u64 = collectors.into_iter().map(|collector| collector.join().unwrap()).sum();
        if number > 0 {
            // At least what only the earlier sweep's writers had left: they were beside those who wrote the rest again.
            assert!(deleted >= u64::from(POINTS / 5), "{deleted} blobs were deleted");
        }
        let counts = sweep_record(&store, &format!("s{number}")).await.counts;
        assert_eq!(counts.done, i64::from(POINTS));
        assert_eq!(store.check().await.unwrap().problems, Vec::<String>::new(), "of sweep {number}");
    }

    let last = engine.after(i64::from(SWEEPS) * BETWEEN_SWEEPS_MS).await;
    last.collect_garbage(&at_once(), false).await.unwrap();
    let mut named = BTreeSet::new();
    for point in last.points(&format!("s{}", SWEEPS - 1), &[], 0, 1_000).await.unwrap() {
        for artifact in last.artifacts(&point.work_key).await.unwrap() {
            last.blobs().verify(artifact.blob.parse().unwrap()).await.unwrap();
            named.insert(object_name(&artifact.blob));
        }
    }
    let stored: BTreeSet<String> = engine.objects().into_iter().map(|object| object.name).collect();
    assert_eq!(stored, named, "no orphan is left");
    assert_eq!(named.len(), (POINTS + SHARED) as usize);
}

/// Nothing is too young to be deleted.
fn at_once() -> RetentionPolicy {
    let long = Duration::from_secs(365 * 86_400);
    RetentionPolicy {
        artifact_ages: Default::default(),
        other_artifacts: long,
        events: long,
        blob_grace: Duration::ZERO,
    }
}

/// The content that a point's own table has, in whichever sweep, and the one that it shares.
fn contents(point: u32) -> [Vec<u8>; 2] {
    [format!("of point {point}").into_bytes(), format!("of all {}", point % SHARED).into_bytes()]
}

/// A worker. Some of its points it begins twice: at the first time it dies after it has stored a blob that nobody names, or it leaves a
/// checkpoint.
async fn write_during_collection(store: &Store, name: &str) {
    while let Some(Claim { lease, scenario, checkpoint }) = claim_or_none(store, name).await {
        let number = json(&scenario.changes_json)["number"].as_u64().unwrap() as u32;
        let point = number % 1_000;
        let is_first = lease.fencing_token == 1;
        match point % 5 {
            0 if is_first => {
                store.put_blob(format!("of nobody {number}").into_bytes()).await.unwrap();
                assert!(store.release(&lease).await.unwrap());
                continue;
            }
            1 if is_first => {
                let blob = store.put_blob(format!("half of {point}").into_bytes()).await.unwrap();
                assert!(store.keep_checkpoint(&lease, blob).await.unwrap());
                assert!(store.release(&lease).await.unwrap());
                continue;
            }
            _ => {}
        }
        if let Some(checkpoint) = checkpoint {
            let half = store.blobs().get(checkpoint).await.unwrap();
            assert_eq!(half, format!("half of {point}").into_bytes());
        }
        let contents = contents(point);
        let blobs = [BlobId::of(&contents[0]), BlobId::of(&contents[1])];
        assert_eq!(store.reserve(&lease, LEASE_MS, &blobs).await.unwrap(), Renewal::Held);
        let mut artifacts = Vec::new();
        for (name, content) in ["history", "profile"].into_iter().zip(contents) {
            artifacts.push(NewArtifact {
                name: name.to_owned(),
                media_type: "application/vnd.apache.parquet".to_owned(),
                bytes: content.len() as i64,
                row_count: 1,
                blob: store.blobs().put(content).await.unwrap(),
            });
        }
        let result = NewResult {
            summary_json: "{}",
            provenance_json: "{}",
            artifacts: &artifacts,
            is_repeatable: true,
        };
        assert!(store.finish_done(&lease, &result).await.unwrap());
    }
}

/// Puts objects into the object store past the database, as somebody does who brings a copy back: what writers find there may be deleted
/// at any time, until they have reserved it.
async fn copy_in(store: &Store, are_done: &AtomicBool) {
    for point in (0..POINTS).cycle() {
        if are_done.load(Ordering::SeqCst) {
            return;
        }
        for content in contents(point) {
            // A blob without a reservation may be deleted while it is being written.
            let _ = store.blobs().put(content).await;
        }
    }
}

/// Deletes an earlier sweep, and collects until all is done and once more; tells how many blobs that deleted.
async fn collect_over_and_over(store: &Store, earlier: Option<u32>, are_done: &AtomicBool) -> u64 {
    if let Some(earlier) = earlier {
        let outcome = store.delete_sweep(&format!("s{earlier}"), None, false).await.unwrap();
        assert!(matches!(outcome, DeleteOutcome::Deleted { .. }), "{outcome:?}");
    }
    let mut deleted = 0;
    loop {
        let is_last = are_done.load(Ordering::SeqCst);
        deleted += store.collect_garbage(&at_once(), false).await.unwrap().blobs;
        if is_last {
            return deleted;
        }
    }
}
