//! The block-tridiagonal kernels and the contact law at the size of the 200 m string: 296 free nodes.
//! Run: `cargo bench -p drillsweep-sim --bench kernels`

use std::hint::black_box;

use divan::Bencher;
use drillsweep_scenario::{ActiveEffects, Adhesion, ContactLaw, WallLaw};
use drillsweep_sim::force::contact::{ContactNode, ContactParameters, LateralMotion, dynamic_contact};
use drillsweep_sim::math::linalg::{
    Block, BlockTridiagonal, BlockVector, Factor, MatrixPair, NodalField, SkewPart, Symmetric,
};

const ROWS: usize = 296;

fn main() {
    divan::main();
}

/// Numerically full blocks, diagonally dominant.
fn matrix(seed: f64) -> BlockTridiagonal {
    let block = |row: usize, shift: f64| {
        Block::from_fn(|i, j| (seed + (row * 36 + i * 6 + j) as f64).sin() + if i == j { shift } else { 0.0 })
    };
    BlockTridiagonal {
        lower: (0..ROWS).map(|row| block(row, 0.0)).collect(),
        diagonal: (0..ROWS).map(|row| block(row + ROWS, 30.0)).collect(),
        upper: (0..ROWS).map(|row| block(row + 2 * ROWS, 0.0)).collect(),
    }
}

fn vector(seed: f64) -> BlockVector {
    (0..ROWS).map(|row| std::array::from_fn(|i| (seed + (6 * row + i) as f64).cos())).collect()
}

#[divan::bench]
fn multiply(bencher: Bencher) {
    let (matrix, x, mut y) = (matrix(0.1), vector(0.2), vector(0.3));
    bencher.bench_local(|| matrix.multiply_into(black_box(&x), black_box(&mut y)));
}

#[divan::bench]
fn multiply_two(bencher: Bencher) {
    let pair = MatrixPair::<Symmetric>::new(&matrix(0.1), &matrix(0.4));
    let [x, y, whole, mut out] = [0.2, 0.3, 0.6, 0.5].map(|seed| NodalField::from_nodes(&vector(seed)));
    bencher.bench_local(|| {
        pair.subtract_products(&whole, black_box(&x), black_box(&y), black_box(&mut out));
    });
}

/// Skew form of five stages.
#[divan::bench]
fn skew_forms(bencher: Bencher) {
    let skew = SkewPart::new(&matrix(0.1), 0.0);
    let [v, x] = [0.2, 0.3].map(|seed| NodalField::from_nodes(&vector(seed)));
    bencher.bench_local(|| skew.product(black_box([(1.0, &v, &x); 5])));
}

#[divan::bench]
fn factor(bencher: Bencher) {
    let matrix = matrix(0.1);
    bencher.bench_local(|| Factor::new(black_box(&matrix)));
}

#[divan::bench]
fn solve(bencher: Bencher) {
    let (factor, b, mut x) = (Factor::new(&matrix(0.1)).expect("regular"), vector(0.2), vector(0.3));
    bencher.bench_local(|| factor.solve_into(black_box(&b), black_box(&mut x)));
}

/// Every second node against the wall.
#[divan::bench]
fn contact(bencher: Bencher) {
    let law = ContactLaw {
        law: WallLaw::PerNode,
        stiffness: 1e7,
        damping: 1e4,
        stiffness_per_length: None,
        damping_per_length: None,
        stiffness_sharpness: 7e7,
        damping_sharpness: 7e4,
        adhesion: Adhesion::Allowed,
        static_friction: 0.3,
        dynamic_friction: 0.2,
        friction_reference_speed: 0.033,
    };
    let law = ContactParameters::<f64>::new(&law, &ActiveEffects::ALL);
    let node = ContactNode {
        clearance: 0.04,
        contact_radius: 0.0635,
        stiffness_share: 1.0,
        damping_share: 1.0,
        friction: None,
    };
    let (mut x, v, mut force) = (vector(0.2), vector(0.3), vector(0.4));
    for (row, x) in x.iter_mut().enumerate() {
        let radius = if row % 2 == 0 { 0.04005 } else { 0.035 };
        (x[0], x[1]) = (radius * (row as f64).cos(), radius * (row as f64).sin());
    }
    bencher.bench_local(|| {
        for ((force, x), v) in black_box(&mut force).iter_mut().zip(black_box(&x)).zip(black_box(&v)) {
            let motion = LateralMotion { u: x[0], v: x[1], u_rate: v[0], v_rate: v[1], theta_z_rate: v[5] };
            let wall = dynamic_contact(&law, &node, &motion, 12.566);
            *force = [wall.force_u, wall.force_v, 0.0, 0.0, 0.0, wall.torque_z];
        }
    });
}
