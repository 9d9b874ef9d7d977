//! The memory of a worker belongs to the string and the windows, not to the duration.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use allocation_counter::measure;
use drillsweep_scenario::{NodeChoice, Scenario, Snapshots, TimeWindow, preset};
use drillsweep_sim::control::Control;
use drillsweep_study::footprint::Footprint;
use drillsweep_worker::compute;

/// The base case with many recorded nodes, at a draft's steps, for so long \[s\].
fn scenario_of(nodes: u32, duration: f64) -> Scenario {
    let mut scenario = preset("paper-200m-damped").unwrap();
    scenario.duration = duration;
    scenario.recording.nodes = (2..nodes + 2).map(NodeChoice::Node).collect();
    let window = TimeWindow { from: 0.0, to: 1.0 };
    scenario.recording.orbit_window = Some(window.into());
    scenario.recording.spectrum_windows = Some(vec![window]);
    scenario
}

/// The most bytes that a point takes at once.
fn peak(scenario: &Scenario) -> u64 {
    measure(|| drop(compute(scenario, &Control::new()).unwrap())).bytes_max
}

#[test]
fn the_memory_of_a_point_does_not_grow_with_its_duration() {
    // Beyond a row group of 10 s. What 11 s more record are 28 MB in double precision; the energy ledger's rows, ten a second, and
    // what a Parquet file's footer says of a row group do grow.
    let [shorter, longer] = [11.0, 22.0].map(|duration| peak(&scenario_of(40, duration)));
    let recorded = 40 * 11_000 * 64;
    assert!(longer < shorter + recorded / 20, "{shorter} and {longer} bytes");
}

#[test]
fn snapshots_take_no_more_memory_in_a_longer_run() {
    let of = |duration| {
        let mut scenario = scenario_of(1, duration);
        scenario.recording.snapshots = Some(Snapshots { rate_hz: 100.0, window: None });
        peak(&scenario)
    };
    // Both are longer than a block of 5 s; what 6 s more take are 5 MB.
    let [shorter, longer] = [6.0, 12.0].map(of);
    let taken = 600 * 297 * 7 * 4;
    assert!(longer < shorter + taken / 10, "{shorter} and {longer} bytes");
}

#[test]
fn the_plan_bounds_the_memory_of_a_point() {
    let spectra = |mut scenario: Scenario| {
        scenario.recording.spectrum_windows = Some(vec![TimeWindow { from: 0.0, to: scenario.duration }]);
        scenario
    };
    let snapshots = |mut scenario: Scenario| {
        scenario.recording.snapshots = Some(Snapshots { rate_hz: 1000.0, window: None });
        scenario
    };
    for scenario in [
        scenario_of(3, 4.0),
        scenario_of(100, 2.0),
        spectra(scenario_of(2, 20.0)),
        snapshots(scenario_of(1, 2.0)),
    ] {
        let (told, taken) = (Footprint::of(&scenario).unwrap().memory_bytes, peak(&scenario));
        assert!((taken..4 * taken).contains(&told), "{told} bytes told, {taken} taken");
    }
}
