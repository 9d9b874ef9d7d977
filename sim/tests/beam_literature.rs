//! Straight beams against textbook solutions: bending frequencies, gyroscopic split, buckling by tension and by
//! torque, pipes conveying fluid.

mod common;

use std::f64::consts::PI;

use common::{STEEL, StraightBeam, critical_factor, eigenvalues, frequencies, select};
use drillsweep_scenario::preset;
use drillsweep_sim::force::mud::{FlowGeometry, FlowMomentum};
use drillsweep_sim::string::beam::BeamSection;
use nalgebra::DMatrix;

const COLLAR: (f64, f64) = (0.159, 0.071);

fn collar() -> BeamSection {
    BeamSection::pipe(COLLAR.0, COLLAR.1, &STEEL)
}

/// A rod so thin that shear and rotary inertia are below 1e-7 of the bending.
fn thin_rod() -> BeamSection {
    BeamSection::pipe(0.002, 0.0, &STEEL)
}

/// Whirl frequencies of a simply supported spinning Timoshenko shaft in its n-th half wave: roots of
/// (kGA q^2 - rho A w^2)(EI q^2 + kGA - rho I w^2 + rho I_p Omega w) = (kGA q)^2; positive w is forward whirl.
fn timoshenko_whirl(s: &BeamSection, length: f64, n: f64, rotation_speed: f64, from: f64, to: f64) -> f64 {
    let q = n * PI / length;
    let shear = s.shear_modulus * s.shear_area;
    let f = |w: f64| {
        (shear * q * q - s.density * s.area * w * w)
            * (s.bending_stiffness() * q * q + shear - s.density * s.second_moment * w * w
                + s.density * s.polar_moment() * rotation_speed * w)
            - (shear * q).powi(2)
    };
    let (mut low, mut high) = (from, to);
    assert!(f(low).signum() != f(high).signum());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle).signum() == f(low).signum() {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Relative error of the n-th simply supported frequency with `count` elements.
fn frequency_error(s: &BeamSection, length: f64, mode: u32, count: usize) -> f64 {
    // Shear and rotary inertia only lower a frequency: Bernoulli and Euler's is the upper bracket.
    let bernoulli =
        (f64::from(mode) * PI / length).powi(2) * (s.bending_stiffness() / (s.density * s.area)).sqrt();
    let exact = timoshenko_whirl(s, length, f64::from(mode), 0.0, 0.3 * bernoulli, 1.001 * bernoulli);
    let beam = StraightBeam::new(*s, length, count);
    let dofs = beam.pinned_pinned();
    let m = select(&beam.assemble(&beam.element.mass()), &dofs);
    let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
    let c = DMatrix::zeros(m.nrows(), m.nrows());
    // Both planes have the same frequencies.
    frequencies(&m, &c, &k)[2 * (mode as usize - 1)] / exact - 1.0
}

#[test]
fn slender_simply_supported_frequencies_converge_with_order_four() {
    // Timoshenko (1921): exact frequencies of a simply supported beam with shear and rotary inertia. The
    // deflection is cubic, so a slender beam's frequencies err with the fourth power of the length.
    for mode in 1..=3 {
        let (coarse, fine) =
            (frequency_error(&thin_rod(), 1.0, mode, 6), frequency_error(&thin_rod(), 1.0, mode, 12));
        let order = (coarse / fine).log2();
        assert!(coarse > 0.0, "a consistent mass bounds frequencies from above");
        assert!((order - 4.0).abs() < 0.4, "mode {mode}: order {order}, errors {coarse:e} {fine:e}");
    }
}

#[test]
fn stocky_simply_supported_frequencies_converge_to_timoshenkos() {
    // The shear force is constant in an element, so the shear's share of the error falls with the square.
    for mode in 1..=3 {
        let (coarse, fine) =
            (frequency_error(&collar(), 2.0, mode, 12), frequency_error(&collar(), 2.0, mode, 24));
        let order = (coarse / fine).log2();
        assert!((1.9..4.1).contains(&order), "mode {mode}: order {order}, errors {coarse:e} {fine:e}");
        assert!(fine < 1e-3);
    }
}

#[test]
fn gyroscopic_effect_raises_forward_and_lowers_backward_whirl() {
    // Characteristic equation of the spinning Timoshenko shaft, in the signs of docs/model/beam.md, Gyroscopic matrix.
    let (s, length, omega) = (collar(), 1.0, 2000.0);
    let expected_forward = timoshenko_whirl(&s, length, 1.0, omega, 1.0, 12000.0);
    let expected_backward = -timoshenko_whirl(&s, length, 1.0, omega, -12000.0, -1.0);
    let errors = |count: usize| {
        let beam = StraightBeam::new(s, length, count);
        let dofs = beam.pinned_pinned();
        let m = select(&beam.assemble(&beam.element.mass()), &dofs);
        let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
        let g = select(&beam.assemble(&beam.element.gyroscopic(omega)), &dofs);
        let w = frequencies(&m, &g, &k);
        assert!(w[1] - w[0] > 10.0, "no split");
        (w[0] - expected_backward, w[1] - expected_forward, w[1] - w[0])
    };
    let (coarse, fine) = (errors(12), errors(24));
    for (coarse, fine) in [(coarse.0, fine.0), (coarse.1, fine.1)] {
        // Second order at least; the remainder is far below the split itself.
        assert!(coarse.abs() / fine.abs() > 3.5, "{coarse} {fine}");
    }
    let split = expected_forward - expected_backward;
    assert!((fine.2 / split - 1.0).abs() < 1e-3, "split {} against {split}", fine.2);
}

#[test]
fn forward_whirl_turns_with_the_string() {
    // The eigenvector of the higher mode turns from u to v: v lags u by a quarter period, as cos, sin does.
    let s = collar();
    let beam = StraightBeam::new(s, 1.0, 2);
    let dofs = beam.pinned_pinned();
    let m = select(&beam.assemble(&beam.element.mass()), &dofs);
    let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
    let g = select(&beam.assemble(&beam.element.gyroscopic(2000.0)), &dofs);
    let w = frequencies(&m, &g, &k)[1];
    let lambda = nalgebra::Complex::new(0.0, w);
    let a = DMatrix::from_fn(m.nrows(), m.nrows(), |i, j| {
        lambda * lambda * m[(i, j)] + lambda * g[(i, j)] + nalgebra::Complex::from(k[(i, j)])
    });
    let shape = a.svd(false, true).v_t.expect("asked for").adjoint().column(m.nrows() - 1).into_owned();
    // The free lateral displacements are those of the middle node: dofs start with the two rotations of node 0.
    let (u, v) = (shape[2], shape[3]);
    let phase = (v / u).arg();
    assert!((phase + PI / 2.0).abs() < 1e-6, "v is behind u by {phase} rad");
}

#[test]
fn compression_buckles_at_eulers_load_with_engessers_shear() {
    // Timoshenko and Gere (1961) 2.17: P = P_E / (1 + P_E / kGA).
    for (s, length, orders) in [(thin_rod(), 1.0, 3.7..4.3), (collar(), 3.0, 1.9..4.1)] {
        let euler = PI.powi(2) * s.bending_stiffness() / (length * length);
        let expected = euler / (1.0 + euler / (s.shear_modulus * s.shear_area));
        let error = |count: usize| {
            let beam = StraightBeam::new(s, length, count);
            let dofs = beam.pinned_pinned();
            let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
            let t = select(&beam.assemble(&-beam.element.tension_stiffening()), &dofs);
            critical_factor(&k, &t) / expected - 1.0
        };
        let (coarse, fine) = (error(4), error(8));
        let order = (coarse / fine).log2();
        assert!(orders.contains(&order), "order {order}, errors {coarse:e} {fine:e}");
        assert!(fine.abs() < 1e-3);
    }
}

#[test]
fn torque_buckles_at_greenhills_value() {
    // Greenhill (1883): a simply supported shaft buckles at 2 pi E I / L, in either sense.
    let (s, length) = (thin_rod(), 10.0);
    let expected = 2.0 * PI * s.bending_stiffness() / length;
    for sign in [1.0, -1.0] {
        let error = |count: usize| {
            let beam = StraightBeam::new(s, length, count);
            let dofs = beam.pinned_pinned();
            let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
            let t = select(&beam.assemble(&(beam.element.torque_stiffening() * sign)), &dofs);
            critical_factor(&k, &t) / expected - 1.0
        };
        let (coarse, fine) = (error(8), error(16));
        let order = (coarse / fine).abs().log2();
        assert!(order > 3.5, "order {order}, errors {coarse:e} {fine:e}");
        assert!(fine.abs() < 1e-3);
    }
}

#[test]
fn pipe_conveying_fluid_diverges_at_pi_pinned_and_two_pi_clamped() {
    // Paidoussis (1998), chapter 3: U sqrt(M_f / EI) L = pi and 2 pi.
    let (s, length) = (thin_rod(), 10.0);
    let beam = StraightBeam::new(s, length, 16);
    for (dofs, expected) in [(beam.pinned_pinned(), PI), (beam.clamped_clamped(), 2.0 * PI)] {
        let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
        let flow = select(&beam.assemble(&-beam.element.tension_stiffening()), &dofs);
        let v2 = critical_factor(&k, &flow);
        let u = (v2 / s.bending_stiffness()).sqrt() * length;
        assert!((u / expected - 1.0).abs() < 2e-4, "{u} against {expected}");
    }
}

#[test]
fn cantilever_conveying_fluid_flutters_at_the_published_speeds() {
    // Speeds and frequencies of an independent program with 16 Hermite elements; beta = 0.2 is in Gregory and Paidoussis (1966).
    let (s, length) = (thin_rod(), 10.0);
    let beam = StraightBeam::new(s, length, 16);
    let e = &beam.element;
    let dofs = beam.cantilever();
    let mass = s.density * s.area;
    for (beta, critical, frequency) in [(0.1, 4.750, 14.217), (0.2, 5.5915, 13.715), (0.5, 9.3231, 26.501)] {
        let bore_mass = mass * beta / (1.0 - beta);
        let speed_unit = (s.bending_stiffness() / bore_mass).sqrt() / length;
        let m = select(&beam.assemble(&(e.mass() + e.lateral_mass() * bore_mass)), &dofs);
        let most_unstable = |u: f64| {
            let speed = u * speed_unit;
            let c = select(&beam.assemble(&(e.coriolis() * (2.0 * bore_mass * speed))), &dofs);
            let v2 = bore_mass * speed * speed;
            let k = select(
                &(beam.assemble(&(e.stiffness() - e.tension_stiffening() * v2))
                    + beam.at_end(&(e.flow_end() * v2))),
                &dofs,
            );
            let lambda = eigenvalues(&m, &c, &k);
            // The published loss of stability is that of the low modes.
            let time_unit = (s.bending_stiffness() / ((mass + bore_mass) * length.powi(4))).sqrt();
            lambda
                .into_iter()
                .filter(|l| l.im > 0.0 && l.im < 60.0 * time_unit)
                .max_by(|a, b| a.re.total_cmp(&b.re))
                .map(|l| l / time_unit)
                .expect("there are low modes")
        };
        let (mut stable, mut unstable) = (0.9 * critical, 1.1 * critical);
        assert!(most_unstable(stable).re < 0.0 && most_unstable(unstable).re > 0.0, "beta {beta}");
        for _ in 0..40 {
            let middle = 0.5 * (stable + unstable);
            if most_unstable(middle).re < 0.0 {
                stable = middle;
            } else {
                unstable = middle;
            }
        }
        // The table's last digit, and the mesh's own error of the third mode (16 elements, order 4).
        assert!((stable / critical - 1.0).abs() < 5e-4, "beta {beta}: {stable} against {critical}");
        assert!((most_unstable(stable).im / frequency - 1.0).abs() < 1e-3, "beta {beta}");
    }
}

#[test]
fn mud_lowers_frequencies_by_the_root_of_the_mass_ratio() {
    // sqrt(m / (m + M_f + chi rho_f A_o)), chi = (D_ch^2 + D_o^2) / (D_ch^2 - D_o^2) = 2.0582 for the drillpipe.
    let mut mud = preset("paper-200m").expect("shipped preset").mud.expect("wet");
    mud.flow_rate = 0.0;
    let s = BeamSection::pipe(0.127, 0.108, &STEEL);
    let momentum = FlowMomentum::new(&mud, &FlowGeometry::past(&s, 0.2159));
    assert!((momentum.added_mass_coefficient - 2.0582).abs() < 5e-5);
    let added = 1200.0 * PI / 4.0 * (0.108_f64.powi(2) + 2.0582 * 0.127_f64.powi(2));
    assert!(
        (momentum.bore_mass + momentum.added_mass_coefficient * momentum.displaced_mass - added).abs() < 1e-3
    );
    let beam = StraightBeam::new(s, 20.0, 8);
    let dofs = beam.pinned_pinned();
    let k = select(&beam.assemble(&beam.element.stiffness()), &dofs);
    let lowest = |mass: f64| {
        let m = select(&beam.assemble(&(beam.element.mass() + beam.element.lateral_mass() * mass)), &dofs);
        frequencies(&m, &DMatrix::zeros(m.nrows(), m.nrows()), &k)[0]
    };
    let steel = s.density * s.area;
    let expected = (steel / (steel + added)).sqrt();
    // Rotary inertia, (pi r / L)^2 = 4e-5 of the mass, is not added to.
    assert!((lowest(added) / lowest(0.0) / expected - 1.0).abs() < 5e-5);
}
