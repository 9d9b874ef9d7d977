//! Several threads, each with connections of its own, on one store.

use std::collections::HashMap;
use std::sync::{Arc, Barrier};
use std::thread;

use drillsweep_store::{Renewal, Role, Store, StoreConfig, SubmitOutcome, WorkKey};

use crate::bench::{Engine, LEASE_MS, claim_or_none, finish, key, submit, sweep, sweep_record};

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

pub(crate) async fn of_several_submissions_with_one_idempotency_key_one_is_stored<E: Engine>() {
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
