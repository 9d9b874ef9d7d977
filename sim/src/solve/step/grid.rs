//! Times of a run as whole numbers, so that steps of any length meet samples and rows of the ledger exactly.

/// Steps are powers of two of the shortest one, a tick, and begin at multiples of their own length; a sample is a whole number
/// of ticks from the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Grid {
    /// Recording interval \[s\].
    interval: f64,
    ticks_per_sample: u64,
    /// The longest step is 2^top ticks.
    top: u32,
}

impl Grid {
    /// A grid whose longest step is at most `longest` \[s\] and can be halved `halvings` times. It is the recording
    /// interval times a power of two, or a whole part of it.
    pub(crate) fn new(interval: f64, longest: f64, halvings: u32) -> Self {
        let mut doublings = 0;
        while doublings < MOST_DOUBLINGS && interval * f64::from(2u32 << doublings) <= longest * (1.0 + SAME)
        {
            doublings += 1;
        }
        if doublings > 0 {
            let halvings = halvings.max(doublings);
            Self { interval, ticks_per_sample: 1 << (halvings - doublings), top: halvings }
        } else {
            Self { interval, ticks_per_sample: parts(interval, longest) << halvings, top: halvings }
        }
    }

    /// The level of the longest step.
    pub(crate) fn top(&self) -> u32 {
        self.top
    }

    /// Length of a step \[s\]: of 2^level ticks.
    pub(crate) fn step(&self, level: u32) -> f64 {
        (1u64 << level) as f64 * self.interval / self.ticks_per_sample as f64
    }

    /// Time \[s\] of a number of ticks: never a sum.
    pub(crate) fn time(&self, ticks: u64) -> f64 {
        ticks as f64 / self.ticks_per_sample as f64 * self.interval
    }

    /// Ticks at a sample.
    pub(crate) fn at_sample(&self, sample: u64) -> u64 {
        sample * self.ticks_per_sample
    }

    /// The level of the longest step from `now` that is at most of level `wanted` and does not pass `end`.
    pub(crate) fn level_at(&self, now: u64, end: u64, wanted: u32) -> u32 {
        let aligned = if now == 0 { self.top } else { now.trailing_zeros() };
        let room = (end - now).ilog2();
        wanted.min(aligned).min(room)
    }
}

/// Largest number of doublings of the recording interval in a step: 65,536 samples a step, more than any longest step spans, and powers of two
/// that stay within their type.
const MOST_DOUBLINGS: u32 = 16;

/// Two times that differ by less than this part of them are the same.
const SAME: f64 = 1e-9;

/// Equal parts of `interval`, none longer than `step` \[s\].
pub(crate) fn parts(interval: f64, step: f64) -> u64 {
    (interval / step * (1.0 - SAME)).ceil().max(1.0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_begin_at_multiples_of_their_length_and_end_at_samples() {
        for (interval, longest, halvings) in
            [(1e-3, 4e-3, 7), (1e-3, 3.9e-3, 5), (1e-3, 2.5e-4, 3), (1.0 / 300.0, 4e-3, 6), (5e-2, 4e-3, 2)]
        {
            let grid = Grid::new(interval, longest, halvings);
            assert!(grid.step(grid.top()) <= longest * (1.0 + 1e-9));
            assert!(grid.step(grid.top()) * 2.0 > longest.min(interval) * 0.5);
            let (mut now, end) = (0, grid.at_sample(101));
            let mut wanted = 0;
            while now < end {
                let level = grid.level_at(now, end, wanted % (grid.top() + 1));
                assert_eq!(now % (1 << level), 0);
                let step = grid.time(now + (1 << level)) - grid.time(now);
                assert!((step / grid.step(level) - 1.0).abs() < 1e-10);
                now += 1 << level;
                wanted += 3;
            }
            assert_eq!(now, end);
            assert_eq!(grid.time(end), 101.0 * interval);
        }
    }

    #[test]
    fn a_step_that_divides_the_interval_is_kept_as_it_is() {
        for parts in [1u32, 2, 3, 5, 8, 20] {
            let grid = Grid::new(1e-3, 1e-3 / f64::from(parts), 0);
            assert_eq!(grid.at_sample(1), u64::from(parts));
            assert_eq!(grid.top(), 0);
        }
    }
}
