//! Blocks in the layout of a solve.

use super::block::Block;
use super::four::Four;
use super::lane::Lane;

/// A block that is multiplied many times, in the layout with the fastest reads. Columns of six rows fill a register and a half, and some would
/// lie across two cache lines; therefore the rows from the
/// fifth on lie apart, those of two columns in one register. Even columns add up in one sum and odd ones in another, and these are added in
/// the end, as in products of [`Block`]: the bits are the same.
#[derive(Debug, Clone, Copy)]
pub(super) struct SplitBlock<const D: usize> {
    /// The first four rows of each column.
    heads: [Four; D],
    /// The other rows of columns 0 and 1, 2 and 3, 4 and 5; zeros for missing rows.
    tails: [Four; 3],
}

/// A sum of products in parts.
#[derive(Clone, Copy)]
struct SplitSum {
    /// First rows, of even and odd columns.
    heads: [Four; 2],
    /// Last rows, those of even columns before those of odd ones.
    tail: Four,
}

impl<const D: usize> SplitBlock<D> {
    /// Splits a block.
    pub(super) fn new(block: &Block<D>) -> Self {
        let at = |row: usize, column: usize| {
            if row < D && column < D { block[(row, column)] } else { 0.0 }
        };
        SplitBlock {
            heads: std::array::from_fn(|column| Four::new(std::array::from_fn(|row| at(row, column)))),
            tails: std::array::from_fn(|pair| {
                let (even, odd) = (2 * pair, 2 * pair + 1);
                Four::new([at(4, even), at(5, even), at(4, odd), at(5, odd)])
            }),
        }
    }

    /// `self x + other y`.
    #[inline(always)]
    pub(super) fn sum_of_products(&self, x: &[f64; D], other: &Self, y: &[f64; D]) -> [f64; D] {
        let zero = SplitSum { heads: [Four::ZERO; 2], tail: Four::ZERO };
        other.add_product(y, self.add_product(x, zero)).total()
    }

    /// `sum + self x`.
    #[inline(always)]
    pub(super) fn multiply_add(&self, x: &[f64; D], sum: &[f64; D]) -> [f64; D] {
        let at = |row: usize| if row < D { sum[row] } else { 0.0 };
        let start = SplitSum {
            heads: [Four::new([at(0), at(1), at(2), at(3)]), Four::ZERO],
            tail: Four::new([at(4), at(5), 0.0, 0.0]),
        };
        self.add_product(x, start).total()
    }

    #[inline(always)]
    fn add_product(&self, x: &[f64; D], mut sum: SplitSum) -> SplitSum {
        for (column, head) in self.heads.iter().enumerate() {
            let part = &mut sum.heads[column % 2];
            *part = head.mul_add(Four::splat(x[column]), *part);
        }
        if D > 4 {
            for (pair, tail) in self.tails.iter().enumerate() {
                let (even, odd) = (x[2 * pair], if 2 * pair + 1 < D { x[2 * pair + 1] } else { 0.0 });
                sum.tail = tail.mul_add(Four::new([even, even, odd, odd]), sum.tail);
            }
        }
        sum
    }
}

impl SplitSum {
    #[inline(always)]
    fn total<const D: usize>(self) -> [f64; D] {
        let head = (self.heads[0] + self.heads[1]).to_array();
        let [a, b, c, d] = self.tail.to_array();
        let tail = [a + c, b + d];
        std::array::from_fn(|row| if row < 4 { head[row] } else { tail[row - 4] })
    }
}
