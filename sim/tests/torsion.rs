//! Torsional modes that velocity-weakening friction excites: the chain of shafts compared with all modes together, and the effect of damping.

use std::f64::consts::PI;

use drillsweep_scenario::{Effect, NodeChoice, Scenario, Switch, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{ModeKind, ModeSearch, UndampedTorsion, modes, torsional_modes};
use drillsweep_sim::solve::run::{NodeHistory, Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;

fn at_rest(scenario: &Scenario) -> (Model, Equilibrium) {
    let model = Model::new(scenario).expect("has a model");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    (model, equilibrium)
}

#[test]
fn twist_alone_has_the_frequencies_and_growth_of_all_motion_together() {
    let (model, equilibrium) = at_rest(&preset("paper-200m").expect("shipped preset"));
    let search = ModeSearch { to_hz: 60.0, ..ModeSearch::default() };
    let all = modes(&model, &equilibrium, &search).expect("found").modes;
    let chain = torsional_modes(&model, &equilibrium).expect("twist takes part");
    // Modes of almost pure twist; the lateral part of one, up to 3e-3 of its energy, is damped by some 10 1/s.
    let torsional = all.iter().filter(|mode| mode.kind == ModeKind::Torsional && mode.torsional_share > 0.99);
    let mut count = 0;
    for (mode, alone) in torsional.zip(&chain) {
        assert!((alone.frequency_hz / mode.frequency_hz - 1.0).abs() < 1e-3, "{alone:?} against {mode:?}");
        assert!((alone.growth_rate - mode.growth_rate).abs() < 0.03, "{alone:?} against {mode:?}");
        count += 1;
    }
    assert_eq!(count, 8);
}

#[test]
fn torsion_grows_to_the_end_of_the_mesh_unless_damping_grows_with_frequency() {
    let judged = |scenario: &Scenario| {
        let (model, equilibrium) = at_rest(scenario);
        (UndampedTorsion::about(&model, &equilibrium), torsional_modes(&model, &equilibrium))
    };
    let mut scenario = preset("paper-200m").expect("shipped preset");
    let (torsion, modes) = judged(&scenario);
    let (torsion, modes) = (torsion.expect("twist takes part"), modes.expect("twist takes part"));
    assert!(torsion.up_to_the_mesh && torsion.growing_modes > Some(280), "{torsion:?}");
    assert_eq!(modes.len(), model_nodes(&scenario) - 1);
    // A finer mesh only has more of them to grow.
    scenario.scale_mesh(0.5);
    let (finer, _) = judged(&scenario);
    let finer = finer.expect("twist takes part");
    assert!(finer.up_to_the_mesh && finer.highest_hz > torsion.highest_hz.map(|hz| 1.5 * hz), "{finer:?}");

    let (damped, modes) = judged(&preset("paper-200m-damped").expect("shipped preset"));
    let (damped, modes) = (damped.expect("twist takes part"), modes.expect("twist takes part"));
    assert!(!damped.up_to_the_mesh && damped.highest_hz < Some(20.0), "{damped:?}");
    assert!(modes.iter().all(|mode| mode.frequency_hz < 20.0 || mode.growth_rate < 0.0));
    // Stick-slip is still there: the lowest mode grows nearly as it does without.
    assert!(modes[0].growth_rate > 0.1 && modes[0].frequency_hz < 2.2, "{:?}", modes[0]);
}

fn model_nodes(scenario: &Scenario) -> usize {
    Model::new(scenario).expect("has a model").node_count()
}

/// The base case in a straight well of an inclination \[deg\], all nodes recorded.
fn straight(inclination_deg: f64, duration: f64) -> Scenario {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.duration = duration;
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario.recording.nodes = (1..=model_nodes(&scenario) as u32).map(NodeChoice::Node).collect();
    for station in &mut scenario.well.survey {
        (station.inclination_deg, station.azimuth_deg) = (inclination_deg, 0.0);
    }
    scenario
}

fn recorded(scenario: &Scenario) -> (Model, Equilibrium, Vec<NodeHistory>) {
    let (model, equilibrium) = at_rest(scenario);
    let histories = match Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new()) {
        Ok(Outcome::Finished(records)) => records.histories,
        other => panic!("did not finish: {other:?}"),
    };
    (model, equilibrium, histories)
}

#[test]
fn torque_on_bit_is_constant_along_a_frictionless_string() {
    let mut scenario = straight(0.0, 0.05);
    scenario.operation.torque_on_bit = -2500.0;
    scenario.operation.weight_on_bit = 0.0;
    scenario.effects.set(Effect::Unbalance, Switch::Off);
    let (_, _, histories) = recorded(&scenario);
    for NodeHistory { node, torque, theta_z_rate, .. } in &histories {
        assert!(torque.iter().all(|torque| (torque / -2500.0 - 1.0).abs() < 1e-9), "node {node}: {torque:?}");
        assert!(theta_z_rate.iter().all(|rate| rate.abs() < 1e-9), "node {node}");
    }
}

#[test]
fn torque_of_a_rubbing_string_is_torsional_stiffness_times_twist() {
    let scenario = straight(80.0, 2.0);
    let (model, equilibrium, histories) = recorded(&scenario);
    let material = &scenario.string.material;
    let shear_modulus = material.youngs_modulus / (2.0 * (1.0 + material.poissons_ratio));
    let mut largest_change: f64 = 0.0;
    for (e, (element, ends)) in model.mesh.elements.iter().zip(histories.windows(2)).enumerate() {
        let polar_moment =
            PI / 32.0 * (element.tube.outer_diameter.powi(4) - element.tube.inner_diameter.powi(4));
        let stiffness = shear_modulus * polar_moment / element.length;
        let below = &ends[1].torque;
        for ((torque, top), bottom) in below.iter().zip(&ends[0].theta_z).zip(&ends[1].theta_z) {
            assert!((torque - stiffness * (bottom - top)).abs() < 1e-3, "element {e}: {torque} N m");
            largest_change = largest_change.max((torque - below[0]).abs());
        }
        assert!((below[0] - equilibrium.torque[e]).abs() < 1e-6, "starts from the equilibrium");
    }
    assert!(histories[0].torque == histories[1].torque, "the first node has the element below it");
    assert!(largest_change > 100.0, "the torque swings: {largest_change} N m");
}
