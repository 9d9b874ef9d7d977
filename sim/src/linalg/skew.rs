//! The skew part of a block-tridiagonal matrix.

use super::block::{Block, DOFS};
use super::column::Column;
use super::tridiagonal::BlockTridiagonal;

/// `(m - m^T) / 2`, at the rows where there is any.
#[derive(Debug, Clone)]
pub struct SkewPart<const D: usize = DOFS>(Vec<SkewRow<D>>);

/// A weight, and the vectors to its left and right.
pub type WeightedPair<'a, const D: usize> = (f64, &'a [[f64; D]], &'a [[f64; D]]);

/// Blocks on the diagonal and above it; below stands minus the transposed one.
#[derive(Debug, Clone)]
struct SkewRow<const D: usize> {
    row: usize,
    diagonal: Block<f64, D>,
    upper: Block<f64, D>,
}

impl<const D: usize> SkewPart<D> {
    /// That of `m`, without entries up to `threshold`: rounding of terms that cancel.
    pub fn new(m: &BlockTridiagonal<f64, D>, threshold: f64) -> Self {
        let half_difference =
            |a: &Block<f64, D>, b: &Block<f64, D>| Block::from_fn(|i, j| 0.5 * (a[(i, j)] - b[(j, i)]));
        let rows = (0..m.rows()).map(|row| SkewRow {
            row,
            diagonal: half_difference(&m.diagonal[row], &m.diagonal[row]),
            upper: match m.lower.get(row + 1) {
                Some(mirrored) => half_difference(&m.upper[row], mirrored),
                None => Block::zero(),
            },
        });
        let present = |row: &SkewRow<D>| row.diagonal.largest().max(row.upper.largest()) > threshold;
        Self(rows.filter(present).collect())
    }

    /// `sum_k weight_k v_k^T A x_k`, the matrix read once for all of them.
    ///
    /// # Panics
    /// When a vector has fewer rows than the matrix.
    pub fn product<const K: usize>(&self, pairs: [WeightedPair<'_, D>; K]) -> f64 {
        let mut sums = [Column::zero(); K];
        let beyond = [0.0; D];
        for SkewRow { row, diagonal, upper } in &self.0 {
            let v = pairs.map(|(_, v, _)| &v[*row]);
            let x = pairs.map(|(_, _, x)| &x[*row]);
            let v_next = pairs.map(|(_, v, _)| v.get(row + 1).unwrap_or(&beyond));
            let x_next = pairs.map(|(_, _, x)| x.get(row + 1).unwrap_or(&beyond));
            let pushed = upper.times_each(x_next, diagonal.times_each(x, [Column::zero(); K]));
            let pulled = upper.times_each(v_next, [Column::zero(); K]);
            for k in 0..K {
                let power = pushed[k].product(Column::new(v[k]));
                sums[k] = power.minus(pulled[k].product(Column::new(x[k]))).plus(sums[k]);
            }
        }
        sums.iter().zip(pairs).map(|(sum, (weight, ..))| weight * sum.sum()).sum()
    }
}
