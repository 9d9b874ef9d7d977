//! Modes about an equilibrium against dense eigenvalues, textbook solutions and figures of the base case.

mod common;

use std::f64::consts::{PI, TAU};

use common::{STEEL, eigenvalues};
use drillsweep_scenario::{Effect, Material, Scenario, Section, Switch, preset};
use drillsweep_sim::force::effect::active_effects;
use drillsweep_sim::math::linalg::BlockTridiagonal;
use drillsweep_sim::solve::model::{Model, add_element_matrix};
use drillsweep_sim::solve::modes::{
    Completeness, InstabilityKind, Mode, ModeKind, ModeSearch, Modes, Pencil, Receptance, Stability, modes,
    modes_of, static_stability,
};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::string::beam::{BeamElement, BeamSection, ElementMatrix};
use nalgebra::DMatrix;

fn base() -> Scenario {
    preset("paper-200m").expect("shipped preset")
}

fn modes_to(scenario: &Scenario, to_hz: f64) -> Vec<Mode> {
    let model = Model::new(scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let search = ModeSearch { to_hz, ..ModeSearch::default() };
    modes(&model, &equilibrium, &search).expect("found").modes
}

#[test]
fn base_case_has_the_frequencies_and_growth_of_an_independent_computation() {
    // Computed with dense eigenvalues (scipy) of another implementation about its own equilibrium: frequency, growth. Where growth
    // is small it is a difference of large numbers, so the two equilibria show in it.
    let expected = [
        (2.161, 0.09, true),
        (12.85, 0.16, true),
        (17.45, 0.18, true),
        (14.20, 0.33, false),
        (15.01, 0.72, false),
        (14.676, -0.019, false),
    ];
    let found = modes_to(&base(), 18.0);
    for (frequency, growth, torsional) in expected {
        let nearest = found
            .iter()
            .filter(|mode| (mode.kind == ModeKind::Torsional) == torsional)
            .min_by(|a, b| {
                let off = |m: &Mode| (m.frequency_hz - frequency).hypot(m.growth_rate - growth);
                off(a).total_cmp(&off(b))
            })
            .expect("there are modes");
        assert!((nearest.frequency_hz / frequency - 1.0).abs() < 1e-3, "{frequency} Hz: {nearest:?}");
        assert!((nearest.growth_rate - growth).abs() < 0.012, "{frequency} Hz: {nearest:?}");
    }
    // Sliding friction excites backward whirl (dry-friction whirl) and damps forward whirl.
    let flutter = found.iter().filter(|mode| mode.growth_rate > 0.3);
    assert!(flutter.clone().count() == 2 && flutter.clone().all(|mode| mode.kind == ModeKind::Backward));
}

#[test]
fn every_eigenvalue_of_a_band_is_found() {
    // A coarse mesh, whose dense eigenvalues can be had: all couplings and closed contacts take part.
    let mut scenario = base();
    let mesh = scenario.mesh.lengths_mut().expect("has target lengths");
    (mesh.drillpipe, mesh.tool_joint, mesh.collar, mesh.stabilizer, mesh.bit) = (10.0, 0.3, 10.0, 2.0, 0.5);
    scenario.string.unbalance.clear();
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let pencil = Pencil::about(&model, &equilibrium);
    let free: Vec<usize> =
        pencil.held.as_flattened().iter().enumerate().filter(|(_, held)| !**held).map(|(i, _)| i).collect();
    let dense = |matrix: &BlockTridiagonal| {
        let n = matrix.rows();
        let mut full = DMatrix::zeros(6 * n, 6 * n);
        for row in 0..n {
            let sides =
                [(row.wrapping_sub(1), &matrix.lower), (row, &matrix.diagonal), (row + 1, &matrix.upper)];
            for (column, blocks) in sides {
                for i in (0..36).filter(|_| column < n) {
                    full[(6 * row + i / 6, 6 * column + i % 6)] = blocks[row][(i / 6, i % 6)];
                }
            }
        }
        common::select(&full, &free)
    };
    let all = eigenvalues(&dense(&pencil.mass), &dense(&pencil.damping), &dense(&pencil.stiffness));
    let (from_hz, to_hz) = (0.0, 60.0);
    let mut expected: Vec<_> = all
        .into_iter()
        .filter(|value| value.im > 1e-3 && (TAU * from_hz..=TAU * to_hz).contains(&value.im))
        .filter(|value| value.re.abs() < 5.0)
        .collect();
    expected.sort_by(|a, b| a.im.total_cmp(&b.im));
    let found =
        modes(&model, &equilibrium, &ModeSearch { from_hz, to_hz, ..ModeSearch::default() }).expect("found");
    assert!(found.complete_to_rate > 5.0 && found.complete_to_hz == to_hz);
    assert_eq!(found.completeness, Completeness::Counted);
    let found: Vec<_> = found
        .modes
        .into_iter()
        .filter(|mode| mode.growth_rate.abs() < 5.0 && mode.frequency_hz > 1e-3)
        .collect();
    assert!(expected.len() > 50);
    assert_eq!(found.len(), expected.len());
    for (mode, value) in found.iter().zip(&expected) {
        let error = (mode.growth_rate - value.re).hypot(TAU * mode.frequency_hz - value.im);
        assert!(error < 1e-5 * value.norm(), "{mode:?} against {value}");
    }
}

/// A straight beam with its matrices, lateral degrees of freedom only.
struct Beam {
    element: BeamElement,
    pencil: Pencil,
}

impl Beam {
    fn new(section: BeamSection, length: f64, count: usize) -> Self {
        let zero = BlockTridiagonal::zeros(count + 1);
        let held = vec![[false, false, true, false, false, true]; count + 1];
        let mut beam = Self {
            element: BeamElement::new(section, length / count as f64),
            pencil: Pencil { mass: zero.clone(), damping: zero.clone(), stiffness: zero, held },
        };
        let (mass, stiffness) = (beam.element.mass(), beam.element.stiffness());
        beam.add(|pencil| &mut pencil.mass, &mass);
        beam.add(|pencil| &mut pencil.stiffness, &stiffness);
        beam
    }

    fn add(&mut self, of: fn(&mut Pencil) -> &mut BlockTridiagonal, matrix: &ElementMatrix) {
        let target = of(&mut self.pencil);
        for e in 0..target.rows() - 1 {
            add_element_matrix(target, e, matrix);
        }
    }

    fn hold(mut self, node: usize, dofs: &[usize]) -> Self {
        for &dof in dofs {
            self.pencil.held[node][dof] = true;
        }
        self
    }

    fn pinned(self) -> Self {
        let last = self.pencil.held.len() - 1;
        self.hold(0, &[0, 1]).hold(last, &[0, 1])
    }

    fn modes(&self, to_hz: f64) -> Vec<Mode> {
        let found = self.search(to_hz);
        assert_eq!(found.completeness, Completeness::Counted);
        found.modes
    }

    fn search(&self, to_hz: f64) -> Modes {
        let pencil = self.pencil.clone();
        let pencil = Pencil::new(pencil.mass, pencil.damping, pencil.stiffness, pencil.held);
        let depths: Vec<f64> = (0..pencil.held.len()).map(|i| i as f64 * self.element.length()).collect();
        modes_of(&pencil, &depths, &ModeSearch { to_hz, ..ModeSearch::default() }).expect("found")
    }

    fn grows(&self, to_hz: f64) -> Option<Mode> {
        let most = self.modes(to_hz).into_iter().max_by(|a, b| a.growth_rate.total_cmp(&b.growth_rate));
        most.filter(|mode| mode.growth_rate > 1e-6 * TAU * to_hz)
    }
}

fn collar() -> BeamSection {
    BeamSection::pipe(0.159, 0.071, &STEEL)
}

#[test]
fn round_beam_has_timoshenkos_frequencies_twice() {
    // Bernoulli and Euler's n^2 pi^2 sqrt(EI / rho S L^4), lowered by rotary inertia and shear (Timoshenko 1921, to first order):
    // (n pi / L)^2 (I / S) (1 + E / kG) / 2.
    let (section, length) = (collar(), 20.0);
    let found = Beam::new(section, length, 24).pinned().modes(40.0);
    let bernoulli =
        (PI / length).powi(2) * (section.bending_stiffness() / (section.density * section.area)).sqrt();
    let correction = 0.5
        * (PI / length).powi(2)
        * (section.second_moment / section.area)
        * (1.0 + STEEL.youngs_modulus * section.area / (section.shear_modulus * section.shear_area));
    for n in 1..=4 {
        let order = f64::from(n * n);
        let expected = order * bernoulli * (1.0 - order * correction) / TAU;
        let pair = &found[2 * n as usize - 2..2 * n as usize];
        for mode in pair {
            assert!((mode.frequency_hz / expected - 1.0).abs() < 5e-4, "{mode:?} against {expected}");
            assert!(mode.growth_rate.abs() < 1e-6 && mode.lateral_share > 0.999_999);
        }
    }
}

#[test]
fn rotation_splits_a_pair_into_forward_and_backward_whirl() {
    // To first order in Omega a simply supported shaft's pair splits by 2 Omega (n pi / L)^2 I / S.
    let (section, length, omega) = (collar(), 5.0, 200.0);
    let mut beam = Beam::new(section, length, 24).pinned();
    let gyroscopic = beam.element.gyroscopic(omega);
    beam.add(|pencil| &mut pencil.damping, &gyroscopic);
    let found = beam.modes(40.0);
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!([found[0].kind, found[1].kind], [ModeKind::Backward, ModeKind::Forward]);
    assert!(found[0].whirl < -0.999 && found[1].whirl > 0.999, "circles");
    let split = TAU * (found[1].frequency_hz - found[0].frequency_hz);
    let expected = 2.0 * omega * (PI / length).powi(2) * section.second_moment / section.area;
    assert!((split / expected - 1.0).abs() < 0.01, "{split} against {expected}");
}

#[test]
fn static_instabilities_begin_at_their_published_loads() {
    // Euler's load with Engesser's shear; Greenhill's torque 2 pi EI / L; divergence of a pinned pipe conveying fluid at u = pi
    // (Paidoussis 1998).
    let (section, length) = (collar(), 20.0);
    let stiffness = section.bending_stiffness();
    let euler = PI.powi(2) * stiffness / (length * length);
    let euler = euler / (1.0 + euler / (section.shear_modulus * section.shear_area));
    let greenhill = 2.0 * PI * stiffness / length;
    let bore_mass = 20.0_f64;
    let divergence = PI * (stiffness / bore_mass).sqrt() / length;
    let loaded = |change: &dyn Fn(&mut Beam)| {
        let mut beam = Beam::new(section, length, 24).pinned();
        change(&mut beam);
        beam.grows(20.0)
    };
    let compressed = |force: f64| {
        loaded(&|beam| {
            let change = beam.element.tension_stiffening() * -force;
            beam.add(|pencil| &mut pencil.stiffness, &change);
        })
    };
    let twisted = |torque: f64| {
        loaded(&|beam| {
            let change = beam.element.torque_stiffening() * -torque;
            beam.add(|pencil| &mut pencil.stiffness, &change);
        })
    };
    let flowing = |speed: f64| {
        loaded(&|beam| {
            let mass = beam.element.lateral_mass() * bore_mass;
            let coriolis = beam.element.coriolis() * (2.0 * bore_mass * speed);
            let centrifugal = beam.element.tension_stiffening() * -(bore_mass * speed * speed);
            beam.add(|pencil| &mut pencil.mass, &mass);
            beam.add(|pencil| &mut pencil.damping, &coriolis);
            beam.add(|pencil| &mut pencil.stiffness, &centrifugal);
        })
    };
    type Loaded<'a> = &'a dyn Fn(f64) -> Option<Mode>;
    let cases: [(&str, Loaded<'_>, f64); 3] = [
        ("Euler", &compressed, euler),
        ("Greenhill", &twisted, greenhill),
        ("divergence", &flowing, divergence),
    ];
    for (name, grows, critical) in cases {
        assert_eq!(grows(0.998 * critical), None, "{name}: stable below");
        let mode = grows(1.002 * critical).unwrap_or_else(|| panic!("{name}: unstable above"));
        assert_eq!(mode.frequency_hz, 0.0, "{name} does not turn: {mode:?}");
    }
}

#[test]
fn cantilever_conveying_fluid_flutters_at_the_published_speed() {
    // u = 5.5915 at beta = 0.2, frequency 13.715 (Gregory and Paidoussis 1966); the rod is thin, so shear plays no part.
    let (section, length, beta) = (BeamSection::pipe(0.02, 0.0, &STEEL), 10.0_f64, 0.2);
    let mass = section.density * section.area;
    let bore_mass = mass * beta / (1.0 - beta);
    let unit = (section.bending_stiffness() / ((mass + bore_mass) * length.powi(4))).sqrt();
    let most = |u: f64| {
        let speed = u * (section.bending_stiffness() / bore_mass).sqrt() / length;
        let mut beam = Beam::new(section, length, 20).hold(0, &[0, 1, 3, 4]);
        let added = beam.element.lateral_mass() * bore_mass;
        let coriolis = beam.element.coriolis() * (2.0 * bore_mass * speed);
        let centrifugal = beam.element.tension_stiffening() * -(bore_mass * speed * speed);
        let follower = beam.element.flow_end() * (bore_mass * speed * speed);
        beam.add(|pencil| &mut pencil.mass, &added);
        beam.add(|pencil| &mut pencil.damping, &coriolis);
        beam.add(|pencil| &mut pencil.stiffness, &centrifugal);
        add_element_matrix(&mut beam.pencil.stiffness, 19, &follower);
        beam.grows(60.0 * unit / TAU)
    };
    assert_eq!(most(5.56), None);
    let mode = most(5.63).expect("flutters");
    assert!((TAU * mode.frequency_hz / unit / 13.715 - 1.0).abs() < 0.02, "{mode:?}");
}

/// The Coriolis terms of both flows on a wave along the string: `c = 2 rho Q - 2 chi rho A_o U_o`, the flow in the bore downwards, that in the
/// annulus upwards. With kappa = D_o / D_ch both are `2 rho Q (1 - kappa^2 (1 + kappa^2) / (1 - kappa^2)^2)`: they cancel at
/// kappa^2 = 1/3, below that the bore's prevails and speeds up waves that travel down.
#[test]
fn opposite_flows_cancel_in_a_pipe_of_a_third_of_the_holes_area() {
    let with_ratio = |ratio: f64, coriolis: Switch| {
        let mut scenario = preset("hard/vertical").expect("shipped preset");
        let mut pipe = scenario.string.sections[0].clone();
        pipe.outer_diameter = ratio * scenario.well.hole_diameter;
        (pipe.length, pipe.count, pipe.tool_joint) = (200.0, 1, None);
        scenario.string.sections = vec![pipe];
        scenario.string.gauges.clear();
        scenario.string.unbalance.clear();
        scenario.recording.nodes.clear();
        scenario.effects.set(Effect::FluidCoriolis, coriolis);
        let model = Model::new(&scenario).expect("valid");
        let equilibrium = Equilibrium::find(&model).expect("rests");
        (
            scenario.mud.expect("wet"),
            model.mesh.depths().to_vec(),
            Pencil::about(&model, &equilibrium).damping,
        )
    };
    // Eight waves within an envelope s that rests at the held ends: the integral of s^2 over the length L is 3/8 L.
    let (length, waves) = (200.0_f64, 8.0);
    let (slow, fast) = (PI / length, TAU * waves / length);
    let field = |depths: &[f64], phase: f64| -> Vec<[f64; 6]> {
        let at = |z: f64| {
            let (sin, cos) = (slow * z).sin_cos();
            let wave = fast * z + phase;
            let slope = 2.0 * slow * sin * cos * wave.sin() + fast * sin * sin * wave.cos();
            [sin * sin * wave.sin(), 0.0, 0.0, 0.0, slope, 0.0]
        };
        depths.iter().map(|&z| at(z)).collect()
    };
    for ratio in [0.52_f64, 3_f64.sqrt().recip(), 0.65] {
        let (mud, depths, with) = with_ratio(ratio, Switch::On);
        let (_, _, without) = with_ratio(ratio, Switch::Off);
        // Velocity a sine and displacement a cosine: c times the velocity's derivative is in phase with the displacement.
        let (displacement, velocity) = (field(&depths, PI / 2.0), field(&depths, 0.0));
        let mut force = vec![[0.0; 6]; depths.len()];
        with.multiply_add(&velocity, &mut force);
        let mut other = vec![[0.0; 6]; depths.len()];
        without.multiply_add(&velocity, &mut other);
        let products = |force: &[[f64; 6]]| -> f64 {
            force.as_flattened().iter().zip(displacement.as_flattened()).map(|(f, x)| f * x).sum()
        };
        let square = ratio * ratio;
        let unit = 2.0 * mud.density * mud.flow_rate * fast * 3.0 / 16.0 * length;
        let expected = 1.0 - square * (1.0 + square) / (1.0 - square).powi(2);
        let found = (products(&force) - products(&other)) / unit;
        assert!((found - expected).abs() < 5e-3, "{ratio}: {found} for {expected}");
    }
}

#[test]
fn without_velocity_weakening_friction_torsion_does_not_grow() {
    // The slope of the friction curve excites it: with mu_d = mu_s there is none.
    let mut scenario = base();
    scenario.contact.dynamic_friction = scenario.contact.static_friction;
    let grows = |scenario: &Scenario| {
        modes_to(scenario, 18.0)
            .into_iter()
            .any(|mode| mode.kind == ModeKind::Torsional && mode.growth_rate > 0.0)
    };
    assert!(!grows(&scenario));
    scenario.contact.dynamic_friction = 0.2;
    assert!(grows(&scenario));
    scenario.effects.set(Effect::FrictionTorque, Switch::Off);
    assert!(!grows(&scenario), "nor without friction's torque");
}

#[test]
fn twist_of_a_driven_shaft_is_a_standing_wave() {
    let mut scenario = preset("hard/vertical").expect("shipped preset");
    scenario.damping.mass_proportional = 0.0;
    scenario.damping.stiffness_proportional = 0.0;
    scenario.contact.static_friction = 0.0;
    scenario.contact.dynamic_friction = 0.0;
    scenario.effects.set(Effect::Torsion, Switch::On);
    let mut pipe = scenario.string.sections[0].clone();
    (pipe.length, pipe.count, pipe.tool_joint) = (200.0, 1, None);
    scenario.string.sections = vec![pipe];
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.recording.nodes.clear();
    let model = Model::new(&scenario).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    let pencil = Pencil::about(&model, &equilibrium);
    let material = &scenario.string.material;
    let speed = (material.youngs_modulus / (2.0 * (1.0 + material.poissons_ratio)) / material.density).sqrt();
    let length = *model.mesh.depths().last().expect("has nodes");
    for hz in [0.5, 3.0, 9.0] {
        let response = Receptance::of(&pencil, hz).expect("no resonance").to_twist_of_bit();
        let number = TAU * hz / speed;
        for (depth, node) in model.mesh.depths().iter().zip(&response) {
            let exact = (number * depth).sin() / (number * length).sin();
            // The mesh's error is of the fourth power of number times element, next to a resonance more.
            assert!(
                (node[5].re - exact).abs() < 1e-3 && node[5].im.abs() < 1e-6,
                "{hz} Hz at {depth} m: {} {exact}",
                node[5]
            );
        }
    }
}

/// The frequencies \[Hz\] of a pipe that hangs clamped, by Ritz' method with x^2 times Legendre polynomials: bending stiffness and weight,
/// without shear and rotary inertia.
fn hanging_frequencies(section: &BeamSection, length: f64, gravity: f64) -> Vec<f64> {
    const TERMS: usize = 14;
    let mass = section.density * section.area;
    let (mut inertia, mut stiffness) =
        (DMatrix::<f64>::zeros(TERMS, TERMS), DMatrix::<f64>::zeros(TERMS, TERMS));
    let points = 4000;
    for point in 0..points {
        let x = (f64::from(point) + 0.5) / f64::from(points);
        let t = 2.0 * x - 1.0;
        // P, P', P'' in t by Bonnet's recurrence and its derivatives.
        let mut legendre = vec![[1.0, 0.0, 0.0], [t, 1.0, 0.0]];
        for n in 1..TERMS - 1 {
            let (order, [p, q]) = (n as f64, [legendre[n], legendre[n - 1]]);
            let next = |k: usize, extra: f64| {
                ((2.0 * order + 1.0) * (t * p[k] + extra) - order * q[k]) / (order + 1.0)
            };
            legendre.push([next(0, 0.0), next(1, p[0]), next(2, 2.0 * p[1])]);
        }
        let shapes: Vec<[f64; 3]> = legendre
            .iter()
            .map(|[p, q, r]| {
                let (q, r) = (2.0 * q, 4.0 * r);
                [x * x * p, 2.0 * x * p + x * x * q, 2.0 * p + 4.0 * x * q + x * x * r]
            })
            .collect();
        let weight = length / f64::from(points);
        let tension = mass * gravity * length * (1.0 - x);
        for i in 0..TERMS {
            for j in 0..TERMS {
                let (a, b) = (&shapes[i], &shapes[j]);
                inertia[(i, j)] += weight * mass * a[0] * b[0];
                stiffness[(i, j)] += weight
                    * (tension * a[1] * b[1] / length.powi(2)
                        + section.bending_stiffness() * a[2] * b[2] / length.powi(4));
            }
        }
    }
    let inverse = inertia.cholesky().expect("positive").l().try_inverse().expect("regular");
    let reduced: DMatrix<f64> = &inverse * stiffness * inverse.transpose();
    let mut squares: Vec<f64> =
        (0.5 * (&reduced + reduced.transpose())).symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(f64::total_cmp);
    squares.iter().map(|square| square.sqrt() / TAU).collect()
}

#[test]
fn hanging_pipe_has_its_modes_on_coarse_and_fine_meshes() {
    // Of K x, a hundred thousand times smaller than its terms on 4 cm, little but rounding is left.
    let (section, length, gravity) = (BeamSection::pipe(0.127, 0.108, &STEEL), 100.0, 9.81);
    let expected = hanging_frequencies(&section, length, gravity);
    assert!(expected[2] < 0.39 && expected[3] > 0.39, "{expected:?}");
    for count in [100, 500, 2500] {
        let mut beam = Beam::new(section, length, count).hold(0, &[0, 1, 3, 4]);
        let unit = beam.element.tension_stiffening();
        let weight = section.density * section.area * gravity * beam.element.length();
        for e in 0..count {
            let tension = weight * (count as f64 - e as f64 - 0.5);
            add_element_matrix(&mut beam.pencil.stiffness, e, &(unit * tension));
        }
        let found = beam.modes(0.39);
        assert_eq!(found.len(), 6, "{count} elements: {found:?}");
        for (mode, order) in found.iter().zip([0, 0, 1, 1, 2, 2]) {
            // Errors of the mesh are in proportion to (h / L)^2 of the tension's steps, and rounding's to (L / h)^4 epsilon.
            assert!((mode.frequency_hz / expected[order] - 1.0).abs() < 1e-3, "{count} elements: {mode:?}");
        }
    }
}

#[test]
fn stiff_walls_hold_as_supports_do() {
    // A beam on a wall in its middle is one of half the length, pinned or, where it is even, clamped there: (n pi)^2 and 3.9266^2 (Blevins).
    let length = 20.0;
    for (material, stiffness) in [(STEEL, 1e13), (Material { density: 80.0, ..STEEL }, 1e10)] {
        let section = BeamSection::pipe(0.02, 0.0, &material);
        let mut beam = Beam::new(section, length, 400).pinned();
        for dof in [0, 1] {
            beam.pencil.stiffness.diagonal[200][(dof, dof)] += stiffness;
        }
        let unit = (section.bending_stiffness() / (section.density * section.area)).sqrt() / TAU;
        let half = 0.5 * length;
        let pinned = |n: f64| unit * (n * PI / half).powi(2);
        let clamped = |wave: f64| unit * (wave / half).powi(2);
        let expected = [pinned(1.0), clamped(3.926_602), pinned(2.0), clamped(7.068_583)];
        let found = beam.modes(0.5 * (expected[3] + pinned(3.0)));
        assert_eq!(found.len(), 8, "{stiffness:e} N/m: {found:?}");
        for (pair, expected) in found.chunks(2).zip(expected) {
            for mode in pair {
                assert!((mode.frequency_hz / expected - 1.0).abs() < 1e-3, "{mode:?} against {expected} Hz");
            }
        }
    }
}

#[test]
fn growing_modes_are_found_on_a_mesh_of_thousands() {
    // Velocity-weakening friction excites torsion of 200 m of string; steps of 4 cm or 50 cm are equal for a wave of a kilometre.
    let growing = |length: f64| {
        let mut scenario = preset("hard/elements-5000").expect("shipped preset");
        let mesh = scenario.mesh.lengths_mut().expect("has target lengths");
        (mesh.drillpipe, mesh.collar) = (length, length);
        let (model, search) = (
            Model::new(&scenario).expect("valid"),
            ModeSearch { from_hz: 2.05, to_hz: 2.2, ..ModeSearch::default() },
        );
        let found = modes(&model, &Equilibrium::find(&model).expect("rests"), &search).expect("found");
        assert_eq!(found.completeness, Completeness::Counted, "{length} m");
        let growing: Vec<Mode> = found.modes.into_iter().filter(|mode| mode.growth_rate > 0.0).collect();
        assert_eq!(growing.len(), 1, "{length} m: {growing:?}");
        growing[0]
    };
    let (fine, coarse) = (growing(0.04), growing(0.5));
    assert_eq!(fine.kind, ModeKind::Torsional);
    assert!((fine.frequency_hz / coarse.frequency_hz - 1.0).abs() < 1e-3, "{fine:?} against {coarse:?}");
    assert!((fine.growth_rate / coarse.growth_rate - 1.0).abs() < 0.05, "{fine:?} against {coarse:?}");
}

#[test]
fn a_rod_of_two_materials_has_the_modes_of_a_stepped_rod() {
    // Held above and free below: Z_1 cos(w L_1 / c_1) cos(w L_2 / c_2) = Z_2 sin(w L_1 / c_1) sin(w L_2 / c_2) with the wave speeds
    // c^2 = E / rho (torsional G / rho) and the impedances Z = S rho c (I_p rho c); S and I_p are the same here.
    let mut scenario = base();
    for station in &mut scenario.well.survey {
        (station.inclination_deg, station.azimuth_deg) = (60.0, 30.0);
    }
    let aluminium = Material { youngs_modulus: 7.3e10, density: 2800.0, poissons_ratio: 0.33, grade: None };
    let (steel, collar) = (scenario.string.material, scenario.string.sections[2].clone());
    let section = |length, material| Section { length, count: 1, material, ..collar.clone() };
    scenario.string.sections = vec![section(90.0, None), section(110.0, Some(aluminium))];
    scenario.string.unbalance.clear();
    scenario.operation.weight_on_bit = -1e4;
    (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
    let found = modes_to(&scenario, 40.0);
    let shear = |material: &Material| material.youngs_modulus / (2.0 * (1.0 + material.poissons_ratio));
    let young = |material: &Material| material.youngs_modulus;
    type Modulus<'a> = &'a dyn Fn(&Material) -> f64;
    let kinds: [(ModeKind, Modulus<'_>); 2] = [(ModeKind::Axial, &young), (ModeKind::Torsional, &shear)];
    for (kind, modulus) in kinds {
        let [upper, lower] = [(90.0, steel), (110.0, aluminium)].map(|(length, material)| {
            let speed = (modulus(&material) / material.density).sqrt();
            (length / speed, material.density * speed)
        });
        let balance = |hz: f64| {
            let [(s1, c1), (s2, c2)] = [upper, lower].map(|(time, _)| (TAU * hz * time).sin_cos());
            upper.1 * c1 * c2 - lower.1 * s1 * s2
        };
        let expected = roots(balance, 40.0);
        let frequencies: Vec<f64> =
            found.iter().filter(|mode| mode.kind == kind).map(|mode| mode.frequency_hz).collect();
        assert!(expected.len() >= 3, "{kind:?}: {expected:?}");
        assert_eq!(frequencies.len(), expected.len(), "{kind:?}: {frequencies:?} against {expected:?}");
        for (found, expected) in frequencies.iter().zip(&expected) {
            // Linear elements are (k h)^2 / 24 too stiff, 1e-4 at 40 Hz.
            assert!((found / expected - 1.0).abs() < 2e-4, "{kind:?}: {found} against {expected}");
        }
    }
}

/// The determinant of the conditions at the lower end of a weightless cantilever under a pull of constant direction at a frequency \[Hz\], whose
/// zeros are its frequencies: `y = A (cosh s x - cos t x) + B (sinh s x - s/t sin t x)` with no moment and `E I y^(3) = P y'` there.
fn pulled_cantilever(section: &BeamSection, length: f64, pull: f64, hz: f64) -> f64 {
    let half = 0.5 * pull / section.bending_stiffness();
    let inertia = section.density * section.area * (TAU * hz).powi(2) / section.bending_stiffness();
    let root = (half * half + inertia).sqrt();
    let (s, t) = ((root + half).sqrt(), (root - half).sqrt());
    let ((sinh, cosh), (sin, cos)) = (((s * length).sinh(), (s * length).cosh()), (t * length).sin_cos());
    let by_a = [s * s * cosh + t * t * cos, s * t * t * sinh - s * s * t * sin];
    let by_b = [s * s * sinh + s * t * sin, s * t * t * cosh + s.powi(3) * cos];
    by_a[0] * by_b[1] - by_a[1] * by_b[0]
}

#[test]
fn a_pull_raises_lateral_frequencies_as_tensioned_beams_have_them() {
    let length = 30.0;
    let mut scenario = base();
    scenario.mud = None;
    for station in &mut scenario.well.survey {
        (station.inclination_deg, station.azimuth_deg) = (0.0, 0.0);
    }
    scenario.string.sections = vec![Section { length, count: 1, ..scenario.string.sections[0].clone() }];
    (scenario.string.gauges, scenario.string.unbalance) = (Vec::new(), Vec::new());
    scenario.mesh.lengths_mut().expect("has target lengths").drillpipe = 0.5;
    (scenario.operation.rotation_speed_rpm, scenario.operation.torque_on_bit) = (0.0, 0.0);
    scenario.damping.mass_proportional = 0.0;
    scenario.effects.set(Effect::Contact, Switch::Off);
    scenario.effects.set(Effect::Gravity, Switch::Off);
    let material = scenario.string.material;
    let of = &scenario.string.sections[0];
    let section = BeamSection::pipe(of.outer_diameter, of.inner_diameter, &material);
    let mass = section.density * section.area;
    let shear = section.axial_stiffness() / (section.shear_modulus * section.shear_area);
    let mut lowest = Vec::new();
    for pull in [0.0, 2e4, 4e5] {
        scenario.operation.weight_on_bit = pull;
        let expected = roots(|hz| pulled_cantilever(&section, length, pull, hz), 5.0);
        assert!(expected.len() >= 2, "{pull} N: {expected:?}");
        let found: Vec<Mode> = modes_to(&scenario, 5.0)
            .into_iter()
            .filter(|mode| ![ModeKind::Axial, ModeKind::Torsional].contains(&mode.kind))
            .collect();
        assert_eq!(found.len(), 2 * expected.len(), "{pull} N: {found:?} against {expected:?}");
        for (pair, expected) in found.chunks(2).zip(&expected) {
            for mode in pair {
                // Shear and rotary inertia lower them by (1 + E / k_S G) (k r)^2 / 2 (Timoshenko 1921), k^2 = w (m / E I)^(1/2) without a pull.
                let wave = TAU * expected * (mass / section.bending_stiffness()).sqrt();
                let lower = 0.5 * (1.0 + shear) * wave * section.second_moment / section.area;
                let ratio = mode.frequency_hz / expected;
                assert!((1.0 - ratio).abs() < 1.5 * lower + 1e-5, "{pull} N: {mode:?} against {expected} Hz");
            }
        }
        lowest.push(found[0].frequency_hz);
    }
    // Under a large pull it is a string held at one end, (P / m)^(1/2) / 4 L, but for its stiffness at the clamp: (E I / P)^(1/2) / L.
    let as_string = (4e5 / mass).sqrt() / (4.0 * length);
    let stiffness = (section.bending_stiffness() / 4e5).sqrt() / length;
    assert!(lowest[2] > as_string && lowest[2] < as_string * (1.0 + 2.0 * stiffness), "{lowest:?}");
}

/// The zeros of a function of the frequency \[Hz\] that changes slowly within a hundredth of a hertz.
fn roots(function: impl Fn(f64) -> f64, to_hz: f64) -> Vec<f64> {
    let at = |i: u32| 0.01 * (f64::from(i) + 0.5);
    let changes = (0..(100.0 * to_hz) as u32).filter(|&i| function(at(i)) * function(at(i + 1)) < 0.0);
    let bisected = changes.map(|i| {
        let (mut low, mut high) = (at(i), at(i + 1));
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if function(low) * function(middle) <= 0.0 { high = middle } else { low = middle }
        }
        low
    });
    bisected.filter(|hz| *hz < to_hz).collect()
}

/// Independent nodes on springs, all with one frequency.
fn equal_oscillators(nodes: usize) -> Pencil {
    let zero = BlockTridiagonal::zeros(nodes);
    let (mut mass, mut stiffness) = (zero.clone(), zero.clone());
    for node in 0..nodes {
        for dof in 0..6 {
            mass.diagonal[node][(dof, dof)] = 1.0;
            stiffness.diagonal[node][(dof, dof)] = 4.0;
        }
    }
    Pencil::new(mass, zero, stiffness, vec![[false; 6]; nodes])
}

#[test]
fn equal_eigenvalues_are_searched_again_and_missing_ones_reported() {
    // A Krylov space from two vectors holds two shapes of an eigenvalue, however many it has.
    let search = ModeSearch { to_hz: 1.0, ..ModeSearch::default() };
    let few = modes_of(&equal_oscillators(1), &[0.0], &search).expect("found");
    assert_eq!((few.modes.len(), few.completeness), (6, Completeness::Counted));
    let depths: Vec<f64> = (0..10).map(f64::from).collect();
    let many = modes_of(&equal_oscillators(10), &depths, &search).expect("found");
    assert!(many.modes.len() < 60, "too few searches");
    // With their conjugates.
    assert_eq!(many.completeness, Completeness::Missing(2 * (60 - many.modes.len())));
}

#[test]
fn straight_strings_have_the_modes_of_rods_unless_they_are_switched_off() {
    // A rod clamped above and free below: c (2 n - 1) / 4 L, axial with c^2 = E / rho, torsional with G / rho. If nothing in the scenario
    // excites these motions, a run in time omits them.
    let mut scenario = base();
    for station in &mut scenario.well.survey {
        (station.inclination_deg, station.azimuth_deg) = (60.0, 30.0);
    }
    scenario.string.sections =
        vec![Section { length: 200.0, count: 1, ..scenario.string.sections[2].clone() }];
    scenario.string.unbalance.clear();
    (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
    let active = active_effects(&scenario);
    assert!(!active.torsion && !active.axial_motion);
    let material = scenario.string.material;
    let shear = material.youngs_modulus / (2.0 * (1.0 + material.poissons_ratio));
    let of_kind = |scenario: &Scenario, kind| -> Vec<f64> {
        let found = modes_to(scenario, 20.0).into_iter().filter(|mode| mode.kind == kind);
        found.map(|mode| mode.frequency_hz).collect()
    };
    for (kind, modulus, effect) in [
        (ModeKind::Axial, material.youngs_modulus, Effect::AxialMotion),
        (ModeKind::Torsional, shear, Effect::Torsion),
    ] {
        let quarter = (modulus / material.density).sqrt() / (4.0 * 200.0);
        let expected: Vec<f64> =
            [1.0, 3.0, 5.0, 7.0].map(|n| n * quarter).into_iter().filter(|hz| *hz < 20.0).collect();
        let found = of_kind(&scenario, kind);
        assert_eq!(found.len(), expected.len(), "{kind:?}: {found:?} against {expected:?}");
        for (found, expected) in found.iter().zip(&expected) {
            // Linear elements are (k h)^2 / 24 too stiff, 1e-5 here.
            assert!((found / expected - 1.0).abs() < 1e-4, "{kind:?}: {found} against {expected}");
        }
        let mut without = scenario.clone();
        without.effects.set(effect, Switch::Off);
        assert_eq!(of_kind(&without, kind), [0.0; 0], "{kind:?} switched off");
    }
}

#[test]
fn a_buckled_column_on_the_axis_leaves_it_as_beam_theory_says() {
    // A column clamped above and free below under a thrust P that keeps its direction: E I y'''' + P y'' + m l^2 y = 0. With
    // a^2 + b^2 = P / E I and a b = sqrt(m / E I) l, y = A (cos a x - cos b x) + B (b sin a x - a sin b x) has y'' = 0 and
    // y''' + (P / E I) y' = 0 at its end.
    let (length, share) = (40.0, 1.1);
    let mut scenario = base();
    scenario.mud = None;
    for station in &mut scenario.well.survey {
        (station.inclination_deg, station.azimuth_deg) = (90.0, 0.0);
    }
    scenario.string.sections =
        vec![Section { length, count: 1, tool_joint: None, ..scenario.string.sections[2].clone() }];
    scenario.string.gauges.clear();
    scenario.string.unbalance.clear();
    scenario.recording.nodes.clear();
    scenario.effects.set(Effect::Gravity, Switch::Off);
    (scenario.damping.mass_proportional, scenario.operation.rotation_speed_rpm) = (0.0, 0.0);
    scenario.operation.torque_on_bit = 0.0;
    let of = &scenario.string.sections[0];
    let beam = BeamSection::pipe(of.outer_diameter, of.inner_diameter, &scenario.string.material);
    let thrust = share * (0.5 * PI / length).powi(2);
    scenario.operation.weight_on_bit = -thrust * beam.bending_stiffness();
    let determinant = |product: f64| {
        let root = (0.25 * thrust * thrust - product * product).sqrt();
        let (a, b) = ((0.5 * thrust + root).sqrt(), (0.5 * thrust - root).sqrt());
        let ((sin_a, cos_a), (sin_b, cos_b)) = ((a * length).sin_cos(), (b * length).sin_cos());
        // Over a b, which all terms have.
        let moment = [b * b * cos_b - a * a * cos_a, a * b * (b * sin_b - a * sin_a)];
        let shear = [a * sin_b - b * sin_a, b * b * cos_a - a * a * cos_b];
        moment[0] * shear[1] - moment[1] * shear[0]
    };
    let (mut low, mut high) = (1e-9 * thrust, 0.499 * thrust);
    let is_negative_below = determinant(low) < 0.0;
    while high - low > 1e-12 * thrust {
        let middle = 0.5 * (low + high);
        if (determinant(middle) < 0.0) == is_negative_below { low = middle } else { high = middle }
    }
    let growth = low * (beam.bending_stiffness() / (beam.density * beam.area)).sqrt();

    let judged = |scenario: &Scenario| {
        let model = Model::new(scenario).expect("valid");
        static_stability(&model, &Equilibrium::find(&model).expect("straight"))
    };
    let found = judged(&scenario).expect("negative stiffness");
    let unstable = found.instability.expect("unstable");
    assert_eq!((found.stable, unstable.kind), (Some(false), InstabilityKind::Buckling), "{found}");
    assert!(found.warning().is_some_and(|warning| warning.contains("buckling")));
    // Shear and rotary inertia take 1e-4 of it.
    assert!((unstable.growth_rate / growth - 1.0).abs() < 1e-3, "{found} instead of {growth} 1/s");

    scenario.operation.weight_on_bit /= 2.0 * share;
    assert_eq!(judged(&scenario), None);
}

#[test]
fn strings_on_the_wall_hold_and_a_pushed_one_on_the_axis_does_not() {
    for (name, holds) in [
        ("paper-200m", true),
        ("paper-200m-damped", true),
        ("closed/near-horizontal", true),
        ("hard/horizontal", true),
        ("hard/stick-slip", true),
        ("hard/near-buckling", true),
        ("hard/on-axis", true),
        ("hard/vertical", false),
        ("hard/beyond-buckling", false),
    ] {
        let model = Model::new(&preset(name).expect("shipped preset")).expect("valid");
        let found = static_stability(&model, &Equilibrium::find(&model).expect("rests"));
        let warning = found.as_ref().and_then(Stability::warning);
        assert_eq!(warning.is_none(), holds, "{name}: {found:?}");
        // Negative stiffness is looked for without friction, which makes none.
        assert_eq!(found.is_none(), holds, "{name}: {found:?}");
    }
}
