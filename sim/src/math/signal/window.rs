//! Windows: ranges of samples and their weights.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use serde::{Deserialize, Serialize};

/// Weights of the samples before a Fourier transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Window {
    /// Equal weights: exact for lines that fit the window, leaky for all others.
    #[default]
    Rectangular,
    /// The periodic Hann window (1 - cos(2 pi n / N)) / 2: little leakage, lines twice as wide.
    Hann,
}

impl Window {
    /// The weight of sample `n` of `count`.
    pub fn weight(self, n: usize, count: usize) -> f64 {
        match self {
            Window::Rectangular => 1.0,
            Window::Hann => 0.5 - 0.5 * (TAU * n as f64 / count as f64).cos(),
        }
    }

    /// Sum of the weights of `count` samples.
    pub(super) fn sum(self, count: usize) -> f64 {
        (0..count).map(|n| self.weight(n, count)).sum()
    }

    /// Offset of a line from its highest bin towards the higher neighbour, in bins from 0 to 1/2; `ratio` is the neighbour's
    /// amplitude over the highest bin's. Exact for a lone line in a long window
    /// (Rife and Vincent 1970 without window, Grandke 1983 with Hann's).
    pub(super) fn line_offset(self, ratio: f64) -> f64 {
        let offset = match self {
            Window::Rectangular => ratio / (1.0 + ratio),
            Window::Hann => (2.0 * ratio - 1.0) / (1.0 + ratio),
        };
        offset.clamp(0.0, 0.5)
    }

    /// Ratio of the highest bin to a line's amplitude, at an `offset` of 0 to 1/2 bins: the transform of the window's weights
    /// over its value on the bin, for a lone line in a long window (Harris 1978). Down to 0.64 without window, 0.85 with Hann's.
    pub(super) fn line_height(self, offset: f64) -> f64 {
        let run = PI * offset;
        let sinc = if run == 0.0 { 1.0 } else { run.sin() / run };
        match self {
            Window::Rectangular => sinc,
            Window::Hann => sinc / (1.0 - offset * offset),
        }
    }
}

/// The samples k with from <= k / rate < to, among `len` recorded at k / rate from k = 0 on.
///
/// A bound within rounding of a sample is that sample's time: at 1 kHz, [0.1, 0.3) holds 200 samples.
pub fn sample_range(from: f64, to: f64, rate_hz: f64, len: usize) -> Range<usize> {
    let first_not_before = |time: f64| {
        let position = time * rate_hz;
        let nearest = position.round();
        let is_sample = (position - nearest).abs() <= 1e-10 * nearest.abs().max(1.0);
        let index = if is_sample { nearest } else { position.ceil() };
        // The cast saturates: before the first sample is 0.
        (index as usize).min(len)
    };
    let start = first_not_before(from);
    start..first_not_before(to).max(start)
}
