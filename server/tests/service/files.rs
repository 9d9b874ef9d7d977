//! Files of results: whole, in ranges, not twice; and a sweep in one archive.

use std::io::{Cursor, Read};

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use serde_json::{Value, json};

use crate::bench::{Answer, Bench};

async fn finished() -> (Bench, String) {
    let bench = Bench::new().await;
    let id = bench
        .submit(json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}}))
        .await;
    bench.succeed().await;
    bench.diverge().await;
    (bench, format!("/v1/sweeps/{id}"))
}

async fn with(bench: &Bench, path: &str, headers: &[(&str, &str)]) -> Answer {
    let mut request = Request::get(path);
    for (name, value) in headers {
        request = request.header(*name, *value);
    }
    bench.send(request.body(Body::empty()).unwrap()).await
}

#[tokio::test]
async fn a_file_is_served_whole_and_in_ranges() {
    let (bench, path) = finished().await;
    let list = bench.get(&format!("{path}/points/1/artifacts")).await.json();
    let names: Vec<_> = list["artifacts"].as_array().unwrap().iter().map(|entry| &entry["name"]).collect();
    assert_eq!(names, ["history", "profile", "statics"]);
    let entry = &list["artifacts"][1];
    let link = entry["link"].as_str().unwrap();
    let whole = bench.get(link).await;
    assert_eq!(whole.headers[header::ACCEPT_RANGES], "bytes");
    assert_eq!(whole.headers[header::CONTENT_TYPE], "application/vnd.apache.parquet");
    assert_eq!(whole.body.len() as u64, entry["bytes"].as_u64().unwrap());
    assert_eq!(entry["hash"], blake3::hash(&whole.body).to_hex().as_str());
    let length = whole.body.len();
    for (range, expected) in [
        ("bytes=0-9".to_owned(), 0..10),
        ("bytes=4-".to_owned(), 4..length),
        ("bytes=-8".to_owned(), length - 8..length),
        (format!("bytes=10-{}", length + 100), 10..length),
    ] {
        let part = with(&bench, link, &[("range", &range)]).await;
        assert_eq!(part.status, StatusCode::PARTIAL_CONTENT, "{range}");
        assert_eq!(part.body, whole.body[expected.clone()], "{range}");
        let place = format!("bytes {}-{}/{length}", expected.start, expected.end - 1);
        assert_eq!(part.headers[header::CONTENT_RANGE], place.as_str());
    }
    let beyond = with(&bench, link, &[("range", &format!("bytes={length}-"))]).await;
    beyond.problem(416, "range-not-satisfiable");
    assert_eq!(beyond.headers[header::CONTENT_RANGE], format!("bytes */{length}").as_str());
    for odd in ["lines=1-2", "bytes=x-y", "bytes=0-1,4-5"] {
        let answer = with(&bench, link, &[("range", odd)]).await;
        assert_eq!((answer.status, answer.body.len()), (StatusCode::OK, length), "{odd}");
    }
    bench.get(&format!("{path}/points/1/artifacts/../../etc")).await.problem(404, "no-such-route");
    bench.get(&format!("{path}/points/1/artifacts/..%2f..%2fetc")).await.problem(404, "no-such-table");
    bench.get(&format!("{path}/points/2/artifacts")).await.problem(409, "no-result");
}

/// RFC 9110 section 12.5.3: `identity;q=0` excludes answers without an encoding, and a part of a file has none.
#[tokio::test]
async fn requests_that_exclude_identity_get_no_part_of_a_file() {
    let (bench, path) = finished().await;
    let link = format!("{path}/points/1/artifacts/history");
    let encoded = ("accept-encoding", "gzip, identity;q=0");
    let whole = with(&bench, &link, &[encoded]).await;
    assert_eq!(
        (whole.status, &whole.headers[header::CONTENT_ENCODING]),
        (StatusCode::OK, &"gzip".parse().unwrap())
    );
    let part = with(&bench, &link, &[encoded, ("range", "bytes=0-3")]).await;
    assert_eq!((part.status, &part.body), (StatusCode::OK, &whole.body));
    assert_eq!(part.headers[header::CONTENT_ENCODING], "gzip");
    assert!(!part.headers.contains_key(header::CONTENT_RANGE));
    let either =
        with(&bench, &link, &[("accept-encoding", "gzip, identity;q=0.1"), ("range", "bytes=0-3")]).await;
    assert_eq!((either.status, either.body.len()), (StatusCode::PARTIAL_CONTENT, 4));
}

#[tokio::test]
async fn a_client_with_a_current_copy_of_a_file_does_not_get_it_again() {
    let (bench, path) = finished().await;
    let link = format!("{path}/points/1/artifacts/history");
    let named = bench.get(&format!("{link}.parquet")).await;
    assert_eq!((named.status.as_u16(), &named.body), (200, &bench.get(&link).await.body));
    bench.get(&format!("{link}.json")).await.problem(404, "no-such-table");
    let whole = bench.get(&link).await;
    let tag = whole.headers[header::ETAG].to_str().unwrap().to_owned();
    for known in [tag.clone(), format!("W/{tag}"), format!("\"other\", {tag}"), "*".to_owned()] {
        let answer = with(&bench, &link, &[("if-none-match", &known)]).await;
        assert_eq!((answer.status, answer.body.len()), (StatusCode::NOT_MODIFIED, 0), "{known}");
        assert_eq!(answer.headers[header::ETAG], tag.as_str());
    }
    assert_eq!(with(&bench, &link, &[("if-none-match", "\"other\"")]).await.status, StatusCode::OK);
    // A range of another content than the client has would not fit.
    let fits = with(&bench, &link, &[("range", "bytes=0-3"), ("if-range", &tag)]).await;
    assert_eq!(fits.status, StatusCode::PARTIAL_CONTENT);
    let other = with(&bench, &link, &[("range", "bytes=0-3"), ("if-range", "\"other\"")]).await;
    assert_eq!((other.status, other.body.len()), (StatusCode::OK, whole.body.len()));
}

#[tokio::test]
async fn an_export_holds_the_whole_sweep() {
    let (bench, path) = finished().await;
    let answer = bench.get(&format!("{path}/export")).await;
    assert_eq!(answer.headers[header::CONTENT_TYPE], "application/zip");
    let mut archive = zip::ZipArchive::new(Cursor::new(answer.body.to_vec())).unwrap();
    let names: Vec<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    let expected = [
        "sweep.json",
        "table.csv",
        "points/1/history.parquet",
        "points/1/profile.parquet",
        "points/1/statics.parquet",
        "manifest.json",
    ];
    assert_eq!(names, expected);
    let mut read = |name: &str| {
        let mut bytes = Vec::new();
        archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    };
    let sweep: Value = serde_json::from_slice(&read("sweep.json")).unwrap();
    assert_eq!(sweep["request"]["axes"]["mud_density"]["values"], json!([1200.0, 1500.0]));
    assert_eq!(read("table.csv"), bench.get(&format!("{path}/table?format=csv")).await.body);
    assert_eq!(
        read("points/1/history.parquet"),
        bench.get(&format!("{path}/points/1/artifacts/history")).await.body
    );
    let small = bench.get(&format!("{path}/export?artifacts=profile")).await;
    let archive = zip::ZipArchive::new(Cursor::new(small.body.to_vec())).unwrap();
    let names: Vec<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    assert_eq!(names, ["sweep.json", "table.csv", "points/1/profile.parquet", "manifest.json"]);
    bench.get("/v1/sweeps/none/export").await.problem(404, "not-found");
}
