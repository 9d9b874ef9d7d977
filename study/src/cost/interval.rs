//! Difference of ensembles' means, with a confidence interval.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::ensemble::spread;

/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.95;

/// A sum of weighted means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contrast {
    pub(super) value: f64,
    /// Half the width of its confidence interval; absent if an ensemble has one member only.
    pub(super) half_width: Option<f64>,
}

/// The sum over `terms` of weight times mean of an ensemble, with the interval after Welch (1947): the ensembles need
/// not have the same variance, and Satterthwaite's degrees of freedom belong to the sum of variances.
pub(super) fn contrast(terms: &[(f64, &[f64])]) -> Contrast {
    let (mut value, mut variance, mut squares, mut is_known) = (0.0, 0.0, 0.0, true);
    for &(weight, sample) in terms {
        let Some((mean, deviation)) = spread(sample) else { continue };
        value += weight * mean;
        let count = sample.len() as f64;
        is_known &= count > 1.0;
        let of_mean = weight * weight * deviation * deviation / count;
        variance += of_mean;
        squares += of_mean * of_mean / (count - 1.0).max(1.0);
    }
    let half_width = is_known.then(|| {
        let freedom = variance * variance / squares;
        // Members that are all alike have no degrees of freedom and no uncertainty.
        match StudentsT::new(0.0, 1.0, freedom) {
            Ok(student) if variance > 0.0 => student.inverse_cdf(0.5 + 0.5 * CONFIDENCE) * variance.sqrt(),
            _ => 0.0,
        }
    });
    Contrast { value, half_width }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Additional hours of sleep by two drugs (Student 1908); R documents them as `sleep`.
    const SLEEP: [[f64; 10]; 2] = [
        [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0],
        [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4],
    ];

    #[test]
    fn welchs_interval_is_that_of_a_published_example() {
        // R's t.test(extra ~ group, data = sleep): df = 17.776, 95 percent confidence interval -3.3654832 to 0.2054832.
        let difference = contrast(&[(1.0, &SLEEP[0]), (-1.0, &SLEEP[1])]);
        assert!((difference.value + 1.58).abs() < 1e-12, "{difference:?}");
        let half_width = difference.half_width.unwrap();
        assert!((difference.value - half_width + 3.365_483_2).abs() < 1e-6, "{difference:?}");
        assert!((difference.value + half_width - 0.205_483_2).abs() < 1e-6, "{difference:?}");
    }

    #[test]
    fn the_mean_of_two_references_counts_with_half_of_each() {
        // Against two ensembles that are the same one: Satterthwaite's interval of a difference of means, of which one has
        // half the variance.
        let [a, b] = &SLEEP;
        let both = contrast(&[(1.0, a), (-0.5, b), (-0.5, b)]);
        assert!((both.value + 1.58).abs() < 1e-12);
        let variance = |sample: &[f64]| spread(sample).map(|(_, s)| s * s / 10.0).unwrap();
        let (va, vb) = (variance(a), 0.25 * variance(b));
        let freedom = (va + 2.0 * vb).powi(2) / ((va * va + 2.0 * vb * vb) / 9.0);
        // Tables have Student's t at 0.975 as 2.093 for 19 and 2.086 for 20 degrees of freedom.
        assert!((freedom - 19.9).abs() < 0.01, "{freedom}");
        assert!((both.half_width.unwrap() / (va + 2.0 * vb).sqrt() - 2.0867).abs() < 1e-3);
    }

    #[test]
    fn one_member_has_no_interval_and_equal_members_a_tiny_one() {
        assert_eq!(
            contrast(&[(1.0, &[3.0]), (-1.0, &[1.0, 2.0])]),
            Contrast { value: 1.5, half_width: None }
        );
        let alike = contrast(&[(1.0, &[3.0, 3.0]), (-1.0, &[1.0, 1.0])]);
        assert_eq!(alike, Contrast { value: 2.0, half_width: Some(0.0) });
    }
}
