//! Snapshots of the whole string.

use drillsweep_table::{Column, Table, parquet};
use serde_json::{Value, json};

use crate::bench::Bench;

const NODES: usize = 3;

/// 50 snapshots of three nodes at 25 Hz from 10 s on; every value tells snapshot and node.
fn snapshots() -> Table {
    let rows = || (0..50).flat_map(|frame| (0..NODES).map(move |node| (frame, node)));
    let value = |(frame, node): (usize, usize)| (10 * frame + node) as f32;
    Table::default()
        .with("time", Column::Number(rows().map(|(frame, _)| 10.0 + frame as f64 / 25.0).collect()))
        .with("node", Column::Integer(rows().map(|(_, node)| Some(node as i64 + 1)).collect()))
        .with("u", Column::Single(rows().map(|row| 1e-3 * value(row)).collect()))
        .with("normal_force", Column::Single(rows().map(value).collect()))
}

/// A point with snapshots, and one without; the path of their sweep.
async fn finished() -> (Bench, String) {
    let bench = Bench::new().await;
    let set = json!({"recording.snapshots": {"rate_hz": 25.0, "window": {"from": 10.0, "to": 12.0}}});
    let body = json!({"preset": "paper-200m", "set": set, "axes": {"mud_density": {"values": [1200, 1500]}}});
    let id = bench.submit(body).await;
    let depths = Column::Number(vec![0.0, 1.5, 3.0]);
    let statics = Table::default()
        .with("node", Column::Integer((1..=NODES as i64).map(Some).collect()))
        .with("measured_depth", depths);
    bench.succeed_with_tables(1e-9, &[("snapshots", &snapshots()), ("statics", &statics)]).await;
    bench.succeed().await;
    (bench, format!("/v1/sweeps/{id}/points"))
}

fn numbers(table: &Value, column: &str) -> Vec<f64> {
    let values = table["columns"][column].as_array().unwrap_or_else(|| panic!("no {column} in {table}"));
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[tokio::test]
async fn snapshots_are_served_whole_by_window_and_thinned_by_whole_snapshots() {
    let (bench, path) = finished().await;
    let get = async |query: &str| bench.get(&format!("{path}/1/snapshots{query}")).await.json();
    let whole = get("").await;
    let attributes = |table: &Value, snapshots: u32, first: f64, interval: f64| {
        let told = &table["attributes"];
        assert_eq!((&told["snapshots"], &told["nodes"]), (&json!(snapshots), &json!(3)));
        for (name, expected) in [("first", first), ("interval", interval)] {
            assert!((told[name].as_f64().unwrap() - expected).abs() < 1e-12, "{told}");
        }
    };
    attributes(&whole, 50, 10.0, 0.04);
    assert_eq!(whole["units"], json!({"time": "s", "u": "m", "normal_force": "N"}));
    assert_eq!(numbers(&whole, "node").len(), 150);

    let thinned = get("?from=10.2&to=11&max_frames=7&fields=node,normal_force").await;
    // Snapshots 5 to 24, every third.
    attributes(&thinned, 20, 10.2, 0.12);
    let expected: Vec<f64> =
        (5..25).step_by(3).flat_map(|frame| (0..3).map(move |node| f64::from(10 * frame + node))).collect();
    assert_eq!(numbers(&thinned, "normal_force"), expected);
    assert_eq!(numbers(&thinned, "node"), [1.0, 2.0, 3.0].repeat(7));
    assert_eq!(numbers(&get("?from=20").await, "time"), [0.0; 0]);

    let csv = bench.get(&format!("{path}/1/snapshots?from=11.96&format=csv")).await;
    assert_eq!(csv.text().lines().next(), Some("time,node,u,normal_force"));
    assert_eq!(csv.text().lines().count(), 1 + NODES);
    let stored = bench.get(&format!("{path}/1/snapshots?format=parquet")).await;
    assert!(stored.body == parquet::write(&snapshots()).unwrap(), "as it is stored");
    let part = bench.get(&format!("{path}/1/snapshots?to=10.08&format=parquet")).await;
    assert_eq!(parquet::read(part.body, None, None).unwrap().rows(), 2 * NODES);
}

#[tokio::test]
async fn what_cannot_be_had_of_snapshots_is_told() {
    let (bench, path) = finished().await;
    let problem = bench.get(&format!("{path}/2/snapshots")).await.problem(404, "no-such-table");
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("`recording.snapshots`") && detail.contains("history"), "{detail}");
    for (query, parameter) in
        [("max_frames=0", "max_frames"), ("from=11&to=11", "to"), ("fields=v", "fields")]
    {
        let problem =
            bench.get(&format!("{path}/1/snapshots?{query}")).await.problem(400, "invalid-parameter");
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{problem}");
    }
}
