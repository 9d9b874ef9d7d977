//! Snapshots of the whole string.

use std::f64::consts::TAU;

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

fn statics() -> Table {
    Table::default()
        .with("node", Column::Integer((1..=NODES as i64).map(Some).collect()))
        .with("measured_depth", Column::Number(vec![0.0, 1.5, 3.0]))
}

/// A point with snapshots, and one without; the path of their sweep.
async fn finished() -> (Bench, String) {
    let bench = Bench::new().await;
    let set = json!({"recording.snapshots": {"rate_hz": 25.0, "window": {"from": 10.0, "to": 12.0}}});
    let body = json!({"preset": "paper-200m", "set": set, "axes": {"mud_density": {"values": [1200, 1500]}}});
    let id = bench.submit(body).await;
    bench.succeed_with_tables(1e-9, &[("snapshots", &snapshots()), ("statics", &statics())]).await;
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
    let middle = get("?node=2&from=10.2&to=11&max_frames=7").await;
    assert_eq!(middle["attributes"]["nodes"], 1);
    let expected: Vec<f64> = (5..25).step_by(3).map(|frame| f64::from(10 * frame + 1)).collect();
    assert_eq!(numbers(&middle, "normal_force"), expected);
    assert_eq!(numbers(&middle, "node"), [2.0; 7]);

    let csv = bench.get(&format!("{path}/1/snapshots?from=11.96&format=csv")).await;
    assert_eq!(csv.text().lines().next(), Some("time,node,u,normal_force"));
    assert_eq!(csv.text().lines().count(), 1 + NODES);
    let stored = bench.get(&format!("{path}/1/snapshots?format=parquet")).await;
    assert!(stored.body == parquet::write(&snapshots()).unwrap(), "as it is stored");
    let part = bench.get(&format!("{path}/1/snapshots?to=10.08&format=parquet")).await;
    assert_eq!(parquet::read(part.body, None, None).unwrap().rows(), 2 * NODES);
}

#[tokio::test]
async fn impossible_requests_for_snapshots_are_refused_with_reasons() {
    let (bench, path) = finished().await;
    let problem = bench.get(&format!("{path}/2/snapshots")).await.problem(404, "no-such-table");
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("`recording.snapshots`") && detail.contains("history"), "{detail}");
    for (query, parameter) in [
        ("max_frames=0", "max_frames"),
        ("node=4", "node"),
        ("from=11&to=11", "to"),
        ("from=20", "from"),
        ("to=10", "to"),
        ("fields=v", "fields"),
    ] {
        let problem =
            bench.get(&format!("{path}/1/snapshots?{query}")).await.problem(400, "invalid-parameter");
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{problem}");
    }
}

/// Over 10 s at 10 Hz node 2 turns at 60 rpm and 20 rpm about it, under -2 to -4 kN m.
fn history_of_node_2() -> Table {
    let of_time =
        |f: fn(f64) -> f64| Column::Single((0..100).map(|k| f(f64::from(k) / 10.0) as f32).collect());
    Table::default()
        .with("time", Column::Number((0..100).map(|k| f64::from(k) / 10.0).collect()))
        .with("u_2", of_time(|t| 1e-3 * t.sin()))
        .with("v_2", of_time(|t| 1e-3 * t.cos()))
        .with("rotation_speed_2", of_time(|t| (60.0 + 20.0 * t.sin()) * TAU / 60.0))
        .with("torque_2", of_time(|t| -3e3 - 1e3 * t.sin()))
}

/// The bit, node 3, at 25 Hz from 5 s on: it turns at 60 rpm and 120 rpm about it, the others stand still.
fn snapshots_of_torsion() -> Table {
    let rows =
        || (0..125).flat_map(|frame| (0..NODES).map(move |node| (5.0 + f64::from(frame) / 25.0, node)));
    let of_bit = |f: fn(f64) -> f64| {
        let value = |(time, node)| if node + 1 == NODES { f(time) as f32 } else { 0.0 };
        Column::Single(rows().map(value).collect())
    };
    Table::default()
        .with("time", Column::Number(rows().map(|(time, _)| time).collect()))
        .with("node", Column::Integer(rows().map(|(_, node)| Some(node as i64 + 1)).collect()))
        .with("u", of_bit(|_| 0.0))
        .with("rotation_speed", of_bit(|t| (60.0 + 120.0 * t.sin()) * TAU / 60.0))
        .with("torque", of_bit(|t| -7e3 - 2e3 * t.sin()))
}

/// The least and the largest number at the ticks of the vertical axis that bears this name.
fn ticks(svg: &str, axis: &str) -> [f64; 2] {
    let panel = svg.split("<g class=\"axes\">").find(|panel| panel.contains(&format!(">{axis}<"))).unwrap();
    let numbers = panel.lines().filter(|line| line.contains("text-anchor=\"end\""));
    let numbers = numbers.filter_map(|line| line.split(['>', '<']).nth(2)?.replace('−', "-").parse().ok());
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, largest]: [f64; 2], number: f64| {
        [least.min(number), largest.max(number)]
    })
}

#[tokio::test]
async fn a_history_picture_takes_the_rotation_of_the_bit_from_snapshots() {
    let bench = Bench::new().await;
    let body = json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}});
    let id = bench.submit(body).await;
    let (history, statics, snapshots) = (history_of_node_2(), statics(), snapshots_of_torsion());
    let tables = [("history", &history), ("statics", &statics), ("snapshots", &snapshots)];
    bench.succeed_with_tables(1e-9, &tables).await;
    bench.succeed_with_tables(1e-9, &tables[..2]).await;
    let picture = async |point: u32, query: &str| {
        let path = format!("/v1/sweeps/{id}/points/{point}/history?format=svg{query}");
        bench.get(&path).await.text().to_owned()
    };
    let (speed, torque) = ("rotation speed [rpm]", "torque [kN m]");
    let shows = |svg: &str, expected: [[f64; 2]; 2], spacing: [f64; 2]| {
        for ((axis, [least, largest]), spacing) in [speed, torque].into_iter().zip(expected).zip(spacing) {
            let found = ticks(svg, axis);
            assert!(
                (found[0] - least).abs() <= spacing && (found[1] - largest).abs() <= spacing,
                "{axis}: {found:?}"
            );
        }
    };
    // Least and largest of what stands above.
    let (of_bit, of_node_2) = ([[-60.0, 180.0], [-9.0, -5.0]], [[40.0, 80.0], [-4.0, -2.0]]);
    let whole = picture(1, "").await;
    assert!(whole.contains("rotation speed at the bit, 3.0 m MD"), "{whole}");
    shows(&whole, of_bit, [50.0, 1.0]);
    // From 7 to 9 s the sine is above 0.4 and below 1.
    let window = picture(1, "&from=7&to=9").await;
    shows(&window, [[110.0, 180.0], [-9.0, -7.8]], [10.0, 0.25]);

    let nowhere = picture(2, "").await;
    assert!(nowhere.contains("Rotation at the bit, at 3.0 m MD, was not recorded"), "{nowhere}");
    assert!(nowhere.contains("rotation speed at 1.5 m MD"), "{nowhere}");
    shows(&nowhere, of_node_2, [10.0, 0.5]);
    for query in ["&node=2", "&fields=rotation_speed_2"] {
        let asked = picture(1, query).await;
        assert!(!asked.contains("bit"), "{asked}");
    }
    shows(&picture(1, "&node=2").await, of_node_2, [10.0, 0.5]);
}
