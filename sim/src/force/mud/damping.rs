//! Damping and added mass of lateral motion by the mud.

use std::f64::consts::{PI, SQRT_2};

use super::geometry::FlowGeometry;

/// Viscous damping of a pipe that whirls at the speed of rotation in a concentric hole, equation (29):
/// k = 2 sqrt(2) / sqrt(S) (1 + kappa^3) / (1 - kappa^2)^2 rho A_o Omega \[N s/m2\], S = Omega D_o^2 / (4 nu_f).
///
/// `viscosity` is nu_f \[m2/s\]; the sense of the rotation does not matter. Boundary-layer solution, good if
/// sqrt(S) (1 - kappa) / kappa is much larger than 1: 5 to 8 % low in a drilling annulus.
pub(super) fn rotation_damping(
    density: f64,
    outer_diameter: f64,
    diameter_ratio: f64,
    viscosity: f64,
    rotation_speed: f64,
) -> f64 {
    let speed = rotation_speed.abs();
    // rho A_o Omega / sqrt(S), written so that it is 0 at Omega = 0.
    let scale =
        density * PI / 4.0 * outer_diameter.powi(2) * 2.0 / outer_diameter * (viscosity * speed).sqrt();
    2.0 * SQRT_2 * (1.0 + diameter_ratio.powi(3)) / (1.0 - diameter_ratio.powi(2)).powi(2) * scale
}

/// Added-mass coefficient of the confined annulus, chi = (D_ch^2 + D_o^2) / (D_ch^2 - D_o^2), equation (28).
pub(super) fn added_mass_coefficient(geometry: &FlowGeometry) -> f64 {
    let (hole2, outer2) = (geometry.hole_diameter.powi(2), geometry.outer_diameter.powi(2));
    (hole2 + outer2) / (hole2 - outer2)
}
