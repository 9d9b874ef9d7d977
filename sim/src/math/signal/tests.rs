use std::f64::consts::TAU;

use super::*;

/// Circles z = sum a exp(i (2 pi f t + phase)), sampled at k / rate.
fn orbit(circles: &[(f64, f64, f64)], rate_hz: f64, count: usize) -> (Vec<f64>, Vec<f64>) {
    let at = |k: usize| {
        let angle = |f: f64, phase: f64| TAU * (f * k as f64 / rate_hz).fract() + phase;
        let along =
            |part: fn(f64) -> f64| circles.iter().map(|(f, a, p)| a * part(angle(*f, *p))).sum::<f64>();
        (along(f64::cos), along(f64::sin))
    };
    (0..count).map(at).unzip()
}

fn amplitude_at(spectrum: &FullSpectrum, frequency_hz: f64) -> f64 {
    let bin = spectrum.frequency_hz.iter().position(|f| (f - frequency_hz).abs() < 1e-9);
    spectrum.amplitude[bin.expect("a bin")]
}

const ALL: PeakSearch = PeakSearch { count: 10, min_separation_hz: 0.0, exclude_mean: false };

/// Forward 2 Hz, backward 2.7 Hz and an offset, each on a bin of 10 s.
const CIRCLES: [(f64, f64, f64); 3] = [(2.0, 1.5e-3, 0.3), (-2.7, 4e-4, 1.1), (0.0, 0.0376, -0.8)];

#[test]
fn components_of_an_orbit_have_lines_at_their_signed_frequencies() {
    for count in [10_000, 9_000, 3_000] {
        let rate = f64::from(count) / 10.0;
        let (u, v) = orbit(&CIRCLES, rate, count as usize);
        for window in [Window::Rectangular, Window::Hann] {
            let spectrum = full_spectrum(&u, &v, rate, window);
            assert_eq!(spectrum.amplitude.len(), count as usize);
            assert!(spectrum.frequency_hz.is_sorted());
            for (frequency, amplitude, _) in CIRCLES {
                assert!((amplitude_at(&spectrum, frequency) - amplitude).abs() < 1e-12);
                if frequency != 0.0 {
                    assert!(amplitude_at(&spectrum, -frequency) < 1e-12);
                }
            }
            let peaks = spectrum.peaks(&PeakSearch { count: 3, ..ALL });
            let whirls: Vec<Whirl> = peaks.iter().map(|peak| peak.whirl).collect();
            assert_eq!(whirls, [Whirl::Offset, Whirl::Forward, Whirl::Backward]);
            for (peak, frequency) in peaks.iter().zip([0.0, 2.0, -2.7]) {
                assert!((peak.frequency_hz - frequency).abs() < 1e-9);
            }
        }
    }
}

/// Tran et al. 2019: their peak at 0 Hz, 0.07521 m, is twice the orbit's offset.
#[test]
fn peak_to_peak_at_zero_is_twice_the_offset() {
    let (u, v) = orbit(&[(0.0, 0.037_605, 2.0), (2.0, 1e-3, 0.0)], 1000.0, 10_000);
    let spectrum = full_spectrum(&u, &v, 1000.0, Window::Rectangular);
    let zero = spectrum.frequency_hz.iter().position(|f| *f == 0.0).expect("0 Hz");
    assert!((spectrum.peak_to_peak()[zero] - 0.075_21).abs() < 1e-12);
}

/// A straight vibration along u is half a forward and half a backward circle.
#[test]
fn a_straight_vibration_is_half_forward_and_half_backward() {
    let (u, _) = orbit(&[(3.0, 2e-3, 0.4)], 500.0, 5_000);
    let spectrum = full_spectrum(&u, &vec![0.0; u.len()], 500.0, Window::Rectangular);
    assert!((amplitude_at(&spectrum, 3.0) - 1e-3).abs() < 1e-12);
    assert!((amplitude_at(&spectrum, -3.0) - 1e-3).abs() < 1e-12);
}

#[test]
fn frequencies_of_even_odd_and_tiny_counts_are_those_of_the_transform() {
    let frequencies = |count: usize| {
        let zeros = vec![0.0; count];
        full_spectrum(&zeros, &zeros, count as f64, Window::Rectangular).frequency_hz
    };
    assert_eq!(frequencies(4), [-2.0, -1.0, 0.0, 1.0]);
    assert_eq!(frequencies(5), [-2.0, -1.0, 0.0, 1.0, 2.0]);
    assert_eq!(frequencies(1), [0.0]);
    assert!(frequencies(0).is_empty());
    let tiny = full_spectrum(&[1.0, 2.0], &[0.0, 0.0], 2.0, Window::Hann);
    assert!(tiny.peaks(&ALL).is_empty());
}

/// Parseval: without a window the mean square distance from the axis is the sum of the squared amplitudes.
#[test]
fn the_amplitudes_hold_the_mean_square_of_the_motion() {
    // A prime count too: the transform takes any.
    for count in [1024, 9_973] {
        let mut state = 7u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let (u, v): (Vec<f64>, Vec<f64>) = (0..count).map(|_| (number(), number() - 0.3)).unzip();
        let mean_square = u.iter().zip(&v).map(|(u, v)| u * u + v * v).sum::<f64>() / count as f64;
        let spectrum = full_spectrum(&u, &v, 1000.0, Window::Rectangular);
        let sum: f64 = spectrum.amplitude.iter().map(|amplitude| amplitude * amplitude).sum();
        assert!((sum / mean_square - 1.0).abs() < 1e-13);
    }
}

/// The interpolation is exact for a lone line up to (pi / N)^2.
#[test]
fn a_lone_line_between_bins_is_found() {
    for fraction in [-0.5, -0.31, 0.0, 0.07, 0.25, 0.49] {
        for frequency in [2.1 + 0.1 * fraction, -7.3 + 0.1 * fraction] {
            let (u, v) = orbit(&[(frequency, 1e-3, 0.2)], 1000.0, 10_000);
            for window in [Window::Rectangular, Window::Hann] {
                let peaks = full_spectrum(&u, &v, 1000.0, window).peaks(&PeakSearch { count: 1, ..ALL });
                assert!((peaks[0].frequency_hz - frequency).abs() < 0.1 * 1e-6, "{window:?} {frequency}");
                assert_eq!(peaks[0].whirl == Whirl::Forward, frequency > 0.0);
            }
        }
    }
}

/// A lone line has its own amplitude at any place between two bins. The closed forms are those of many samples: N sin(pi d / N)
/// in place of pi d, and its effect on the offset, are both within (pi / N)^2 of them.
#[test]
fn a_single_line_has_its_amplitude_at_any_frequency() {
    let amplitude = 1e-2;
    for count in [64_u32, 1_000, 10_000] {
        let bound = (std::f64::consts::PI / f64::from(count)).powi(2) + 1e-11;
        for step in -20..=20 {
            for bin in [11.0, -17.0] {
                let frequency = bin + 0.025 * f64::from(step);
                let (u, v) = orbit(&[(frequency, amplitude, 0.7)], f64::from(count), count as usize);
                for window in [Window::Rectangular, Window::Hann] {
                    let spectrum = full_spectrum(&u, &v, f64::from(count), window);
                    let peak = spectrum.peaks(&PeakSearch { count: 1, ..ALL })[0];
                    let error = (peak.amplitude / amplitude - 1.0).abs();
                    assert!(error < bound, "{window:?}, {count} samples, {frequency}: {error}");
                }
            }
        }
    }
}

/// Hann's sidelobes fall as the cube of the distance in bins: 20 bins off, an equal line moves the other's ratio
/// of neighbours by about 1 / 20^3.
#[test]
fn two_lines_between_bins_are_found_with_hann() {
    let lines = [2.034, -2.771, 4.049];
    let circles: Vec<_> = lines.iter().map(|f| (*f, 1e-3, *f)).collect();
    let (u, v) = orbit(&circles, 1000.0, 10_000);
    let search = PeakSearch { count: 3, min_separation_hz: 0.5, exclude_mean: true };
    let mut peaks = full_spectrum(&u, &v, 1000.0, Window::Hann).peaks(&search);
    peaks.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    for (peak, line) in peaks.iter().zip([-2.771, 2.034, 4.049]) {
        assert!((peak.frequency_hz - line).abs() < 0.1 / 8000.0 * 3.0, "{} for {line}", peak.frequency_hz);
    }
}

#[test]
fn peaks_keep_their_distance_their_number_and_leave_out_the_mean() {
    let circles = [(0.0, 1.0, 0.0), (2.0, 0.5, 0.0), (2.4, 0.4, 0.0), (-6.0, 0.3, 0.0), (9.0, 0.2, 0.0)];
    let (u, v) = orbit(&circles, 100.0, 1_000);
    let spectrum = full_spectrum(&u, &v, 100.0, Window::Rectangular);
    let found = |search: &PeakSearch, spectrum: &FullSpectrum| -> Vec<f64> {
        spectrum.peaks(search).iter().map(|peak| (peak.frequency_hz * 10.0).round() / 10.0).collect()
    };
    let search = PeakSearch { count: 5, min_separation_hz: 0.0, exclude_mean: false };
    assert_eq!(found(&search, &spectrum), [0.0, 2.0, 2.4, -6.0, 9.0]);
    let search = PeakSearch { count: 3, min_separation_hz: 0.5, exclude_mean: true };
    assert_eq!(found(&search, &spectrum), [2.0, -6.0, 9.0]);

    let range = spectrum.restricted_to(&(-7.0..=2.2));
    assert_eq!((range.frequency_hz[0], range.frequency_hz[range.frequency_hz.len() - 1]), (-7.0, 2.2));
    assert_eq!(range.amplitude.len(), 93);
    assert_eq!(found(&PeakSearch { count: 2, ..search }, &range), [2.0, -6.0]);
}

#[test]
fn windows_are_half_open_despite_rounding() {
    let range = |from, to| sample_range(from, to, 1000.0, 60_001);
    assert_eq!(range(15.0, 25.0), 15_000..25_000);
    assert_eq!(range(50.0, 60.0), 50_000..60_000);
    // 0.1 * 3 = 0.30000000000000004 and 0.29 * 1000 = 290.0 - 6e-14: both are sample times.
    assert_eq!(range(0.1, 0.3), 100..300);
    assert_eq!(range(0.1, 0.1 * 3.0), 100..300);
    assert_eq!(range(0.29, 0.57), 290..570);
    // Between samples, the next one on either side.
    assert_eq!(range(0.1001, 0.3001), 101..301);
    assert_eq!(range(-1.0, 0.002), 0..2);
    assert_eq!(range(59.0, 99.0), 59_000..60_001);
    assert!(range(20.0, 10.0).is_empty());
    // Adjoining windows share no sample and lose none.
    for k in 1..2_000 {
        let (a, b, c) = (f64::from(k - 1) * 0.03, f64::from(k) * 0.03, f64::from(k + 1) * 0.03);
        assert_eq!(range(a, b).end, range(b, c).start);
        if k < 1_999 {
            assert_eq!(range(a, b).len(), 30, "{k}");
        }
    }
}

/// A circle of radius a about (x, y), its closest and farthest points on the samples.
#[test]
fn statistics_of_a_circle_are_its_centre_and_radius() {
    let (x, y, a) = (0.03, 0.04, 1e-3);
    let at = |k: u32| {
        let angle = TAU * f64::from(k) / 1000.0 + 0.8f64.asin();
        (x + a * angle.cos(), y + a * angle.sin())
    };
    let (u, v): (Vec<f64>, Vec<f64>) = (0..1000).map(at).unzip();
    let statistics = orbit_statistics(&u, &v).expect("samples");
    let close = |actual: f64, expected: f64, tolerance: f64| {
        assert!((actual - expected).abs() < tolerance, "{actual} instead of {expected}");
    };
    close(statistics.mean_u, x, 1e-15);
    close(statistics.mean_v, y, 1e-15);
    close(statistics.orbit_radius_rms, a, 1e-15);
    close(statistics.largest_radius, 0.051, 1e-15);
    close(statistics.smallest_radius, 0.049, 1e-15);
    // r = R + a cos + a^2 sin^2 / (2 R) + O(a^3 / R^2): the first terms' mean and deviation.
    close(statistics.mean_radius, 0.05 + a * a / (4.0 * 0.05), a * (a / 0.05).powi(3));
    close(statistics.radius_deviation, a / 2f64.sqrt(), a * (a / 0.05).powi(2));
    // The nearest samples miss a diameter's ends by at most half a step of 2 pi / 1000.
    close(statistics.peak_to_peak_u, 2.0 * a, a * (TAU / 2000.0).powi(2));
    close(statistics.peak_to_peak_v, 2.0 * a, a * (TAU / 2000.0).powi(2));
    assert_eq!(orbit_statistics(&[], &[]), None);
}

#[test]
fn windows_are_written_in_snake_case() {
    assert_eq!(serde_json::to_string(&Window::Hann).expect("plain"), r#""hann""#);
    assert_eq!(serde_json::from_str::<Window>(r#""rectangular""#).expect("known"), Window::Rectangular);
}
