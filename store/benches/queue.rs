//! Cost of the queue per point, on a file in the temporary directory, next to a sweep of ten thousand points.

use std::cell::Cell;

use divan::Bencher;
use drillsweep_store::{
    Addition, CachePolicy, NewArtifact, NewPoint, NewResult, NewSweep, NewVerification, Role, Store,
    StoreConfig,
};
use tempfile::TempDir;
use tokio::runtime::Runtime;

const POINTS: i64 = 10_000;

fn main() {
    divan::main();
}

struct Queue {
    runtime: Runtime,
    store: Store,
    _directory: TempDir,
}

fn queue(role: Role) -> Queue {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    let config = StoreConfig::in_directory(directory.path(), role);
    let store = runtime.block_on(Store::open(&config)).expect("a store");
    Queue { runtime, store, _directory: directory }
}

fn sweep(number: i64) -> NewSweep {
    sweep_of(number, POINTS)
}

/// A sweep whose texts are as long as real ones.
fn sweep_of(number: i64, points: i64) -> NewSweep {
    let point = |ordinal: i64| NewPoint {
        ordinal,
        parameters_json: format!(r#"{{"flow_rate":0.03,"mud_density":{ordinal}}}"#),
        changes_json: format!(r#"{{"mud.flow_rate":0.03,"mud.density":{ordinal}}}"#),
        work_key: *blake3::hash(format!("{number} {ordinal}").as_bytes()).as_bytes(),
        fuller_key: None,
    };
    NewSweep {
        id: number.to_string(),
        name: None,
        owner: "anne".to_owned(),
        request_json: "{}".to_owned(),
        priority: 0,
        varied_json: r#"["flow_rate"]"#.to_owned(),
        tags_json: "[]".to_owned(),
        cache: CachePolicy::Reuse,
        idempotency_key: None,
        base_json: format!("{number:>3000}"),
        physics_version: 1,
        points: (1..=points).map(point).collect(),
        verification: NewVerification::default(),
    }
}

/// Claim, one renewal, finish with five artifacts: all that the database does for a point.
#[divan::bench(args = [Role::Worker, Role::Server], sample_count = 2_000, sample_size = 1)]
fn claim_renew_finish(bencher: Bencher, role: Role) {
    let queue = queue(role);
    queue.runtime.block_on(queue.store.submit_sweep(&sweep(1))).expect("submitted");
    let blob = queue.runtime.block_on(queue.store.put_blob(b"history".to_vec())).expect("written");
    let artifacts = ["profile", "statics", "history", "contacts", "energy"].map(|name| NewArtifact {
        name: name.to_owned(),
        media_type: "application/vnd.apache.parquet".to_owned(),
        blob,
        bytes: 7,
        row_count: 1,
    });
    let summary = format!(r#"{{"rows":"{:>2000}"}}"#, "");
    bencher.bench_local(|| {
        queue.runtime.block_on(async {
            let claim = queue.store.claim("w", 1, 60_000).await.expect("claimed").expect("work is ready");
            queue.store.renew(&claim.lease, 60_000, 0.5).await.expect("renewed");
            let result = NewResult {
                summary_json: &summary,
                provenance_json: "{}",
                artifacts: &artifacts,
                is_repeatable: true,
            };
            queue.store.finish_done(&claim.lease, &result).await.expect("finished")
        })
    });
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn submit_ten_thousand_points(bencher: Bencher) {
    let queue = queue(Role::Server);
    let number = Cell::new(0);
    bencher
        .with_inputs(|| {
            number.set(number.get() + 1);
            sweep(number.get())
        })
        .bench_local_values(|sweep| {
            queue.runtime.block_on(queue.store.submit_sweep(&sweep)).expect("submitted")
        });
}

/// Submission time of one owner's point while another owner submits and cancels a hundred thousand, time after time.
#[divan::bench(sample_count = 500, sample_size = 1)]
fn submit_next_to_a_hundred_thousand_points(bencher: Bencher) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let runtime = Runtime::new().expect("a runtime");
    let config = StoreConfig::in_directory(directory.path(), Role::Server);
    let store = runtime.block_on(Store::open(&config)).expect("a store");
    let busy = store.clone();
    runtime.spawn(async move {
        for number in 1.. {
            busy.submit_sweep(&sweep_of(number, 100_000)).await.expect("submitted");
            busy.cancel_sweep(&number.to_string()).await.expect("cancelled");
        }
    });
    let number = Cell::new(0);
    bencher
        .with_inputs(|| {
            number.set(number.get() + 1);
            NewSweep {
                owner: "bob".to_owned(),
                id: format!("bob's {number:?}"),
                ..sweep_of(-number.get(), 1)
            }
        })
        .bench_local_values(|sweep| runtime.block_on(store.submit_sweep(&sweep)).expect("submitted"));
}

/// One more point, to a sweep that has one and to one that has ten thousand.
#[divan::bench(args = [1, POINTS], sample_count = 1_000, sample_size = 1)]
fn append_a_point(bencher: Bencher, points: i64) {
    let queue = queue(Role::Server);
    let mut sweep = sweep(1);
    sweep.points.truncate(points as usize);
    queue.runtime.block_on(queue.store.submit_sweep(&sweep)).expect("submitted");
    let number = Cell::new(0);
    bencher
        .with_inputs(|| {
            number.set(number.get() + 1);
            let mut point = sweep.points[0].clone();
            point.work_key = *blake3::hash(format!("appended {}", number.get()).as_bytes()).as_bytes();
            [point]
        })
        .bench_local_values(|point| {
            let addition = Addition {
                base_json: &sweep.base_json,
                physics_version: 1,
                points: &point,
                verification: &sweep.verification,
                request_json: "{}",
            };
            let append = queue.store.append_points("1", &addition, 100_000);
            queue.runtime.block_on(append).expect("appended")
        });
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn cancel_ten_thousand_points(bencher: Bencher) {
    let queue = queue(Role::Server);
    let number = Cell::new(0);
    bencher
        .with_inputs(|| {
            number.set(number.get() + 1);
            queue.runtime.block_on(queue.store.submit_sweep(&sweep(number.get()))).expect("submitted");
            number.get().to_string()
        })
        .bench_local_values(|id| queue.runtime.block_on(queue.store.cancel_sweep(&id)).expect("cancelled"));
}

#[divan::bench(sample_count = 1_000, sample_size = 1)]
fn look_at_a_sweep(bencher: Bencher) {
    let queue = queue(Role::Server);
    queue.runtime.block_on(queue.store.submit_sweep(&sweep(1))).expect("submitted");
    bencher.bench_local(|| queue.runtime.block_on(queue.store.sweep("1")).expect("read"));
}
