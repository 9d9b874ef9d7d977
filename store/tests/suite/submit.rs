//! Submitting and reading back: nothing is computed twice, nothing is stored twice, nothing is lost.

use std::time::{SystemTime, UNIX_EPOCH};

use drillsweep_store::{
    AppendOutcome, CachePolicy, NewSweep, StateCounts, StoreError, SubmitOutcome, SweepFilter, WorkState,
};

use crate::bench::{
    Engine, addition, claim, claim_or_none, finish, key, point_record, scenario, states, submit, sweep,
    sweep_record,
};

pub(crate) async fn a_sweep_is_read_back_as_it_was_submitted<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [10, 20, 30])).await;

    let record = sweep_record(&store, "s").await;
    assert_eq!(record.name.as_deref(), Some("sweep s"));
    assert_eq!(record.owner, "anne");
    assert_eq!(record.varied_json, r#"["flow_rate"]"#);
    assert_eq!(store.request_json("s").await.unwrap().as_deref(), Some(r#"{"request":"s"}"#));
    assert_eq!(record.counts, StateCounts { total: 3, queued: 3, ..StateCounts::default() });
    assert_eq!((record.progress, record.finished, record.is_cancelled), (0.0, None, false));
    let system = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_millis() as i64;
    assert!((record.created - system).abs() < 10_000, "{} is not about {system}", record.created);

    let point = point_record(&store, "s", 2).await;
    assert_eq!(point.parameters_json, r#"{"flow_rate":20}"#);
    assert_eq!(point.scenario, Some(scenario("s", 20)));
    assert_eq!(point.work_key, key(20));
    assert_eq!((point.state, point.attempts, point.summary_json), (WorkState::Queued, 0, None));
    assert_eq!(store.point("s", 4).await.unwrap(), None);
    assert_eq!(store.sweep("t").await.unwrap(), None);
    assert_eq!(store.sweep_version("t").await.unwrap(), None);
    assert_eq!(store.request_bytes("s").await.unwrap(), Some(15));
    assert_eq!(store.request_bytes("t").await.unwrap(), None);
    assert_eq!(store.request_json("t").await.unwrap(), None);
}

pub(crate) async fn a_result_is_read_back_with_its_artifacts_and_fills_the_table<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let first = claim(&store, "w").await;
    assert_eq!(first.scenario, scenario("s", 1));
    assert!(finish(&store, &first).await);

    let point = point_record(&store, "s", 1).await;
    assert_eq!((point.state, point.progress, point.attempts), (WorkState::Done, 1.0, 1));
    assert_eq!(point.summary_json.as_deref(), Some(r#"{"by":"w"}"#));
    assert_eq!(point.provenance_json.as_deref(), Some(r#"{"version":"test"}"#));
    let artifacts = store.artifacts(&key(1)).await.unwrap();
    assert_eq!(artifacts.len(), 1);
    assert_eq!((artifacts[0].name.as_str(), artifacts[0].row_count), ("history", 7));
    let blob = store.blobs().get(artifacts[0].blob.parse().unwrap()).await.unwrap();
    assert_eq!(blob, key(1).as_slice());
    assert_eq!(store.artifacts(&key(2)).await.unwrap(), []);

    let rows = store.table_rows("s", 0, 100).await.unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!((rows[0].ordinal, rows[0].state), (1, WorkState::Done));
    assert_eq!(rows[0].summary_json.as_deref(), Some(r#"{"by":"w"}"#));
    assert_eq!(
        (rows[1].ordinal, rows[1].state, rows[1].summary_json.as_deref()),
        (2, WorkState::Queued, None)
    );
}

pub(crate) async fn the_same_point_is_computed_once_for_every_sweep_that_has_it<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2])).await;
    submit(&store, &sweep("b", [2, 3])).await;
    let mut claimed = Vec::new();
    while let Some(claim) = claim_or_none(&store, "w").await {
        assert!(finish(&store, &claim).await);
        claimed.push(claim.lease.key);
    }
    claimed.sort();
    assert_eq!(claimed, [key(3), key(2), key(1)]);
    for id in ["a", "b"] {
        let record = sweep_record(&store, id).await;
        assert_eq!(record.counts, StateCounts { total: 2, done: 2, ..StateCounts::default() });
        assert!(record.finished.is_some());
    }
    // Known results count at once.
    submit(&store, &sweep("c", [1, 3])).await;
    let record = sweep_record(&store, "c").await;
    assert_eq!(record.counts, StateCounts { total: 2, done: 2, ..StateCounts::default() });
    assert_eq!(record.finished, Some(record.created));
    assert_eq!(record.progress, 2.0);
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert_eq!(store.known_results(&[1, 9, 3].map(|number| (key(number), None))).await.unwrap(), 2);
}

pub(crate) async fn a_point_whose_result_is_part_of_a_fuller_one_is_not_computed<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let partly = |id: &str| {
        let mut sweep = sweep(id, [11, 12, 13]);
        for (point, number) in sweep.points.iter_mut().zip([1, 2, 3]) {
            point.fuller_key = Some(key(number));
        }
        sweep
    };
    let keys = [1, 2, 3].map(|number| (key(10 + number), Some(key(number))));
    assert_eq!(store.known_results(&keys).await.unwrap(), 0);
    submit(&store, &sweep("full", [1, 2])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    // One has a result, one is under way, one was never asked for.
    let under_way = claim(&store, "w").await;
    assert_eq!(store.known_results(&keys).await.unwrap(), 1);
    submit(&store, &partly("part")).await;
    let counts = sweep_record(&store, "part").await.counts;
    assert_eq!((counts.done, counts.queued), (1, 2));
    assert_eq!(point_record(&store, "part", 1).await.work_key, key(1));
    for number in [12, 13] {
        let claimed = claim(&store, "w").await;
        assert_eq!(claimed.lease.key, key(number));
        assert!(finish(&store, &claimed).await);
    }
    assert!(finish(&store, &under_way).await);

    // A point that a sweep has by a fuller result is not added again.
    let points = partly("more").points;
    let added = store.append_points("part", &addition("{}", &points[..1], "{}"), 10).await.unwrap();
    assert_eq!(added, AppendOutcome::Added(0));
    // Asked to compute anew, a point is computed as it was asked for.
    submit(&store, &NewSweep { cache: CachePolicy::Refresh, ..partly("anew") }).await;
    assert_eq!(claim(&store, "w").await.lease.key, key(11));
}

pub(crate) async fn a_point_that_a_sweep_has_twice_counts_twice_and_is_computed_once<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 1, 2])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let record = sweep_record(&store, "s").await;
    assert_eq!(record.counts, StateCounts { total: 3, queued: 1, done: 2, ..StateCounts::default() });
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert!(sweep_record(&store, "s").await.finished.is_some());
}

pub(crate) async fn a_physical_failure_is_final_until_a_retry<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1])).await;
    let failed = claim(&store, "w").await;
    let error = r#"{"class":"physical","time":1.25,"node":49}"#;
    assert!(store.finish_failed(&failed.lease, error).await.unwrap());
    assert_eq!(point_record(&store, "a", 1).await.error_json.as_deref(), Some(error));

    submit(&store, &sweep("b", [1])).await;
    assert_eq!(states(&store, "b").await, [WorkState::Failed]);
    assert_eq!(claim_or_none(&store, "w").await, None);

    assert_eq!(store.retry_sweep("b").await.unwrap(), Some(1));
    // The other sweep that has the point sees it come back to life too.
    let record = sweep_record(&store, "a").await;
    assert_eq!((record.counts.queued, record.finished), (1, None));
    let again = claim(&store, "w").await;
    assert_eq!(again.lease.fencing_token, failed.lease.fencing_token + 1);
    assert!(finish(&store, &again).await);
    assert_eq!(point_record(&store, "b", 1).await.error_json, None);
    assert_eq!(states(&store, "a").await, [WorkState::Done]);
    assert_eq!(store.retry_sweep("c").await.unwrap(), None);
}

pub(crate) async fn the_same_idempotency_key_gives_the_sweep_that_it_made<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let with_key = |id: &str, owner: &str, body: u8| {
        let mut sweep = sweep(id, [1, 2]);
        sweep.owner = owner.to_owned();
        sweep.idempotency_key = Some(("retry-safe".to_owned(), [body; 32]));
        sweep
    };
    submit(&store, &with_key("a", "anne", 1)).await;
    let again = store.submit_sweep(&with_key("b", "anne", 1)).await.unwrap();
    assert_eq!(again, SubmitOutcome::Known("a".to_owned()));
    let other_body = store.submit_sweep(&with_key("c", "anne", 2)).await.unwrap_err();
    assert!(matches!(other_body, StoreError::IdempotencyConflict), "{other_body}");
    // Keys are their owner's own.
    submit(&store, &with_key("d", "bert", 2)).await;
    let ids: Vec<_> = store
        .sweeps(&SweepFilter::default(), None, 10)
        .await
        .unwrap()
        .into_iter()
        .map(|sweep| sweep.id)
        .collect();
    assert_eq!(ids, ["d", "a"]);
}

pub(crate) async fn pages_hold_every_row_once_and_in_order<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 1..=25)).await;
    for _ in 0..4 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    claim(&store, "w").await;

    let mut seen = Vec::new();
    loop {
        let page = store.points("s", &[], seen.last().copied().unwrap_or(0), 10).await.unwrap();
        if page.is_empty() {
            break;
        }
        seen.extend(page.iter().map(|point| point.ordinal));
    }
    assert_eq!(seen, (1..=25).collect::<Vec<_>>());
    let of = async |states: &[WorkState]| -> Vec<i64> {
        store.points("s", states, 0, 100).await.unwrap().into_iter().map(|point| point.ordinal).collect()
    };
    assert_eq!(of(&[WorkState::Done]).await, [1, 2, 3, 4]);
    assert_eq!(of(&[WorkState::Done, WorkState::Leased]).await, [1, 2, 3, 4, 5]);
    assert_eq!(of(&[WorkState::Waiting, WorkState::Queued]).await.len(), 20);
    assert_eq!(of(&[WorkState::Dead]).await, [0; 0]);

    for (id, owner) in [("t1", "bert"), ("t2", "anne"), ("t3", "bert")] {
        submit(&store, &drillsweep_store::NewSweep { owner: owner.to_owned(), ..sweep(id, [1]) }).await;
    }
    let ids = async |owner, before, limit| -> Vec<String> {
        store
            .sweeps(&SweepFilter { owner, ..SweepFilter::default() }, before, limit)
            .await
            .unwrap()
            .into_iter()
            .map(|sweep| sweep.id)
            .collect()
    };
    assert_eq!(ids(None, None, 2).await, ["t3", "t2"]);
    assert_eq!(ids(None, Some("t2"), 2).await, ["t1", "s"]);
    assert_eq!(ids(Some("bert"), None, 10).await, ["t3", "t1"]);
}

pub(crate) async fn everything_is_there_after_reopening<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2, 3])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let running = claim(&store, "w").await;
    let before = sweep_record(&store, "s").await;
    store.close().await;

    let store = engine.open().await;
    assert_eq!(sweep_record(&store, "s").await, before);
    assert_eq!(states(&store, "s").await, [WorkState::Done, WorkState::Leased, WorkState::Queued]);
    assert!(finish(&store, &running).await);
}
