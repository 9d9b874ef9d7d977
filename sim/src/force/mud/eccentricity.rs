//! Factors by which eccentricity lowers the pressure loss of the flow past a pipe.
//!
//! The factors were fitted for 0.3 <= kappa <= 0.9, 0 <= e <= 0.95 and an index of 0.4 to 1. Against a 2D
//! solution of yield-power-law flow they hold within 1 % down to N = 0.367. With e <= 1 and the index cut by
//! [`super::regime::correlation_index`] they stay above 0.3 for every kappa.

/// R_lam of laminar friction, Haciislamoglu and Langlinais (1990), with the generalized index for n.
pub(super) fn laminar_factor(eccentricity: f64, index: f64, diameter_ratio: f64) -> f64 {
    factor(eccentricity, index, diameter_ratio, 0.072, 1.5, 0.96)
}

/// R_turb of turbulent friction, Haciislamoglu and Cartalos (1994), with the generalized index for n.
pub(super) fn turbulent_factor(eccentricity: f64, index: f64, diameter_ratio: f64) -> f64 {
    factor(eccentricity, index, diameter_ratio, 0.048, 2.0 / 3.0, 0.285)
}

fn factor(e: f64, index: f64, diameter_ratio: f64, linear: f64, square: f64, cube: f64) -> f64 {
    1.0 - linear * e / index * diameter_ratio.powf(0.8454)
        - square * e * e * index.sqrt() * diameter_ratio.powf(0.1852)
        + cube * e.powi(3) * index.sqrt() * diameter_ratio.powf(0.2527)
}

#[cfg(test)]
mod tests {
    use super::super::regime::correlation_index;
    use super::*;

    #[test]
    fn factors_stay_positive_and_fall_with_eccentricity() {
        for index in [0.0, 0.1, 0.15, 0.2, 0.4, 0.7, 1.0, 1.4].map(correlation_index) {
            for diameter_ratio in [0.0, 0.2, 0.3, 0.6, 0.9, 0.97, 1.0] {
                assert_eq!(laminar_factor(0.0, index, diameter_ratio), 1.0);
                assert_eq!(turbulent_factor(0.0, index, diameter_ratio), 1.0);
                let lowest = laminar_factor(1.0, index, diameter_ratio);
                assert!(lowest > 0.3, "{index} {diameter_ratio} {lowest}");
                assert!(lowest < turbulent_factor(1.0, index, diameter_ratio) || diameter_ratio == 0.0);
            }
        }
    }
}
