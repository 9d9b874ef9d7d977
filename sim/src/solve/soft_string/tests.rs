use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use drillsweep_scenario::{
    Grade, HoleSection, Material, Mud, Scenario, Section, SectionKind, SurveyStation, preset,
};
use nalgebra::Vector3;

use super::*;
use crate::string::well::WellPath;

const POUND: f64 = 4.448_221_615_260_5;
const FOOT: f64 = 0.3048;

fn station(measured_depth: f64, inclination_deg: f64, azimuth_deg: f64) -> SurveyStation {
    SurveyStation { measured_depth, inclination_deg, azimuth_deg }
}

/// One pipe of 5 in by 4.276 in of a weight \[N/m\] in a dry hole, to the end of the survey.
fn pipe(survey: Vec<SurveyStation>, weight: f64) -> Scenario {
    let mut scenario = preset("paper-200m").unwrap();
    let (outer_diameter, inner_diameter) = (0.127, 0.108_610_4);
    let area = FRAC_PI_2 / 2.0 * (outer_diameter * outer_diameter - inner_diameter * inner_diameter);
    scenario.string.material.density = weight / 9.81 / area;
    scenario.string.sections = vec![Section::plain(
        SectionKind::Drillpipe,
        survey.last().unwrap().measured_depth,
        outer_diameter,
        inner_diameter,
    )];
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.mud = None;
    scenario.well.survey = survey;
    (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
    scenario
}

fn at(mode: DragMode, string: &SoftString, friction: f64) -> DragCase {
    DragCase { mode, bit_depth: string.bit_depth(), friction: Some(friction) }
}

fn forces(scenario: &Scenario, mode: DragMode, friction: f64) -> DragResult {
    let string = SoftString::new(scenario).unwrap();
    string.forces(&at(mode, &string, friction), &DragSettings::default()).unwrap()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() <= relative, "{found} instead of {expected}");
}

/// Forces at the top of a string with a bit load \[N\], moved along a shares of friction up the string, by Heun's method with small steps on the axis of the
/// hole, whose curvature comes from differences of the tangent: shares no formula with the arcs.
fn by_small_steps(
    scenario: &Scenario,
    [weight, bit]: [f64; 2],
    [drag, turn]: [f64; 2],
    steps: u32,
) -> [f64; 3] {
    let path = WellPath::new(&scenario.well).unwrap();
    let length: f64 = scenario.well.survey.last().unwrap().measured_depth;
    let step = length / f64::from(steps);
    let side_force = |depth: f64, tension: f64| {
        let away = 1e-3;
        let tangent = path.tangent(depth);
        let curvature = (path.tangent(depth + away) - path.tangent(depth - away)) / (2.0 * away);
        let down = Vector3::new(0.0, 0.0, weight);
        let across = down - tangent * down.dot(&tangent) + curvature * tension;
        (tangent.z, across.norm())
    };
    let (mut tension, mut torque, mut total) = (bit, 0.0, 0.0);
    for i in 0..steps {
        // Off the stations, where the curvature jumps.
        let depth = length - step * f64::from(i);
        let (z, n) = side_force(depth - 0.01 * step, tension);
        let first = weight * z + drag * n;
        let (z, m) = side_force(depth - 0.99 * step, tension + step * first);
        tension += 0.5 * step * (first + weight * z + drag * m);
        torque += 0.5 * step * turn * (n + m);
        total += 0.5 * step * (n + m);
    }
    [tension, torque, total]
}

#[test]
fn the_two_station_example_has_its_forces() {
    // 6,750 to 7,050 ft, 30.9 deg 78.2 deg to 43.2 deg 100.6 deg, 16 lbf/ft, mu 0.3, 25,000 lbf below.
    let survey = vec![station(0.0, 30.9, 78.2), station(300.0 * FOOT, 43.2, 100.6)];
    let mut scenario = pipe(survey, 16.0 * POUND / FOOT);
    scenario.operation.weight_on_bit = 25_000.0 * POUND;
    let string = SoftString::new(&scenario).unwrap();
    let laid = string.laid(string.bit_depth()).unwrap();
    for (mode, drag, tension, side_force) in [
        (DragMode::PickUp, 0.3, 30_987.0, 7_152.0),
        (DragMode::Rotate, 0.0, 28_841.0, 6_850.0),
        (DragMode::SlackOff, -0.3, 26_871.0, 6_565.0),
    ] {
        let motion = mode.motion(&string.operation, &DragSettings::default()).unwrap();
        let top = laid.forces(&[0.3], &motion, [scenario.operation.weight_on_bit, 0.0], |_, _| {});
        assert_near(top.tension / POUND, tension, 5e-5);
        assert_near(top.side_force / POUND, side_force, 1e-4);
        // The second way: small steps, whose error falls with their square to 1e-9.
        let weight = 16.0 * POUND / FOOT;
        let [fine, _, total] = by_small_steps(&scenario, [weight, 25_000.0 * POUND], [drag, 0.0], 40_000);
        assert_near(top.tension, fine, 1e-8);
        assert_near(top.side_force, total, 1e-7);
    }
}

#[test]
fn a_weightless_string_is_a_capstan() {
    // In an arc that also turns in azimuth, as in one plane: the tension grows by exp(mu theta), theta the whole turn.
    let survey = vec![station(0.0, 20.0, 10.0), station(300.0, 60.0, 130.0), station(500.0, 90.0, 100.0)];
    let mut scenario = pipe(survey, 300.0);
    scenario.effects.gravity = drillsweep_scenario::Switch::Off;
    (scenario.operation.weight_on_bit, scenario.operation.rotation_speed_rpm) = (5e4, 120.0);
    let string = SoftString::new(&scenario).unwrap();
    let path = WellPath::new(&scenario.well).unwrap();
    let turn = [(0.0, 300.0), (300.0, 500.0)]
        .map(|(top, bottom)| path.tangent(top).dot(&path.tangent(bottom)).acos())
        .iter()
        .sum::<f64>();
    assert!(turn > 1.5);
    let laid = string.laid(500.0).unwrap();
    let top = |mode: DragMode| {
        let motion = mode.motion(&string.operation, &DragSettings::default()).unwrap();
        laid.forces(&[0.3], &motion, [5e4, 0.0], |_, _| {})
    };
    assert_near(top(DragMode::PickUp).tension, 5e4 * (0.3 * turn).exp(), 1e-10);
    assert_near(top(DragMode::SlackOff).tension, 5e4 * (-0.3 * turn).exp(), 1e-10);
    // Rotating: the tension stays, the torque is mu R T theta.
    assert_near(top(DragMode::Rotate).tension, 5e4, 1e-14);
    assert_near(top(DragMode::Rotate).torque, 0.3 * 0.0635 * 5e4 * turn, 1e-10);
}

#[test]
fn an_inclined_straight_string_has_its_closed_forms() {
    let (weight, length, angle) = (284.0, 1000.0, FRAC_PI_3);
    let mut scenario = pipe(vec![station(0.0, 60.0, 0.0), station(length, 60.0, 0.0)], weight);
    scenario.operation.rotation_speed_rpm = 120.0;
    let (along, across) = (weight * length * angle.cos(), weight * length * angle.sin());
    let mu = 0.3;
    assert_near(forces(&scenario, DragMode::PickUp, mu).hook_load, along + mu * across, 1e-12);
    assert_near(forces(&scenario, DragMode::SlackOff, mu).hook_load, along - mu * across, 1e-12);
    let rotating = forces(&scenario, DragMode::Rotate, mu);
    assert_near(rotating.hook_load, along, 1e-12);
    assert_near(rotating.surface_torque, mu * across * 0.0635, 1e-12);
    // Down with 0.3 m/s at 120 rpm: friction along the velocity (Omega R, V) of the surface.
    let string = SoftString::new(&scenario).unwrap();
    let settings = DragSettings { axial_speed: Some(0.3), travelling_weight: 2e5 };
    let reaming = string.forces(&at(DragMode::Ream, &string, mu), &settings).unwrap();
    let surface = 4.0 * std::f64::consts::PI * 0.0635;
    let speed = f64::hypot(0.3, surface);
    assert_near(reaming.hook_load, 2e5 + along - mu * across * 0.3 / speed, 1e-12);
    assert_near(reaming.surface_torque, mu * across * 0.0635 * surface / speed, 1e-12);
    let error = string.forces(&at(DragMode::Ream, &string, mu), &DragSettings::default());
    assert_eq!(error, Err(SoftStringError::NoAxialSpeed));
}

#[test]
fn a_build_section_has_the_tension_of_its_linear_equation() {
    // Vertical plane, the string on the inside all along: dT/dtheta = -w R cos theta - mu (T - w R sin theta), from horizontal at the bit to vertical.
    let (weight, radius, mu, bit) = (284.0, 300.0, 0.25, 3e5);
    let scenario = pipe(vec![station(0.0, 0.0, 0.0), station(FRAC_PI_2 * radius, 90.0, 0.0)], weight);
    let string = SoftString::new(&scenario).unwrap();
    let laid = string.laid(string.bit_depth()).unwrap();
    let load = weight * radius;
    // T = a cos theta + b sin theta + c exp(-mu theta), with a = -2 mu w R / (1 + mu^2), b = (mu^2 - 1) w R / (1 + mu^2).
    let (a, b) = (-2.0 * mu * load / (1.0 + mu * mu), (mu * mu - 1.0) * load / (1.0 + mu * mu));
    let c = (bit - b) * (mu * FRAC_PI_2).exp();
    let motion = DragMode::PickUp.motion(&string.operation, &DragSettings::default()).unwrap();
    assert_near(laid.forces(&[mu], &motion, [bit, 0.0], |_, _| {}).tension, a + c, 1e-9);
}

#[test]
fn a_string_that_changes_sides_agrees_with_small_steps() {
    // A drop below a build: little tension at the bit, much at the top, so that the string passes from the low to the high side.
    let survey = vec![
        station(0.0, 0.0, 0.0),
        station(400.0, 0.0, 0.0),
        station(900.0, 55.0, 30.0),
        station(1500.0, 20.0, 350.0),
        station(1900.0, 20.0, 350.0),
    ];
    let scenario = pipe(survey, 284.0);
    for (mode, drag) in [(DragMode::PickUp, 0.3), (DragMode::SlackOff, -0.3), (DragMode::Rotate, 0.0)] {
        let result = forces(&scenario, mode, 0.3);
        let turn = if mode == DragMode::Rotate { 0.3 * 0.0635 } else { 0.0 };
        let [tension, torque, side_force] = by_small_steps(&scenario, [284.0, 0.0], [drag, turn], 400_000);
        assert_near(result.hook_load, tension, 1e-6);
        assert_near(result.side_force, side_force, 1e-5);
        assert!((result.surface_torque - torque).abs() <= 1e-5 * torque);
        assert_eq!(result.profile.first().unwrap().measured_depth, 0.0);
        assert_eq!(result.profile.last().unwrap().tension, 0.0);
        assert!(result.profile.windows(2).all(|pair| pair[0].measured_depth < pair[1].measured_depth));
    }
}

#[test]
fn a_shortened_string_loses_pipe_at_its_top() {
    let mut scenario = pipe(vec![station(0.0, 0.0, 0.0), station(1000.0, 0.0, 0.0)], 200.0);
    scenario.string.sections[0].length = 900.0;
    let collar = Section {
        length: 100.0,
        inner_diameter: 0.05,
        kind: SectionKind::Collar,
        ..scenario.string.sections[0].clone()
    };
    scenario.string.sections.push(collar);
    let string = SoftString::new(&scenario).unwrap();
    let hook_load = |bit_depth: f64| {
        let case = DragCase { mode: DragMode::Rotate, bit_depth, friction: Some(0.2) };
        string.forces(&case, &DragSettings::default()).unwrap().hook_load
    };
    let collar_weight = hook_load(100.0);
    assert_near(hook_load(1000.0) - collar_weight, 900.0 * 200.0, 1e-12);
    assert_near(hook_load(350.0) - collar_weight, 250.0 * 200.0, 1e-12);
    assert_near(hook_load(50.0), 0.5 * collar_weight, 1e-12);
    for bit_depth in [0.0, -1.0, 1000.1, f64::NAN] {
        let case = DragCase { mode: DragMode::Rotate, bit_depth, friction: None };
        let error = string.forces(&case, &DragSettings::default()).unwrap_err();
        assert!(matches!(error, SoftStringError::BitDepth { .. }), "{error}");
    }
    let case = DragCase { mode: DragMode::Rotate, bit_depth: 10.0, friction: Some(-0.1) };
    assert_eq!(string.forces(&case, &DragSettings::default()), Err(SoftStringError::Friction(-0.1)));
}

#[test]
fn weight_is_buoyed_as_in_the_model() {
    let mut scenario = preset("paper-200m").unwrap();
    scenario.mud.as_mut().unwrap().flow_rate = 0.0;
    let model = crate::solve::model::Model::new(&scenario).unwrap();
    let weight: f64 = model.elements.iter().map(|element| element.axial_weight).sum();
    // Chords are shorter than arcs.
    assert_near(forces(&scenario, DragMode::Rotate, 0.0).hook_load, weight, 1e-4);
}

/// The path of Equinor's well Volve 15/9-F-12 (open data, planned path) with pipe without joints, heavy-weight pipe with.
fn volve() -> Scenario {
    let mut scenario = preset("paper-200m").unwrap();
    let survey = "0 0 0 284 0 0 300 .53 45 330 1.53 45 360 2.53 45 390 3.53 45 420 4.53 45 450 5.53 45 480 6.53 45 510 7.53 45 524 8 45 540 7.01 41.92 \
        570 5.24 33.08 600 3.71 16.26 630 2.85 344.07 660 3.22 306.21 690 4.55 283.62 720 6.24 272.16 750 8.08 265.73 780 9.98 261.69 810 11.91 258.94 \
        840 13.86 256.96 870 15.82 255.45 892.38 17.29 254.55 1081.87 17.29 254.55 1110 19.17 254.52 1132.05 20.64 254.49 1935.32 20.64 254.49 \
        1950 19.75 253.27 1980 17.97 250.43 2010 16.25 247 2040 14.59 242.79 2070 13.02 237.56 2100 11.59 231 2130 10.34 222.76 2160 9.36 212.56 \
        2190 8.73 200.46 2220 8.52 187.16 2250 8.78 173.95 2280 9.46 162.04 2310 10.48 152.07 2340 11.75 144.04 2370 13.2 137.65 2400 14.77 132.56 \
        2430 16.44 128.45 2460 18.18 125.09 2490 19.96 122.31 2520 21.78 119.97 2550 23.62 117.97 2580 25.49 116.25 2594 26.37 115.53 2610 27.38 114.76 \
        2640 29.28 113.44 2670 31.19 112.27 2700 33.11 111.22 2730 35.04 110.28 2760 36.97 109.42 2790 38.91 108.63 2820 40.86 107.91 2850 42.81 107.25 \
        2880 44.76 106.63 2910 46.72 106.05 2940 48.68 105.51 2970 50.64 105 3000 52.61 104.51 3012.59 53.43 104.32 3438 53.43 104.32";
    let numbers: Vec<f64> = survey.split_whitespace().map(|number| number.parse().unwrap()).collect();
    scenario.well.survey = numbers.chunks(3).map(|row| station(row[0], row[1], row[2])).collect();
    scenario.string.material =
        Material { youngs_modulus: 2.06e11, density: 7850.0, poissons_ratio: 0.3, grade: None };
    let section = |kind, count, length, outer_diameter, inner_diameter| Section {
        count,
        ..Section::plain(kind, length, outer_diameter, inner_diameter)
    };
    use SectionKind::{Bit, Collar, Drillpipe, Stabilizer};
    let joint = drillsweep_scenario::ToolJoint {
        length: 0.6,
        outer_diameter: 0.168_275,
        inner_diameter: 0.077_787_5,
        material: None,
    };
    let heavy = Section { tool_joint: Some(joint), ..section(Drillpipe, 15, 9.3, 0.127, 0.0762) };
    let lower = [
        heavy,
        section(Collar, 1, 9.6, 0.1651, 0.06985),
        section(Collar, 3, 9.2, 0.1651, 0.071_437_5),
        section(Collar, 1, 9.2, 0.17145, 0.071_374),
        section(Stabilizer, 1, 1.5, 0.17145, 0.071_374),
        section(Collar, 1, 8.0, 0.17145, 0.0889),
        section(Collar, 1, 5.5, 0.17145, 0.071_374),
        section(Stabilizer, 1, 1.5, 0.17145, 0.071_374),
        section(Collar, 1, 3.0, 0.1397, 0.0762),
        section(Collar, 1, 4.1, 0.17145, 0.0508),
        section(Bit, 1, 0.3, 0.17145, 0.05715),
    ];
    let below: f64 = lower.iter().map(|section| f64::from(section.count) * section.length).sum();
    scenario.string.sections = vec![section(Drillpipe, 1, 3438.0 - below, 0.127, 0.108_610_4)];
    scenario.string.sections.extend(lower);
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    let mud = scenario.mud.unwrap();
    scenario.mud = Some(Mud { density: 1_258.177_486_65, flow_rate: 0.0, ..mud });
    (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (-88_964.432, -5_423.271_6);
    scenario
}

#[test]
fn volve_f12_agrees_with_two_independent_codes() {
    // They agree with each other to 0.05 %, in torque to 0.6 %; bodies of pipe turn on their own radius in them.
    let string = SoftString::new(&volve()).unwrap();
    let mut on_bodies = string.clone();
    for part in &mut on_bodies.parts {
        part.contact_radius = 0.5 * part.strength.outer_diameter();
    }
    let forces = |string: &SoftString, mode: DragMode, friction: f64| {
        string.forces(&at(mode, string, friction), &DragSettings::default()).unwrap()
    };
    for (mode, friction, hook_load, torque) in [
        (DragMode::Rotate, 0.25, 746.9, 13.61),
        (DragMode::PickUp, 0.25, 1_004.9, 0.0),
        (DragMode::SlackOff, 0.25, 573.8, 0.0),
        (DragMode::Rotate, 0.20, 746.91, 10.89),
        (DragMode::PickUp, 0.20, 944.0, 0.0),
        (DragMode::SlackOff, 0.20, 603.6, 0.0),
        (DragMode::Drill, 0.25, 657.9, 17.11),
        (DragMode::Drill, 0.20, 657.9, 14.77),
    ] {
        let result = forces(&on_bodies, mode, friction);
        assert_near(1e-3 * result.hook_load, hook_load, 5e-4);
        assert!((1e-3 * result.surface_torque - torque).abs() <= 6e-3 * torque, "{}", result.surface_torque);
        // Tool joints of the heavy-weight pipe carry it, at their larger radius.
        let on_joints = forces(&string, mode, friction);
        assert_eq!(on_joints.hook_load, result.hook_load);
        let more = on_joints.surface_torque / result.surface_torque;
        assert!(torque == 0.0 || (1.01..1.03).contains(&more), "{more}");
    }
    assert_near(1e-3 * forces(&string, DragMode::Drill, 0.25).side_force, 710.4, 1e-3);
    // Moved up and down with that weight on bit.
    assert_near(1e-3 * forces(&string, DragMode::Slide, 0.25).hook_load, 505.3, 5e-4);
    let up = DragMode::PickUp.motion(&string.operation, &DragSettings::default()).unwrap();
    let top = string.laid(string.bit_depth()).unwrap().forces(&[0.25], &up, [-88_964.432, 0.0], |_, _| {});
    assert_near(1e-3 * top.tension, 871.0, 5e-4);
}

#[test]
fn volve_f12_with_all_tool_joints_has_the_weight_of_another_code() {
    let mut scenario = volve();
    let joint = drillsweep_scenario::ToolJoint {
        length: 0.26,
        outer_diameter: 0.168_275,
        inner_diameter: 0.08255,
        material: None,
    };
    let plain = scenario.string.sections[0].clone();
    let jointed = Section { count: 336, length: 9.6, tool_joint: Some(joint), ..plain };
    scenario.string.sections[0].length -= 336.0 * 9.6;
    scenario.string.sections.insert(1, jointed);
    let result = forces(&scenario, DragMode::Rotate, 0.2);
    // The torque there is 12.3 kN m, with bodies on their own radius of 63.5 mm in place of the joints' 84.1 mm.
    assert_near(result.surface_torque, 12.3e3 * 0.168_275 / 0.127, 1e-2);
    assert_near(1e-3 * result.hook_load, 886.0, 1e-3);
}

#[test]
fn margins_are_those_of_the_sections() {
    let mut scenario = pipe(vec![station(0.0, 60.0, 0.0), station(1000.0, 60.0, 0.0)], 284.0);
    scenario.string.material.grade = Some(Grade::S135);
    (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (-2e5, -2e4);
    let result = forces(&scenario, DragMode::Drill, 0.3);
    // API RP 7G: 5 in, 0.362 in wall, S-135 new pipe: 712,070 lbf in tension.
    let (top, area) = (result.profile[0], 5.2746 * 0.0254 * 0.0254);
    let shear = result.surface_torque * 0.0635 / (FRAC_PI_2 * (0.0635_f64.powi(4) - 0.054_305_2_f64.powi(4)));
    let strength = 135_000.0 * POUND / (0.0254 * 0.0254);
    let stress = (top.tension / area).hypot(3_f64.sqrt() * shear);
    assert_near(top.yield_ratio.unwrap(), stress / strength, 1e-4);
    let overpull = area * (strength * strength - 3.0 * shear * shear).sqrt() - top.tension;
    assert_eq!(result.margins.make_up_ratio, None);
    scenario.string.sections[0].make_up_torque = Some(4e4);
    let made_up = forces(&scenario, DragMode::Drill, 0.3).margins.make_up_ratio.unwrap();
    assert_near(made_up.value, result.surface_torque / 4e4, 1e-12);
    assert_eq!(made_up.measured_depth, 0.0);
    let least = result.margins.overpull.unwrap();
    assert_near(least.value, overpull, 1e-4);
    assert_eq!(least.measured_depth, 0.0);
    let pulled = forces(&scenario, DragMode::PickUp, 0.3);
    assert_near(pulled.margins.overpull.unwrap().value + pulled.hook_load, 712_070.0 * POUND, 2e-4);
    // Dawson and Paslay: 2 sqrt(E I w sin I / r).
    let scenario_section = scenario.string.material;
    let inertia = std::f64::consts::PI / 64.0 * (0.127_f64.powi(4) - 0.108_610_4_f64.powi(4));
    let clearance = 0.5 * (scenario.well.hole_diameter - 0.127);
    let load = 2.0 * (scenario_section.youngs_modulus * inertia * 284.0 * FRAC_PI_3.sin() / clearance).sqrt();
    let buckling = result.margins.buckling_ratio.unwrap();
    assert_near(buckling.value, 2e5 / load, 1e-12);
    assert_eq!(buckling.measured_depth, 1000.0);
    assert_eq!(pulled.margins.buckling_ratio, None);
    scenario.string.material.grade = None;
    assert_eq!(forces(&scenario, DragMode::Drill, 0.3).margins.overpull, None);
}

/// Cased to a depth, and open below.
fn cased(to: f64, casing: f64, open: f64) -> Scenario {
    let mut scenario = volve();
    let section = |from: f64, friction: f64| HoleSection {
        name: String::new(),
        from,
        hole_diameter: None,
        static_friction: Some(friction),
        dynamic_friction: Some(friction),
    };
    scenario.well.section = vec![section(0.0, casing), section(to, open)];
    scenario
}

#[test]
fn friction_is_that_of_the_hole_section() {
    let string = SoftString::new(&cased(2594.0, 0.2, 0.3)).unwrap();
    let hook_load = |string: &SoftString, friction: Option<f64>, bit_depth: f64| {
        let case = DragCase { mode: DragMode::PickUp, bit_depth, friction };
        string.forces(&case, &DragSettings::default()).unwrap().hook_load
    };
    assert_eq!(hook_load(&string, None, 2500.0), hook_load(&string, Some(0.2), 2500.0));
    let deep = hook_load(&string, None, 3438.0);
    assert!(hook_load(&string, Some(0.2), 3438.0) < deep && deep < hook_load(&string, Some(0.3), 3438.0));
    // The lower part alone decides the tension at the shoe.
    let open = SoftString::new(&cased(2594.0, 0.3, 0.3)).unwrap();
    let at_shoe = |string: &SoftString| {
        let case = DragCase { mode: DragMode::PickUp, bit_depth: 3438.0, friction: None };
        let profile = string.forces(&case, &DragSettings::default()).unwrap().profile;
        profile.iter().find(|row| row.measured_depth == 2594.0).unwrap().tension
    };
    assert_eq!(at_shoe(&string), at_shoe(&open));
}

#[test]
fn a_broomstick_has_the_forces_of_its_cases() {
    let string = SoftString::new(&volve()).unwrap();
    let settings = DragSettings { travelling_weight: 3e5, axial_speed: None };
    let (modes, friction, depths) =
        ([DragMode::PickUp, DragMode::Rotate], [None, Some(0.3)], [1000.0, 2000.0, 3438.0]);
    let rows = string.broomstick(&modes, &friction, &depths, &settings).unwrap();
    assert_eq!(rows.len(), 12);
    let row = &rows[5];
    assert_eq!((row.mode, row.friction, row.bit_depth), (DragMode::PickUp, Some(0.3), 3438.0));
    for row in rows {
        let case = DragCase { mode: row.mode, bit_depth: row.bit_depth, friction: row.friction };
        let alone = string.forces(&case, &settings).unwrap();
        assert_eq!((alone.hook_load, alone.surface_torque), (row.hook_load, row.surface_torque));
        assert_eq!(alone.margins, row.margins);
    }
    let many = [1000.0; 5_001];
    let error = string.broomstick(&modes[..1], &friction[..1], &many, &settings);
    assert_eq!(error, Err(SoftStringError::TooManyCases(5_001)));
}

#[test]
fn fitted_friction_is_that_of_the_measured_string() {
    let truth = SoftString::new(&cased(2594.0, 0.2, 0.3)).unwrap();
    let settings = FitSettings::default();
    let measure = |bit_depth: f64, mode: DragMode| {
        let case = DragCase { mode, bit_depth, friction: None };
        let result = truth.forces(&case, &settings.drag).unwrap();
        let torque = matches!(mode, DragMode::Rotate).then_some(result.surface_torque);
        MeasuredPoint { bit_depth, mode, hook_load: Some(result.hook_load), torque }
    };
    let mut points = Vec::new();
    for depth in [1500.0, 2200.0, 2800.0, 3100.0, 3400.0] {
        points.extend(
            [DragMode::PickUp, DragMode::SlackOff, DragMode::Rotate].map(|mode| measure(depth, mode)),
        );
    }
    let string = SoftString::new(&cased(2594.0, 0.25, 0.25)).unwrap();
    let fit = string.fit_friction(&points, &settings).unwrap();
    assert_eq!(fit.friction.iter().map(|fitted| fitted.from).collect::<Vec<_>>(), [0.0, 2594.0]);
    for (fitted, friction) in fit.friction.iter().zip([0.2, 0.3]) {
        assert!((fitted.friction - friction).abs() < 1e-8, "{fitted:?}");
        assert!(fitted.standard_error.unwrap() < 1e-8);
    }
    // Hook loads and torques that scatter by 2 kN and 150 N m, in turn up and down.
    for (i, point) in points.iter_mut().enumerate() {
        let sign = if i * 7 % 4 < 2 { 1.0 } else { -1.0 };
        point.hook_load = point.hook_load.map(|load| load + sign * 2e3);
        point.torque = point.torque.map(|torque| torque - sign * 150.0);
    }
    let scattered = FitSettings { hook_load_deviation: 2e3, torque_deviation: 150.0, ..settings };
    let fit = string.fit_friction(&points, &scattered).unwrap();
    for (fitted, friction) in fit.friction.iter().zip([0.2, 0.3]) {
        let error = fitted.standard_error.unwrap();
        assert!(error < 0.01 && (fitted.friction - friction).abs() < 0.01, "{fitted:?}");
    }
    assert!((fit.reduced_deviation.unwrap() - 1.0).abs() < 0.2, "{fit:?}");
    assert_eq!(fit.residuals.len(), points.len());
    assert!(
        fit.residuals
            .iter()
            .zip(&points)
            .all(|(left, point)| left.torque.is_some() == point.torque.is_some())
    );
}

#[test]
fn a_fit_refuses_points_that_determine_nothing() {
    let string = SoftString::new(&cased(2594.0, 0.2, 0.3)).unwrap();
    let point = |bit_depth: f64, mode: DragMode| MeasuredPoint {
        bit_depth,
        mode,
        hook_load: Some(8e5),
        torque: None,
    };
    let fit = |points: &[MeasuredPoint]| string.fit_friction(points, &FitSettings::default());
    assert_eq!(fit(&[]), Err(FitError::Undetermined { measurements: 0, sections: 0 }));
    let one = fit(&[point(3000.0, DragMode::PickUp)]);
    assert_eq!(one, Err(FitError::Undetermined { measurements: 1, sections: 2 }));
    // The hook load of a rotating string does not depend on friction.
    let rotating = fit(&[point(2800.0, DragMode::Rotate), point(3000.0, DragMode::Rotate)]);
    assert_eq!(rotating, Err(FitError::Undetermined { measurements: 2, sections: 2 }));
    assert!(matches!(fit(&[point(4000.0, DragMode::PickUp); 2]), Err(FitError::Case { point: 0, .. })));
    let settings = FitSettings { torque_deviation: 0.0, ..FitSettings::default() };
    assert!(matches!(string.fit_friction(&[], &settings), Err(FitError::Number(_))));
}
