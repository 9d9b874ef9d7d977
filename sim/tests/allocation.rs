//! The time loop allocates no memory after its start.

use allocation_counter::measure;
use drillsweep_scenario::{Accuracy, Integrator, OrbitWindow, Snapshots, TimeStepping, TimeWindow, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::key::canonical_json;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;

#[test]
fn steps_allocate_nothing() {
    // Defaults of scenarios are found once in a process.
    let _ = canonical_json(&preset("paper-200m").expect("it ships with the crate"));
    let adaptive = TimeStepping { tolerance: Some(1e-6), ..TimeStepping::fixed(Integrator::Rk4, 6e-5) };
    for stepping in [
        TimeStepping::fixed(Integrator::GeneralizedAlpha, 5e-4),
        TimeStepping::fixed(Integrator::Esdirk4, 1e-3),
        TimeStepping::fixed(Integrator::Rk4, 5e-5),
        adaptive,
    ] {
        // Rows of the ledger, samples of three nodes and snapshots of all included.
        let [shorter, longer] = [0.2, 0.4].map(|duration| {
            let mut scenario = preset("paper-200m").expect("it ships with the crate");
            scenario.duration = duration;
            scenario.accuracy = Accuracy::Explicit(stepping);
            scenario.recording.spectrum_windows = Some(Vec::new());
            // The state from which a twin starts is kept once, at the start of the window, and the verdict on the window is the same.
            let window = TimeWindow { from: 0.0, to: 0.1 };
            scenario.recording.orbit_window = Some(OrbitWindow::Fixed(window));
            scenario.recording.snapshots = Some(Snapshots { rate_hz: 50.0, window: None });
            let model = Model::new(&scenario).expect("the preset has a model");
            let equilibrium = Equilibrium::find(&model).expect("the preset has an equilibrium");
            let run = Transient::new(&model, &equilibrium).expect("the preset can be run");
            let mut steps = 0;
            let allocated = measure(|| {
                let Ok(Outcome::Finished(records)) = run.run(&Control::new()) else {
                    panic!("nothing stops it")
                };
                steps = records.effort.steps;
            });
            (steps, allocated.count_total)
        });
        assert!(longer.0 > shorter.0 + 100, "{stepping:?}");
        assert_eq!(longer.1, shorter.1, "allocations of {} and {} steps: {stepping:?}", longer.0, shorter.0);
    }
}

#[test]
fn memory_grows_with_the_string_and_not_with_the_steps() {
    let peak = |lengths: f64, duration: f64| {
        let mut scenario = preset("paper-200m").expect("it ships with the crate");
        scenario.duration = duration;
        scenario.recording.nodes.truncate(1);
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        scenario.scale_mesh(lengths);
        let mut nodes = 0;
        let bytes = measure(|| {
            let model = Model::new(&scenario).expect("the preset has a model");
            nodes = model.node_count();
            let equilibrium = Equilibrium::find(&model).expect("the preset has an equilibrium");
            let run = Transient::new(&model, &equilibrium).expect("the preset can be run");
            run.run_into(&Control::new(), &mut |_| Ok(())).expect("nothing stops it");
        })
        .bytes_max;
        (nodes as f64, bytes as f64)
    };
    // Largest memory of a run of the base case, with its model: 40 KB a node.
    let (nodes, bytes) = peak(1.0, 0.05);
    assert!(bytes < 40e3 * nodes, "{} B a node", bytes / nodes);
    let (more_nodes, more_bytes) = peak(0.25, 0.05);
    let growth = (more_bytes - bytes) / (more_nodes - nodes);
    assert!(growth < 40e3, "{growth} B for each further node");
    // Beyond a block of samples, 8 s of one node, only the ledger grows, some twenty numbers ten times a second, and the course of the node and
    // the bit over the window, the last third: three numbers 200 times a second.
    let [shorter, longer] = [9.0, 12.0].map(|duration| peak(1.0, duration).1);
    assert!(
        longer - shorter < (3.0 * 10.0 * 24.0 + 1.0 * 200.0 * 3.0) * 8.0,
        "{} B for 3 s",
        longer - shorter
    );
}
