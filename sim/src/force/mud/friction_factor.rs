//! The Fanning friction factor over all regimes.

use std::f64::consts::LN_10;

use drillsweep_scenario::RegimeChoice;

use super::regime::{Regime, RegimeLimits};

/// Fanning factor as a function of the Reynolds number, once continuously differentiable.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionFactor {
    /// f Re of laminar flow: 24 in a slot, 16 in a pipe.
    pub(super) laminar_constant: f64,
    /// Factor on laminar friction.
    pub(super) laminar_factor: f64,
    /// Factor on turbulent friction.
    pub(super) turbulent_factor: f64,
    /// Generalized index for the correlations.
    pub(super) index: f64,
    /// Limits of the flow regimes.
    pub(super) limits: RegimeLimits,
}

impl FrictionFactor {
    /// Regime and Fanning factor at a positive Reynolds number.
    pub(super) fn at(&self, reynolds_number: f64, choice: RegimeChoice) -> (Regime, f64) {
        let laminar = self.laminar_factor * self.laminar_constant / reynolds_number;
        if choice == RegimeChoice::Laminar || reynolds_number <= self.limits.laminar {
            (Regime::Laminar, laminar)
        } else if reynolds_number >= self.limits.turbulent {
            (Regime::Turbulent, self.turbulent_factor * dodge_metzner(reynolds_number, self.index).fanning)
        } else {
            (Regime::Transitional, self.transitional(reynolds_number))
        }
    }

    /// Cubic Hermite in (ln Re, ln f) between the ends of laminar and turbulent flow. A local blend of both
    /// branches would dip: for a shear-thinning mud the turbulent one starts below the laminar one.
    fn transitional(&self, reynolds_number: f64) -> f64 {
        let RegimeLimits { laminar: start, turbulent: end } = self.limits;
        let width = (end / start).ln();
        let t = (reynolds_number / start).ln() / width;
        let turbulent = dodge_metzner(end, self.index);
        let ln_start = (self.laminar_factor * self.laminar_constant / start).ln();
        let ln_end = (self.turbulent_factor * turbulent.fanning).ln();
        let ln_fanning = (1.0 + 2.0 * t) * (1.0 - t).powi(2) * ln_start - t * (1.0 - t).powi(2) * width
            + t * t * (3.0 - 2.0 * t) * ln_end
            + t * t * (t - 1.0) * width * turbulent.logarithmic_slope;
        ln_fanning.exp()
    }
}

/// Turbulent flow past a smooth wall.
#[derive(Debug, Clone, Copy)]
struct TurbulentFriction {
    fanning: f64,
    /// d ln f / d ln Re.
    logarithmic_slope: f64,
}

/// Dodge and Metzner (1959), smooth wall: 1/sqrt f = 4/N^0.75 log10(Re f^(1 - N/2)) - 0.4/N^1.2, for N in (0, 1].
///
/// With s = 1/sqrt f it reads s + c ln s = r, c > 0: increasing and concave in s with exactly one positive
/// root. Newton's method climbs to it from below.
fn dodge_metzner(reynolds_number: f64, index: f64) -> TurbulentFriction {
    let per_decade = 4.0 / index.powf(0.75);
    let c = per_decade * (2.0 - index) / LN_10;
    let r = per_decade * reynolds_number.log10() - 0.4 / index.powf(1.2);
    // One Newton step from exp(r / c), worked out: it lies below the root and above 0.
    let above = (r / c).exp();
    let mut s = c * above / (above + c);
    for _ in 0..64 {
        let step = (r - s - c * s.ln()) / (1.0 + c / s);
        s += step;
        if step.abs() <= 4.0 * f64::EPSILON * s {
            break;
        }
    }
    let a = per_decade / (s * LN_10);
    TurbulentFriction { fanning: 1.0 / (s * s), logarithmic_slope: -2.0 * a / (1.0 + (2.0 - index) * a) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dodge_metzner_of_the_reference_table() {
        for (reynolds_number, index, fanning) in [
            (4000.0, 1.0, 0.009986),
            (1e4, 1.0, 0.007727),
            (1e5, 1.0, 0.004500),
            (5000.0, 0.4, 0.005299),
            (2e4, 0.45, 0.003662),
            (1e5, 0.5, 0.002586),
        ] {
            let friction = dodge_metzner(reynolds_number, index);
            assert!((friction.fanning - fanning).abs() < 5.1e-7, "{friction:?}");
        }
    }

    #[test]
    fn dodge_metzner_solves_its_equation_everywhere() {
        for index in [0.15_f64, 0.2, 0.36, 0.5, 0.8, 1.0] {
            for decade in 0..=40 {
                let reynolds_number = 10_f64.powf(0.25 * f64::from(decade));
                let f = dodge_metzner(reynolds_number, index).fanning;
                assert!(f > 0.0);
                let right = 4.0 / index.powf(0.75) * (reynolds_number * f.powf(1.0 - index / 2.0)).log10()
                    - 0.4 / index.powf(1.2);
                let scale = 4.0 / index.powf(0.75) * (1.0 + reynolds_number.log10());
                assert!((1.0 / f.sqrt() - right).abs() < 1e-13 * scale, "{index} {reynolds_number} {f}");
            }
        }
    }

    #[test]
    fn slope_is_the_derivative() {
        let h = 1e-4_f64;
        for (reynolds_number, index) in [(4402.0, 0.367), (3938.0, 0.491), (1e5, 1.0)] {
            let ln_f = |re: f64| dodge_metzner(re, index).fanning.ln();
            let slope = (ln_f(reynolds_number * h.exp()) - ln_f(reynolds_number * (-h).exp())) / (2.0 * h);
            let stated = dodge_metzner(reynolds_number, index).logarithmic_slope;
            assert!((slope - stated).abs() < 1e-8, "{slope} {stated}");
        }
    }

    #[test]
    fn friction_and_its_slope_are_continuous_at_both_limits() {
        let friction = FrictionFactor {
            laminar_constant: 24.0,
            laminar_factor: 0.574,
            turbulent_factor: 0.72,
            index: 0.367,
            limits: RegimeLimits { laminar: 2241.0, turbulent: 4402.0 },
        };
        let ln_f = |ln_re: f64| friction.at(ln_re.exp(), RegimeChoice::Auto).1.ln();
        for limit in [2241.0_f64, 4402.0] {
            let x = limit.ln();
            // A one-sided difference errs by h f''/2; halving h must halve the mismatch of the two sides,
            // and also the jump of the value, which is the slope times 2 h.
            let mismatch =
                |h: f64| ((ln_f(x + h) - ln_f(x + 1e-12)) / h - (ln_f(x - 1e-12) - ln_f(x - h)) / h).abs();
            assert!(mismatch(1e-3) < 1e-2 && mismatch(5e-4) < 0.55 * mismatch(1e-3), "{}", mismatch(1e-3));
            assert!((ln_f(x + 1e-9) - ln_f(x - 1e-9)).abs() < 2.1e-9);
        }
        assert_eq!(friction.at(2240.9, RegimeChoice::Auto).0, Regime::Laminar);
        assert_eq!(friction.at(2241.1, RegimeChoice::Auto).0, Regime::Transitional);
        assert_eq!(friction.at(4402.1, RegimeChoice::Auto).0, Regime::Turbulent);
        assert_eq!(friction.at(1e6, RegimeChoice::Laminar).0, Regime::Laminar);
    }
}
