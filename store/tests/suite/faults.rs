//! Blobs under faults of networks and object stores: servers that are gone, killed, restarted or overloaded, and answers that are lost.

use std::fs::File;
use std::io::Write as _;
use std::time::Duration;

use drillsweep_store::{BlobId, BlobStore, ObjectsLocation, StoreError};

use crate::place::object_name;
use crate::servers::proxy::{Behaviour, Proxy};
use crate::servers::seaweed::Seaweed;

const PREFIX: &str = "faults";

/// Answer of an overloaded server.
const OVERLOADED: Behaviour = Behaviour::Refuse("503 Slow Down", "<Error><Code>SlowDown</Code></Error>");

/// Answer of a server that has no room for its user.
const FULL: Behaviour = Behaviour::Refuse("403 Forbidden", "<Error><Code>QuotaExceeded</Code></Error>");

/// A file of 24 MB and its name. Its upload has three parts.
fn large_file() -> (File, BlobId) {
    let content: Vec<u8> = (0..24_000_000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(&content).unwrap();
    (file, blake3::hash(&content).into())
}

/// The blobs of a server, by way of a proxy.
fn open(server: &Seaweed, proxy: &Proxy) -> BlobStore {
    BlobStore::open(&server.location(proxy.address(), PREFIX)).unwrap()
}

/// The names of all objects of a server.
fn names(server: &Seaweed) -> Vec<String> {
    server.files(PREFIX).into_iter().map(|file| file.name).collect()
}

/// Asserts that an error reports an unavailable service, and no loss.
#[track_caller]
fn assert_unavailable<T: std::fmt::Debug>(result: drillsweep_store::Result<T>) {
    let error = result.expect_err("nobody answers");
    assert!(error.is_unavailable() && !error.is_damage() && !error.is_full(), "{error}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_killed_upload_is_invisible_and_the_next_one_complete() {
    let mut server = Seaweed::start();
    let proxy = Proxy::before(&server.address());
    let (file, id) = large_file();
    let (writer, written) = (open(&server, &proxy), file.try_clone().unwrap());
    proxy.set(Behaviour::StallAfter(12_000_000));
    let upload = tokio::spawn(async move { writer.put_file(&written).await });
    proxy.wait_for(12_000_000);
    server.kill();
    // Its worker is killed with it.
    upload.abort();
    assert!(upload.await.unwrap_err().is_cancelled());
    server.restart();
    proxy.set(Behaviour::Pass);

    let blobs = open(&server, &proxy);
    assert_eq!(names(&server), [""; 0]);
    let error = blobs.get(id).await.unwrap_err();
    assert!(error.is_damage() && !error.is_unavailable(), "{error}");
    assert_eq!(blobs.put_file(&file).await.unwrap(), (id, 24_000_000));
    assert_eq!(names(&server), [format!("{PREFIX}/{}", object_name(&id.to_string()))]);
    assert_eq!(blobs.verify(id).await.unwrap(), 24_000_000);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_upload_goes_on_after_its_server_was_killed_and_started_again() {
    let mut server = Seaweed::start();
    let proxy = Proxy::before(&server.address());
    let (file, id) = large_file();
    let writer = open(&server, &proxy);
    proxy.set(Behaviour::StallAfter(12_000_000));
    let upload = tokio::spawn(async move { writer.put_file(&file).await });
    proxy.wait_for(12_000_000);
    server.kill();
    proxy.set(Behaviour::Pass);
    server.restart();
    assert_eq!(upload.await.unwrap().unwrap(), (id, 24_000_000));
    assert_eq!(open(&server, &proxy).verify(id).await.unwrap(), 24_000_000);
}

#[tokio::test]
async fn a_server_that_is_gone_is_unavailable_and_back_when_it_is_started() {
    let mut server = Seaweed::start();
    let blobs = BlobStore::open(&server.location(&server.address(), PREFIX)).unwrap();
    let content = b"orbit".repeat(200_000);
    let id = blobs.put(content.clone()).await.unwrap();
    assert_eq!(blobs.get_range(id, 5..10).await.unwrap(), b"orbit".as_slice());
    server.kill();
    let scratch = tempfile::tempfile().unwrap();
    let (whole, range, verified, into) = tokio::join!(
        blobs.get(id),
        blobs.get_range(id, 5..10),
        blobs.verify(id),
        blobs.get_into(id, scratch),
    );
    assert_unavailable(whole);
    assert_unavailable(range);
    assert_unavailable(verified);
    assert_unavailable(into);
    server.restart();
    assert_eq!(blobs.get(id).await.unwrap(), content);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_refused_by_an_overloaded_server_are_retried() {
    let server = Seaweed::shared();
    let proxy = Proxy::before(&server.address());
    let blobs = open(server, &proxy);
    proxy.set(OVERLOADED);
    let writing = tokio::spawn({
        let blobs = blobs.clone();
        async move { blobs.put(b"orbit".to_vec()).await }
    });
    proxy.wait_for_disturbed(2);
    proxy.set(Behaviour::Pass);
    let id = writing.await.unwrap().unwrap();

    proxy.set(OVERLOADED);
    let reading = tokio::spawn({
        let blobs = blobs.clone();
        async move { blobs.get(id).await }
    });
    proxy.wait_for_disturbed(proxy.disturbed() + 2);
    proxy.set(Behaviour::Pass);
    assert_eq!(reading.await.unwrap().unwrap(), b"orbit".as_slice());

    // Somebody waits for what is read: not forever.
    proxy.set(OVERLOADED);
    let read = tokio::time::timeout(Duration::from_secs(30), blobs.get(id)).await;
    assert_unavailable(read.expect("within its patience"));
}

#[tokio::test]
async fn a_server_that_says_nothing_is_not_waited_for_forever() {
    let server = Seaweed::shared();
    let proxy = Proxy::before(&server.address());
    let blobs = open(server, &proxy);
    let id = blobs.put(b"profile".to_vec()).await.unwrap();
    proxy.set(Behaviour::StallAfter(0));
    let read = tokio::time::timeout(Duration::from_secs(40), blobs.get(id)).await;
    assert_unavailable(read.expect("within its patience"));
    proxy.set(Behaviour::Pass);
    assert_eq!(blobs.get(id).await.unwrap(), b"profile".as_slice());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_write_with_a_lost_answer_is_known() {
    let server = Seaweed::shared();
    let proxy = Proxy::before(&server.address());
    let blobs = open(server, &proxy);
    let content = b"spectrum".repeat(1_000);
    proxy.set(Behaviour::LoseAnswerTo("PUT /"));
    let id = blobs.put(content.clone()).await.unwrap();
    assert_eq!(proxy.disturbed(), 1);
    assert_eq!(blobs.get(id).await.unwrap(), content);

    let (file, large) = large_file();
    // The request that completes an upload.
    proxy.set(Behaviour::LoseAnswerTo("?uploadId="));
    assert_eq!(blobs.put_file(&file).await.unwrap(), (large, 24_000_000));
    assert_eq!(proxy.disturbed(), 2);
    assert_eq!(blobs.verify(large).await.unwrap(), 24_000_000);
}

#[tokio::test]
async fn a_server_without_room_is_full_and_nothing_else() {
    let server = Seaweed::shared();
    let proxy = Proxy::before(&server.address());
    let blobs = open(server, &proxy);
    proxy.set(FULL);
    let error = blobs.put(b"orbit".to_vec()).await.unwrap_err();
    assert!(error.is_full() && !error.is_unavailable() && !error.is_damage(), "{error}");
}

#[tokio::test]
async fn a_wrong_bucket_or_key_is_neither_lost_blobs_nor_an_unavailable_server() {
    let server = Seaweed::shared();
    let ObjectsLocation::S3 { bucket, prefix, settings } = server.location(&server.address(), PREFIX) else {
        panic!("it is a bucket");
    };
    let id: BlobId = blake3::hash(b"nowhere").into();
    let mut wrong_key = settings.clone();
    wrong_key.insert("secret_access_key".to_owned(), "another".to_owned());
    for location in [
        ObjectsLocation::S3 { bucket: "another-bucket".to_owned(), prefix: prefix.clone(), settings },
        ObjectsLocation::S3 { bucket, prefix, settings: wrong_key },
    ] {
        let blobs = BlobStore::open(&location).unwrap();
        for error in [blobs.get(id).await.unwrap_err(), blobs.verify(id).await.unwrap_err()] {
            assert!(matches!(error, StoreError::Blob(_)), "{error}");
            assert!(!error.is_damage() && !error.is_unavailable(), "{error}");
        }
    }
}
