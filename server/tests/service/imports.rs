//! Parts of a scenario from files of other programs.

use axum::body::Body;
use axum::http::{Request, header};
use drillsweep_import::{AssumedUnits, MOST_BYTES, SurveyOptions, TallyOptions};
use serde_json::{Value, json};

use crate::bench::{Answer, Bench};

/// A pound-force over a hundred square feet \[Pa\].
const POUNDS: f64 = 4.448_221_615_260_5 / 9.290_304;

const SURVEY: &str = "MD;Inc;Azi\n0;0;0\n1000;2,5;-1\n2000;5;x\n";
const TALLY: &str =
    "Item,Joints,Length each,OD,ID\nBit,1,1,8,3\nDrill collar,3,30,8,3\nHWDP,10,31,5,\nJar,1,31,6.5,2.75\n";

impl Bench {
    async fn import(&self, path: &str, media_type: &str, bytes: impl Into<Body>) -> Answer {
        let request = Request::post(format!("/v1/imports/{path}")).header(header::CONTENT_TYPE, media_type);
        self.send(request.body(bytes.into()).unwrap()).await
    }
}

#[tokio::test]
async fn files_are_answered_as_the_library_reads_them() {
    let bench = Bench::new().await;
    let survey = bench.import("survey?depth_unit=ft", "text/csv", SURVEY).await;
    assert_eq!(survey.status, 200, "{}", survey.text());
    let options = SurveyOptions { depth_unit: Some("ft"), sheet: None };
    assert_eq!(survey.json(), json!(drillsweep_import::survey(SURVEY.as_bytes(), options).unwrap()));
    assert_eq!(survey.json()["problems"][0]["row"], 4);

    let tally = bench.import("tally?assumed_units=field", "application/octet-stream", TALLY).await;
    assert_eq!(tally.status, 200, "{}", tally.text());
    let options = TallyOptions { assumed_units: Some(AssumedUnits::Field), ..TallyOptions::default() };
    assert_eq!(tally.json(), json!(drillsweep_import::tally(TALLY.as_bytes(), options).unwrap()));
    let problem = &tally.json()["problems"][0];
    assert_eq!((&problem["row"], &problem["column"]), (&json!(4), &json!("E")));

    let hole =
        bench.import("hole", "text/plain", "Section;From (m);ID (in)\ncasing;0;8.5\nopen;100;6\n").await;
    assert_eq!(hole.json()["sections"][1]["hole_diameter"], 0.1524);
}

#[tokio::test]
async fn sections_of_a_tally_are_those_of_a_request() {
    let bench = Bench::new().await;
    let mut tally = bench.import("tally?assumed_units=field", "text/csv", TALLY).await.json();
    let length = tally["length"].as_f64().unwrap();
    let mut scenario = bench.get("/v1/scenarios/paper-200m").await.json()["scenario"].clone();
    scenario["string"]["sections"] = tally["sections"].take();
    for list in ["gauges", "unbalance"] {
        scenario["string"][list] = json!([]);
    }
    let hole = bench.import("hole", "text/csv", "Section;From (m);ID (in)\nopen;0;9\n").await.json();
    scenario["well"]["section"] = hole["sections"].clone();
    let station = |depth: f64| json!({"measured_depth": depth, "inclination_deg": 0, "azimuth_deg": 0});
    scenario["well"]["survey"] = json!([station(0.0), station(length)]);
    scenario["recording"]["nodes"] = json!([]);
    let request = json!({"scenario": scenario, "axes": {"flow_rate": {"values": [0.01]}}});
    let plan = bench.post("/v1/sweeps?dry_run=true", request).await;
    assert_eq!(plan.status, 200, "{}", plan.text());
}

#[tokio::test]
async fn muds_are_fitted_to_readings_or_to_plastic_viscosity() {
    let bench = Bench::new().await;
    let fit = async |body: Value| bench.post("/v1/imports/mud", body).await;
    // Dials of tau = 3 Pa + 0.2 Pa s^0.7 gamma^0.7 on a viscometer R1-B1-F1.
    let dial = |rpm: f64| (3.0 + 0.2 * (1.703 * rpm).powf(0.7)) / (1.0667 * POUNDS);
    let reading = |rpm: f64| json!({"rpm": rpm, "dial": dial(rpm)});
    let readings: Vec<_> = [600.0, 300.0, 200.0, 100.0, 6.0, 3.0].map(reading).into();
    let report = fit(json!({"readings": readings})).await.json();
    for (member, expected) in [("yield_stress", 3.0), ("consistency", 0.2), ("flow_index", 0.7)] {
        let found = report["least_squares"][member].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 1e-6, "{member}: {found}");
    }
    let [six, three, lowest, low] = [dial(600.0), dial(300.0), dial(3.0), dial(6.0)];
    let law = json!({
        "plastic_viscosity": 1e-3 * (six - three),
        "yield_point": POUNDS * (2.0 * three - six),
        "low_shear_yield_point": POUNDS * (2.0 * lowest - low),
    });
    let law = fit(law).await.json();
    for member in ["yield_stress", "consistency", "flow_index"] {
        let (found, expected) = (law[member].as_f64().unwrap(), report["rp_13d"][member].as_f64().unwrap());
        assert!((found / expected - 1.0).abs() < 1e-9, "{member}: {found} {expected}");
    }
    for (body, pointer) in [
        (json!({}), ""),
        (json!({"readings": [{"rpm": 600, "dial": 62}]}), "/readings"),
        (json!({"readings": [{"rpm": 600, "dial": 62}, {"rpm": 300, "dial": -1}]}), "/readings/1"),
        (json!({"plastic_viscosity": -1, "yield_point": 0}), "/plastic_viscosity"),
        (json!({"plastic_viscosity": 0.01}), ""),
    ] {
        let problem = fit(body.clone()).await.problem(422, "invalid-request");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{body}");
    }
    fit(json!({"reading": []})).await.problem(400, "malformed-body");
}

#[tokio::test]
async fn files_that_are_not_read_name_parameter_or_cells() {
    let bench = Bench::new().await;
    for (path, text, parameter) in [
        ("survey", SURVEY, "depth_unit"),
        ("tally", TALLY, "assumed_units"),
        ("tally?assumed_units=si", "Item,Length,OD,ID\nJar,9,200,70\nDC,9,200,70\n", "order"),
        ("tally?assumed_units=si&order=up", TALLY, "order"),
        ("hole?unit=m", TALLY, "unit"),
    ] {
        let problem = bench.import(path, "text/csv", text).await.problem(400, "invalid-parameter");
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{path}: {problem}");
    }
    let text = "MD (m),Inc,Azi\n0,0,0\n30,one,2\n";
    let problem = bench.import("survey", "text/csv", text).await.problem(400, "malformed-body");
    assert_eq!(problem["errors"][0]["detail"], "row 3, column B, `one`: no number");
    for (text, detail) in [
        ("", "empty"),
        ("<a>", "XML"),
        ("<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>", "XML"),
        ("PK\u{3}\u{4}", "Excel"),
        ("a,b,c\n1,2,3\n", "headings"),
    ] {
        for part in ["survey", "tally", "hole"] {
            let problem = bench.import(part, "text/csv", text).await.problem(400, "malformed-body");
            assert!(problem["detail"].as_str().unwrap().contains(detail), "{part}: {problem}");
        }
    }
    let large = vec![b'1'; MOST_BYTES + 1];
    bench.import("tally", "text/csv", large).await.problem(413, "body-too-large");
}
