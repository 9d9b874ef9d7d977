//! Matrices that couple each node to its two neighbours.

use std::ops::Range;

use super::block::{Block, Sum};
use super::singular::SingularBlock;
use crate::math::dof::{BENDING_ROTATIONS, DOFS};

/// A square matrix of n x n blocks, zero but on three diagonals.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockTridiagonal<const D: usize = DOFS> {
    /// `lower[i]` is at (i, i - 1); `lower[0]` is unused.
    pub lower: Vec<Block<D>>,
    /// `diagonal[i]` is at (i, i).
    pub diagonal: Vec<Block<D>>,
    /// `upper[i]` is at (i, i + 1); the last one is unused.
    pub upper: Vec<Block<D>>,
}

/// Blocks of the inverse of a [`BlockTridiagonal`].
#[derive(Debug, Clone, PartialEq)]
pub struct InverseBands<const D: usize = DOFS> {
    /// `diagonal[i]` is at (i, i).
    pub diagonal: Vec<Block<D>>,
    /// `upper[i]` is at (i, i + 1); the last one is unused.
    pub upper: Vec<Block<D>>,
}

impl<const D: usize> BlockTridiagonal<D> {
    /// The zero matrix of `rows` block rows.
    pub fn zeros(rows: usize) -> Self {
        let zero = vec![Block::zero(); rows];
        BlockTridiagonal { lower: zero.clone(), diagonal: zero.clone(), upper: zero }
    }

    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.diagonal.len()
    }

    /// Adds a block at (row, column).
    ///
    /// # Panics
    /// The block lies outside the three diagonals.
    pub fn add_block(&mut self, row: usize, column: usize, block: &Block<D>) {
        assert!(row < self.rows() && column < self.rows(), "block ({row}, {column}) of {} rows", self.rows());
        if row == column {
            self.diagonal[row].add(block);
        } else if column + 1 == row {
            self.lower[row].add(block);
        } else if row + 1 == column {
            self.upper[row].add(block);
        } else {
            panic!("block ({row}, {column}) is outside the three diagonals");
        }
    }

    /// `a A + b B + c C`.
    pub fn combine(a: f64, matrix_a: &Self, b: f64, matrix_b: &Self, c: f64, matrix_c: &Self) -> Self {
        let blocks = |a_blocks: &[Block<D>], b_blocks: &[Block<D>], c_blocks: &[Block<D>]| {
            let rows = a_blocks.iter().zip(b_blocks).zip(c_blocks);
            rows.map(|((block_a, block_b), block_c)| {
                Block::from_fn(|row, column| {
                    let place = (row, column);
                    block_c[place].mul_add(c, block_b[place].mul_add(b, block_a[place] * a))
                })
            })
            .collect()
        };
        BlockTridiagonal {
            lower: blocks(&matrix_a.lower, &matrix_b.lower, &matrix_c.lower),
            diagonal: blocks(&matrix_a.diagonal, &matrix_b.diagonal, &matrix_c.diagonal),
            upper: blocks(&matrix_a.upper, &matrix_b.upper, &matrix_c.upper),
        }
    }

    /// `y = A x`.
    pub fn multiply_into(&self, x: &[[f64; D]], y: &mut [[f64; D]]) {
        self.for_rows(x, y, |_, product| product);
    }

    /// `y = y + A x`.
    pub fn multiply_add(&self, x: &[[f64; D]], y: &mut [[f64; D]]) {
        self.for_rows(x, y, |y, product| std::array::from_fn(|dof| y[dof] + product[dof]));
    }

    #[inline(always)]
    fn for_rows(&self, x: &[[f64; D]], y: &mut [[f64; D]], finish: impl Fn([f64; D], [f64; D]) -> [f64; D]) {
        let rows = y.len();
        assert!(self.rows() == rows && x.len() == rows);
        for (row, y) in y.iter_mut().enumerate() {
            *y = finish(*y, self.row_product(row, x));
        }
    }

    #[inline(always)]
    fn row_product(&self, row: usize, x: &[[f64; D]]) -> [f64; D] {
        let mut sum = self.diagonal[row].add_product(&x[row], Sum::zero());
        if row > 0 {
            sum = self.lower[row].add_product(&x[row - 1], sum);
        }
        if row + 1 < x.len() {
            sum = self.upper[row].add_product(&x[row + 1], sum);
        }
        sum.total()
    }

    /// The blocks on the diagonal of the inverse, and those above it: row i's is at (i, i + 1), the last one is unused.
    ///
    /// Eliminating all rows above and below row i leaves the pivot `S_i + T_i - A_ii` there, S being the pivots of an elimination from
    /// the top and T those of one from the bottom; its inverse is the block on the diagonal. The block above the next row's diagonal block is
    /// `-S_i^-1 A_i,i+1` times that diagonal block.
    ///
    /// # Errors
    /// A pivot block is singular.
    pub fn inverse_bands(&self) -> Result<InverseBands<D>, SingularBlock> {
        let rows = self.rows();
        let inverse = |pivot: &Block<D>, row: usize| {
            let (inverse, smallest, _) = pivot.inverse();
            if smallest > 0.0 && inverse.is_finite() { Ok(inverse) } else { Err(SingularBlock { row }) }
        };
        let mut pivots = self.diagonal.clone();
        let mut upper = vec![Block::zero(); rows];
        for row in 1..rows {
            let above = inverse(&pivots[row - 1], row - 1)?.negated().multiply_block(&self.upper[row - 1]);
            self.lower[row].multiply_block_add(&above, &mut pivots[row]);
            upper[row - 1] = above;
        }
        let mut from_below = Block::zero();
        for row in (0..rows).rev() {
            let mut below = self.diagonal[row];
            self.upper[row].multiply_block_add(&from_below, &mut below);
            pivots[row].add(&below);
            pivots[row].add(&self.diagonal[row].negated());
            pivots[row] = inverse(&pivots[row], row)?;
            from_below = inverse(&below, row)?.negated().multiply_block(&self.lower[row]);
        }
        for row in 1..rows {
            upper[row - 1] = upper[row - 1].multiply_block(&pivots[row]);
        }
        Ok(InverseBands { diagonal: pivots, upper })
    }

    /// True if the last degree of freedom couples with others than the two before it.
    pub fn last_couples(&self) -> bool {
        self.blocks().into_iter().any(|(blocks, rows)| {
            blocks[rows].iter().any(|block| {
                (0..D).any(|i| (0..D).any(|j| !can_couple::<D>(i, j, false) && block[(i, j)] != 0.0))
            })
        })
    }

    /// The blocks below, on and above the diagonal, with the rows that have one.
    pub(super) fn blocks(&self) -> [(&[Block<D>], Range<usize>); 3] {
        let rows = self.rows();
        [(&self.lower, 1..rows), (&self.diagonal, 0..rows), (&self.upper, 0..rows - 1)]
    }
}

/// True if an entry of a block can differ from zero, given whether the matrix's
/// [last degree of freedom couples](BlockTridiagonal::last_couples).
#[inline(always)]
pub const fn can_couple<const D: usize>(row: usize, column: usize, last_couples: bool) -> bool {
    let (lower, higher) = if row < column { (row, column) } else { (column, row) };
    last_couples || higher + 1 < D || lower + 1 + BENDING_ROTATIONS >= D
}
