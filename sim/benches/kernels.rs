//! The block-tridiagonal kernels at the size of the 200 m case: 296 free nodes.
//! Run: `cargo bench -p drillsweep-sim --bench kernels`

use std::hint::black_box;

use divan::Bencher;
use drillsweep_sim::linalg::{Block, BlockTridiagonal, BlockVector, Factor};

const ROWS: usize = 296;

fn main() {
    divan::main();
}

/// Numerically full blocks, diagonally dominant.
fn matrix(seed: f64) -> BlockTridiagonal<f64> {
    let block = |row: usize, shift: f64| {
        Block::from_fn(|i, j| (seed + (row * 36 + i * 6 + j) as f64).sin() + if i == j { shift } else { 0.0 })
    };
    BlockTridiagonal {
        lower: (0..ROWS).map(|row| block(row, 0.0)).collect(),
        diagonal: (0..ROWS).map(|row| block(row + ROWS, 30.0)).collect(),
        upper: (0..ROWS).map(|row| block(row + 2 * ROWS, 0.0)).collect(),
    }
}

fn vector(seed: f64) -> BlockVector<f64> {
    (0..ROWS).map(|row| std::array::from_fn(|i| (seed + (6 * row + i) as f64).cos())).collect()
}

#[divan::bench]
fn multiply(bencher: Bencher) {
    let (matrix, x, mut y) = (matrix(0.1), vector(0.2), vector(0.3));
    bencher.bench_local(|| matrix.multiply_into(black_box(&x), black_box(&mut y)));
}

#[divan::bench]
fn multiply_two(bencher: Bencher) {
    let (a, b, x, y, mut out) = (matrix(0.1), matrix(0.4), vector(0.2), vector(0.3), vector(0.5));
    bencher.bench_local(|| {
        BlockTridiagonal::multiply_two_into(&a, black_box(&x), &b, black_box(&y), black_box(&mut out));
    });
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
