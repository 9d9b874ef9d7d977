//! What it costs to serve a part of a blob of 100 MB of which every byte is verified.

use divan::Bencher;
use divan::counter::BytesCount;
use drillsweep_store::{BlobId, Role, Store, StoreConfig};
use tempfile::TempDir;
use tokio::runtime::Runtime;

const BYTES: u64 = 100_000_000;

fn main() {
    divan::main();
}

struct Stored {
    runtime: Runtime,
    directory: TempDir,
    store: Store,
    blob: BlobId,
}

impl Stored {
    fn new() -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let runtime = Runtime::new().expect("a runtime");
        let store = runtime.block_on(Store::open(&config(&directory))).expect("a store");
        let content = (0..BYTES).map(|index| (index % 251) as u8).collect();
        let blob = runtime.block_on(store.blobs().put(content)).expect("written");
        Stored { runtime, directory, store, blob }
    }
}

fn config(directory: &TempDir) -> StoreConfig {
    StoreConfig::in_directory(directory.path(), Role::Server)
}

/// By a process that has not read it before.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn first_range(bencher: Bencher) {
    let stored = Stored::new();
    bencher
        .counter(BytesCount::new(BYTES))
        .with_inputs(|| stored.runtime.block_on(Store::open(&config(&stored.directory))).expect("a store"))
        .bench_local_values(|store| {
            stored.runtime.block_on(store.blobs().get_range(stored.blob, 0..1_000)).expect("read")
        });
}

#[divan::bench(args = [1_000, 1_000_000], sample_count = 500, sample_size = 1)]
fn later_range(bencher: Bencher, length: u64) {
    let stored = Stored::new();
    let range = |start: u64| {
        stored
            .runtime
            .block_on(stored.store.blobs().get_range(stored.blob, start..start + length))
            .expect("read")
    };
    range(0);
    bencher.bench_local(|| range(BYTES / 2));
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn whole(bencher: Bencher) {
    let stored = Stored::new();
    bencher
        .counter(BytesCount::new(BYTES))
        .bench_local(|| stored.runtime.block_on(stored.store.blobs().get(stored.blob)).expect("read"));
}
