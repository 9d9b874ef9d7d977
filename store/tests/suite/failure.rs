//! The list of what was given up, over all sweeps.

use drillsweep_store::{FailureFilter, FailurePlace, FailureRecord, NewSweep, Store, WorkState};

use crate::bench::{Engine, claim, finish, submit, sweep};

async fn list(store: &Store, filter: FailureFilter<'_>, after: Option<&FailurePlace>) -> Vec<FailureRecord> {
    store.failures(&filter, after, 2).await.unwrap()
}

/// All of them, page by page.
async fn all(store: &Store, filter: FailureFilter<'_>) -> Vec<(String, i64)> {
    let mut found: Vec<FailureRecord> = Vec::new();
    loop {
        let place = found.last().map(FailureRecord::place);
        let page = list(store, filter, place.as_ref()).await;
        if page.is_empty() {
            return found.into_iter().map(|record| (record.sweep_id, record.point.ordinal)).collect();
        }
        found.extend(page);
    }
}

/// Fails the next piece of work in a way of its own.
async fn fail(store: &Store, error: &str) {
    let lease = claim(store, "w").await.lease;
    assert!(store.finish_failed(&lease, error).await.unwrap());
}

fn places(places: &[(&str, i64)]) -> Vec<(String, i64)> {
    places.iter().map(|(sweep, ordinal)| ((*sweep).to_owned(), *ordinal)).collect()
}

pub(crate) async fn dead_work_is_listed_over_all_sweeps_latest_first<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2, 3])).await;
    fail(&store, r#"{"class":"physical"}"#).await;
    let later = engine.after(1_000).await;
    fail(&later, r#"{"class":"timeout"}"#).await;
    assert!(finish(&later, &claim(&later, "w").await).await);
    // The same work as point 1 of "a", twice: it failed when it failed.
    submit(&later, &NewSweep { owner: "bert".to_owned(), ..sweep("b", [1, 4, 1]) }).await;
    let latest = engine.after(2_000).await;
    for _ in 0..3 {
        let doomed = claim(&latest, "w").await;
        assert!(latest.crashed(&doomed.lease, r#"{"class":"crash"}"#).await.unwrap());
    }

    let everything = FailureFilter::default();
    let order = [("b", 2), ("a", 2), ("b", 3), ("b", 1), ("a", 1)];
    assert_eq!(all(&store, everything).await, places(&order));
    let first = &list(&store, everything, None).await[0];
    assert_eq!((first.owner.as_str(), first.point.state), ("bert", WorkState::Dead));
    assert_eq!(first.sweep_name.as_deref(), Some("sweep b"));
    assert_eq!(first.point.error_json.as_deref(), Some(r#"{"class":"crash"}"#));

    let of_anne = FailureFilter { owner: Some("anne"), ..everything };
    assert_eq!(all(&store, of_anne).await, places(&[("a", 2), ("a", 1)]));
    let timeouts = FailureFilter { class: Some("timeout"), ..everything };
    assert_eq!(all(&store, timeouts).await, places(&[("a", 2)]));

    // Retried points are no longer given up.
    assert_eq!(store.retry_sweep("a").await.unwrap(), Some(2));
    assert_eq!(all(&store, everything).await, places(&[("b", 2)]));
}

pub(crate) async fn an_error_that_is_no_json_has_no_class<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1])).await;
    fail(&store, "of an older version").await;
    assert_eq!(all(&store, FailureFilter::default()).await.len(), 1);
    let physical = FailureFilter { class: Some("physical"), ..FailureFilter::default() };
    assert!(all(&store, physical).await.is_empty());
}
