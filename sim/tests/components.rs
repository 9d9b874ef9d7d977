//! Components by a tally: mass of their own, tubes that carry loads, blades.

use std::f64::consts::{FRAC_PI_4, PI};

use drillsweep_scenario::{
    Effect, Gauge, Material, Scenario, Section, SectionKind, SurveyStation, Switch, preset,
};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{Mode, ModeKind, ModeSearch, modes};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;

const GRAVITY: f64 = 9.81;
const POUND: f64 = 0.453_592_37;
const STEEL: Material =
    Material { youngs_modulus: 2.06e11, density: 7850.0, poissons_ratio: 0.3, grade: None };

/// Component of a published tally: length \[m\], weight in air \[lb\], diameters \[mm\], diameter of the blades \[in\].
type Component = (&'static str, f64, f64, [f64; 2], Option<f64>);

/// 12 1/4 in motor assembly from the top (Open-Source-Drilling-Community/Dixit-Drillstring-Model-2023, `drillsim-main/EM_drill_sim_input_sheet.xlsx`).
const TALLY: [Component; 10] = [
    ("transition collar", 9.32, 6759.0, [244.0, 77.0], None),
    ("filter sub", 2.53, 1841.0, [246.0, 82.0], None),
    ("float sub", 1.14, 816.0, [241.0, 72.0], None),
    ("string stabilizer", 1.56, 974.0, [242.0, 77.0], Some(12.125)),
    ("pony", 3.68, 2670.0, [246.0, 83.0], None),
    ("MWD", 8.59, 5315.0, [233.0, 108.0], None),
    ("in-line stabilizer", 1.51, 942.0, [241.0, 102.0], Some(12.125)),
    ("LWD", 5.81, 3813.0, [233.0, 109.0], None),
    ("motor", 8.65, 4497.0, [231.0, 171.45], Some(12.125)),
    ("bit", 0.41, 349.0, [202.0, 72.0], Some(12.25)),
];

fn component(&(name, length, weight, [outer, inner], blades): &Component) -> Section {
    let kind = match name {
        "bit" => SectionKind::Bit,
        name if name.contains("stabilizer") => SectionKind::Stabilizer,
        _ => SectionKind::Collar,
    };
    Section {
        name: name.to_owned(),
        mass_per_length: Some(weight * POUND / length),
        blade_diameter: blades.map(|inches| inches * 0.0254),
        ..Section::plain(kind, length, 1e-3 * outer, 1e-3 * inner)
    }
}

/// Sections in a vertical dry hole of 12 1/4 in, without loads at the bit.
fn vertical(sections: Vec<Section>) -> Scenario {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.mud = None;
    scenario.well.hole_diameter = 12.25 * 0.0254;
    let length = sections.iter().map(Section::whole_length).sum();
    scenario.well.survey = [0.0, length]
        .map(|measured_depth| SurveyStation { measured_depth, inclination_deg: 0.0, azimuth_deg: 0.0 })
        .to_vec();
    scenario.string.material = STEEL;
    scenario.string.sections = sections;
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.recording.nodes.clear();
    (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
    scenario
}

#[test]
fn a_hanging_assembly_weighs_what_its_tally_says() {
    let scenario = vertical(TALLY.iter().map(component).collect());
    validate(&scenario).expect("valid");
    let expected: f64 = TALLY.iter().map(|component| component.2 * POUND).sum();
    let in_air: f64 = scenario.string.sections.iter().map(|section| scenario.string.mass(section)).sum();
    assert!((in_air / expected - 1.0).abs() < 1e-13);
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("an equilibrium");
    // The tension of an element is that of its middle.
    let first = &model.mesh.elements[0];
    let above = 0.5 * first.length * scenario.string.body(&scenario.string.sections[0]).mass_per_length();
    let found = equilibrium.tension[0] / GRAVITY + above;
    assert!((found / expected - 1.0).abs() < 1e-8, "{found} kg, not {expected}");
}

/// Modes up to 30 Hz of one bare collar, held at its top.
fn modes_of(section: Section) -> Vec<Mode> {
    let mut scenario = vertical(vec![section]);
    scenario.operation.rotation_speed_rpm = 0.0;
    scenario.damping.mass_proportional = 0.0;
    scenario.damping.stiffness_proportional = 0.0;
    for effect in [Effect::Contact, Effect::Gravity] {
        scenario.effects.set(effect, Switch::Off);
    }
    scenario.effects.set(Effect::Torsion, Switch::On);
    scenario.mesh.lengths_mut().expect("has target lengths").collar = 0.5;
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("an equilibrium");
    modes(&model, &equilibrium, &ModeSearch { to_hz: 30.0, ..ModeSearch::default() }).expect("modes").modes
}

#[test]
fn frequencies_are_those_of_the_tube_that_carries_and_of_the_mass() {
    let (length, outer, inner, mass) = (30.0, 0.2, 0.08, 310.0);
    let collar = Section {
        mass_per_length: Some(mass),
        stiffness_outer_diameter: Some(outer),
        stiffness_inner_diameter: Some(inner),
        ..Section::plain(SectionKind::Collar, length, 0.24, 0.1)
    };
    let found = modes_of(collar);
    let of = |kinds: &[ModeKind]| -> Vec<f64> {
        found.iter().filter(|mode| kinds.contains(&mode.kind)).map(|mode| mode.frequency_hz).collect()
    };
    // A rod that is held at one end turns at c / (4 L), c^2 = G I_p / (m I_p / S) with the mass in the tube.
    let area = FRAC_PI_4 * (outer * outer - inner * inner);
    let shear_modulus = STEEL.youngs_modulus / 2.6;
    let torsional = (shear_modulus * area / mass).sqrt() / (4.0 * length);
    let turning = of(&[ModeKind::Torsional])[0];
    assert!((turning / torsional - 1.0).abs() < 1e-3, "{turning} Hz, not {torsional}");
    // And bends as a cantilever, 1.8751^2 / (2 pi L^2) (E I / m)^(1/2); shear and rotary inertia lower it by less than 1e-3.
    let second_moment = PI / 64.0 * (outer.powi(4) - inner.powi(4));
    let bending = 1.875_104_f64.powi(2) / (2.0 * PI * length * length)
        * (STEEL.youngs_modulus * second_moment / mass).sqrt();
    let lateral = found
        .iter()
        .filter(|mode| ![ModeKind::Axial, ModeKind::Torsional].contains(&mode.kind))
        .map(|mode| mode.frequency_hz)
        .fold(f64::INFINITY, f64::min);
    assert!((lateral / bending - 1.0).abs() < 1e-3, "{lateral} Hz, not {bending}");
}

#[test]
fn blades_are_the_gauges_that_they_stand_for() {
    let bladed = vertical(TALLY.iter().map(component).collect());
    let mut listed = bladed.clone();
    let mut top = 0.0;
    for section in &mut listed.string.sections {
        let bottom = top + section.length;
        if let Some(diameter) = section.blade_diameter.take() {
            let measured_depth =
                if section.kind == SectionKind::Bit { bottom } else { top + 0.5 * section.length };
            let clearance = (0.5 * (listed.well.hole_diameter - diameter)).max(1e-4);
            listed.string.gauges.push(Gauge::at(measured_depth, clearance));
        }
        top = bottom;
    }
    assert_eq!(listed.string.gauges.len(), 4);
    let clearances = |scenario: &Scenario| -> Vec<(f64, f64)> {
        let mesh = Model::new(scenario).expect("valid").mesh;
        let gauges = mesh.nodes.iter().filter(|node| node.is_gauge);
        gauges.map(|node| (node.measured_depth, node.clearance)).collect()
    };
    let (found, expected) = (clearances(&bladed), clearances(&listed));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found.0 - expected.0).abs() < 1e-12 && (found.1 - expected.1).abs() < 1e-15);
    }
}

#[test]
fn impossible_components_are_refused_at_their_field() {
    let refused = |change: &dyn Fn(&mut Section)| -> Vec<String> {
        let mut sections: Vec<Section> = TALLY.iter().map(component).collect();
        change(&mut sections[8]);
        let problems = validate(&vertical(sections)).err().into_iter().flat_map(|problems| problems.0);
        problems.map(|problem| problem.path.replace("string.sections[8].", "")).collect()
    };
    assert_eq!(refused(&|_| ()), [""; 0]);
    assert_eq!(refused(&|s| s.mass_per_length = Some(0.0)), ["mass_per_length"]);
    assert_eq!(refused(&|s| s.mass_per_length = Some(1000.0)), ["mass_per_length"], "denser than any solid");
    assert_eq!(refused(&|s| s.stiffness_inner_diameter = Some(0.25)), ["stiffness_inner_diameter"]);
    assert_eq!(refused(&|s| s.stiffness_outer_diameter = Some(-0.1)), ["stiffness_outer_diameter"]);
    assert_eq!(refused(&|s| s.blade_diameter = Some(0.32)), ["blade_diameter"]);
    assert_eq!(refused(&|s| s.blade_diameter = Some(0.2)), ["blade_diameter"]);
    assert_eq!(refused(&|s| s.blade_above_end = Some(9.0)), ["blade_above_end"]);
}
