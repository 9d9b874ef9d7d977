//! Equilibria of strings that move along the hole, compared with the soft string, closed forms and an independent computation.

use std::f64::consts::{FRAC_PI_2, PI};

use drillsweep_scenario::{
    Effect, Scenario, Section, SectionKind, StartFriction, SurveyStation, Switch, preset,
};
use drillsweep_sim::math::dof::{DOFS, W};
use drillsweep_sim::solve::model::{GRAVITY, Model};
use drillsweep_sim::solve::modes::{ModeSearch, ModesError, modes};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::string::beam::BeamSection;
use drillsweep_sim::validation::validate;

fn equilibrium(scenario: &Scenario) -> Equilibrium {
    validate(scenario).expect("valid");
    Equilibrium::find(&Model::new(scenario).expect("valid")).expect("found")
}

/// A scenario in equilibrium only, off bottom.
fn off_bottom(name: &str) -> Scenario {
    let mut scenario = preset(name).expect("shipped preset");
    scenario.effects.set(Effect::Transient, Switch::Off);
    (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
    scenario
}

fn moving(mut scenario: Scenario, axial_speed: f64, rotation_speed_rpm: f64) -> Scenario {
    (scenario.operation.axial_speed, scenario.operation.rotation_speed_rpm) =
        (axial_speed, rotation_speed_rpm);
    scenario
}

/// Pipe without mud in a hole of given stations.
fn dry_pipe(survey: &[(f64, f64)], element: f64, hole_diameter: f64) -> Scenario {
    let mut scenario = off_bottom("paper-200m");
    scenario.mud = None;
    let station = |&(measured_depth, inclination_deg)| SurveyStation {
        measured_depth,
        inclination_deg,
        azimuth_deg: 0.0,
    };
    scenario.well.survey = survey.iter().map(station).collect();
    scenario.well.hole_diameter = hole_diameter;
    let length = survey.last().expect("stations").0;
    scenario.string.sections = vec![Section::plain(SectionKind::Collar, length, 0.127, 0.108)];
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.recording.nodes.clear();
    scenario.mesh.lengths_mut().expect("has target lengths").collar = element;
    scenario
}

/// Tension \[kN\] at the top of the base case: that of the uppermost element, 0.6 m long, with half its buoyed weight.
fn top_tension(scenario: &Scenario) -> f64 {
    let model = Model::new(scenario).expect("valid");
    let half = -0.5 * model.elements[0].load[W] - 0.5 * model.elements[0].load[DOFS + W];
    1e-3 * (equilibrium(scenario).tension[0] - half)
}

/// The tensions of an independent finite-element program.
#[test]
fn the_base_case_moves_at_the_tensions_of_an_independent_computation() {
    for (axial_speed, rotation_speed_rpm, tension) in [
        (0.0, 120.0, 12.00),
        (-0.3, 0.0, 48.99),
        (0.3, 0.0, -34.78),
        (-0.3, 120.0, 22.22),
        (0.3, 120.0, 1.07),
    ] {
        let found = top_tension(&moving(off_bottom("paper-200m"), axial_speed, rotation_speed_rpm));
        assert!((found - tension).abs() < 0.01, "{axial_speed} m/s, {rotation_speed_rpm} rpm: {found} kN");
    }
    let mut sliding = moving(off_bottom("paper-200m"), 0.3, 0.0);
    sliding.operation.weight_on_bit = -3e4;
    let found = top_tension(&sliding);
    assert!((found + 71.23).abs() < 0.01, "{found} kN");
}

#[test]
fn an_inclined_straight_pipe_moves_at_the_tension_of_its_closed_form() {
    let pipe = || dry_pipe(&[(0.0, 60.0), (1000.0, 60.0)], 2.5, 0.216);
    let section = BeamSection::pipe(0.127, 0.108, &pipe().string.material);
    let weight = section.density * section.area * GRAVITY;
    let (along, across, mu) = (0.5 * weight, 0.75_f64.sqrt() * weight, 0.3);
    for (axial_speed, rotation_speed_rpm) in [(-0.3, 0.0), (0.3, 0.0), (0.3, 120.0)] {
        let surface_speed = rotation_speed_rpm * PI / 30.0 * 0.0635;
        let speed = f64::hypot(axial_speed, surface_speed);
        // Friction about the axis moves the pipe up the wall, until its side force is across / sqrt(1 + mu_t^2).
        let side = across / (mu * surface_speed / speed).hypot(1.0);
        let tension = along - mu * side * axial_speed / speed;
        let torque = -mu * side * 0.0635 * surface_speed / speed;
        // The clamped top carries some metres of pipe.
        let found = equilibrium(&moving(pipe(), axial_speed, rotation_speed_rpm));
        let a_metre = |values: &[f64]| (values[40] - values[360]) / 800.0;
        let (found, found_torque) = (a_metre(&found.tension), a_metre(&found.torque));
        let scale = 1e-3 * mu * across;
        assert!((found - tension).abs() < scale, "{found} N/m, not {tension}");
        assert!((found_torque - torque).abs() < scale * 0.0635, "{found_torque} N m/m, not {torque}");
    }
}

#[test]
fn a_weightless_pipe_in_a_bend_is_a_capstan() {
    let length = 300.0;
    for axial_speed in [-0.3, 0.3] {
        let mut pipe = dry_pipe(&[(0.0, 0.0), (length, 90.0)], 1.0, 0.131);
        pipe.effects.set(Effect::Gravity, Switch::Off);
        pipe.operation.weight_on_bit = 5e4;
        let found = equilibrium(&moving(pipe, axial_speed, 0.0)).tension;
        // The free end has no bending moment: next to it, forces that bend the pipe to the hole add friction.
        let turn = 200.0 / length * FRAC_PI_2;
        let expected = (-axial_speed.signum() * 0.3 * turn).exp();
        let ratio = found[50] / found[250];
        assert!((ratio / expected - 1.0).abs() < 1e-3, "{axial_speed} m/s: {ratio}, not {expected}");
    }
}

#[test]
fn an_axial_speed_is_for_equilibria_alone() {
    let scenario = moving(preset("paper-200m").unwrap(), 0.3, 120.0);
    let problems = validate(&scenario).unwrap_err();
    assert!(problems.to_string().contains("effects.transient"), "{problems}");
    let still = moving(off_bottom("paper-200m"), 0.3, 120.0);
    let model = Model::new(&still).unwrap();
    let found = modes(&model, &Equilibrium::find(&model).unwrap(), &ModeSearch::default());
    assert_eq!(found.unwrap_err(), ModesError::AxialSpeed { speed: 0.3 });
}

#[test]
fn a_sliding_string_meets_the_friction_of_its_axial_speed() {
    let mut sliding = moving(off_bottom("paper-200m"), -0.7, 0.0);
    sliding.statics.friction = StartFriction::Sliding;
    let (mu_s, mu_d, v_ref, speed): (f64, f64, f64, f64) = (0.3, 0.2, 0.033, 0.7);
    // Without rotation every node slides as fast, so that a constant coefficient of (14) gives the same string.
    let xi = (1.0 - mu_d / mu_s).sqrt();
    let run = 1.0 + (1.0 - xi) / (2.0 * v_ref * mu_d) * speed;
    let mu = speed / (2.0 * v_ref) * ((1.0 + xi) / (run * run) + (1.0 - xi) / run);
    assert!((0.21..0.25).contains(&mu), "{mu}");
    let mut constant = moving(off_bottom("paper-200m"), -0.7, 0.0);
    (constant.contact.static_friction, constant.contact.dynamic_friction) = (mu, mu);
    let (sliding, constant) = (top_tension(&sliding), top_tension(&constant));
    assert!((sliding / constant - 1.0).abs() < 1e-9, "{sliding} kN, {constant} kN");
}
