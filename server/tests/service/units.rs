//! Tables and pictures in other units than the kept ones, and in drillers' signs.

use axum::http::header;
use drillsweep_table::{Column, parquet};
use serde_json::{Value, json};

use crate::bench::Bench;

/// A sweep of two points with a result over density and weight on bit.
async fn finished() -> (Bench, String) {
    let bench = Bench::new().await;
    let axes = json!({"mud_density": {"values": ["10.5 ppg", 1500]}, "operation.weight_on_bit": {"values": [-50e3]}});
    let id = bench.submit(json!({"preset": "paper-200m", "axes": axes})).await;
    bench.succeed().await;
    bench.succeed().await;
    let path = format!("/v1/sweeps/{id}");
    (bench, path)
}

fn numbers(table: &Value, column: &str) -> Vec<f64> {
    let values =
        table["columns"][column].as_array().unwrap_or_else(|| panic!("no column {column} in {table}"));
    values.iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
}

#[tokio::test]
async fn a_sweep_is_read_in_the_units_in_which_it_was_written() {
    let (bench, path) = finished().await;
    let field = bench.get(&format!("{path}/table?units=field")).await.json();
    let densities = numbers(&field, "mud_density");
    assert_eq!(densities[0], 10.5);
    assert_eq!(field["units"]["mud_density"], "ppg");
    assert_eq!(field["units"]["flow_rate"], "gpm");
    let own = bench.get(&format!("{path}/table?units=field,mud_density:kg/m3")).await.json();
    assert_eq!(numbers(&own, "mud_density")[1], 1500.0);
    assert_eq!(own["units"]["mud_density"], "kg/m3");
    let csv =
        bench.get(&format!("{path}/table?units=field&format=csv&fields=ordinal,mud_density,state")).await;
    assert!(csv.text().starts_with("ordinal,mud_density [ppg],state\n1,10.5,succeeded\n"), "{}", csv.text());
    let name = csv.headers[header::CONTENT_DISPOSITION].to_str().unwrap();
    assert!(name.ends_with("-field.csv\""), "{name}");
    let whole = bench.get(&format!("{path}/table?units=field&format=parquet")).await;
    let table = parquet::read(whole.body, None, None).unwrap();
    assert_eq!(table.units["mud_density"], "ppg");
    assert!(matches!(&table.columns["mud_density"], Column::Number(values) if values[0] == 10.5));
    let npz = bench.get(&format!("{path}/table?units=field&format=npz&fields=mud_density")).await;
    let text: String =
        npz.body.iter().filter(|byte| byte.is_ascii_graphic()).map(|byte| char::from(*byte)).collect();
    assert!(text.contains(r#"{"mud_density":"ppg"}"#));
}

#[tokio::test]
async fn field_units_times_their_factors_are_the_kept_numbers() {
    let (bench, path) = finished().await;
    for (view, query) in [
        ("statics", ""),
        ("history", "max_points=50&"),
        ("orbit", "node=49&max_points=50&"),
        ("spectrum", "node=49&from=2&to=8&"),
        ("spectrogram", "node=49&"),
        ("statistics", ""),
    ] {
        let path = format!("{path}/points/1/{view}?{query}");
        let kept = bench.get(&path).await.json();
        for system in ["field", "si"] {
            let shown = bench.get(&format!("{path}units={system}")).await.json();
            let columns = kept["columns"].as_object().unwrap();
            for name in columns.keys().filter(|name| kept["units"][name.as_str()].is_string()) {
                let units = drillsweep_quantity::Name::parse(name).unwrap().units().unwrap();
                let symbol = shown["units"][name.as_str()].as_str().unwrap();
                let size = drillsweep_quantity::entry::unit_of(symbol, units).unwrap().size;
                for (kept, shown) in numbers(&kept, name).iter().zip(numbers(&shown, name)) {
                    // Recorded samples have single precision.
                    let off = (shown * size - kept).abs();
                    assert!(
                        off <= f64::from(f32::EPSILON) * kept.abs() || kept.is_nan(),
                        "{view} {name}: {kept} {shown}"
                    );
                }
            }
        }
        let csv = bench.get(&format!("{path}units=field&format=csv")).await;
        let json = bench.get(&format!("{path}units=field")).await.json();
        let head: Vec<&str> = csv.text().lines().next().unwrap().split(',').collect();
        for (name, head) in json["columns"].as_object().unwrap().keys().zip(head) {
            match json["units"][name.as_str()].as_str().filter(|unit| *unit != "1") {
                Some(unit) => assert_eq!(head, format!("{name} [{unit}]")),
                None => assert_eq!(head, name),
            }
        }
    }
    let orbit = bench.get(&format!("{path}/points/1/orbit?node=49&units=field")).await.json();
    assert_eq!(orbit["attributes"]["measured_depth"], 57.73 / 0.3048);
    assert_eq!(orbit["units"]["measured_depth"], "ft");
}

#[tokio::test]
async fn modes_and_a_diagnosis_have_depths_and_limits_in_requested_units() {
    /// International foot \[m\] and ksi \[Pa\], a thousand pounds-force on a square inch.
    const FOOT: f64 = 0.3048;
    const KSI: f64 = 4_448.221_615_260_5 / (0.0254 * 0.0254);
    let (bench, path) = finished().await;
    let modes = format!("{path}/points/1/modes?to_hz=2");
    let (kept, field) =
        (bench.get(&modes).await.json(), bench.get(&format!("{modes}&units=field")).await.json());
    let same = |shown: &Value, size: f64, kept: &Value| {
        let (shown, kept) = (shown.as_f64().unwrap(), kept.as_f64().unwrap());
        assert!((shown * size - kept).abs() <= 2.0 * f64::EPSILON * kept.abs(), "{shown} for {kept}");
    };
    assert!(!kept["modes"].as_array().unwrap().is_empty() && kept.get("units").is_none());
    for (shown, kept) in field["modes"].as_array().unwrap().iter().zip(kept["modes"].as_array().unwrap()) {
        same(&shown["measured_depth"], FOOT, &kept["measured_depth"]);
        same(&shown["extent"][1], FOOT, &kept["extent"][1]);
        assert_eq!(shown["frequency_hz"], kept["frequency_hz"]);
    }
    assert_eq!(field["units"], json!({"measured_depth": "ft", "extent": "ft"}));
    let diagnosis = format!("{path}/points/1/diagnosis");
    let (kept, field) = (
        bench.get(&diagnosis).await.json(),
        bench.get(&format!("{diagnosis}?units=field,largest_equivalent_stress:MPa")).await.json(),
    );
    same(&field["limits"]["largest_bending_stress"], KSI, &kept["limits"]["largest_bending_stress"]);
    same(&field["limits"]["largest_equivalent_stress"], 1e6, &kept["limits"]["largest_equivalent_stress"]);
    assert_eq!(field["units"]["largest_equivalent_stress"], "MPa");
    assert_eq!(field["sentence"], kept["sentence"]);
    for wrong in ["modes?units=metric", "diagnosis?units=measured_depth:psi", "cost?units=state:m"] {
        let problem = bench.get(&format!("{path}/points/1/{wrong}")).await.problem(400, "invalid-parameter");
        assert_eq!(problem["errors"][0]["parameter"], "units", "{problem}");
    }
}

#[tokio::test]
async fn etags_depend_on_units_and_a_copy_of_the_same_units_is_current() {
    let (bench, path) = finished().await;
    for path in [
        format!("{path}/points/1/statics?format=parquet"),
        format!("{path}/points/1/history?format=csv"),
        format!("{path}/points/1/orbit?node=49"),
        format!("{path}/points/1/orbit?node=49&format=svg"),
        format!("{path}/table?format=csv"),
        format!("{path}/table?fields=orbit_radius_rms_49&format=svg"),
    ] {
        // Without units a picture is that of SI, and tables of sweeps have the hash of their contents as tag.
        let choices = [
            "",
            "&units=si",
            "&units=field",
            "&units=field,u:mm,measured_depth:m,orbit_radius_rms:mm,flow_rate:l/s",
        ];
        let mut tags = Vec::new();
        for units in choices.iter().filter(|units| **units != "&units=si" || !path.contains("table?fields")) {
            let answer = bench.get(&format!("{path}{units}")).await;
            assert_eq!(answer.status, 200, "{path}{units}: {}", answer.text());
            tags.push(answer.headers[header::ETAG].clone());
        }
        let count = tags.len();
        tags.sort_by(|a, b| a.as_bytes().cmp(b.as_bytes()));
        tags.dedup();
        assert_eq!(tags.len(), count, "{path}");
    }
    let one = bench.get(&format!("{path}/points/1/orbit?node=49&units=u:mm,v:MM")).await;
    let other = bench.get(&format!("{path}/points/1/orbit?node=49&units=v:mm,u:mm")).await;
    assert_eq!(one.body, other.body);
}

#[tokio::test]
async fn pictures_have_axes_in_the_requested_units() {
    let (bench, path) = finished().await;
    let svg = async |query: &str| bench.get(&format!("{path}/{query}")).await.text().to_owned();
    let map = svg("table?fields=orbit_radius_rms_49&format=svg&units=field").await;
    assert!(map.contains("mud density [ppg]") && map.contains("[in]"), "{map}");
    let own = svg("table?fields=orbit_radius_rms_49&format=svg&units=field,mud_density:g/cm3").await;
    assert!(own.contains("mud density [g/cm3]"), "{own}");
    let orbit = svg("points/1/orbit?node=49&format=svg&units=field").await;
    assert!(orbit.contains("node 49 at 189.40 ft") && orbit.contains("[in]"), "{orbit}");
    let spectrum = svg("points/1/spectrum?node=49&from=2&to=8&format=svg&units=field").await;
    assert!(spectrum.contains("[in]") && !spectrum.contains(" mm"), "{spectrum}");
    let history = svg("points/1/history?node=49&max_points=50&format=svg&units=field").await;
    assert!(history.contains("[in]") && history.contains("ft MD"), "{history}");
}

#[tokio::test]
async fn units_that_do_not_fit_are_refused_with_those_that_do() {
    let (bench, path) = finished().await;
    let refused = async |query: &str| {
        let problem = bench.get(&format!("{path}/{query}")).await.problem(400, "invalid-parameter");
        problem["errors"][0].clone()
    };
    let error = refused("table?units=field,mud_density:gpm").await;
    assert_eq!(error["parameter"], "units");
    assert_eq!(
        error["detail"],
        "must be for mud_density one of the units kg/m3, g/cm3, ppg, lb/ft3; `gpm` is a unit of volume flow rate"
    );
    for query in ["table?units=metric", "window?units=state:m", "points/1/orbit?node=49&units=si,field"] {
        assert_eq!(refused(query).await["parameter"], "units", "{query}");
    }
}

#[tokio::test]
async fn a_unit_of_another_dimension_is_an_invalid_request_anywhere_in_it() {
    let bench = Bench::new().await;
    let preset = bench.get("/v1/scenarios/paper-200m").await.json()["scenario"].clone();
    let mut scenario = preset.clone();
    scenario["mud"]["density"] = json!("12 gpm");
    for (body, pointer) in [
        (json!({"scenario": scenario}), "/scenario/mud/density"),
        (json!({"preset": "paper-200m", "set": {"mud.density": "12 gpm"}}), "/set/mud.density"),
        (json!({"preset": "paper-200m", "set": {"mud": {"density": "12 gpm"}}}), "/set/mud"),
        (
            json!({"preset": "paper-200m", "axes": {"mud_density": {"values": ["12 gpm"]}}}),
            "/axes/mud_density",
        ),
    ] {
        let problem = bench.post("/v1/sweeps?dry_run=true", body).await.problem(422, "invalid-request");
        let error = &problem["errors"][0];
        let detail = error["detail"].as_str().unwrap();
        assert!(error["pointer"].as_str().unwrap().starts_with(pointer), "{problem}");
        assert!(
            detail.contains("kg/m3, g/cm3, ppg, lb/ft3; `gpm` is a unit of volume flow rate"),
            "{problem}"
        );
    }
}

#[tokio::test]
async fn a_full_scenario_has_numbers_with_units() {
    let bench = Bench::new().await;
    let mut scenario = bench.get("/v1/scenarios/paper-200m").await.json()["scenario"].clone();
    scenario["mud"]["density"] = json!("10.5 ppg");
    scenario["well"]["hole_diameter"] = json!("8 1/2 in");
    let by_scenario = bench.submit(json!({"scenario": scenario})).await;
    let set = json!({"mud.density": "10.5 ppg"});
    let by_set = bench.submit(json!({"preset": "paper-200m", "set": set})).await;
    let key = async |id: &str| bench.get(&format!("/v1/sweeps/{id}/points/1")).await.json()["key"].clone();
    assert_eq!(key(&by_scenario).await, key(&by_set).await);
    let table = bench.get(&format!("/v1/sweeps/{by_scenario}/table?units=field")).await.json();
    assert_eq!(numbers(&table, "mud_density"), [10.5]);
}

#[tokio::test]
async fn limits_and_slices_have_units() {
    let (bench, path) = finished().await;
    let window = bench.get(&format!("{path}/window?limits=largest_side_force:5%20klbf")).await.json();
    assert_eq!(window["attributes"]["limits"]["largest_side_force"], 22_241.108_076_302_5);
    let field =
        bench.get(&format!("{path}/window?limits=largest_side_force:5%20klbf&units=field")).await.json();
    assert_eq!(field["attributes"]["limits"]["largest_side_force"], 5.0);
    assert_eq!(field["units"]["largest_side_force"], "klbf");
    let wrong = bench.get(&format!("{path}/window?limits=largest_side_force:5%20ppg")).await;
    let detail = wrong.problem(400, "invalid-parameter")["errors"][0]["detail"].to_string();
    assert!(detail.contains("`ppg` is a unit of density"), "{detail}");
    let slice = format!("{path}/table?fields=orbit_radius_rms_49&format=svg&slice=mud_density:10.5%20ppg");
    assert!(bench.get(&slice).await.text().contains("slice at mud density"));
}

#[tokio::test]
async fn drillers_signs_are_those_of_the_same_points() {
    let (bench, path) = finished().await;
    let weight = "operation.weight_on_bit";
    let request = |sign: f64, signs: &str| json!({"preset": "paper-200m", "signs": signs, "axes": {weight: {"values": [sign * 20e3, sign * 30e3]}}});
    let model = bench.submit(request(-1.0, "model")).await;
    let driller = bench.submit(request(1.0, "driller")).await;
    let keys = async |id: &str| {
        let points = bench.get(&format!("/v1/sweeps/{id}/points")).await.json()["points"].clone();
        points.as_array().unwrap().iter().map(|point| point["key"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(keys(&model).await, keys(&driller).await);
    let append = json!({"signs": "driller", "axes": {weight: {"values": [40e3]}}});
    bench.post(&format!("/v1/sweeps/{driller}/points"), append).await.json();
    let table = bench.get(&format!("/v1/sweeps/{driller}/table?signs=driller&units=si")).await.json();
    assert_eq!(numbers(&table, weight), [20.0, 30.0, 40.0]);
    let kept = bench.get(&format!("/v1/sweeps/{driller}/table")).await.json();
    assert_eq!(numbers(&kept, weight), [-20e3, -30e3, -40e3]);
    let slice =
        format!("{path}/table?fields=orbit_radius_rms_49&format=svg&signs=driller&slice={weight}:50%20kN");
    assert!(bench.get(&slice).await.text().contains("slice at weight on bit 50"));
}
