//! Adding points where classes of a sweep change.

use drillsweep_store::NewResult;
use serde_json::{Value, json};

use crate::bench::Bench;

/// Density \[kg/m3\] of the edge between quiet, below, and stick-slip.
const EDGE: f64 = 1437.0;

/// Ends `count` points with the severity of their density.
async fn end_points(bench: &Bench, count: usize) {
    for _ in 0..count {
        let claim = bench.claim().await;
        let scenario =
            drillsweep_api::compose(&claim.scenario.base_json, &claim.scenario.changes_json).unwrap();
        let severity = if scenario.mud.unwrap().density > EDGE { 1.5 } else { 0.5 };
        let summary =
            json!({"bit_stick_slip_severity": severity, "largest_lateral_acceleration_rms": 0.1}).to_string();
        let result =
            NewResult { summary_json: &summary, provenance_json: "{}", artifacts: &[], is_repeatable: true };
        assert!(bench.store.finish_done(&claim.lease, &result).await.unwrap());
    }
}

#[tokio::test]
async fn an_edge_of_classes_is_located_round_by_round() {
    let bench = Bench::new().await;
    let axes =
        json!({"flow_rate": {"values": [0.01, 0.03]}, "mud_density": {"from": 1200, "to": 1800, "count": 3}});
    let id = bench.submit(json!({"preset": "paper-200m", "axes": axes})).await;
    let path = format!("/v1/sweeps/{id}/points");
    let refine = json!({"refine": {"by": "class", "over": ["mud_density"], "resolution": 0.05}});
    let early = bench.post(&path, refine.clone()).await.problem(422, "invalid-request");
    assert_eq!(early["errors"][0]["pointer"], "/refine/by");
    end_points(&bench, 6).await;
    let mut rounds = Vec::new();
    loop {
        let sweep = bench.post(&path, refine.clone()).await.json();
        let state = &sweep["refinement"];
        rounds.push((state["open_edges"].as_u64().unwrap(), state["longest_edge"].as_f64().unwrap()));
        if state["proposed"] == 0 {
            break;
        }
        // The same request, before there are results, changes nothing.
        let again = bench.post(&path, refine.clone()).await.json();
        assert_eq!(again["counts"], sweep["counts"]);
        end_points(&bench, 2).await;
    }
    // Halves of the first step, on both lines.
    assert_eq!(rounds, [(2, 0.5), (2, 0.25), (2, 0.125), (2, 0.0625), (0, 0.0)]);
    let table: Value = bench.get(&format!("/v1/sweeps/{id}/table?fields=mud_density,class")).await.json();
    let (densities, classes) = (&table["columns"]["mud_density"], &table["columns"]["class"]);
    let of_class = |class: &str| {
        let rows = densities.as_array().unwrap().iter().zip(classes.as_array().unwrap());
        rows.filter(|(_, of)| *of == class)
            .map(|(density, _)| density.as_f64().unwrap())
            .collect::<Vec<f64>>()
    };
    let quiet = of_class("quiet").into_iter().fold(f64::MIN, f64::max);
    let stick_slip = of_class("stick_slip").into_iter().fold(f64::MAX, f64::min);
    assert!(quiet < EDGE && EDGE < stick_slip && stick_slip - quiet <= 0.05 * 600.0, "{quiet}, {stick_slip}");
    // The sweep keeps the points that were added, so that it can be repeated without its results.
    let appended = &bench.get(&format!("/v1/sweeps/{id}")).await.json()["appended"];
    assert_eq!(appended[0]["points"].as_array().unwrap().len(), 2);
}

#[tokio::test]
async fn a_refinement_excludes_a_design_and_names_its_wrong_fields() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let path = format!("/v1/sweeps/{id}/points");
    let pointers = async |body: Value| {
        let problem = bench.post(&path, body).await.problem(422, "invalid-request");
        let errors = problem["errors"].as_array().unwrap().iter();
        errors.map(|error| error["pointer"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(pointers(json!({"refine": {"by": "class"}, "design": "zip"})).await, ["/refine"]);
    assert_eq!(pointers(json!({"refine": {"by": "class"}})).await, ["/refine/over"]);
    assert_eq!(pointers(json!({"refine": {"by": "clas", "budget": 0}})).await[0], "/refine/by");
}
