//! Owners take turns however much each of them has in the queue.

use drillsweep_store::{NewSweep, Store, WorkKey};

use crate::bench::{Engine, claim, finish, finish_and_claim, key, submit, sweep};

/// Largest lead under start-time fair queueing between two owners of equal weight who both have work all the time: the
/// cost of one piece of work of each (Goyal, Vin and Cheng 1996, theorem 1).
const BOUND: usize = 2;

async fn submit_of(store: &Store, owner: &str, id: &str, numbers: std::ops::Range<u32>) {
    submit(store, &NewSweep { owner: owner.to_owned(), ..sweep(id, numbers) }).await;
}

/// Claims and finishes work; tells what it was.
async fn serve(store: &Store, number: usize) -> Vec<WorkKey> {
    let mut served = Vec::new();
    for _ in 0..number {
        let claim = claim(store, "w").await;
        assert!(finish(store, &claim).await);
        served.push(claim.lease.key);
    }
    served
}

fn assert_even(served: &[WorkKey], one: std::ops::Range<u32>, other: std::ops::Range<u32>) {
    let (one, other) = (among(served, one), among(served, other));
    assert_eq!(one + other, served.len());
    assert!(one.abs_diff(other) <= BOUND, "{one} and {other}");
}

fn among(served: &[WorkKey], numbers: std::ops::Range<u32>) -> usize {
    let keys: Vec<_> = numbers.map(key).collect();
    served.iter().filter(|served| keys.contains(served)).count()
}

pub(crate) async fn ten_points_do_not_wait_for_ten_thousand<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "large", 0..10_000).await;
    assert_eq!(among(&serve(&store, 300).await, 0..10_000), 300);
    submit_of(&store, "bert", "small", 20_000..20_010).await;
    // Alone it would need ten turns; with one rival, twice as many and what the bound allows.
    assert_eq!(among(&serve(&store, 20 + BOUND).await, 20_000..20_010), 10);
}

pub(crate) async fn ten_points_do_not_wait_for_the_ten_thousand_that_they_are_among<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "large", 0..10_000).await;
    submit_of(&store, "bert", "small", 9_990..10_000).await;
    assert_eq!(among(&serve(&store, 20 + BOUND).await, 9_990..10_000), 10);
    // Not the other way round: who has a long queue does not move what others wait for to its end.
    submit_of(&store, "cleo", "few", 20_000..20_010).await;
    submit_of(&store, "anne", "all", 15_000..20_010).await;
    assert_eq!(among(&serve(&store, 20 + BOUND).await, 20_000..20_010), 10);
}

pub(crate) async fn an_owner_cannot_jump_the_queue_with_many_small_sweeps<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "one large", 0..100).await;
    for small in 0..100 {
        let number = 1_000 + small;
        submit_of(&store, "bert", &format!("small {small}"), number..number + 1).await;
    }
    let served = serve(&store, 100).await;
    assert_even(&served, 0..100, 1_000..1_100);
}

pub(crate) async fn workers_that_claim_with_results_take_turns_too<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "large", 0..200).await;
    submit_of(&store, "bert", "other", 1_000..1_200).await;
    let mut served = Vec::new();
    let mut next = Some(claim(&store, "w").await);
    for _ in 0..100 {
        let claim = next.expect("both have work");
        served.push(claim.lease.key);
        next = finish_and_claim(&store, &claim).await.next;
        assert_even(&served, 0..200, 1_000..1_200);
    }
}

pub(crate) async fn idle_time_is_not_saved_up<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "long ago", 0..200).await;
    serve(&store, 150).await;
    // Bert has asked for nothing all this time; that does not give him 150 turns in a row.
    submit_of(&store, "bert", "now", 5_000..5_200).await;
    let served = serve(&store, 60).await;
    assert_even(&served, 0..200, 5_000..5_200);
}

pub(crate) async fn urgency_counts_within_an_owner_only<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "plain", 0..100).await;
    let urgent = NewSweep { owner: "anne".to_owned(), priority: 10, ..sweep("urgent", 100..200) };
    submit(&store, &urgent).await;
    submit_of(&store, "bert", "other", 1_000..1_200).await;
    let served = serve(&store, 150).await;
    assert_even(&served, 0..200, 1_000..1_200);
    assert_eq!(among(&served, 0..100), 0, "the urgent ones first");
}

pub(crate) async fn retried_points_do_not_precede_other_owners<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit_of(&store, "anne", "cancelled", 0..100).await;
    assert!(store.cancel_sweep("cancelled").await.unwrap());
    submit_of(&store, "bert", "first", 1_000..1_100).await;
    serve(&store, 40).await;
    assert_eq!(store.retry_sweep("cancelled").await.unwrap(), Some(100));
    let served = serve(&store, 40).await;
    assert_even(&served, 0..100, 1_000..1_100);
    let retried: Vec<_> = (0..100).map(key).filter(|key| served.contains(key)).collect();
    let order: Vec<_> = served.into_iter().filter(|served| retried.contains(served)).collect();
    assert_eq!(order, (0..order.len() as u32).map(key).collect::<Vec<_>>(), "in the order of their ordinals");
}
