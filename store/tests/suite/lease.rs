//! Leases: who holds a point, until when, and what becomes of it when its worker falls silent.

use drillsweep_store::{
    BlobId, CachePolicy, Finished, NewArtifact, NewSweep, Renewal, StateCounts, StoreError, WorkState,
    WorkerRecord,
};

use crate::bench::{
    Engine, LEASE_MS, PHYSICS, claim, claim_or_none, finish, finish_and_claim, json, key, point_record,
    result, scenario, states, submit, sweep, sweep_record,
};

fn worker(id: &str) -> WorkerRecord {
    WorkerRecord {
        id: id.to_owned(),
        host: "rig".to_owned(),
        process: 42,
        version: "0.1.0".to_owned(),
        physics_version: PHYSICS,
        started: 0,
        last_seen: 0,
    }
}

pub(crate) async fn a_silent_worker_loses_its_point_when_the_lease_ends_and_not_before<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let first = claim(&store, "first").await;
    assert_eq!(first.lease.fencing_token, 1);

    let shortly_before = engine.after(LEASE_MS - 5_000).await;
    assert_eq!(claim_or_none(&shortly_before, "second").await, None);
    let later = engine.after(LEASE_MS + 1).await;
    let second = claim(&later, "second").await;
    assert_eq!((second.lease.key, second.lease.fencing_token), (key(1), 2));
    assert_eq!(point_record(&later, "s", 1).await.attempts, 2);
}

pub(crate) async fn a_claim_finds_a_lease_that_ended_after_the_last_look<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    // The first claim of a process looks for ended leases; its own, which ends at once, and the second claim follow within a second.
    let lost = store.claim("first", PHYSICS, -1).await.unwrap().expect("a queued point");
    assert_eq!(lost.lease.key, key(1));
    // A queued point goes first, and is the only one taken.
    assert_eq!(claim(&store, "second").await.lease.key, key(2));
    assert_eq!(claim(&store, "third").await.lease.key, key(1));
    assert_eq!(claim_or_none(&store, "fourth").await, None);
    assert!(!finish(&store, &lost).await);
}

pub(crate) async fn open_work_of_an_owner_ends_with_its_points<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2, 3])).await;
    assert_eq!(store.open_work("anne").await.unwrap(), 3);
    assert_eq!(store.open_work("bert").await.unwrap(), 0);
    let running = claim(&store, "worker").await;
    assert_eq!(store.open_work("anne").await.unwrap(), 3);
    assert!(finish(&store, &running).await);
    assert_eq!(store.open_work("anne").await.unwrap(), 2);
}

pub(crate) async fn a_buried_worker_releases_its_points_alone_at_once<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    for (id, process) in [("dead", 7), ("alive", 8)] {
        let worker = WorkerRecord { process, ..worker(id) };
        store.register_worker(&worker).await.unwrap();
    }
    submit(&store, &sweep("s", [1, 2])).await;
    let lost = claim(&store, "dead").await;
    let kept = claim(&store, "alive").await;
    // A process of the same number elsewhere is another one.
    assert_eq!(store.bury_worker("elsewhere", 7, None).await.unwrap(), 0);
    assert_eq!(claim_or_none(&store, "heir").await, None);
    assert_eq!(store.bury_worker("rig", 7, None).await.unwrap(), 1);

    let heir = claim(&engine.after(1).await, "heir").await;
    assert_eq!((heir.lease.key, heir.lease.fencing_token), (lost.lease.key, 2));
    assert!(!finish(&store, &lost).await, "its late result is refused");
    assert!(finish(&store, &kept).await);
    let left = store.workers(LEASE_MS).await.unwrap();
    assert_eq!(left.iter().map(|worker| worker.id.as_str()).collect::<Vec<_>>(), ["alive"]);
}

pub(crate) async fn a_late_writer_changes_nothing<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let late = claim(&store, "late").await;
    let later = engine.after(LEASE_MS + 1).await;

    let refuses_the_late_one = async || {
        let version = store.sweep_version("s").await.unwrap();
        assert_eq!(store.renew(&late.lease, LEASE_MS, 0.9).await.unwrap(), Renewal::Lost);
        let blobs = [BlobId::of(b"late")];
        assert_eq!(store.reserve(&late.lease, LEASE_MS, &blobs).await.unwrap(), Renewal::Lost);
        assert!(!finish(&store, &late).await);
        assert!(!store.finish_failed(&late.lease, "{}").await.unwrap());
        assert!(!store.finish_cancelled(&late.lease, "{}").await.unwrap());
        assert!(!store.release(&late.lease).await.unwrap());
        assert!(!store.crashed(&late.lease, "{}").await.unwrap());
        let blob = store.put_blob(b"late".to_vec()).await.unwrap();
        assert!(!store.keep_checkpoint(&late.lease, blob).await.unwrap());
        assert!(!store.retry_later(&late.lease, "{}").await.unwrap());
        assert_eq!(store.sweep_version("s").await.unwrap(), version);
    };

    // Back in the queue, under way elsewhere, finished elsewhere.
    assert_eq!(later.reap_expired().await.unwrap(), 1);
    refuses_the_late_one().await;
    let prompt = claim(&later, "prompt").await;
    refuses_the_late_one().await;
    assert!(finish(&later, &prompt).await);
    refuses_the_late_one().await;

    let point = point_record(&store, "s", 1).await;
    assert_eq!(point.summary_json.as_deref(), Some(r#"{"by":"prompt"}"#));
    // The result is stored once, even by the one that holds the lease.
    assert!(!finish(&later, &prompt).await);
}

pub(crate) async fn a_reservation_of_blobs_extends_the_lease<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let first = claim(&store, "first").await;
    // Two tables of a result may have the same content, and a result may have none.
    let blobs = [BlobId::of(b"history"), BlobId::of(b"profile"), BlobId::of(b"history")];
    assert_eq!(store.reserve(&first.lease, LEASE_MS, &blobs).await.unwrap(), Renewal::Held);
    let halfway = engine.after(LEASE_MS / 2).await;
    assert_eq!(halfway.reserve(&first.lease, LEASE_MS, &[]).await.unwrap(), Renewal::Held);
    let point = point_record(&store, "s", 1).await;
    assert_eq!((point.state, point.progress), (WorkState::Leased, 1.0));

    let shortly_before = engine.after(LEASE_MS / 2 + LEASE_MS - 5_000).await;
    assert_eq!(claim_or_none(&shortly_before, "second").await, None);
    let later = engine.after(LEASE_MS / 2 + LEASE_MS + 1).await;
    assert_eq!(claim(&later, "second").await.lease.fencing_token, 2);
}

pub(crate) async fn a_result_brings_its_worker_the_next_point<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let first = claim(&store, "w").await;
    let finished = finish_and_claim(&store, &first).await;
    assert!(finished.is_stored);
    let second = finished.next.expect("another one is ready");
    assert_eq!((second.lease.key, second.lease.fencing_token), (key(2), 1));
    assert_eq!(second.lease.worker, "w");
    assert_eq!(second.scenario, scenario("s", 2));
    assert_eq!(states(&store, "s").await, [WorkState::Done, WorkState::Leased]);
    assert_eq!(store.renew(&second.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
    let shortly_before = engine.after(LEASE_MS - 5_000).await;
    assert_eq!(claim_or_none(&shortly_before, "other").await, None, "its lease is as long as any");

    let finished = finish_and_claim(&store, &second).await;
    assert_eq!(finished, Finished { is_stored: true, next: None });
    let record = sweep_record(&store, "s").await;
    assert_eq!((record.counts.done, record.finished.is_some()), (2, true));
    let events = store.events("s", 0, 10).await.unwrap();
    let told: Vec<_> = events.iter().map(|event| (event.work_key, event.state)).collect();
    let (one, two) = (key(1), key(2));
    let expected =
        [(one, WorkState::Leased), (one, WorkState::Done), (two, WorkState::Leased), (two, WorkState::Done)];
    assert_eq!(told, expected);

    // A result in place of an earlier one brings the next point as well.
    let again = NewSweep { cache: CachePolicy::Refresh, ..sweep("again", [1, 2]) };
    submit(&store, &again).await;
    let first = claim(&store, "w").await;
    let finished = finish_and_claim(&store, &first).await;
    assert_eq!((finished.is_stored, finished.next.map(|next| next.lease.key)), (true, Some(two)));
    assert_eq!(states(&store, "again").await, [WorkState::Done, WorkState::Leased]);
}

pub(crate) async fn a_result_that_is_refused_brings_no_point<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let late = claim(&store, "late").await;
    let later = engine.after(LEASE_MS + 1).await;
    let heir = claim(&later, "heir").await;
    assert_eq!(heir.lease.key, late.lease.key);
    assert_eq!(finish_and_claim(&later, &late).await, Finished { is_stored: false, next: None });
    assert_eq!(states(&later, "s").await, [WorkState::Leased, WorkState::Queued]);

    // Nor does one whose table is not there, which can be stored once it is.
    let artifact = NewArtifact {
        name: "history".to_owned(),
        media_type: "application/vnd.apache.parquet".to_owned(),
        blob: blake3::hash(b"not written").into(),
        bytes: 11,
        row_count: 1,
    };
    let refused =
        later.finish_and_claim(&heir.lease, &result("{}", &[artifact]), PHYSICS, LEASE_MS).await.unwrap_err();
    assert!(matches!(refused, StoreError::BlobMissing(_)), "{refused}");
    assert_eq!(states(&later, "s").await, [WorkState::Leased, WorkState::Queued]);
    let finished = finish_and_claim(&later, &heir).await;
    assert_eq!((finished.is_stored, finished.next.map(|next| next.lease.key)), (true, Some(key(2))));
}

/// A fleet that goes on from result to result never calls for a point alone: it looks for leases that ran out all the same.
pub(crate) async fn a_result_claims_points_of_an_expired_lease<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let silent = claim(&store, "silent").await;
    let own = claim(&engine.after(LEASE_MS / 2).await, "w").await;
    let later = engine.after(LEASE_MS + 1).await;
    let next = finish_and_claim(&later, &own).await.next.expect("the silent worker's point is free");
    assert_eq!((next.lease.key, next.lease.fencing_token), (silent.lease.key, 2));
}

pub(crate) async fn the_same_worker_cannot_write_under_its_earlier_claim<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let earlier = claim(&store, "w").await;
    let later = engine.after(LEASE_MS + 1).await;
    let now = claim(&later, "w").await;
    assert!(!finish(&later, &earlier).await);
    assert!(finish(&later, &now).await);
}

pub(crate) async fn a_renewal_extends_the_lease_and_carries_the_progress<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    let running = claim(&store, "w").await;
    let version = store.sweep_version("s").await.unwrap();

    let at_50_s = engine.after(50_000).await;
    assert_eq!(at_50_s.renew(&running.lease, LEASE_MS, 0.25).await.unwrap(), Renewal::Held);
    assert_eq!(point_record(&store, "s", 1).await.progress, 0.25);
    assert_eq!(sweep_record(&store, "s").await.progress, 0.25);
    // Progress is not a change of state.
    assert_eq!(store.sweep_version("s").await.unwrap(), version);

    assert_eq!(engine.after(100_000).await.reap_expired().await.unwrap(), 0);
    assert_eq!(engine.after(50_000 + LEASE_MS + 5_000).await.reap_expired().await.unwrap(), 1);
    let point = point_record(&store, "s", 1).await;
    assert_eq!((point.state, point.progress), (WorkState::Queued, 0.0));
}

pub(crate) async fn a_point_whose_workers_die_three_times_is_dead<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    for death in 1..=3 {
        let store = engine.after((death - 1) * 2 * LEASE_MS).await;
        assert_eq!(claim(&store, "doomed").await.lease.fencing_token, death);
    }
    let end = engine.after(6 * LEASE_MS).await;
    assert_eq!(claim_or_none(&end, "w").await, None);
    assert_eq!(states(&store, "s").await, [WorkState::Dead]);
    let record = sweep_record(&store, "s").await;
    assert_eq!(record.counts, StateCounts { total: 1, failed: 1, ..StateCounts::default() });
    assert!(record.finished.is_some());
    assert_eq!(
        point_record(&store, "s", 1).await.error_json.as_deref().map(json),
        Some(json(r#"{"class":"crash","reason":"3 workers went silent while they simulated it"}"#))
    );

    // A retry begins to count anew.
    assert_eq!(end.retry_sweep("s").await.unwrap(), Some(1));
    claim(&end, "doomed").await;
    let after_one_more = engine.after(8 * LEASE_MS).await;
    assert!(finish(&after_one_more, &claim(&after_one_more, "w").await).await);
}

pub(crate) async fn the_error_of_a_dead_point_names_its_last_worker<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    store.register_worker(&WorkerRecord { process: 7, ..worker("watched") }).await.unwrap();
    let reason = async |store: &drillsweep_store::Store| point_record(store, "s", 1).await.error_json;
    let first = claim(&store, "silent").await;
    assert!(store.note_worker(&first.lease, "was nearly full").await.unwrap());
    let second_life = engine.after(2 * LEASE_MS).await;
    claim(&second_life, "another").await;
    assert!(!second_life.note_worker(&first.lease, "late").await.unwrap(), "its lease is lost");
    let third_life = engine.after(4 * LEASE_MS).await;
    claim(&third_life, "watched").await;
    assert_eq!(third_life.bury_worker("rig", 7, Some("was ended by signal 9")).await.unwrap(), 1);
    let end = engine.after(4 * LEASE_MS + 1).await;
    end.reap_expired().await.unwrap();
    assert_eq!(
        reason(&end).await.as_deref().map(json),
        Some(json(
            r#"{"class":"crash","reason":"3 workers went silent while they simulated it; the last one was ended by signal 9"}"#
        ))
    );
    // The next claim clears the notes on an earlier one.
    assert_eq!(end.retry_sweep("s").await.unwrap(), Some(1));
    for death in 0..3 {
        let lease = claim(&engine.after((6 + 2 * death) * LEASE_MS).await, "w").await.lease;
        if death == 1 {
            assert!(engine.after(8 * LEASE_MS).await.note_worker(&lease, "was nearly full").await.unwrap());
        }
    }
    let end = engine.after(12 * LEASE_MS).await;
    end.reap_expired().await.unwrap();
    assert!(!reason(&end).await.unwrap().contains("last"));
}

pub(crate) async fn a_point_given_back_is_refunded_its_attempt_but_not_its_fencing_token<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let released = claim(&store, "w").await;
    assert!(store.release(&released.lease).await.unwrap());
    let point = point_record(&store, "s", 1).await;
    assert_eq!((point.state, point.attempts), (WorkState::Queued, 0));
    let again = claim(&store, "w").await;
    assert_eq!(again.lease.fencing_token, 2);
    assert_eq!(point_record(&store, "s", 1).await.attempts, 1);
    assert!(!finish(&store, &released).await);
    assert!(finish(&store, &again).await);
}

pub(crate) async fn infrastructure_failures_back_off_exponentially_with_jitter_up_to_the_fifth<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let mut clock = 0;
    for wait in [5_000, 10_000, 20_000, 40_000] {
        let store = engine.after(clock).await;
        let failing = claim(&store, "w").await;
        assert!(store.retry_later(&failing.lease, r#"{"class":"infrastructure"}"#).await.unwrap());
        assert_eq!(states(&store, "s").await, [WorkState::Waiting]);
        assert_eq!(store.queue_depths().await.unwrap().waiting, 1);
        let too_early = engine.after(clock + wait - 2_000).await;
        assert_eq!(claim_or_none(&too_early, "w").await, None);
        // The margin is for the time that the test itself takes.
        clock += wait * 3 / 2 + 2_000;
    }
    let last = engine.after(clock).await;
    let failing = claim(&last, "w").await;
    assert!(last.retry_later(&failing.lease, r#"{"class":"infrastructure"}"#).await.unwrap());
    let point = point_record(&last, "s", 1).await;
    assert_eq!(point.state, WorkState::Failed);
    assert_eq!(point.error_json.as_deref(), Some(r#"{"class":"infrastructure"}"#));
    assert!(sweep_record(&last, "s").await.finished.is_some());
}

pub(crate) async fn points_that_failed_together_do_not_come_back_together<E: Engine>() {
    let engine = E::new();
    submit(&engine.open().await, &sweep("s", 0..100)).await;
    let mut clock = 0;
    // The fourth wait, so long that the time which the test itself takes hardly counts.
    for wait in [5_000, 10_000, 20_000, 40_000] {
        let store = engine.after(clock).await;
        while let Some(failing) = claim_or_none(&store, "w").await {
            assert!(store.retry_later(&failing.lease, "{}").await.unwrap());
        }
        clock += wait * 5 / 4;
        if wait < 40_000 {
            clock += wait / 4 + 10_000;
        }
    }
    // About half of the waits spread evenly over 40 to 60 s are over after 50 s; without a spread all would be.
    let store = engine.after(clock).await;
    store.reap_expired().await.unwrap();
    let ready = store.queue_depths().await.unwrap().queued;
    assert!((15..=85).contains(&ready), "{ready}");
}

pub(crate) async fn a_checkpoint_reaches_the_next_attempts_until_the_work_is_done<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let first = claim(&store, "first").await;
    assert_eq!(first.checkpoint, None);
    let blob = store.put_blob(b"half of it".to_vec()).await.unwrap();
    assert!(store.keep_checkpoint(&first.lease, blob).await.unwrap());
    assert!(store.release(&first.lease).await.unwrap());
    assert_eq!(point_record(&store, "s", 1).await.attempts, 0);

    // A worker that dies on the way does not lose it either.
    let second = claim(&store, "second").await;
    assert_eq!((second.checkpoint, second.lease.fencing_token), (Some(blob), 2));
    let later = engine.after(LEASE_MS + 1).await;
    let third = claim(&later, "third").await;
    assert_eq!(third.checkpoint, Some(blob));
    // Nor does one that gives the point up for having taken too long: a retry goes on from there.
    assert!(later.finish_failed(&third.lease, "{}").await.unwrap());
    assert_eq!(later.retry_sweep("s").await.unwrap(), Some(1));
    let fourth = claim(&later, "fourth").await;
    assert_eq!(fourth.checkpoint, Some(blob));
    assert!(finish(&later, &fourth).await);
}

pub(crate) async fn poison_work_is_given_up_even_if_workers_survive<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1])).await;
    let error = r#"{"class":"crash","reason":"panicked"}"#;
    let first = claim(&store, "survivor").await;
    assert!(store.crashed(&first.lease, error).await.unwrap());
    assert_eq!(states(&store, "s").await, [WorkState::Queued]);
    claim(&store, "killed").await;
    let later = engine.after(LEASE_MS + 1).await;
    let third = claim(&later, "survivor").await;
    assert!(later.crashed(&third.lease, error).await.unwrap());
    let point = point_record(&later, "s", 1).await;
    assert_eq!((point.state, point.error_json.as_deref()), (WorkState::Dead, Some(error)));
    assert_eq!(claim_or_none(&later, "w").await, None);
}

pub(crate) async fn a_worker_gets_only_work_of_its_own_numbers<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &NewSweep { physics_version: PHYSICS - 1, ..sweep("old", [1]) }).await;
    submit(&store, &sweep("new", [2])).await;
    assert_eq!(claim(&store, "w").await.lease.key, key(2));
    assert_eq!(claim_or_none(&store, "w").await, None);
    let claimed = store.claim("old worker", PHYSICS - 1, LEASE_MS).await.unwrap().unwrap();
    assert_eq!(claimed.lease.key, key(1));
}

pub(crate) async fn work_of_an_abandoned_version_ends_with_its_reason<E: Engine>() {
    const SILENCE_MS: i64 = 100_000;
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2, 3])).await;
    submit(&store, &NewSweep { physics_version: PHYSICS + 1, ..sweep("new", [4]) }).await;
    let running = claim(&store, "old").await;
    let retried = claim(&store, "old").await;
    assert!(store.retry_later(&retried.lease, "{}").await.unwrap());
    store.register_worker(&worker("old")).await.unwrap();
    // While a worker computes them they wait.
    assert_eq!(store.end_outdated(PHYSICS, SILENCE_MS).await.unwrap(), 0);
    assert_eq!(store.end_outdated(PHYSICS + 1, SILENCE_MS).await.unwrap(), 0);

    let later = engine.after(SILENCE_MS + 1).await;
    assert_eq!(later.end_outdated(PHYSICS + 1, SILENCE_MS).await.unwrap(), 2);
    assert_eq!(states(&later, "s").await, [WorkState::Leased, WorkState::Failed, WorkState::Failed]);
    assert_eq!(states(&later, "new").await, [WorkState::Queued]);
    let error = point_record(&later, "s", 3).await.error_json.unwrap();
    assert!(error.contains("outdated") && error.contains(&format!("physics version {PHYSICS} ")), "{error}");
    // A running point ends when its worker is gone.
    assert_eq!(running.lease.key, key(1));
    assert_eq!(later.reap_expired().await.unwrap(), 1);
    assert_eq!(later.end_outdated(PHYSICS + 1, SILENCE_MS).await.unwrap(), 1);
    assert!(sweep_record(&later, "s").await.finished.is_some());
}

pub(crate) async fn the_urgent_goes_first_then_the_order_asked<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("plain", [1, 2, 3])).await;
    // Point 2 becomes as urgent as the sweep that also wants it.
    submit(&store, &NewSweep { priority: 5, ..sweep("urgent", [4, 2]) }).await;
    let mut order = Vec::new();
    while let Some(claim) = claim_or_none(&store, "w").await {
        order.push(claim.lease.key);
    }
    assert_eq!(order, [key(2), key(4), key(1), key(3)]);
}

pub(crate) async fn workers_are_listed_while_their_heartbeat_lasts<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    store.register_worker(&worker("a")).await.unwrap();
    let later = engine.after(90_000).await;
    later.register_worker(&worker("b")).await.unwrap();
    let ids = async |within| -> Vec<String> {
        later.workers(within).await.unwrap().into_iter().map(|worker| worker.id).collect()
    };
    assert_eq!(ids(60_000).await, ["b"]);
    assert_eq!(ids(120_000).await, ["a", "b"]);
    later.register_worker(&worker("a")).await.unwrap();
    assert_eq!(ids(60_000).await, ["a", "b"]);
    let listed = later.workers(60_000).await.unwrap();
    assert!(listed[0].last_seen - listed[0].started >= 90_000, "{:?}", listed[0]);
    later.remove_worker("a").await.unwrap();
    assert_eq!(ids(120_000).await, ["b"]);
}

/// Step by which tests of leases and of heartbeats set the clock back.
const BACK_MS: i64 = 3_600_000;

pub(crate) async fn a_clock_that_is_set_back_keeps_no_point_with_a_dead_worker<E: Engine>() {
    let engine = E::new();
    let before = engine.after(BACK_MS).await;
    submit(&before, &sweep("s", [1, 2])).await;
    let dead = claim(&before, "dead").await;
    let alive = claim(&before, "alive").await;

    let back = engine.open().await;
    assert_eq!(claim_or_none(&back, "heir").await, None, "neither has been silent for a lease");
    let renewed = engine.after(LEASE_MS / 2).await;
    assert_eq!(renewed.renew(&alive.lease, LEASE_MS, 0.5).await.unwrap(), Renewal::Held);
    let shortly_before = engine.after(LEASE_MS - 5_000).await;
    assert_eq!(claim_or_none(&shortly_before, "heir").await, None);
    let later = engine.after(LEASE_MS + 5_000).await;
    let heir = claim(&later, "heir").await;
    assert_eq!((heir.lease.key, heir.lease.fencing_token), (dead.lease.key, 2));
    assert!(!finish(&later, &dead).await);
    assert!(finish(&later, &alive).await, "who renewed has it still");
}

pub(crate) async fn a_clock_that_is_set_back_holds_up_no_retry<E: Engine>() {
    // Twice the longest wait: the four waits before the fifth try are 5 s to 40 s, and up to half as much again.
    let back_ms = 2 * 40_000 * 3 / 2;
    let engine = E::new();
    let before = engine.after(back_ms).await;
    submit(&before, &sweep("s", [1])).await;
    let failing = claim(&before, "w").await;
    assert!(before.retry_later(&failing.lease, "{}").await.unwrap());
    assert_eq!(claim_or_none(&before, "w").await, None);
    assert_eq!(claim(&engine.open().await, "w").await.lease.fencing_token, 2);
}

pub(crate) async fn a_clock_that_is_set_back_makes_no_dead_worker_alive<E: Engine>() {
    let engine = E::new();
    let before = engine.after(BACK_MS).await;
    for id in ["dead", "alive"] {
        before.register_worker(&worker(id)).await.unwrap();
    }
    let back = engine.open().await;
    back.register_worker(&worker("alive")).await.unwrap();
    let left = back.workers(LEASE_MS).await.unwrap();
    assert_eq!(left.iter().map(|worker| worker.id.as_str()).collect::<Vec<_>>(), ["alive"]);
}
