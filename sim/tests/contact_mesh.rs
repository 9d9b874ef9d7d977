//! Contact by length of string (`contact.reference_length`): the wall is the same for every mesh, and what rests on it converges.

use drillsweep_sim::mesh_estimate::MeshEstimate;
use drillsweep_sim::model::{GRAVITY, Model};
use drillsweep_sim::scenario::{Scenario, SurveyStation, preset};
use drillsweep_sim::statics::Equilibrium;

fn rest(model: &Model) -> Equilibrium {
    Equilibrium::find(model).expect("rests")
}

/// 60 m of drillpipe in a horizontal hole, its top clamped on the axis, on a wall of `stiffness` \[N/m\] a metre or a node.
fn pipe_on_the_low_side(stiffness: f64, elements: u32, reference_length: Option<f64>) -> Scenario {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    let station = |measured_depth| SurveyStation { measured_depth, inclination_deg: 90.0, azimuth_deg: 0.0 };
    scenario.well.survey = vec![station(0.0), station(60.0)];
    scenario.string.sections.truncate(1);
    scenario.string.sections[0].length = 60.0;
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.mud = None;
    let operation = &mut scenario.operation;
    (operation.rotation_speed_rpm, operation.weight_on_bit, operation.torque_on_bit) = (0.0, 0.0, 0.0);
    scenario.contact.stiffness = stiffness;
    scenario.contact.reference_length = reference_length;
    scenario.mesh.drillpipe = 60.0 / f64::from(elements);
    scenario.recording.nodes.clear();
    scenario
}

/// What a pipe that rests on its low side shows.
struct Resting {
    /// Bending moment at the clamped top \[N m\].
    clamp_moment: f64,
    normal_force: f64,
    deepest: f64,
}

impl Resting {
    fn of(scenario: &Scenario) -> Self {
        let model = Model::new(scenario).expect("has a model");
        let equilibrium = rest(&model);
        let section = model.elements[0].beam.section();
        let weight = section.density * section.area * GRAVITY;
        let nodes = || model.mesh.nodes.iter().zip(&equilibrium.displacement);
        // The balance of moments about the top.
        let depths = model.mesh.depths();
        let pushed: f64 =
            depths.iter().zip(&equilibrium.normal_force).map(|(depth, force)| depth * force).sum();
        Self {
            clamp_moment: 0.5 * weight * model.mesh.length().powi(2) - pushed,
            normal_force: equilibrium.normal_force.iter().sum(),
            deepest: nodes().map(|(node, x)| x[0].hypot(x[1]) - node.clearance).fold(0.0, f64::max),
        }
    }
}

#[test]
fn pipe_on_an_elastic_wall_converges_to_its_boundary_value_problem() {
    // E I y'''' = w - kappa max(0, y - j0), clamped above, free below, solved by collocation: moment at the clamp, force of the wall,
    // deepest penetration. Without shear, which softens this pipe by less than a thousandth.
    let (moment, force, deepest) = (5507.6, 14_316.9, 2.0655e-3);
    let kappa = 2e5;
    let found = [30, 60, 120, 240].map(|count| Resting::of(&pipe_on_the_low_side(kappa, count, Some(1.0))));
    let finest = &found[3];
    assert!((finest.clamp_moment / moment - 1.0).abs() < 2e-3, "{} N m", finest.clamp_moment);
    assert!((finest.normal_force / force - 1.0).abs() < 1e-3, "{} N", finest.normal_force);
    // Halving the elements shrinks what is missing: a node's wall is a rule of quadrature of second order.
    let missing = found.each_ref().map(|resting| (resting.deepest / deepest - 1.0).abs());
    assert!(missing[0] < 0.05 && missing[1] < 0.02 && missing[2] < 5e-3 && missing[3] < 2e-3, "{missing:?}");
    // A node's own stiffness makes the wall twice as hard at every halving.
    let by_node = [60, 240].map(|count| Resting::of(&pipe_on_the_low_side(kappa, count, None)).deepest);
    assert!(by_node[1] < 0.4 * by_node[0], "{by_node:?}");
}

/// Static radius \[m\] of the base case at node 49 of the paper, on a drillpipe body between two tool joints, with elements `factor` times as
/// long; with `ends_reach` half of the body's element beside a tool joint's end counts as touching too.
fn radius_of_the_base_case(factor: f64, ends_reach: bool) -> f64 {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.contact.reference_length = Some(0.5);
    let mesh = &mut scenario.mesh;
    for length in
        [&mut mesh.drillpipe, &mut mesh.tool_joint, &mut mesh.collar, &mut mesh.stabilizer, &mut mesh.bit]
    {
        *length *= factor;
    }
    let mut model = Model::new(&scenario).expect("has a model");
    if ends_reach {
        let lengths: Vec<f64> = model.mesh.elements.iter().map(|element| element.length).collect();
        for (i, node) in model.mesh.nodes.iter_mut().enumerate().filter(|(_, node)| !node.is_gauge) {
            let above = i.checked_sub(1).map_or(0.0, |above| lengths[above]);
            node.contact_share = 0.5 * (above + lengths.get(i).copied().unwrap_or(0.0)) / 0.5;
        }
    }
    let [u, v, ..] = rest(&model).displacement[model.mesh.nearest_node(57.73)];
    u.hypot(v)
}

#[test]
fn radius_between_tool_joints_converges_with_the_mesh() {
    // Joints carry the pipe there. Where their ends count with a part of the bodies beside them, which do not touch, the wall under a
    // joint softens with the mesh: 37.15, 37.26, 37.37, 37.46 mm on the way to 37.60 mm, ever slower.
    let radii =
        |ends_reach| [1.0, 0.5, 0.25, 0.125].map(|factor| radius_of_the_base_case(factor, ends_reach));
    let (found, reaching) = (radii(false), radii(true));
    let limit = found[3];
    for (radius, factor) in found.iter().zip([1.0, 0.5, 0.25]) {
        assert!(
            (radius / limit - 1.0).abs() < 1e-3,
            "{radius} m against {limit} m, elements {factor} times as long"
        );
    }
    // A rule of quadrature of second order: with a quarter of the length a sixteenth of that is left.
    assert!((found[2] / limit - 1.0).abs() < 1e-4, "{found:?}");
    assert!(reaching[0] / limit - 1.0 < -1e-2 && reaching[3] / reaching[2] - 1.0 > 2e-3, "{reaching:?}");
}

#[test]
fn estimate_of_the_meshs_part_is_the_distance_from_a_much_finer_mesh() {
    let scaled = |factor: f64| {
        let mut scenario = preset("paper-200m").expect("shipped preset");
        scenario.contact.reference_length = Some(0.5);
        let mesh = &mut scenario.mesh;
        for length in
            [&mut mesh.drillpipe, &mut mesh.tool_joint, &mut mesh.collar, &mut mesh.stabilizer, &mut mesh.bit]
        {
            *length *= factor;
        }
        let model = Model::new(&scenario).expect("has a model");
        let equilibrium = rest(&model);
        (model, equilibrium)
    };
    let (model, equilibrium) = scaled(1.0);
    let MeshEstimate::Estimated(estimate) = MeshEstimate::of(&model, &equilibrium) else {
        panic!("is known")
    };
    // Nodes of the mesh are nodes of the one with an eighth of its lengths.
    let (fine_model, fine) = scaled(0.125);
    let radius = |x: &[f64; 6]| x[0].hypot(x[1]);
    let at = |depth: f64| fine.displacement[fine_model.mesh.nearest_node(depth)];
    let (mut worst, mut recorded) = (0.0_f64, 0.0_f64);
    for (i, (node, x)) in model.mesh.nodes.iter().zip(&equilibrium.displacement).enumerate() {
        let y = at(node.measured_depth);
        worst = worst.max((x[0] - y[0]).hypot(x[1] - y[1]) / 0.10795);
        if [9, 48, 281].contains(&i) {
            recorded = recorded.max((radius(x) / radius(&y) - 1.0).abs());
        }
    }
    // C_f of each element against that of the finer one in its middle, mean over the length.
    let (mut apart, mut whole) = (0.0, 0.0);
    for (element, flow) in model.mesh.elements.iter().zip(&equilibrium.flows) {
        let middle = element.top + 0.5 * element.length;
        let below = fine_model.mesh.elements.partition_point(|finer| finer.top + finer.length < middle);
        let reference = fine.flows[below].friction_coefficient;
        apart += element.length * (flow.friction_coefficient - reference).abs();
        whole += element.length * reference;
    }
    let pairs = [
        (Some(estimate.static_position), worst),
        (estimate.mean_radius, recorded),
        (estimate.friction_coefficient, apart / whole),
    ];
    for (estimated, found) in pairs {
        let estimated = estimated.expect("is estimated");
        assert!((1.0 / 3.0..3.0).contains(&(estimated / found)), "{estimated} for {found}");
    }
}
