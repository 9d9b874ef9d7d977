//! Laminar flow of a yield-power-law fluid between equal walls: the equation that slot and pipe share.

use super::rheology::Rheology;

/// A laminar flow by its quantities at the wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaminarFlow {
    /// tau_w \[Pa\].
    pub(super) wall_shear_stress: f64,
    /// gamma_w = ((tau_w - tau_y) / K)^(1/n) \[1/s\].
    pub(super) wall_shear_rate: f64,
    /// N = d ln tau_w / d ln U.
    pub(super) generalized_index: f64,
}

/// Solves g = c C(x) ((tau_w - tau_y) / K)^(1/n) for tau_w, with x = tau_y / tau_w, c = (m+1) n / (m n + 1)
/// and C(x) = (1 - x) q(x). `nominal_rate` is g, the wall's shear rate in a Newtonian fluid, positive;
/// `m` is 2 in a slot and 3 in a pipe; `plug` gives (q(x), q'(x)), q(0) = 1.
///
/// The unknown is z = ln(tau_w - tau_y), which keeps 1 - x exact near the yield stress. In z the logarithm
/// of the equation is increasing and concave, so Newton's method converges from anywhere, and from the
/// power-law solution in one to six steps.
pub(super) fn solve(
    rheology: &Rheology,
    nominal_rate: f64,
    m: f64,
    plug: impl Fn(f64) -> (f64, f64),
) -> LaminarFlow {
    let Rheology { yield_stress, consistency, flow_index: n } = *rheology;
    let ln_consistency = consistency.ln();
    let ln_rate = (nominal_rate * (m * n + 1.0) / ((m + 1.0) * n)).ln();
    let mut z = ln_consistency + n * ln_rate;
    for _ in 0..64 {
        let excess = z.exp();
        let wall = yield_stress + excess;
        let x = yield_stress / wall;
        let sheared = excess / wall;
        let (q, q_slope) = plug(x);
        let residual = (z - ln_consistency) / n + (sheared * q).ln() - ln_rate;
        let slope = 1.0 / n + x * (1.0 - sheared * q_slope / q);
        let step = residual / slope;
        z -= step;
        if step.abs() <= 4.0 * f64::EPSILON * (1.0 + z.abs()) {
            break;
        }
    }
    let excess = z.exp();
    let wall_shear_stress = yield_stress + excess;
    let c = excess / wall_shear_stress * plug(yield_stress / wall_shear_stress).0;
    LaminarFlow {
        wall_shear_stress,
        wall_shear_rate: ((z - ln_consistency) / n).exp(),
        // From the wall's shear rate, gamma_w = (m N + 1) / ((m + 1) N) g (Rabinowitsch).
        generalized_index: n * c / (1.0 + m * n * (1.0 - c)),
    }
}
