//! Pictures of results, arrays for NumPy, and chosen columns.

use std::io::{Cursor, Read};

use axum::body::Body;
use axum::http::{Request, header};
use serde_json::json;

use crate::bench::Bench;

async fn finished() -> (Bench, String) {
    let bench = Bench::new().await;
    let axes = json!({"flow_rate": {"values": [0.01, 0.04]}, "mud_density": {"values": [1200, 1500]}});
    let id =
        bench.submit(json!({"preset": "paper-200m", "name": "flow against density", "axes": axes})).await;
    for _ in 0..4 {
        bench.succeed().await;
    }
    (bench, format!("/v1/sweeps/{id}"))
}

#[tokio::test]
async fn results_are_shown_as_drawings_and_as_pixels() {
    let (bench, path) = finished().await;
    for (query, words) in [
        ("points/1/orbit?node=49&from=2&to=8", "Orbit, flow rate 0.01 m3/s, mud density 1200 kg/m3"),
        ("points/1/orbit?node=49&from=2&to=8", "node 49 at 57.73 m, 2.00 to 8.00 s"),
        ("points/1/spectrum?node=49&from=2&to=8&range_hz=5&peaks=3", "+2.00 Hz, 30.00 mm"),
        ("points/1/history?node=49&from=2&to=3", "u at 57.7 m MD, lateral"),
        ("table?fields=density_seen", "flow against density"),
    ] {
        let svg = bench.get(&format!("{path}/{query}&format=svg").replace("&&", "&")).await;
        assert_eq!(svg.headers[header::CONTENT_TYPE], "image/svg+xml", "{}", svg.text());
        assert!(svg.text().contains(words), "{words} in {}", svg.text());
        let accepts = Request::get(format!("{path}/{query}")).header(header::ACCEPT, "image/png");
        let png = bench.send(accepts.body(Body::empty()).unwrap()).await;
        assert_eq!(png.headers[header::CONTENT_TYPE], "image/png");
        assert!(png.body.starts_with(b"\x89PNG\r\n\x1a\n"));
    }
    let problem = bench.get(&format!("{path}/table?format=png")).await.problem(400, "invalid-parameter");
    assert!(problem["detail"].as_str().unwrap().contains("density_seen"), "{problem}");
    let words = bench
        .get(&format!("{path}/table?fields=state&spacing=to_scale&slice=mud_density:1200&format=svg"))
        .await;
    for text in [">state: succeeded<", "slice at mud density 1200 kg/m3 (one of 2)"] {
        assert!(words.text().contains(text), "{text} in {}", words.text());
    }
    for (query, parameter, valid) in [
        ("spacing=uneven", "spacing", "to_scale"),
        ("slice=mud_density", "slice", "mud.density:1200"),
        ("slice=mud_density:1300", "slice", "1200"),
        ("slice=mud:1", "slice", "flow_rate"),
    ] {
        let refused = bench.get(&format!("{path}/table?fields=state&{query}&format=svg")).await;
        let problem = refused.problem(400, "invalid-parameter");
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{problem}");
        assert!(problem["errors"][0]["detail"].as_str().unwrap().contains(valid), "{problem}");
    }
    // Such a profile has no depths to be shown over.
    bench.get(&format!("{path}/points/1/profile?format=svg")).await.problem(400, "invalid-parameter");
}

#[tokio::test]
async fn a_map_names_the_depth_of_a_node_of_one_mesh() {
    let bench = Bench::new().await;
    let over = async |axes: serde_json::Value| {
        let id = bench.submit(json!({"preset": "paper-200m", "axes": axes})).await;
        bench.succeed().await;
        bench.succeed().await;
        bench
            .get(&format!("/v1/sweeps/{id}/table?fields=orbit_radius_rms_49&format=svg"))
            .await
            .text()
            .to_owned()
    };
    let flow = over(json!({"flow_rate": {"values": [0.02, 0.03]}})).await;
    assert!(flow.contains(">lateral vibration at 57.7 m MD [mm]<"), "{flow}");
    // Of another mesh a number is another place.
    let mesh = over(json!({"mesh.drillpipe": {"values": [1.5, 1.2]}})).await;
    assert!(mesh.contains(">lateral vibration, node 49 [mm]<"), "{mesh}");
}

#[tokio::test]
async fn pictures_name_the_components_of_their_nodes() {
    let bench = Bench::new().await;
    let set = json!({"string.sections[1].name": "5 in drillpipe"});
    let axes = json!({"flow_rate": {"values": [0.02, 0.03]}});
    let id = bench.submit(json!({"preset": "paper-200m", "set": set, "axes": axes})).await;
    bench.succeed().await;
    bench.succeed().await;
    for (query, words) in [
        ("points/1/orbit?node=49", "5 in drillpipe, node 49 at 57.73 m, "),
        ("points/1/spectrum?node=49&from=2&to=8", "5 in drillpipe, node 49 at 57.73 m"),
        ("points/1/history?node=49&from=2&to=3", "u at 57.7 m MD, 5 in drillpipe, lateral"),
        ("table?fields=orbit_radius_rms_49", ">lateral vibration at 57.7 m MD, 5 in drillpipe [mm]<"),
    ] {
        let svg = bench.get(&format!("/v1/sweeps/{id}/{query}&format=svg")).await;
        assert!(svg.text().contains(words), "{words} in {}", svg.text());
    }
    let orbit = bench.get(&format!("/v1/sweeps/{id}/points/1/orbit?node=49")).await.json();
    assert_eq!(orbit["attributes"]["component"], "5 in drillpipe");
}

#[tokio::test]
async fn columns_can_be_chosen() {
    let (bench, path) = finished().await;
    let table = bench.get(&format!("{path}/table?fields=density_seen,ordinal")).await.json();
    assert_eq!(
        table["columns"],
        json!({"density_seen": [1200.0, 1500.0, 1200.0, 1500.0], "ordinal": [1, 2, 3, 4]})
    );
    let csv = bench.get(&format!("{path}/points/1/history?fields=time,u_10&to=0.002&format=csv")).await;
    assert_eq!(csv.text(), "time,u_10\n0.0,0.01\n0.001,0.01\n");
    let points = bench.get(&format!("{path}/points?fields=state,ordinal&limit=1")).await.json();
    assert_eq!(points["points"], json!([{"state": "succeeded", "ordinal": 1}]));
    assert!(points["next"].is_string());
}

#[tokio::test]
async fn tables_are_served_as_arrays() {
    let (bench, path) = finished().await;
    let npz = bench.get(&format!("{path}/points/1/orbit?node=49&from=2&to=3&format=npz")).await;
    assert_eq!(npz.headers[header::CONTENT_TYPE], "application/x-npz");
    let mut archive = zip::ZipArchive::new(Cursor::new(npz.body.to_vec())).unwrap();
    let mut bytes = Vec::new();
    archive.by_name("u.npy").unwrap().read_to_end(&mut bytes).unwrap();
    let json = bench.get(&format!("{path}/points/1/orbit?node=49&from=2&to=3")).await.json();
    let expected: Vec<u8> = json["columns"]["u"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|value| value.as_f64().unwrap().to_le_bytes())
        .collect();
    assert_eq!(bytes[bytes.len() - expected.len()..], expected);
}
