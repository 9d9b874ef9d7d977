//! Pausing, changing, extending and refreshing: what a sweep's owner does with it while it runs.

use std::time::Duration;

use drillsweep_store::{
    Addition, AppendOutcome, CachePolicy, ChangeOutcome, NewArtifact, NewPoint, NewResult, NewSweep,
    QueueDepths, StateCounts, Store, SubmitOutcome, SweepChanges, SweepFilter, WorkState,
};

use crate::bench::{
    Engine, PHYSICS, addition, claim, claim_or_none, finish, json, key, point_record, result, scenario,
    states, submit, sweep, sweep_record,
};

const LONG_AGO: Duration = Duration::from_secs(86_400);

pub(crate) async fn a_paused_sweep_is_not_handed_out_until_it_goes_on<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let running = claim(&store, "w").await;
    assert!(store.pause_sweep("s", true).await.unwrap());
    assert!(sweep_record(&store, "s").await.is_paused);
    assert_eq!(claim_or_none(&store, "w").await, None);
    let depths = QueueDepths { held: 1, leased: 1, ..QueueDepths::default() };
    assert_eq!(store.queue_depths().await.unwrap(), depths);
    assert_eq!(engine.after(9_000).await.census(LONG_AGO).await.unwrap().oldest_queued_ms, 0);
    // Running points continue; returned ones wait with the rest.
    assert!(store.release(&running.lease).await.unwrap());
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert_eq!(states(&store, "s").await, [WorkState::Queued; 2]);
    assert!(store.pause_sweep("s", false).await.unwrap());
    for _ in 0..2 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    assert!(sweep_record(&store, "s").await.finished.is_some());
    assert!(!store.pause_sweep("t", true).await.unwrap());
}

pub(crate) async fn a_pause_does_not_hold_work_of_another_sweep<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2])).await;
    submit(&store, &sweep("b", [2])).await;
    assert!(store.pause_sweep("a", true).await.unwrap());
    let shared = claim(&store, "w").await;
    assert_eq!(shared.lease.key, key(2));
    assert_eq!(claim_or_none(&store, "w").await, None);
    // A new sweep that wants a held point lets it go; once it is cancelled, the pause holds again.
    submit(&store, &sweep("c", [1])).await;
    assert!(store.cancel_sweep("c").await.unwrap());
    assert_eq!(states(&store, "a").await[0], WorkState::Queued);
    assert_eq!(claim_or_none(&store, "w").await, None);
    submit(&store, &sweep("d", [1])).await;
    assert_eq!(claim(&store, "w").await.lease.key, key(1));
}

pub(crate) async fn editable_fields_of_a_sweep_are_changed<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1])).await;
    submit(&store, &sweep("b", [2, 3])).await;
    submit(&store, &NewSweep { priority: 3, ..sweep("c", [3]) }).await;
    let changes =
        SweepChanges { priority: Some(5), tags_json: Some(r#"["x"]"#.to_owned()), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("b", &changes, None).await.unwrap(), ChangeOutcome::Changed);
    let record = sweep_record(&store, "b").await;
    assert_eq!((record.priority, record.tags_json.as_str()), (5, r#"["x"]"#));
    assert_eq!(record.name.as_deref(), Some("sweep b"));
    // Back down: what a more urgent sweep wants too stays as urgent as that.
    let changes = SweepChanges { priority: Some(-5), name: Some(None), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("b", &changes, None).await.unwrap(), ChangeOutcome::Changed);
    assert_eq!(sweep_record(&store, "b").await.name, None);
    let expires = |at| SweepChanges { expires: Some(at), is_pinned: Some(true), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("a", &expires(Some(7)), None).await.unwrap(), ChangeOutcome::Changed);
    let record = sweep_record(&store, "a").await;
    assert_eq!((record.expires, record.is_pinned, record.name.as_deref()), (Some(7), true, Some("sweep a")));
    assert_eq!(
        store.change_sweep("a", &SweepChanges::default(), None).await.unwrap(),
        ChangeOutcome::Changed
    );
    assert_eq!(sweep_record(&store, "a").await.expires, Some(7));
    assert_eq!(store.change_sweep("a", &expires(None), None).await.unwrap(), ChangeOutcome::Changed);
    assert_eq!(sweep_record(&store, "a").await.expires, None);
    let mut order = Vec::new();
    while let Some(claim) = claim_or_none(&store, "w").await {
        order.push(claim.lease.key);
    }
    assert_eq!(order, [key(3), key(1), key(2)]);
    assert_eq!(store.change_sweep("t", &changes, None).await.unwrap(), ChangeOutcome::NoSuchSweep);
}

pub(crate) async fn a_change_of_a_stale_version_is_refused<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let read = sweep_record(&store, "s").await.revision;
    // Progress of the points is no change of the sweep.
    assert!(finish(&store, &claim(&store, "w").await).await);
    let named = |name: &str| SweepChanges { name: Some(Some(name.to_owned())), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("s", &named("anne's"), Some(read)).await.unwrap(), ChangeOutcome::Changed);
    let late = store.change_sweep("s", &named("bob's"), Some(read)).await.unwrap();
    assert_eq!(late, ChangeOutcome::OtherRevision);
    assert_eq!(sweep_record(&store, "s").await.name.as_deref(), Some("anne's"));
    for step in 0..3 {
        let before = sweep_record(&store, "s").await.revision;
        match step {
            0 => assert!(store.pause_sweep("s", true).await.unwrap()),
            1 => assert!(store.cancel_sweep("s").await.unwrap()),
            _ => assert_eq!(store.retry_sweep("s").await.unwrap(), Some(1)),
        }
        assert!(sweep_record(&store, "s").await.revision > before);
    }
}

pub(crate) async fn points_are_added_once_and_go_on_from_the_last<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    for _ in 0..2 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    assert!(sweep_record(&store, "s").await.finished.is_some());
    let points: Vec<NewPoint> = sweep("s", [2, 3, 3, 4]).points;
    let base = scenario("s", 0).base_json;
    let addition = addition(&base, &points, r#"{"added":1}"#);
    let append = async |limit| store.append_points("s", &addition, limit).await.unwrap();
    assert_eq!(store.lacking_points("s", &points).await.unwrap(), [2, 4]);
    assert_eq!(append(3).await, AppendOutcome::TooMany(4));
    assert_eq!(append(4).await, AppendOutcome::Added(2));
    assert_eq!(append(4).await, AppendOutcome::Added(0));
    let record = sweep_record(&store, "s").await;
    assert_eq!(record.counts, StateCounts { total: 4, queued: 2, done: 2, ..StateCounts::default() });
    assert_eq!(record.finished, None);
    assert_eq!(store.appended_requests("s", 9, 100).await.unwrap(), [r#"{"added":1}"#]);
    assert_eq!(point_record(&store, "s", 3).await.work_key, key(3));
    assert_eq!(point_record(&store, "s", 4).await.work_key, key(4));
    for _ in 0..2 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    let finished = sweep_record(&store, "s").await.finished;
    assert!(finished.is_some());
    let later = engine.after(60_000).await;
    let again = later.append_points("s", &addition, 9).await.unwrap();
    assert_eq!(again, AppendOutcome::Added(0));
    assert_eq!(sweep_record(&store, "s").await.finished, finished, "nothing was added, nothing ends anew");
    let of_others = Addition { physics_version: PHYSICS + 1, ..addition };
    let others = store.append_points("s", &of_others, 9).await.unwrap();
    assert_eq!(others, AppendOutcome::OtherNumbers(PHYSICS));
    assert!(store.cancel_sweep("s").await.unwrap());
    assert_eq!(append(9).await, AppendOutcome::Cancelled);
    let none = store.append_points("t", &addition, 9).await.unwrap();
    assert_eq!(none, AppendOutcome::NoSuchSweep);
}

pub(crate) async fn points_added_to_a_paused_sweep_wait<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    // Work that was cancelled before it could be held back.
    submit(&store, &sweep("gone", [2])).await;
    assert!(store.cancel_sweep("gone").await.unwrap());
    submit(&store, &sweep("s", [1])).await;
    assert!(store.pause_sweep("s", true).await.unwrap());
    let points = sweep("s", [2, 3]).points;
    let base = scenario("s", 0).base_json;
    let added = store.append_points("s", &addition(&base, &points, "{}"), 9).await.unwrap();
    assert_eq!(added, AppendOutcome::Added(2));
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert!(store.pause_sweep("s", false).await.unwrap());
    for _ in 0..3 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    assert_eq!(states(&store, "s").await, [WorkState::Done; 3]);
}

/// Adds a point to a sweep.
async fn append_one(store: &Store, id: &str, number: u32, request: &str) {
    let (points, base) = (sweep(id, [number]).points, scenario(id, 0).base_json);
    let added = store.append_points(id, &addition(&base, &points, request), 100_000).await.unwrap();
    assert_eq!(added, AppendOutcome::Added(1));
}

pub(crate) async fn requests_are_kept_in_order_and_returned_up_to_a_limit<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [0])).await;
    submit(&store, &sweep("other", [0])).await;
    for number in 1..=12 {
        append_one(&store, "s", number, &format!(r#"{{"added":{number}}}"#)).await;
        append_one(&store, "other", number, "{}").await;
    }
    let kept = async |limit, bytes| store.appended_requests("s", limit, bytes).await.unwrap();
    let expected: Vec<String> = (1..=12).map(|number| format!(r#"{{"added":{number}}}"#)).collect();
    assert_eq!(kept(i64::MAX, i64::MAX).await, expected);
    assert_eq!(kept(3, i64::MAX).await, expected[9..]);
    // The last three have 12 bytes each, those before 11.
    for (bytes, first) in [(11, 12), (12, 11), (35, 10), (36, 9), (47, 8), (3 * 12 + 9 * 11, 0)] {
        assert_eq!(kept(i64::MAX, bytes).await, expected[first..], "{bytes}");
    }
    assert_eq!(store.appended_bytes("s").await.unwrap(), 3 * 12 + 9 * 11);
    assert_eq!(store.appended_bytes("none").await.unwrap(), 0);
    let record = sweep_record(&store, "s").await;
    assert_eq!(record.counts, StateCounts { total: 13, queued: 13, ..StateCounts::default() });
    assert_eq!(point_record(&store, "s", 13).await.work_key, key(12));
}

/// A sweep of work item 1 that asks to recompute it.
fn refresh(id: &str) -> NewSweep {
    NewSweep { cache: CachePolicy::Refresh, ..sweep(id, [1]) }
}

pub(crate) async fn a_refresh_computes_anew_and_keeps_the_old_result_until_then<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("old", [1])).await;
    assert!(finish(&store, &claim(&store, "first").await).await);
    submit(&store, &refresh("new")).await;
    let summary = async |id: &str| point_record(&store, id, 1).await.summary_json;
    assert_eq!(states(&store, "new").await, [WorkState::Queued]);
    assert_eq!(summary("old").await.as_deref(), Some(r#"{"by":"first"}"#));
    assert!(finish(&store, &claim(&store, "second").await).await);
    assert_eq!(summary("old").await.as_deref(), Some(r#"{"by":"second"}"#));
    assert_eq!(store.artifacts(&key(1)).await.unwrap().len(), 1);
}

pub(crate) async fn a_refresh_by_another_owner_leaves_finished_sweeps_as_they_are<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("old", [1, 2])).await;
    finish_with(&store, "first", r#"{"radius":1}"#, b"orbit", true).await;
    let failed = claim(&store, "first").await;
    assert!(store.finish_failed(&failed.lease, "{}").await.unwrap());
    let before = sweep_record(&store, "old").await;
    let others =
        NewSweep { owner: "another".to_owned(), cache: CachePolicy::Refresh, ..sweep("new", [1, 2]) };
    submit(&store, &others).await;
    assert_eq!(sweep_record(&store, "old").await, before);
    assert_eq!(states(&store, "new").await, [WorkState::Queued, WorkState::Queued]);
    // Until the new one is there the old result is shown, with its tables.
    let point = async || point_record(&store, "new", 1).await;
    assert_eq!(point().await.summary_json.as_deref(), Some(r#"{"radius":1}"#));
    assert_eq!(store.artifacts(&point().await.work_key).await.unwrap().len(), 1);

    finish_with(&store, "second", r#"{"radius":2}"#, b"orbit", true).await;
    finish_with(&store, "second", r#"{"radius":3}"#, b"another", true).await;
    let told = r#"{"worker":"second","disagreement":{"differs":"summary","earlier":{"worker":"first"}}}"#;
    assert_eq!(json(&point().await.provenance_json.unwrap()), json(told));
    assert_eq!(sweep_record(&store, "old").await, before);
    assert_eq!(states(&store, "old").await, [WorkState::Done, WorkState::Failed]);
    let old = point_record(&store, "old", 1).await;
    assert_eq!(old.summary_json.as_deref(), Some(r#"{"radius":1}"#));
    assert!(!old.provenance_json.unwrap().contains("disagreement"));
    // The sweep has its points, whichever work they are of.
    let lacking = store.lacking_points("new", &sweep("new", [1, 2, 3]).points).await.unwrap();
    assert_eq!(lacking, [3]);
    // Another refresh recomputes its own points, and those that nobody else has.
    submit(&store, &NewSweep { cache: CachePolicy::Refresh, ..sweep("again", [1]) }).await;
    assert_eq!(states(&store, "again").await, [WorkState::Queued]);
    assert_eq!(states(&store, "old").await, [WorkState::Queued, WorkState::Failed]);
    assert_eq!(states(&store, "new").await, [WorkState::Done, WorkState::Done]);
}

/// Claims what is next and finishes it with this summary and, as the history, this content.
async fn finish_with(store: &Store, worker: &str, summary: &str, history: &[u8], is_repeatable: bool) {
    let claim = claim(store, worker).await;
    let artifact = NewArtifact {
        name: "history".to_owned(),
        media_type: "application/octet-stream".to_owned(),
        blob: store.put_blob(history.to_vec()).await.unwrap(),
        bytes: history.len() as i64,
        row_count: 1,
    };
    let provenance = format!(r#"{{"worker":"{worker}"}}"#);
    let result = NewResult {
        summary_json: summary,
        provenance_json: &provenance,
        artifacts: &[artifact],
        is_repeatable,
    };
    assert!(store.finish_done(&claim.lease, &result).await.unwrap());
}

pub(crate) async fn a_disagreeing_refresh_is_reported<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let provenance = async || point_record(&store, "s", 1).await.provenance_json.unwrap();
    let disagreements = async || store.census(LONG_AGO).await.unwrap().disagreements;
    submit(&store, &sweep("s", [1])).await;
    finish_with(&store, "first", r#"{"radius":1}"#, b"orbit", true).await;
    submit(&store, &refresh("same")).await;
    finish_with(&store, "second", r#"{"radius":1}"#, b"orbit", true).await;
    assert_eq!(json(&provenance().await), json(r#"{"worker":"second"}"#));
    assert_eq!(disagreements().await, 0);

    submit(&store, &refresh("summary")).await;
    finish_with(&store, "third", r#"{"radius":2}"#, b"orbit", true).await;
    let told = r#"{"worker":"third","disagreement":{"differs":"summary","earlier":{"worker":"second"}}}"#;
    assert_eq!(json(&provenance().await), json(told));
    submit(&store, &refresh("history")).await;
    finish_with(&store, "fourth", r#"{"radius":2}"#, b"another orbit", true).await;
    let disagreement = r#""disagreement":{"differs":"history","earlier":{"worker":"third"}}"#;
    assert_eq!(json(&provenance().await), json(&format!(r#"{{"worker":"fourth",{disagreement}}}"#)));
    // Agreement of the last two does not resolve it.
    submit(&store, &refresh("again")).await;
    finish_with(&store, "fifth", r#"{"radius":2}"#, b"another orbit", true).await;
    assert_eq!(json(&provenance().await), json(&format!(r#"{{"worker":"fifth",{disagreement}}}"#)));
    assert_eq!(disagreements().await, 1, "results, not times");
    assert_eq!(point_record(&store, "s", 1).await.summary_json.as_deref(), Some(r#"{"radius":2}"#));
}

pub(crate) async fn a_table_missing_from_a_refresh_is_reported<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    finish_with(&store, "first", "{}", b"orbit", true).await;
    submit(&store, &refresh("without")).await;
    let second = claim(&store, "second").await;
    assert!(store.finish_done(&second.lease, &result("{}", &[])).await.unwrap());
    let told = r#"{"version":"test","disagreement":{"differs":"history","earlier":{"worker":"first"}}}"#;
    assert_eq!(json(&point_record(&store, "s", 1).await.provenance_json.unwrap()), json(told));
}

pub(crate) async fn a_refresh_of_measured_times_may_disagree<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    finish_with(&store, "first", r#"{"seconds":1}"#, b"one", false).await;
    submit(&store, &refresh("new")).await;
    finish_with(&store, "second", r#"{"seconds":2}"#, b"two", false).await;
    assert_eq!(store.census(LONG_AGO).await.unwrap().disagreements, 0);
    assert_eq!(point_record(&store, "s", 1).await.provenance_json.as_deref(), Some(r#"{"worker":"second"}"#));
}

pub(crate) async fn a_refresh_follows_the_state_of_its_sweep<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("old", [1])).await;
    assert!(finish(&store, &claim(&store, "first").await).await);
    // Paused: not computed, though a live sweep has the point; that one has its result.
    submit(&store, &refresh("new")).await;
    assert!(store.pause_sweep("new", true).await.unwrap());
    assert_eq!(claim_or_none(&store, "w").await, None);
    // Cancelled before it began: the old result stands.
    assert!(store.cancel_sweep("new").await.unwrap());
    assert_eq!(states(&store, "old").await, [WorkState::Done]);
    // Cancelled under way: likewise, as soon as the worker hears of it.
    submit(&store, &refresh("again")).await;
    let running = claim(&store, "second").await;
    assert!(store.cancel_sweep("again").await.unwrap());
    assert!(store.release(&running.lease).await.unwrap());
    assert_eq!(states(&store, "old").await, [WorkState::Done]);
    let record = sweep_record(&store, "old").await;
    assert_eq!(record.counts, StateCounts { total: 1, done: 1, ..StateCounts::default() });
    assert!(record.finished.is_some());
    let point = point_record(&store, "old", 1).await;
    assert_eq!(point.summary_json.as_deref(), Some(r#"{"by":"first"}"#));
}

pub(crate) async fn a_failed_refresh_keeps_the_old_result_and_reports_its_error<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("old", [1])).await;
    assert!(finish(&store, &claim(&store, "first").await).await);
    let error = r#"{"class":"timeout"}"#;
    submit(&store, &refresh("timeout")).await;
    let running = claim(&store, "second").await;
    assert!(store.finish_failed(&running.lease, error).await.unwrap());
    let point = point_record(&store, "timeout", 1).await;
    assert_eq!((point.state, point.error_json.as_deref()), (WorkState::Done, Some(error)));
    assert_eq!(point.summary_json.as_deref(), Some(r#"{"by":"first"}"#));

    submit(&store, &refresh("crash")).await;
    for _ in 0..3 {
        assert!(store.crashed(&claim(&store, "third").await.lease, "{}").await.unwrap());
    }
    submit(&store, &refresh("disk")).await;
    for round in 0..5 {
        let later = engine.after(round * 100_000).await;
        assert!(later.retry_later(&claim(&later, "fourth").await.lease, "{}").await.unwrap());
    }
    submit(&store, &refresh("silence")).await;
    for round in 5..8 {
        claim(&engine.after(round * 100_000).await, "fifth").await;
    }
    assert_eq!(engine.after(900_000).await.reap_expired().await.unwrap(), 1);
    assert_eq!(states(&store, "old").await, [WorkState::Done]);
    let point = point_record(&store, "old", 1).await;
    assert_eq!(point.summary_json.as_deref(), Some(r#"{"by":"first"}"#));
    assert!(point.error_json.unwrap().contains("3 workers went silent"));
}

pub(crate) async fn a_refresh_begins_at_the_beginning<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("old", [1])).await;
    let running = claim(&store, "first").await;
    let blob = store.put_blob(b"half of it".to_vec()).await.unwrap();
    assert!(store.keep_checkpoint(&running.lease, blob).await.unwrap());
    assert!(store.finish_failed(&running.lease, "{}").await.unwrap());
    submit(&store, &refresh("new")).await;
    assert_eq!(claim(&store, "second").await.checkpoint, None);
}

pub(crate) async fn a_submission_of_known_points_alone_refuses_others<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("known", [1, 2, 3])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let failing = claim(&store, "w").await;
    assert!(store.finish_failed(&failing.lease, "{}").await.unwrap());
    let only = |id: &str, numbers: &[u32]| NewSweep {
        cache: CachePolicy::Only,
        ..sweep(id, numbers.iter().copied())
    };
    let outcome = store.submit_sweep(&only("some", &[1, 3, 2, 4])).await.unwrap();
    assert_eq!(outcome, SubmitOutcome::NotComputed { points: vec![2, 4], verifications: vec![] });
    assert_eq!(store.sweep("some").await.unwrap(), None);
    submit(&store, &only("all", &[1, 2])).await;
    assert_eq!(states(&store, "all").await, [WorkState::Done, WorkState::Failed]);
    // A result that is being recomputed is one all the same.
    submit(&store, &refresh("new")).await;
    submit(&store, &only("meanwhile", &[1])).await;
}

pub(crate) async fn sweeps_are_found_by_their_tags_and_states<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    for (id, tags) in [("a", r#"["x","y"]"#), ("b", r#"["xy"]"#), ("c", "[]")] {
        submit(&store, &NewSweep { tags_json: tags.to_owned(), ..sweep(id, [1]) }).await;
    }
    assert!(store.pause_sweep("c", true).await.unwrap());
    let found = async |filter: SweepFilter<'_>| -> Vec<String> {
        store.sweeps(&filter, None, 10).await.unwrap().into_iter().map(|sweep| sweep.id).collect()
    };
    let tagged = |tag| SweepFilter { tag: Some(tag), ..SweepFilter::default() };
    assert_eq!(found(tagged("x")).await, ["a"]);
    assert_eq!(found(tagged("y")).await, ["a"]);
    assert!(found(tagged("[]")).await.is_empty());
    let state = |state| SweepFilter { state: Some(state), ..SweepFilter::default() };
    assert_eq!(found(state("paused")).await, ["c"]);
    assert_eq!(found(state("running")).await, ["b", "a"]);
}
