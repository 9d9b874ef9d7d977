//! Reports: their values, units, escapes and headers.

use axum::http::{StatusCode, header};
use serde_json::{Value, json};

use crate::bench::Bench;

/// Texts of an HTML document without its tags and pictures, entities resolved.
fn text_of(html: &str) -> String {
    let (mut text, mut rest) = (String::new(), html);
    while let Some((before, after)) = rest.split_once('<') {
        text.push_str(before);
        text.push(' ');
        let end = if after.starts_with("svg") { "</svg>" } else { ">" };
        rest = after.split_once(end).map_or("", |(_, after)| after);
    }
    text.push_str(rest);
    let entities = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&amp;", "&"), ("\u{a0}", " ")];
    let resolved = entities.iter().fold(text, |text, (entity, sign)| text.replace(entity, sign));
    resolved.split_whitespace().collect::<Vec<_>>().join(" ")
}

async fn finished(name: &str) -> (Bench, String) {
    let bench = Bench::new().await;
    let axes = json!({"flow_rate": {"values": [0.01, 0.04]}, "mud_density": {"values": [1200, 1500]}});
    let id = bench.submit(json!({"preset": "paper-200m", "name": name, "axes": axes})).await;
    for _ in 0..3 {
        bench.succeed().await;
    }
    bench.diverge().await;
    (bench, format!("/v1/sweeps/{id}"))
}

#[tokio::test]
async fn a_report_has_the_values_of_the_service_and_is_the_same_for_equal_data() {
    let (bench, path) = finished("flow against density").await;
    let answer = bench.get(&format!("{path}/report")).await;
    assert_eq!(answer.status, StatusCode::OK, "{}", answer.text());
    assert_eq!(answer.headers[header::CONTENT_TYPE], "text/html; charset=utf-8");
    let policy = answer.headers[header::CONTENT_SECURITY_POLICY].to_str().unwrap();
    assert!(
        policy.starts_with("default-src 'none'; style-src 'sha256-") && !policy.contains("unsafe"),
        "{policy}"
    );
    let text = text_of(answer.text());
    let window = bench.get(&format!("{path}/window")).await.json();
    for (class, points) in window["attributes"]["points_by_class"].as_object().unwrap() {
        let line = format!("{} {points}", class.replace('_', " "));
        assert!(text.contains(&line), "{line} in {text}");
    }
    let key = bench.get(&format!("{path}/points/1")).await.json()["key"].as_str().unwrap().to_owned();
    let version = drillsweep_api::PHYSICS_VERSION.to_string();
    for words in [
        "flow against density",
        "4 points: 3 with a result, 1 failed",
        "flow rate 0.01 m³/s 0.04 m³/s 2",
        "mud density 1200 kg/m³ 1500 kg/m³ 2",
        "hole diameter 215.9 mm",
        "weight on bit −100 kN",
        "largest equivalent stress of all elements 517.1 MPa",
        "error of orbit sizes within 2 %",
        "Verified: no",
        &format!("Physics version {version}"),
        &format!("Key of point 1 {key}"),
    ] {
        assert!(text.contains(words), "{words} in {text}");
    }
    assert_eq!(bench.get(&format!("{path}/report")).await.text(), answer.text());
    let point = text_of(bench.get(&format!("{path}/points/1/report")).await.text());
    let diagnosis = bench.get(&format!("{path}/points/1/diagnosis")).await.json();
    for words in [diagnosis["sentence"].as_str().unwrap(), "flow rate 0.01 m³/s, mud density 1200 kg/m³"] {
        assert!(point.contains(words), "{words} in {point}");
    }
    let failed = text_of(bench.get(&format!("{path}/points/4/report")).await.text());
    assert!(failed.contains("Judgement failed") && failed.contains("The point failed: "), "{failed}");
}

#[tokio::test]
async fn reports_follow_the_requested_units_and_limits() {
    let (bench, path) = finished("units").await;
    let field = text_of(
        bench.get(&format!("{path}/report?units=field&limits=largest_side_force:44482.216")).await.text(),
    );
    // NIST SP 811: 8.5 in are 215.9 mm, 4448.2216 N a klbf, 6.309020e-5 m3/s a gpm, 6894757 Pa a ksi.
    for words in [
        "hole diameter 8.5 in",
        "weight on bit −22.48 klbf",
        "flow rate 158.5 gpm 634 gpm 2",
        "75 ksi",
        "largest side force of all nodes 10 klbf",
    ] {
        assert!(field.contains(words), "{words} in {field}");
    }
    let html = bench.get(&format!("{path}/report?units=field")).await.text().to_owned();
    for words in [">measured depth [ft]<", ">flow rate [gpm]<"] {
        assert!(html.contains(words), "{words} in {html}");
    }
    let refused = bench.get(&format!("{path}/report?units=imperial")).await.problem(400, "invalid-parameter");
    assert_eq!(refused["errors"][0]["parameter"], "units");
    bench.get(&format!("{path}/points/9/report")).await.problem(404, "not-found");
    bench.get("/v1/sweeps/none/report").await.problem(404, "not-found");
}

#[tokio::test]
async fn names_of_users_are_no_markup() {
    let hostile = "<script>alert(1)</script> & \"quoted\" <img src=x onerror=alert(1)>";
    let (bench, path) = finished(hostile).await;
    for report in [format!("{path}/report"), format!("{path}/points/1/report")] {
        let html = bench.get(&report).await.text().to_owned();
        assert!(!html.contains("<script") && !html.contains("<img"), "{html}");
        assert!(html.contains("&lt;script&gt;alert(1)&lt;/script&gt; &amp; "), "{html}");
        assert!(text_of(&html).contains(hostile));
    }
}

#[tokio::test]
async fn a_point_without_a_result_has_its_inputs_and_a_copy_is_revalidated() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let path = format!("/v1/sweeps/{id}/report");
    let text = text_of(bench.get(&path).await.text());
    assert!(text.contains("0 with a result") && text.contains("hole diameter 215.9 mm"), "{text}");
    let point = text_of(bench.get(&format!("/v1/sweeps/{id}/points/1/report")).await.text());
    assert!(point.contains("The point is queued: it has no result."), "{point}");
    let answer = bench.get(&path).await;
    let request =
        axum::http::Request::get(&path).header(header::IF_NONE_MATCH, &answer.headers[header::ETAG]);
    let unchanged = bench.send(request.body(axum::body::Body::empty()).unwrap()).await;
    assert_eq!(unchanged.status, StatusCode::NOT_MODIFIED);
    bench.succeed().await;
    let later = bench.get(&path).await;
    assert_ne!(later.headers[header::ETAG], answer.headers[header::ETAG]);
    assert!(text_of(later.text()).contains("1 with a result"), "{}", Value::from(later.text()));
}
