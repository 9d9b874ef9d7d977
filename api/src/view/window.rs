//! The part of a history that is looked at.

use std::ops::Range;

/// The samples of a half-open window \[from, to) of simulated time; an absent end is open.
///
/// `time` increases. Recording times are multiples of the sampling interval formed in floating point, so a
/// sample within a hundredth of an interval of an end counts as lying on it.
pub fn samples(time: &[f64], from: Option<f64>, to: Option<f64>) -> Range<usize> {
    let slack = match time {
        [first, second, ..] => 1e-2 * (second - first),
        _ => 0.0,
    };
    let below = |end: f64| time.partition_point(|&instant| instant < end - slack);
    let start = from.map_or(0, below);
    let end = to.map_or(time.len(), below);
    start..end.max(start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_half_open() {
        let time: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 1e-3).collect();
        assert_eq!(samples(&time, Some(0.25), Some(0.5)), 250..500);
        assert_eq!(samples(&time, None, Some(0.5)), 0..500);
        assert_eq!(samples(&time, Some(0.25), None), 250..1001);
        assert_eq!(samples(&time, Some(0.5), Some(0.25)), 500..500);
        assert_eq!(samples(&[], Some(0.5), Some(0.25)), 0..0);
    }

    #[test]
    fn rounding_of_recording_times_moves_no_sample_over_an_end() {
        // Accumulated times fall on either side of the multiple of 1 ms that they stand for.
        let mut time = vec![0.0];
        for _ in 0..60_000 {
            time.push(time[time.len() - 1] + 1e-3);
        }
        assert!(time[40_000] != 40.0, "the times of this test must not be exact");
        assert_eq!(samples(&time, Some(40.0), Some(60.0)), 40_000..60_000);
    }
}
