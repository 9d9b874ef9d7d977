//! Cost of storing a blob and of serving a part of one of which every byte is verified, in a directory and in a bucket of an object
//! store on this machine.

use divan::Bencher;
use divan::counter::BytesCount;
use drillsweep_store::{BlobId, BlobStore, ObjectsLocation};
use tempfile::TempDir;
use tokio::runtime::Runtime;

use servers::seaweed::Seaweed;

#[allow(dead_code, reason = "the tests use more of it")]
#[path = "../tests/servers/mod.rs"]
mod servers;

/// Size of the blob that is read.
const BYTES: u64 = 100_000_000;

fn main() {
    divan::main();
}

/// Location of blobs.
trait Place {
    fn new() -> Self;
    fn location(&self) -> ObjectsLocation;
}

struct Directory(TempDir);

impl Place for Directory {
    fn new() -> Self {
        Directory(tempfile::tempdir().expect("a temporary directory"))
    }

    fn location(&self) -> ObjectsLocation {
        ObjectsLocation::Directory(self.0.path().to_owned())
    }
}

struct Bucket(&'static Seaweed);

impl Place for Bucket {
    fn new() -> Self {
        Bucket(Seaweed::shared())
    }

    fn location(&self) -> ObjectsLocation {
        self.0.location(&self.0.address(), "benches")
    }
}

struct Stored<P> {
    runtime: Runtime,
    place: P,
    blobs: BlobStore,
    blob: BlobId,
}

impl<P: Place> Stored<P> {
    fn new() -> Self {
        let place = P::new();
        let runtime = Runtime::new().expect("a runtime");
        let blobs = open(&place);
        let blob = runtime.block_on(blobs.put(content(BYTES, 0))).expect("written");
        Stored { runtime, place, blobs, blob }
    }
}

fn open(place: &impl Place) -> BlobStore {
    BlobStore::open(&place.location()).expect("a place for blobs")
}

/// A content of some bytes, another one for every number.
fn content(bytes: u64, number: u64) -> Vec<u8> {
    let mut content: Vec<u8> = (0..bytes).map(|index| (index % 251) as u8).collect();
    content[..8].copy_from_slice(&number.to_le_bytes());
    content
}

/// Reads by a process that has not read the blob before.
#[divan::bench(types = [Directory, Bucket], sample_count = 20, sample_size = 1)]
fn first_range<P: Place>(bencher: Bencher) {
    let stored = Stored::<P>::new();
    bencher.counter(BytesCount::new(BYTES)).with_inputs(|| open(&stored.place)).bench_local_values(|blobs| {
        stored.runtime.block_on(blobs.get_range(stored.blob, 0..1_000)).expect("read")
    });
}

#[divan::bench(types = [Directory, Bucket], args = [1_000, 1_000_000], sample_count = 500, sample_size = 1)]
fn later_range<P: Place>(bencher: Bencher, length: u64) {
    let stored = Stored::<P>::new();
    let range = |start: u64| {
        stored.runtime.block_on(stored.blobs.get_range(stored.blob, start..start + length)).expect("read")
    };
    range(0);
    bencher.bench_local(|| range(BYTES / 2));
}

#[divan::bench(types = [Directory, Bucket], sample_count = 20, sample_size = 1)]
fn whole<P: Place>(bencher: Bencher) {
    let stored = Stored::<P>::new();
    bencher
        .counter(BytesCount::new(BYTES))
        .bench_local(|| stored.runtime.block_on(stored.blobs.get(stored.blob)).expect("read"));
}

/// A blob that is not there yet, as tables of one point are.
#[divan::bench(types = [Directory, Bucket], args = [10_000, 1_000_000], sample_count = 100, sample_size = 1)]
fn put<P: Place>(bencher: Bencher, bytes: u64) {
    let (place, runtime) = (P::new(), Runtime::new().expect("a runtime"));
    let blobs = open(&place);
    let mut number = 0;
    let next = || {
        number += 1;
        content(bytes, number)
    };
    bencher
        .counter(BytesCount::new(bytes))
        .with_inputs(next)
        .bench_local_values(|content| runtime.block_on(blobs.put(content)).expect("written"));
}
