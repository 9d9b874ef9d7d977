//! Laminar flow in a circular pipe: the bore.

use super::laminar::{LaminarFlow, solve};
use super::rheology::Rheology;

/// Flow at mean speed U \[m/s\] in a pipe of diameter D \[m\], 8 U / D = 4n/(3n+1) C_p ((tau_w - tau_y)/K)^(1/n),
/// C_p = (1-x) \[(1-x)^2 + 2x(1-x)(3n+1)/(2n+1) + x^2 (3n+1)/(n+1)\]. Exact.
pub(super) fn pipe_flow(rheology: &Rheology, mean_speed: f64, diameter: f64) -> LaminarFlow {
    let n = rheology.flow_index;
    let b = (3.0 * n + 1.0) / (2.0 * n + 1.0);
    let c = (3.0 * n + 1.0) / (n + 1.0);
    solve(rheology, 8.0 * mean_speed / diameter, 3.0, |x| {
        let q = (1.0 - x).powi(2) + 2.0 * b * x * (1.0 - x) + c * x * x;
        (q, 2.0 * ((b - 1.0) + (1.0 - 2.0 * b + c) * x))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUD: Rheology = Rheology { yield_stress: 0.29, consistency: 0.07, flow_index: 0.55 };

    #[test]
    fn wall_stress_of_the_reference_table() {
        for (speed, diameter, stress) in [(1.0, 0.108, 1.188694), (2.5, 0.071, 2.089120)] {
            let flow = pipe_flow(&MUD, speed, diameter);
            assert!((flow.wall_shear_stress - stress).abs() < 5.1e-7, "{flow:?}");
        }
    }

    #[test]
    fn a_bingham_fluid_obeys_buckingham_and_reiner() {
        // 8 U / D = (tau_w / mu) (1 - 4/3 x + 1/3 x^4), the textbook solution for n = 1.
        let bingham = Rheology { yield_stress: 3.0, consistency: 0.02, flow_index: 1.0 };
        let flow = pipe_flow(&bingham, 1.3, 0.1);
        let x = bingham.yield_stress / flow.wall_shear_stress;
        let rate = flow.wall_shear_stress / bingham.consistency * (1.0 - 4.0 / 3.0 * x + x.powi(4) / 3.0);
        assert!((rate / (8.0 * 1.3 / 0.1) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn generalized_index_is_the_logarithmic_slope() {
        let (speed, h) = (1.0, 1e-4_f64);
        let index = pipe_flow(&MUD, speed, 0.108).generalized_index;
        let stress = |s: f64| pipe_flow(&MUD, s, 0.108).wall_shear_stress.ln();
        let slope = (stress(speed * h.exp()) - stress(speed * (-h).exp())) / (2.0 * h);
        assert!((index - slope).abs() < 1e-8, "{index} {slope}");
    }
}
