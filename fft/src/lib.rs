//! The discrete Fourier transform.
//!
//! A crate of its own for the time that it takes to build: `rustfft` is generic over the number type, so that its transforms of all
//! sizes are compiled where they are used. Here that is done once, and not with every change of the simulation.

use std::sync::Arc;

use rustfft::Fft;
use rustfft::num_complex::Complex;

/// Transforms N samples z in place to Z_k = sum over n of z_n exp(-2 pi i k n / N), k = 0 to N - 1. N is any number; no
/// samples stay none.
// Inlined, it would take all of `rustfft` to where it is used.
#[inline(never)]
pub fn forward(samples: &mut [Complex<f64>]) {
    if !samples.is_empty() {
        plan(samples.len()).process(samples);
    }
}

/// The transform of so many samples, by AVX. The general planner would choose the same, but it is compiled together with the transforms for
/// processors without AVX, on which the program does not run.
#[cfg(all(target_arch = "x86_64", target_feature = "avx", target_feature = "fma"))]
fn plan(count: usize) -> Arc<dyn Fft<f64>> {
    let mut planner = rustfft::FftPlannerAvx::new().expect("the program is compiled for AVX and FMA");
    planner.plan_fft_forward(count)
}

/// The transform of so many samples.
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx", target_feature = "fma")))]
fn plan(count: usize) -> Arc<dyn Fft<f64>> {
    rustfft::FftPlanner::new().plan_fft_forward(count)
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
