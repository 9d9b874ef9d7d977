//! Rules of windows of time.

use drillsweep_scenario::{FEWEST_SAMPLES, Scenario, TimeWindow};

use super::report::Report;

/// Relative difference below which two times are the same.
const SAME_TIME: f64 = 1e-9;

pub(super) fn check_window(report: &mut Report, scenario: &Scenario, window: &TimeWindow, path: &str) {
    let (duration, rate) = (scenario.duration, scenario.recording.rate_hz);
    report.not_negative(window.from, format!("{path}.from"));
    if duration > 0.0 && duration.is_finite() {
        report.number(
            window.to,
            format!("{path}.to"),
            |to| to <= duration * (1.0 + SAME_TIME),
            format!("must be within the run of {duration} s"),
        );
    }
    let length = window.to - window.from;
    if !length.is_finite() {
        return;
    }
    let got = format!("{} to {} s", window.from, window.to);
    if length <= 0.0 {
        report.require(false, path, got, "must end after it begins");
    } else if rate > 0.0 && rate.is_finite() {
        report.require(
            length * rate >= FEWEST_SAMPLES * (1.0 - SAME_TIME),
            path,
            got,
            format!("must hold at least {FEWEST_SAMPLES} samples, {} s", FEWEST_SAMPLES / rate),
        );
    }
}

/// Checks that a ratio of times is a whole number.
pub(super) fn is_whole(ratio: f64) -> bool {
    ratio.round() >= 1.0 && (ratio - ratio.round()).abs() <= SAME_TIME * ratio
}
