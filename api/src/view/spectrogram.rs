//! The spectrogram of one node's orbit: its full spectrum over windows that follow each other in time.

use drillsweep_quantity::columns;
use drillsweep_sim::math::signal::full_spectrum;
use drillsweep_table::{Column, Table};
use serde_json::json;

use super::orbit::Motion;
use super::spectrum::{FullSpectrum, Weighting};
use crate::problem::ProblemDetails;

/// Amplitudes of a spectrogram at most.
pub const MOST_AMPLITUDES: usize = 1_000_000;

/// Samples that all windows together may transform.
const MOST_TRANSFORMED: usize = 1 << 25;

/// Samples of a window at least.
const FEWEST_SAMPLES: usize = 8;

/// Default length of a window \[s\], except in a short history: a resolution of a quarter of a hertz.
const USUAL_WINDOW: f64 = 4.0;

/// Windows from the beginning to the end of a history, if no step is requested, at most.
const USUAL_WINDOWS: f64 = 200.0;

/// Relative error of a frequency by rounding.
const ROUNDING: f64 = 1e-9;

/// Request for a spectrogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrogramRequest {
    /// Weighting of the samples in each window.
    pub weighting: Weighting,
    /// Length of a window \[s\]; absent means 4 s, and a quarter of the history if that is shorter.
    pub window: Option<f64>,
    /// From the beginning of a window to that of the next \[s\]; absent means an eighth of a window, and more if that would be over 200
    /// windows.
    pub step: Option<f64>,
    /// Frequencies from minus to plus this \[Hz\].
    pub range: f64,
}

/// The full spectra of all windows that lie in a motion as a whole: columns `time` \[s\], the middle of the window, `frequency` \[Hz\] and
/// `amplitude` \[m\]; window after window, in each ascending in frequency. Positive frequencies are forward whirl. Attributes:
/// `windows`, the number of them, `samples` of each, `window_s` and `step_s` as taken, `resolution` \[Hz\], and `window`, the weighting.
///
/// # Errors
/// A window holds too few samples or is longer than the motion, or the spectrogram would be too large; of the query's parameters.
pub fn spectrogram(motion: &Motion<'_>, request: &SpectrogramRequest) -> Result<Table, Box<ProblemDetails>> {
    let cut = Cut::new(motion, request)?;
    // A frequency at its end belongs to the range whatever the rounding of the recording times.
    let range = request.range * (1.0 + ROUNDING);
    let mut rows = [Vec::new(), Vec::new(), Vec::new()];
    let mut resolution = 0.0;
    for first in cut.starts() {
        let samples = first..first + cut.samples;
        let whole =
            full_spectrum(&motion.u[samples.clone()], &motion.v[samples], cut.rate, request.weighting);
        let FullSpectrum { resolution_hz, frequency_hz, amplitude, .. } =
            whole.restricted_to(&(-range..=range));
        resolution = resolution_hz;
        let middle = motion.time[first] + 0.5 * cut.samples as f64 / cut.rate;
        rows[0].extend(std::iter::repeat_n(middle, frequency_hz.len()));
        rows[1].extend(frequency_hz);
        rows[2].extend(amplitude);
    }
    let [time, frequency, amplitude] = rows.map(Column::Number);
    Ok(Table::default()
        .with(&columns::TIME, time)
        .with(&columns::FREQUENCY, frequency)
        .with(&columns::AMPLITUDE, amplitude)
        .attribute("windows", cut.starts().len())
        .attribute("samples", cut.samples)
        .attribute("window_s", cut.samples as f64 / cut.rate)
        .attribute("step_s", cut.step as f64 / cut.rate)
        .attribute("resolution", resolution)
        .attribute("window", json!(request.weighting)))
}

/// Windows of a motion.
struct Cut {
    /// Samples per second \[Hz\].
    rate: f64,
    /// Samples of the motion.
    all: usize,
    /// Samples of a window.
    samples: usize,
    /// Samples from the beginning of a window to that of the next.
    step: usize,
}

impl Cut {
    fn new(motion: &Motion<'_>, request: &SpectrogramRequest) -> Result<Self, Box<ProblemDetails>> {
        let refused = |name: &str, got: Option<f64>, detail: String| {
            let got = got.map(|got| got.to_string());
            Err(Box::new(ProblemDetails::invalid_parameter(name, got.as_deref(), detail)))
        };
        let all = motion.time.len();
        let (Some(first), Some(last)) = (motion.time.first(), motion.time.last()) else {
            return refused("from", None, "the history has no samples from then on".to_owned());
        };
        if all < FEWEST_SAMPLES {
            let detail = format!("there are {all} samples; a window needs {FEWEST_SAMPLES} or more");
            return refused("from", None, detail);
        }
        let rate = (all - 1) as f64 / (last - first);
        let span = all as f64 / rate;
        let shortest = FEWEST_SAMPLES as f64 / rate;
        let window = request.window.unwrap_or_else(|| USUAL_WINDOW.min(0.25 * span).max(shortest));
        let samples = (window * rate).round() as usize;
        if !(FEWEST_SAMPLES..=all).contains(&samples) {
            let detail = format!("must be {shortest} s, {FEWEST_SAMPLES} samples, to {span} s, all of them");
            return refused("window_s", request.window, detail);
        }
        let step = request.step.unwrap_or_else(|| (0.125 * window).max(span / USUAL_WINDOWS));
        let cut = Self { rate, all, samples, step: (step * rate).round().max(1.0) as usize };
        let windows = cut.starts().len();
        let bins = (2.0 * request.range.min(0.5 * rate) / rate * samples as f64) as usize + 1;
        let amplitudes = windows.saturating_mul(bins.min(samples));
        if amplitudes > MOST_AMPLITUDES {
            let detail = format!(
                "{windows} windows of {} frequencies would be {amplitudes} amplitudes, and a spectrogram has at most {MOST_AMPLITUDES}: \
                 give a longer step, a shorter window or a smaller range_hz",
                bins.min(samples)
            );
            return refused("step_s", request.step, detail);
        }
        if windows.saturating_mul(samples) > MOST_TRANSFORMED {
            let detail = format!(
                "{windows} windows of {samples} samples are more than {MOST_TRANSFORMED} samples to transform: give a longer step or a \
                 shorter window"
            );
            return refused("step_s", request.step, detail);
        }
        Ok(cut)
    }

    /// The first sample of each window.
    fn starts(&self) -> impl ExactSizeIterator<Item = usize> {
        (0..self.all - self.samples + 1).step_by(self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RATE: f64 = 200.0;

    /// 20 s at 200 Hz about (2, 1) mm: a forward circle of 3 mm at 2 Hz, after 10 s a backward one of 1 mm at 5 Hz in its place.
    fn motion() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..4000).map(|i| f64::from(i) / RATE).collect();
        let of = |t: f64| if t < 10.0 { (3e-3, 2.0 * TAU * t) } else { (1e-3, -5.0 * TAU * t) };
        let u = time.iter().map(|t| 2e-3 + of(*t).0 * of(*t).1.cos()).collect();
        let v = time.iter().map(|t| 1e-3 + of(*t).0 * of(*t).1.sin()).collect();
        (time, u, v)
    }

    fn request(window: Option<f64>, step: Option<f64>, range: f64) -> SpectrogramRequest {
        SpectrogramRequest { weighting: Weighting::Rectangular, window, step, range }
    }

    fn numbers<'a>(table: &'a Table, name: &str) -> &'a [f64] {
        match &table.columns[name] {
            Column::Number(values) => values,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn whirl_has_a_line_at_its_time_and_signed_frequency() {
        let (time, u, v) = motion();
        let motion = Motion { time: &time, u: &u, v: &v };
        let table = spectrogram(&motion, &request(Some(2.0), Some(1.0), 10.0)).unwrap();
        // Windows from 0, 1, ... 18 s on; every half hertz from -10 to 10 Hz.
        assert_eq!((table.attributes["windows"].as_u64(), table.rows()), (Some(19), 19 * 41));
        let attribute = |name: &str| table.attributes[name].as_f64().unwrap();
        assert!((attribute("step_s") - 1.0).abs() < 1e-9 && (attribute("resolution") - 0.5).abs() < 1e-9);
        let [times, frequencies, amplitudes] =
            ["time", "frequency", "amplitude"].map(|name| numbers(&table, name));
        for row in 0..table.rows() {
            let (time, half_hertz) = (times[row], (2.0 * frequencies[row]).round());
            assert!((0.5 * half_hertz - frequencies[row]).abs() < 1e-9);
            let expected = match half_hertz as i32 {
                // Both in one window.
                _ if time > 9.5 && time < 10.5 => continue,
                0 => 5e-6_f64.sqrt(),
                4 if time < 10.0 => 3e-3,
                -10 if time > 10.0 => 1e-3,
                _ => 0.0,
            };
            // All lines fall on bins.
            assert!((amplitudes[row] - expected).abs() < 1e-12, "{} s, {} Hz", times[row], frequencies[row]);
        }
        assert!((times[0] - 1.0).abs() < 1e-9 && (times[41] - 2.0).abs() < 1e-9);
    }

    #[test]
    fn windows_and_steps_follow_the_history_unless_given() {
        let (time, u, v) = motion();
        let motion = Motion { time: &time, u: &u, v: &v };
        for (to, window, step) in [(20.0, 4.0, 0.5), (4.0, 1.0, 0.125)] {
            let table = spectrogram(&motion.window(None, Some(to)), &request(None, None, 20.0)).unwrap();
            for (name, expected) in [("window_s", window), ("step_s", step)] {
                assert!(
                    (table.attributes[name].as_f64().unwrap() - expected).abs() < 1e-9,
                    "{name} of {to} s"
                );
            }
        }
    }

    #[test]
    fn too_short_or_too_large_a_window_is_refused_at_its_parameter() {
        let (time, u, v) = motion();
        let motion = Motion { time: &time, u: &u, v: &v };
        let refused = |motion: &Motion<'_>, request| {
            let problem = spectrogram(motion, &request).unwrap_err();
            assert_eq!(problem.status, 400);
            problem.errors[0].parameter.clone().unwrap()
        };
        for window in [0.03, 20.5] {
            assert_eq!(refused(&motion, request(Some(window), None, 20.0)), "window_s");
        }
        // 3201 windows of 801 frequencies; 2001 windows of 2000 samples, but few frequencies.
        assert_eq!(refused(&motion, request(Some(4.0), Some(0.001), 100.0)), "step_s");
        assert_eq!(refused(&motion.window(Some(19.97), None), request(None, None, 20.0)), "from");
        assert_eq!(refused(&motion.window(Some(30.0), None), request(None, None, 20.0)), "from");
        let time: Vec<f64> = (0..60_000).map(|i| f64::from(i) * 1e-3).collect();
        let still = vec![0.0; time.len()];
        let long = Motion { time: &time, u: &still, v: &still };
        assert_eq!(refused(&long, request(Some(20.0), Some(0.001), 0.05)), "step_s");
    }
}
