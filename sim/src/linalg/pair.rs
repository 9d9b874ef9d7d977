//! Two block-tridiagonal matrices that are always read together.

use super::block::{Block, DOFS, Sum};
use super::lane::Lane;
use super::tridiagonal::BlockTridiagonal;

/// Two matrices A and B of the same size, their rows interleaved: a pass over both is one stream through the cache.
#[derive(Debug, Clone)]
pub struct MatrixPair<L, const D: usize = DOFS> {
    rows: Vec<[Row<L, D>; 2]>,
}

/// The blocks of a row; those of the first and last row that stand outside the matrix take no part.
#[derive(Debug, Clone, Copy)]
struct Row<L, const D: usize> {
    lower: Block<L, D>,
    diagonal: Block<L, D>,
    upper: Block<L, D>,
}

impl<L: Lane, const D: usize> MatrixPair<L, D> {
    /// Copies two matrices.
    ///
    /// # Panics
    /// When they differ in size.
    pub fn new(a: &BlockTridiagonal<L, D>, b: &BlockTridiagonal<L, D>) -> Self {
        assert_eq!(a.rows(), b.rows());
        let row = |m: &BlockTridiagonal<L, D>, row: usize| Row {
            lower: m.lower[row],
            diagonal: m.diagonal[row],
            upper: m.upper[row],
        };
        Self { rows: (0..a.rows()).map(|i| [row(a, i), row(b, i)]).collect() }
    }

    /// `out = whole - (A x + B y)`.
    ///
    /// # Panics
    /// When a vector has not as many rows as the matrices.
    pub fn subtract_products(&self, whole: &[[L; D]], x: &[[L; D]], y: &[[L; D]], out: &mut [[L; D]]) {
        let rows = self.rows.len();
        assert!(whole.len() == rows && x.len() == rows && y.len() == rows && out.len() == rows);
        for (i, ([a, b], (out, whole))) in self.rows.iter().zip(out.iter_mut().zip(whole)).enumerate() {
            // Two sums that do not wait for each other.
            let (of_a, of_b) = (a.product(i, x), b.product(i, y));
            *out = std::array::from_fn(|dof| whole[dof] - (of_a[dof] + of_b[dof]));
        }
    }
}

impl<L: Lane, const D: usize> Row<L, D> {
    #[inline(always)]
    fn product(&self, row: usize, x: &[[L; D]]) -> [L; D] {
        let mut sum = self.diagonal.add_product(&x[row], Sum::zero());
        if row > 0 {
            sum = self.lower.add_product(&x[row - 1], sum);
        }
        if row + 1 < x.len() {
            sum = self.upper.add_product(&x[row + 1], sum);
        }
        sum.total()
    }
}
