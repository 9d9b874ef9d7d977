//! The number type of laws that are evaluated for one node or for several side by side.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// One value for each of [`Lane::LANES`] nodes.
///
/// Every operation acts on each lane alone and rounds as the same operation of one `f64` does, so a lane's
/// bits do not depend on the number of other lanes. Code over lanes chooses by [`Lane::select`] and may
/// branch on [`Mask::any`] only to skip work that would change nothing.
pub trait Lane:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Number of lanes.
    const LANES: usize;

    /// One truth value for each lane.
    type Mask: Mask;

    /// The same value in every lane.
    fn splat(value: f64) -> Self;

    /// The value of one lane; `lane` is below [`Lane::LANES`].
    fn lane(self, lane: usize) -> f64;

    /// Sets the value of one lane; `lane` is below [`Lane::LANES`].
    fn set_lane(&mut self, lane: usize, value: f64);

    /// `self * factor + addend`, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;

    /// The magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;

    /// Lanes with `self < other`.
    fn less_than(self, other: Self) -> Self::Mask;

    /// `if_true` in the lanes of the mask, `if_false` in the others.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// Lanes with `self > other`.
    #[inline(always)]
    fn greater_than(self, other: Self) -> Self::Mask {
        other.less_than(self)
    }

    /// The smaller value; `other` if one is not a number.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.less_than(other), self, other)
    }

    /// The larger value; `other` if one is not a number.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.less_than(self), self, other)
    }

    /// Sine and cosine of an angle \[rad\] of at most 2^30 in magnitude: reduced by multiples of pi/2 in two parts (Cody and Waite), then the
    /// polynomials of `fdlibm`. The absolute error is below 3e-16.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let splat = Self::splat;
        // Adding and taking away 1.5 2^52 rounds to the nearest whole number.
        let nearest = |value: Self| (value + splat(ROUNDS)) - splat(ROUNDS);
        let quarters = nearest(self * splat(std::f64::consts::FRAC_2_PI));
        let reduced = (-quarters).mul_add(splat(std::f64::consts::FRAC_PI_2), self);
        let reduced = (-quarters).mul_add(splat(PI_HALF_TAIL), reduced);
        // -2 to 2.
        let quadrant = (-nearest(quarters * splat(0.25))).mul_add(splat(4.0), quarters);

        let square = reduced * reduced;
        let horner = |coefficients: &[f64]| {
            coefficients.iter().fold(splat(0.0), |sum, c| sum.mul_add(square, splat(*c)))
        };
        let sine = (reduced * square).mul_add(horner(&SINE), reduced);
        let cosine = (square * square).mul_add(horner(&COSINE), (-square).mul_add(splat(0.5), splat(1.0)));
        let is_odd = quadrant.abs().greater_than(splat(0.5)) & quadrant.abs().less_than(splat(1.5));
        let (sine, cosine) = (Self::select(is_odd, cosine, sine), Self::select(is_odd, sine, cosine));
        let is_half_turn = quadrant.abs().greater_than(splat(1.5));
        let sine_falls = quadrant.less_than(splat(-0.5)) | is_half_turn;
        let cosine_falls = quadrant.greater_than(splat(0.5)) | is_half_turn;
        (Self::select(sine_falls, -sine, sine), Self::select(cosine_falls, -cosine, cosine))
    }

    /// Arctangent \[rad\]: beyond 8 the asymptotic series pi/2 - 1/x + 1/(3 x^3) - ..., else the rational approximation of Moshier's Cephes library
    /// (`atan.c`). The relative error is below 3e-16.
    #[inline(always)]
    fn atan(self) -> Self {
        let one = Self::splat(1.0);
        let magnitude = self.abs();
        let far = magnitude.greater_than(Self::splat(FAR));
        let inverse = one / Self::select(far, magnitude, one);
        let square = inverse * inverse;
        let series = ATAN_SERIES.iter().fold(Self::splat(0.0), |sum, c| sum.mul_add(square, Self::splat(*c)));
        let far_angle = Self::splat(std::f64::consts::FRAC_PI_2)
            - (inverse * series.mul_add(square, one) - Self::splat(PI_HALF_TAIL));
        if !(!far).any() {
            return far_angle.copysign(self);
        }
        Self::select(far, far_angle, self.near_atan()).copysign(self)
    }

    /// Arctangent \[rad\] of the magnitude, by the rational approximation.
    #[inline(always)]
    fn near_atan(self) -> Self {
        let one = Self::splat(1.0);
        let magnitude = self.abs();
        let steep = magnitude.greater_than(Self::splat(TANGENT_OF_THREE_EIGHTHS_PI));
        let middle = magnitude.greater_than(Self::splat(0.66)) & !steep;

        // Reduced to [-0.66, 0.66] by atan x = pi/2 - atan(1/x) and atan x = pi/4 + atan((x-1)/(x+1)).
        let numerator = Self::select(steep, -one, Self::select(middle, magnitude - one, magnitude));
        let denominator = Self::select(steep, magnitude, Self::select(middle, magnitude + one, one));
        let reduced = numerator / denominator;
        let zero = Self::splat(0.0);
        let offset = Self::select(
            steep,
            Self::splat(std::f64::consts::FRAC_PI_2),
            Self::select(middle, Self::splat(std::f64::consts::FRAC_PI_4), zero),
        );
        let offset_tail = Self::select(
            steep,
            Self::splat(PI_HALF_TAIL),
            Self::select(middle, Self::splat(0.5 * PI_HALF_TAIL), zero),
        );

        let square = reduced * reduced;
        let horner = |coefficients: &[f64], leading: Self| {
            coefficients.iter().fold(leading, |sum, c| sum.mul_add(square, Self::splat(*c)))
        };
        let p = horner(&ATAN_P[1..], Self::splat(ATAN_P[0]));
        let q = horner(&ATAN_Q, one);
        let correction = square * p / q;
        offset + (reduced.mul_add(correction, reduced) + offset_tail)
    }
}

/// Truth values of the lanes.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same truth value in every lane.
    fn splat(value: bool) -> Self;

    /// True if any lane is true.
    fn any(self) -> bool;

    /// The truth value of one lane.
    fn lane(self, lane: usize) -> bool;
}

/// Value from which the series is summed; nine terms leave a remainder below x^-20 / 21.
const FAR: f64 = 8.0;

/// Coefficients of x^-18 to x^-2 in x (pi/2 - atan x), less its leading one.
const ATAN_SERIES: [f64; 9] = [
    -1.0 / 19.0,
    1.0 / 17.0,
    -1.0 / 15.0,
    1.0 / 13.0,
    -1.0 / 11.0,
    1.0 / 9.0,
    -1.0 / 7.0,
    1.0 / 5.0,
    -1.0 / 3.0,
];

/// 1.5 2^52: numbers of its size have no digits after the point.
const ROUNDS: f64 = 6_755_399_441_055_744.0;

/// Coefficients of (sin x - x) / x^3 in x^2, the highest power first.
const SINE: [f64; 6] = [
    1.589_690_995_211_55e-10,
    -2.505_076_025_340_686_3e-8,
    2.755_731_370_707_006_8e-6,
    -1.984_126_982_985_795e-4,
    8.333_333_333_322_49e-3,
    -1.666_666_666_666_663_2e-1,
];

/// Coefficients of (cos x - 1 + x^2 / 2) / x^4 in x^2, the highest power first.
const COSINE: [f64; 6] = [
    -1.135_964_755_778_819_5e-11,
    2.087_572_321_298_175e-9,
    -2.755_731_435_139_066_3e-7,
    2.480_158_728_947_673e-5,
    -1.388_888_888_887_411e-3,
    4.166_666_666_666_66e-2,
];

const TANGENT_OF_THREE_EIGHTHS_PI: f64 = 2.414_213_562_373_095;
/// pi/2 less its nearest `f64`.
const PI_HALF_TAIL: f64 = 6.123_233_995_736_766e-17;
const ATAN_P: [f64; 5] = [
    -8.750_608_600_031_904e-1,
    -1.615_753_718_733_365e1,
    -7.500_855_792_314_705e1,
    -1.228_866_684_490_136_2e2,
    -6.485_021_904_942_025e1,
];
const ATAN_Q: [f64; 5] = [
    2.485_846_490_142_306_3e1,
    1.650_270_098_316_988_5e2,
    4.328_810_604_912_902_7e2,
    4.853_903_996_359_137e2,
    1.945_506_571_482_614e2,
];

impl Lane for f64 {
    const LANES: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn lane(self, _lane: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn set_lane(&mut self, _lane: usize, value: f64) {
        *self = value;
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        f64::mul_add(self, factor, addend)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        f64::copysign(self, sign)
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }

    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn lane(self, _lane: usize) -> bool {
        self
    }
}
