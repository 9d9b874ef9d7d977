//! Strings without excitation: they stay at rest, at a cost like that of strings that move.

use drillsweep_scenario::{Accuracy, AccuracyPreset, Effect, NodeChoice, Scenario, Switch, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{NodeHistory, Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_study::summary::TransientSummary;

/// Simulated time \[s\].
const DURATION: f64 = 5.0;

/// A preset with all of its nodes recorded.
fn changed_preset(name: &str, change: impl Fn(&mut Scenario)) -> Scenario {
    let mut scenario = preset(name).expect("shipped preset");
    (scenario.duration, scenario.accuracy) = (DURATION, Accuracy::Preset(AccuracyPreset::Standard));
    (scenario.recording.spectrum_windows, scenario.recording.orbit_window) = (Some(Vec::new()), None);
    change(&mut scenario);
    let nodes = Model::new(&scenario).expect("has a model").node_count();
    scenario.recording.nodes =
        (1..=nodes).map(|node| NodeChoice::Node(node.try_into().expect("few"))).collect();
    scenario
}

/// A run from the equilibrium, or as a disturbed member of an ensemble, with the ratio of its residual energy.
fn run(scenario: &Scenario, member: u32) -> (Records, Option<f64>) {
    let model = Model::new(scenario).expect("has a model");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let transient = Transient::member(&model, &equilibrium, member).expect("sets up");
    match transient.run(&Control::new()) {
        Ok(Outcome::Finished(records)) => {
            let Ok(summary) = TransientSummary::new(&model, &records);
            (*records, summary.energy_residual_ratio)
        }
        other => panic!("{}: {other:?}", scenario.name),
    }
}

fn all_series(history: &NodeHistory) -> [&[f64]; 8] {
    [
        &history.u,
        &history.v,
        &history.w,
        &history.theta_z,
        &history.u_rate,
        &history.v_rate,
        &history.w_rate,
        &history.theta_z_rate,
    ]
}

#[test]
fn a_string_at_rest_stays_there_at_the_cost_of_a_moving_one() {
    let (moving, _) = run(&changed_preset("paper-200m", |_| ()), 0);
    let on_wall = changed_preset("paper-200m", |scenario| {
        (scenario.operation.rotation_speed_rpm, scenario.operation.torque_on_bit) = (0.0, 0.0);
    });
    let turning = changed_preset("paper-200m", |scenario| {
        for effect in [Effect::Friction, Effect::FrictionTorque, Effect::Unbalance] {
            scenario.effects.set(effect, Switch::Off);
        }
    });
    let hanging = changed_preset("hard/vertical", |scenario| {
        (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
        scenario.effects.set(Effect::Unbalance, Switch::Off);
    });
    // The last one is a member of an ensemble, which starts a micrometre from its equilibrium.
    for (scenario, member, farthest) in
        [(&on_wall, 0, 1e-8), (&turning, 0, 1e-8), (&hanging, 0, 0.0), (&hanging, 1, 1e-5)]
    {
        let (records, residual_ratio) = run(scenario, member);
        let (name, last) = (&scenario.name, records.energy.last().expect("booked at the end"));
        // Nothing has done work that a residual could be measured by.
        assert_eq!(residual_ratio, None, "{name}: {last:?}");
        assert!(member > 0 || last.kinetic <= records.energy_rounding, "{name}: {last:?}");
        let mut drift = 0.0_f64;
        for history in &records.histories {
            for series in all_series(history) {
                // Numbers below the normal ones take many processors a hundred times as long.
                let is_normal = |value: &f64| *value == 0.0 || value.is_normal();
                assert!(series.iter().all(is_normal), "{name}: node {}", history.node);
            }
            for series in &all_series(history)[..4] {
                drift = series.iter().fold(drift, |most, value| most.max((value - series[0]).abs()));
            }
        }
        assert!(drift <= farthest, "{name}: {drift} m or rad");
        // If friction sticks, contact iterations converge with half the step only.
        let (effort, expected) = (&records.effort, &moving.effort);
        assert_eq!((effort.rejected_steps, effort.unresolved_steps), (0, 0), "{name}: {effort:?}");
        assert!(effort.steps <= 2 * expected.steps, "{name}: {effort:?} {expected:?}");
        assert!(
            effort.contact_iterations.count <= 2 * expected.contact_iterations.count,
            "{name}: {effort:?} {expected:?}"
        );
    }
}
