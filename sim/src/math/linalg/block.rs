//! Small square blocks, column by column.

use std::ops::{Index, IndexMut};

use crate::math::dof::DOFS;

/// A D x D matrix, D from 2 to 6, stored by columns, so that a product sums whole columns.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Block<const D: usize = DOFS> {
    /// The columns, each of D rows.
    pub columns: [[f64; D]; D],
}

/// A sum of products of blocks and vectors in two parts, so that half as many additions wait for each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum<const D: usize>([[f64; D]; 2]);

impl<const D: usize> Sum<D> {
    #[inline(always)]
    pub(super) fn zero() -> Self {
        Sum([[0.0; D]; 2])
    }

    #[inline(always)]
    pub(super) fn total(self) -> [f64; D] {
        std::array::from_fn(|row| self.0[0][row] + self.0[1][row])
    }
}

impl<const D: usize> Index<(usize, usize)> for Block<D> {
    type Output = f64;

    /// The entry at (row, column).
    #[inline(always)]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.columns[column][row]
    }
}

impl<const D: usize> IndexMut<(usize, usize)> for Block<D> {
    #[inline(always)]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.columns[column][row]
    }
}

impl<const D: usize> Block<D> {
    /// The zero block.
    pub fn zero() -> Self {
        Block { columns: [[0.0; D]; D] }
    }

    /// The identity.
    pub fn identity() -> Self {
        let mut block = Self::zero();
        for i in 0..D {
            block.columns[i][i] = 1.0;
        }
        block
    }

    /// A block from its entries.
    pub fn from_fn(mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        Block { columns: std::array::from_fn(|column| std::array::from_fn(|row| entry(row, column))) }
    }

    /// Adds another block.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for (column, other) in self.columns.iter_mut().zip(&other.columns) {
            for (entry, other) in column.iter_mut().zip(other) {
                *entry += *other;
            }
        }
    }

    /// `sum + self x`.
    #[inline(always)]
    pub(super) fn multiply_add(&self, x: &[f64; D], sum: [f64; D]) -> [f64; D] {
        self.add_product(x, Sum([sum, [0.0; D]])).total()
    }

    /// `sum + self x` in its parts.
    #[inline(always)]
    pub(super) fn add_product(&self, x: &[f64; D], Sum(mut parts): Sum<D>) -> Sum<D> {
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

    /// The largest magnitude of an entry; entries that are not numbers are ignored.
    pub(super) fn largest(&self) -> f64 {
        self.columns.as_flattened().iter().fold(0.0, |largest, entry| entry.abs().max(largest))
    }

    /// True if all entries are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.columns.as_flattened().iter().all(|entry| entry.is_finite())
    }

    /// The inverse by Gauss-Jordan elimination with partial pivoting, and the smallest pivot's magnitude. A singular block yields a pivot
    /// of zero (or not a number) and no usable inverse.
    pub(super) fn inverse(&self) -> (Self, f64, bool) {
        let mut is_negative = false;
        let mut columns = self.columns;
        let mut swaps = [[false; D]; D];
        let mut smallest_pivot = f64::INFINITY;
        for pivot in 0..D {
            for row in pivot + 1..D {
                let swap = columns[pivot][row].abs() > columns[pivot][pivot].abs();
                swaps[pivot][row] = swap;
                is_negative ^= swap;
                if swap {
                    for column in &mut columns {
                        column.swap(pivot, row);
                    }
                }
            }
            smallest_pivot = columns[pivot][pivot].abs().min(smallest_pivot);
            is_negative ^= columns[pivot][pivot] < 0.0;
            // The pivot row's contribution, with its pivot scaled to one, to every row; in place of the pivot row the row itself.
            let mut multipliers = columns[pivot].map(|multiplier| -multiplier);
            multipliers[pivot] = 1.0;
            let reciprocal = 1.0 / columns[pivot][pivot];
            // The eliminated column makes room for the inverse's, which starts as the identity's.
            columns[pivot] = [0.0; D];
            columns[pivot][pivot] = 1.0;
            for column in &mut columns {
                let scaled = column[pivot] * reciprocal;
                column[pivot] = 0.0;
                for (entry, multiplier) in column.iter_mut().zip(&multipliers) {
                    *entry = multiplier.mul_add(scaled, *entry);
                }
            }
        }
        // Rows swapped on the way in are columns of the inverse to swap back.
        for pivot in (0..D).rev() {
            for other in (pivot + 1..D).rev().filter(|&other| swaps[pivot][other]) {
                columns.swap(pivot, other);
            }
        }
        (Block { columns }, smallest_pivot, is_negative)
    }
}
