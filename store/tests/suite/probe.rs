//! The probe tries the store out and leaves nothing behind.

use drillsweep_store::{QueueDepths, StoreError};

use crate::bench::{Engine, claim_or_none, states, submit, sweep};

pub(crate) async fn a_probe_leaves_nothing_behind<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let before = states(&store, "s").await;
    store.probe().await.unwrap();
    assert_eq!(states(&store, "s").await, before);
    assert_eq!(store.queue_depths().await.unwrap(), QueueDepths { queued: 1, ..QueueDepths::default() });
    assert!(claim_or_none(&store, "w").await.is_some(), "the probe did not claim the real point");
    assert_eq!(engine.objects(), []);
}

pub(crate) async fn a_probe_notices_that_blobs_cannot_be_written<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    engine.refuse_scratch_objects();
    assert!(matches!(store.probe().await, Err(StoreError::Blob(_))));
}
