//! Snapshots of the whole string: which of them lie in a window.

use std::ops::Range;

/// Times of the snapshots of a run, at equal intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapshotTimes {
    /// Time of the first \[s\].
    pub first: f64,
    /// Time of the last \[s\].
    pub last: f64,
    /// Number of snapshots.
    pub count: usize,
}

impl SnapshotTimes {
    /// Time of the `index`-th, from 0 \[s\].
    pub fn time(&self, index: usize) -> f64 {
        self.first + index as f64 * self.interval()
    }

    /// From one to the next \[s\]; 1 if there are not two.
    pub fn interval(&self) -> f64 {
        match self.count {
            0 | 1 => 1.0,
            count => (self.last - self.first) / (count - 1) as f64,
        }
    }

    /// Snapshots in a half-open window \[from, to) of simulated time \[s\], by number from 0; an absent end is open.
    ///
    /// A snapshot within a hundredth of an interval of an end counts as lying on it.
    pub fn window(&self, from: Option<f64>, to: Option<f64>) -> Range<usize> {
        // Saturates at both ends.
        let below =
            |end: f64| (((end - self.first) / self.interval() - 1e-2).ceil() as usize).min(self.count);
        let start = from.map_or(0, below);
        let end = to.map_or(self.count, below);
        start..end.max(start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_half_open() {
        // At 25 Hz from 10 s on.
        let times = SnapshotTimes { first: 10.0, last: 10.0 + 249.0 / 25.0, count: 250 };
        for (from, to, expected) in [
            (None, None, 0..250),
            (Some(10.0), Some(12.0), 0..50),
            (Some(0.0), Some(10.04), 0..1),
            (Some(10.08), None, 2..250),
            (Some(10.081), Some(10.119), 3..3),
            (Some(10.081), Some(10.121), 3..4),
            (Some(19.96), Some(60.0), 249..250),
            (Some(20.0), None, 250..250),
            (Some(15.0), Some(12.0), 125..125),
            (None, Some(-1.0), 0..0),
        ] {
            assert_eq!(times.window(from, to), expected, "{from:?} to {to:?}");
        }
        assert!((times.time(249) - 19.96).abs() < 1e-12 && (times.interval() - 0.04).abs() < 1e-12);
        let none = SnapshotTimes { first: 0.0, last: 0.0, count: 0 };
        assert_eq!(none.window(Some(1.0), None), 0..0);
        let one = SnapshotTimes { first: 3.0, last: 3.0, count: 1 };
        assert_eq!((one.window(Some(3.0), None), one.window(None, Some(3.0))), (0..1, 0..0));
    }
}
