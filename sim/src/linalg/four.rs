//! Four lanes in a plain array: not fast, but it shows that the kernels treat each lane as one `f64`.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::{Lane, Mask};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Four(pub(crate) [f64; 4]);

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FourMask(pub(crate) [bool; 4]);

impl Four {
    fn with(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        Four(std::array::from_fn(|i| operation(self.0[i], other.0[i])))
    }
}

impl Add for Four {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Four {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Four {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Div for Four {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}

impl Neg for Four {
    type Output = Self;

    fn neg(self) -> Self {
        Four(self.0.map(|a| -a))
    }
}

impl Lane for Four {
    const LANES: usize = 4;
    type Mask = FourMask;

    fn splat(value: f64) -> Self {
        Four([value; 4])
    }

    fn lane(self, lane: usize) -> f64 {
        self.0[lane]
    }

    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0[lane] = value;
    }

    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Four(std::array::from_fn(|i| self.0[i].mul_add(factor.0[i], addend.0[i])))
    }

    fn sqrt(self) -> Self {
        Four(self.0.map(f64::sqrt))
    }

    fn abs(self) -> Self {
        Four(self.0.map(f64::abs))
    }

    fn copysign(self, sign: Self) -> Self {
        self.with(sign, f64::copysign)
    }

    fn less_than(self, other: Self) -> FourMask {
        FourMask(std::array::from_fn(|i| self.0[i] < other.0[i]))
    }

    fn select(mask: FourMask, if_true: Self, if_false: Self) -> Self {
        Four(std::array::from_fn(|i| if mask.0[i] { if_true.0[i] } else { if_false.0[i] }))
    }
}

impl BitAnd for FourMask {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        FourMask(std::array::from_fn(|i| self.0[i] && other.0[i]))
    }
}

impl BitOr for FourMask {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        FourMask(std::array::from_fn(|i| self.0[i] || other.0[i]))
    }
}

impl Not for FourMask {
    type Output = Self;

    fn not(self) -> Self {
        FourMask(self.0.map(|a| !a))
    }
}

impl Mask for FourMask {
    fn splat(value: bool) -> Self {
        FourMask([value; 4])
    }

    fn any(self) -> bool {
        self.0.contains(&true)
    }

    fn lane(self, lane: usize) -> bool {
        self.0[lane]
    }
}
