//! The size of an orbit.

use serde::{Deserialize, Serialize};

use super::window::Window;

/// Position and size of an orbit \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct OrbitStatistics {
    /// Mean u.
    pub mean_u: f64,
    /// Mean v.
    pub mean_v: f64,
    /// Mean distance r from the hole's axis.
    pub mean_radius: f64,
    /// Largest r.
    pub largest_radius: f64,
    /// Smallest r.
    pub smallest_radius: f64,
    /// Standard deviation of r.
    pub radius_deviation: f64,
    /// Root mean square distance from the mean position (mean u, mean v): the radius of a circular orbit.
    pub orbit_radius_rms: f64,
    /// Largest less smallest u.
    pub peak_to_peak_u: f64,
    /// Largest less smallest v.
    pub peak_to_peak_v: f64,
}

/// Statistics of the samples (u, v), all weighted alike; `None` without samples.
///
/// # Panics
/// u and v differ in length.
pub fn orbit_statistics(u: &[f64], v: &[f64]) -> Option<OrbitStatistics> {
    weighted_orbit_statistics(u, v, Window::Rectangular)
}

/// Statistics of the samples (u, v) with the weights of a window; extremes are those of all samples. `None` without samples.
///
/// # Panics
/// u and v differ in length.
pub fn weighted_orbit_statistics(u: &[f64], v: &[f64], window: Window) -> Option<OrbitStatistics> {
    assert_eq!(u.len(), v.len());
    let weights: Vec<f64> = (0..u.len()).map(|n| window.weight(n, u.len())).collect();
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return None;
    }
    let mean = |values: &[f64]| {
        values.iter().zip(&weights).map(|(value, weight)| weight * value).sum::<f64>() / total
    };
    let mean_square_from = |values: &[f64], centre: f64| {
        let squares = values.iter().map(|value| (value - centre) * (value - centre));
        squares.zip(&weights).map(|(square, weight)| weight * square).sum::<f64>() / total
    };
    let largest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);

    let radius: Vec<f64> = u.iter().zip(v).map(|(u, v)| u.hypot(*v)).collect();
    let (mean_u, mean_v, mean_radius) = (mean(u), mean(v), mean(&radius));
    Some(OrbitStatistics {
        mean_u,
        mean_v,
        mean_radius,
        largest_radius: largest(&radius),
        smallest_radius: smallest(&radius),
        radius_deviation: mean_square_from(&radius, mean_radius).sqrt(),
        orbit_radius_rms: (mean_square_from(u, mean_u) + mean_square_from(v, mean_v)).sqrt(),
        peak_to_peak_u: largest(u) - smallest(u),
        peak_to_peak_v: largest(v) - smallest(v),
    })
}
