//! Problems of the points of a request beyond the first.

use drillsweep_api::{SweepRequest, UNINTERRUPTED, expand};
use serde_json::{Value, json};

/// Pointers and messages of the problems of a request; none if it is valid.
fn refused(body: Value) -> Vec<(String, String)> {
    let request: SweepRequest = serde_json::from_value(body).expect("a request");
    match expand(&request, UNINTERRUPTED) {
        Ok(_) => Vec::new(),
        Err(problem) => {
            let of = |error: drillsweep_api::FieldProblem| (error.pointer.unwrap_or_default(), error.detail);
            problem.errors.into_iter().map(of).collect()
        }
    }
}

/// The limit of stability takes an equilibrium to find, so that only extreme points are looked at: here the least step is within it, and so is the
/// first.
#[test]
fn a_step_beyond_stability_is_found_at_any_point() {
    for (steps, at) in [([2e-5, 1e-4, 1e-5], 1), ([2e-5, 1e-5, 1e-4], 2), ([1e-4, 2e-5, 1e-5], 0)] {
        let body = json!({"preset": "paper-200m", "set": {"accuracy": {"integrator": "rk4", "step": 1e-5}},
            "axes": {"accuracy.step": {"values": steps}}});
        let found = refused(body);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].0, format!("/axes/accuracy.step/values/{at}"));
        assert!(found[0].1.contains("6.3"), "{found:?}");
    }
}

/// A mesh of `auto` is finer at the accuracy `reference`: 1500 pieces of drillpipe with tool joints have eight elements each at `draft` and
/// twenty at `reference`, more than the 20,000 that a mesh has at most.
#[test]
fn a_reference_that_cannot_run_a_later_point_is_found() {
    let of = |pieces: u32| {
        let survey = [0.0, 4e4]
            .map(|depth| json!({"measured_depth": depth, "inclination_deg": 0.0, "azimuth_deg": 0.0}));
        json!({"preset": "paper-200m-damped", "set": {"accuracy": "draft", "well.survey": survey}, "outputs": "summary",
            "axes": {"string.sections[1].count": {"values": [9, pieces]}}, "verify": 2})
    };
    assert_eq!(refused(of(10)), []);
    let found = refused(of(3000));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].0, "/verify");
    assert!(found[0].1.starts_with("not valid at the accuracy `reference`: mesh: "), "{found:?}");
}

/// The sequence has 2^32 points.
#[test]
fn a_sobol_sequence_is_not_drawn_beyond_its_end() {
    let of = |skip: u32| {
        json!({"preset": "paper-200m", "design": "sobol", "samples": 10, "skip": skip,
            "axes": {"flow_rate": {"from": 0.01, "to": 0.06}}})
    };
    assert_eq!(refused(of(u32::MAX - 10)), []);
    for skip in [u32::MAX - 9, u32::MAX] {
        let found = refused(of(skip));
        assert_eq!((found.len(), found[0].0.as_str()), (1, "/skip"), "{found:?}");
    }
}

/// Gauges, masses and recorded nodes of whole wells move with the bit.
#[test]
fn a_whole_well_is_swept_over_its_bit_depth() {
    for (preset, depths) in [
        ("wells/volve-f12", [1500.0, 2500.0, 3438.0]),
        ("wells/vertical-2500m", [700.0, 1600.0, 2500.0]),
        ("wells/extended-reach-5000m", [2500.0, 4000.0, 5000.0]),
        ("wells/well-b-aarsnes", [800.0, 1500.0, 2500.0]),
    ] {
        let body = json!({"preset": preset, "axes": {"string.bit_depth": {"values": depths}}});
        assert_eq!(refused(body), [], "{preset}");
    }
}
