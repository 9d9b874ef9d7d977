//! Judgement of computed points: classes by limits, causes of lines, and the operating window of a sweep.

use serde_json::{Value, json};

use crate::{completed, get, listen, post, wait};

/// Address of the only point of a preset with changes.
fn point(server: &str, preset: &str, changes: &Value) -> String {
    let request = json!({ "preset": preset, "set": changes });
    let id = post(&format!("{server}/v1/runs"), &request)["id"].as_str().unwrap().to_owned();
    assert_eq!(wait(server, &id, completed)["counts"]["succeeded"], 1, "{preset}");
    format!("{server}/v1/sweeps/{id}/points/1")
}

/// Kinds of the causes of a diagnosis' lines whose frequency is near one \[Hz\], either way.
fn kinds_near(diagnosis: &Value, frequency_hz: f64) -> Vec<(String, i64)> {
    let lines = diagnosis["lines"].as_array().unwrap();
    let near = lines.iter().filter(|line| {
        let distance = (line["frequency_hz"].as_f64().unwrap().abs() - frequency_hz).abs();
        // Of the window of the statistics; an earlier one has another motion.
        distance < 0.05 && line["window"][0].as_f64().unwrap() >= 40.0
    });
    near.map(|line| {
        let cause = &line["cause"];
        let multiple = cause["torsion_multiple"].as_i64().unwrap_or_default().abs();
        (cause["kind"].as_str().unwrap_or("none").to_owned(), multiple)
    })
    .collect()
}

#[test]
fn base_case_sticks_and_slips_and_its_lines_are_the_torsion_and_its_multiples() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "1"]);
    let point = point(&server, "paper-200m", &json!({ "accuracy": "draft" }));
    let diagnosis = get(&format!("{point}/diagnosis"));
    assert_eq!(diagnosis["class"], "stick_slip");
    let evidence = &diagnosis["findings"][0]["evidence"];
    // -4 to 257 rpm at 120 rpm, seen in the recorded speed of the bit by an earlier reader.
    let rpm = |column: &str| evidence[column].as_f64().unwrap() * 30.0 / std::f64::consts::PI;
    assert!((rpm("bit_speed_min") + 4.0).abs() < 2.0, "{evidence}");
    assert!((rpm("bit_speed_max") - 257.0).abs() < 5.0, "{evidence}");
    for (frequency, multiple) in [(2.16, 1), (4.315, 2), (6.477, 3)] {
        let kinds = kinds_near(&diagnosis, frequency);
        let torsion = ("torsion".to_owned(), multiple);
        assert!(!kinds.is_empty() && kinds.iter().all(|kind| *kind == torsion), "{frequency} Hz: {kinds:?}");
    }
    // The peaks of the recorded speed of the bit are those of all steps, or less.
    let history = get(&format!("{point}/history?from=40&to=60"));
    let columns = history["columns"].as_object().unwrap();
    let bit = columns
        .keys()
        .filter(|name| name.starts_with("rotation_speed_"))
        .max_by_key(|name| name.len())
        .unwrap();
    let largest =
        columns[bit].as_array().unwrap().iter().map(|speed| speed.as_f64().unwrap()).fold(0.0, f64::max);
    let of_steps = evidence["bit_speed_max"].as_f64().unwrap();
    assert!(largest <= of_steps * (1.0 + 1e-6) && largest > 0.99 * of_steps, "{largest} {of_steps}");

    let summary = &get(&point)["summary"];
    let side_force = summary["largest_side_force"].as_f64().unwrap();
    let off = "bit_stick_slip_severity:off";
    let limited = |limit: f64| get(&format!("{point}/diagnosis?limits={off},largest_side_force:{limit}"));
    assert_eq!(limited(0.9 * side_force)["class"], "over_limit");
    assert_ne!(limited(1.1 * side_force)["class"], "over_limit");
}

#[test]
fn whirl_stick_slip_impacts_and_rest_have_their_classes() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "2"]);
    let classes = |point: &str| -> Vec<String> {
        let diagnosis = get(&format!("{point}/diagnosis"));
        let findings = diagnosis["findings"].as_array().unwrap();
        findings.iter().map(|finding| finding["class"].as_str().unwrap().to_owned()).collect()
    };
    let whirl = point(&server, "hard/dry-friction-whirl", &json!({}));
    assert_eq!(classes(&whirl)[0], "backward_whirl");
    let summary = &get(&whirl)["summary"];
    assert!(summary["backward_whirl_fraction"].as_f64().unwrap() > 0.5, "{summary}");
    assert!(summary["fastest_whirl_speed"].as_f64().unwrap() < 0.0, "{summary}");

    let stick_slip = point(&server, "hard/stick-slip", &json!({}));
    assert_eq!(classes(&stick_slip)[0], "stick_slip");

    // Without mud and with friction along the wall, the string is thrown from wall to wall.
    let dry = json!({ "accuracy": "draft", "duration": 20, "recording.orbit_window": { "from": 10, "to": 20 }, "recording.spectrum_windows": [] });
    assert!(classes(&point(&server, "paper-200m-dry", &dry)).contains(&"impacts".to_owned()));

    // Without the friction torque nothing excites torsion, and the unbalance hardly moves the string.
    let quiet = json!({
        "accuracy": "draft", "effects.friction_torque": "off", "duration": 20, "recording.orbit_window": { "from": 10, "to": 20 },
        "recording.spectrum_windows": [],
    });
    assert_eq!(classes(&point(&server, "paper-200m", &quiet)), ["quiet"]);
}

#[test]
fn operating_window_follows_its_limits_without_new_runs() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &["up", "--workers", "2"]);
    let request = json!({
        "preset": "paper-200m",
        "set": { "accuracy": "draft", "duration": 0.4, "recording.orbit_window": { "from": 0.2, "to": 0.4 }, "recording.spectrum_windows": [] },
        "axes": { "mud.density": { "values": [1200, 1500, 1800] } },
    });
    let id = post(&format!("{server}/v1/sweeps"), &request)["id"].as_str().unwrap().to_owned();
    wait(&server, &id, completed);
    let sweep = format!("{server}/v1/sweeps/{id}");
    let window = |limits: &str| get(&format!("{sweep}/window?limits={limits}"));
    let forces =
        get(&format!("{sweep}/table?fields=largest_side_force"))["columns"]["largest_side_force"].clone();
    let forces: Vec<f64> = forces.as_array().unwrap().iter().map(|force| force.as_f64().unwrap()).collect();
    let off = "bit_stick_slip_severity:off,largest_shock_rate_10g:off,largest_lateral_acceleration_rms:off,backward_whirl_fraction:off";
    let middle = {
        let mut sorted = forces.clone();
        sorted.sort_by(f64::total_cmp);
        0.5 * (sorted[0] + sorted[1])
    };
    let limited = window(&format!("{off},largest_side_force:{middle}"));
    let over: Vec<bool> = forces.iter().map(|force| *force > middle).collect();
    let classes = limited["columns"]["class"].as_array().unwrap();
    assert_eq!(classes.iter().map(|class| class == "over_limit").collect::<Vec<_>>(), over, "{limited}");
    assert_eq!(limited["attributes"]["points_by_class"]["over_limit"], 2, "{limited}");
    assert_eq!(limited["attributes"]["limits"]["largest_side_force"], middle);
    assert_eq!(limited["columns"]["mud.density"], json!([1200.0, 1500.0, 1800.0]));
    let table = get(&format!("{sweep}/table?fields=class&limits={off},largest_side_force:{middle}"));
    assert_eq!(table["columns"]["class"], limited["columns"]["class"]);
    let picture = ureq::get(format!("{sweep}/window?format=svg&limits={off},largest_side_force:{middle}"))
        .call()
        .unwrap()
        .body_mut()
        .read_to_string()
        .unwrap();
    assert!(picture.contains("<svg") && picture.contains("class: over limit"), "{picture}");

    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    for path in ["window", "points/1/diagnosis", "table"] {
        let mut answer = agent.get(format!("{sweep}/{path}?limits=largest_side_forc:1")).call().unwrap();
        assert_eq!(answer.status(), 400, "{path}");
        let problem: Value = answer.body_mut().read_json().unwrap();
        assert!(problem.to_string().contains("largest_side_force"), "{problem}");
    }
}
