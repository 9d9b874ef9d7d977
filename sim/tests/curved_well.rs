//! A string in a curved hole: rigid motion, torque, bending, effective tension, contact load.

use drillsweep_scenario::{Effect, Scenario, SurveyStation, Switch, preset};
use drillsweep_sim::math::linalg::{BlockTridiagonal, Factor};
use drillsweep_sim::solve::model::{GRAVITY, Model, add_element_matrix, add_element_vector, element_values};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::string::well::WellPath;
use nalgebra::Vector3;

fn base() -> Scenario {
    preset("paper-200m").expect("shipped preset")
}

/// The base case's string in a horizontal circular arc of constant curvature \[deg per 30 m\].
fn horizontal_arc(dogleg_deg_per_30m: f64) -> Scenario {
    let mut scenario = base();
    scenario.well.survey = [0.0, 100.0, 200.0]
        .map(|depth| SurveyStation {
            measured_depth: depth,
            inclination_deg: 90.0,
            azimuth_deg: depth / 30.0 * dogleg_deg_per_30m,
        })
        .to_vec();
    scenario
}

#[test]
fn rigid_translation_of_the_whole_string_costs_no_force() {
    let model = Model::new(&base()).expect("valid");
    let shift = Vector3::new(0.3, -0.7, 0.2);
    let displacement: Vec<[f64; 6]> = model
        .frames
        .iter()
        .map(|f| [f.e1.dot(&shift), f.e2.dot(&shift), f.e3.dot(&shift), 0.0, 0.0, 0.0])
        .collect();
    for (e, element) in model.elements.iter().enumerate() {
        let force = element.elastic * element_values(&displacement, e);
        assert!(force.norm() < 1e-9 * element.elastic.norm(), "element {e}: {}", force.norm());
        assert!(element.tension_row.dot(&element_values(&displacement, e)).abs() < 1e-3);
    }
}

#[test]
fn torque_is_conserved_round_a_frictionless_curved_hole() {
    // With nodes held on the axis the torque at the top equals that at the bit. The full rotation in place of the
    // twist rule (docs/model/well.md, Chord frame) would leave 0.75 of it.
    let leak = |dogleg: f64| {
        let model = Model::new(&horizontal_arc(dogleg)).expect("valid");
        let n = model.node_count();
        let mut stiffness = BlockTridiagonal::zeros(n);
        for (e, element) in model.elements.iter().enumerate() {
            add_element_matrix(&mut stiffness, e, &element.elastic);
        }
        let torque = -5000.0;
        let mut right = vec![[0.0; 6]; n];
        right[n - 1][5] = torque;
        for node in 0..n {
            // A stiff guide keeps every node on the axis; the top is clamped.
            let held: &[usize] = if node == 0 { &[0, 1, 2, 3, 4, 5] } else { &[0, 1] };
            for &dof in held {
                stiffness.diagonal[node][(dof, dof)] += 1e16;
            }
        }
        Factor::new(&stiffness).expect("regular").solve_in_place(&mut right);
        let ratios = model.elements.iter().enumerate();
        ratios
            .map(|(e, element)| element.torque_row.dot(&element_values(&right, e)) / torque - 1.0)
            .fold(0.0_f64, |m, leak| m.max(leak.abs()))
    };
    // A chord makes an angle of kappa l / 2 with the nodal tangents, so unequal neighbours hand torque on with an
    // error of (kappa l)^2 / 8: 8e-5 for 1.48 m at 30 deg / 30 m, and a quarter of that at half the curvature.
    let (curved, half) = (leak(30.0), leak(15.0));
    assert!(curved < 8.4e-5, "{curved}");
    assert!((curved / half - 4.0).abs() < 0.05, "{curved} {half}");
}

#[test]
fn pipe_clamped_into_an_arc_carries_ei_kappa_and_loads_nothing_in_between() {
    let mut scenario = horizontal_arc(7.5);
    scenario.string.sections.truncate(1);
    scenario.string.sections[0].length = 60.0;
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.mud = None;
    let forces = |switch: Switch| {
        let mut scenario = scenario.clone();
        scenario.effects.set(Effect::WellBending, switch);
        let model = Model::new(&scenario).expect("valid");
        let mut sum = vec![[0.0; 6]; model.node_count()];
        for (e, element) in model.elements.iter().enumerate() {
            add_element_vector(&mut sum, e, &element.load);
        }
        (model, sum)
    };
    let (model, bent) = forces(Switch::On);
    let (_, straight) = forces(Switch::Off);
    let section = *model.elements[0].beam.section();
    let curvature = 7.5_f64.to_radians() / 30.0;
    let moment = section.bending_stiffness() * curvature;
    let last = model.node_count() - 1;
    for node in 0..=last {
        let load: Vec<f64> = (0..6).map(|dof| bent[node][dof] - straight[node][dof]).collect();
        let (force, couple) = (load[0].hypot(load[1]), load[3].hypot(load[4]));
        // Chords and arcs differ by (kappa l)^2 / 24 = 2e-6 here.
        if node == 0 || node == last {
            assert!((couple / moment - 1.0).abs() < 1e-5, "end couple {couple} against {moment}");
        } else {
            assert!(couple < 1e-5 * moment, "node {node}: couple {couple}");
        }
        assert!(force * 30.0 < 1e-5 * moment, "node {node}: force {force}");
    }
}

#[test]
fn hanging_string_carries_its_weight_and_stretches_by_it() {
    // w L^2 / 2 E S and T = w (L - s), exact for linear elements under consistent loads.
    let mut scenario = base();
    scenario.well.survey = [0.0, 200.0]
        .map(|depth| SurveyStation { measured_depth: depth, inclination_deg: 0.0, azimuth_deg: 0.0 })
        .to_vec();
    scenario.string.sections.truncate(1);
    scenario.string.sections[0].length = 180.0;
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.mud = None;
    scenario.operation.weight_on_bit = 0.0;
    scenario.operation.torque_on_bit = 0.0;
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("hangs");
    let section = *model.elements[0].beam.section();
    let weight = section.density * section.area * GRAVITY;
    for (element, tension) in model.mesh.elements.iter().zip(&equilibrium.tension) {
        let expected = weight * (180.0 - (element.top + 0.5 * element.length));
        assert!((tension - expected).abs() < 1e-6 * weight * 180.0, "{tension} {expected}");
    }
    let stretch = weight * 180.0_f64.powi(2) / (2.0 * section.axial_stiffness());
    let bit = equilibrium.displacement.last().expect("nodes")[2];
    assert!((bit / stretch - 1.0).abs() < 1e-8, "{bit} {stretch}");
}

/// Effective tension, torque and contact load of a soft string (no bending stiffness) that lies on the hole's axis:
/// dT/ds = -w t_z + drag, n = |T kappa + w_lateral| with the flows' centrifugal share, dT0/ds = mu_s n R_e
/// (Johancsik, Friesen and Dawson 1984, for a string that turns).
struct SoftString {
    tension: f64,
    torque: f64,
    side_force: f64,
}

fn soft_string(model: &Model, equilibrium: &Equilibrium) -> SoftString {
    let scenario = &model.scenario;
    let path = WellPath::new(&scenario.well).expect("valid");
    let mud = scenario.mud.as_ref();
    let mut state = SoftString {
        tension: scenario.operation.weight_on_bit,
        torque: scenario.operation.torque_on_bit,
        side_force: 0.0,
    };
    let parts = 50;
    for (e, element) in model.mesh.elements.iter().enumerate().rev() {
        let section = model.elements[e].beam.section();
        let buoyed = section.density * section.area
            + mud.map_or(0.0, |m| m.density * (section.bore_area() - section.displaced_area()));
        let drag = equilibrium.drag.get(e).copied().unwrap_or(0.0);
        let contact_radius = 0.5 * element.tube.outer_diameter;
        for i in (0..parts).rev() {
            let ds = element.length / f64::from(parts);
            let s = element.top + (f64::from(i) + 0.5) * ds;
            let tangent = path.tangent(s);
            let gravity = Vector3::new(0.0, 0.0, buoyed * GRAVITY);
            let along = gravity.dot(&tangent);
            let mid_tension = state.tension + 0.5 * (along - drag) * ds;
            let side = (path.curvature(s) * mid_tension + gravity - tangent * along).norm() * ds;
            state.tension += (along - drag) * ds;
            state.side_force += side;
            state.torque -= scenario.contact.static_friction * side * contact_radius;
        }
    }
    state
}

#[test]
fn curved_wells_tension_torque_and_side_force_match_a_soft_string() {
    let model = Model::new(&base()).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let soft = soft_string(&model, &equilibrium);
    let side_force: f64 = equilibrium.normal_force.iter().sum();
    // The soft string lies on the axis, the real one within 0.045 m of it: a 200 m string's tension differs by the
    // buoyed weight of that height, 0.05 m of 450 N/m in 100 kN.
    assert!(
        (equilibrium.tension[0] / soft.tension - 1.0).abs() < 2e-3,
        "{} {}",
        equilibrium.tension[0],
        soft.tension
    );
    // Stiffness moves contact load between tool joints and lets the clamped top carry some of it: a few per cent.
    assert!((side_force / soft.side_force - 1.0).abs() < 0.05, "{side_force} {}", soft.side_force);
    assert!(
        (equilibrium.torque[0] / soft.torque - 1.0).abs() < 0.05,
        "{} {}",
        equilibrium.torque[0],
        soft.torque
    );
    assert!((equilibrium.tension.last().expect("elements") + 1e5).abs() < 300.0);
}

#[test]
fn statics_from_quite_different_starts_give_one_equilibrium() {
    let model = Model::new(&base()).expect("valid");
    let reference = Equilibrium::find(&model).expect("rests");
    let n = model.node_count();
    let starts: [Vec<[f64; 6]>; 3] = [
        // Along the low side, along the high side, and a corkscrew.
        vec![[0.03, 0.0, 0.0, 0.0, 0.0, 0.0]; n],
        vec![[-0.03, 0.01, 0.0, 0.0, 0.0, 0.0]; n],
        (0..n)
            .map(|i| {
                let (s, c) = (0.2 * i as f64).sin_cos();
                [0.02 * c, 0.02 * s, 1e-3, 0.0, 0.0, -0.1]
            })
            .collect(),
    ];
    for mut start in starts {
        start[0] = [0.0; 6];
        let other = Equilibrium::find_from(&model, start).expect("the same place");
        for (a, b) in reference.displacement.iter().zip(&other.displacement) {
            for dof in 0..6 {
                assert!((a[dof] - b[dof]).abs() < 1e-9, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn equilibrium_leaves_no_force_unbalanced() {
    let model = Model::new(&base()).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    // Rounding of forces E S u / l of 1e10 N/m times 0.1 m.
    assert!(equilibrium.effort.residual < 1e-5, "{}", equilibrium.effort.residual);
}

#[test]
fn base_case_rests_as_in_the_paper() {
    // Section 4.2 of the paper: contacts at the tool joints and at almost all collars; node 49 sits at 0.037 m.
    let model = Model::new(&base()).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let radius = |node: usize| equilibrium.displacement[node][0].hypot(equilibrium.displacement[node][1]);
    assert!((radius(48) - 0.037).abs() < 5e-4, "{}", radius(48));
    let touches = |node: usize| equilibrium.normal_force[node] > 0.0;
    // The connection of each pair of drillpipes is the node between two tool joints.
    let connections = (1..=8).map(|pipe| model.mesh.nearest_node(4.0 + 9.5 * f64::from(pipe)));
    assert_eq!(connections.filter(|&node| touches(node)).count(), 8);
    let collars: Vec<usize> =
        (0..model.node_count()).filter(|&node| model.mesh.nodes[node].measured_depth > 89.5).collect();
    let resting = collars.iter().filter(|&&node| touches(node)).count();
    assert!(resting * 10 > collars.len() * 5, "{resting} of {} collar nodes", collars.len());
    // Nothing is pushed into the rock further than its contact stiffness allows for.
    for (node, force) in equilibrium.normal_force.iter().enumerate().filter(|(_, force)| **force > 0.0) {
        let penetration = radius(node) - model.mesh.nodes[node].clearance;
        assert!(*force <= 1.0e7 * penetration * (1.0 + 1e-9) && *force >= 0.5e7 * penetration);
    }
}

#[test]
fn tension_in_an_arc_is_a_load_along_the_element() {
    // 7.5 deg in 30 m, horizontal: to the right of the string, so that the axis bends towards +v.
    let model = Model::new(&horizontal_arc(7.5)).expect("valid");
    let curvature = (7.5_f64 / 30.0).to_radians();
    for element in &model.elements {
        let length = element.chord.length;
        // A load w in the plane of v has the end moments -+ w l^2 / 12 about -e1, which T kappa needs in addition to the forces of T by the chords'
        // directions: on the left-hand side, loads are negative.
        let moment = curvature * length * length / 12.0;
        let load = element.load_of_slopes(1.0, 0.0);
        let small = 1e-3 * moment;
        for (dof, value) in load.iter().enumerate() {
            let wanted = match dof {
                3 => moment,
                9 => -moment,
                _ => 0.0,
            };
            assert!((value.abs() - wanted.abs()).abs() < small, "{dof}: {value} for {wanted}");
        }
        assert!(load[3] * load[9] < 0.0);
    }
}

/// Displacements of the free end of a pipe of 40 m in a slight arc, without wall and weight, under a pull and a torque: so slight that the angles of
/// chords and tangents, (kappa l)^2 / 8, do not count.
fn end_in_an_arc(elements: u32, [pull, torque]: [f64; 2]) -> [f64; 2] {
    let mut scenario = horizontal_arc(0.1);
    scenario.string.sections.truncate(1);
    scenario.string.sections[0].length = 40.0;
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.mud = None;
    scenario.recording.nodes.clear();
    let operation = &mut scenario.operation;
    (operation.rotation_speed_rpm, operation.weight_on_bit, operation.torque_on_bit) = (0.0, pull, torque);
    for effect in [Effect::Contact, Effect::Gravity, Effect::WellBending] {
        scenario.effects.set(effect, Switch::Off);
    }
    scenario.mesh.lengths_mut().expect("has target lengths").drillpipe = 40.0 / f64::from(elements);
    let model = Model::new(&scenario).expect("valid");
    let rest = Equilibrium::find(&model).expect("rests");
    let [u, v, ..] = rest.displacement[model.node_count() - 1];
    [u, v]
}

#[test]
fn displacements_in_an_arc_converge_at_fourth_order() {
    let errors = |loads: [f64; 2], dof: usize| {
        let at_end = |elements| end_in_an_arc(elements, loads)[dof];
        let limit = at_end(128);
        [4, 8, 16].map(|elements| (at_end(elements) / limit - 1.0).abs())
    };
    // Between third and fifth order; without the loads on the slopes errors are of second order.
    let by_pull = errors([4e3, 0.0], 1);
    for pair in by_pull.windows(2) {
        assert!((8.0..32.0).contains(&(pair[0] / pair[1])), "{by_pull:?}");
    }
    // On four elements torque leaves hardly more than rounding.
    let by_torque = errors([0.0, -3e3], 0);
    assert!(by_torque.iter().all(|&error| error < 1e-6), "{by_torque:?}");
}
