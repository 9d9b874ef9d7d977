//! Small square blocks, column by column.

use std::ops::{Index, IndexMut};

use super::lane::{Lane, Mask};

/// Degrees of freedom of a node, and rows of a block where nothing else is said.
pub const DOFS: usize = 6;

/// A D x D matrix, D from 2 to 6, stored by columns, so that a product sums whole columns.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Block<L, const D: usize = DOFS> {
    /// The columns, each of D rows.
    pub columns: [[L; D]; D],
}

/// A sum of products of blocks and vectors in two parts; half as many additions wait for each other as in one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum<L, const D: usize>([[L; D]; 2]);

impl<L: Lane, const D: usize> Sum<L, D> {
    #[inline(always)]
    pub(super) fn zero() -> Self {
        Sum([[L::splat(0.0); D]; 2])
    }

    #[inline(always)]
    pub(super) fn total(self) -> [L; D] {
        std::array::from_fn(|row| self.0[0][row] + self.0[1][row])
    }
}

impl<L, const D: usize> Index<(usize, usize)> for Block<L, D> {
    type Output = L;

    /// The entry at (row, column).
    #[inline(always)]
    fn index(&self, (row, column): (usize, usize)) -> &L {
        &self.columns[column][row]
    }
}

impl<L, const D: usize> IndexMut<(usize, usize)> for Block<L, D> {
    #[inline(always)]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut L {
        &mut self.columns[column][row]
    }
}

impl<L: Lane, const D: usize> Block<L, D> {
    /// The zero block.
    pub fn zero() -> Self {
        Block { columns: [[L::splat(0.0); D]; D] }
    }

    /// The identity.
    pub fn identity() -> Self {
        let mut block = Self::zero();
        for i in 0..D {
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
    pub(super) fn multiply_add(&self, x: &[L; D], sum: [L; D]) -> [L; D] {
        self.add_product(x, Sum([sum, [L::splat(0.0); D]])).total()
    }

    /// `sum + self x`, not added up yet.
    #[inline(always)]
    pub(super) fn add_product(&self, x: &[L; D], Sum(mut parts): Sum<L, D>) -> Sum<L, D> {
        for (j, column) in self.columns.iter().enumerate() {
            for (sum, entry) in parts[j % 2].iter_mut().zip(column) {
                *sum = entry.mul_add(x[j], *sum);
            }
        }
        Sum(parts)
    }

    /// `sum = sum + self other`.
    #[inline(always)]
    pub(super) fn multiply_block_add(&self, other: &Self, sum: &mut Self) {
        for (sum, column) in sum.columns.iter_mut().zip(&other.columns) {
            *sum = self.multiply_add(column, *sum);
        }
    }

    /// `self other`.
    #[inline(always)]
    pub(super) fn multiply_block(&self, other: &Self) -> Self {
        let mut product = Self::zero();
        self.multiply_block_add(other, &mut product);
        product
    }

    /// `-self`.
    #[inline(always)]
    pub(super) fn negated(&self) -> Self {
        let mut negated = *self;
        for entry in negated.columns.as_flattened_mut() {
            *entry = -*entry;
        }
        negated
    }

    /// The largest magnitude of an entry that is a number.
    pub(super) fn largest(&self) -> L {
        let mut rows = [L::splat(0.0); D];
        for column in &self.columns {
            for (largest, entry) in rows.iter_mut().zip(column) {
                *largest = entry.abs().max(*largest);
            }
        }
        rows.into_iter().fold(L::splat(0.0), L::max)
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
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut columns = self.columns;
        let mut swaps = [[L::Mask::splat(false); D]; D];
        let mut smallest_pivot = L::splat(f64::INFINITY);
        for pivot in 0..D {
            for row in pivot + 1..D {
                let swap = columns[pivot][row].abs().greater_than(columns[pivot][pivot].abs());
                swaps[pivot][row] = swap;
                if swap.any() {
                    for column in &mut columns {
                        let (upper, lower) = (column[pivot], column[row]);
                        column[pivot] = L::select(swap, lower, upper);
                        column[row] = L::select(swap, upper, lower);
                    }
                }
            }
            smallest_pivot = columns[pivot][pivot].abs().min(smallest_pivot);
            // What the pivot row, scaled to a pivot of one, adds to every row; itself in place of the pivot row.
            let mut multipliers = columns[pivot];
            for multiplier in &mut multipliers {
                *multiplier = -*multiplier;
            }
            multipliers[pivot] = one;
            let reciprocal = one / columns[pivot][pivot];
            // The eliminated column makes room for the inverse's, which starts as the identity's.
            columns[pivot] = [zero; D];
            columns[pivot][pivot] = one;
            for column in &mut columns {
                let scaled = column[pivot] * reciprocal;
                column[pivot] = zero;
                for (entry, multiplier) in column.iter_mut().zip(&multipliers) {
                    *entry = multiplier.mul_add(scaled, *entry);
                }
            }
        }
        // Rows swapped on the way in are columns of the inverse to swap back.
        for pivot in (0..D).rev() {
            for other in (pivot + 1..D).rev() {
                let swap = swaps[pivot][other];
                if swap.any() {
                    let (before, after) = columns.split_at_mut(other);
                    for (left, right) in before[pivot].iter_mut().zip(&mut after[0]) {
                        (*left, *right) = (L::select(swap, *right, *left), L::select(swap, *left, *right));
                    }
                }
            }
        }
        (Block { columns }, smallest_pivot)
    }
}
