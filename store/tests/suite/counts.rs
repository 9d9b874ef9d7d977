//! A sweep's counts, end and events follow its points through whatever happens to them.

use drillsweep_store::{Addition, Claim, StateCounts, Store, WorkState};

use crate::bench::{
    Engine, LEASE_MS, addition, claim, claim_or_none, finish, key, scenario, states, submit, sweep,
    sweep_record, verification, verified,
};

/// A small generator (xorshift): the same numbers in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % sides as u64) as usize
    }
}

/// The counts, made from the points themselves.
fn recount(states: &[WorkState]) -> StateCounts {
    let number = |wanted: &[WorkState]| states.iter().filter(|state| wanted.contains(state)).count() as i64;
    StateCounts {
        total: states.len() as i64,
        queued: number(&[WorkState::Waiting, WorkState::Queued]),
        running: number(&[WorkState::Leased]),
        done: number(&[WorkState::Done]),
        failed: number(&[WorkState::Failed, WorkState::Dead]),
        cancelled: number(&[WorkState::Cancelled]),
    }
}

async fn check(store: &Store, sweeps: &[String], step: usize) {
    for id in sweeps {
        let states = states(store, id).await;
        let record = sweep_record(store, id).await;
        let expected = recount(&states);
        assert_eq!(record.counts, expected, "sweep {id} after step {step}");
        let runs: Vec<WorkState> =
            store.verifications(id).await.unwrap().into_iter().map(|run| run.state).collect();
        let of_runs = recount(&runs);
        assert_eq!(record.verification, of_runs, "sweep {id} after step {step}");
        let is_open = expected.queued + expected.running + of_runs.queued + of_runs.running > 0;
        assert_eq!(record.finished.is_none(), is_open, "sweep {id} after step {step}: {record:?}");
    }
}

/// Runs that verify some of so many points. Some are of the work that is a point's own, here or elsewhere.
fn runs(dice: &mut Dice, points: usize) -> Vec<(i64, u32)> {
    let mut runs = Vec::new();
    for ordinal in 1..=points as i64 {
        if dice.roll(3) == 0 {
            runs.push((ordinal, 10 + dice.roll(20) as u32));
        }
    }
    runs
}

pub(crate) async fn counts_and_end_agree_with_the_points_after_every_step_of_a_random_history<E: Engine>() {
    for seed in [0x9e37_79b9, 0x1234_5678_9abc, 0xdead_beef_cafe] {
        let engine = E::new();
        let mut dice = Dice(seed);
        let mut clock = 0;
        let mut store = engine.open().await;
        let mut sweeps: Vec<String> = Vec::new();
        let mut claims: Vec<Claim> = Vec::new();
        for step in 0..250 {
            match dice.roll(13) {
                0 if sweeps.len() < 12 => {
                    let id = format!("s{step}");
                    // Few work items, so that sweeps share them and have some of them twice.
                    let numbers: Vec<u32> = (0..1 + dice.roll(8)).map(|_| dice.roll(20) as u32).collect();
                    let runs = runs(&mut dice, numbers.len());
                    submit(&store, &verified(sweep(&id, numbers), &runs)).await;
                    sweeps.push(id);
                }
                0..=3 => claims.extend(claim_or_none(&store, "w").await),
                4 if !sweeps.is_empty() => {
                    assert!(store.cancel_sweep(&sweeps[dice.roll(sweeps.len())]).await.unwrap());
                }
                5 if !sweeps.is_empty() => {
                    store.retry_sweep(&sweeps[dice.roll(sweeps.len())]).await.unwrap().unwrap();
                }
                6 => {
                    clock += 20_000;
                    store = engine.after(clock).await;
                    store.reap_expired().await.unwrap();
                }
                12 if !sweeps.is_empty() => {
                    let id = &sweeps[dice.roll(sweeps.len())];
                    let points = sweep(id, (0..1 + dice.roll(4)).map(|_| dice.roll(20) as u32)).points;
                    let base = scenario(id, 0).base_json;
                    let verification = verification(&runs(&mut dice, points.len()));
                    let addition = Addition { verification: &verification, ..addition(&base, &points, "{}") };
                    // A sweep that is cancelled, or has all of them, stays as it is.
                    store.append_points(id, &addition, 100).await.unwrap();
                }
                kind if !claims.is_empty() => {
                    // Some of these have lost their lease: then nothing may change.
                    let claim = claims.swap_remove(dice.roll(claims.len()));
                    let lease = &claim.lease;
                    match kind {
                        7 => drop(finish(&store, &claim).await),
                        8 => drop(store.finish_failed(lease, "{}").await.unwrap()),
                        9 => drop(store.finish_cancelled(lease, "{}").await.unwrap()),
                        10 => drop(store.release(lease).await.unwrap()),
                        _ => drop(store.retry_later(lease, "{}").await.unwrap()),
                    }
                }
                _ => {}
            }
            check(&store, &sweeps, step).await;
        }
        assert!(sweeps.len() > 5, "the history is too poor to mean anything");
    }
}

pub(crate) async fn events_report_the_history_in_the_order_of_versions<E: Engine>() {
    let engine = E::new();
    let store = engine.open().await;
    submit(&store, &sweep("s", [1, 2])).await;
    submit(&store, &sweep("other", [2])).await;
    let silent = claim(&store, "w").await;
    let later = engine.after(LEASE_MS + 1).await;
    let again = claim(&later, "w").await;
    assert_eq!(again.lease.key, silent.lease.key);
    assert!(finish(&later, &again).await);
    let failed = claim(&later, "w").await;
    assert!(later.finish_failed(&failed.lease, "{}").await.unwrap());

    let events = store.events("s", 0, 100).await.unwrap();
    let told: Vec<_> = events.iter().map(|event| (event.work_key, event.state)).collect();
    assert_eq!(
        told,
        [
            (key(1), WorkState::Leased),
            (key(1), WorkState::Queued),
            (key(1), WorkState::Leased),
            (key(1), WorkState::Done),
            (key(2), WorkState::Leased),
            (key(2), WorkState::Failed),
        ]
    );
    assert!(events.is_sorted_by(|a, b| a.seq < b.seq && a.at <= b.at), "{events:?}");
    // The end has a number of its own.
    assert_eq!(store.sweep_version("s").await.unwrap(), Some(events[5].seq + 1));
    assert_eq!(store.events("s", events[2].seq, 2).await.unwrap(), events[3..5]);
    let others: Vec<_> =
        store.events("other", 0, 100).await.unwrap().into_iter().map(|event| event.state).collect();
    assert_eq!(others, [WorkState::Leased, WorkState::Failed]);
    assert_eq!(sweep_record(&store, "s").await.finished, Some(events[5].at));
}
