//! Blobs: named by their content, written once.

use std::io::{Read as _, Seek as _, Write as _};

use drillsweep_store::{BlobId, NamedFile, StoreError};

use crate::place::{Bucket, Directory, Place, object_name};

async fn the_name_is_the_blake3_hash_of_the_content<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    let id = blobs.put(Vec::new()).await.unwrap();
    // The first test vector of BLAKE3: empty input.
    let hash = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";
    assert_eq!(id.to_string(), hash);
    assert_eq!(hash.parse::<BlobId>().unwrap(), id);
    assert!(matches!("af13".parse::<BlobId>(), Err(StoreError::Corrupt(_))));
}

async fn the_same_content_is_stored_once_and_never_rewritten<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    let content = b"orbit".repeat(1_000);
    let id = blobs.put(content.clone()).await.unwrap();
    let written = place.objects();
    assert_eq!(written.len(), 1);
    assert_eq!((&written[0].name, written[0].bytes), (&object_name(&id.to_string()), 5_000));

    let (again, at_once) = tokio::join!(blobs.put(content.clone()), blobs.put(content.clone()));
    assert_eq!((again.unwrap(), at_once.unwrap()), (id, id));
    assert_eq!(place.objects(), written);

    let other = blobs.put(b"spectrum".to_vec()).await.unwrap();
    assert_ne!(other, id);
    // Another process on the same store reads what was written.
    let reader = place.open();
    assert_eq!(reader.get(id).await.unwrap(), content);
    assert_eq!(reader.get(other).await.unwrap(), b"spectrum".as_slice());
}

async fn a_range_is_cut_from_the_content<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    let content: Vec<u8> = (0..=255).collect();
    let id = blobs.put(content.clone()).await.unwrap();
    assert_eq!(blobs.get_range(id, 10..20).await.unwrap(), content[10..20]);
    assert_eq!(blobs.get_range(id, 250..1_000).await.unwrap(), content[250..]);
    let missing: BlobId = "0".repeat(64).parse().unwrap();
    for error in [blobs.get(missing).await.unwrap_err(), blobs.get_range(missing, 0..1).await.unwrap_err()] {
        assert!(error.is_damage(), "{error}");
    }
    for beyond in [256..300, 20..20] {
        let error = blobs.get_range(id, beyond).await.unwrap_err();
        assert!(matches!(error, StoreError::NoSuchRange(_)) && !error.is_damage(), "{error}");
    }
}

async fn a_damaged_blob_is_replaced_by_the_next_write<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    let content = b"orbit".repeat(1_000);
    let id = blobs.put(content.clone()).await.unwrap();
    let name = object_name(&id.to_string());
    let mut flipped = content.clone();
    flipped[4_321] ^= 4;
    let longer = [content.as_slice(), b"x"].concat();
    for damaged in [b"".as_slice(), &content[..2_500], &flipped, &longer] {
        place.write_object(&name, damaged);
        assert!(blobs.get(id).await.unwrap_err().is_damage());
        assert_eq!(blobs.put(content.clone()).await.unwrap(), id);
        assert_eq!(blobs.get(id).await.unwrap(), content);
    }
    place.delete_object(&name);
    assert!(blobs.get(id).await.unwrap_err().is_damage());
    assert_eq!(blobs.put(content.clone()).await.unwrap(), id);
    assert_eq!(blobs.get(id).await.unwrap(), content);
    assert_eq!(place.objects().len(), 1);
}

async fn no_range_of_a_damaged_blob_is_handed_out<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    let content: Vec<u8> = (0..1_000_000_u32).map(|index| (index % 251) as u8).collect();
    let id = blobs.put(content.clone()).await.unwrap();
    let name = object_name(&id.to_string());
    let mut flipped = content.clone();
    flipped[700_000] ^= 1;

    // Found at the first range, wherever that lies.
    place.write_object(&name, &flipped);
    let error = blobs.get_range(id, 0..10).await.unwrap_err();
    assert!(matches!(error, StoreError::BlobDamaged(damaged) if damaged == id), "{error}");

    place.write_object(&name, &content);
    for range in [0..10, 999_990..2_000_000, 100_000..900_000] {
        let expected = &content[range.start as usize..(range.end as usize).min(content.len())];
        assert_eq!(blobs.get_range(id, range).await.unwrap(), expected);
    }
    // Found at a later one too, and only what is damaged is refused.
    place.write_object(&name, &flipped);
    assert_eq!(blobs.get_range(id, 0..10).await.unwrap(), content[..10]);
    for range in [700_000..700_001, 600_000..600_010, 0..1_000_000] {
        let error = blobs.get_range(id, range).await.unwrap_err();
        assert!(matches!(error, StoreError::BlobDamaged(_)), "{error}");
    }
    place.write_object(&name, &content[..999_999]);
    assert!(blobs.get_range(id, 999_990..1_000_000).await.unwrap_err().is_damage());
}

async fn a_file_that_changes_before_it_is_written_is_no_blob<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    // In one part and in several.
    for length in [1_000, 20 << 20] {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&vec![1; length]).unwrap();
        let named = NamedFile::read(&file).await.unwrap();
        file.rewind().unwrap();
        file.write_all(&[2]).unwrap();
        assert!(matches!(blobs.put_named(&named).await.unwrap_err(), StoreError::LocalFile(_)));
        file.set_len(length as u64 / 2).unwrap();
        assert!(matches!(blobs.put_named(&named).await.unwrap_err(), StoreError::LocalFile(_)));
    }
    assert!(place.objects().is_empty());
}

async fn a_file_is_the_blob_of_its_bytes<P: Place>() {
    let place = P::new();
    let blobs = place.open();
    // None, less than a part of an upload, exactly one, and some more.
    for length in [0, 1_000, 8 << 20, (16 << 20) + 5] {
        let content: Vec<u8> =
            (0..length).map(|k: usize| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&content).unwrap();
        let (id, bytes) = blobs.put_file(&file).await.unwrap();
        assert_eq!(bytes, length as u64);
        let stored = place.objects();
        assert_eq!(blobs.put(content.clone()).await.unwrap(), id);
        assert_eq!(blobs.put_file(&file).await.unwrap().0, id);
        assert_eq!(place.objects(), stored, "what is there is not written again");

        // A damaged blob is replaced, and not handed out before.
        place.write_object(&object_name(&id.to_string()), b"damaged");
        let fetched = blobs.get_into(id, tempfile::tempfile().unwrap()).await;
        assert!(fetched.unwrap_err().is_damage());
        blobs.put_file(&file).await.unwrap();
        let mut fetched = blobs.get_into(id, tempfile::tempfile().unwrap()).await.unwrap();
        let mut read = Vec::new();
        fetched.rewind().unwrap();
        fetched.read_to_end(&mut read).unwrap();
        assert!(read == content, "{length} bytes");
    }
}

macro_rules! in_every_place {
    ($($test:ident,)+) => {
        in_every_place!(directory: Directory, $($test,)+);
        in_every_place!(bucket: Bucket, $($test,)+);
    };
    ($module:ident: $place:ident, $($test:ident,)+) => {
        mod $module {
            $(#[tokio::test]
            async fn $test() {
                super::$test::<super::$place>().await;
            })+
        }
    };
}

in_every_place! {
    the_name_is_the_blake3_hash_of_the_content,
    the_same_content_is_stored_once_and_never_rewritten,
    a_range_is_cut_from_the_content,
    a_damaged_blob_is_replaced_by_the_next_write,
    a_file_is_the_blob_of_its_bytes,
    a_file_that_changes_before_it_is_written_is_no_blob,
    no_range_of_a_damaged_blob_is_handed_out,
}
