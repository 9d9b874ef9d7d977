//! Eigenvalues of the quadratic pencil nearest to a shift: block Arnoldi iteration on the inverse about it.
//!
//! With y = (x, x'/s) the pencil `l^2 M + l C + K` is linear in l, and the inverse about a shift costs one solve with the
//! pencil itself: for `(A - sigma B)^-1 B (p, q)` it is `a = -Q(sigma)^-1 (M q + (C + sigma M) p)`, `b = p + sigma a`
//! (Tisseur and Meerbergen 2001, section 5). Two start vectors find the pairs of nearly equal eigenvalues that a round string has in its
//! two planes.
//!
//! faer's `matrix_free::eigen::partial_eigen` (0.24) solves the same problem, and agrees to 1e-10 in about the same time (55 to 74 ms a shift;
//! this module takes 54 to 60, with 80 applications of the inverse at 297 nodes). It starts from one vector, though: of a round beam's pairs of
//! equal eigenvalues it missed one or two among 20 to 34 at three of four shifts, at a tolerance of 1e-12. It returns neither residuals nor
//! the eigenvalues that did not converge, so that no radius can be stated within which nothing is missing. The projected matrix stays with nalgebra's
//! complex Schur decomposition, too: 60 ms at 160 rows; faer's takes 98.

use nalgebra::{Complex, DMatrix, Schur};

use super::pencil::Pencil;
use super::shifted::ShiftedPencil;
use crate::math::linalg::DOFS;

/// Start vectors.
const BLOCK: usize = 2;

/// Residual of an eigenvector of the projected matrix, relative to its eigenvalue, at which it has converged.
const CONVERGED: f64 = 1e-9;

/// Iterations of the projected matrix' QR algorithm for each of its rows.
const QR_ITERATIONS: usize = 60;

/// One eigenvalue with its shape.
#[derive(Debug, Clone)]
pub(super) struct Eigenpair {
    /// The eigenvalue \[1/s\].
    pub(super) value: Complex<f64>,
    /// Displacements, degree of freedom by degree of freedom from the top.
    pub(super) shape: Vec<Complex<f64>>,
}

/// The eigenvalues around a shift.
pub(super) struct Neighbourhood {
    /// The converged ones without a gap, nearest first.
    pub(super) pairs: Vec<Eigenpair>,
    /// Radius \[1/s\]: every eigenvalue nearer to the shift is among the pairs.
    pub(super) radius: f64,
}

/// Finds the eigenvalues around `shift` in a Krylov space of `dimension` from the start vectors of number `start`: if more eigenvalues
/// are equal than there are start vectors, others find the rest. `None` if the shift is an eigenvalue itself or the iteration breaks
/// down.
pub(super) fn around(
    shift: Complex<f64>,
    pencil: &Pencil,
    dimension: usize,
    start: u64,
) -> Option<Neighbourhood> {
    let factor = ShiftedPencil::new(shift, pencil.matrices(), &pencil.held)?;
    let free = pencil.held.as_flattened().iter().filter(|held| !**held).count();
    let dimension = dimension.min(2 * free);
    // Displacements and velocities of the wanted modes become equally large.
    let scale = shift.norm().max(1.0);
    let mut basis = start_vectors(pencil, start);
    let mut projected = DMatrix::<Complex<f64>>::zeros(dimension + BLOCK, dimension);
    for step in 0..dimension {
        let mut next = apply(shift, scale, pencil, &factor, &basis[step]);
        let before = norm(&next);
        let mut left = orthogonalise(&mut next, &basis, |row, value| projected[(row, step)] += value);
        // Twice is enough (Kahan; Daniel, Gragg, Kaufman and Stewart 1976).
        if left < 0.7 * before {
            left = orthogonalise(&mut next, &basis, |row, value| projected[(row, step)] += value);
        }
        if !left.is_finite() {
            return None;
        }
        projected[(basis.len(), step)] = Complex::new(left, 0.0);
        // An exhausted space continues with zeros.
        let factor = if left > 1e-14 * before { 1.0 / left } else { 0.0 };
        next.iter_mut().for_each(|value| *value *= factor);
        basis.push(next);
    }

    let square = projected.rows(0, dimension).into_owned();
    let (vectors, triangle) = Schur::try_new(square, f64::EPSILON, QR_ITERATIONS * dimension)?.unpack();
    let mut ritz: Vec<(Complex<f64>, Vec<Complex<f64>>, f64)> = (0..dimension)
        .filter(|&index| triangle[(index, index)].norm() > 0.0)
        .map(|index| {
            let small = &vectors * triangular_eigenvector(&triangle, index);
            let coupling = projected.rows(dimension, BLOCK) * &small;
            let theta = triangle[(index, index)];
            (theta, small.iter().copied().collect(), coupling.norm() / theta.norm())
        })
        .collect();
    ritz.sort_by(|a, b| b.0.norm_sqr().total_cmp(&a.0.norm_sqr()));
    let complete = dimension == 2 * free;
    let converged = ritz.iter().take_while(|(_, _, residual)| *residual <= CONVERGED).count();
    let converged = if complete { ritz.len() } else { converged };
    // The next one is roughly known, the last converged one precisely.
    let radius = match ritz.get(converged) {
        Some((theta, ..)) => (1.0 / theta.norm())
            .min(1.5 * converged.checked_sub(1).map_or(0.0, |last| 1.0 / ritz[last].0.norm())),
        None => f64::INFINITY,
    };
    let size = DOFS * pencil.held.len();
    let pairs = ritz[..converged]
        .iter()
        .map(|(theta, small, _)| {
            let mut shape = vec![Complex::new(0.0, 0.0); size];
            for (vector, &factor) in basis.iter().zip(small) {
                for (sum, value) in shape.iter_mut().zip(vector) {
                    *sum += factor * value;
                }
            }
            Eigenpair { value: shift + 1.0 / theta, shape }
        })
        .collect();
    Some(Neighbourhood { pairs, radius })
}

/// The inverse about the shift, applied to a state.
fn apply(
    shift: Complex<f64>,
    scale: f64,
    pencil: &Pencil,
    factor: &ShiftedPencil,
    state: &[Complex<f64>],
) -> Vec<Complex<f64>> {
    let (p, q) = state.split_at(state.len() / 2);
    let pushed: Vec<Complex<f64>> = p.iter().zip(q).map(|(p, q)| scale * q + shift * p).collect();
    let mut a = pencil.times_mass(&pushed);
    for (a, damped) in a.iter_mut().zip(pencil.times_damping(p)) {
        *a = -(*a + damped);
    }
    factor.solve_in_place(&mut a);
    let b: Vec<Complex<f64>> = p.iter().zip(&a).map(|(p, a)| (p + shift * a) / scale).collect();
    a.extend(b);
    a
}

/// Orthonormal start vectors: numbers without pattern, the same everywhere.
fn start_vectors(pencil: &Pencil, number: u64) -> Vec<Vec<Complex<f64>>> {
    let mut basis: Vec<Vec<Complex<f64>>> = Vec::new();
    let held = pencil.held.as_flattened();
    let mut seed = 0x2545_f491_4f6c_dd1d_u64 ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    while basis.len() < BLOCK {
        let mut vector: Vec<Complex<f64>> = held
            .iter()
            .chain(held)
            .map(|held| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let value = (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                Complex::new(if *held { 0.0 } else { value }, 0.0)
            })
            .collect();
        let size = orthogonalise(&mut vector, &basis, |_, _| ());
        vector.iter_mut().for_each(|value| *value /= size);
        basis.push(vector);
    }
    basis
}

/// Removes the basis' components from a vector, reports them, and returns the norm of the remainder.
fn orthogonalise(
    vector: &mut [Complex<f64>],
    basis: &[Vec<Complex<f64>>],
    mut component: impl FnMut(usize, Complex<f64>),
) -> f64 {
    for (row, other) in basis.iter().enumerate() {
        let (mut re, mut im) = (0.0, 0.0);
        for (a, b) in other.iter().zip(vector.iter()) {
            re += a.re * b.re + a.im * b.im;
            im += a.re * b.im - a.im * b.re;
        }
        let value = Complex::new(re, im);
        for (vector, other) in vector.iter_mut().zip(other) {
            *vector -= value * other;
        }
        component(row, value);
    }
    norm(vector)
}

fn norm(vector: &[Complex<f64>]) -> f64 {
    vector.iter().map(Complex::norm_sqr).sum::<f64>().sqrt()
}

/// The eigenvector of an upper triangular matrix for its `index`-th diagonal entry, of length 1.
fn triangular_eigenvector(triangle: &DMatrix<Complex<f64>>, index: usize) -> nalgebra::DVector<Complex<f64>> {
    let theta = triangle[(index, index)];
    let smallest = f64::EPSILON * triangle.norm();
    let mut vector = nalgebra::DVector::zeros(triangle.nrows());
    vector[index] = Complex::new(1.0, 0.0);
    for row in (0..index).rev() {
        let known: Complex<f64> =
            (row + 1..=index).map(|column| triangle[(row, column)] * vector[column]).sum();
        let mut gap = theta - triangle[(row, row)];
        if gap.norm() < smallest {
            gap = Complex::new(smallest, 0.0);
        }
        vector[row] = known / gap;
    }
    let length = vector.norm();
    vector / Complex::new(length, 0.0)
}
