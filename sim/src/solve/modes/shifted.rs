//! The string's quadratic pencil at a complex shift, factored.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::linalg::lu::simplicial::{
    SimplicialLu, factorize_simplicial_numeric_lu, factorize_simplicial_numeric_lu_scratch,
    solve_in_place_scratch,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par};
use nalgebra::Complex;

use crate::math::linalg::{BlockTridiagonal, DOFS};

/// `s^2 M + s C + K` with rows exchanged for the largest pivot. The time-stepping factor has no exchanges across nodes; far above
/// the lowest frequencies this matrix is indefinite and needs them.
///
/// By faer's simplicial LU, column by column in the order of the nodes. A banded factor of our own with the same exchanges took 0.47 ms
/// instead of 1.4 ms, and 0.071 ms a solve instead of 0.060, which is equal for a factor and its 80 solves (6.2 and
/// 6.3 ms at 297 nodes on one core of a 2.6 GHz EPYC). The COLAMD order makes it 6.0 ms, supernodes 9.3 ms. This variant calls no dense
/// kernel, whose sums would be split by the caches and vector registers of the machine.
pub(super) struct ShiftedPencil {
    lu: SimplicialLu<usize, Complex<f64>>,
    /// Order of the rows after their exchanges.
    rows: Perm<usize>,
    /// Order of the columns: unchanged.
    columns: Perm<usize>,
}

impl ShiftedPencil {
    /// Factors the pencil at `shift`; `held` degrees of freedom get a unit diagonal. `None` if the shift is an
    /// eigenvalue to working precision or a value is not finite.
    pub(super) fn new(
        shift: Complex<f64>,
        matrices: [&BlockTridiagonal; 3],
        held: &[[bool; DOFS]],
    ) -> Option<Self> {
        let matrix = assemble(shift, matrices, held);
        let size = matrix.ncols();
        let mut lu = SimplicialLu::new();
        let (mut order, mut place) = (vec![0; size], vec![0; size]);
        let columns = Perm::new_checked((0..size).collect(), (0..size).collect(), size);
        let scratch = factorize_simplicial_numeric_lu_scratch::<usize, Complex<f64>>(size, size);
        factorize_simplicial_numeric_lu(
            &mut order,
            &mut place,
            &mut lu,
            matrix.as_ref(),
            columns.as_ref(),
            MemStack::new(&mut MemBuffer::new(scratch)),
        )
        .ok()?;
        // A column without any entry is an error; a pivot that is zero or not finite is not.
        let upper = lu.u_factor_unsorted();
        let regular = (0..size).all(|column| {
            upper.row_idx_of_col(column).zip(upper.val_of_col(column)).all(|(row, value)| {
                value.re.is_finite() && value.im.is_finite() && (row != column || value.norm_sqr() > 0.0)
            })
        });
        regular.then(|| Self { lu, rows: Perm::new_checked(order.into(), place.into(), size), columns })
    }

    /// The determinant's logarithm: of its magnitude, and its phase \[rad\] up to whole turns.
    pub(super) fn log_determinant(&self) -> Complex<f64> {
        let upper = self.lu.u_factor_unsorted();
        let (mut size, mut direction) = (0.0, Complex::new(1.0, 0.0));
        for column in 0..upper.ncols() {
            let mut entries = upper.row_idx_of_col(column).zip(upper.val_of_col(column));
            if let Some((_, pivot)) = entries.find(|(row, _)| *row == column) {
                let length = pivot.norm();
                size += length.ln();
                direction *= pivot / length;
                direction /= direction.norm();
            }
        }
        let turned = if is_odd(self.rows.arrays().0) { std::f64::consts::PI } else { 0.0 };
        Complex::new(size, direction.arg() + turned)
    }

    /// Replaces a right-hand side, degree of freedom by degree of freedom from the top, by the solution.
    pub(super) fn solve_in_place(&self, x: &mut [Complex<f64>]) {
        let size = x.len();
        let scratch = solve_in_place_scratch::<usize, Complex<f64>>(size, 1, Par::Seq);
        self.lu.solve_in_place_with_conj(
            self.rows.as_ref(),
            self.columns.as_ref(),
            Conj::No,
            MatMut::from_column_major_slice_mut(x, size, 1),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

/// True if a permutation is an odd number of exchanges.
fn is_odd(order: &[usize]) -> bool {
    let mut seen = vec![false; order.len()];
    let mut exchanges = 0;
    for start in 0..order.len() {
        let mut place = start;
        while !std::mem::replace(&mut seen[place], true) {
            place = order[place];
            exchanges += usize::from(place != start);
        }
    }
    exchanges % 2 == 1
}

/// The pencil at a shift by columns, without the entries that are zero.
fn assemble(
    shift: Complex<f64>,
    [mass, damping, stiffness]: [&BlockTridiagonal; 3],
    held: &[[bool; DOFS]],
) -> SparseColMat<usize, Complex<f64>> {
    let (nodes, square) = (mass.rows(), shift * shift);
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (node, is_held) in held.iter().enumerate() {
        let above = node.checked_sub(1).map(|above| (above, &mass.upper, &damping.upper, &stiffness.upper));
        let own = (node, &mass.diagonal, &damping.diagonal, &stiffness.diagonal);
        let below = (node + 1, &mass.lower, &damping.lower, &stiffness.lower);
        for (column, &is_held) in is_held.iter().enumerate() {
            let blocks = above.into_iter().chain([own]).chain((node + 1 < nodes).then_some(below));
            for (other, m, c, k) in blocks {
                for row in 0..DOFS {
                    let place = (row, column);
                    let value = if is_held && (other, row) == (node, column) {
                        Complex::new(1.0, 0.0)
                    } else {
                        square * m[other][place] + shift * c[other][place] + k[other][place]
                    };
                    if value != Complex::new(0.0, 0.0) {
                        rows.push(DOFS * other + row);
                        values.push(value);
                    }
                }
            }
            starts.push(rows.len());
        }
    }
    let size = DOFS * nodes;
    SparseColMat::new(SymbolicSparseColMat::new_checked(size, size, starts, None, rows), values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::modes::pencil::times;

    const NODES: usize = 30;

    fn i() -> Complex<f64> {
        Complex::new(0.0, 1.0)
    }

    /// Full blocks without dominant diagonals, so that rows are exchanged across nodes.
    fn matrix(seed: f64) -> BlockTridiagonal {
        let mut matrix = BlockTridiagonal::zeros(NODES);
        let blocks = matrix.lower.iter_mut().chain(&mut matrix.diagonal).chain(&mut matrix.upper);
        for (number, block) in blocks.enumerate() {
            for row in 0..DOFS {
                for column in 0..DOFS {
                    // Of squares: sines of the numbers themselves are blocks of rank 2.
                    block[(row, column)] = (seed + (36 * number + DOFS * row + column) as f64).powi(2).sin();
                }
            }
        }
        matrix
    }

    #[test]
    fn solutions_satisfy_an_indefinite_pencil() {
        let matrices = [0.1, 0.4, 0.9].map(matrix);
        let matrices = matrices.each_ref();
        let (shift, held) = (Complex::new(0.3, 1.7), vec![[false; DOFS]; NODES]);
        let right: Vec<Complex<f64>> = (0..DOFS * NODES).map(|k| (i() * (0.3 + k as f64)).exp()).collect();
        let mut x = right.clone();
        ShiftedPencil::new(shift, matrices, &held).expect("regular").solve_in_place(&mut x);
        let [inertia, damping, elastic] = matrices.map(|matrix| times(matrix, &x));
        for (k, right) in right.iter().enumerate() {
            let left = shift * shift * inertia[k] + shift * damping[k] + elastic[k];
            assert!((left - right).norm() < 1e-10, "{k}: {left} against {right}");
        }
    }

    #[test]
    fn determinant_is_that_of_the_dense_matrix() {
        let matrices = [0.1, 0.4, 0.9].map(matrix);
        let shift = Complex::new(0.3, 1.7);
        let mut dense = nalgebra::DMatrix::<Complex<f64>>::zeros(DOFS * NODES, DOFS * NODES);
        for column in 0..DOFS * NODES {
            let mut unit = vec![Complex::new(0.0, 0.0); DOFS * NODES];
            unit[column] = Complex::new(1.0, 0.0);
            let [m, c, k] = matrices.each_ref().map(|matrix| times(matrix, &unit));
            for row in 0..DOFS * NODES {
                dense[(row, column)] = shift * shift * m[row] + shift * c[row] + k[row];
            }
        }
        let expected = dense.determinant();
        let factor =
            ShiftedPencil::new(shift, matrices.each_ref(), &[[false; DOFS]; NODES]).expect("regular");
        let found = factor.log_determinant();
        assert!((found.re / expected.norm().ln() - 1.0).abs() < 1e-12, "{found} against {expected}");
        // The direction distinguishes an odd number of exchanges from an even one.
        let apart = Complex::from_polar(1.0, found.im) - expected / expected.norm();
        assert!(apart.norm() < 1e-9, "{found} against {expected}");
    }

    #[test]
    fn non_finite_eigenvalues_and_entries_are_reported() {
        // A node by itself on springs k, mass m: s = i sqrt(k / m) is an eigenvalue.
        let diagonal = |value: f64| {
            let mut matrix = BlockTridiagonal::zeros(NODES);
            for block in &mut matrix.diagonal {
                (0..DOFS).for_each(|dof| block[(dof, dof)] = value);
            }
            matrix
        };
        let (mass, damping, stiffness) = (diagonal(1.0), diagonal(0.0), diagonal(4.0));
        let free = [[false; DOFS]; NODES];
        let factor = |shift, stiffness: &BlockTridiagonal, held: &[_]| {
            ShiftedPencil::new(shift, [&mass, &damping, stiffness], held)
        };
        assert!(factor(2.0 * i(), &stiffness, &free).is_none(), "singular");
        assert!(factor(2.0 * i(), &stiffness, &[[true; DOFS]; NODES]).is_some(), "held throughout");
        assert!(factor(2.5 * i(), &stiffness, &free).is_some());
        for value in [f64::NAN, f64::INFINITY] {
            let mut broken = stiffness.clone();
            broken.diagonal[NODES / 2][(1, 1)] = value;
            assert!(factor(2.5 * i(), &broken, &free).is_none(), "{value}");
            let mut broken = stiffness.clone();
            broken.upper[NODES / 2][(1, 4)] = value;
            assert!(factor(2.5 * i(), &broken, &free).is_none(), "{value}");
        }
        // A pivot that becomes zero, in no empty column.
        let mut singular = stiffness.clone();
        for place in [(0, 1), (1, 0)] {
            singular.diagonal[NODES / 2][place] = 4.0;
        }
        assert!(factor(Complex::new(0.0, 0.0), &singular, &free).is_none(), "two equal rows");
    }
}
