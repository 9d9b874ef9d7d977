//! Torsional modes that falling friction feeds: the chain of shafts against all modes together, and what damping does to them.

use drillsweep_sim::model::Model;
use drillsweep_sim::modes::{ModeKind, ModeSearch, UndampedTorsion, modes, torsional_modes};
use drillsweep_sim::scenario::{Scenario, preset};
use drillsweep_sim::statics::Equilibrium;

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
    // Modes that move next to nothing but twist; what of one is lateral, up to 3e-3 of its energy, is damped by some 10 1/s.
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
    scenario.mesh = scenario.mesh.scaled(0.5);
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
