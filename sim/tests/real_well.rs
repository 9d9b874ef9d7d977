//! The string of a whole well, 3,438 m with 336 joints of drillpipe.

use drillsweep_scenario::{ElementLengths, Mesh, PressureLosses, Scenario, preset};
use drillsweep_sim::math::dof::{U, V};
use drillsweep_sim::solve::hydraulics::{Circuit, Conduit};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::soft_string::{DragCase, DragMode, DragSettings, SoftString};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::solve::stiff_string::stiff_row;

fn well() -> Scenario {
    preset("wells/volve-f12").expect("it ships with the program")
}

/// A string of another mesh in the same scenario.
fn on(mesh: Mesh) -> (Model, Equilibrium) {
    let model = Model::new(&Scenario { mesh, ..well() }).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    (model, equilibrium)
}

#[test]
fn far_from_the_bit_two_elements_a_joint_carry_what_eight_carry() {
    // The mesh of `auto` near the bit, all along the string, and twice as fine.
    let everywhere = |share: f64| {
        Mesh::Lengths(ElementLengths {
            drillpipe: share * 9.08 / 8.0,
            tool_joint: share * 0.6,
            collar: share * 0.5,
            stabilizer: share * 0.5,
            bit: share * 0.3,
        })
    };
    let (graded, fine, finer) = (on(Mesh::auto(1.0)), on(everywhere(1.0)), on(everywhere(0.5)));
    assert!(2 * graded.0.node_count() < fine.0.node_count(), "{} nodes", graded.0.node_count());
    // What the graded mesh leaves out is no more than what the fine mesh itself is from its limit, by its halving, or a thousandth.
    let values = |(_, equilibrium): &(Model, Equilibrium)| [equilibrium.tension[0], equilibrium.torque[0]];
    for ((graded, fine), finer) in values(&graded).into_iter().zip(values(&fine)).zip(values(&finer)) {
        let allowed = (fine - finer).abs().max(1e-3 * finer.abs());
        assert!((graded - finer).abs() < 2.0 * allowed, "{graded} of {fine} and {finer}");
    }
    let radius = 0.5 * well().well.hole_diameter;
    for depth in [3437.7, 3428.0, 3410.0, 3390.0, 3338.0] {
        let [graded, finer] = [&graded, &finer].map(|string| position(string, depth));
        let distance = (graded[0] - finer[0]).hypot(graded[1] - finer[1]);
        assert!(distance < 0.01 * radius, "{distance} m apart at {depth} m");
    }
}

#[test]
fn the_assembly_rests_alone_as_below_the_whole_string() {
    let part = preset("wells/volve-f12-assembly").expect("it ships with the program");
    let cut = part.operation.length_above.expect("pipe above");
    let resting = |scenario: &Scenario| {
        let model = Model::new(scenario).expect("valid");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        (model, equilibrium)
    };
    let (whole, part) = (resting(&well()), resting(&part));
    // The first element below a depth.
    let force = |(model, equilibrium): &(Model, Equilibrium), depth: f64| {
        let element =
            model.mesh.elements.iter().position(|element| element.top >= depth - 1e-6).expect("below");
        [equilibrium.tension[element], equilibrium.torque[element]]
    };
    for depth in [9.6, 149.1, 200.0] {
        let (of_whole, of_part) = (force(&whole, cut + depth), force(&part, depth));
        for (whole, part) in of_whole.into_iter().zip(of_part) {
            assert!((part - whole).abs() < 0.01 * whole.abs().max(1e3), "{part} of {whole} at {depth} m");
        }
    }
    let radius = 0.5 * well().well.hole_diameter;
    for depth in [218.4, 211.4, 204.4, 189.4, 169.4, 119.4] {
        // Axes across the hole are carried along the well from its top; the low side is the same place in both.
        let from_low_side = |string: &(Model, Equilibrium), depth: f64| {
            let [u, v] = position(string, depth);
            let nodes = &string.0.mesh.nodes;
            let node = nodes.partition_point(|node| node.measured_depth < depth);
            let (sine, cosine) = string.0.frames[node].low_side_angle.sin_cos();
            [u * cosine + v * sine, v * cosine - u * sine]
        };
        let [of_whole, of_part] = [from_low_side(&whole, cut + depth), from_low_side(&part, depth)];
        let distance = (of_whole[0] - of_part[0]).hypot(of_whole[1] - of_part[1]);
        assert!(distance < 0.01 * radius, "{distance} m apart at {depth} m");
    }
}

/// Position \[m\] at a depth, linear between nodes.
fn position((model, equilibrium): &(Model, Equilibrium), depth: f64) -> [f64; 2] {
    let nodes = &model.mesh.nodes;
    let below = nodes.partition_point(|node| node.measured_depth < depth).clamp(1, nodes.len() - 1);
    let (top, bottom) = (nodes[below - 1].measured_depth, nodes[below].measured_depth);
    let share = (depth - top) / (bottom - top);
    let at = |node: usize, dof: usize| equilibrium.displacement[node][dof];
    [U, V].map(|dof| at(below - 1, dof) + share * (at(below, dof) - at(below - 1, dof)))
}

#[test]
fn a_whole_string_off_bottom_hangs_and_turns_as_a_soft_string_does() {
    // A soft string by minimum curvature in steps of 1 m, without flow, by two codes of other authors that agree to 0.05 %, torque to 0.6 %, with a
    // contact radius of the pipe's bodies. Joints of the heavy-weight pipe alone leave the torque there; if all joints stand off the wall, it lies between
    // that radius and theirs, 1.325 times as large.
    for (has_joints, hook_load, torque) in
        [(false, 746.91e3, 10.56e3..11.22e3), (true, 886.0e3, 12.3e3..1.325 * 12.3e3)]
    {
        let mut scenario = well();
        if !has_joints {
            scenario.string.sections[1].tool_joint = None;
        }
        scenario.operation.weight_on_bit = 0.0;
        scenario.operation.torque_on_bit = 0.0;
        scenario.contact.static_friction = 0.2;
        if let Some(mud) = &mut scenario.mud {
            mud.flow_rate = 0.0;
        }
        let equilibrium = Equilibrium::find(&Model::new(&scenario).expect("valid")).expect("rests");
        // The string lies off the axis and bends: 0.2 % of the tension, and 3 % of the side force that turns it.
        assert!((equilibrium.tension[0] / hook_load - 1.0).abs() < 5e-3, "{} N", equilibrium.tension[0]);
        assert!(torque.contains(&-equilibrium.torque[0]), "{} N m", equilibrium.torque[0]);
    }
}

#[test]
fn pressures_of_a_whole_well_are_those_of_the_formulas_by_another_program() {
    // Losses of API RP 13D by a program of its own, in Pa: 310.4 psi of annulus and 1,312.8 psi of bore, of which the tool joints have 53.7 and
    // 182.0 psi.
    let (model, equilibrium) = on(Mesh::auto(1.0));
    let circuit = Circuit::new(&model, &equilibrium).expect("it has mud");
    let column = |losses| {
        circuit
            .columns
            .iter()
            .position(|column| column.losses == losses && !column.rotates)
            .expect("a column")
    };
    let [eccentric, concentric, rp13d] = PressureLosses::ALL.map(column);
    let of = |column: usize| &circuit.columns[column];
    let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-4, "{value}");
    near(of(rp13d).annulus_loss, 2.139_815e6);
    near(of(rp13d).bore_loss, 9.051_222e6);
    let joints = |conduit: Conduit| -> f64 {
        let parts = circuit.parts.iter().filter(|part| part.conduit == conduit && part.kind == "tool joint");
        parts.map(|part| part.losses[rp13d]).sum::<f64>() / 6_894.757
    };
    assert!((joints(Conduit::Annulus) - 53.65).abs() < 0.05, "{}", joints(Conduit::Annulus));
    assert!((joints(Conduit::Bore) - 182.01).abs() < 0.1, "{}", joints(Conduit::Bore));
    // A string in the middle loses about as much by either friction; on the low side it loses between the factors of laminar and turbulent flow.
    let annulus = [eccentric, concentric, rp13d].map(|column| of(column).annulus_loss);
    assert!((annulus[2] / annulus[1] - 1.0).abs() < 0.15, "{annulus:?}");
    assert!((0.5..0.75).contains(&(annulus[0] / annulus[1])), "{annulus:?}");
}

#[test]
fn a_whole_string_moves_at_the_hook_loads_of_a_soft_string() {
    let mut scenario = well();
    scenario.mud.as_mut().expect("mud").flow_rate = 0.0;
    let soft = SoftString::new(&scenario).expect("valid");
    let settings = DragSettings { axial_speed: Some(-0.3), ..DragSettings::default() };
    let (mu, bit_depth) = (0.25, soft.bit_depth());
    // Friction about the axis moves a string up the wall, whose side force falls by this; a soft string stays on the low side.
    let climb = 1.0 / f64::hypot(mu, 1.0);
    for mode in DragMode::ALL {
        let case = DragCase { mode, bit_depth, friction: Some(mu) };
        let expected = soft.forces(&case, &settings).expect("valid");
        let found = stiff_row(&scenario, &case, &settings).expect("rests");
        // A stiff string crosses doglegs within its clearance, where a soft one presses on the wall.
        let ratio = found.hook_load / expected.hook_load;
        assert!((ratio - 1.0).abs() < 0.02, "{}: {ratio} of the hook load", mode.name());
        if matches!(mode, DragMode::Rotate | DragMode::Drill) {
            let ratio = found.surface_torque / (expected.surface_torque * climb);
            assert!((ratio - 1.0).abs() < 0.03, "{}: {ratio} of the torque", mode.name());
        }
    }
}

#[test]
fn a_stiff_string_hangs_at_any_depth_of_its_bit_as_a_soft_one() {
    let mut scenario = well();
    scenario.mud.as_mut().expect("mud").flow_rate = 0.0;
    let soft = SoftString::new(&scenario).expect("valid");
    let settings = DragSettings::default();
    let (modes, depths) = ([DragMode::PickUp, DragMode::Rotate], [400.0, 1500.0, 2500.0]);
    let expected = soft.broomstick(&modes, &[Some(0.2)], &depths, &settings).expect("valid");
    for expected in &expected {
        let case =
            DragCase { mode: expected.mode, bit_depth: expected.bit_depth, friction: expected.friction };
        let found = stiff_row(&scenario, &case, &settings).expect("rests");
        let ratio = found.hook_load / expected.hook_load;
        assert!((ratio - 1.0).abs() < 0.02, "{} at {} m: {ratio}", found.mode.name(), found.bit_depth);
    }
}
