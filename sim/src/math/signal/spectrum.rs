//! Full (two-sided) spectra and their lines.

use std::ops::RangeInclusive;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::fft;
use super::window::Window;

/// The full spectrum of an orbit: one amplitude for every frequency, negative for backward whirl.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct FullSpectrum {
    /// Distance of two neighbouring frequencies \[Hz\].
    pub resolution_hz: f64,
    /// Window of the transform.
    pub window: Window,
    /// Frequencies \[Hz\], ascending.
    pub frequency_hz: Vec<f64>,
    /// Radius of the circle travelled at each frequency \[m\]: |Z| / N, less the window's own weight.
    pub amplitude: Vec<f64>,
}

/// One line of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Peak {
    /// Frequency \[Hz\], interpolated between the bins.
    pub frequency_hz: f64,
    /// Amplitude \[m\] of the motion, interpolated like the frequency, whatever the distance of the frequency from a bin.
    pub amplitude: f64,
    /// Sense of the motion.
    pub whirl: Whirl,
}

/// Sense of a line's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Whirl {
    /// In the sense of the string's rotation.
    Forward,
    /// Against the string's rotation.
    Backward,
    /// No motion: the orbit's mean position.
    Offset,
}

/// Criteria of a search for lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakSearch {
    /// Largest number of lines, the highest first.
    pub count: usize,
    /// Least separation \[Hz\]: lines closer than this to a higher one are skipped.
    pub min_separation_hz: f64,
    /// True if the mean position (0 Hz) is skipped.
    pub exclude_mean: bool,
}

/// The full spectrum of (u, v) \[m\] sampled at `rate_hz`, for any number of samples. The highest of an even
/// number of frequencies counts as negative. Without samples the spectrum is empty.
///
/// ```
/// use std::f64::consts::TAU;
///
/// use drillsweep_sim::math::signal::{Window, full_spectrum};
///
/// // A circle of 3 mm, travelled twice a second against the rotation of the string, over one second.
/// let angles = (0..100).map(|n| -TAU * 2.0 * f64::from(n) / 100.0);
/// let (u, v): (Vec<f64>, Vec<f64>) = angles.map(|angle| (3e-3 * angle.cos(), 3e-3 * angle.sin())).unzip();
/// let spectrum = full_spectrum(&u, &v, 100.0, Window::Rectangular);
/// let line = spectrum.frequency_hz.iter().position(|&frequency| frequency == -2.0).unwrap();
/// assert!((spectrum.amplitude[line] - 3e-3).abs() < 1e-15);
/// ```
///
/// # Panics
/// u and v differ in length.
pub fn full_spectrum(u: &[f64], v: &[f64], rate_hz: f64, window: Window) -> FullSpectrum {
    assert_eq!(u.len(), v.len());
    let count = u.len();
    let mut bins: Vec<Complex<f64>> = u
        .iter()
        .zip(v)
        .enumerate()
        .map(|(n, (u, v))| Complex::new(*u, *v) * window.weight(n, count))
        .collect();
    fft::forward(&mut bins);
    // The second half of the bins are the negative frequencies.
    let negative = count / 2;
    bins.rotate_right(negative);
    let resolution_hz = rate_hz / count.max(1) as f64;
    let scale = 1.0 / window.sum(count);
    FullSpectrum {
        resolution_hz,
        window,
        frequency_hz: (0..count).map(|bin| (bin as f64 - negative as f64) * rate_hz / count as f64).collect(),
        amplitude: bins.iter().map(|bin| bin.norm() * scale).collect(),
    }
}

impl FullSpectrum {
    /// Twice the amplitude, 2 |Z| / N \[m\]: the convention of Tran et al. 2019, whose 0 Hz value is twice the
    /// orbit's offset.
    pub fn peak_to_peak(&self) -> Vec<f64> {
        self.amplitude.iter().map(|amplitude| 2.0 * amplitude).collect()
    }

    /// The part at frequencies within a range \[Hz\].
    pub fn restricted_to(&self, range_hz: &RangeInclusive<f64>) -> FullSpectrum {
        let inside = |(frequency, _): &(&f64, &f64)| range_hz.contains(frequency);
        let bins = self.frequency_hz.iter().zip(&self.amplitude).filter(inside);
        let (frequency_hz, amplitude) = bins.unzip();
        FullSpectrum { resolution_hz: self.resolution_hz, window: self.window, frequency_hz, amplitude }
    }

    /// The highest lines, the highest first. A line is a bin above both its neighbours, so the first and last
    /// bins are none. Frequency and amplitude are interpolated between the bins: exactly for a single line in a long window, otherwise
    /// up to the leakage of other lines.
    pub fn peaks(&self, search: &PeakSearch) -> Vec<Peak> {
        let mut candidates: Vec<Peak> =
            (1..self.amplitude.len().saturating_sub(1)).filter_map(|bin| self.peak_at(bin)).collect();
        candidates.retain(|peak| !(search.exclude_mean && peak.whirl == Whirl::Offset));
        candidates.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let mut chosen: Vec<Peak> = Vec::new();
        for candidate in candidates {
            let distance = |peak: &Peak| (peak.frequency_hz - candidate.frequency_hz).abs();
            if chosen.len() < search.count
                && chosen.iter().all(|peak| distance(peak) >= search.min_separation_hz)
            {
                chosen.push(candidate);
            }
        }
        chosen
    }

    fn peak_at(&self, bin: usize) -> Option<Peak> {
        let (below, amplitude, above) =
            (self.amplitude[bin - 1], self.amplitude[bin], self.amplitude[bin + 1]);
        if !(amplitude > below && amplitude >= above) {
            return None;
        }
        let centre = self.frequency_hz[bin];
        let whirl = if centre.abs() < 0.5 * self.resolution_hz {
            Whirl::Offset
        } else if centre > 0.0 {
            Whirl::Forward
        } else {
            Whirl::Backward
        };
        let offset = self.window.line_offset(below.max(above) / amplitude);
        let towards = if above > below { offset } else { -offset };
        Some(Peak {
            frequency_hz: centre + towards * self.resolution_hz,
            amplitude: amplitude / self.window.line_height(offset),
            whirl,
        })
    }
}
