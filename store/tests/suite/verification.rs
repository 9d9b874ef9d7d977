//! Runs that verify points: work like any other, told apart from the points.

use drillsweep_store::{
    Addition, AppendOutcome, CachePolicy, ChangeOutcome, FailureFilter, NewSweep, StateCounts, SubmitOutcome,
    SweepChanges, WorkState,
};

use crate::bench::{
    Engine, addition, claim, claim_or_none, finish, key, point_record, scenario, states, submit, sweep,
    sweep_record, verification, verified,
};
use crate::garbage::{DAY_MS, collect};

pub(crate) async fn runs_come_after_the_points_and_end_the_sweep<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &verified(sweep("s", [1, 2, 3]), &[(3, 13), (1, 11)])).await;
    let record = sweep_record(&store, "s").await;
    assert_eq!(record.counts, StateCounts { total: 3, queued: 3, ..StateCounts::default() });
    assert_eq!(record.verification, StateCounts { total: 2, queued: 2, ..StateCounts::default() });
    for number in [1, 2, 3] {
        let claimed = claim(&store, "w").await;
        assert_eq!(claimed.lease.key, key(number));
        assert!(finish(&store, &claimed).await);
    }
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.done, record.finished), (3, None), "its runs are still open");
    let claimed = claim(&store, "w").await;
    assert_eq!(
        (claimed.lease.key, claimed.scenario.base_json.clone()),
        (key(13), scenario("reference", 0).base_json)
    );
    store.renew(&claimed.lease, 60_000, 0.5).await.unwrap();
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.verification.running, record.progress.to_bits()), (1, 3.5_f64.to_bits()));
    assert!(finish(&store, &claimed).await);
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert!(sweep_record(&store, "s").await.finished.is_some());

    // Lists have the points alone.
    assert_eq!(states(&store, "s").await, [WorkState::Done; 3]);
    assert_eq!(store.table_rows("s", 0, 100).await.unwrap().len(), 3);
    assert_eq!(store.point_artifacts("s", 0, 9).await.unwrap().len(), 3);
    assert_eq!(point_record(&store, "s", 1).await.work_key, key(1));
    let runs = store.verifications("s").await.unwrap();
    let told: Vec<_> = runs.iter().map(|run| (run.ordinal, run.work_key, run.state)).collect();
    assert_eq!(told, [(1, key(11), WorkState::Done), (3, key(13), WorkState::Done)]);
    assert!(runs.iter().all(|run| run.summary_json.is_some() && run.reference_json.is_some()));
    let events = store.events("s", 0, 99).await.unwrap();
    let of_runs: Vec<_> =
        events.iter().filter(|event| event.ordinals.is_empty()).map(|event| event.verifies.clone()).collect();
    assert_eq!(of_runs, [[3], [3], [1], [1]]);
}

pub(crate) async fn a_run_is_shared_with_sweeps_of_the_same_point<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &verified(sweep("s", [1, 2]), &[(1, 11), (2, 11)])).await;
    submit(&store, &sweep("reference", [11])).await;
    for _ in 0..3 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert_eq!(sweep_record(&store, "s").await.verification.done, 2);
    assert_eq!(states(&store, "reference").await, [WorkState::Done]);
    // The result of a point verifies at once, and the other way round.
    submit(&store, &verified(sweep("again", [1]), &[(1, 11)])).await;
    assert!(sweep_record(&store, "again").await.finished.is_some());
    // A sweep that has the same work as a point and as a run counts it as both.
    submit(&store, &verified(sweep("both", [21]), &[(1, 21)])).await;
    let record = sweep_record(&store, "both").await;
    assert_eq!((record.counts.queued, record.verification.queued), (1, 1));
    assert!(finish(&store, &claim(&store, "w").await).await);
    let record = sweep_record(&store, "both").await;
    assert_eq!((record.counts.done, record.verification.done), (1, 1));
    let last = store.events("both", 0, 9).await.unwrap().pop().unwrap();
    assert_eq!((last.ordinals, last.verifies), (vec![1], vec![1]));
}

pub(crate) async fn runs_are_cancelled_held_hurried_and_retried_with_their_sweep<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &verified(sweep("s", [1]), &[(1, 11)])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert!(store.pause_sweep("s", true).await.unwrap());
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert!(store.pause_sweep("s", false).await.unwrap());

    submit(&store, &sweep("other", [2])).await;
    let urgent = SweepChanges { priority: Some(5), ..SweepChanges::default() };
    submit(&store, &sweep("third", [3])).await;
    assert_eq!(store.change_sweep("s", &urgent, None).await.unwrap(), ChangeOutcome::Changed);
    let run = claim(&store, "w").await;
    assert_eq!(run.lease.key, key(11));
    assert!(store.finish_failed(&run.lease, "{}").await.unwrap());
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.failed, record.verification.failed), (0, 1));
    assert!(record.finished.is_some());
    // The point has its result: only what was asked to verify it failed.
    assert!(store.failures(&FailureFilter::default(), None, 9).await.unwrap().is_empty());
    let told = store.verifications("s").await.unwrap();
    assert_eq!((told[0].state, told[0].error_json.as_deref()), (WorkState::Failed, Some("{}")));

    assert_eq!(store.retry_sweep("s").await.unwrap(), Some(1));
    assert_eq!(sweep_record(&store, "s").await.finished, None);
    assert!(store.cancel_sweep("s").await.unwrap());
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.done, record.verification.cancelled), (1, 1));
    assert!(record.finished.is_some());
    assert_eq!(store.retry_sweep("s").await.unwrap(), Some(1));
    // Points first, then runs.
    submit(&store, &verified(sweep("both", [31, 32]), &[(1, 41)])).await;
    assert!(store.cancel_sweep("both").await.unwrap());
    assert_eq!(store.retry_sweep("both").await.unwrap(), Some(3));
    let mut order = Vec::new();
    while let Some(claim) = claim_or_none(&store, "w").await {
        order.push(claim.lease.key);
    }
    let of_both: Vec<_> =
        order.into_iter().filter(|claimed| [31, 32, 41].map(key).contains(claimed)).collect();
    assert_eq!(of_both, [31, 32, 41].map(key));
}

pub(crate) async fn a_run_of_another_live_sweep_continues<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &verified(sweep("s", [1]), &[(1, 11)])).await;
    submit(&store, &sweep("wants", [11])).await;
    assert!(store.cancel_sweep("s").await.unwrap());
    assert_eq!(states(&store, "wants").await, [WorkState::Queued]);
    // And the other way round: a sweep that verifies by it wants it.
    submit(&store, &sweep("t", [21])).await;
    submit(&store, &verified(sweep("verifies", [1]), &[(1, 21)])).await;
    assert!(store.cancel_sweep("t").await.unwrap());
    assert_eq!(sweep_record(&store, "verifies").await.verification.queued, 1);
}

pub(crate) async fn a_run_is_kept_as_long_as_its_sweep<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &verified(sweep("s", [1]), &[(1, 11)])).await;
    for _ in 0..2 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    assert_eq!(collect(&engine.after(2 * DAY_MS).await).await.results, 0);
    let now = store.now_ms().await.unwrap();
    let expires = SweepChanges { expires: Some(Some(now + DAY_MS)), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("s", &expires, None).await.unwrap(), ChangeOutcome::Changed);
    let found = collect(&engine.after(2 * DAY_MS).await).await;
    assert_eq!((found.sweeps, found.results, found.scenarios, found.blobs), (1, 2, 2, 2));
}

pub(crate) async fn added_points_bring_their_runs<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &verified(sweep("s", [1, 2]), &[(2, 12)])).await;
    let (points, base) = (sweep("s", [2, 3, 4]).points, scenario("s", 0).base_json);
    // The first is there already, and so is not verified for it.
    let runs = verification(&[(1, 12), (3, 14)]);
    let addition = Addition { verification: &runs, ..addition(&base, &points, "{}") };
    assert_eq!(store.append_points("s", &addition, 9).await.unwrap(), AppendOutcome::Added(2));
    let told: Vec<_> = store.verifications("s").await.unwrap();
    let told: Vec<_> = told.into_iter().map(|run| (run.ordinal, run.work_key)).collect();
    assert_eq!(told, [(2, key(12)), (4, key(14))]);
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.queued, record.verification.queued), (4, 2));
    // The same again changes nothing.
    assert_eq!(store.append_points("s", &addition, 9).await.unwrap(), AppendOutcome::Added(0));
    assert_eq!(sweep_record(&store, "s").await.verification.total, 2);
}

pub(crate) async fn a_submission_of_known_points_requires_known_runs<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("known", [1, 2, 11])).await;
    for _ in 0..3 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    let only = |id: &str, runs: &[(i64, u32)]| NewSweep {
        cache: CachePolicy::Only,
        ..verified(sweep(id, [1, 2]), runs)
    };
    let outcome = store.submit_sweep(&only("some", &[(1, 11), (2, 12)])).await.unwrap();
    assert_eq!(outcome, SubmitOutcome::NotComputed { points: vec![], verifications: vec![2] });
    submit(&store, &only("all", &[(1, 11)])).await;
    assert!(sweep_record(&store, "all").await.finished.is_some());
    // Computed anew are the runs as well as the points.
    let anew = verified(sweep("anew", [1]), &[(1, 11)]);
    submit(&store, &NewSweep { cache: CachePolicy::Refresh, ..anew }).await;
    let record = sweep_record(&store, "anew").await;
    assert_eq!((record.counts.queued, record.verification.queued), (1, 1));
}
