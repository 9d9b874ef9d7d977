//! The check of the whole store: silent where all is well, and naming what was damaged.

use drillsweep_store::StoreError;

use crate::bench::{Engine, claim, finish, submit, sweep};
use crate::place::object_name;

pub(crate) async fn a_whole_store_has_no_problems_and_damage_to_blobs_is_named<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", 1..=3)).await;
    let (mut blobs, mut contents) = (Vec::new(), Vec::new());
    for _ in 0..3 {
        let claim = claim(&store, "w").await;
        assert!(finish(&store, &claim).await);
        contents.push(claim.lease.key);
        blobs.push(store.put_blob(claim.lease.key.to_vec()).await.unwrap().to_string());
    }
    let report = store.check().await.unwrap();
    assert_eq!((report.results, report.blobs, report.bytes), (3, 3, 96));
    assert_eq!(report.problems, Vec::<String>::new());

    let [gone, changed, cut] = [0, 1, 2].map(|number: usize| object_name(&blobs[number]));
    engine.delete_object(&gone);
    contents[1][7] ^= 1;
    engine.write_object(&changed, &contents[1]);
    engine.write_object(&cut, &contents[2][..16]);
    let problems = store.check().await.unwrap().problems;
    assert_eq!(problems.len(), 3, "{problems:?}");
    let of = |blob: &String| problems.iter().find(|problem| problem.contains(blob.as_str())).unwrap();
    assert!(of(&blobs[0]).contains("not found"), "{problems:?}");
    assert!(of(&blobs[1]).contains("does not match its hash"), "{problems:?}");
    assert!(of(&blobs[2]).contains("does not match its hash"), "{problems:?}");
    // Nor is it handed out.
    assert!(matches!(store.blobs().get(blobs[1].parse().unwrap()).await, Err(StoreError::BlobDamaged(_))));
}
