//! Loads of prescribed motions with closed forms, and of whole runs.

use std::f64::consts::TAU;

use drillsweep_scenario::{Accuracy, Integrator, Scenario, SurveyStation, TimeStepping, TimeWindow, preset};
use serde_json::{Value, json};

use super::{LoadBlocks, LoadRecords, Loads, Moment};
use crate::control::Control;
use crate::force::term::gravity::GRAVITY;
use crate::force::wall::ContactForces;
use crate::math::dof::{DOFS, Dofs, THETA_X, THETA_Y, THETA_Z, U, V, W};
use crate::math::linalg::NodalField;
use crate::solve::model::{Model, NodalVector};
use crate::solve::run::{Checkpoint, Outcome, Records, Transient};
use crate::solve::statics::Equilibrium;
use crate::solve::step::forces::Forces;

/// The base case's string without mud, in a hole of an inclination \[deg\] whose azimuth turns by `turn` \[deg\] in 200 m.
fn string(inclination_deg: f64, turn_deg: f64) -> Scenario {
    let mut scenario = preset("paper-200m").unwrap();
    scenario.well.survey = [0.0, 100.0, 200.0]
        .map(|measured_depth| SurveyStation {
            measured_depth,
            inclination_deg,
            azimuth_deg: measured_depth / 200.0 * turn_deg,
        })
        .to_vec();
    scenario.with("mud", Value::Null).unwrap()
}

/// Displacement, velocity and acceleration of a degree of freedom at a time, by node and degree of freedom.
type Motion<'a> = &'a dyn Fn(f64, usize, usize) -> [f64; 3];

/// Loads of a prescribed motion over `duration` \[s\], in steps of `h` \[s\], off the wall.
fn loads_of(model: &Model, [duration, h]: [f64; 2], motion: Motion<'_>) -> LoadRecords {
    let equilibrium = Equilibrium::find(model).unwrap();
    let rest: NodalVector = vec![[0.0; DOFS]; model.node_count()];
    let steps = (duration / h).round() as u64;
    let mut loads = Loads::new(model, &equilibrium, Dofs::ALL, &rest, (steps, None));
    let mut blocks = LoadBlocks::default();
    let system = model.dynamic_system(&equilibrium).reduced_to(Dofs::ALL);
    let wall = ContactForces::none(&Forces::new(model, &system).wall);
    for step in 0..=steps {
        let time = step as f64 * h;
        let [displacement, velocity, acceleration] = [0, 1, 2].map(|derivative| {
            let nodes = (0..model.node_count())
                .map(|node| std::array::from_fn(|dof| motion(time, node, dof)[derivative]))
                .collect::<Vec<[f64; DOFS]>>();
            NodalField::from_nodes(&nodes)
        });
        let moment = Moment {
            time,
            angle: model.drive.angle(time),
            displacement: &displacement,
            velocity: &velocity,
            acceleration: &acceleration,
            wall: &wall,
            peaks: &[],
        };
        if step == 0 {
            loads.start(&moment);
        } else {
            loads.observe(&moment, h, [step - 1, step], &mut blocks);
        }
    }
    loads.records(&blocks, TimeWindow { from: 0.0, to: duration })
}

fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value} against {expected}");
}

#[test]
fn a_circle_has_its_centripetal_acceleration_and_speed() {
    let model = Model::new(&string(30.0, 0.0)).unwrap();
    let (radius, offset) = (4e-3, 0.02);
    for whirl in [-3.0 * TAU, 2.5 * TAU] {
        let circle = move |time: f64, _: usize, dof: usize| {
            let (sin, cos) = (whirl * time).sin_cos();
            match dof {
                U => [offset + radius * cos, -radius * whirl * sin, -radius * whirl * whirl * cos],
                V => [radius * sin, radius * whirl * cos, -radius * whirl * whirl * sin],
                _ => [0.0; 3],
            }
        };
        let loads = loads_of(&model, [2.0, 1e-3], &circle);
        let node = &loads.nodes[7];
        let centripetal = radius * whirl * whirl;
        assert_near(node.lateral_acceleration.rms, centripetal, 1e-12);
        assert_near(node.lateral_acceleration.peak.value, centripetal, 1e-12);
        assert_near(node.orbit_radius_rms, radius, 1e-9);
        assert_near(node.orbit_whirl_speed, whirl, 1e-9);
        // About the axis, r^2 w of the circle is spread over the square of the whole distance.
        let squared = offset * offset + radius * radius;
        assert_near(node.whirl_speed, whirl * radius * radius / squared, 1e-9);
        assert_eq!(node.contact_fraction, 0.0);
        assert_eq!(loads.window, TimeWindow { from: 0.0, to: 2.0 });
    }
}

#[test]
fn a_whirl_about_the_axis_is_forward_or_backward_all_the_time() {
    let model = Model::new(&string(30.0, 0.0)).unwrap();
    for (whirl, share) in [(-7.0, 0.0), (7.0, 1.0)] {
        let circle = move |time: f64, _: usize, dof: usize| {
            let (sin, cos) = (whirl * time).sin_cos();
            match dof {
                U => [cos, -whirl * sin, -whirl * whirl * cos],
                V => [sin, whirl * cos, -whirl * whirl * sin],
                _ => [0.0; 3],
            }
        };
        let forward = loads_of(&model, [0.5, 1e-2], &circle).nodes[3].forward_fraction;
        assert!((forward - share).abs() < 1e-12, "{forward}");
    }
}

#[test]
fn a_still_pipe_reads_gravity_once_a_turn() {
    let inclination_deg: f64 = 40.0;
    let model = Model::new(&string(inclination_deg, 0.0)).unwrap();
    let turns = 4.0;
    let duration = turns * TAU / model.rotation_speed;
    let loads = loads_of(&model, [duration, duration / 4000.0], &|_, _, _| [0.0; 3]);
    let across = GRAVITY * inclination_deg.to_radians().sin();
    for node in &loads.nodes {
        assert_eq!(node.lateral_acceleration.rms, 0.0);
        assert_near(node.turning_acceleration.rms, across / 2_f64.sqrt(), 1e-9);
        // The peak lies at most half a step of 1/1000 turn off: (pi/1000)^2 / 2.
        assert_near(node.turning_acceleration.peak.value, across, 5e-6);
        assert_eq!(node.stick_fraction, Some(0.0));
        assert_eq!(node.stick_slip_severity(), Some(0.0));
    }
}

#[test]
fn a_bit_that_swings_about_its_speed_has_severity_and_sticks_for_its_share() {
    let model = Model::new(&string(30.0, 0.0)).unwrap();
    let (nominal, omega) = (model.rotation_speed, 2.0 * TAU);
    // Speed nominal (1 + a sin(omega t)).
    let a = 1.2;
    let swing = move |time: f64, _: usize, dof: usize| {
        let (sin, cos) = (omega * time).sin_cos();
        match dof {
            THETA_Z => [-a * nominal / omega * cos, a * nominal * sin, a * nominal * omega * cos],
            _ => [0.0; 3],
        }
    };
    let loads = loads_of(&model, [1.0, 1.0 / 8192.0], &swing);
    let bit = loads.nodes.last().unwrap();
    assert_near(bit.rotation_speed.mean, nominal, 1e-12);
    assert_near(bit.rotation_speed.largest, (1.0 + a) * nominal, 1e-12);
    assert_near(bit.rotation_speed.least, (1.0 - a) * nominal, 1e-12);
    assert_near(bit.stick_slip_severity().unwrap(), a, 1e-12);
    // sin < -(1 - 0.05) / a, to a step at each of the four ends.
    let share = 0.5 - (0.95 / a).asin() / std::f64::consts::PI;
    assert!((bit.stick_fraction.unwrap() - share).abs() < 4.0 / 8192.0);
    let radius = 0.5 * model.mesh.elements.last().unwrap().tube.outer_diameter;
    assert_near(bit.tangential_acceleration.rms, radius * a * nominal * omega / 2_f64.sqrt(), 1e-12);
    assert_near(bit.tangential_acceleration.peak.value, radius * a * nominal * omega, 1e-12);
}

#[test]
fn impacts_are_counted_once_a_rise() {
    let model = Model::new(&string(30.0, 0.0)).unwrap();
    // 30 g at its peaks, two of either sign in a period of 0.2 s.
    let (omega, peak) = (10.0 * std::f64::consts::PI, 30.0 * 9.806_65);
    let shaking = move |time: f64, _: usize, dof: usize| match dof {
        U => [0.0, 0.0, peak * (omega * time).sin()],
        _ => [0.0; 3],
    };
    let loads = loads_of(&model, [2.0, 1e-3], &shaking);
    assert_eq!(loads.nodes[5].shock_rates, [10.0, 0.0]);
}

#[test]
fn a_pipe_on_the_axis_of_a_curved_hole_bends_with_it() {
    let turn_deg: f64 = 50.0;
    let model = Model::new(&string(90.0, turn_deg)).unwrap();
    let curvature = turn_deg.to_radians() / 200.0;
    let loads = loads_of(&model, [0.1, 0.05], &|_, _, _| [0.0; 3]);
    for (element, loads) in model.elements.iter().zip(&loads.elements) {
        let section = element.beam.section();
        let moment = section.bending_stiffness() * curvature;
        // A chord against its arc: (kappa l)^2 / 24.
        let tolerance = (curvature * element.beam.length()).powi(2) / 24.0 + 1e-9;
        assert_near(loads.bending_moment.rms, moment, tolerance);
        assert_near(loads.bending_moment.peak.value, moment, tolerance);
        let stress = section.youngs_modulus * 0.5 * section.outer_diameter * curvature;
        assert_near(loads.bending_stress, stress, tolerance);
        assert_near(loads.equivalent_stress.value, stress, tolerance);
    }
}

#[test]
fn a_bent_pipe_that_turns_is_damaged_once_a_turn_and_one_that_whirls_with_it_is_not() {
    let turn_deg: f64 = 50.0;
    let with_grade = |turn_deg| {
        let scenario = string(90.0, turn_deg).with("string.material.grade", json!("S-135")).unwrap();
        Model::new(&scenario).unwrap()
    };
    let model = with_grade(turn_deg);
    let turns = 20.0;
    let duration = turns * TAU / model.rotation_speed;
    let loads = loads_of(&model, [duration, duration / 8000.0], &|_, _, _| [0.0; 3]);
    let curvature = turn_deg.to_radians() / 200.0;
    for (element, loads) in model.elements.iter().zip(&loads.elements) {
        let section = element.beam.section();
        let range = 2.0 * section.youngs_modulus * 0.5 * section.outer_diameter * curvature;
        // Of so small a range by the branch of long lives; without tension there is no mean stress.
        let per_turn = (1e-6 * range).powi(5) / 10_f64.powf(17.01);
        // The first and the last turn are open: half a cycle less, and eight places lie at most pi / 8000 from an extreme.
        assert_near(loads.fatigue_rate.unwrap(), turns * per_turn / duration, 0.5 / turns + 1e-3);
        assert_near(loads.yield_ratio.unwrap(), 0.5 * range / 930.792e6, 1e-2);
    }
    // In a straight hole the pipe bows and turns with its bow: the same fibre stays in tension.
    let model = with_grade(0.0);
    let speed = model.rotation_speed;
    let depths: Vec<f64> = model.mesh.nodes.iter().map(|node| node.measured_depth).collect();
    let bow = |whirl: f64| {
        let depths = &depths;
        move |time: f64, node: usize, dof: usize| {
            let wave = TAU / 50.0;
            let (value, slope) = ((wave * depths[node]).sin(), wave * (wave * depths[node]).cos());
            let (sin, cos) = (whirl * time).sin_cos();
            let size = 0.05;
            match dof {
                U => [size * value * cos, 0.0, 0.0],
                V => [size * value * sin, 0.0, 0.0],
                THETA_X => [-size * slope * sin, 0.0, 0.0],
                THETA_Y => [size * slope * cos, 0.0, 0.0],
                _ => [0.0; 3],
            }
        }
    };
    let largest = |whirl: f64| {
        let loads = loads_of(&model, [4.0, 1e-3], &bow(whirl));
        loads.elements.iter().filter_map(|element| element.fatigue_rate).fold(0.0, f64::max)
    };
    let (with, still, against) = (largest(speed), largest(0.0), largest(-speed));
    assert!(with < 1e-9 * still, "{with} against {still}");
    // Backward whirl at the same speed bends a fibre twice a turn.
    assert_near(against, 2.0 * still, 0.1);
    // Without a grade there is neither.
    let none = loads_of(&Model::new(&string(0.0, 0.0)).unwrap(), [0.1, 0.05], &|_, _, _| [0.0; 3]);
    assert!(
        none.elements.iter().all(|element| element.fatigue_rate.is_none() && element.yield_ratio.is_none())
    );
}

#[test]
fn tension_and_torque_add_up_to_the_equivalent_stress() {
    let model = Model::new(&string(0.0, 0.0)).unwrap();
    let (strain, twist) = (4e-4, -2e-3);
    let depths: Vec<f64> = model.mesh.nodes.iter().map(|node| node.measured_depth).collect();
    let stretched = |time: f64, node: usize, dof: usize| {
        let factor = 1.0 - time;
        match dof {
            W => [factor * strain * depths[node], 0.0, 0.0],
            THETA_Z => [factor * twist * depths[node], 0.0, 0.0],
            _ => [0.0; 3],
        }
    };
    let loads = loads_of(&model, [1.0, 0.25], &stretched);
    for (element, loads) in model.elements.iter().zip(&loads.elements) {
        let section = element.beam.section();
        // From full load at the first step's start, which belongs to the step before, to none.
        let first = 0.75;
        assert_near(loads.tension.largest, first * section.axial_stiffness() * strain, 1e-6);
        assert_near(loads.tension.mean, 0.5 * section.axial_stiffness() * strain, 1e-6);
        assert_near(loads.torque.least, first * section.torsional_stiffness() * twist, 1e-6);
        let normal = first * section.youngs_modulus * strain;
        let shear = first * section.shear_modulus * twist * 0.5 * section.outer_diameter;
        assert_near(loads.axial_stress, normal, 1e-6);
        assert_near(loads.torsional_stress, shear.abs(), 1e-6);
        assert_near(loads.equivalent_stress.value, normal.hypot(3_f64.sqrt() * shear), 1e-6);
        assert_eq!(loads.equivalent_stress.time, 0.25);
    }
}

#[test]
fn shear_by_pressure_is_half_the_difference_of_hoop_and_radial_stress() {
    let model = Model::new(&string(0.0, 0.0)).unwrap();
    let section = model.elements[0].beam.section();
    let [outer, inner] = [section.outer_diameter, section.inner_diameter].map(|diameter| 0.5 * diameter);
    // Lame's stresses of a thick tube under 1 Pa in its bore.
    let factor = inner * inner / (outer * outer - inner * inner);
    for radius in [inner, 0.5 * (inner + outer), outer] {
        let [hoop, radial] = [1.0, -1.0].map(|sign| factor * (1.0 + sign * (outer / radius).powi(2)));
        assert_near(section.pressure_shear(radius), 0.5 * (hoop - radial), 1e-12);
    }
}

/// Run of the base case from rest over `duration` \[s\], with its histories.
fn run_of(duration: f64, (integrator, step): (Integrator, f64), rate_hz: f64) -> (Model, Box<Records>) {
    let scenario = ["duration", "recording.rate_hz"]
        .into_iter()
        .zip([json!(duration), json!(rate_hz)])
        .fold(preset("paper-200m").unwrap(), |scenario, (path, value)| scenario.with(path, value).unwrap())
        .with("recording.orbit_window", json!({ "from": 0.2 * duration, "to": duration }))
        .unwrap();
    let accuracy = Accuracy::Explicit(TimeStepping::fixed(integrator, step));
    let model = Model::new(&Scenario { accuracy, ..scenario }).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    let Outcome::Finished(records) =
        Transient::new(&model, &equilibrium).unwrap().run(&Control::new()).unwrap()
    else {
        panic!("not finished")
    };
    (model, records)
}

#[test]
fn loads_do_not_depend_on_the_recording_rate() {
    let step = 5e-4;
    let [slow, fast] = [200.0, 2000.0].map(|rate| run_of(0.5, (Integrator::Esdirk4, step), rate).1.loads);
    for (slow, fast) in slow.nodes.iter().zip(&fast.nodes).skip(1) {
        for (slow, fast) in [
            (slow.lateral_acceleration.peak.value, fast.lateral_acceleration.peak.value),
            (slow.tangential_acceleration.peak.value, fast.tangential_acceleration.peak.value),
            (slow.lateral_acceleration.rms, fast.lateral_acceleration.rms),
            (slow.rotation_speed.largest, fast.rotation_speed.largest),
        ] {
            assert_near(slow, fast, 1e-2);
        }
    }
    for (slow, fast) in slow.elements.iter().zip(&fast.elements) {
        assert_near(slow.bending_moment.peak.value, fast.bending_moment.peak.value, 1e-2);
        assert_near(slow.equivalent_stress.value, fast.equivalent_stress.value, 1e-2);
    }
}

#[test]
fn accelerations_are_the_derivatives_of_recorded_rates() {
    for integrator in [Integrator::Esdirk4, Integrator::Rk4] {
        // Friction that falls at the start excites torsion up to the highest frequency of the mesh, some kilohertz.
        let (model, records) = run_of(0.1, (integrator, 2.5e-5), 40e3);
        let h = 1.0 / records.rate_hz;
        for history in &records.histories {
            let loads = &records.loads.nodes[history.node];
            // Within the window; the stencil of order 4 misses a thousandth of a vibration of 3 kHz.
            let from = (0.02 * records.rate_hz) as usize;
            let slope = |rate: &[f64]| {
                rate[from..]
                    .windows(5)
                    .map(|r| (r[0] - 8.0 * r[1] + 8.0 * r[3] - r[4]) / (12.0 * h))
                    .collect::<Vec<f64>>()
            };
            let [u, v, twist] = [&history.u_rate, &history.v_rate, &history.theta_z_rate].map(|r| slope(r));
            let rms = |squares: &mut dyn Iterator<Item = f64>| (squares.sum::<f64>() / u.len() as f64).sqrt();
            let lateral = rms(&mut u.iter().zip(&v).map(|(u, v)| u * u + v * v));
            assert_near(loads.lateral_acceleration.rms, lateral, 5e-3);
            let adjoining =
                &model.mesh.elements[history.node - 1..(history.node + 1).min(model.elements.len())];
            let radius = adjoining.iter().map(|e| 0.5 * e.tube.outer_diameter).fold(0.0, f64::max);
            let tangential = radius * rms(&mut twist.iter().map(|rate| rate * rate));
            assert_near(loads.tangential_acceleration.rms, tangential, 5e-3);
        }
    }
}

#[test]
fn loads_go_on_from_a_checkpoint_to_the_same_bits() {
    let scenario = ["duration", "recording.orbit_window"]
        .into_iter()
        .zip([json!(0.4), json!({ "from": 0.1, "to": 0.4 })])
        .fold(preset("paper-200m").unwrap(), |scenario, (path, value)| scenario.with(path, value).unwrap());
    let model = Model::new(&scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    let run =
        |transient: Transient<'_>, control: &Control| transient.run_into(control, &mut |_| Ok(())).unwrap();
    let Outcome::Finished(whole) = run(Transient::new(&model, &equilibrium).unwrap(), &Control::new()) else {
        panic!("not finished")
    };
    let suspending = Control::observed_by(|control, time| {
        if time >= 0.2 {
            control.suspend();
        }
    });
    let Outcome::Suspended(checkpoint, ()) = run(Transient::new(&model, &equilibrium).unwrap(), &suspending)
    else {
        panic!("not suspended")
    };
    let checkpoint = Checkpoint::from_bytes(&checkpoint.to_bytes()).unwrap();
    let resumed = Transient::resume(&model, &equilibrium, &checkpoint).unwrap();
    let Outcome::Finished(resumed) = run(resumed, &Control::new()) else { panic!("not finished") };
    assert_eq!(resumed.loads, whole.loads);
    assert_eq!(whole.loads.nodes.len(), model.node_count());
    assert!(whole.loads.nodes.iter().skip(1).all(|node| node.lateral_acceleration.rms > 0.0));
}

#[test]
fn blocks_outside_the_window_do_not_count() {
    let model = Model::new(&string(30.0, 0.0)).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    let rest: NodalVector = vec![[0.0; DOFS]; model.node_count()];
    let loads: Loads<DOFS> = Loads::new(&model, &equilibrium, Dofs::ALL, &rest, (10, None));
    let mut blocks = LoadBlocks::default();
    for number in 0..25 {
        let new = || super::LoadBlock::new(10.0 * number as f64, 1, 1, 0);
        blocks.of_number(number, new, &[]).end = 10.0 * (number + 1) as f64;
    }
    let merged =
        |from: f64, to: f64| blocks.merged(TimeWindow { from, to }, &[]).map(|sum| [sum.start, sum.end]);
    assert_eq!(merged(170.0, 250.0), Some([170.0, 250.0]));
    assert_eq!(merged(173.0, 247.0), Some([180.0, 240.0]));
    assert_eq!(merged(242.0, 248.0), Some([240.0, 250.0]));
    assert_eq!(merged(0.0, 20.0), None);
    assert!(loads.records(&blocks, TimeWindow { from: 0.0, to: 20.0 }).nodes.is_empty());
}
