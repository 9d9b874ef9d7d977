//! Four lanes in one vector register.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use wide::f64x4;

use super::lane::{Lane, Mask};

/// True if vectors multiply and add in one instruction. Without it, vectors would round twice and a lane alone once: then all is computed lane by
/// lane, at a twelfth of the speed, to the same bits.
pub(super) const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

/// Four values side by side; each lane has the bits of one `f64` alone.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(transparent)]
pub struct Four(f64x4);

/// Truth values of the lanes of [`Four`]: all bits of a lane, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(transparent)]
pub struct FourMask(f64x4);

impl Four {
    /// Zero in every lane.
    pub const ZERO: Four = Four(f64x4::ZERO);

    /// The values of lanes 0 to 3.
    #[inline(always)]
    pub fn new(values: [f64; 4]) -> Self {
        Four(f64x4::new(values))
    }

    /// The values of lanes 0 to 3.
    ///
    /// # Panics
    /// There are not four values.
    #[inline(always)]
    pub fn from_slice(values: &[f64]) -> Self {
        let [a, b, c, d] = values else { panic!("{} values for four lanes", values.len()) };
        Four::new([*a, *b, *c, *d])
    }

    /// The values of lanes 0 to 3.
    #[inline(always)]
    pub fn to_array(self) -> [f64; 4] {
        self.0.to_array()
    }

    /// The value of one lane; `lane` is below 4.
    #[inline(always)]
    pub fn lane_ref(&self, lane: usize) -> &f64 {
        &self.0.as_array()[lane]
    }

    /// As [`Four::lane_ref`].
    #[inline(always)]
    pub fn lane_mut(&mut self, lane: usize) -> &mut f64 {
        &mut self.0.as_mut_array()[lane]
    }

    /// Lane i of each in vector i.
    #[inline(always)]
    pub fn transpose(vectors: [Four; 4]) -> [Four; 4] {
        let [a, b, c, d] = vectors;
        let (a, b, c, d) = (a.to_array(), b.to_array(), c.to_array(), d.to_array());
        [
            Four::new([a[0], b[0], c[0], d[0]]),
            Four::new([a[1], b[1], c[1], d[1]]),
            Four::new([a[2], b[2], c[2], d[2]]),
            Four::new([a[3], b[3], c[3], d[3]]),
        ]
    }

    /// The sum of the lanes, by pairs.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [a, b, c, d] = self.to_array();
        (a + b) + (c + d)
    }
}

impl Add for Four {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Four(self.0 + other.0)
    }
}

impl Sub for Four {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Four(self.0 - other.0)
    }
}

impl Mul for Four {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Four(self.0 * other.0)
    }
}

impl Div for Four {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Four(self.0 / other.0)
    }
}

impl Neg for Four {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Four(self.0 ^ f64x4::splat(-0.0))
    }
}

impl Lane for Four {
    const LANES: usize = 4;
    type Mask = FourMask;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Four(f64x4::splat(value))
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        *self.lane_ref(lane)
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        *self.lane_mut(lane) = value;
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        if FUSED {
            Four(self.0.mul_add(factor.0, addend.0))
        } else {
            let (a, b, c) = (self.to_array(), factor.to_array(), addend.to_array());
            Four::new(std::array::from_fn(|i| a[i].mul_add(b[i], c[i])))
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Four(self.0.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Four(self.0.abs())
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Four(f64x4::splat(-0.0).bitselect(sign.0, self.0))
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> FourMask {
        FourMask(self.0.simd_lt(other.0))
    }

    #[inline(always)]
    fn select(mask: FourMask, if_true: Self, if_false: Self) -> Self {
        Four(mask.0.select(if_true.0, if_false.0))
    }
}

impl BitAnd for FourMask {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        FourMask(self.0 & other.0)
    }
}

impl BitOr for FourMask {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        FourMask(self.0 | other.0)
    }
}

impl Not for FourMask {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        FourMask(!self.0)
    }
}

impl Mask for FourMask {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        FourMask(f64x4::splat(f64::from_bits(if value { u64::MAX } else { 0 })))
    }

    #[inline(always)]
    fn any(self) -> bool {
        self.0.to_bitmask() != 0
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        self.0.to_bitmask() & (1 << lane) != 0
    }
}
