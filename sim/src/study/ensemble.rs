//! How far a history can be trusted: runs of the same scenario from starts that differ by next to nothing.
//!
//! Impacts and sliding make neighbouring histories part. From then on neither their course nor the error of an
//! integrator along it means anything; sizes, lines and counts do, with the spread that the members show.

use std::ops::Range;

use crate::transient::NodeHistory;

/// Distance at which two histories count as parted, relative to the size of the motion.
pub(crate) const PARTED: f64 = 0.1;

/// The time \[s\] at which two members' recorded histories have parted: their root mean square distance over the nodes
/// exceeds a tenth of the root mean square motion of the first about its mean. Absent where they stay together.
pub fn parting_time(a: &[NodeHistory], b: &[NodeHistory], rate_hz: f64) -> Option<f64> {
    let mut motion = 0.0;
    for history in a {
        for values in [&history.u, &history.v] {
            let count = values.len().max(1) as f64;
            let mean = values.iter().sum::<f64>() / count;
            motion += values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        }
    }
    let samples = a.iter().map(|history| history.u.len()).min().unwrap_or(0);
    let distance = |k: usize| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a.u[k] - b.u[k]).powi(2) + (a.v[k] - b.v[k]).powi(2)).sum()
    };
    let parted = |&k: &usize| motion > 0.0 && distance(k) > PARTED * PARTED * motion;
    (0..samples).find(parted).map(|k| k as f64 / rate_hz)
}

/// Root mean square distance over some samples between two members, of each recorded node \[m\].
pub fn distances(a: &[NodeHistory], b: &[NodeHistory], samples: &Range<usize>) -> Vec<f64> {
    let of_node = |(a, b): (&NodeHistory, &NodeHistory)| {
        let square = |k: usize| (a.u[k] - b.u[k]).powi(2) + (a.v[k] - b.v[k]).powi(2);
        let ends = samples.start.min(samples.end)..samples.end.min(a.u.len()).min(b.u.len());
        let count = ends.len().max(1) as f64;
        (ends.map(square).sum::<f64>() / count).sqrt()
    };
    a.iter().zip(b).map(of_node).collect()
}

/// Mean and standard deviation of a statistic over the members; nothing without any.
pub fn spread(values: &[f64]) -> Option<(f64, f64)> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    // One member has no spread; more have that of a sample.
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (!values.is_empty()).then(|| (mean, (squares / (count - 1.0).max(1.0)).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn histories_part_where_their_distance_passes_a_tenth_of_the_motion() {
        let history = |growth: f64| {
            let time = (0..1000).map(|k| k as f64 / 100.0);
            let u: Vec<f64> = time.map(|t| t.sin() + 1e-6 * (growth * t).exp()).collect();
            NodeHistory { v: vec![0.0; u.len()], u, ..NodeHistory::default() }
        };
        let (a, b) = ([history(0.0)], [history(2.0)]);
        // The sine's root mean square is 0.7: parted at ln(0.07 / 1e-6) / 2 = 5.6 s.
        let parted = parting_time(&a, &b, 100.0).unwrap();
        assert!((parted - 5.6).abs() < 0.05, "{parted}");
        assert_eq!(parting_time(&a, &a, 100.0), None);
    }

    #[test]
    fn spread_is_that_of_a_sample() {
        assert_eq!(spread(&[]), None);
        assert_eq!(spread(&[3.0]), Some((3.0, 0.0)));
        assert_eq!(spread(&[1.0, 3.0]), Some((2.0, 2.0_f64.sqrt())));
    }
}
