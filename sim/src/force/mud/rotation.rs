//! Shear thinning of the mud by rotation, which lowers the friction of its laminar flow.

use super::laminar::LaminarFlow;
use super::rheology::Rheology;

/// Ratio of the axial pressure gradients with and without rotation at the same mean speed, from the exact
/// helical flow in a narrow slot, at most 1. Concentric and laminar.
///
/// `axial` is the flow without rotation at `mean_speed` \[m/s\] in a slot of half height `half_gap` \[m\];
/// one wall moves at `wall_speed` \[m/s\] across it. The stress at the distance y from the middle is
/// hypot(G y, tau_theta); G and tau_theta follow from
/// 2 int_0^H gamma/tau tau_theta dy = V and (1/H) int_0^H gamma/tau G y^2 dy = U.
pub(super) fn rotation_factor(
    rheology: &Rheology,
    axial: &LaminarFlow,
    mean_speed: f64,
    half_gap: f64,
    wall_speed: f64,
) -> f64 {
    let scale = half_gap * axial.wall_shear_rate;
    let slot = HelicalSlot {
        yield_stress: rheology.yield_stress / axial.wall_shear_stress,
        inverse_index: 1.0 / rheology.flow_index,
        axial_flow: mean_speed / scale,
        sliding: wall_speed.abs() / (2.0 * scale),
    };
    // Start from the viscosity at the wall's total shear rate.
    let shear_rate = 1_f64.hypot(slot.sliding);
    let viscosity =
        rheology.stress(axial.wall_shear_rate * shear_rate) / axial.wall_shear_stress / shear_rate;
    slot.solve([viscosity, viscosity * slot.sliding])[0].min(1.0)
}

/// The helical slot in units of its own flow without rotation: stresses by tau_w, rates by gamma_w, lengths
/// by the half gap. The unknowns are (G H, tau_theta) / tau_w. They make a convex function stationary, the
/// dissipation potential less the power of the flow and of the moving wall.
struct HelicalSlot {
    yield_stress: f64,
    inverse_index: f64,
    /// U / (H gamma_w).
    axial_flow: f64,
    /// V / (2 H gamma_w).
    sliding: f64,
}

/// Gradient and Hessian of the potential.
struct Derivatives {
    gradient: [f64; 2],
    hessian: [[f64; 2]; 2],
}

impl HelicalSlot {
    /// Newton's method with backtracking on the slope along the step, which convexity makes converge.
    fn solve(&self, start: [f64; 2]) -> [f64; 2] {
        let mut at = start;
        let Some(mut here) = self.derivatives(at) else { return at };
        for _ in 0..60 {
            let [[a, b], [_, d]] = here.hessian;
            let determinant = a * d - b * b;
            let [g, h] = here.gradient;
            let step = [(b * h - d * g) / determinant, (b * g - a * h) / determinant];
            let slope_along = |gradient: [f64; 2]| (gradient[0] * step[0] + gradient[1] * step[1]).abs();
            let mut fraction = 1.0;
            loop {
                let trial = [at[0] + fraction * step[0], at[1] + fraction * step[1]];
                if let Some(there) = self.derivatives(trial)
                    && (slope_along(there.gradient) < slope_along(here.gradient) || fraction < 1e-6)
                {
                    at = trial;
                    here = there;
                    break;
                }
                if fraction < 1e-12 {
                    return at;
                }
                fraction *= 0.5;
            }
            if step[0].hypot(step[1]) <= 8.0 * f64::EPSILON * at[0].hypot(at[1]) {
                break;
            }
        }
        at
    }

    /// Derivatives of the potential; `None` if no part of the gap is sheared.
    fn derivatives(&self, [gradient, tangential]: [f64; 2]) -> Option<Derivatives> {
        let plug = if tangential.abs() < self.yield_stress {
            (self.yield_stress.powi(2) - tangential.powi(2)).sqrt() / gradient.abs()
        } else {
            0.0
        };
        if plug >= 1.0 || plug.is_nan() {
            return None;
        }
        let mut sums = Derivatives { gradient: [-self.axial_flow, -self.sliding], hessian: [[0.0; 2]; 2] };
        for (node, weight) in GAUSS_20.iter().flat_map(|&(x, w)| [(-x, w), (x, w)]) {
            // Squared, the variable crowds the nodes at the plug, where the integrand is least smooth.
            let s = 0.5 * (1.0 + node);
            let y = plug + (1.0 - plug) * s * s;
            let weight = weight * s * (1.0 - plug);
            let stress = (gradient * y).hypot(tangential);
            let excess = stress - self.yield_stress;
            if excess <= 0.0 {
                continue;
            }
            let rate = (excess / (1.0 - self.yield_stress)).powf(self.inverse_index);
            let fluidity = rate / stress;
            let bend = (self.inverse_index * rate / excess - fluidity) / (stress * stress);
            let axial = gradient * y * y;
            sums.gradient[0] += weight * fluidity * axial;
            sums.gradient[1] += weight * fluidity * tangential;
            sums.hessian[0][0] += weight * (fluidity * y * y + bend * axial * axial);
            sums.hessian[0][1] += weight * bend * axial * tangential;
            sums.hessian[1][1] += weight * (fluidity + bend * tangential * tangential);
        }
        sums.hessian[1][0] = sums.hessian[0][1];
        Some(sums)
    }
}

/// Positive nodes and weights of the 20-point Gauss-Legendre rule on \[-1, 1\].
const GAUSS_20: [(f64, f64); 10] = [
    (0.07652652113349734, 0.15275338713072584),
    (0.22778585114164507, 0.14917298647260374),
    (0.37370608871541955, 0.14209610931838204),
    (0.5108670019508271, 0.13168863844917664),
    (0.636053680726515, 0.11819453196151841),
    (0.7463319064601508, 0.10193011981724044),
    (0.8391169718222188, 0.08327674157670475),
    (0.912234428251326, 0.06267204833410907),
    (0.9639719272779138, 0.04060142980038694),
    (0.9931285991850949, 0.017614007139152118),
];

#[cfg(test)]
mod tests {
    use super::super::slot::slot_flow;
    use super::*;

    const MUD: Rheology = Rheology { yield_stress: 0.29, consistency: 0.07, flow_index: 0.55 };
    const GAP: f64 = 0.0889;

    fn factor(rheology: &Rheology, mean_speed: f64, wall_speed: f64) -> f64 {
        let axial = slot_flow(rheology, mean_speed, GAP);
        rotation_factor(rheology, &axial, mean_speed, GAP / 4.0, wall_speed)
    }

    #[test]
    fn a_newtonian_fluid_does_not_feel_rotation() {
        let water = Rheology { yield_stress: 0.0, consistency: 1e-3, flow_index: 1.0 };
        assert!((factor(&water, 0.4, 3.0) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn slow_rotation_changes_nothing() {
        // The factor departs from 1 as the square of the wall speed.
        assert!((1.0 - factor(&MUD, 0.4, 1e-5)).abs() < 1e-8);
        assert_eq!(factor(&MUD, 0.4, 0.8), factor(&MUD, 0.4, -0.8));
    }

    #[test]
    fn fast_rotation_leaves_the_viscosity_of_the_couette_flow() {
        // With U << V the stress is uniform, mu = tau(gamma_c) / gamma_c at gamma_c = V / 2H, and the axial flow is
        // the Newtonian G = 3 mu U / H^2. The remainder is of second order in U / V.
        let (wall_speed, half_gap) = (10.0, GAP / 4.0);
        for rheology in [MUD, Rheology { yield_stress: 0.0, ..MUD }, Rheology { flow_index: 0.2, ..MUD }] {
            let couette = wall_speed / (2.0 * half_gap);
            let viscosity = rheology.stress(couette) / couette;
            let error = |speed: f64| {
                let gradient = 3.0 * viscosity * speed / half_gap.powi(2);
                let alone = slot_flow(&rheology, speed, GAP).wall_shear_stress / half_gap;
                factor(&rheology, speed, wall_speed) / (gradient / alone) - 1.0
            };
            assert!(error(0.01).abs() < 1e-3, "{:e}", error(0.01));
            assert!((error(0.01) / error(0.005) - 4.0).abs() < 0.01, "{}", error(0.01) / error(0.005));
        }
    }

    #[test]
    fn solution_satisfies_both_flow_conditions_under_a_finer_rule() {
        // The midpoint rule in the plain variable, second order: 2e5 cells leave about 1e-9. The firmer mud has a plug in the middle, which rotation
        // does not break up.
        let firm = Rheology { yield_stress: 3.0, ..MUD };
        for (rheology, wall_speed, has_plug) in [(MUD, 0.798, false), (firm, 0.1, true)] {
            let (speed, half_gap) = (0.4177, GAP / 4.0);
            let axial = slot_flow(&rheology, speed, GAP);
            let slot = HelicalSlot {
                yield_stress: rheology.yield_stress / axial.wall_shear_stress,
                inverse_index: 1.0 / rheology.flow_index,
                axial_flow: speed / (half_gap * axial.wall_shear_rate),
                sliding: wall_speed / (2.0 * half_gap * axial.wall_shear_rate),
            };
            let [gradient, tangential] = slot.solve([1.0, 0.3]);
            let (gradient, tangential) =
                (gradient * axial.wall_shear_stress / half_gap, tangential * axial.wall_shear_stress);
            assert_eq!(tangential < rheology.yield_stress, has_plug);
            let cells = 200_000;
            let dy = half_gap / f64::from(cells);
            let (mut flow, mut sliding) = (0.0, 0.0);
            for cell in 0..cells {
                let y = (f64::from(cell) + 0.5) * dy;
                let stress = (gradient * y).hypot(tangential);
                let fluidity = rheology.shear_rate(stress) / stress;
                flow += fluidity * gradient * y * y * dy / half_gap;
                sliding += 2.0 * fluidity * tangential * dy;
            }
            assert!((flow / speed - 1.0).abs() < 1e-8, "{:e}", flow / speed - 1.0);
            assert!((sliding / wall_speed - 1.0).abs() < 1e-8, "{:e}", sliding / wall_speed - 1.0);
        }
    }
}
