//! Reading results: tables as stored, and the views cut from the history.

use std::f64::consts::TAU;

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use drillsweep_server::{Config, ExpansionLimits};
use drillsweep_table::{Column, parquet};
use serde_json::{Value, json};

use crate::bench::{Answer, Bench, DURATION, RATE};

/// A sweep of two points, the first with a result, the second diverged.
async fn finished() -> (Bench, String) {
    let bench = Bench::new().await;
    let body = json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}});
    let id = bench.submit(body).await;
    bench.succeed().await;
    bench.diverge().await;
    let path = format!("/v1/sweeps/{id}");
    (bench, path)
}

fn numbers(table: &Value, column: &str) -> Vec<f64> {
    let values =
        table["columns"][column].as_array().unwrap_or_else(|| panic!("no column {column} in {table}"));
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[tokio::test]
async fn a_stored_table_is_served_in_every_format() {
    let (bench, path) = finished().await;
    let json = bench.get(&format!("{path}/points/1/profile")).await;
    assert_eq!(json.headers[header::CONTENT_TYPE], "application/json");
    assert_eq!(
        json.json(),
        json!({
            "columns": {"element": [1, 2], "friction_coefficient": [0.0192, null], "regime": ["laminar", "turbulent"]},
            "units": {"friction_coefficient": "1"}
        })
    );
    let request = Request::get(format!("{path}/points/1/profile")).header(header::ACCEPT, "text/csv");
    let csv = bench.send(request.body(Body::empty()).unwrap()).await;
    assert_eq!(csv.headers[header::CONTENT_TYPE], "text/csv");
    assert_eq!(csv.text(), "element,friction_coefficient,regime\n1,0.0192,laminar\n2,,turbulent\n");
    let whole = bench.get(&format!("{path}/points/1/profile?format=parquet")).await;
    assert_eq!(whole.headers[header::CONTENT_TYPE], "application/vnd.apache.parquet");
    let table = parquet::read(whole.body, None, None).unwrap();
    assert_eq!(table.columns["element"], Column::Integer(vec![Some(1), Some(2)]));
}

#[tokio::test]
async fn the_table_of_a_sweep_has_a_row_for_every_point() {
    let (bench, path) = finished().await;
    let failed = bench.get(&format!("{path}/points/2")).await.json();
    let depth = failed["error_place"]["measured_depth"].as_f64().expect("the place of its node");
    assert!((depth - 57.7).abs() < 0.1, "{failed}");
    let table = bench.get(&format!("{path}/table")).await.json();
    assert_eq!(
        table["columns"],
        json!({
            "ordinal": [1, 2],
            "state": ["succeeded", "failed"],
            "class": ["not_judged", "failed"],
            "mud_density": [1200.0, 1500.0],
            "flow_rate": [0.01, 0.01],
            "steps": [10_000, null],
            "density_seen": [1200.0, null],
            "residual": [1e-9, null],
            "resolved_hz": [200.0, null],
            "orbit_radius_rms_49": [1e-3, null],
            "error": [null, "the state is not finite"],
            "error_time": [null, 1.25],
            "error_node": [null, 49],
        })
    );
    let csv = bench.get(&format!("{path}/table?format=csv")).await;
    let header = "ordinal,state,class,mud_density,flow_rate,steps,density_seen,residual,resolved_hz,orbit_radius_rms_49,error,error_time,error_node";
    assert_eq!(
        csv.text(),
        format!(
            "{header}\n1,succeeded,not_judged,1200.0,0.01,10000,1200.0,1e-9,200.0,0.001,,,\n2,failed,failed,1500.0,0.01,,,,,,the state is not finite,1.25,49\n"
        )
    );
    let whole = bench.get(&format!("{path}/table?format=parquet")).await;
    let table = parquet::read(whole.body, None, None).unwrap();
    assert_eq!(table.columns["mud_density"], Column::Number(vec![1200.0, 1500.0]));
    assert_eq!(table.units["mud_density"], "kg/m3");
}

#[tokio::test]
async fn an_orbit_is_cut_from_the_history() {
    let (bench, path) = finished().await;
    let orbit = bench.get(&format!("{path}/points/1/orbit?node=49&from=2&to=3")).await.json();
    assert_eq!(orbit["attributes"], json!({"samples": 1000, "node": 49, "measured_depth": 57.73}));
    assert_eq!(orbit["units"], json!({"time": "s", "u": "m", "v": "m", "radius": "m"}));
    let (time, u, v, radius) =
        (numbers(&orbit, "time"), numbers(&orbit, "u"), numbers(&orbit, "v"), numbers(&orbit, "radius"));
    assert_eq!(time.len(), 1000);
    assert_eq!((time[0], time[999]), (2.0, 2.999));
    for (i, t) in time.iter().enumerate() {
        assert_eq!(u[i], 0.004 + 0.03 * (2.0 * TAU * t).cos() + 0.01 * (3.0 * TAU * t).cos());
        assert_eq!(radius[i], u[i].hypot(v[i]));
    }
    let thinned = bench
        .get(&format!("{path}/points/1/orbit?depth=55&nearest=true&from=2&to=3&max_points=100"))
        .await
        .json();
    assert_eq!(thinned["attributes"]["node"], 49);
    let thin_u = numbers(&thinned, "u");
    assert!(thin_u.len() <= 100 && thin_u.len() > 50, "{}", thin_u.len());
    let largest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(largest(&thin_u), largest(&u));
    let csv = bench.get(&format!("{path}/points/1/orbit?depth=0&nearest=true&to=0.002&format=csv")).await;
    assert_eq!(csv.text(), "time,u,v,radius\n0.0,0.01,0.0,0.01\n0.001,0.01,0.0,0.01\n");
}

#[tokio::test]
async fn a_spectrum_finds_the_lines_of_a_known_orbit() {
    let (bench, path) = finished().await;
    // 6 s hold whole periods of both lines, so that what is left beside them is rounding.
    let query = "node=49&from=2&to=8&range_hz=5&peaks=3";
    let spectrum = bench.get(&format!("{path}/points/1/spectrum?{query}")).await.json();
    let frequency = numbers(&spectrum, "frequency");
    let amplitude = numbers(&spectrum, "amplitude");
    let peak_to_peak = numbers(&spectrum, "peak_to_peak");
    assert_eq!(frequency.len(), 61, "every 1/6 Hz from -5 to 5 Hz");
    assert!((spectrum["attributes"]["resolution"].as_f64().unwrap() - 1.0 / 6.0).abs() < 1e-9);
    for (i, f) in frequency.iter().enumerate() {
        let expected = match (f * 6.0).round() {
            12.0 => 0.03,
            -18.0 => 0.01,
            0.0 => 0.005,
            _ => 0.0,
        };
        assert!((amplitude[i] - expected).abs() < 1e-12, "{f} Hz: {}", amplitude[i]);
        assert_eq!(peak_to_peak[i], 2.0 * amplitude[i]);
    }
    let peaks = spectrum["attributes"]["peaks"].as_array().unwrap();
    let found: Vec<_> = peaks
        .iter()
        .map(|peak| (peak["whirl"].as_str().unwrap(), peak["frequency"].as_f64().unwrap().round()))
        .collect();
    assert_eq!(found, [("forward", 2.0), ("backward", -3.0), ("offset", 0.0)]);

    assert_eq!(spectrum["attributes"]["resolved_hz"], 200.0);
    assert!(peaks.iter().all(|peak| peak["is_resolved"] == true), "{peaks:?}");
    let wide = format!("{path}/points/1/spectrum?node=49&from=2&to=8&range_hz=400&peaks=1&format=svg");
    let shaded = "not resolved by the step (±200 Hz)";
    assert!(bench.get(&wide).await.text().contains(shaded));
    assert!(!bench.get(&wide.replace("400", "100")).await.text().contains(shaded));

    let hann = bench.get(&format!("{path}/points/1/spectrum?{query}&window=hann")).await.json();
    assert_eq!(hann["attributes"]["window"], "hann");
    // The Hann window spreads a line on a bin over its neighbours, half as high.
    let of =
        |f: f64| numbers(&hann, "amplitude")[frequency.iter().position(|g| (g - f).abs() < 1e-6).unwrap()];
    assert!((of(2.0) - 0.03).abs() < 1e-12);
    assert!((of(2.0 + 1.0 / 6.0) - 0.015).abs() < 1e-12);
}

#[tokio::test]
async fn a_history_is_served_whole_or_of_one_node() {
    let (bench, path) = finished().await;
    let whole = bench.get(&format!("{path}/points/1/history?max_points=1000")).await.json();
    assert_eq!(whole["attributes"]["samples"], RATE * DURATION);
    assert_eq!(numbers(&whole, "time").len(), 1000);
    let columns: Vec<_> = whole["columns"].as_object().unwrap().keys().cloned().collect();
    assert_eq!(columns, ["time", "u_10", "v_10", "u_49", "v_49"]);
    let whole = bench.get(&format!("{path}/points/1/history?format=parquet")).await;
    assert_eq!(parquet::read(whole.body, None, None).unwrap().rows(), 10_000);
    let of_node = bench.get(&format!("{path}/points/1/history?node=10&from=1&to=1.003")).await.json();
    assert_eq!(
        of_node["columns"],
        json!({"time": [1.0, 1.001, 1.002], "u_10": [0.01, 0.01, 0.01], "v_10": [0.0, 0.0, 0.0]})
    );
}

#[tokio::test]
async fn a_node_that_was_not_recorded_is_answered_with_those_that_were() {
    let (bench, path) = finished().await;
    let problem =
        bench.get(&format!("{path}/points/1/orbit?node=50")).await.problem(404, "node-not-recorded");
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("10 (11.72 m), 49 (57.73 m)"), "{detail}");
    bench.get(&format!("{path}/points/1/spectrum?node=50")).await.problem(404, "node-not-recorded");
}

#[tokio::test]
async fn a_point_without_a_result_reports_its_state() {
    let (bench, path) = finished().await;
    let problem = bench.get(&format!("{path}/points/2/orbit?node=49")).await.problem(409, "no-result");
    assert_eq!(problem["state"], "failed");
    let id = bench.submit(json!({"preset": "paper-200m", "set": {"mud.flow_rate": 0.02}})).await;
    let problem = bench.get(&format!("/v1/sweeps/{id}/points/1/profile")).await.problem(409, "no-result");
    assert_eq!(problem["state"], "queued");
    bench.get(&format!("{path}/points/3/profile")).await.problem(404, "not-found");
    bench.get("/v1/sweeps/none/points/1/profile").await.problem(404, "not-found");
    bench.get(&format!("{path}/points/1/energy")).await.problem(404, "no-such-table");
}

#[tokio::test]
async fn a_point_shows_its_summary_and_provenance() {
    let (bench, path) = finished().await;
    let answer = bench.get(&format!("{path}/points/1")).await;
    assert_eq!(answer.status, StatusCode::OK);
    let point = answer.json();
    assert_eq!(
        point["summary"],
        json!({"steps": 10_000, "density_seen": 1200.0, "residual": 1e-9, "resolved_hz": 200.0,
            "orbit_radius_rms_49": 1e-3})
    );
    assert_eq!(point["provenance"], json!({"version": "bench"}));
    assert_eq!(point["tables"], json!(["history", "profile", "statics"]));
    assert_eq!(point["progress"], 1.0);
    assert_eq!(point["links"]["self"], format!("{path}/points/1"));
}

#[tokio::test]
async fn a_current_copy_of_the_client_is_not_sent_again() {
    let mut bench = Bench::new().await;
    let body = json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}});
    let path = format!("/v1/sweeps/{}", bench.submit(body).await);
    bench.succeed().await;
    let table = format!("{path}/table");
    let orbit = format!("{path}/points/1/orbit?node=49&from=1&to=2");
    // What takes reading and computing, and depends on the point's result or scenario alone.
    let views = [
        orbit.clone(),
        format!("{path}/points/1/orbit?node=49&from=1&to=2&max_points=100"),
        format!("{path}/points/1/profile"),
        format!("{path}/points/1/history?node=49&from=1&to=2&format=svg"),
        format!("{path}/points/1/history?node=49&max_points=100&decimation=minmax"),
        format!("{path}/points/1/history?node=49&max_points=100"),
        format!("{path}/points/1/spectrum?node=49&from=1&to=2&format=svg"),
        format!("{path}/points/1/spectrum?node=49&from=1&to=2&window=hann"),
        format!("{path}/points/1/statistics?node=49&from=1&to=2"),
        format!("{path}/points/1/statics?fields=node"),
    ];
    let others =
        [format!("{path}/points/1/statics?format=parquet"), format!("{table}?format=csv"), table.clone()];
    let mut tags = std::collections::HashMap::new();
    for path in views.iter().chain(&others) {
        let first = bench.get(path).await;
        assert_eq!(first.status, StatusCode::OK, "{path}: {}", first.text());
        let tag = first.headers[header::ETAG].to_str().unwrap().to_owned();
        let unchanged = again(&bench, path, &format!("\"other\", {tag}")).await;
        assert_eq!((unchanged.status, unchanged.body.len()), (StatusCode::NOT_MODIFIED, 0), "{path}");
        assert_eq!(unchanged.headers[header::ETAG], tag);
        let other = again(&bench, path, "\"other\"").await;
        assert_eq!((other.status, &other.body), (StatusCode::OK, &first.body), "{path}");
        tags.insert(tag, path);
    }
    assert_eq!(tags.len(), views.len() + others.len(), "every body has a tag of its own: {tags:?}");
    // The table changes with the sweep, the orbit does not.
    let tag_of = async |path: &str| bench.get(path).await.headers[header::ETAG].to_str().unwrap().to_owned();
    let (table_tag, orbit_tag) = (tag_of(&table).await, tag_of(&orbit).await);
    bench.succeed().await;
    assert_eq!(again(&bench, &table, &table_tag).await.status, StatusCode::OK);
    assert_eq!(again(&bench, &orbit, &orbit_tag).await.status, StatusCode::NOT_MODIFIED);

    // Any copy is none of what there is not.
    let nowhere = format!("{path}/points/1/orbit?node=4900");
    again(&bench, &nowhere, "*").await.problem(404, "node-not-recorded");
    assert_eq!(again(&bench, &orbit, "*").await.status, StatusCode::NOT_MODIFIED);

    // Nothing is read or computed for it: it needs no place where there is none.
    bench.reconfigure(Config {
        large_answers: 0,
        large_answer_bytes: 0,
        large_answers_waiting: 0,
        ..Config::default()
    });
    for (tag, path) in tags.iter().filter(|(_, path)| views.contains(path)) {
        assert_eq!(again(&bench, path, tag).await.status, StatusCode::NOT_MODIFIED, "{path}");
        again(&bench, path, "\"other\"").await.problem(503, "unavailable");
    }
}

async fn again(bench: &Bench, path: &str, tag: &str) -> Answer {
    bench.send(Request::get(path).header(header::IF_NONE_MATCH, tag).body(Body::empty()).unwrap()).await
}

#[tokio::test]
async fn a_point_whose_modes_and_plan_are_known_is_not_computed_again() {
    let bench = Bench::new().await;
    let body = json!({"preset": "paper-200m", "axes": {"mud_density": {"values": [1200, 1500]}}});
    let path = format!("/v1/sweeps/{}", bench.submit(body).await);
    let mut tags = std::collections::HashSet::new();
    for view in [
        "1/modes?to_hz=2",
        "1/modes?to_hz=1",
        "2/modes?to_hz=2",
        "1/plan",
        "2/plan",
        "1/torque_drag",
        "1/torque_drag?friction=0.2",
        "1/hydraulics",
    ] {
        let path = format!("{path}/points/{view}");
        let first = bench.get(&path).await;
        let tag = first.headers[header::ETAG].to_str().unwrap().to_owned();
        let unchanged = again(&bench, &path, &tag).await;
        assert_eq!((unchanged.status, unchanged.body.len()), (StatusCode::NOT_MODIFIED, 0), "{view}");
        assert_eq!(unchanged.headers[header::ETAG], tag);
        assert!(unchanged.headers[header::CACHE_CONTROL].to_str().unwrap().contains("no-cache"));
        tags.insert(tag);
    }
    assert_eq!(tags.len(), 8, "every answer has a tag of its own");
}

#[tokio::test]
async fn large_answers_beyond_their_places_are_refused_and_light_ones_are_not() {
    let (mut bench, path) = finished().await;
    bench.reconfigure(Config {
        large_answers: 0,
        large_answer_bytes: 0,
        large_answers_waiting: 0,
        expansions: ExpansionLimits { waiting: 0, ..Config::default().expansions },
        ..Config::default()
    });
    for view in ["points/1/history?format=csv", "points/1/orbit?node=49", "points/1/profile", "table"] {
        let answer = bench.get(&format!("{path}/{view}")).await;
        answer.problem(503, "unavailable");
        assert!(answer.headers.contains_key("retry-after"), "{view}");
    }
    let dry_run = bench.post("/v1/sweeps?dry_run=true", json!({"preset": "paper-200m"})).await;
    dry_run.problem(503, "unavailable");
    for light in ["/v1/sweeps", path.as_str(), "/v1/queue"] {
        assert_eq!(bench.get(light).await.status, StatusCode::OK, "{light}");
    }
}

#[tokio::test]
async fn a_history_thinned_to_its_extremes_has_the_peaks_of_the_whole() {
    let (bench, path) = finished().await;
    let history = format!("{path}/points/1/history?node=49&fields=time,u_49,v_49");
    let whole = bench.get(&history).await.json();
    let thinned = bench.get(&format!("{history}&max_points=90&decimation=minmax")).await.json();
    assert_eq!(thinned["attributes"], whole["attributes"]);
    assert_eq!(thinned["units"], whole["units"]);
    let times = numbers(&thinned, "time");
    assert!(times.len() <= 90 && times.len() > 60, "{}", times.len());
    let extremes = |values: &[f64]| {
        let fold = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick).unwrap();
        (fold(f64::min), fold(f64::max))
    };
    for column in ["u_49", "v_49"] {
        let (kept, all) = (numbers(&thinned, column), numbers(&whole, column));
        assert_eq!(extremes(&kept), extremes(&all), "{column}");
        // What stays are samples, each at its own time.
        for (value, time) in kept.iter().zip(&times) {
            assert_eq!(*value, all[(time * RATE).round() as usize]);
        }
    }
    // Where all fits, all stays; a picture is drawn from what stays.
    let all = bench.get(&format!("{history}&max_points=10000&decimation=minmax")).await.json();
    assert_eq!(all["columns"], whole["columns"]);
    let drawn = format!("{path}/points/1/history?node=49&max_points=90&decimation=minmax&format=svg");
    let picture = bench.get(&drawn).await;
    assert_eq!(picture.headers[header::CONTENT_TYPE], "image/svg+xml");
    let problem = bench.get(&format!("{history}&max_points=3&decimation=minmax")).await;
    assert!(problem.problem(400, "invalid-parameter")["detail"].as_str().unwrap().contains("4 or more"));
}

#[tokio::test]
async fn statistics_of_a_window_are_those_of_a_known_orbit() {
    let (bench, path) = finished().await;
    // Whole periods of both circles, of 30 and 10 mm, about (4, 3) mm.
    let table = bench.get(&format!("{path}/points/1/statistics?from=2&to=8")).await.json();
    assert_eq!(table["attributes"], json!({"samples": 6000}));
    assert_eq!(table["columns"]["node"], json!([10, 49]));
    assert_eq!(table["columns"]["measured_depth"], json!([11.72, 57.73]));
    let close = |column: &str, expected: [f64; 2]| {
        for (value, expected) in numbers(&table, column).iter().zip(expected) {
            assert!((value - expected).abs() < 1e-9, "{column}: {value}, not {expected}");
        }
    };
    close("orbit_radius_rms", [0.0, (0.03_f64.powi(2) + 0.01_f64.powi(2)).sqrt()]);
    close("orbit_offset", [0.01, 0.005]);
    let [_, mean] = numbers(&table, "orbit_mean_radius")[..] else { panic!("two nodes") };
    let mean_square = 0.03_f64.powi(2) + 0.01_f64.powi(2) + 0.005_f64.powi(2);
    close("orbit_radius_deviation", [0.0, (mean_square - mean * mean).sqrt()]);

    let one =
        bench.get(&format!("{path}/points/1/statistics?depth=60&nearest=true&from=2&to=8")).await.json();
    assert_eq!(one["columns"]["orbit_mean_radius"], json!([mean]));
    let csv = bench.get(&format!("{path}/points/1/statistics?node=49&fields=node&format=csv")).await;
    assert_eq!(csv.text(), "node\n49\n");
    for (query, parameter) in [("from=20", "from"), ("from=3&to=2", "to"), ("node=3", "node")] {
        let answer = bench.get(&format!("{path}/points/1/statistics?{query}")).await;
        assert_eq!(answer.json()["errors"][0]["parameter"], parameter, "{query}");
    }
}

#[tokio::test]
async fn windows_outside_of_the_history_are_refused_and_those_that_stick_out_are_cut() {
    let (bench, path) = finished().await;
    // The history has 10,000 samples from 0 s, 1 ms apart.
    for view in ["orbit", "spectrum", "spectrogram", "statistics", "history"] {
        let view = format!("{path}/points/1/{view}?node=49");
        for (window, parameter) in
            [("from=20&to=30", "from"), ("from=10", "from"), ("from=-3&to=2", "from"), ("to=0", "to")]
        {
            let problem = bench.get(&format!("{view}&{window}")).await.problem(400, "invalid-parameter");
            let error = &problem["errors"][0];
            assert_eq!(error["parameter"], parameter, "{view} {window}: {problem}");
            let detail = error["detail"].as_str().unwrap();
            assert!(detail.contains("begins at 0 s and ends at 9.999 s"), "{view} {window}: {detail}");
        }
        let between = bench.get(&format!("{view}&from=3.0001&to=3.0002")).await;
        between.problem(400, "invalid-parameter");
        let cut = bench.get(&format!("{view}&from=2&to=30")).await.json();
        assert_eq!(cut["attributes"]["window_cut_at"], 9.999, "{view}");
        let whole = bench.get(&format!("{view}&from=2&to=10")).await.json();
        assert_eq!(whole["attributes"].get("window_cut_at"), None, "{view}");
        assert_eq!(whole["columns"], cut["columns"], "{view}");
    }
    for view in ["orbit", "spectrum", "history"] {
        let picture = bench.get(&format!("{path}/points/1/{view}?node=49&from=2&to=30&format=svg")).await;
        assert!(picture.text().contains("to the end of the history at 9.999 s"), "{view}");
    }
}

#[tokio::test]
async fn the_columns_of_a_table_are_listed_without_their_values() {
    let (bench, path) = finished().await;
    let table = bench.get(&format!("{path}/table")).await.json();
    let listed = bench.get(&format!("{path}/table/columns")).await.json();
    let listed = listed["columns"].as_array().unwrap();
    let names: Vec<&str> = listed.iter().map(|column| column["name"].as_str().unwrap()).collect();
    let expected: Vec<&String> = table["columns"].as_object().unwrap().keys().collect();
    assert_eq!(names, expected);
    for column in listed {
        let name = column["name"].as_str().unwrap();
        assert_eq!(column["unit"], table["units"][name], "{name}");
        let is_text = table["columns"][name].as_array().unwrap().iter().any(Value::is_string);
        assert_eq!(column["kind"] == "text", is_text, "{name}");
    }
    assert_eq!(listed[0], json!({"name": "ordinal", "kind": "integer"}));
    bench.get("/v1/sweeps/none/table/columns").await.problem(404, "not-found");

    // They are those of the points as they are now, however often they were asked for before.
    let axes = json!({"flow_rate": {"values": [0.011, 0.012]}});
    let id = bench.submit(json!({"preset": "paper-200m", "axes": axes})).await;
    let path = format!("/v1/sweeps/{id}/table");
    let names = async || {
        let listed = bench.get(&format!("{path}/columns")).await.json();
        let names = listed["columns"].as_array().unwrap().iter();
        names.map(|column| column["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names().await, names().await);
    assert!(!names().await.contains(&"residual".to_owned()));
    bench.succeed().await;
    assert!(names().await.contains(&"residual".to_owned()));
}

#[tokio::test]
async fn the_plan_of_a_point_is_that_of_its_scenario() {
    let (bench, path) = finished().await;
    let plan = bench.get(&format!("{path}/points/2/plan")).await.json();
    let run = json!({"preset": "paper-200m", "set": {"mud.density": 1500}});
    let planned = bench.post("/v1/runs?dry_run=true", run).await.json();
    assert_eq!(plan, planned["plan"]);
    assert!(plan["effects"].as_array().unwrap().iter().all(|effect| effect["reason"].is_string()));
    bench.get(&format!("{path}/points/3/plan")).await.problem(404, "not-found");
}

#[tokio::test]
async fn torque_and_drag_of_a_point_is_a_table_or_a_broomstick() {
    let bench = Bench::new().await;
    // Before any worker has simulated it.
    let path =
        format!("/v1/sweeps/{}/points/1/torque_drag", bench.submit(json!({"preset": "paper-200m"})).await);
    let found =
        bench.get(&format!("{path}?modes=pick_up,rotate&depths=100:200:3&friction=0.2,0.3")).await.json();
    let columns = &found["columns"];
    assert_eq!(columns["bit_depth"].as_array().unwrap().len(), 12);
    assert_eq!((&columns["drag_mode"][11], &columns["friction_factor"][11]), (&json!("rotate"), &json!(0.3)));
    let hook_load = |row: usize| columns["hook_load"][row].as_f64().unwrap();
    // Friction holds a string that is pulled up, and leaves the hook load of one that turns.
    assert!(hook_load(6) < hook_load(0) && hook_load(0) < hook_load(3), "{found}");
    assert_eq!(hook_load(6), hook_load(9));
    let picture = bench
        .get(&format!("{path}?format=svg&field=surface_torque&modes=rotate,drill&axial_speed=0.1"))
        .await;
    assert!(String::from_utf8_lossy(&picture.body).contains("surface torque"));
    for wrong in [
        "modes=up",
        "modes=ream",
        "depths=201",
        "depths=1:2",
        "depths=1:200:100000",
        "friction=-0.1",
        "depths=1:200:1000&friction=0.1:0.5:50",
        "format=svg&field=nothing",
        "travelling_weight=x",
    ] {
        bench.get(&format!("{path}?{wrong}")).await.problem(400, "invalid-parameter");
    }
}

#[tokio::test]
async fn friction_of_a_point_is_fitted_to_measurements() {
    let bench = Bench::new().await;
    let path = format!("/v1/sweeps/{}/points/1", bench.submit(json!({"preset": "paper-200m"})).await);
    let torque = |found: &Value| found["columns"]["surface_torque"][0].as_f64().unwrap();
    let found = bench.get(&format!("{path}/torque_drag?modes=rotate&depths=180&friction=0.22")).await.json();
    let point = json!({"bit_depth": 180, "mode": "rotate", "torque": torque(&found)});
    let fit = bench.post(&format!("{path}/friction"), json!({"points": [point]})).await.json();
    assert!((fit["friction"][0]["friction"].as_f64().unwrap() - 0.22).abs() < 1e-6, "{fit}");
    for (body, status, slug) in [
        (json!({"points": []}), 422, "invalid-request"),
        (json!({"points": [point], "hook_load_deviation": 0}), 422, "invalid-request"),
        (json!({"points": [{"bit_depth": 300, "mode": "rotate", "torque": 1}]}), 422, "invalid-request"),
        (json!({"points": [{"bit_depth": 100, "mode": "fly", "torque": 1}]}), 400, "malformed-body"),
    ] {
        bench.post(&format!("{path}/friction"), body).await.problem(status, slug);
    }
}

#[tokio::test]
async fn forced_response_of_a_point_is_a_table_or_a_picture() {
    let bench = Bench::new().await;
    let path = format!("/v1/sweeps/{}/points/1", bench.submit(json!({"preset": "paper-200m"})).await);
    let path = format!("{path}/forced_response");
    // Speeds are sorted, so that a picture has a line a component.
    let found = bench.get(&format!("{path}?speeds=180:60:3")).await.json();
    let speeds = found["columns"]["rotation_speed_rpm"].as_array().unwrap();
    assert_eq!(speeds[..3], [json!(60.0), json!(120.0), json!(180.0)]);
    let picture = bench.get(&format!("{path}?speeds=60,120&format=svg&field=forced_bending_stress")).await;
    assert!(String::from_utf8_lossy(&picture.body).contains("forced bending stress"));
    for wrong in [
        "speeds=0,60",
        "speeds=40:240:501",
        "depth=201&speeds=60",
        "force=10",
        "depth=100&force=-1",
        "speeds=60&format=svg&field=nothing",
    ] {
        bench.get(&format!("{path}?{wrong}")).await.problem(400, "invalid-parameter");
    }
}

#[tokio::test]
async fn the_circuit_of_a_point_adds_up_by_every_set_of_formulas() {
    let (bench, path) = finished().await;
    let circuit = bench.get(&format!("{path}/points/1/hydraulics")).await.json();
    let column = |losses: &str, rotates: bool| {
        let columns = circuit["columns"].as_array().unwrap().iter();
        let mut named = columns.filter(|column| column["losses"] == losses && column["rotates"] == rotates);
        let found = named.next().unwrap_or_else(|| panic!("no column of {losses}: {circuit}"));
        let of = |name: &str| found[name].as_f64().unwrap();
        let losses = ["surface_loss", "bore_loss", "tool_loss", "bit_loss", "annulus_loss"];
        let sum: f64 = losses.map(of).iter().sum();
        assert!((of("standpipe_pressure") / sum - 1.0).abs() < 1e-12, "{found}");
        of("annulus_loss")
    };
    // A string next to the wall leaves more room on its other side.
    let [eccentric, concentric] = ["eccentric", "concentric"].map(|losses| column(losses, false));
    assert!(0.0 < eccentric && eccentric < concentric, "{eccentric} and {concentric} Pa");
    assert!(column("rp13d", false) > 0.0);
    let mut dry = json!({"preset": "paper-200m", "set": {"mud": null}, "axes": {"operation.weight_on_bit": {"values": [-1e5]}}});
    dry["set"]["duration"] = json!(1.0);
    let dry = format!("/v1/sweeps/{}/points/1/hydraulics", bench.submit(dry).await);
    let problem = bench.get(&dry).await.problem(409, "no-result");
    assert!(problem["detail"].as_str().unwrap().contains("mud"), "{problem}");
}

#[tokio::test]
async fn the_modes_of_a_point_fill_the_requested_band() {
    let (bench, path) = finished().await;
    let of_band = async |to: f64| {
        let found = bench.get(&format!("{path}/points/1/modes?to_hz={to}")).await.json();
        assert_eq!(found["completeness"], "counted", "{found}");
        let modes = found["modes"].as_array().unwrap();
        modes.iter().map(|mode| mode["frequency_hz"].as_f64().unwrap()).collect::<Vec<f64>>()
    };
    let (narrow, wide) = (of_band(3.0).await, of_band(5.0).await);
    assert!(wide.is_sorted() && wide.iter().all(|frequency| *frequency <= 5.0), "{wide:?}");
    // What is found of a band does not depend on how far beyond it was searched.
    let within: Vec<f64> = wide.iter().copied().filter(|frequency| *frequency <= 3.0).collect();
    assert_eq!(narrow.len(), within.len());
    assert!(!narrow.is_empty() && within.len() < wide.len());
    for (narrow, wide) in narrow.iter().zip(within) {
        assert!((narrow - wide).abs() < 1e-6);
    }
    for wrong in ["0", "-1", "51", "x"] {
        bench.get(&format!("{path}/points/1/modes?to_hz={wrong}")).await.problem(400, "invalid-parameter");
    }
}
