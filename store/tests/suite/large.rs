//! Sweeps of thousands of points: whole or not at all, and nobody waits for them.

use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::task::Poll;

use drillsweep_store::{NewSweep, Role, StateCounts, Store, StoreError, SubmitOutcome, SweepFilter};

use crate::bench::{Engine, claim, finish, submit, sweep, sweep_record};

/// Many times what is written under one hold of the lock.
const POINTS: u32 = 5_000;

/// Time for which a change is left to the process that began it \[ms\].
const SILENCE_MS: i64 = 60_000;

fn large(id: &str) -> NewSweep {
    NewSweep { idempotency_key: Some((format!("key of {id}"), [7; 32])), ..sweep(id, 1..=POINTS) }
}

/// Lets something go on to its next wait. True once it is done.
async fn advance(work: &mut Pin<&mut impl Future>) -> bool {
    poll_fn(|context| Poll::Ready(work.as_mut().poll(context).is_ready())).await
}

async fn queued(store: &Store) -> i64 {
    store.queue_depths().await.unwrap().queued
}

pub(crate) async fn a_partial_sweep_is_invisible_and_removed<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    // Another process; this one dies.
    let dying = engine.open().await;
    let request = large("s");
    {
        let mut submission = pin!(dying.submit_sweep(&request));
        while queued(&store).await == 0 {
            assert!(!advance(&mut submission).await, "it is stored in one step");
        }
    }
    drop(dying);
    assert!(queued(&store).await < i64::from(POINTS));
    assert_eq!(store.sweep("s").await.unwrap(), None);
    assert_eq!(store.sweeps(&SweepFilter::default(), None, 10).await.unwrap(), []);
    assert_eq!(store.sweep_version("s").await.unwrap(), None);
    let again = store.submit_sweep(&NewSweep { id: "t".to_owned(), ..request.clone() }).await;
    assert!(matches!(again, Err(StoreError::Arriving)), "{again:?}");
    assert_eq!(store.finish_partial_changes(SILENCE_MS).await.unwrap(), 0);

    let later = engine.after(SILENCE_MS + 1_000).await;
    assert_eq!(later.finish_partial_changes(SILENCE_MS).await.unwrap(), 1);
    assert_eq!(queued(&later).await, 0);
    let again = later.submit_sweep(&NewSweep { id: "t".to_owned(), ..request }).await.unwrap();
    assert_eq!(again, SubmitOutcome::Created);
    let all = i64::from(POINTS);
    let expected = StateCounts { total: all, queued: all, ..StateCounts::default() };
    assert_eq!(sweep_record(&later, "t").await.counts, expected);
    assert_eq!(later.check().await.unwrap().problems, Vec::<String>::new());
}

pub(crate) async fn a_large_submission_lets_others_in_between<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let request = large("s");
    let mut submission = pin!(store.submit_sweep(&request));
    while queued(&store).await == 0 {
        assert!(!advance(&mut submission).await);
    }
    let other = NewSweep { owner: "bob".to_owned(), ..sweep("t", [POINTS + 1]) };
    tokio::select! {
        biased;
        outcome = store.submit_sweep(&other) => assert_eq!(outcome.unwrap(), SubmitOutcome::Created),
        _ = &mut submission => panic!("the small sweep waits for the large one"),
    }
    // Results from before the sweep was seen count as well.
    let worker = Store::open(&engine.config(Role::Worker, 0)).await.unwrap();
    let working = async {
        for _ in 0..2 {
            assert!(finish(&worker, &claim(&worker, "w").await).await);
        }
    };
    let (outcome, ()) = tokio::join!(submission, working);
    assert_eq!(outcome.unwrap(), SubmitOutcome::Created);
    let counts = sweep_record(&store, "s").await.counts;
    assert_eq!(counts.done + sweep_record(&store, "t").await.counts.done, 2);
    assert_eq!((counts.total, counts.queued + counts.done), (i64::from(POINTS), i64::from(POINTS)));
}

pub(crate) async fn a_cancellation_holds_from_its_beginning_and_is_brought_to_its_end<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &large("s")).await;
    let dying = engine.open().await;
    {
        let mut cancellation = pin!(dying.cancel_sweep("s"));
        while queued(&store).await == i64::from(POINTS) {
            assert!(!advance(&mut cancellation).await, "it is cancelled in one step");
        }
    }
    drop(dying);
    assert!(queued(&store).await > 0);
    let all = i64::from(POINTS);
    let expected = StateCounts { total: all, cancelled: all, ..StateCounts::default() };
    let record = sweep_record(&store, "s").await;
    assert!(record.is_cancelled && record.finished.is_some());
    assert_eq!(record.counts, expected);
    assert_eq!(store.finish_partial_changes(SILENCE_MS).await.unwrap(), 1);
    assert_eq!(queued(&store).await, 0);
    assert_eq!(sweep_record(&store, "s").await.counts, expected);
    // One who takes it back half-way has all of it queued.
    assert_eq!(store.retry_sweep("s").await.unwrap(), Some(POINTS.into()));
    let dying = engine.open().await;
    {
        let mut cancellation = pin!(dying.cancel_sweep("s"));
        while queued(&store).await == all {
            assert!(!advance(&mut cancellation).await);
        }
    }
    assert!(store.retry_sweep("s").await.unwrap().is_some_and(|queued| queued < POINTS.into()));
    assert_eq!(queued(&store).await, all);
    assert_eq!(store.finish_partial_changes(SILENCE_MS).await.unwrap(), 0);
    let expected = StateCounts { total: all, queued: all, ..StateCounts::default() };
    assert_eq!(sweep_record(&store, "s").await.counts, expected);
}
