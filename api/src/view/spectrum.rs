//! The full spectrum of one node's orbit.

use drillsweep_quantity::columns;
use drillsweep_sim::math::signal::{PeakSearch, full_spectrum};
use drillsweep_table::{Column, Table};
use serde_json::{Value, json};

use super::orbit::Motion;
use crate::problem::{FieldProblem, ProblemDetails, ProblemKind};

pub use drillsweep_sim::math::signal::{FullSpectrum, Window as Weighting};

/// Two lines closer than this many bins are one: the rest is its leakage.
const LINE_WIDTH_BINS: f64 = 2.0;

/// The full spectrum of all samples of a motion, within plus and minus `range` \[Hz\]: columns `frequency`
/// \[Hz\], `amplitude` and `peak_to_peak` \[m\], ascending in frequency. Positive frequencies are forward
/// whirl. Attributes: `samples`, `resolution` \[Hz\], `window`, and `peaks`, the `peaks` highest lines in the
/// range, highest first, each with `frequency`, `amplitude` and `peak_to_peak`, all interpolated between the bins,
/// and `whirl`.
///
/// # Errors
/// There are too few samples to have a rate.
pub fn spectrum(
    motion: &Motion<'_>,
    weighting: Weighting,
    range: f64,
    peaks: usize,
) -> Result<Table, Box<ProblemDetails>> {
    let (Some(first), Some(last)) = (motion.time.first(), motion.time.last()) else {
        return Err(too_few(motion).into());
    };
    let intervals = motion.time.len() - 1;
    if intervals == 0 {
        return Err(too_few(motion).into());
    }
    let rate = intervals as f64 / (last - first);
    Ok(part(&full_spectrum(motion.u, motion.v, rate, weighting), range, peaks))
}

/// A half-open window of time \[from, to) whose spectrum was kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptWindow {
    /// Start \[s\].
    pub from: f64,
    /// End \[s\].
    pub to: f64,
}

impl KeptWindow {
    /// The requested one of `kept`; an end may be left out if the other identifies it.
    ///
    /// # Errors
    /// A problem that lists the kept windows, if the requested one is not among them.
    pub fn choose(
        kept: &[KeptWindow],
        from: Option<f64>,
        to: Option<f64>,
    ) -> Result<KeptWindow, Box<ProblemDetails>> {
        let is_asked_for = |window: &&KeptWindow| {
            from.is_none_or(|from| from == window.from) && to.is_none_or(|to| to == window.to)
        };
        let mut found = kept.iter().filter(is_asked_for);
        if let (Some(window), None) = (found.next(), found.next()) {
            return Ok(*window);
        }
        let windows: Vec<_> =
            kept.iter().map(|window| format!("{} to {} s", window.from, window.to)).collect();
        let detail = format!(
            "the run kept no histories, but spectra over the windows {}: `from` and `to` must be those of one of them",
            windows.join(", ")
        );
        let (parameter, got) = match (from, to) {
            (None, Some(to)) => ("to", Some(to.into())),
            (from, _) => ("from", from.map(Into::into)),
        };
        let error = FieldProblem {
            pointer: None,
            parameter: Some(parameter.to_owned()),
            got,
            detail: detail.clone(),
        };
        let problem = ProblemDetails::new(ProblemKind::WindowNotKept, detail);
        Err(Box::new(ProblemDetails { errors: vec![error], ..problem }))
    }
}

/// The part of a spectrum within plus and minus `range` \[Hz\] with its highest lines, as [`spectrum`] gives it; of one that was
/// kept in place of the motion.
pub fn part(whole: &FullSpectrum, range: f64, peaks: usize) -> Table {
    let samples = whole.frequency_hz.len();
    let spectrum = whole.restricted_to(&(-range..=range));
    let min_separation_hz = LINE_WIDTH_BINS * spectrum.resolution_hz;
    let lines = spectrum.peaks(&PeakSearch { count: peaks, min_separation_hz, exclude_mean: false });
    let lines: Vec<_> = lines
        .iter()
        .map(|line| {
            json!({
                "frequency": line.frequency_hz,
                "amplitude": line.amplitude,
                "peak_to_peak": 2.0 * line.amplitude,
                "whirl": line.whirl,
            })
        })
        .collect();
    let peak_to_peak = spectrum.peak_to_peak();
    Table::default()
        .with(&columns::FREQUENCY, Column::Number(spectrum.frequency_hz))
        .with(&columns::AMPLITUDE, Column::Number(spectrum.amplitude))
        .with(&columns::PEAK_TO_PEAK, Column::Number(peak_to_peak))
        .attribute("samples", samples)
        .attribute("resolution", spectrum.resolution_hz)
        .attribute("window", json!(spectrum.window))
        .attribute("peaks", lines)
}

/// Says in a table of [`part`] up to which frequency \[Hz\] the run's steps resolve vibrations: the attribute `resolved_hz`, and of each of the
/// `peaks` whether it `is_resolved`. Unchanged if that is not known.
#[must_use]
pub fn mark_resolved(mut table: Table, resolved_hz: Option<f64>) -> Table {
    let Some(resolved_hz) = resolved_hz else { return table };
    if let Some(Value::Array(peaks)) = table.attributes.get_mut("peaks") {
        for peak in peaks {
            let frequency = peak["frequency"].as_f64().unwrap_or(0.0);
            peak["is_resolved"] = json!(frequency.abs() <= resolved_hz);
        }
    }
    table.attribute("resolved_hz", resolved_hz)
}

fn too_few(motion: &Motion<'_>) -> ProblemDetails {
    let detail = format!("the window holds {} samples; a spectrum needs 2 or more", motion.time.len());
    ProblemDetails::invalid_parameter("from", None, detail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// 10 s at 1 kHz of a forward circle (2 Hz, 3 mm), a backward one (5 Hz, 1 mm) and an offset of (4, 3) mm.
    fn motion() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..10_000).map(|i| f64::from(i) * 1e-3).collect();
        let u = time.iter().map(|t| 4e-3 + 3e-3 * (2.0 * TAU * t).cos() + 1e-3 * (5.0 * TAU * t).cos());
        let v = time.iter().map(|t| 3e-3 + 3e-3 * (2.0 * TAU * t).sin() - 1e-3 * (5.0 * TAU * t).sin());
        (time.clone(), u.collect(), v.collect())
    }

    #[test]
    fn unresolved_frequencies_are_marked_on_both_sides() {
        let (time, u, v) = motion();
        let motion = Motion { time: &time, u: &u, v: &v };
        let table = spectrum(&motion, Weighting::Rectangular, 20.0, 3).unwrap();
        let resolved = |table: &Table| -> Vec<(f64, Option<bool>)> {
            let peaks = table.attributes["peaks"].as_array().unwrap();
            let one =
                |peak: &Value| (peak["frequency"].as_f64().unwrap().round(), peak["is_resolved"].as_bool());
            peaks.iter().map(one).collect()
        };
        let marked = mark_resolved(table.clone(), Some(4.0));
        assert_eq!(marked.attributes["resolved_hz"], 4.0);
        assert_eq!(resolved(&marked), [(0.0, Some(true)), (2.0, Some(true)), (-5.0, Some(false))]);
        let unknown = mark_resolved(table, None);
        assert!(!unknown.attributes.contains_key("resolved_hz"));
        assert_eq!(resolved(&unknown)[2], (-5.0, None));
    }

    #[test]
    fn whirl_has_a_line_at_its_signed_frequency() {
        let (time, u, v) = motion();
        let motion = Motion { time: &time, u: &u, v: &v };
        let table = spectrum(&motion, Weighting::Rectangular, 20.0, 3).unwrap();
        assert_eq!(table.rows(), 401, "every 0.1 Hz from -20 to 20 Hz");
        let peaks = table.attributes["peaks"].as_array().unwrap();
        let expected = [("offset", 0.0, 5e-3), ("forward", 2.0, 3e-3), ("backward", -5.0, 1e-3)];
        assert_eq!(peaks.len(), expected.len());
        for (peak, (whirl, frequency, amplitude)) in peaks.iter().zip(expected) {
            assert_eq!(peak["whirl"], whirl);
            // All lines fall on bins, so that the rest is rounding.
            assert!((peak["frequency"].as_f64().unwrap() - frequency).abs() < 1e-9, "{peak}");
            assert!((peak["amplitude"].as_f64().unwrap() - amplitude).abs() < 1e-12, "{peak}");
            assert!((peak["peak_to_peak"].as_f64().unwrap() - 2.0 * amplitude).abs() < 1e-12, "{peak}");
        }
    }

    #[test]
    fn kept_windows_are_selected_by_their_ends() {
        let window = |from, to| KeptWindow { from, to };
        let kept = [window(5.0, 15.0), window(50.0, 60.0)];
        assert_eq!(KeptWindow::choose(&kept, Some(50.0), Some(60.0)).unwrap(), kept[1]);
        assert_eq!(KeptWindow::choose(&kept, None, Some(15.0)).unwrap(), kept[0]);
        assert_eq!(KeptWindow::choose(&kept[..1], None, None).unwrap(), kept[0]);
        for (from, to, parameter) in
            [(None, None, "from"), (Some(5.0), Some(60.0), "from"), (None, Some(61.0), "to")]
        {
            let problem = KeptWindow::choose(&kept, from, to).unwrap_err();
            assert_eq!(problem.status, 422);
            assert_eq!(problem.errors[0].parameter.as_deref(), Some(parameter));
            assert!(problem.detail.contains("5 to 15 s, 50 to 60 s"), "{problem}");
        }
    }

    #[test]
    fn a_window_without_samples_is_refused() {
        let (time, u, v) = motion();
        let empty = Motion { time: &time, u: &u, v: &v }.window(Some(20.0), None);
        assert_eq!(spectrum(&empty, Weighting::Hann, 20.0, 3).unwrap_err().status, 400);
    }
}
