//! Runs that end once their motion has settled.

use drillsweep_scenario::{Accuracy, AccuracyPreset, OrbitWindow, Scenario, TimeWindow, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{ModeKind, ModeSearch, modes};
use drillsweep_sim::solve::run::{Checkpoint, MotionRegime, Outcome, Records, Transient, shortest_run};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_study::summary::TransientSummary;

mod whole_run_scenarios;

fn settled(mut scenario: Scenario, longest: f64) -> Scenario {
    scenario.duration = longest;
    scenario.recording.orbit_window = Some(OrbitWindow::SETTLED);
    scenario.recording.spectrum_windows = None;
    scenario
}

/// A shaft of one element, whose runs take little time.
fn shaft(longest: f64) -> Scenario {
    let mut scenario = settled(preset("hard/one-element").expect("shipped preset"), longest);
    scenario.recording.rate_hz = 200.0;
    scenario.accuracy = Accuracy::Preset(AccuracyPreset::Draft);
    scenario
}

fn at_rest(scenario: &Scenario) -> (Model, Equilibrium) {
    let model = Model::new(scenario).expect("has a model");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    (model, equilibrium)
}

fn run(scenario: &Scenario) -> (Records, TransientSummary) {
    let (model, equilibrium) = at_rest(scenario);
    let ended = Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new());
    let Ok(Outcome::Finished(records)) = ended else { panic!("not finished: {ended:?}") };
    let Ok(summary) = TransientSummary::new(&model, &records);
    (*records, summary)
}

#[test]
fn a_suspended_run_ends_once_settled() {
    let scenario = shaft(300.0);
    let (whole, _) = run(&scenario);
    assert_eq!(whole.settling.regime, MotionRegime::Regular);
    assert!(
        whole.simulated_time >= shortest_run(&scenario) && whole.simulated_time < 300.0,
        "{:?}",
        whole.settling
    );
    assert_eq!(whole.settling.window.to, whole.simulated_time);
    let (model, equilibrium) = at_rest(&scenario);
    // On the way, at a judgement that lets it go on, and at the last.
    for at in [12.3, 30.0, whole.simulated_time] {
        let control = Control::observed_by(move |control, time| {
            if time >= at {
                control.suspend();
            }
        });
        let ended = Transient::new(&model, &equilibrium).expect("sets up").run(&control);
        let Ok(Outcome::Suspended(checkpoint, histories)) = ended else { panic!("not suspended: {ended:?}") };
        let restored = Checkpoint::from_bytes(&checkpoint.to_bytes()).expect("its own bytes");
        let resumed = Transient::resume(&model, &equilibrium, &restored).expect("same scenario");
        let ended = resumed.run_on(&Control::new(), histories);
        let Ok(Outcome::Finished(resumed)) = ended else { panic!("not finished: {ended:?}") };
        assert_eq!(*resumed, whole, "from {at} s");
    }
}

#[test]
fn a_run_without_time_to_settle_shows_its_last_third_and_says_so() {
    let scenario = shaft(30.0);
    let (records, summary) = run(&scenario);
    assert_eq!((records.simulated_time, shortest_run(&scenario)), (30.0, 30.0));
    assert_eq!(summary.settling.regime, MotionRegime::NotSettled);
    assert_eq!(summary.settling.settled_at, None);
    assert_eq!(summary.settling.window, TimeWindow { from: 20.0, to: 30.0 });
    assert!(summary.orbits.iter().all(|orbit| orbit.window == summary.settling.window));
    assert!(summary.settling.halves_differ.is_some());
}

#[test]
fn no_run_ends_before_its_fixed_windows_do() {
    let mut scenario = shaft(300.0);
    let ends = run(&scenario).0.simulated_time;
    scenario.recording.spectrum_windows = Some(vec![TimeWindow { from: ends, to: ends + 15.0 }]);
    let (records, summary) = run(&scenario);
    assert!(records.simulated_time >= ends + 15.0, "{} after {ends}", records.simulated_time);
    assert_eq!(summary.spectra[0].window.to, ends + 15.0);
}

/// Torsion of the reduced string grows with 0.05 1/s at this speed: over [20, 30) s the string is quiet, and settled it sticks and slips in
/// orbits more than ten times as large. Two runs of 160 s together, since the settled motion comes late: 3 s.
#[test]
fn a_mode_that_grows_keeps_a_run_going_until_it_sticks_and_slips() {
    let mut quiet = whole_run_scenarios::reduced();
    quiet.operation.rotation_speed_rpm = 170.0;
    quiet.mud.as_mut().expect("mud").density = 1500.0;
    quiet.accuracy = Accuracy::Preset(AccuracyPreset::Draft);
    let (_, early) = run(&quiet);
    assert_eq!((early.settling.regime, early.slip_to_stick_count), (MotionRegime::Fixed, 0));
    let growing = early.settling.growing_mode.expect("still grows");
    assert!(growing.growth_rate > 0.04 && growing.growth_rate < 0.06, "{growing:?}");
    let (model, equilibrium) = at_rest(&quiet);
    let search = ModeSearch { from_hz: 1.9, to_hz: 2.4, most: 100 };
    let all = modes(&model, &equilibrium, &search).expect("found").modes;
    let torsional = all.iter().find(|mode| mode.kind == ModeKind::Torsional && mode.growth_rate > 0.0);
    let shift = torsional.expect("torsion grows").frequency_hz - growing.frequency_hz;
    assert!(shift.abs() < 0.02, "{shift} Hz");
    assert!(early.settling.halves_differ.expect("has halves") > 0.2);

    let (_, late) = run(&settled(quiet, 300.0));
    assert_eq!((late.settling.regime, late.settling.growing_mode), (MotionRegime::Regular, None));
    assert!(late.simulated_time > 100.0 && late.slip_to_stick_count > 1000, "{:?}", late.settling);
    for (early, late) in early.orbits.iter().zip(&late.orbits) {
        assert!(late.orbit_radius_rms > 10.0 * early.orbit_radius_rms, "{early:?} {late:?}");
    }
    // The limit cycle turns at the frequency of the mode that it has grown from.
    let [base] = late.settling.base_frequencies_hz[..] else { panic!("{:?}", late.settling) };
    assert!((base - growing.frequency_hz).abs() < 0.02, "{base}");
}
