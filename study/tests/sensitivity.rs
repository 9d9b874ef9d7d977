//! Amplification of a disturbance by a scenario, compared with the modes about its equilibrium.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::sync::atomic::{AtomicBool, Ordering};

use drillsweep_scenario::{Scenario, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::stability;
use drillsweep_sim::solve::run::{Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;
use drillsweep_study::sensitivity::Sensitivity;
use serde_json::json;

/// Flutter without a wall: linear motion, of which one frequency grows, in both senses of whirl.
fn flutter() -> Scenario {
    let mut scenario = preset("hard/flow-flutter").unwrap();
    for (path, value) in [
        ("duration", json!(3.0)),
        ("effects.contact", json!("off")),
        ("recording.orbit_window", json!({ "from": 1.0, "to": 2.0 })),
        ("recording.spectrum_windows", json!([])),
    ] {
        scenario = scenario.with(path, value).unwrap();
    }
    validate(&scenario).unwrap();
    scenario
}

fn finished(outcome: Outcome) -> Box<Records> {
    match outcome {
        Outcome::Finished(records) => records,
        other => panic!("did not finish: {other:?}"),
    }
}

#[test]
fn distances_grow_as_the_unstable_mode_does() {
    let scenario = flutter();
    let model = Model::new(&scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    let run = finished(Transient::new(&model, &equilibrium).unwrap().run(&Control::new()).unwrap());
    let twin = Sensitivity::of(&model, &equilibrium, &run, &Control::new()).unwrap().unwrap();
    let mode = stability(&model, &equilibrium).unwrap().instability.unwrap();
    // Over an eighth of its period the mode has not left the others behind altogether.
    let growth = twin.growth_rate.unwrap();
    assert!((growth / mode.growth_rate - 1.0).abs() < 0.05, "{growth} against {}", mode.growth_rate);
    assert!((twin.window.from - 1.0).abs() < 0.11 && (twin.window.to - twin.window.from - 1.0).abs() < 1e-9);
}

#[test]
fn a_run_that_was_suspended_in_its_window_has_the_same_twin() {
    let scenario = flutter();
    let model = Model::new(&scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    let whole = finished(Transient::new(&model, &equilibrium).unwrap().run(&Control::new()).unwrap());
    let asked = AtomicBool::new(false);
    let control = Control::observed_by(move |control, time| {
        if time > 1.5 && !asked.swap(true, Ordering::Relaxed) {
            control.suspend();
        }
    });
    let Outcome::Suspended(checkpoint, histories) =
        Transient::new(&model, &equilibrium).unwrap().run(&control).unwrap()
    else {
        panic!("was not suspended")
    };
    let resumed = Transient::resume(&model, &equilibrium, &checkpoint).unwrap();
    let resumed = finished(resumed.run_on(&Control::new(), histories).unwrap());
    assert!(whole.window_start.is_some());
    assert_eq!(whole.window_start, resumed.window_start);
    let twin = |run: &Records| Sensitivity::of(&model, &equilibrium, run, &Control::new()).unwrap();
    assert_eq!(twin(&whole), twin(&resumed));
}
