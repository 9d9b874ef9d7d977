//! Time up to which a history can be trusted, from runs of the same scenario whose starts almost agree.
//!
//! Impacts and sliding make neighbouring histories part. From then on neither their course nor the error of an
//! integrator along it has a meaning; sizes, lines and counts have one, with the spread of the members.

use std::ops::Range;

use drillsweep_sim::solve::run::{Histories, Series};

/// Distance at which two histories count as parted, relative to the size of the motion.
pub(crate) const PARTED: f64 = 0.1;

/// Samples compared at once.
const BLOCK: usize = 4096;

/// The time \[s\] at which two members' recorded histories have parted: their root mean square distance over the nodes
/// exceeds a tenth of the root mean square motion of the first about its mean. Absent if they stay together.
///
/// # Errors
/// The histories cannot be read.
pub fn parting_time<H: Histories>(a: &H, b: &H, rate_hz: f64) -> Result<Option<f64>, H::Error> {
    let motion = motion(a)?;
    let samples = a.samples().min(b.samples());
    for from in (0..samples).step_by(BLOCK) {
        let block = from..(from + BLOCK).min(samples);
        let mut distance = vec![0.0; block.len()];
        for index in 0..a.nodes().len() {
            for (total, square) in distance.iter_mut().zip(squared_distances(a, b, index, &block)?) {
                *total += square;
            }
        }
        if let Some(k) = distance.iter().position(|&d| motion > 0.0 && d > PARTED * PARTED * motion) {
            return Ok(Some((from + k) as f64 / rate_hz));
        }
    }
    Ok(None)
}

/// Root mean square distance over some samples between two members, of each recorded node \[m\].
///
/// # Errors
/// The histories cannot be read.
pub fn distances<H: Histories>(a: &H, b: &H, samples: &Range<usize>) -> Result<Vec<f64>, H::Error> {
    let ends = samples.start.min(samples.end)..samples.end.min(a.samples()).min(b.samples());
    let count = ends.len().max(1) as f64;
    let of_node = |index: usize| {
        let mut sum = 0.0;
        for from in ends.clone().step_by(BLOCK) {
            let block = from..(from + BLOCK).min(ends.end);
            for square in squared_distances(a, b, index, &block)? {
                sum += square;
            }
        }
        Ok((sum / count).sqrt())
    };
    (0..a.nodes().len()).map(of_node).collect()
}

/// Mean square motion about the mean, of all nodes together \[m2\].
fn motion<H: Histories>(histories: &H) -> Result<f64, H::Error> {
    let samples = histories.samples();
    let count = samples.max(1) as f64;
    let mut motion = 0.0;
    for index in 0..histories.nodes().len() {
        for series in [Series::U, Series::V] {
            let sum_of = |term: &dyn Fn(f64) -> f64| {
                let mut sum = 0.0;
                for from in (0..samples).step_by(BLOCK) {
                    let block = histories.read(index, series, from..(from + BLOCK).min(samples))?;
                    block.iter().for_each(|&value| sum += term(value));
                }
                Ok(sum)
            };
            let mean = sum_of(&|value| value)? / count;
            motion += sum_of(&|value| (value - mean).powi(2))? / count;
        }
    }
    Ok(motion)
}

/// Squared distances between two members at one node \[m2\], by sample.
fn squared_distances<H: Histories>(
    a: &H,
    b: &H,
    index: usize,
    samples: &Range<usize>,
) -> Result<Vec<f64>, H::Error> {
    let mut squares = vec![0.0; samples.len()];
    for series in [Series::U, Series::V] {
        let (a, b) = (a.read(index, series, samples.clone())?, b.read(index, series, samples.clone())?);
        for (square, (a, b)) in squares.iter_mut().zip(a.iter().zip(b.iter())) {
            *square += (a - b).powi(2);
        }
    }
    Ok(squares)
}

/// Mean and standard deviation of a statistic over the members; `None` without members.
pub fn spread(values: &[f64]) -> Option<(f64, f64)> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    // One member has no spread; more have the spread of a sample.
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (!values.is_empty()).then(|| (mean, (squares / (count - 1.0).max(1.0)).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use drillsweep_sim::solve::run::NodeHistory;

    #[test]
    fn histories_diverge_at_a_tenth_of_the_motion() {
        let history = |growth: f64| {
            let time = (0..1000).map(|k| k as f64 / 100.0);
            let u: Vec<f64> = time.map(|t| t.sin() + 1e-6 * (growth * t).exp()).collect();
            NodeHistory { v: vec![0.0; u.len()], u, ..NodeHistory::default() }
        };
        let (a, b) = (vec![history(0.0)], vec![history(2.0)]);
        // The sine's root mean square is 0.7: parted at ln(0.07 / 1e-6) / 2 = 5.6 s.
        let Ok(parted) = parting_time(&a, &b, 100.0);
        let parted = parted.unwrap();
        assert!((parted - 5.6).abs() < 0.05, "{parted}");
        assert_eq!(parting_time(&a, &a, 100.0), Ok(None));
    }

    #[test]
    fn spread_is_that_of_a_sample() {
        assert_eq!(spread(&[]), None);
        assert_eq!(spread(&[3.0]), Some((3.0, 0.0)));
        assert_eq!(spread(&[1.0, 3.0]), Some((2.0, 2.0_f64.sqrt())));
    }
}
