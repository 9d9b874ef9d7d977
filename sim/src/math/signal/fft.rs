//! The discrete Fourier transform.

use nalgebra::Complex;
use rustfft::FftPlanner;

/// Transforms N samples z in place to Z_k = sum over n of z_n exp(-2 pi i k n / N), k = 0 to N - 1. N is any number, zero
/// included.
pub(super) fn forward(samples: &mut [Complex<f64>]) {
    if !samples.is_empty() {
        FftPlanner::new().plan_fft_forward(samples.len()).process(samples);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn it_is_the_sum_that_defines_it() {
        for count in [0, 1, 2, 31, 96, 101, 1024] {
            let samples: Vec<Complex<f64>> =
                (0..count).map(|n| Complex::new((n * n % 17) as f64, (n * 7 % 5) as f64 - 2.0)).collect();
            let mut transformed = samples.clone();
            forward(&mut transformed);
            for (k, value) in transformed.iter().enumerate() {
                let turn = |n: usize| Complex::cis(-TAU * (k * n % count) as f64 / count as f64);
                let sum: Complex<f64> = samples.iter().enumerate().map(|(n, sample)| sample * turn(n)).sum();
                assert!((sum - value).norm() < 1e-9 * count as f64, "{k} of {count}: {value} for {sum}");
            }
        }
    }
}
