//! Sections of the hole: the same hole in sections gives the same bits, and each section has its own diameter and friction.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use drillsweep_scenario::{
    Accuracy, HoleSection, Integrator, Scenario, SurveyStation, TimeStepping, WallLaw, preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;

fn section(from: f64, hole_diameter: Option<f64>, friction: Option<[f64; 2]>) -> HoleSection {
    HoleSection {
        name: String::new(),
        from,
        hole_diameter,
        static_friction: friction.map(|[static_friction, _]| static_friction),
        dynamic_friction: friction.map(|[_, dynamic_friction]| dynamic_friction),
    }
}

fn rest(scenario: &Scenario) -> (Model, Equilibrium) {
    let model = Model::new(scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    (model, equilibrium)
}

fn run(scenario: &Scenario) -> Records {
    let (model, equilibrium) = rest(scenario);
    let transient = Transient::new(&model, &equilibrium).unwrap();
    match transient.run(&Control::new()) {
        Ok(Outcome::Finished(records)) => *records,
        other => panic!("not finished: {other:?}"),
    }
}

fn short(law: WallLaw) -> Scenario {
    let mut scenario = preset("paper-200m").unwrap();
    scenario.contact.law = law;
    scenario.duration = 0.1;
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Esdirk4, 1e-3));
    scenario
}

#[test]
fn a_hole_that_is_given_as_a_section_has_the_bits_of_the_same_hole() {
    for law in [WallLaw::PerNode, WallLaw::PerLength] {
        let plain = short(law);
        let mut sections = plain.clone();
        sections.well.hole_diameter = 0.3;
        (sections.contact.static_friction, sections.contact.dynamic_friction) = (0.5, 0.5);
        // The boundary at 123.5 m is a gauge, and so a node already.
        let hole = Some(plain.well.hole_diameter);
        sections.well.section = [0.0, 123.5].map(|from| section(from, hole, Some([0.3, 0.2]))).to_vec();
        let [(plain, first), (sections, second)] =
            [(run(&plain), rest(&plain).1), (run(&sections), rest(&sections).1)];
        assert_eq!(first.displacement, second.displacement, "{law:?}");
        assert_eq!((first.tension, first.torque), (second.tension, second.torque));
        assert_eq!(plain.histories.len(), sections.histories.len());
        for (a, b) in plain.histories.iter().zip(&sections.histories) {
            assert_eq!((&a.u, &a.v), (&b.u, &b.v), "{law:?}");
        }
    }
}

#[test]
fn every_section_turns_the_string_by_its_own_friction() {
    // A horizontal string at break-away: the torque at the top is the sum of mu w L R of its sections.
    for law in [WallLaw::PerNode, WallLaw::PerLength] {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.contact.law = law;
        scenario.mud = None;
        scenario.string.gauges.clear();
        scenario.string.unbalance.clear();
        (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
        let station =
            |measured_depth| SurveyStation { measured_depth, inclination_deg: 90.0, azimuth_deg: 0.0 };
        scenario.well.survey = vec![station(0.0), station(200.0)];
        let (upper, lower) = (0.4, 0.1);
        scenario.well.section =
            vec![section(0.0, None, Some([upper, 0.1])), section(100.0, Some(0.25), Some([lower, lower]))];
        let (model, equilibrium) = rest(&scenario);
        let nodes = model.mesh.nodes.iter().zip(&equilibrium.normal_force);
        let torque: f64 = nodes
            .map(|(node, force)| {
                // The edge of the narrower hole carries the string.
                let friction = if node.measured_depth <= 100.0 { upper } else { lower };
                friction * force * node.contact_radius
            })
            .sum();
        let found = equilibrium.torque[0].abs();
        assert!((found / torque - 1.0).abs() < 5e-3, "{law:?}: {found} against {torque}");
        // Pipe in the wider hole lies lower by half the difference of the diameters.
        let depth = |at: f64| {
            let [u, v, ..] = equilibrium.displacement[model.mesh.nearest_node(at)];
            u.hypot(v)
        };
        let step = depth(150.0) - depth(95.0);
        let wall = 0.5 * (0.25 - 0.2159);
        assert!((step - wall).abs() < 2e-3, "{law:?}: {step} against {wall}");
    }
}

#[test]
fn a_section_without_friction_next_to_one_with_it_runs() {
    let mut scenario = short(WallLaw::PerNode);
    for law in [WallLaw::PerNode, WallLaw::PerLength] {
        scenario.contact.law = law;
        scenario.well.section = vec![section(20.3, None, Some([0.0, 0.0])), section(150.3, None, None)];
        let records = run(&scenario);
        assert!(records.histories.iter().all(|history| history.u.iter().all(|value| value.is_finite())));
    }
}
