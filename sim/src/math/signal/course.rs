//! Motion over a whole run, and its settling.
//!
//! Regular motion (a few base frequencies and their combinations) settles when statistics of consecutive windows agree. They are weighted by
//! Hann's window: weighted means of such motion converge faster than any power of the window's length, plain ones with its inverse (Das,
//! Saiki, Sander and Yorke 2017, "Quantitative quasiperiodicity"; Duignan and Meiss 2023, "Distinguishing between regular and chaotic orbits
//! of flows by the weighted Birkhoff average"). Means of irregular motion scatter with any weights; their interval is that of batch
//! means (Law and Kelton, "Simulation modeling and analysis", chapter 9).

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::spectrum::{FullSpectrum, PeakSearch, full_spectrum};
use super::window::Window;

/// Lengths of windows whose statistics are compared \[s\], the shortest first.
const LENGTHS: [f64; 3] = [20.0, 40.0, 80.0];

/// The longest of them \[s\].
pub const LONGEST_WINDOW: f64 = LENGTHS[LENGTHS.len() - 1];

/// Least number of beats of the closest pair of strong lines in a window.
const BEATS: f64 = 2.0;

/// Length of the end of the run \[s\] whose lines are searched for beats: long enough to separate lines that beat in 20 s.
const LINES_OF: f64 = 40.0;

/// Amplitude of a strong line relative to the strongest. A weaker pair changes an orbit's size by less than a per cent in the course of its beat.
const STRONG: f64 = 0.1;

/// Distance in bins below which two lines are one.
const APART: f64 = 1.5;

/// Share of the strongest line's power from which a line is one of the base frequencies.
const BASE_POWER: f64 = 0.01;

/// Largest multiple of the strongest line by which another one is explained: friction produces many of them.
const LARGEST_MULTIPLE: i32 = 12;

/// Batches of irregular motion.
const BATCHES: usize = 8;

/// Student's t of 95 % (two-sided) for the mean of eight batches.
const STUDENT: f64 = 2.365;

/// The shortest batch \[s\]: several periods of the slowest torsion of long strings, so that neighbouring batches hardly depend on each other.
const SHORTEST_BATCH: f64 = 10.0;

/// Student's t of 98 % (two-sided) for the difference between the means of the first and of the last four batches: one of fifty statistics of
/// steady motion exceeds it. A straight trend alone has 4.4, amplitudes that grow 4.5-fold over the batches have 3.2.
const STEADY: f64 = 3.143;

/// Motion of the recorded nodes and rate of twist at the bit, at the recording rate or a whole part of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Course {
    rate_hz: f64,
    /// Samples of the run, at `rate_hz`, before its first.
    before: usize,
    /// Lateral displacements u and v of each node \[m\].
    orbits: Vec<[Vec<f64>; 2]>,
    /// Rate of twist at the bit \[rad/s\]; empty if torsion is not solved for.
    twist_rate: Vec<f64>,
}

/// Relative differences of statistics that count as none, and least sizes of motion for relative differences.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// Difference of orbit sizes, and of the standard deviation of the rotation speed.
    pub orbit_size: f64,
    /// Difference of standard deviations of the radius.
    pub radius_deviation: f64,
    /// Smaller orbits and deviations \[m\] count as this large.
    pub smallest_orbit: f64,
    /// Smaller standard deviations of the rotation speed \[rad/s\] count as this large.
    pub smallest_rotation: f64,
}

/// Three windows whose statistics agree.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Start of the first window.
    pub since: usize,
    /// The last window.
    pub window: Range<usize>,
    /// The largest relative difference between orbit sizes of any two windows.
    pub differ: f64,
}

/// Batch means over the second half of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Batches {
    /// All batches together.
    pub window: Range<usize>,
    /// Half widths of the intervals of 95 % of orbit size and radius deviation of each node \[m\].
    pub half_widths: Vec<[f64; 2]>,
    /// True if the first and the last batches have the same means within their scatter.
    pub is_steady: bool,
    /// True if all intervals are as narrow as allowed.
    pub is_narrow: bool,
}

/// One statistic of a window.
#[derive(Debug, Clone, Copy)]
struct Statistic {
    value: f64,
    /// Relative difference that counts as none.
    allowed: f64,
    /// A smaller value counts as this large.
    smallest: f64,
}

impl Statistic {
    fn scale(&self) -> f64 {
        self.value.max(self.smallest)
    }
}

impl Course {
    /// An empty course of `nodes` nodes, with or without the bit's rate of twist, that begins `before` samples at `rate_hz` after the start
    /// and has capacity for `samples`.
    pub fn new(rate_hz: f64, before: usize, nodes: usize, has_bit: bool, samples: usize) -> Self {
        let series = || Vec::with_capacity(samples);
        Self {
            rate_hz,
            before,
            orbits: (0..nodes).map(|_| [series(), series()]).collect(),
            twist_rate: if has_bit { series() } else { Vec::new() },
        }
    }

    /// Reserves capacity for a total number of samples.
    pub fn reserve(&mut self, samples: usize) {
        let has_bit = !self.twist_rate.is_empty();
        let series = self.orbits.iter_mut().flatten().chain(has_bit.then_some(&mut self.twist_rate));
        series.for_each(|series| series.reserve_exact(samples.saturating_sub(series.len())));
    }

    /// Adds a sample: u and v \[m\] of each node, and the rate of twist at the bit \[rad/s\] if the course has it.
    pub fn push(&mut self, orbits: impl Iterator<Item = [f64; 2]>, twist_rate: Option<f64>) {
        for ([along_u, along_v], [u, v]) in self.orbits.iter_mut().zip(orbits) {
            along_u.push(u);
            along_v.push(v);
        }
        self.twist_rate.extend(twist_rate);
    }

    /// Samples of each series.
    pub fn samples(&self) -> usize {
        self.orbits.first().map_or(self.twist_rate.len(), |[u, _]| u.len())
    }

    /// Samples a second \[Hz\].
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Time of a sample \[s\].
    pub fn time(&self, sample: usize) -> f64 {
        (self.before + sample) as f64 / self.rate_hz
    }

    /// u and v of each node \[m\].
    pub fn orbits(&self) -> &[[Vec<f64>; 2]] {
        &self.orbits
    }

    /// Rate of twist at the bit \[rad/s\]; empty if the course has none.
    pub fn twist_rate(&self) -> &[f64] {
        &self.twist_rate
    }

    /// The three consecutive windows up to sample `end`, each half a window after the one before, whose statistics agree; absent if they
    /// do not. The shortest windows that agree are returned, and none with fewer than two beats of the closest pair of strong lines.
    pub fn agreement(&self, end: usize, allowed: &Allowed) -> Option<Agreement> {
        let two_beats = BEATS * self.slowest_beat(end);
        let long_enough = LENGTHS.iter().position(|length| *length >= two_beats).unwrap_or(LENGTHS.len() - 1);
        LENGTHS[long_enough..].iter().find_map(|seconds| {
            let half = self.count(0.5 * seconds);
            let since = end.checked_sub(4 * half)?;
            let windows = [0, 1, 2].map(|k| since + k * half..since + (k + 2) * half);
            let [first, second, last] =
                windows.clone().map(|window| self.statistics(window, Window::Hann, allowed));
            let agree = |a: &Statistic, b: &Statistic| {
                (a.value - b.value).abs() <= a.allowed * a.scale().max(b.scale())
            };
            let mut all = first.iter().zip(&second).zip(&last);
            let has_settled = all.all(|((a, b), c)| agree(a, b) && agree(b, c) && agree(a, c));
            let difference =
                |a: &Statistic, b: &Statistic| (a.value - b.value).abs() / a.scale().max(b.scale());
            let orbit_sizes = (0..2 * self.orbits.len()).step_by(2);
            let differ = orbit_sizes.fold(0.0, |most, place| {
                let (a, b, c) = (&first[place], &second[place], &last[place]);
                f64::max(most, difference(a, b).max(difference(b, c)).max(difference(a, c)))
            });
            has_settled.then(|| Agreement { since, window: windows[2].clone(), differ })
        })
    }

    /// Batch means over the second half of the course before sample `end`; absent if batches would be shorter than ten seconds.
    pub fn batches(&self, end: usize, allowed: &Allowed) -> Option<Batches> {
        let length = end / 2 / BATCHES;
        if length < self.count(SHORTEST_BATCH) {
            return None;
        }
        let window = end - BATCHES * length..end;
        let means = self.mean_squares(&window, length, allowed);
        let intervals: Vec<Interval> =
            means.iter().map(|(statistic, means)| Interval::of(statistic, means)).collect();
        let of_orbits = 2 * self.orbits.len();
        Some(Batches {
            window,
            half_widths: intervals[..of_orbits]
                .chunks(2)
                .map(|pair| [pair[0].half_width, pair[1].half_width])
                .collect(),
            is_steady: intervals.iter().all(|interval| interval.is_steady),
            is_narrow: intervals.iter().all(|interval| interval.is_narrow),
        })
    }

    /// Largest relative difference of orbit sizes and radius deviations between the halves of a window; absent if a half has fewer than
    /// two samples or no node is recorded.
    pub fn halves_differ(&self, window: &Range<usize>, allowed: &Allowed) -> Option<f64> {
        let [first, second] = halves(window)?;
        let statistics = |half| self.statistics(half, Window::Rectangular, allowed);
        let (first, second) = (statistics(first), statistics(second));
        let of_orbits = first.iter().zip(&second).take(2 * self.orbits.len());
        of_orbits.map(|(a, b)| (a.value - b.value).abs() / a.scale().max(b.scale())).reduce(f64::max)
    }

    /// Growth \[1/s\] of the bit's rotation at a frequency \[Hz\], from one window to another of the same length that begins `lag` seconds
    /// later; absent if the course has no bit, the windows are shorter than three periods, or nothing moves at that frequency.
    pub fn growth(&self, [from, to]: [Range<usize>; 2], frequency_hz: f64) -> Option<f64> {
        /// Periods of a window in which Hann's window separates the line from the mean.
        const PERIODS: f64 = 3.0;
        /// Largest relative difference between the frequencies of a large motion and of a small one.
        const SHIFT: f64 = 0.02;
        let lag = (to.start as f64 - from.start as f64) / self.rate_hz;
        if from.len() as f64 / self.rate_hz * frequency_hz < PERIODS || lag <= 0.0 {
            return None;
        }
        let amplitude = |window: Range<usize>| {
            let values = self.twist_rate.get(window)?;
            let spectrum = full_spectrum(values, &vec![0.0; values.len()], self.rate_hz, Window::Hann);
            let reach = APART * spectrum.resolution_hz + SHIFT * frequency_hz;
            let near = spectrum.restricted_to(&(frequency_hz - reach..=frequency_hz + reach));
            near.amplitude.into_iter().reduce(f64::max).filter(|amplitude| *amplitude > 0.0)
        };
        Some((amplitude(to)? / amplitude(from)?).ln() / lag)
    }

    /// The base frequencies of a window \[Hz\], ascending, two at most: its strongest line, and the strongest that is not among its
    /// multiples. Lines of forward and backward whirl count alike.
    pub fn base_frequencies(&self, window: &Range<usize>) -> Vec<f64> {
        let spectra = self.spectra(window);
        let Some(resolution) = spectra.first().map(|spectrum| spectrum.resolution_hz) else {
            return Vec::new();
        };
        let near = |a: f64, b: f64| (a - b).abs() < APART * resolution;
        // Lines of all nodes and the bit together, each relative to its own motion.
        let mut lines: Vec<(f64, f64)> = Vec::new();
        for spectrum in &spectra {
            let found = lines_of(spectrum);
            let power: f64 = found.iter().map(|line| line.1 * line.1).sum();
            for (frequency, amplitude) in found {
                let share = amplitude * amplitude / power;
                match lines.iter_mut().find(|line| near(line.0, frequency)) {
                    Some((mean, total)) => {
                        *mean += (frequency - *mean) * share / (*total + share);
                        *total += share;
                    }
                    None => lines.push((frequency, share)),
                }
            }
        }
        lines.sort_by(|a, b| b.1.total_cmp(&a.1));
        let Some(&(strongest, most)) = lines.first() else { return Vec::new() };
        let multiples = 1..=LARGEST_MULTIPLE;
        let strong = lines.iter().filter(|line| line.1 >= BASE_POWER * most);
        let other = strong
            .map(|line| line.0)
            .find(|&f| !multiples.clone().any(|k| near(f, f64::from(k) * strongest)));
        let mut base = vec![strongest];
        if let Some(other) = other {
            // The strongest may be a harmonic.
            if multiples.clone().any(|k| near(strongest, f64::from(k) * other)) {
                base[0] = other;
            } else {
                base.push(other);
            }
        }
        base.sort_by(f64::total_cmp);
        base
    }

    /// Time of a beat of the closest pair of strong lines before sample `end` \[s\]; 0 without such a pair.
    fn slowest_beat(&self, end: usize) -> f64 {
        let window = end.saturating_sub(self.count(LINES_OF))..end;
        let beat_of = |spectrum: &FullSpectrum| {
            let mut lines = lines_of(spectrum);
            let strongest = lines.iter().fold(0.0, |most: f64, line| most.max(line.1));
            lines.retain(|line| line.1 >= STRONG * strongest);
            lines.sort_by(|a, b| a.0.total_cmp(&b.0));
            let distances = lines.windows(2).map(|pair| pair[1].0 - pair[0].0);
            let apart = distances.filter(|distance| *distance >= APART * spectrum.resolution_hz);
            apart.map(|distance| 1.0 / distance).fold(0.0, f64::max)
        };
        self.spectra(&window).iter().map(beat_of).fold(0.0, f64::max)
    }

    /// Hann-weighted spectra of all nodes' motion and of the bit's rate of twist.
    fn spectra(&self, window: &Range<usize>) -> Vec<FullSpectrum> {
        let spectrum = |u: &[f64], v: &[f64]| full_spectrum(u, v, self.rate_hz, Window::Hann);
        let orbits = self.orbits.iter().map(|[u, v]| spectrum(&u[window.clone()], &v[window.clone()]));
        let of_bit = self.twist_rate.get(window.clone()).filter(|rate| !rate.is_empty());
        orbits.chain(of_bit.map(|rate| spectrum(rate, &vec![0.0; rate.len()]))).collect()
    }

    /// Statistics of a window: orbit size and radius deviation of each node in turn, then the deviation of the bit's rotation.
    fn statistics(&self, window: Range<usize>, weighting: Window, allowed: &Allowed) -> Vec<Statistic> {
        let count = window.len();
        let total = weighting.sum(count);
        let weights: Vec<f64> = (0..count).map(|n| weighting.weight(n, count) / total).collect();
        let squares = |values: &[f64]| {
            let mean: f64 = values.iter().zip(&weights).map(|(value, weight)| weight * value).sum();
            values.iter().zip(&weights).map(|(value, weight)| weight * (value - mean).powi(2)).sum::<f64>()
        };
        self.mean_square_of(&window, |values| squares(values))
            .into_iter()
            .enumerate()
            .map(|(place, square)| self.statistic(place, square, allowed))
            .collect()
    }

    /// Mean squares about the window's mean by batch, of the same statistics, with the statistic of the whole.
    fn mean_squares(
        &self,
        window: &Range<usize>,
        length: usize,
        allowed: &Allowed,
    ) -> Vec<(Statistic, Vec<f64>)> {
        let by_batch = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let square = |batch: &[f64]| {
                batch.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / batch.len() as f64
            };
            Squares(values.chunks(length).map(square).collect())
        };
        let squares = self.mean_square_of(window, by_batch);
        squares
            .into_iter()
            .enumerate()
            .map(|(place, Squares(by_batch))| {
                let whole = by_batch.iter().sum::<f64>() / by_batch.len() as f64;
                (self.statistic(place, whole, allowed), by_batch)
            })
            .collect()
    }

    /// Values of `of` for the series of each statistic: the sum over u and v, the radius, the bit's rate of twist.
    fn mean_square_of<T: std::ops::Add<Output = T>>(
        &self,
        window: &Range<usize>,
        of: impl Fn(&[f64]) -> T,
    ) -> Vec<T> {
        let mut found = Vec::with_capacity(2 * self.orbits.len() + 1);
        for [u, v] in &self.orbits {
            let (u, v) = (&u[window.clone()], &v[window.clone()]);
            let radius: Vec<f64> = u.iter().zip(v).map(|(u, v)| u.hypot(*v)).collect();
            found.push(of(u) + of(v));
            found.push(of(&radius));
        }
        if let Some(rate) = self.twist_rate.get(window.clone()).filter(|rate| !rate.is_empty()) {
            found.push(of(rate));
        }
        found
    }

    fn statistic(&self, place: usize, square: f64, allowed: &Allowed) -> Statistic {
        let (allowed, smallest) = match place {
            place if place == 2 * self.orbits.len() => (allowed.orbit_size, allowed.smallest_rotation),
            place if place.is_multiple_of(2) => (allowed.orbit_size, allowed.smallest_orbit),
            _ => (allowed.radius_deviation, allowed.smallest_orbit),
        };
        Statistic { value: square.sqrt(), allowed, smallest }
    }

    /// Samples in a time \[s\].
    fn count(&self, seconds: f64) -> usize {
        (seconds * self.rate_hz).round() as usize
    }
}

/// Mean squares of batches, which add up batch by batch.
struct Squares(Vec<f64>);

impl std::ops::Add for Squares {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(a, b)| a + b).collect())
    }
}

/// Confidence interval of the root of a mean, from the means of batches.
struct Interval {
    half_width: f64,
    is_steady: bool,
    is_narrow: bool,
}

impl Interval {
    fn of(statistic: &Statistic, squares: &[f64]) -> Self {
        let count = squares.len() as f64;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let centre = mean(squares);
        let about =
            |part: &[f64], centre: f64| part.iter().map(|square| (square - centre).powi(2)).sum::<f64>();
        let of_square = STUDENT * (about(squares, centre) / (count - 1.0) / count).sqrt();
        // A root's error is that of its square over twice the root.
        let half_width = if statistic.value > 0.0 { 0.5 * of_square / statistic.value } else { 0.0 };
        let (first, last) = squares.split_at(squares.len() / 2);
        let [first_mean, last_mean] = [mean(first), mean(last)];
        let pooled = (about(first, first_mean) + about(last, last_mean)) / (count - 2.0);
        let is_trend = (first_mean - last_mean).abs() > STEADY * (pooled * 4.0 / count).sqrt();
        // Motion below the smallest that counts has no meaningful trend, and neither has one that rounding alone causes.
        let counts = statistic.value > statistic.smallest
            && (first_mean - last_mean).abs() > statistic.allowed * statistic.value.powi(2);
        Self {
            half_width,
            is_steady: !(is_trend && counts),
            is_narrow: half_width <= statistic.allowed * statistic.scale(),
        }
    }
}

/// The two halves of a window; absent if they have fewer than two samples.
pub fn halves(window: &Range<usize>) -> Option<[Range<usize>; 2]> {
    let half = window.len() / 2;
    (half >= 2).then(|| [window.start..window.start + half, window.end - half..window.end])
}

/// The highest lines of a spectrum but for the mean: frequency \[Hz\] without the sense of whirl, and amplitude.
fn lines_of(spectrum: &FullSpectrum) -> Vec<(f64, f64)> {
    const LINES: usize = 16;
    let search = PeakSearch { count: LINES, min_separation_hz: 0.0, exclude_mean: true };
    // Hann's window spreads the mean over the bins next to it.
    let beyond_mean = 2.0 * spectrum.resolution_hz;
    let peaks = spectrum.peaks(&search).into_iter().map(|peak| (peak.frequency_hz.abs(), peak.amplitude));
    peaks.filter(|peak| peak.0 >= beyond_mean).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const RATE: f64 = 50.0;

    const ALLOWED: Allowed =
        Allowed { orbit_size: 0.01, radius_deviation: 0.025, smallest_orbit: 1e-5, smallest_rotation: 1e-2 };

    /// A course of one node and the bit over a number of seconds.
    fn course(seconds: f64, orbit: impl Fn(f64) -> [f64; 2], twist_rate: impl Fn(f64) -> f64) -> Course {
        let samples = (seconds * RATE) as usize;
        let mut course = Course::new(RATE, 0, 1, true, samples);
        for sample in 0..samples {
            let time = sample as f64 / RATE;
            course.push(std::iter::once(orbit(time)), Some(twist_rate(time)));
        }
        course
    }

    /// The first end of a block of ten seconds at which windows agree.
    fn settles(course: &Course, allowed: &Allowed) -> Option<(usize, Agreement)> {
        (1..=course.samples() / 500)
            .find_map(|block| Some((500 * block, course.agreement(500 * block, allowed)?)))
    }

    /// Circles of 1 and 0.4 mm about a place near the wall, whose frequencies beat in 6.25 s.
    fn beating(time: f64) -> [f64; 2] {
        let (a, b) = (TAU * 2.0 * time, TAU * 2.16 * time + 1.0);
        [0.03 + 1e-3 * a.cos() + 4e-4 * b.cos(), 1e-3 * a.sin() - 4e-4 * b.sin()]
    }

    #[test]
    fn beating_lines_settle_at_once_to_their_own_statistics() {
        let course = course(60.0, beating, |time| 2.0 + 0.5 * (TAU * 2.16 * time).sin());
        let (end, found) = settles(&course, &ALLOWED).unwrap();
        assert_eq!((end, found.since, found.window.clone()), (2000, 0, 1000..2000));
        assert!(found.differ < 1e-4, "{found:?}");
        let statistics = course.statistics(1000..2000, Window::Hann, &ALLOWED);
        let size = 1e-3_f64.hypot(4e-4);
        assert!((statistics[0].value / size - 1.0).abs() < 1e-4, "{statistics:?}");
        // r = 0.03 + (motion along the offset) + O(size^2 / 0.03): half of each circle's mean square.
        assert!((statistics[1].value / (size / 2.0_f64.sqrt()) - 1.0).abs() < size / 0.03, "{statistics:?}");
        assert!((statistics[2].value / (0.5 / 2.0_f64.sqrt()) - 1.0).abs() < 1e-4, "{statistics:?}");
        let base = course.base_frequencies(&(0..2000));
        assert!((base[0] - 2.0).abs() < 1e-3 && (base[1] - 2.16).abs() < 1e-3 && base.len() == 2, "{base:?}");
        assert_eq!(course.growth([0..1000, 1000..2000], 2.16).map(|growth| growth.abs() < 1e-4), Some(true));
    }

    #[test]
    fn slow_beats_take_longer_windows() {
        // A beat of 12 s: two of them take a window of 40 s, and the three windows 80 s.
        let course = course(
            160.0,
            |time| {
                let (a, b) = (TAU * 2.0 * time, TAU * (2.0 + 1.0 / 12.0) * time);
                [1e-3 * a.cos() + 8e-4 * b.cos(), 1e-3 * a.sin() + 8e-4 * b.sin()]
            },
            |_| 0.0,
        );
        let (end, found) = settles(&course, &ALLOWED).unwrap();
        assert_eq!((end, found.window.len()), (4000, 2000));
        let size = course.statistics(found.window, Window::Hann, &ALLOWED)[0].value;
        assert!((size / 1e-3_f64.hypot(8e-4) - 1.0).abs() < 5e-3, "{size}");
    }

    #[test]
    fn growth_and_drift_never_settle() {
        let growing = course(
            300.0,
            |time| {
                let [u, v] = beating(time);
                let factor = 0.1 * (0.008 * time).exp();
                [0.03 + factor * (u - 0.03), factor * v]
            },
            |_| 0.0,
        );
        // Ten seconds hold whole turns: nothing but the drift moves the batches.
        let drifting = course(
            300.0,
            |time| [1e-3 * (TAU * 2.0 * time).cos(), 1e-3 * (1.0 + 0.01 * time) * (TAU * 2.0 * time).sin()],
            |_| 0.0,
        );
        let swinging = course(300.0, beating, |time| 3.0 * (0.01 * time).exp() * (TAU * 0.3 * time).sin());
        for course in [&growing, &drifting, &swinging] {
            assert_eq!(settles(course, &ALLOWED), None);
            for end in (8000..=15_000).step_by(500) {
                assert!(!course.batches(end, &ALLOWED).unwrap().is_steady, "{end}");
            }
        }
        let rate = swinging.growth([5000..6000, 6000..7000], 0.3).unwrap();
        assert!((rate - 0.01).abs() < 1e-4, "{rate}");
        assert_eq!(swinging.growth([0..400, 400..800], 0.3), None, "fewer than three periods");
    }

    #[test]
    fn motion_below_the_smallest_does_not_keep_a_run_from_settling() {
        let dying =
            course(60.0, |time| [0.03 + 1e-8 * (-0.2 * time).exp() * (TAU * time).sin(), 0.0], |_| 0.0);
        assert_eq!(settles(&dying, &ALLOWED).unwrap().0, 2000);
        assert_eq!(dying.halves_differ(&(0..2000), &ALLOWED).map(|differ| differ < 1e-3), Some(true));
    }

    #[test]
    fn halves_differ_by_the_imposed_change() {
        let size = |time: f64| if time < 10.0 { 1e-3 } else { 2e-3 };
        let stepping =
            course(20.0, |time| [size(time) * (TAU * time).cos(), size(time) * (TAU * time).sin()], |_| 0.0);
        let differ = stepping.halves_differ(&(0..1000), &ALLOWED).unwrap();
        assert!((differ - 0.5).abs() < 1e-12, "{differ}");
        assert_eq!(stepping.halves_differ(&(0..3), &ALLOWED), None);
    }

    /// First-order autoregressive noise in u and v with a correlation time of half a second: the square of its orbit size is twice its
    /// variance. Of 300 runs an interval of 95 % misses 15 +- 3.8.
    #[test]
    fn batches_cover_the_size_of_irregular_motion_nineteen_times_in_twenty() {
        let mut state = 7_u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let mut normal = move || (-2.0 * uniform().ln()).sqrt() * (TAU * uniform()).cos();
        let keep: f64 = (-1.0 / (0.5 * RATE)).exp();
        let kick = (1.0 - keep * keep).sqrt();
        let (mut covered, mut steady) = (0, 0);
        const RUNS: u32 = 300;
        for _ in 0..RUNS {
            let mut course = Course::new(RATE, 0, 1, false, 8000);
            let mut at = [normal(), normal()];
            for _ in 0..8000 {
                at = at.map(|x| keep * x + kick * normal());
                course.push(std::iter::once(at), None);
            }
            let batches = course.batches(8000, &ALLOWED).unwrap();
            assert_eq!(batches.window, 4000..8000);
            let size = course.statistics(batches.window, Window::Rectangular, &ALLOWED)[0].value;
            covered += u32::from((size - 2.0_f64.sqrt()).abs() <= batches.half_widths[0][0]);
            steady += u32::from(batches.is_steady);
            assert!(!batches.is_narrow, "one per cent takes a hundred times as long");
        }
        assert!((270..=298).contains(&covered), "{covered} of {RUNS}");
        assert!(steady >= 276, "{steady} of {RUNS} are steady");
        assert!(
            Course::new(RATE, 0, 1, false, 0).batches(7999, &ALLOWED).is_none(),
            "batches are of ten seconds"
        );
    }
}
