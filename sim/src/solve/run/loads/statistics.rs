//! Sums and extremes of four nodes or elements at a time.

use serde::{Deserialize, Serialize};

use crate::math::linalg::{Four, Lane};

/// Root mean square of a quantity over the window, and its largest value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RmsAndPeak {
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude, with its time.
    pub peak: Peak,
}

/// Largest value over the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    /// Value.
    pub value: f64,
    /// Time of its first occurrence \[s\].
    pub time: f64,
}

/// Mean and extremes of a quantity over the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Span {
    /// Mean over time.
    pub mean: f64,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub largest: f64,
}

/// Integrals over time of `M` quantities, and the extremes of `E`; in checkpoints one row of numbers, since serde knows no arrays of a length that
/// is a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<f64>", try_from = "Vec<f64>")]
pub(super) struct Sums<const M: usize, const E: usize> {
    pub(super) integrals: [Four; M],
    pub(super) extremes: [Extreme; E],
}

/// Largest value so far, with its time \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extreme {
    value: Four,
    time: Four,
}

impl<const M: usize, const E: usize> Sums<M, E> {
    pub(super) fn none() -> Self {
        Self { integrals: [Four::ZERO; M], extremes: [Extreme::none(); E] }
    }

    /// Adds a step of `h` \[s\] between two samples.
    #[inline(always)]
    pub(super) fn integrate(&mut self, h: f64, before: &[Four; M], after: &[Four; M]) {
        let half = Four::splat(0.5 * h);
        for quantity in 0..M {
            let sum = before[quantity] + after[quantity];
            self.integrals[quantity] = sum.mul_add(half, self.integrals[quantity]);
        }
    }

    pub(super) fn add(&mut self, next: &Self) {
        for (sum, next) in self.integrals.iter_mut().zip(next.integrals) {
            *sum = *sum + next;
        }
        for (extreme, next) in self.extremes.iter_mut().zip(next.extremes) {
            extreme.raise(next.value, next.time);
        }
    }

    /// Mean over `duration` \[s\] of a quantity in a lane.
    pub(super) fn mean(&self, quantity: usize, lane: usize, duration: f64) -> f64 {
        self.integrals[quantity].lane(lane) / duration
    }

    /// Largest value of a quantity in a lane.
    pub(super) fn peak(&self, quantity: usize, lane: usize) -> Peak {
        let Extreme { value, time } = self.extremes[quantity];
        Peak { value: value.lane(lane), time: time.lane(lane) }
    }

    /// Root mean square and largest magnitude of a quantity whose square is integrated and compared.
    pub(super) fn of_square(&self, [mean, peak]: [usize; 2], lane: usize, duration: f64) -> RmsAndPeak {
        let Peak { value, time } = self.peak(peak, lane);
        RmsAndPeak {
            rms: self.mean(mean, lane, duration).max(0.0).sqrt(),
            peak: Peak { value: value.max(0.0).sqrt(), time },
        }
    }

    /// Mean and extremes of a quantity whose negative and whose value are compared.
    pub(super) fn span(
        &self,
        mean: usize,
        [negative, value]: [usize; 2],
        lane: usize,
        duration: f64,
    ) -> Span {
        Span {
            mean: self.mean(mean, lane, duration),
            least: -self.peak(negative, lane).value,
            largest: self.peak(value, lane).value,
        }
    }
}

impl<const M: usize, const E: usize> From<Sums<M, E>> for Vec<f64> {
    fn from(sums: Sums<M, E>) -> Self {
        let extremes = sums.extremes.iter().flat_map(|extreme| [extreme.value, extreme.time]);
        sums.integrals.into_iter().chain(extremes).flat_map(Four::to_array).collect()
    }
}

impl<const M: usize, const E: usize> TryFrom<Vec<f64>> for Sums<M, E> {
    type Error = &'static str;

    fn try_from(values: Vec<f64>) -> Result<Self, Self::Error> {
        let (groups, rest) = values.as_chunks();
        if groups.len() != M + 2 * E || !rest.is_empty() {
            return Err("sums of loads of another number of quantities");
        }
        let four = |place: usize| Four::new(groups[place]);
        Ok(Self {
            integrals: std::array::from_fn(four),
            extremes: std::array::from_fn(|extreme| Extreme {
                value: four(M + 2 * extreme),
                time: four(M + 2 * extreme + 1),
            }),
        })
    }
}

impl Extreme {
    fn none() -> Self {
        Self { value: Four::splat(f64::NEG_INFINITY), time: Four::ZERO }
    }

    /// Raises the largest value to `value` at `time` \[s\], if that is larger.
    #[inline(always)]
    pub(super) fn raise(&mut self, value: Four, time: Four) {
        let is_larger = value.greater_than(self.value);
        self.value = Four::select(is_larger, value, self.value);
        self.time = Four::select(is_larger, time, self.time);
    }
}

/// One for lanes in which a condition holds, zero for others.
#[inline(always)]
pub(super) fn indicator(condition: <Four as Lane>::Mask) -> Four {
    Four::select(condition, Four::splat(1.0), Four::ZERO)
}
