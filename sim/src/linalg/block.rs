//! 6 x 6 blocks, column by column.

use std::ops::{Index, IndexMut};

use super::lane::{Lane, Mask};

/// Degrees of freedom of a node, and rows of a block.
pub const DOFS: usize = 6;

/// A 6 x 6 matrix stored by columns, so that a product sums whole columns.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Block<L> {
    /// The columns, each of six rows.
    pub columns: [[L; DOFS]; DOFS],
}

impl<L> Index<(usize, usize)> for Block<L> {
    type Output = L;

    /// The entry at (row, column).
    #[inline(always)]
    fn index(&self, (row, column): (usize, usize)) -> &L {
        &self.columns[column][row]
    }
}

impl<L> IndexMut<(usize, usize)> for Block<L> {
    #[inline(always)]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut L {
        &mut self.columns[column][row]
    }
}

impl<L: Lane> Block<L> {
    /// The zero block.
    pub fn zero() -> Self {
        Block { columns: [[L::splat(0.0); DOFS]; DOFS] }
    }

    /// The identity.
    pub fn identity() -> Self {
        let mut block = Self::zero();
        for i in 0..DOFS {
            block.columns[i][i] = L::splat(1.0);
        }
        block
    }

    /// A block from its entries.
    pub fn from_fn(mut entry: impl FnMut(usize, usize) -> L) -> Self {
        Block { columns: std::array::from_fn(|column| std::array::from_fn(|row| entry(row, column))) }
    }

    /// Adds another block.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for (column, other) in self.columns.iter_mut().zip(&other.columns) {
            for (entry, other) in column.iter_mut().zip(other) {
                *entry = *entry + *other;
            }
        }
    }

    /// `sum + self x`.
    #[inline(always)]
    pub(super) fn multiply_add(&self, x: &[L; DOFS], sum: [L; DOFS]) -> [L; DOFS] {
        let mut sum = sum;
        for (column, x) in self.columns.iter().zip(x) {
            for (sum, entry) in sum.iter_mut().zip(column) {
                *sum = entry.mul_add(*x, *sum);
            }
        }
        sum
    }

    /// `sum + self other`.
    #[inline(always)]
    pub(super) fn multiply_block_add(&self, other: &Self, sum: &Self) -> Self {
        Block { columns: std::array::from_fn(|c| self.multiply_add(&other.columns[c], sum.columns[c])) }
    }

    /// `-self`.
    pub(super) fn negated(&self) -> Self {
        Block { columns: self.columns.map(|column| column.map(|entry| -entry)) }
    }

    /// The largest magnitude of an entry that is a number.
    pub(super) fn largest(&self) -> L {
        self.columns.as_flattened().iter().fold(L::splat(0.0), |largest, entry| entry.abs().max(largest))
    }

    /// Lanes whose entries are all finite.
    pub(super) fn is_finite(&self) -> L::Mask {
        let infinity = L::splat(f64::INFINITY);
        let entries = self.columns.as_flattened().iter();
        entries.fold(L::Mask::splat(true), |finite, entry| finite & entry.abs().less_than(infinity))
    }

    /// The inverse by Gauss-Jordan elimination with partial pivoting, and the smallest pivot's magnitude.
    ///
    /// Each lane swaps its own rows by selection. A singular block gives a pivot of zero (or not a number) in
    /// its lane and no usable inverse there.
    pub(super) fn inverse(&self) -> (Self, L) {
        let mut left = self.columns;
        let mut right = Self::identity().columns;
        let mut smallest_pivot = L::splat(f64::INFINITY);
        for pivot in 0..DOFS {
            for row in pivot + 1..DOFS {
                let swap = left[pivot][row].abs().greater_than(left[pivot][pivot].abs());
                if swap.any() {
                    for column in left[pivot..].iter_mut().chain(&mut right) {
                        let (upper, lower) = (column[pivot], column[row]);
                        column[pivot] = L::select(swap, lower, upper);
                        column[row] = L::select(swap, upper, lower);
                    }
                }
            }
            smallest_pivot = left[pivot][pivot].abs().min(smallest_pivot);
            // What the pivot row, scaled to a pivot of one, adds to every row; itself in place of the pivot row.
            let mut multipliers = left[pivot].map(|entry| -entry);
            multipliers[pivot] = L::splat(1.0);
            let reciprocal = L::splat(1.0) / left[pivot][pivot];
            for column in left[pivot + 1..].iter_mut().chain(&mut right) {
                let scaled = column[pivot] * reciprocal;
                column[pivot] = L::splat(0.0);
                for (entry, multiplier) in column.iter_mut().zip(&multipliers) {
                    *entry = multiplier.mul_add(scaled, *entry);
                }
            }
        }
        (Block { columns: right }, smallest_pivot)
    }
}
