//! Retention: what expires, what stays, and that the space comes back.

use std::collections::BTreeMap;
use std::time::Duration;

use drillsweep_store::{
    BlobId, ChangeOutcome, DeleteOutcome, Garbage, NewResult, NewSweep, Renewal, RetentionPolicy, Store,
    StoreError, SweepChanges,
};

use crate::bench::{Engine, claim, finish, key, point_record, submit, sweep, sweep_record};

const HOUR: u64 = 3_600;
const DAY: u64 = 24 * HOUR;
pub(crate) const DAY_MS: i64 = DAY as i64 * 1_000;

/// Histories for 30 days, all else for a year.
fn policy() -> RetentionPolicy {
    RetentionPolicy {
        artifact_ages: BTreeMap::from([("history".to_owned(), Duration::from_secs(30 * DAY))]),
        other_artifacts: Duration::from_secs(365 * DAY),
        events: Duration::from_secs(30 * DAY),
        blob_grace: Duration::from_secs(DAY),
    }
}

pub(crate) async fn collect(store: &Store) -> Garbage {
    let told = store.collect_garbage(&policy(), true).await.unwrap();
    let done = store.collect_garbage(&policy(), false).await.unwrap();
    assert_eq!(told, done, "a dry run tells what is then done");
    assert_eq!(
        store.collect_garbage(&policy(), false).await.unwrap(),
        Garbage::default(),
        "and once is enough"
    );
    done
}

pub(crate) async fn a_blob_that_no_row_names_goes_after_its_grace<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    assert!(finish(&store, &claim(&store, "w").await).await);
    let named = engine.bytes_of_objects();
    let orphan = store.put_blob(vec![7; 1_000]).await.unwrap();
    assert_eq!(collect(&engine.after(DAY_MS / 2).await).await, Garbage::default());
    let found = collect(&engine.after(DAY_MS + 60_000).await).await;
    assert_eq!(found, Garbage { blobs: 1, blob_bytes: 1_000, ..Garbage::default() });
    assert!(store.blobs().get(orphan).await.is_err());
    assert_eq!(engine.bytes_of_objects(), named);
}

pub(crate) async fn a_blob_that_was_written_for_a_row_to_come_stays_for_an_hour<E: Engine>() {
    const HOUR_MS: i64 = 3_600_000;
    let engine = E::new();
    let blob = engine.open().await.put_blob(vec![7; 1_000]).await.unwrap();
    // Two days later it is garbage; but another worker has the same to store, and finds it there.
    let later = engine.after(2 * DAY_MS).await;
    assert_eq!(later.put_blob(vec![7; 1_000]).await.unwrap(), blob);
    assert_eq!(collect(&engine.after(2 * DAY_MS + HOUR_MS - 60_000).await).await, Garbage::default());
    let found = collect(&engine.after(2 * DAY_MS + HOUR_MS + 60_000).await).await;
    assert_eq!(found, Garbage { blobs: 1, blob_bytes: 1_000, ..Garbage::default() });
    // A deleted blob can be written again.
    let blob = later.put_blob(vec![7; 1_000]).await.unwrap();
    assert_eq!(later.blobs().get(blob).await.unwrap().len(), 1_000);
}

pub(crate) async fn blobs_that_are_reserved_together_all_stay_for_an_hour<E: Engine>() {
    const HOUR_MS: i64 = 3_600_000;
    let engine = E::new();
    let contents = [vec![7; 1_000], vec![8; 500]];
    let blobs = [BlobId::of(&contents[0]), BlobId::of(&contents[1])];
    // Long since garbage, and found there by who has the same to store.
    let store = engine.open().await;
    for content in contents {
        store.blobs().put(content).await.unwrap();
    }
    let later = engine.after(2 * DAY_MS).await;
    submit(&later, &sweep("s", [1])).await;
    let lease = claim(&later, "w").await.lease;
    assert_eq!(later.reserve(&lease, 60_000, &blobs).await.unwrap(), Renewal::Held);
    assert_eq!(collect(&engine.after(2 * DAY_MS + HOUR_MS - 60_000).await).await, Garbage::default());
    let found = collect(&engine.after(2 * DAY_MS + HOUR_MS + 60_000).await).await;
    assert_eq!(found, Garbage { blobs: 2, blob_bytes: 1_500, ..Garbage::default() });
}

pub(crate) async fn leftovers_of_a_killed_upload_are_collected_and_foreign_files_kept<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    engine.abandon_upload(b"half");
    engine.write_object("README", b"not ours");
    drop(store);
    let found = collect(&engine.after(2 * DAY_MS).await).await;
    assert_eq!(found, Garbage { unfinished_uploads: 1, unfinished_bytes: 4, ..Garbage::default() });
    assert_eq!(engine.bytes_of_objects(), 8);
}

pub(crate) async fn an_artifact_expires_with_the_youngest_sweep_that_has_it_unless_one_is_pinned<
    E: Engine,
>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("old", [1, 2, 3])).await;
    for _ in 0..3 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    submit(&engine.after(20 * DAY_MS).await, &sweep("young", [2])).await;
    submit(&store, &sweep("pinned", [3])).await;
    let pin = |is_pinned| SweepChanges { is_pinned: Some(is_pinned), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("pinned", &pin(true), None).await.unwrap(), ChangeOutcome::Changed);
    let before = engine.bytes_of_objects();

    let later = engine.after(31 * DAY_MS).await;
    let found = collect(&later).await;
    assert_eq!((found.artifacts, found.blobs, found.blob_bytes), (1, 1, 32));
    assert_eq!(engine.bytes_of_objects(), before - 32);
    for (number, is_expired) in [(1, true), (2, false), (3, false)] {
        let artifact = &later.artifacts(&key(number)).await.unwrap()[0];
        assert_eq!(artifact.expired.is_some(), is_expired, "{number}");
        assert_eq!(later.blobs().get(artifact.blob.parse().unwrap()).await.is_err(), is_expired);
    }
    assert!(point_record(&later, "old", 1).await.summary_json.is_some(), "the summary stays");

    assert_eq!(later.change_sweep("pinned", &pin(false), None).await.unwrap(), ChangeOutcome::Changed);
    let found = collect(&engine.after(51 * DAY_MS).await).await;
    assert_eq!((found.artifacts, found.blobs), (2, 2));
    assert_eq!(engine.bytes_of_objects(), before - 3 * 32);
}

pub(crate) async fn a_sweep_expires_and_leaves_shared_results<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("goes", [1, 2])).await;
    submit(&store, &sweep("goes too", [3])).await;
    submit(&store, &sweep("stays", [2])).await;
    submit(&store, &sweep("unfinished", [9])).await;
    for _ in 0..3 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    let now = store.now_ms().await.unwrap();
    for id in ["goes", "goes too", "unfinished"] {
        let changes = SweepChanges { expires: Some(Some(now + DAY_MS)), ..SweepChanges::default() };
        assert_eq!(store.change_sweep(id, &changes, None).await.unwrap(), ChangeOutcome::Changed);
    }
    // The scenario of "stays" is not in use: its point was there, by that of "goes".
    let found = collect(&engine.after(DAY_MS / 2).await).await;
    assert_eq!((found.sweeps, found.scenarios), (0, 1));
    let found = collect(&engine.after(2 * DAY_MS).await).await;
    assert_eq!((found.sweeps, found.results, found.scenarios, found.blobs), (2, 2, 1, 2));
    assert_eq!(store.sweep("goes").await.unwrap(), None);
    assert!(store.sweep("unfinished").await.unwrap().is_some());
    let point = point_record(&store, "stays", 1).await;
    assert!(point.summary_json.is_some());
    assert_eq!(point.scenario.unwrap().base_json, r#"{"scenario":"goes"}"#);
    // A deleted point can be requested again.
    submit(&store, &sweep("again", [1])).await;
    submit(&store, &sweep("more", [9])).await;
    assert!(store.sweep("again").await.unwrap().unwrap().finished.is_none());
}

pub(crate) async fn a_sweep_is_deleted_on_request_unless_it_is_pinned_or_unfinished<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1, 2])).await;
    submit(&store, &sweep("b", [2])).await;
    let delete = async |is_dry_run| store.delete_sweep("a", None, is_dry_run).await.unwrap();
    assert_eq!(delete(false).await, DeleteOutcome::Unfinished);
    for _ in 0..2 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    let pin = |is_pinned| SweepChanges { is_pinned: Some(is_pinned), ..SweepChanges::default() };
    assert_eq!(store.change_sweep("a", &pin(true), None).await.unwrap(), ChangeOutcome::Changed);
    assert_eq!(delete(false).await, DeleteOutcome::Pinned);
    let revision = sweep_record(&store, "a").await.revision;
    assert_eq!(store.change_sweep("a", &pin(false), None).await.unwrap(), ChangeOutcome::Changed);
    let late = store.delete_sweep("a", Some(revision), false).await.unwrap();
    assert_eq!(late, DeleteOutcome::OtherRevision);

    let expected = DeleteOutcome::Deleted { points: 2, results: 1, bytes: 32 };
    assert_eq!(delete(true).await, expected);
    assert!(store.sweep("a").await.unwrap().is_some());
    assert_eq!(delete(false).await, expected);
    assert!(store.sweep("a").await.unwrap().is_none());
    assert_eq!(delete(false).await, DeleteOutcome::NoSuchSweep);
    // Results that others share stay.
    assert!(point_record(&store, "b", 1).await.summary_json.is_some());
    assert_eq!(store.last_collection().await.unwrap(), None);
    let garbage = engine.after(2 * DAY_MS).await.collect_garbage(&policy(), false).await.unwrap();
    assert_eq!((garbage.results, garbage.blobs), (1, 1));
    let last = store.last_collection().await.unwrap().unwrap();
    assert_eq!(last.deleted_json, Some(garbage.to_json().to_string()));
    assert!(last.ended.is_some_and(|ended| ended >= last.started));
}

pub(crate) async fn no_row_names_a_blob_that_is_gone<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    // The worker finds the blob of an earlier result, and the collector takes it before the row is written.
    let claim = claim(&store, "w").await;
    let blob = store.put_blob(claim.lease.key.to_vec()).await.unwrap();
    assert_eq!(engine.after(2 * DAY_MS).await.collect_garbage(&policy(), false).await.unwrap().blobs, 1);
    let artifact = drillsweep_store::NewArtifact {
        name: "history".to_owned(),
        media_type: "application/vnd.apache.parquet".to_owned(),
        blob,
        bytes: 32,
        row_count: 7,
    };
    let result =
        NewResult { summary_json: "{}", provenance_json: "{}", artifacts: &[artifact], is_repeatable: true };
    let refused = store.finish_done(&claim.lease, &result).await;
    assert!(matches!(refused, Err(StoreError::BlobMissing(_))), "{refused:?}");
    // It still holds the lease, and writes the blob again.
    assert!(finish(&store, &claim).await);
}

pub(crate) async fn a_forgotten_owner_starts_like_an_idle_one<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    let of = |owner: &str, id: &str, numbers: std::ops::Range<u32>| NewSweep {
        owner: owner.to_owned(),
        ..sweep(id, numbers)
    };
    submit(&store, &of("anne", "a", 0..20)).await;
    submit(&store, &of("bert", "b", 100..110)).await;
    for _ in 0..20 {
        assert!(finish(&store, &claim(&store, "w").await).await);
    }
    // Bert has had all that he asked for and is forgotten; half of what Anne asked for waits.
    store.collect_garbage(&policy(), false).await.unwrap();
    submit(&store, &of("bert", "c", 200..210)).await;
    let mut of_bert = 0;
    for _ in 0..10 {
        let claim = claim(&store, "w").await;
        assert!(finish(&store, &claim).await);
        of_bert += usize::from((200..210).map(key).any(|key| key == claim.lease.key));
    }
    assert!((4..=6).contains(&of_bert), "{of_bert}");
}
