//! The error estimate compared with the true error, over a set of scenarios.

use drillsweep_scenario::{
    Accuracy, Effect, Integrator, NodeChoice, RegimeChoice, Scenario, Switch, TimeStepping, preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;

/// Simulated time \[s\]: long enough for the string to leave its rest, too short for histories to part.
const DURATION: f64 = 0.5;

/// The calibration scenarios: the paper's string, with changes that determine the smoothness of its motion.
fn scenarios() -> Vec<(&'static str, Scenario)> {
    let mut base = preset("paper-200m").expect("shipped preset");
    base.duration = DURATION;
    base.recording.spectrum_windows = Some(Vec::new());
    base.recording.orbit_window = None;
    let change = |name: &'static str, change: &dyn Fn(&mut Scenario)| {
        let mut scenario = base.clone();
        change(&mut scenario);
        (name, scenario)
    };
    let unbalance = |scenario: &mut Scenario, factor: f64| {
        scenario.mud = None;
        for mass in &mut scenario.string.unbalance {
            mass.mass *= factor;
        }
    };
    vec![
        change("base case", &|_| {}),
        change("heavy mud", &|s| s.mud.as_mut().expect("mud").density = 2100.0),
        change("fast flow, declared laminar", &|s| {
            let mud = s.mud.as_mut().expect("mud");
            (mud.flow_rate, mud.regime) = (0.06, RegimeChoice::Laminar);
        }),
        change("fast rotation", &|s| s.operation.rotation_speed_rpm = 180.0),
        change("dry, unbalance x30", &|s| unbalance(s, 30.0)),
        change("dry, unbalance x150: impacts", &|s| unbalance(s, 150.0)),
        change("steep friction", &|s| s.contact.friction_reference_speed = 0.001),
        change("soft wall", &|s| (s.contact.stiffness, s.contact.damping) = (1e6, 1e3)),
        change("frictionless", &|s| {
            s.effects.set(Effect::Friction, Switch::Off);
            s.effects.set(Effect::FrictionTorque, Switch::Off);
        }),
        change("no torque", &|s| s.operation.torque_on_bit = 0.0),
    ]
}

fn run(scenario: &Scenario, stepping: TimeStepping) -> Records {
    let mut scenario = scenario.clone();
    scenario.accuracy = Accuracy::Explicit(stepping);
    scenario.recording.nodes = (2..=297).map(NodeChoice::Node).collect();
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    match Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new()) {
        Ok(Outcome::Finished(records)) => *records,
        other => panic!("did not finish: {other:?}"),
    }
}

/// Root mean square distance of the lateral displacements at the end, over all nodes \[m\].
fn distance_at_the_end(a: &Records, b: &Records) -> f64 {
    let squares = a.histories.iter().zip(&b.histories).map(|(a, b)| {
        let last = a.u.len() - 1;
        (a.u[last] - b.u[last]).powi(2) + (a.v[last] - b.v[last]).powi(2)
    });
    (squares.sum::<f64>() / (2 * a.histories.len()) as f64).sqrt()
}

#[test]
fn estimate_covers_the_true_error_without_being_far_too_large() {
    let steppings = [
        TimeStepping::fixed(Integrator::GeneralizedAlpha, 1e-3),
        TimeStepping::fixed(Integrator::GeneralizedAlpha, 5e-4),
        TimeStepping::fixed(Integrator::GeneralizedAlpha, 2.5e-4),
        TimeStepping::fixed(Integrator::Esdirk4, 1e-3),
        TimeStepping::fixed(Integrator::Esdirk4, 5e-4),
        TimeStepping::fixed(Integrator::Esdirk4, 2.5e-4),
    ];
    let ratios: Vec<(String, f64)> = std::thread::scope(|scope| {
        let workers: Vec<_> = scenarios()
            .into_iter()
            .map(|(name, scenario)| {
                scope.spawn(move || {
                    let finest = TimeStepping {
                        contact_sweeps: 4,
                        ..TimeStepping::fixed(Integrator::Esdirk4, 6.25e-5)
                    };
                    let reference = run(&scenario, finest);
                    steppings.map(|stepping| {
                        let records = run(&scenario, stepping);
                        let error = distance_at_the_end(&records, &reference);
                        let label = format!("{name}, {:?} {:e} s", stepping.integrator, stepping.step);
                        (label, records.error.displacement / error)
                    })
                })
            })
            .collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("runs")).collect()
    });
    let mut sorted: Vec<f64> = ratios.iter().map(|(_, ratio)| *ratio).collect();
    sorted.sort_by(f64::total_cmp);
    let covered = sorted.iter().filter(|&&ratio| ratio >= 1.0).count();
    let median = sorted[sorted.len() / 2];
    assert!(
        covered as f64 >= 0.95 * sorted.len() as f64,
        "{covered} of {} covered: {ratios:#?}",
        sorted.len()
    );
    assert!(median <= 10.0, "too large by {median} in the median: {ratios:#?}");
}

#[test]
fn estimate_of_rk4_covers_the_true_error() {
    let scenarios = scenarios();
    for wanted in ["base case", "frictionless"] {
        let (name, scenario) = scenarios.iter().find(|(name, _)| *name == wanted).expect("is there");
        let scenario = Scenario { duration: 0.1, ..scenario.clone() };
        let reference = run(&scenario, TimeStepping::fixed(Integrator::Rk4, 1e-5));
        let records = run(&scenario, TimeStepping::fixed(Integrator::Rk4, 5e-5));
        let ratio = records.error.displacement / distance_at_the_end(&records, &reference);
        assert!((1.0..=40.0).contains(&ratio), "{name}: {ratio}");
    }
}
