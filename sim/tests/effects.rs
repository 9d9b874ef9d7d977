//! Only the effects that a scenario needs: effects that `auto` omits change no number.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use drillsweep_scenario::{Accuracy, AutoRule, Effect, Integrator, Scenario, Switch, TimeStepping, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::force::effect::decide_effects;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;

const METHODS: [(Integrator, f64); 3] =
    [(Integrator::GeneralizedAlpha, 5e-4), (Integrator::Esdirk4, 1e-3), (Integrator::Rk4, 5e-5)];

/// The base case over `duration` \[s\].
fn base(duration: f64, (integrator, step): (Integrator, f64)) -> Scenario {
    let mut scenario = preset("paper-200m").unwrap();
    scenario.duration = duration;
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(integrator, step));
    scenario
}

fn straighten(scenario: &mut Scenario) {
    for station in &mut scenario.well.survey {
        (station.inclination_deg, station.azimuth_deg) = (60.0, 30.0);
    }
}

fn without_friction(scenario: &mut Scenario) {
    (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
}

/// A finished run and its number of degrees of freedom of a node.
fn run(scenario: &Scenario) -> (Records, usize) {
    let model = Model::new(scenario).unwrap();
    let transient = Transient::new(&model, &Equilibrium::find(&model).unwrap()).unwrap();
    let degrees_of_freedom = transient.degrees_of_freedom();
    match transient.run(&Control::new()) {
        Ok(Outcome::Finished(records)) => (*records, degrees_of_freedom),
        other => panic!("not finished: {other:?}"),
    }
}

/// Largest distance of two runs' recorded lateral displacements, relative to the largest motion of the first.
fn distance(a: &Records, b: &Records) -> f64 {
    let (mut apart, mut motion) = (0.0_f64, 0.0_f64);
    for (a, b) in a.histories.iter().zip(&b.histories) {
        for (a, b) in [(&a.u, &b.u), (&a.v, &b.v)] {
            for (x, y) in a.iter().zip(b) {
                apart = apart.max((x - y).abs());
                motion = motion.max((x - a[0]).abs());
            }
        }
    }
    apart / motion
}

#[test]
fn auto_agrees_with_everything_on_to_rounding() {
    type Change = fn(&mut Scenario);
    // Name, change, degrees of freedom that it leaves.
    let scenarios: [(&str, Change, usize); 7] = [
        ("as it is", |_| {}, 6),
        ("dry", |s| s.mud = None, 6),
        ("still mud", |s| s.mud.as_mut().unwrap().flow_rate = 0.0, 6),
        ("frictionless", without_friction, 6),
        ("straight", straighten, 5),
        ("straight and frictionless", |s| (straighten(s), without_friction(s)).0, 4),
        (
            "straight, friction without torque",
            |s| {
                straighten(s);
                s.effects.set(Effect::FrictionTorque, Switch::Off);
            },
            4,
        ),
    ];
    for (name, change, degrees_of_freedom) in scenarios {
        let mut scenario = base(0.2, METHODS[1]);
        change(&mut scenario);
        let mut everything = scenario.clone();
        for &effect in Effect::ALL {
            if everything.effects.switch(effect) == Switch::Auto {
                everything.effects.set(effect, Switch::On);
            }
        }
        let ((auto, of_auto), (all, of_all)) = (run(&scenario), run(&everything));
        assert_eq!((of_auto, of_all), (degrees_of_freedom, 6), "{name}");
        // 200 steps of six solves, each with 1e-16 times a condition of some thousand.
        let distance = distance(&all, &auto);
        assert!(distance < 1e-8, "{name}: {distance:e}");
    }
}

#[test]
fn neglected_effects_stay_within_their_estimates() {
    let scenario = base(0.5, METHODS[1]);
    let mut neglecting = scenario.clone();
    neglecting.effects.auto = AutoRule::Aggressive;
    let left_out: Vec<_> = decide_effects(&neglecting)
        .into_iter()
        .filter(|decision| decision.reason.starts_with("omitted as small"))
        .collect();
    assert!(!left_out.is_empty() && left_out.len() <= 3, "{left_out:?}");
    // Each changes frequencies by less than 1e-3, so phases of motion up to 20 Hz by less than 1e-3 * 126 rad/s * 0.5 s.
    let distance = distance(&run(&scenario).0, &run(&neglecting).0);
    assert!(distance > 0.0 && distance < left_out.len() as f64 * 1e-3 * 126.0 * 0.5, "{distance:e}");
}

#[test]
fn omitted_motions_are_zero_in_the_records_and_the_ledger_closes() {
    for method in METHODS {
        let mut scenario = base(0.1, method);
        straighten(&mut scenario);
        without_friction(&mut scenario);
        let (records, degrees_of_freedom) = run(&scenario);
        assert_eq!(degrees_of_freedom, 4);
        for history in &records.histories {
            assert!(history.theta_z.iter().all(|&twist| twist == history.theta_z[0] && twist != 0.0));
            assert!(history.w.iter().all(|&w| w == history.w[0] && w != 0.0));
            assert!(history.u.iter().any(|&u| u != history.u[0]));
        }
        let last = records.energy.last().unwrap();
        // Without friction the unbalance drives the motion; the residual is the method's own error.
        assert!(last.residual.abs() < 0.02 * last["work_unbalance"].abs().max(last.kinetic), "{last:?}");
    }
}

#[test]
fn the_ledger_closes_without_gravity() {
    let mut scenario = base(0.3, METHODS[1]);
    let (heavy, _) = run(&scenario);
    scenario.effects.set(Effect::Gravity, Switch::Off);
    let (weightless, _) = run(&scenario);
    for (name, records) in [("with", heavy), ("without", weightless)] {
        let last = records.energy.last().unwrap();
        assert!(last.turned_over() > 0.0, "{name}: nothing moves");
        assert!(last.residual.abs() < 0.02 * last.turned_over(), "{name}: {last:?}");
    }
}

#[test]
fn sliding_dissipates_at_all_times_only_if_friction_turns_the_string() {
    // Friction drives a rotor backwards along its wall.
    let dissipated = |torque: Switch| {
        let mut scenario = preset("hard/dry-friction-whirl").unwrap();
        scenario.effects.set(Effect::FrictionTorque, torque);
        let (records, _) = run(&scenario);
        let last = records.energy.last().unwrap();
        assert!(last.residual.abs() < 0.02 * last.turned_over(), "{last:?}");
        records.energy.iter().map(|row| row["dissipated_friction"]).collect::<Vec<_>>()
    };
    let both = dissipated(Switch::On);
    assert!(both.is_sorted() && *both.last().unwrap() > 0.0, "{both:?}");
    // The force alone does work on the whirl that no drive gives.
    let force_alone = dissipated(Switch::Off);
    assert!(*force_alone.last().unwrap() < 0.0, "{force_alone:?}");
}

#[test]
fn fewer_degrees_of_freedom_resume_to_the_same_bits() {
    for torsion in [Switch::On, Switch::Off] {
        let mut scenario = base(0.3, METHODS[0]);
        straighten(&mut scenario);
        scenario.effects.set(Effect::Torsion, torsion);
        let (whole, degrees_of_freedom) = run(&scenario);
        assert_eq!(degrees_of_freedom, if torsion == Switch::On { 5 } else { 4 });
        let model = Model::new(&scenario).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let control = Control::observed_by(|control, time| {
            if time >= 0.05 {
                control.suspend();
            }
        });
        let outcome = Transient::new(&model, &equilibrium).unwrap().run(&control);
        let Ok(Outcome::Suspended(checkpoint, histories)) = outcome else {
            panic!("not suspended: {outcome:?}")
        };
        let resumed =
            Transient::resume(&model, &equilibrium, &checkpoint).unwrap().run_on(&Control::new(), histories);
        let Ok(Outcome::Finished(resumed)) = resumed else { panic!("not finished: {resumed:?}") };
        assert_eq!(*resumed, whole);
    }
}
