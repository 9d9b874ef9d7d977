//! Sample of a sweep's points that is verified, and the promise of their accuracy.

use drillsweep_scenario::{Accuracy, Promise};
use serde::Deserialize;
use serde_json::Value;

/// The fractional part of the golden ratio as a part of 2^64: its multiples, taken modulo one, spread evenly however many they are
/// (Weyl 1916; of all numbers its spread is the most even).
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Problem of a value of `verify`, in words: it must be a part of the points or a whole number of them.
pub(crate) fn verify_problem(verify: f64) -> Option<&'static str> {
    let is_part = verify > 0.0 && verify < 1.0;
    let is_number = verify >= 1.0 && verify.is_finite() && verify.fract() == 0.0;
    (!is_part && !is_number).then_some(
        "must be a part of the points, above 0 and below 1, or a whole number of points, 1 or more",
    )
}

/// Number of verified points among `total`: a part of them below 1, rounded but at least one, or a number, at most all.
fn wanted(verify: f64, total: usize) -> usize {
    let number = if verify < 1.0 { (verify * total as f64).round().max(1.0) } else { verify };
    (number as usize).min(total)
}

/// Indices of those among `added` points that are verified, in order, if a sweep has `total` points with them and `verified`
/// of the others are verified already.
///
/// They are divided into as many equal parts as are to be verified, and of each part one is taken, by multiples of the golden ratio.
/// So the sample is spread over the order of the points, over the first axis of a grid, as evenly as can be; and within the parts it
/// keeps no step with the axes that vary faster.
pub fn sample(verify: f64, total: usize, verified: usize, added: usize) -> Vec<usize> {
    let number = wanted(verify, total).saturating_sub(verified).min(added);
    let part = |k: usize| {
        let (start, end) = (k * added / number, (k + 1) * added / number);
        // From one half on: a single point is the middle one.
        let fraction = (1_u64 << 63).wrapping_add((k as u64).wrapping_mul(GOLDEN));
        start + ((u128::from(fraction) * (end - start) as u128) >> 64) as usize
    };
    (0..number).map(part).collect()
}

/// Promise of the scenario of this JSON text; none if another release has written it otherwise.
pub fn promise_of_scenario(json: &str) -> Option<Promise> {
    let scenario: Value = serde_json::from_str(json).ok()?;
    Accuracy::deserialize(scenario.get("accuracy")?).ok()?.promise()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_part_or_a_number_of_points_is_verified() {
        for (verify, total, number) in [
            (0.05, 100, 5),
            (0.05, 20, 1),
            (0.05, 29, 1),
            (0.05, 30, 2),
            (0.05, 3, 1),
            (0.999, 2, 2),
            (1e-9, 100_000, 1),
            (1.0, 7, 1),
            (5.0, 7, 5),
            (1e300, 7, 7),
        ] {
            assert_eq!(sample(verify, total, 0, total).len(), number, "{verify} of {total}");
        }
        for good in [0.05, 1e-12, 0.999, 1.0, 12.0, 1e300] {
            assert_eq!(verify_problem(good), None, "{good}");
        }
        for bad in [0.0, -0.0, -1.0, 1.5, -0.05, f64::NAN, f64::INFINITY] {
            assert!(verify_problem(bad).is_some(), "{bad}");
        }
    }

    #[test]
    fn one_of_each_equal_part_is_taken_and_none_twice() {
        for total in [1, 2, 7, 12, 100, 997] {
            for number in 1..=total {
                let sample = sample(number as f64, total, 0, total);
                assert_eq!(sample.len(), number);
                for (k, index) in sample.iter().enumerate() {
                    assert!((k * total / number..(k + 1) * total / number).contains(index));
                }
            }
        }
        assert_eq!(sample(1.0, 101, 0, 101), [50], "a single one is the middle one");
    }

    #[test]
    fn a_sample_of_a_grid_is_spread_over_both_its_axes() {
        // As many as there are rows: of every row one, and the columns are not left out or met by all.
        for side in [10, 16, 20, 32] {
            let sample = sample(side as f64, side * side, 0, side * side);
            let rows: BTreeSet<usize> = sample.iter().map(|index| index / side).collect();
            assert_eq!(rows.len(), side);
            let mut columns = vec![0; side];
            sample.iter().for_each(|index| columns[index % side] += 1);
            assert!(columns.iter().all(|number| *number <= 2), "{side}: {columns:?}");
            assert!(columns.windows(3).all(|three| three.iter().sum::<i32>() > 0), "{side}: {columns:?}");
        }
    }

    #[test]
    fn points_added_singly_are_verified_as_often_as_in_batches() {
        let mut verified = sample(0.05, 10, 0, 10).len();
        for total in 11..=1000 {
            verified += sample(0.05, total, verified, 1).len();
        }
        assert_eq!(verified, 50);
        // A number of points is one of the whole sweep.
        assert_eq!(sample(5.0, 40, 5, 20), Vec::<usize>::new());
        assert_eq!(sample(5.0, 23, 3, 20).len(), 2);
    }
}
