//! Verifying a sample of a sweep's points.

use std::collections::BTreeMap;

use drillsweep_store::NewResult;
use serde_json::{Value, json};

use crate::bench::Bench;

/// Claims the next work and ends it with this summary; gives its accuracy.
async fn end_with(bench: &Bench, summary: impl Fn(&str) -> Value) -> String {
    let claim = bench.claim().await;
    let scenario = drillsweep_api::compose(&claim.scenario.base_json, &claim.scenario.changes_json).unwrap();
    let accuracy = serde_json::to_value(scenario.accuracy).unwrap();
    let accuracy = accuracy.as_str().unwrap_or("explicit").to_owned();
    let summary = summary(&accuracy).to_string();
    let result =
        NewResult { summary_json: &summary, provenance_json: "{}", artifacts: &[], is_repeatable: true };
    assert!(bench.store.finish_done(&claim.lease, &result).await.unwrap());
    accuracy
}

/// Orbits of 1 mm at the reference and of `size` at any other accuracy.
fn orbit(size: f64) -> impl Fn(&str) -> Value {
    move |accuracy| {
        let size = if accuracy == "reference" { 0.001 } else { size };
        json!({"orbit_radius_rms_49": size, "contact_count": 7})
    }
}

fn grid(verify: f64, accuracy: &Value) -> Value {
    json!({"preset": "paper-200m", "verify": verify, "set": {"accuracy": accuracy},
        "axes": {"flow_rate": {"values": [0.01, 0.02, 0.03]}, "mud_density": {"values": [1200, 1500]}}})
}

#[tokio::test]
async fn a_bias_beyond_the_promise_is_reported_by_sweep_table_picture_and_export() {
    let bench = Bench::new().await;
    let id = bench.submit(grid(2.0, &json!("standard"))).await;
    let path = format!("/v1/sweeps/{id}");
    let sweep = bench.get(&path).await.json();
    assert_eq!(sweep["request"]["verify"], 2.0);
    assert_eq!(
        (&sweep["counts"]["total"], &sweep["verification"]["counts"]["queued"]),
        (&json!(6), &json!(2))
    );
    assert_eq!(sweep["verification"].get("worst"), None);
    for point in 1..=6 {
        assert_eq!(end_with(&bench, orbit(0.00101)).await, "standard", "point {point}");
    }
    let sweep = bench.get(&path).await.json();
    assert_eq!((&sweep["state"], &sweep["progress"]), (&json!("running"), &json!(0.75)));
    let verified = bench.get(&format!("{path}/verification")).await.json();
    let ordinals = verified["columns"]["ordinal"].clone();
    assert_eq!(ordinals.as_array().unwrap().len(), 2);
    assert_eq!(verified["columns"]["state"], json!(["queued", "queued"]));
    assert_eq!(verified["columns"].get("bias_orbit_radius_rms_49"), None);

    assert_eq!(end_with(&bench, orbit(0.0)).await, "reference");
    // Within the promise there is no warning.
    let sweep = bench.get(&path).await.json();
    assert_eq!(
        (sweep["verification"].get("warnings"), &sweep["verification"]["worst"]["promised"]),
        (None, &json!(0.02))
    );
    let far = |_: &str| json!({"orbit_radius_rms_49": 0.002, "contact_count": 7});
    end_with(&bench, far).await;
    let sweep = bench.get(&path).await.json();
    assert_eq!(
        (&sweep["state"], &sweep["verification"]["counts"]["succeeded"]),
        (&json!("completed"), &json!(2))
    );
    let worst = &sweep["verification"]["worst"];
    assert_eq!((&worst["statistic"], &worst["ordinal"]), (&json!("orbit_radius_rms_49"), &ordinals[1]));
    assert!((worst["bias"].as_f64().unwrap() + 0.495).abs() < 1e-12);
    let warning = sweep["verification"]["warnings"][0].as_str().unwrap();
    assert!(
        warning.contains("1 of 2 points") && warning.contains("2 %") && warning.contains("−49.50 %"),
        "{warning}"
    );

    let verified = bench.get(&format!("{path}/verification")).await.json();
    assert_eq!(verified["columns"]["reference_orbit_radius_rms_49"], json!([0.001, 0.002]));
    assert_eq!(verified["attributes"]["statistics"]["orbit_radius_rms_49"]["exceeding"], 1);
    assert_eq!(verified["attributes"]["warnings"][0], warning);
    let csv =
        bench.get(&format!("{path}/verification?format=csv&fields=ordinal,bias_orbit_radius_rms_49")).await;
    assert_eq!(csv.text().lines().count(), 3);
    let table = bench.get(&format!("{path}/table")).await.json();
    let biases = table["columns"]["bias_orbit_radius_rms_49"].as_array().unwrap();
    let known: BTreeMap<usize, f64> =
        (1..).zip(biases).filter_map(|(ordinal, bias)| Some((ordinal, bias.as_f64()?))).collect();
    assert_eq!(json!(known.keys().collect::<Vec<_>>()), ordinals);
    assert_eq!(table["attributes"]["warnings"][0], warning);
    assert_eq!(table["units"]["bias_orbit_radius_rms_49"], "1");
    let map = bench.get(&format!("{path}/table?format=svg&fields=orbit_radius_rms_49")).await;
    let map = map.text();
    assert!(map.contains(
        "diamonds: 2 points verified by the reference: bias up to −49.50 %, beyond the 2 % promised"
    ));
    assert_eq!(map.matches(r#"class="marker""#).count(), 2);
    let archive = bench.get(&format!("{path}/export?artifacts=")).await;
    assert!(archive.body.windows(16).any(|name| name == b"verification.csv"));

    // Lists tell how far it is, and read no results for it.
    let listed = bench.get("/v1/sweeps").await.json();
    let listed = &listed["sweeps"][0]["verification"];
    assert_eq!((&listed["counts"]["succeeded"], listed.get("worst")), (&json!(2), None));
    bench.get("/v1/sweeps/none/verification").await.problem(404, "not-found");
}

#[tokio::test]
async fn a_method_without_a_promise_has_a_bias_and_no_warning() {
    let bench = Bench::new().await;
    let id = bench.submit(grid(0.2, &json!({"integrator": "esdirk4", "step": 0.001}))).await;
    for _ in 0..7 {
        end_with(&bench, orbit(0.002)).await;
    }
    let sweep = bench.get(&format!("/v1/sweeps/{id}")).await.json();
    assert_eq!(sweep["state"], "completed");
    let verification = &sweep["verification"];
    assert_eq!((&verification["counts"]["total"], verification.get("warnings")), (&json!(1), None));
    assert!((verification["worst"]["bias"].as_f64().unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(verification["worst"].get("promised"), None);
    // A sweep that verifies nothing says nothing.
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    assert_eq!(bench.get(&format!("/v1/sweeps/{id}")).await.json().get("verification"), None);
    let empty = bench.get(&format!("/v1/sweeps/{id}/verification")).await.json();
    assert_eq!(empty["columns"]["ordinal"], json!([]));
}

#[tokio::test]
async fn failed_reference_runs_are_retried_and_known_ones_reused() {
    let bench = Bench::new().await;
    let id = bench.submit(grid(1.0, &json!("draft"))).await;
    let path = format!("/v1/sweeps/{id}");
    for _ in 0..6 {
        end_with(&bench, orbit(0.00104)).await;
    }
    let claim = bench.claim().await;
    let error = json!({"class": "physical", "reason": "the state is not finite"}).to_string();
    assert!(bench.store.finish_failed(&claim.lease, &error).await.unwrap());
    let sweep = bench.get(&path).await.json();
    assert_eq!(
        (&sweep["state"], &sweep["counts"]["failed"], &sweep["verification"]["counts"]["failed"]),
        (&json!("completed"), &json!(0), &json!(1))
    );
    let verified = bench.get(&format!("{path}/verification")).await.json();
    assert_eq!(verified["columns"]["error"], json!(["the state is not finite"]));
    let retried = bench.post(&format!("{path}/retry"), json!({})).await.json();
    assert_eq!(
        (&retried["state"], &retried["verification"]["counts"]["queued"]),
        (&json!("running"), &json!(1))
    );
    let cancelled = bench.post(&format!("{path}/cancel"), json!({})).await.json();
    assert_eq!(
        (&cancelled["counts"]["succeeded"], &cancelled["verification"]["counts"]["cancelled"]),
        (&json!(6), &json!(1))
    );
    bench.post(&format!("{path}/retry"), json!({})).await;
    assert_eq!(end_with(&bench, orbit(0.0)).await, "reference");
    let sweep = bench.get(&path).await.json();
    // Within the 8 % of a draft.
    assert_eq!((&sweep["state"], sweep["verification"].get("warnings")), (&json!("completed"), None));

    // The same once more, and its plan: points and reference run are known.
    let plan = bench.post("/v1/sweeps?dry_run=true", grid(1.0, &json!("draft"))).await.json();
    assert_eq!((&plan["verification"]["total"], &plan["verification"]["known"]), (&json!(1), &json!(1)));
    assert_eq!(plan["verification"]["points"][0]["ordinal"], verified["columns"]["ordinal"][0]);
    let again = bench.submit(grid(1.0, &json!("draft"))).await;
    let again = bench.get(&format!("/v1/sweeps/{again}")).await.json();
    assert_eq!(
        (&again["state"], &again["verification"]["worst"]),
        (&json!("completed"), &sweep["verification"]["worst"])
    );
    // Where nothing is to be computed, another sample has reference runs that nobody has computed.
    let more = bench.post("/v1/sweeps?cache=only", grid(2.0, &json!("draft"))).await;
    let problem = more.problem(409, "no-result");
    assert!(
        problem["detail"].as_str().unwrap().contains("1 of 2 reference runs that verify points"),
        "{problem}"
    );
}

#[tokio::test]
async fn added_points_are_verified_to_the_part_of_the_whole() {
    let bench = Bench::new().await;
    let id = bench
        .submit(json!({"preset": "paper-200m", "verify": 0.25, "axes": {"flow_rate": {"from": 0.01, "to": 0.03, "count": 4}}}))
        .await;
    let path = format!("/v1/sweeps/{id}/points");
    let verified = async |body: Value| {
        let sweep = bench.post(&path, body).await.json();
        (sweep["counts"]["total"].clone(), sweep["verification"]["counts"]["total"].clone())
    };
    let one = |density: f64| json!({"design": "list", "points": [{"flow_rate": density}]});
    assert_eq!(verified(one(0.04)).await, (json!(5), json!(1)));
    assert_eq!(verified(one(0.05)).await, (json!(6), json!(2)));
    // Of a finer grid, four of whose points are there: 13 points in all, of which a quarter is 3.
    let finer = json!({"axes": {"flow_rate": {"from": 0.01, "to": 0.03, "count": 10}}});
    assert_eq!(verified(finer).await, (json!(12), json!(3)));
    let ordinals =
        bench.get(&format!("/v1/sweeps/{id}/verification")).await.json()["columns"]["ordinal"].clone();
    let ordinals: Vec<u64> = serde_json::from_value(ordinals).unwrap();
    assert!(ordinals[0] <= 4 && ordinals[1] == 6 && ordinals[2] > 6, "{ordinals:?}");
}

#[tokio::test]
async fn an_impossible_verification_is_a_problem_of_the_request() {
    let bench = Bench::new().await;
    for (body, said) in [
        (json!({"preset": "paper-200m", "verify": 1.5}), "a part of the points"),
        (json!({"preset": "paper-200m", "verify": 1, "set": {"accuracy": "reference"}}), "already"),
    ] {
        let problem = bench.post("/v1/sweeps", body).await.problem(422, "invalid-request");
        assert_eq!(problem["errors"][0]["pointer"], "/verify");
        assert!(problem["errors"][0]["detail"].as_str().unwrap().contains(said), "{problem}");
    }
    let problem = bench
        .post("/v1/sweeps", json!({"preset": "paper-200m", "verify": "5%"}))
        .await
        .problem(400, "malformed-body");
    assert_eq!(problem["errors"][0]["pointer"], "/verify", "{problem}");
}
