//! Cancelling: what nobody wants stops, what somebody wants goes on.

use drillsweep_store::{Renewal, StateCounts, WorkState};

use crate::bench::{
    Engine, LEASE_MS, claim, claim_or_none, finish, key, point_record, states, submit, sweep, sweep_record,
};

const CANCELLED: &str = r#"{"class":"cancelled"}"#;

pub(crate) async fn queued_points_end_at_once_and_running_ones_at_their_next_renewal<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2, 3, 4])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let failed = claim(&store, "w").await;
    assert!(store.finish_failed(&failed.lease, r#"{"class":"physical"}"#).await.unwrap());
    let running = claim(&store, "w").await;
    assert!(store.cancel_sweep("s").await.unwrap());
    assert_eq!(
        states(&store, "s").await,
        [WorkState::Done, WorkState::Failed, WorkState::Leased, WorkState::Cancelled]
    );
    let record = sweep_record(&store, "s").await;
    assert!(record.is_cancelled);
    assert_eq!(record.finished, None);

    assert_eq!(store.renew(&running.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::CancelRequested);
    assert_eq!(store.reserve(&running.lease, LEASE_MS, &[]).await.unwrap(), Renewal::CancelRequested);
    assert!(store.finish_cancelled(&running.lease, CANCELLED).await.unwrap());
    let record = sweep_record(&store, "s").await;
    let counts = StateCounts { total: 4, done: 1, failed: 1, cancelled: 2, ..StateCounts::default() };
    assert_eq!((record.counts, record.progress), (counts, 4.0), "a final point counts as one");
    assert!(record.finished.is_some());
    assert_eq!(point_record(&store, "s", 3).await.error_json.as_deref(), Some(CANCELLED));
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert!(!store.cancel_sweep("t").await.unwrap());
}

pub(crate) async fn work_of_another_live_sweep_continues<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2, 3])).await;
    submit(&store, &sweep("b", [1, 3])).await;
    let running = claim(&store, "w").await;
    assert_eq!(running.lease.key, key(1));
    assert!(store.cancel_sweep("a").await.unwrap());
    assert_eq!(store.renew(&running.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
    // The cancelled sweep is final, whatever others still wait for.
    assert_eq!(states(&store, "a").await, [WorkState::Cancelled; 3]);
    let record = sweep_record(&store, "a").await;
    assert_eq!(record.counts, StateCounts { total: 3, cancelled: 3, ..StateCounts::default() });
    assert!(record.finished.is_some());
    let told: Vec<_> = store
        .events("a", 0, 9)
        .await
        .unwrap()
        .into_iter()
        .map(|event| (event.state, event.ordinals))
        .collect();
    let cancelled = |ordinal| (WorkState::Cancelled, vec![ordinal]);
    // In the order of their keys, which is against that of the numbers.
    assert_eq!(told, [(WorkState::Leased, vec![1]), cancelled(2), cancelled(3), cancelled(1)]);
    assert_eq!(states(&store, "b").await, [WorkState::Leased, WorkState::Queued]);
    assert_eq!(sweep_record(&store, "b").await.finished, None);
    // The last one that wanted it is gone.
    assert!(store.cancel_sweep("b").await.unwrap());
    assert_eq!(store.renew(&running.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::CancelRequested);
    assert_eq!(states(&store, "b").await, [WorkState::Leased, WorkState::Cancelled]);
}

pub(crate) async fn work_resubmitted_before_its_worker_stopped_is_done<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1])).await;
    let running = claim(&store, "w").await;
    assert!(store.cancel_sweep("a").await.unwrap());
    assert_eq!(store.renew(&running.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::CancelRequested);
    submit(&store, &sweep("b", [1])).await;
    // The worker acts on what it heard before.
    assert!(store.finish_cancelled(&running.lease, CANCELLED).await.unwrap());
    let point = point_record(&store, "b", 1).await;
    assert_eq!((point.state, point.error_json, point.progress), (WorkState::Queued, None, 0.0));
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert_eq!(sweep_record(&store, "b").await.counts.done, 1);
}

pub(crate) async fn cancelled_work_is_queued_by_a_new_request<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2])).await;
    assert!(store.cancel_sweep("a").await.unwrap());
    assert!(sweep_record(&store, "a").await.finished.is_some());

    submit(&store, &sweep("b", [2])).await;
    assert_eq!(states(&store, "b").await, [WorkState::Queued]);
    assert_eq!(claim(&store, "w").await.lease.key, key(2));
    assert_eq!(claim_or_none(&store, "w").await, None);
    // Attempts of others do not concern the cancelled sweep until there is a result.
    let record = sweep_record(&store, "a").await;
    assert_eq!((record.counts.running, record.counts.cancelled), (0, 2));
    assert!(record.finished.is_some());

    assert_eq!(store.retry_sweep("a").await.unwrap(), Some(1));
    let record = sweep_record(&store, "a").await;
    assert!(!record.is_cancelled);
    assert_eq!(record.counts, StateCounts { total: 2, running: 1, queued: 1, ..StateCounts::default() });
}

pub(crate) async fn a_cancelled_sweep_shares_results_of_another_one<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2])).await;
    submit(&store, &sweep("b", [1])).await;
    assert!(store.cancel_sweep("a").await.unwrap());
    let finished = sweep_record(&store, "a").await.finished;
    assert!(finished.is_some());
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert_eq!(states(&store, "a").await, [WorkState::Done, WorkState::Cancelled]);
    let record = sweep_record(&store, "a").await;
    let expected = StateCounts { total: 2, done: 1, cancelled: 1, ..StateCounts::default() };
    assert_eq!((record.counts, record.finished), (expected, finished));
    let last = store.events("a", 0, 9).await.unwrap().pop().unwrap();
    assert_eq!((last.state, last.ordinals), (WorkState::Done, vec![1]));
    assert_eq!(store.sweep_version("a").await.unwrap(), Some(last.seq + 1));
}

pub(crate) async fn a_sweep_whose_points_all_go_on_for_another_one_is_finished<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2])).await;
    submit(&store, &sweep("b", [1, 2])).await;
    // Nobody computes them: for ever, if it were not for the end of the cancelled one.
    assert!(store.pause_sweep("b", true).await.unwrap());
    assert!(store.cancel_sweep("a").await.unwrap());
    assert!(sweep_record(&store, "a").await.finished.is_some());
    assert!(store.cancel_sweep("a").await.unwrap());
    assert_eq!(sweep_record(&store, "a").await.counts.cancelled, 2);
    // Taking the cancellation back shows their state again.
    assert_eq!(store.retry_sweep("a").await.unwrap(), Some(0));
    let record = sweep_record(&store, "a").await;
    assert_eq!((record.counts.queued, record.counts.cancelled, record.finished), (2, 0, None));
    assert!(claim_or_none(&store, "w").await.is_some());
}

pub(crate) async fn a_retry_takes_back_the_cancellation_of_running_work<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1])).await;
    let running = claim(&store, "w").await;
    assert!(store.cancel_sweep("a").await.unwrap());
    assert_eq!(store.retry_sweep("a").await.unwrap(), Some(0));
    assert_eq!(store.renew(&running.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
    assert!(finish(&store, &running).await);
}

pub(crate) async fn unwanted_work_that_comes_back_is_not_queued<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2, 3])).await;
    let released = claim(&store, "w").await;
    let broken = claim(&store, "w").await;
    let silent = claim(&store, "silent").await;
    assert!(store.cancel_sweep("s").await.unwrap());
    assert!(store.release(&released.lease).await.unwrap());
    assert!(store.retry_later(&broken.lease, r#"{"class":"infrastructure"}"#).await.unwrap());
    assert_eq!(silent.lease.key, key(3));
    assert_eq!(engine.after(LEASE_MS + 1).await.reap_expired().await.unwrap(), 1);
    assert_eq!(states(&store, "s").await, [WorkState::Cancelled; 3]);
    assert!(sweep_record(&store, "s").await.finished.is_some());
}

pub(crate) async fn a_result_that_comes_in_spite_of_a_cancellation_is_kept<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let running = claim(&store, "w").await;
    assert!(store.cancel_sweep("s").await.unwrap());
    assert!(finish(&store, &running).await);
    assert_eq!(states(&store, "s").await, [WorkState::Done]);
    assert_eq!(store.known_results(&[(key(1), None)]).await.unwrap(), 1);
}
