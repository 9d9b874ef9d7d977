//! The spectrogram of a node.

use drillsweep_table::Table;
use serde_json::{Value, json};

use crate::bench::Bench;

fn numbers(table: &Value, column: &str) -> Vec<f64> {
    let values = table["columns"][column].as_array().unwrap_or_else(|| panic!("no {column} in {table}"));
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[tokio::test]
async fn a_spectrogram_has_both_whirls_of_every_window() {
    let bench = Bench::new().await;
    let id = bench
        .submit(json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}}))
        .await;
    bench.succeed().await;
    bench.succeed_with_tables(1e-9, &[("statics", &Table::default())]).await;
    let path = format!("/v1/sweeps/{id}/points");
    let query = "node=49&window_s=2&step_s=1&window=rectangular&range_hz=5";
    let table = bench.get(&format!("{path}/1/spectrogram?{query}")).await.json();
    let attributes = &table["attributes"];
    assert_eq!(
        (&attributes["node"], &attributes["windows"], &attributes["resolved_hz"]),
        (&json!(49), &json!(9), &json!(200.0))
    );
    for (name, expected) in [("window_s", 2.0), ("step_s", 1.0), ("resolution", 0.5)] {
        assert!((attributes[name].as_f64().unwrap() - expected).abs() < 1e-9, "{attributes}");
    }
    let [time, frequency, amplitude] = ["time", "frequency", "amplitude"].map(|name| numbers(&table, name));
    assert_eq!(time.len(), 9 * 21);
    for ((time, frequency), amplitude) in time.iter().zip(&frequency).zip(&amplitude) {
        // The history turns forward with 30 mm at 2 Hz and backward with 10 mm at 3 Hz about (4, 3) mm.
        let expected = match (2.0 * frequency).round() as i32 {
            0 => 0.005,
            4 => 0.03,
            -6 => 0.01,
            _ => 0.0,
        };
        assert!((amplitude - expected).abs() < 1e-9, "{time} s, {frequency} Hz: {amplitude}");
    }
    let hann = bench.get(&format!("{path}/1/spectrogram?depth=57.73")).await.json();
    assert_eq!(
        (&hann["attributes"]["window"], &hann["attributes"]["samples"]),
        (&json!("hann"), &json!(2500))
    );

    for (query, parameter) in [
        ("node=49&window_s=0", "window_s"),
        ("node=49&window_s=11", "window_s"),
        ("node=49&step_s=-1", "step_s"),
        ("node=49&step_s=0.001&range_hz=400", "step_s"),
        ("node=49&range_hz=0", "range_hz"),
        ("", "node"),
    ] {
        let problem =
            bench.get(&format!("{path}/1/spectrogram?{query}")).await.problem(400, "invalid-parameter");
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{query}: {problem}");
    }
    bench.get(&format!("{path}/1/spectrogram?node=50")).await.problem(404, "node-not-recorded");
    bench.get(&format!("{path}/2/spectrogram?node=49")).await.problem(404, "no-such-table");
}
