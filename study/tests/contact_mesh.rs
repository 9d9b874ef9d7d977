//! Contact by length of string (`contact.law = "per_length"`): the wall is the same for every mesh, and the position of a string at rest on it
//! converges.

use drillsweep_scenario::{
    Accuracy, Integrator, Mesh, NodeChoice, RayleighDamping, Scenario, StartFriction, SurveyStation,
    TimeStepping, TimeWindow, UnbalanceMass, WallLaw, preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::math::signal::{orbit_statistics, sample_range};
use drillsweep_sim::solve::model::{GRAVITY, Model};
use drillsweep_sim::solve::modes::{Pencil, Receptance};
use drillsweep_sim::solve::run::{NodeHistory, Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;
use drillsweep_study::mesh_estimate::MeshEstimate;

fn rest(model: &Model) -> Equilibrium {
    Equilibrium::find(model).expect("rests")
}

/// 60 m of drillpipe in a horizontal hole, its top clamped on the axis, on a wall of `stiffness` \[N/m2, or N/m a node\].
fn pipe_on_the_low_side(law: WallLaw, stiffness: f64, elements: u32) -> Scenario {
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
    scenario.contact.law = law;
    match law {
        WallLaw::PerNode => scenario.contact.stiffness = stiffness,
        WallLaw::PerLength => scenario.contact.stiffness_per_length = Some(stiffness),
    }
    scenario.mesh.lengths_mut().expect("has target lengths").drillpipe = 60.0 / f64::from(elements);
    scenario.recording.nodes.clear();
    scenario
}

/// Results of a pipe that rests on its low side.
#[derive(Debug, Clone, Copy)]
struct Resting {
    /// Bending moment at the clamped top \[N m\].
    clamp_moment: f64,
    /// Force of the whole wall \[N\].
    normal_force: f64,
    /// Largest penetration \[m\].
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

    /// The same without a mesh: (E I y'')'' = w - kappa max(0, y - j0), clamped above, free below. From the touchdown at a on, y - j0 is
    /// w/kappa plus a wave that decays away from it (the free end of a pipe under uniform load is as straight as its middle);
    /// above it y is a polynomial of order four. Deflection, rotation, moment and shear force are continuous at a, the deflection being j0: linear
    /// equations for the rest, and a by bisection. `shear_flexibility` is 1/(G S_r) of a Timoshenko beam, 0 of an Euler-Bernoulli one.
    fn on_an_elastic_wall(beam: &Beam, kappa: f64, shear_flexibility: f64) -> (Self, f64) {
        let &Beam { bending, weight, clearance, length } = beam;
        // Exponents -p +- iq of the wave, from r^4 - kappa r^2 / (G S_r) + kappa / (E I) = 0.
        let (half_root, shift) = (0.5 * (kappa / bending).sqrt(), 0.25 * kappa * shear_flexibility);
        let (p, q) = ((half_root + shift).sqrt(), (half_root - shift).sqrt());
        // Derivatives of exp(-p s) cos(q s) and exp(-p s) sin(q s) at s = 0.
        let cosine = [1.0, -p, p * p - q * q, -p * (p * p - 3.0 * q * q)];
        let sine = [0.0, q, -2.0 * p * q, q * (3.0 * p * p - q * q)];
        // Rotation, its derivative and its second derivative, by the wave's derivatives: E I psi'' = -G S_r (y' - psi).
        let turns = |z: [f64; 4]| {
            let second = z[3] - kappa * shear_flexibility * z[1];
            [z[1] + bending * shear_flexibility * second, z[2] - kappa * shear_flexibility * z[0], second]
        };
        let (even, odd) = (turns(cosine), turns(sine));
        let wave = -weight / kappa;
        let line = weight / bending;
        // psi = line s^3 / 6 + d2 s^2 / 2 + d1 s; y' = psi - E I psi'' / (G S_r).
        let continued = |a: f64| {
            // psi'' = line a + d2 and psi' = line a^2 / 2 + d2 a + d1 in terms of the sine's amplitude B: each a constant and a slope.
            let d2 = [wave * even[2] - line * a, odd[2]];
            let d1 = [wave * even[1] - 0.5 * line * a * a - d2[0] * a, odd[1] - d2[1] * a];
            let sag = |d1: f64, d2: f64, line: f64| {
                line * a.powi(4) / 24.0 + d2 * a.powi(3) / 6.0 + d1 * a * a / 2.0
                    - bending * shear_flexibility * (0.5 * line * a * a + d2 * a)
            };
            let b = (clearance - sag(d1[0], d2[0], line)) / sag(d1[1], d2[1], 0.0);
            let (d1, d2) = (d1[0] + b * d1[1], d2[0] + b * d2[1]);
            let gap = line * a.powi(3) / 6.0 + 0.5 * d2 * a * a + d1 * a - (wave * even[0] + b * odd[0]);
            (gap, d1, d2, b)
        };
        // A soft wall is reached below the place at which a rigid one would be left: the bracket is about that.
        let rigid = (72.0 * bending * clearance / weight).powf(0.25);
        let (mut low, mut high) = (0.5 * rigid, 1.5 * rigid);
        let sign = continued(low).0.signum();
        assert!(continued(high).0.signum() != sign, "no touchdown");
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if continued(middle).0.signum() == sign { low = middle } else { high = middle }
        }
        let (_, d1, d2, b) = continued(low);
        let penetration =
            |s: f64| weight / kappa + (-p * s).exp() * (wave * (q * s).cos() + b * (q * s).sin());
        let depths = (0..100_000).map(|i| f64::from(i) * 1e-5 * (length - low));
        let found = Self {
            clamp_moment: bending * d1,
            // The shear force at the clamp is -E I psi''.
            normal_force: weight * length + bending * d2,
            deepest: depths.map(penetration).fold(0.0, f64::max),
        };
        (found, low)
    }
}

/// The pipe of [`pipe_on_the_low_side`].
struct Beam {
    /// E I \[N m2\].
    bending: f64,
    /// Weight \[N/m\].
    weight: f64,
    /// j0 \[m\].
    clearance: f64,
    length: f64,
}

impl Beam {
    /// The pipe, and 1/(G S_r) \[1/N\].
    fn of_the_pipe() -> (Self, f64) {
        let model = Model::new(&pipe_on_the_low_side(WallLaw::PerLength, 2e5, 30)).expect("has a model");
        let section = model.elements[0].beam.section();
        let beam = Self {
            bending: section.bending_stiffness(),
            weight: section.density * section.area * GRAVITY,
            clearance: model.mesh.nodes[0].clearance,
            length: model.mesh.length(),
        };
        (beam, 1.0 / (section.shear_modulus * section.shear_area))
    }
}

#[test]
fn pipe_on_an_elastic_wall_has_its_known_solutions() {
    let (beam, shear_flexibility) = Beam::of_the_pipe();
    // A rigid wall is touched at (72 E I j0 / w)^(1/4), with two thirds of the weight above that on the clamp.
    let (rigid, touchdown) = Resting::on_an_elastic_wall(&beam, 1e20, 0.0);
    assert!((touchdown / 10.985 - 1.0).abs() < 1e-4, "{touchdown} m");
    let on_the_clamp = beam.weight * beam.length - rigid.normal_force;
    assert!((on_the_clamp / (2.0 / 3.0 * beam.weight * touchdown) - 1.0).abs() < 1e-3, "{on_the_clamp} N");
    // An elastic one, solved independently by collocation without shear.
    let (elastic, _) = Resting::on_an_elastic_wall(&beam, 2e5, 0.0);
    assert!((elastic.clamp_moment / 5507.6 - 1.0).abs() < 1e-5, "{elastic:?}");
    assert!((elastic.normal_force / 14_316.9 - 1.0).abs() < 1e-5, "{elastic:?}");
    assert!((elastic.deepest / 2.0655e-3 - 1.0).abs() < 1e-4, "{elastic:?}");
    // Shear softens so slender a pipe by a thousandth.
    let (with_shear, _) = Resting::on_an_elastic_wall(&beam, 2e5, shear_flexibility);
    assert!((with_shear.clamp_moment / elastic.clamp_moment - 1.0).abs() < 1e-3, "{with_shear:?}");
}

#[test]
fn pipe_on_a_wall_by_length_converges_with_the_fourth_power_of_the_elements() {
    let (beam, shear_flexibility) = Beam::of_the_pipe();
    let (limit, _) = Resting::on_an_elastic_wall(&beam, 2e5, shear_flexibility);
    let on_a_mesh = |law, elements| Resting::of(&pipe_on_the_low_side(law, 2e5, elements));
    // Single meshes are off by more or less as the touchdown falls into an element, so each octave is judged by the worst of sixteen
    // meshes: errors times the fourth power of the elements, which stay the same for fourth order and would go by two to the second for third or fifth
    // order from the first octave to the last.
    let coefficients = [30, 60, 120].map(|fewest| {
        let meshes = (0..16).map(|i| fewest + fewest * i / 16);
        meshes.fold([0.0_f64; 2], |most, elements| {
            let found = on_a_mesh(WallLaw::PerLength, elements);
            let parts = [found.clamp_moment / limit.clamp_moment, found.normal_force / limit.normal_force];
            std::array::from_fn(|i| most[i].max((parts[i] - 1.0).abs() * f64::from(elements).powi(4)))
        })
    });
    for quantity in 0..2 {
        let of_octaves = coefficients.map(|of_octave| of_octave[quantity]);
        let (least, most) =
            of_octaves.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &c| (a.min(c), b.max(c)));
        assert!(most < 2.5 * least, "{quantity}: {of_octaves:?}");
    }
    // 2 m of pipe to an element leave a twenty-thousandth of the clamp's moment.
    let coarse = on_a_mesh(WallLaw::PerLength, 30);
    assert!((coarse.clamp_moment / limit.clamp_moment - 1.0).abs() < 5e-5, "{coarse:?} of {limit:?}");
    // The wall of the law by node hardens with the mesh: 240 elements leave a third of the penetration.
    let by_node = [3.756e-3, 2.033e-3, 1.153e-3, 0.652e-3];
    for (elements, deepest) in [30, 60, 120, 240].into_iter().zip(by_node) {
        let found = on_a_mesh(WallLaw::PerNode, elements).deepest;
        assert!((found - deepest).abs() < 1e-6, "{elements} elements: {found} m");
    }
}

/// Orbit sizes \[m\] of the pipe on its low side at some depths, if it turns with a mass off its axis: in the free span, by the touchdown, and
/// on the wall. Damping has removed all motion but that by the mass before the window begins. The wall has no damper: by (11), a damper begins
/// with half its force at once when a node arrives, which leaves a scatter of half a per cent that falls with the mesh by the first order only.
fn orbits_of_a_turning_pipe(elements: u32) -> Vec<f64> {
    orbits_of(&turning_pipe(elements, 4.0))
}

/// The pipe with a mass \[kg\] off its axis.
fn turning_pipe(elements: u32, mass: f64) -> Scenario {
    let mut scenario = pipe_on_the_low_side(WallLaw::PerLength, 2e5, elements);
    scenario.string.unbalance = vec![UnbalanceMass {
        measured_depth: Some(6.0),
        above_bit: None,
        section: None,
        above_end: None,
        mass,
        radius: 0.05,
        phase_deg: 0.0,
    }];
    scenario.operation.rotation_speed_rpm = 120.0;
    scenario.damping = RayleighDamping { mass_proportional: 6.0, stiffness_proportional: 3e-5 };
    scenario.contact.damping_per_length = Some(0.0);
    (scenario.duration, scenario.recording.rate_hz) = (5.0, 1000.0);
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = Some(TimeWindow { from: 4.0, to: 5.0 }.into());
    scenario.recording.nodes = [4.0, 10.0, 20.0].map(NodeChoice::Depth).to_vec();
    scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Esdirk4, 1e-3));
    validate(&scenario).expect("valid");
    scenario
}

fn orbits_of(scenario: &Scenario) -> Vec<f64> {
    let model = Model::new(scenario).expect("has a model");
    let equilibrium = rest(&model);
    let Ok(Outcome::Finished(records)) =
        Transient::new(&model, &equilibrium).expect("sets up").run(&Control::new())
    else {
        panic!("did not finish")
    };
    let size = |history: &NodeHistory| {
        let samples = sample_range(4.0, 5.0, records.rate_hz, history.u.len());
        let orbit = orbit_statistics(&history.u[samples.clone()], &history.v[samples]).expect("samples");
        orbit.orbit_radius_rms
    };
    records.histories.iter().map(size).collect()
}

#[test]
fn small_orbits_are_those_of_the_linear_response_to_the_unbalance() {
    // A tenth of the mass, so that the string stays on the wall at its place of rest.
    let mut scenario = turning_pipe(60, 0.4);
    scenario.statics.friction = StartFriction::Sliding;
    let model = Model::new(&scenario).expect("has a model");
    let pencil = Pencil::about(&model, &rest(&model));
    let response = Receptance::of(&pencil, 2.0).expect("no resonance").to_unbalance(&model);
    for (depth, in_time) in [4.0, 10.0, 20.0].into_iter().zip(orbits_of(&scenario)) {
        let [u, v, ..] = response[model.mesh.nearest_node(depth)];
        let linear = (0.5 * (u.norm_sqr() + v.norm_sqr())).sqrt();
        assert!((linear / in_time - 1.0).abs() < 0.02, "{depth} m: {linear} m, in time {in_time} m");
    }
}

#[test]
fn orbits_converge_at_second_order_or_faster() {
    // Mass and recorded depths are nodes of all these meshes.
    let limit = orbits_of_a_turning_pipe(240);
    let errors = [30, 120].map(|elements| {
        let found = orbits_of_a_turning_pipe(elements);
        [0, 1, 2].map(|place| (found[place] / limit[place] - 1.0).abs())
    });
    for place in 0..3 {
        let [coarse, fine] = errors.map(|errors| errors[place]);
        // Two octaves of second order are a sixteenth. Contact at the nodes leaves some 1e-2 on 30 elements, and second order at best.
        assert!(coarse < 1e-3 && fine < coarse / 16.0, "{place}: {errors:?}");
    }
}

/// Static radius \[m\] of the base case at node 49 of the paper, on a drillpipe body between two tool joints, with elements `factor` times as
/// long.
fn radius_of_the_base_case(factor: f64) -> f64 {
    let mut scenario = preset("paper-200m").expect("shipped preset");
    scenario.contact.law = WallLaw::PerLength;
    scenario.scale_mesh(factor);
    let model = Model::new(&scenario).expect("has a model");
    let [u, v, ..] = rest(&model).displacement[model.mesh.nearest_node(57.73)];
    u.hypot(v)
}

#[test]
fn radius_between_tool_joints_is_that_of_a_fine_mesh_on_one_element_a_joint() {
    // Joints carry the pipe there, and roll on the wall with its sag: contact at their nodes alone, which is too stiff against that, leaves 1e-3.
    let found = [1.0, 0.5, 0.25, 0.125].map(radius_of_the_base_case);
    let limit = found[3];
    for (radius, most) in found.iter().zip([2e-5, 5e-6, 2e-6]) {
        assert!((radius / limit - 1.0).abs() < most, "{found:?}");
    }
}

#[test]
fn estimate_of_the_meshs_part_is_the_distance_from_a_much_finer_mesh() {
    let scaled = |factor: f64| {
        let mut scenario = preset("paper-200m").expect("shipped preset");
        scenario.contact.law = WallLaw::PerLength;
        scenario.scale_mesh(factor);
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
    let (mut worst, mut recorded) = (0.0_f64, 0.0_f64);
    for (i, (node, x)) in model.mesh.nodes.iter().zip(&equilibrium.displacement).enumerate() {
        let nearest = fine_model.mesh.nearest_node(node.measured_depth);
        // The part above the first joint is cut into elements of other lengths.
        if (fine_model.mesh.nodes[nearest].measured_depth - node.measured_depth).abs() > 1e-9 {
            continue;
        }
        let y = fine.displacement[nearest];
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

/// The damped base case in a well of these stations (depth, inclination, azimuth), on a wall by length.
fn base_case_in(stations: &[[f64; 3]]) -> Scenario {
    let mut scenario = preset("paper-200m-damped").expect("shipped preset");
    scenario.contact.law = WallLaw::PerLength;
    if !stations.is_empty() {
        let station = |&[measured_depth, inclination_deg, azimuth_deg]: &[f64; 3]| SurveyStation {
            measured_depth,
            inclination_deg,
            azimuth_deg,
        };
        scenario.well.survey = stations.iter().map(station).collect();
    }
    scenario
}

#[test]
fn automatic_mesh_has_the_equilibrium_of_a_fine_one() {
    for (name, stations) in [
        ("base case", &[][..]),
        ("horizontal", &[[0.0, 85.0, 0.0], [80.0, 90.0, 0.0], [200.0, 88.0, 0.0]]),
        ("building", &[[0.0, 25.0, 0.0], [100.0, 40.0, 10.0], [200.0, 60.0, 15.0]]),
    ] {
        let given = base_case_in(stations);
        let on = |mesh: Mesh| {
            let model = Model::new(&Scenario { mesh, ..given.clone() }).expect("has a model");
            let equilibrium = rest(&model);
            (model, equilibrium)
        };
        // Eight times as fine as any of these on wall and bodies, and with twice the elements of a joint: shorter ones there are lost in
        // the rounding of a bending stiffness that grows with the third power.
        let mut finest =
            Scenario { mesh: preset("paper-200m").expect("shipped preset").mesh, ..given.clone() };
        finest.scale_mesh(0.0625);
        finest.mesh.lengths_mut().expect("has target lengths").tool_joint = 0.3 / 16.0;
        let (fine_model, fine) = on(finest.mesh);
        // Place of the worst node, over the hole's radius; between the fine mesh's nodes on a straight line.
        let depths = fine_model.mesh.depths();
        let error = |(model, equilibrium): &(Model, Equilibrium)| {
            let nodes = model.mesh.nodes.iter().zip(&equilibrium.displacement);
            let off = nodes.map(|(node, x)| {
                let below =
                    depths.partition_point(|&depth| depth < node.measured_depth).clamp(1, depths.len() - 1);
                let (top, bottom) = (depths[below - 1], depths[below]);
                let share = (node.measured_depth - top) / (bottom - top);
                let at = |i: usize| {
                    fine.displacement[below - 1][i] * (1.0 - share) + fine.displacement[below][i] * share
                };
                (x[0] - at(0)).hypot(x[1] - at(1))
            });
            off.fold(0.0, f64::max) / (0.5 * given.well.hole_diameter)
        };
        let auto_error = error(&on(Mesh::AUTO));
        assert!(auto_error < 1e-4, "{name}: {auto_error} of the hole's radius");
    }
}
