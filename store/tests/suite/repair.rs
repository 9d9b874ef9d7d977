//! Results that storage has lost are computed again, and are whole after that.

use drillsweep_store::{BlobId, Claim, Repair, RepairReport, Store, WorkState};

use crate::bench::{
    Engine, PHYSICS, claim, claim_or_none, finish, key, point_record, states, submit, sweep, sweep_record,
};
use crate::place::object_name;

/// The blob of the only table of [`finish`], damaged after the work item was done.
async fn damaged<E: Engine>(engine: &E, store: &Store, number: u32) -> BlobId {
    let claim = claim(store, "w").await;
    assert_eq!(claim.lease.key, key(number));
    assert!(finish(store, &claim).await);
    let blob: BlobId = store.artifacts(&claim.lease.key).await.unwrap()[0].blob.parse().unwrap();
    engine.write_object(&object_name(&blob.to_string()), b"");
    assert!(store.blobs().get(blob).await.unwrap_err().is_damage());
    blob
}

async fn fail(store: &Store, claim: &Claim) {
    assert!(store.finish_failed(&claim.lease, r#"{"class":"physical"}"#).await.unwrap());
}

pub(crate) async fn a_lost_table_is_computed_again_and_is_whole_then<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let blob = damaged(&engine, &store, 1).await;
    assert_eq!(store.known_results(&[(key(1), None)]).await.unwrap(), 1);

    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::Queued);
    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::UnderWay);
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.queued, record.finished), (1, None));
    // The summary is in the database, and stays.
    assert!(point_record(&store, "s", 1).await.summary_json.is_some());
    assert_eq!(store.known_results(&[(key(1), None)]).await.unwrap(), 0);

    assert!(finish(&store, &claim(&store, "w").await).await);
    assert_eq!(store.blobs().get(blob).await.unwrap(), key(1).as_slice());
    assert!(sweep_record(&store, "s").await.finished.is_some());
    assert_eq!(store.known_results(&[(key(1), None)]).await.unwrap(), 1);
    assert_eq!(store.check().await.unwrap().problems, Vec::<String>::new());
    // It may be lost again.
    engine.delete_object(&object_name(&blob.to_string()));
    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::Queued);
}

pub(crate) async fn a_failed_repair_is_not_repeated_at_every_read<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let blob = damaged(&engine, &store, 1).await;
    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::Queued);
    fail(&store, &claim(&store, "w").await).await;
    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::TriedBefore);
    assert_eq!(claim_or_none(&store, "w").await, None);
    // A request for the point needs it whole.
    submit(&store, &sweep("t", [1])).await;
    assert_eq!(states(&store, "t").await, [WorkState::Queued]);
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert_eq!(store.blobs().get(blob).await.unwrap(), key(1).as_slice());
}

pub(crate) async fn a_repair_does_not_depend_on_other_sweeps<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("a", [1])).await;
    submit(&store, &sweep("b", [1])).await;
    let blob = damaged(&engine, &store, 1).await;
    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::Queued);
    assert!(store.pause_sweep("a", true).await.unwrap());
    assert!(store.cancel_sweep("a").await.unwrap());
    let again = claim(&store, "w").await;
    assert!(store.cancel_sweep("b").await.unwrap());
    // Nobody is left who wants it: the result that there is stays.
    assert!(store.finish_cancelled(&again.lease, "{}").await.unwrap());
    assert_eq!(states(&store, "b").await, [WorkState::Done]);
}

pub(crate) async fn a_repair_waits_while_its_sweep_is_paused<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let blob = damaged(&engine, &store, 1).await;
    assert!(store.pause_sweep("s", true).await.unwrap());
    assert_eq!(store.queue_damaged(&key(1), blob, PHYSICS).await.unwrap(), Repair::Queued);
    assert_eq!(claim_or_none(&store, "w").await, None);
    assert!(store.pause_sweep("s", false).await.unwrap());
    assert!(finish(&store, &claim(&store, "w").await).await);
}

pub(crate) async fn a_repair_of_an_abandoned_version_is_not_queued<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let blob = damaged(&engine, &store, 1).await;
    let later = PHYSICS + 1;
    assert_eq!(store.queue_damaged(&key(1), blob, later).await.unwrap(), Repair::OtherNumbers(PHYSICS));
    assert_eq!(states(&store, "s").await, [WorkState::Done]);
    let other: BlobId = "0".repeat(64).parse().unwrap();
    assert_eq!(store.queue_damaged(&key(1), other, PHYSICS).await.unwrap(), Repair::Replaced);
}

pub(crate) async fn a_check_repairs_all_that_it_finds<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2, 3])).await;
    for number in [1, 2] {
        damaged(&engine, &store, number).await;
    }
    assert!(finish(&store, &claim(&store, "w").await).await);
    let found = store.check().await.unwrap();
    assert_eq!(found.problems.len(), 2, "{found:?}");
    let report = store.repair(&found, PHYSICS).await.unwrap();
    assert_eq!(report, RepairReport { queued: 2, ..RepairReport::default() });
    assert_eq!(states(&store, "s").await, [WorkState::Queued, WorkState::Queued, WorkState::Done]);
    let report = store.repair(&found, PHYSICS).await.unwrap();
    assert_eq!(report, RepairReport { under_way: 2, ..RepairReport::default() });
    assert!(finish(&store, &claim(&store, "w").await).await);
    fail(&store, &claim(&store, "w").await).await;
    // Whoever asks for the repair wants another try.
    let found = store.check().await.unwrap();
    let report = store.repair(&found, PHYSICS).await.unwrap();
    assert_eq!(report, RepairReport { queued: 1, ..RepairReport::default() });
    assert!(finish(&store, &claim(&store, "w").await).await);
    let found = store.check().await.unwrap();
    assert_eq!(found.problems, Vec::<String>::new());
    assert_eq!(store.repair(&found, PHYSICS).await.unwrap(), RepairReport::default());
}
