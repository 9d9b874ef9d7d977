//! Limits by which points are judged.

use drillsweep_api::judgement::OperatingLimits;
use drillsweep_server::Config;
use drillsweep_store::NewResult;
use serde_json::json;

use crate::bench::Bench;

#[tokio::test]
async fn limits_of_the_service_are_changed_further_by_a_request() {
    let mut bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let claim = bench.claim().await;
    let summary = json!({"bit_stick_slip_severity": 0.8, "largest_side_force": 15e3, "largest_lateral_acceleration_rms": 0.1}).to_string();
    let result =
        NewResult { summary_json: &summary, provenance_json: "{}", artifacts: &[], is_repeatable: true };
    assert!(bench.store.finish_done(&claim.lease, &result).await.unwrap());
    let classes = async |bench: &Bench, limits: &str| {
        let mut classes = Vec::new();
        for view in ["window?", "table?fields=class&"] {
            let table = bench.get(&format!("/v1/sweeps/{id}/{view}limits={limits}")).await.json();
            classes.push(table["columns"]["class"][0].as_str().unwrap().to_owned());
        }
        assert_eq!(classes[0], classes[1]);
        classes.remove(0)
    };
    assert_eq!(classes(&bench, "").await, "quiet");
    let operating_limits =
        OperatingLimits::parse("bit_stick_slip_severity:0.5,largest_side_force:10000").unwrap();
    bench.reconfigure(Config { operating_limits, ..Config::default() });
    assert_eq!(classes(&bench, "").await, "stick_slip");
    assert_eq!(classes(&bench, "bit_stick_slip_severity:off").await, "over_limit");
    assert_eq!(classes(&bench, "bit_stick_slip_severity:0.9,largest_side_force:20000").await, "quiet");
}
