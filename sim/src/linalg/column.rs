//! A column of a block in vectors of four rows and two: left to itself, the compiler goes row by row from the fifth on.

use wide::{f64x2, f64x4};

use super::four::FUSED;

/// Up to six rows of one `f64` each; rows that a block does not have are zeros.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    head: f64x4,
    tail: f64x2,
}

impl Column {
    #[inline(always)]
    pub(super) fn new<const D: usize>(rows: &[f64; D]) -> Self {
        let at = |row: usize| if row < D { rows[row] } else { 0.0 };
        Column { head: f64x4::new([at(0), at(1), at(2), at(3)]), tail: f64x2::new([at(4), at(5)]) }
    }

    /// `self * factor + addend`, each row rounded once.
    #[inline(always)]
    pub(super) fn mul_add(self, factor: f64, addend: Self) -> Self {
        if FUSED {
            return Column {
                head: self.head.mul_add(f64x4::splat(factor), addend.head),
                tail: self.tail.mul_add(f64x2::splat(factor), addend.tail),
            };
        }
        let (a, b) = (self.to_rows::<6>(), addend.to_rows::<6>());
        Column::new::<6>(&std::array::from_fn(|row| a[row].mul_add(factor, b[row])))
    }

    #[inline(always)]
    pub(super) fn to_rows<const D: usize>(self) -> [f64; D] {
        let (head, tail) = (self.head.to_array(), self.tail.to_array());
        std::array::from_fn(|row| if row < 4 { head[row] } else { tail[row - 4] })
    }
}
