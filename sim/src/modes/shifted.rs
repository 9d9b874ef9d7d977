//! The string's quadratic pencil at a complex shift, factored.

use nalgebra::Complex;

use crate::linalg::{BlockTridiagonal, DOFS};

/// Diagonals on either side of the main one.
const HALF_BAND: usize = 2 * DOFS - 1;

/// Entries of a row from its diagonal on; exchanges of rows double the upper half.
const UPPER: usize = 2 * HALF_BAND + 1;

/// `s^2 M + s C + K` with rows exchanged for the largest pivot. The time-stepping factor has no exchanges across nodes; far above
/// the lowest frequencies this matrix is indefinite and needs them.
pub(super) struct ShiftedPencil {
    /// Rows of the upper triangle from the diagonal on.
    upper: Vec<[Complex<f64>; UPPER]>,
    /// Multipliers of the rows below.
    lower: Vec<[Complex<f64>; HALF_BAND]>,
    /// Row that each row was exchanged with, counted from itself.
    exchanged: Vec<usize>,
}

impl ShiftedPencil {
    /// Factors the pencil at `shift`; `held` degrees of freedom get a unit diagonal. `None` where the shift is an
    /// eigenvalue to working precision or a value is not finite.
    pub(super) fn new(
        shift: Complex<f64>,
        [mass, damping, stiffness]: [&BlockTridiagonal; 3],
        held: &[[bool; DOFS]],
    ) -> Option<Self> {
        let size = DOFS * mass.rows();
        let zero = Complex::new(0.0, 0.0);
        // Row i holds columns from i - HALF_BAND on.
        let mut rows = vec![[zero; HALF_BAND + UPPER]; size];
        let square = shift * shift;
        for node in 0..mass.rows() {
            let blocks = [
                (node.checked_sub(1), &mass.lower, &damping.lower, &stiffness.lower),
                (Some(node), &mass.diagonal, &damping.diagonal, &stiffness.diagonal),
                (
                    Some(node + 1).filter(|&next| next < mass.rows()),
                    &mass.upper,
                    &damping.upper,
                    &stiffness.upper,
                ),
            ];
            for (other, m, c, k) in blocks {
                let Some(other) = other else { continue };
                for column in 0..DOFS {
                    for row in 0..DOFS {
                        let (i, j) = (DOFS * node + row, DOFS * other + column);
                        let place = (row, column);
                        rows[i][j + HALF_BAND - i] =
                            square * m[node][place] + shift * c[node][place] + k[node][place];
                    }
                }
            }
            for dof in (0..DOFS).filter(|&dof| held[node][dof]) {
                rows[DOFS * node + dof][HALF_BAND] = Complex::new(1.0, 0.0);
            }
        }

        let mut factor = Self {
            upper: Vec::with_capacity(size),
            lower: Vec::with_capacity(size),
            exchanged: Vec::with_capacity(size),
        };
        for pivot in 0..size {
            // Column `pivot` stands in row pivot + below at HALF_BAND - below.
            let reach = HALF_BAND.min(size - 1 - pivot);
            let size_of = |below: usize| rows[pivot + below][HALF_BAND - below].norm_sqr();
            let chosen = (0..=reach).max_by(|&a, &b| size_of(a).total_cmp(&size_of(b)))?;
            let largest = size_of(chosen);
            if !(largest.is_finite() && largest > 0.0) {
                return None;
            }
            let window = |below: usize| HALF_BAND - below..HALF_BAND - below + UPPER;
            let mut row: [Complex<f64>; UPPER] =
                std::array::from_fn(|i| rows[pivot + chosen][window(chosen)][i]);
            if chosen > 0 {
                let displaced: [Complex<f64>; UPPER] = std::array::from_fn(|i| rows[pivot][window(0)][i]);
                rows[pivot + chosen][window(chosen)].copy_from_slice(&displaced);
            }
            let reciprocal = Complex::new(1.0, 0.0) / row[0];
            let mut multipliers = [zero; HALF_BAND];
            for below in 1..=reach {
                let target = &mut rows[pivot + below][window(below)];
                let multiplier = target[0] * reciprocal;
                multipliers[below - 1] = multiplier;
                if multiplier != zero {
                    for (target, row) in target.iter_mut().zip(&row) {
                        *target -= multiplier * row;
                    }
                }
            }
            // The diagonal is kept inverted: every solve divides by it.
            row[0] = reciprocal;
            factor.upper.push(row);
            factor.lower.push(multipliers);
            factor.exchanged.push(chosen);
        }
        Some(factor)
    }

    /// Replaces a right-hand side, degree of freedom by degree of freedom from the top, by the solution.
    pub(super) fn solve_in_place(&self, x: &mut [Complex<f64>]) {
        let size = x.len();
        for pivot in 0..size {
            x.swap(pivot, pivot + self.exchanged[pivot]);
            let value = x[pivot];
            let below = &mut x[pivot + 1..(pivot + 1 + HALF_BAND).min(size)];
            for (x, multiplier) in below.iter_mut().zip(&self.lower[pivot]) {
                *x -= multiplier * value;
            }
        }
        for pivot in (0..size).rev() {
            let (value, after) = x[pivot..(pivot + UPPER).min(size)].split_at_mut(1);
            let known: Complex<f64> =
                self.upper[pivot][1..].iter().zip(after.iter()).map(|(a, x)| a * x).sum();
            value[0] = (value[0] - known) * self.upper[pivot][0];
        }
    }
}
