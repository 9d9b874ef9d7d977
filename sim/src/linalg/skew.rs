//! The skew part of a block-tridiagonal matrix.

use super::block::{Block, DOFS};
use super::tridiagonal::BlockTridiagonal;

/// `(m - m^T) / 2`, at the rows where there is any.
#[derive(Debug, Clone)]
pub struct SkewPart<const D: usize = DOFS> {
    rows: usize,
    /// Blocks on the diagonal.
    own: Vec<(usize, Block<f64, D>)>,
    /// Blocks above the diagonal; below stands minus the transposed one.
    next: Vec<(usize, Block<f64, D>)>,
}

/// A weight, and the vectors to its left and right.
pub type WeightedPair<'a, const D: usize> = (f64, &'a [[f64; D]], &'a [[f64; D]]);

impl<const D: usize> SkewPart<D> {
    /// That of `m`, without blocks whose entries are all up to `threshold`: rounding of terms that cancel.
    pub fn new(m: &BlockTridiagonal<f64, D>, threshold: f64) -> Self {
        let half_difference =
            |a: &Block<f64, D>, b: &Block<f64, D>| Block::from_fn(|i, j| 0.5 * (a[(i, j)] - b[(j, i)]));
        let present = |(_, block): &(usize, Block<f64, D>)| block.largest() > threshold;
        let rows = m.rows();
        let own = (0..rows).map(|row| (row, half_difference(&m.diagonal[row], &m.diagonal[row])));
        let next = (1..rows).map(|below| (below - 1, half_difference(&m.upper[below - 1], &m.lower[below])));
        Self { rows, own: own.filter(present).collect(), next: next.filter(present).collect() }
    }

    /// `sum_k weight_k v_k^T A x_k`, the matrix read once for all of them.
    ///
    /// # Panics
    /// When a vector has fewer rows than the matrix.
    pub fn product<const K: usize>(&self, pairs: [WeightedPair<'_, D>; K]) -> f64 {
        let pairs = pairs.map(|(weight, v, x)| (weight, &v[..self.rows], &x[..self.rows]));
        let mirrored = pairs.map(|(weight, v, x)| (-weight, x, v));
        let mut sum = 0.0;
        for (row, block) in &self.own {
            let mut products = Block::zero();
            products.add_products(&pairs, *row, *row);
            sum += block.dot(&products);
        }
        for (row, block) in &self.next {
            let mut products = Block::zero();
            products.add_products(&pairs, *row, row + 1);
            products.add_products(&mirrored, *row, row + 1);
            sum += block.dot(&products);
        }
        sum
    }
}
