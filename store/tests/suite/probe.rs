//! The probe tries the store out and leaves nothing behind.

use drillsweep_store::{QueueDepths, Role, StoreError};

use crate::bench::{Bench, claim_or_none, states, submit, sweep};

#[tokio::test]
async fn a_probe_leaves_nothing_behind() {
    let bench = Bench::new();
    let store = bench.open().await;
    submit(&store, &sweep("s", [1])).await;
    let before = states(&store, "s").await;
    store.probe().await.unwrap();
    assert_eq!(states(&store, "s").await, before);
    assert_eq!(store.queue_depths().await.unwrap(), QueueDepths { queued: 1, ..QueueDepths::default() });
    assert!(claim_or_none(&store, "w").await.is_some(), "the probe did not claim the real point");
    let files = std::fs::read_dir(bench.config(Role::Server, 0).blob_directory.join("probe")).unwrap();
    assert_eq!(files.count(), 0);
}

#[tokio::test]
async fn a_probe_notices_that_blobs_cannot_be_written() {
    let bench = Bench::new();
    let store = bench.open().await;
    let directory = bench.config(Role::Server, 0).blob_directory;
    // A file where the folder should be stops every user; permissions would not stop root.
    std::fs::write(directory.join("probe"), b"").unwrap();
    assert!(matches!(store.probe().await, Err(StoreError::Blob(_))));
}
