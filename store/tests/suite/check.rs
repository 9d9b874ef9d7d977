//! The check of the whole store: silent where all is well, and naming what was damaged.

use drillsweep_store::{Role, StoreError};

use crate::bench::{Bench, claim, finish, submit, sweep};

#[tokio::test]
async fn a_whole_store_has_no_problems_and_damage_to_blobs_is_named() {
    let bench = Bench::new();
    let store = bench.open().await;
    submit(&store, &sweep("s", 1..=3)).await;
    let mut blobs = Vec::new();
    for _ in 0..3 {
        let claim = claim(&store, "w").await;
        assert!(finish(&store, &claim).await);
        blobs.push(store.blobs().put(claim.lease.key.to_vec()).await.unwrap().to_string());
    }
    let report = store.check().await.unwrap();
    assert_eq!((report.results, report.blobs, report.bytes), (3, 3, 96));
    assert_eq!(report.problems, Vec::<String>::new());

    let file = |blob: &str| {
        bench.config(Role::Server, 0).blob_directory.join(&blob[..2]).join(&blob[2..4]).join(blob)
    };
    std::fs::remove_file(file(&blobs[0])).unwrap();
    let mut content = std::fs::read(file(&blobs[1])).unwrap();
    content[7] ^= 1;
    std::fs::write(file(&blobs[1]), &content).unwrap();
    std::fs::write(file(&blobs[2]), &content[..16]).unwrap();
    let problems = store.check().await.unwrap().problems;
    assert_eq!(problems.len(), 3, "{problems:?}");
    let of = |blob: &String| problems.iter().find(|problem| problem.contains(blob.as_str())).unwrap();
    assert!(of(&blobs[0]).contains("not found"), "{problems:?}");
    assert!(of(&blobs[1]).contains("not what its name says"), "{problems:?}");
    assert!(of(&blobs[2]).contains("not what its name says"), "{problems:?}");
    // Nor is it handed out.
    assert!(matches!(store.blobs().get(blobs[1].parse().unwrap()).await, Err(StoreError::Corrupt(_))));
}
