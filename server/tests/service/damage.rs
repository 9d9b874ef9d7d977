//! Tables that storage has lost: nothing of them is served, everything else is, and they are computed again.

use std::io::{Cursor, Read};

use axum::body::Body;
use axum::http::{Request, StatusCode};
use serde_json::{Value, json};

use crate::bench::{Answer, Bench};

/// A finished sweep of two points with the same tables, and its path.
async fn finished(bench: &Bench) -> String {
    let id = bench
        .submit(json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}}))
        .await;
    bench.succeed().await;
    bench.succeed().await;
    format!("/v1/sweeps/{id}")
}

/// Flips a bit in the middle of a table of point 1; point 2 has the same file.
async fn damage(bench: &Bench, path: &str, table: &str) {
    let file = bench.blob_file_of(path, 1, table).await;
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(file, bytes).unwrap();
}

async fn range(bench: &Bench, path: &str, range: &str) -> Answer {
    bench.send(Request::get(path).header("range", range).body(Body::empty()).unwrap()).await
}

#[tokio::test]
async fn a_reader_of_a_damaged_table_has_it_computed_again() {
    let bench = Bench::new().await;
    let path = finished(&bench).await;
    let whole = bench.get(&format!("{path}/points/1/artifacts/history")).await.body;
    damage(&bench, &path, "history").await;

    let point = format!("{path}/points/1");
    for ask in ["artifacts/history", "history", "orbit?node=49", "spectrum?node=49"] {
        let problem = bench.get(&format!("{point}/{ask}")).await.problem(503, "recomputing");
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("table history") && detail.contains("recomputed"), "{detail}");
        // Once: the second reader finds it on its way.
        let counts = bench.get(&path).await.json()["counts"].clone();
        assert_eq!((&counts["queued"], &counts["succeeded"]), (&json!(1), &json!(1)), "{ask}");
    }
    assert_eq!(bench.get(&format!("{point}/profile")).await.status, StatusCode::OK);

    bench.succeed().await;
    let mended = bench.get(&format!("{point}/artifacts/history")).await;
    assert_eq!((mended.status, mended.body), (StatusCode::OK, whole));
    assert_eq!(bench.get(&path).await.json()["state"], "completed");
}

#[tokio::test]
async fn a_table_on_an_object_store_that_does_not_answer_is_not_damaged() {
    let mut bench = Bench::new().await;
    let path = finished(&bench).await;
    bench.lose_object_store().await;
    let answer = bench.get(&format!("{path}/points/1/artifacts/history")).await;
    answer.problem(503, "unavailable");
    assert_eq!(answer.headers["retry-after"], "1");
    assert_eq!(bench.get(&path).await.json()["counts"]["succeeded"], 2, "nothing is computed again");
}

#[tokio::test]
async fn no_range_of_a_damaged_file_is_served() {
    let bench = Bench::new().await;
    let path = finished(&bench).await;
    let file = format!("{path}/points/2/artifacts/history");
    let length = std::fs::metadata(bench.blob_file_of(&path, 2, "history").await).unwrap().len();
    assert_eq!(range(&bench, &file, "bytes=0-9").await.status, StatusCode::PARTIAL_CONTENT);
    damage(&bench, &path, "history").await;
    for bytes in [format!("bytes={0}-{0}", length / 2), format!("bytes=0-{}", length - 1)] {
        range(&bench, &file, &bytes).await.problem(503, "recomputing");
    }
}

#[tokio::test]
async fn a_result_whose_repair_failed_is_reported_as_damaged() {
    let bench = Bench::new().await;
    let path = finished(&bench).await;
    damage(&bench, &path, "history").await;
    let file = format!("{path}/points/1/artifacts/history");
    bench.get(&file).await.problem(503, "recomputing");
    bench.diverge().await;
    let problem = bench.get(&file).await.problem(500, "damaged");
    assert!(problem["detail"].as_str().unwrap().contains("recomputing its point failed"), "{problem}");
    // It is not tried again and again.
    assert_eq!(bench.get(&path).await.json()["counts"]["succeeded"], 2);
}

#[tokio::test]
async fn an_export_omits_and_lists_damaged_results() {
    let bench = Bench::new().await;
    let path = finished(&bench).await;
    let whole = bench.get(&format!("{path}/export")).await;
    assert_eq!(manifest(&whole)["missing"], json!([]));
    assert_eq!(manifest(&whole)["files"], 6);
    damage(&bench, &path, "profile").await;
    std::fs::remove_file(bench.blob_file_of(&path, 1, "statics").await).unwrap();

    let export = bench.get(&format!("{path}/export")).await;
    let names: Vec<String> = archive(&export).file_names().map(|name| name.unwrap().into_owned()).collect();
    let expected =
        ["sweep.json", "table.csv", "points/1/history.parquet", "points/2/history.parquet", "manifest.json"];
    assert_eq!(names, expected);
    let manifest = manifest(&export);
    let missing = manifest["missing"].as_array().unwrap();
    let of = |entry: &Value| (entry["point"].as_u64().unwrap(), entry["table"].as_str().unwrap().to_owned());
    let found: Vec<_> = missing.iter().map(of).collect();
    let expected = [(1, "profile"), (1, "statics"), (2, "profile"), (2, "statics")];
    assert_eq!(found, expected.map(|(point, table)| (point, table.to_owned())));
    for entry in missing {
        assert!(entry["reason"].as_str().unwrap().contains("recomputed"), "{entry}");
    }
    assert_eq!(bench.get(&path).await.json()["counts"]["queued"], 2);
}

fn archive(answer: &Answer) -> zip::ZipArchive<Cursor<Vec<u8>>> {
    assert_eq!(answer.status, StatusCode::OK);
    zip::ZipArchive::new(Cursor::new(answer.body.to_vec())).unwrap()
}

fn manifest(answer: &Answer) -> Value {
    let mut text = String::new();
    archive(answer).by_name("manifest.json").unwrap().read_to_string(&mut text).unwrap();
    serde_json::from_str(&text).unwrap()
}
