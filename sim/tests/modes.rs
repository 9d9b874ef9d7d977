//! Modes about an equilibrium against dense eigenvalues, textbook solutions and figures of the base case.

mod common;

use std::f64::consts::{PI, TAU};

use common::{STEEL, eigenvalues};
use drillsweep_sim::beam::{BeamElement, BeamSection, ElementMatrix};
use drillsweep_sim::linalg::BlockTridiagonal;
use drillsweep_sim::model::{Model, add_element_matrix};
use drillsweep_sim::modes::{Mode, ModeKind, ModeSearch, Pencil, modes, modes_of};
use drillsweep_sim::scenario::{Effect, Scenario, Switch, preset};
use drillsweep_sim::statics::Equilibrium;
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
    // Sliding friction feeds backward whirl (dry-friction whirl) and takes from forward whirl.
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
        let pencil = self.pencil.clone();
        let pencil = Pencil::new(pencil.mass, pencil.damping, pencil.stiffness, pencil.held);
        let depths: Vec<f64> = (0..pencil.held.len()).map(|i| i as f64 * self.element.length()).collect();
        modes_of(&pencil, &depths, &ModeSearch { to_hz, ..ModeSearch::default() }).expect("found").modes
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

#[test]
fn without_falling_friction_torsion_does_not_grow() {
    // The slope of the friction curve is what feeds it: with mu_d = mu_s there is none.
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
