//! Friction of a yield-power-law mud by the formulas of API RP 13D (fifth edition 2006, sixth 2010).
//!
//! With alpha = 0 in a pipe and 1 in an annulus, and the hydraulic diameter D of either:
//! G = ((3 - alpha) n + 1) / ((4 - alpha) n) (1 + alpha / 2), gamma_w = 8 U G / D, tau_w = ((4 - alpha) / (3 - alpha))^n tau_y + K gamma_w^n,
//! N = 8 rho U^2 / tau_w, N_c = 3470 - 1370 n; f_lam = 16 / N, f_trans = 16 N / N_c^2, f_turb = a / N^b with a = (log10 n + 3.93) / 50 and
//! b = (1.75 - log10 n) / 7; f_int = (f_trans^-8 + f_turb^-8)^(-1/8), f = (f_int^12 + f_lam^12)^(1/12). The string is concentric and does not
//! turn. The factor of the viscometer's gap is 1, as the standard allows.

use drillsweep_scenario::{Mud, RegimeChoice};

use super::error::{MudError, check};
use super::geometry::FlowGeometry;
use super::rheology::Rheology;

/// Least flow index of the constants a and b, below which a would change its sign.
const LEAST_INDEX: f64 = 0.01;

/// Flow through a conduit by API RP 13D.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rp13dFlow {
    /// Mean speed U \[m/s\].
    pub speed: f64,
    /// Stress at the wall tau_w that laminar flow would have \[Pa\].
    pub wall_shear_stress: f64,
    /// Generalised Reynolds number N_ReG = 8 rho U^2 / tau_w.
    pub reynolds_number: f64,
    /// Fanning friction factor.
    pub fanning: f64,
    /// Pressure lost to friction 2 f rho U^2 / D \[Pa/m\].
    pub friction_gradient: f64,
}

impl Rp13dFlow {
    /// Flow in the annulus around a concentric pipe.
    ///
    /// # Errors
    /// A mud property is out of its range, or a result is not finite.
    pub fn annulus(mud: &Mud, geometry: &FlowGeometry) -> Result<Self, MudError> {
        let hydraulic_diameter = geometry.hole_diameter - geometry.outer_diameter;
        Self::through(mud, geometry.annulus_speed(mud.flow_rate), hydraulic_diameter, 1.0)
    }

    /// Flow in a pipe of a diameter \[m\].
    ///
    /// # Errors
    /// As [`Rp13dFlow::annulus`].
    pub fn pipe(mud: &Mud, diameter: f64) -> Result<Self, MudError> {
        let area = std::f64::consts::FRAC_PI_4 * diameter * diameter;
        Self::through(mud, mud.flow_rate / area, diameter, 0.0)
    }

    fn through(mud: &Mud, speed: f64, diameter: f64, alpha: f64) -> Result<Self, MudError> {
        let rheology = Rheology::new(mud)?;
        let density = check("mud density", mud.density, "positive", mud.density > 0.0)?;
        check("flow rate", mud.flow_rate, "0 or more", mud.flow_rate >= 0.0)?;
        check("hydraulic diameter", diameter, "positive", diameter > 0.0)?;
        if speed == 0.0 {
            return Ok(Self::default());
        }
        let n = rheology.flow_index;
        let correction = ((3.0 - alpha) * n + 1.0) / ((4.0 - alpha) * n) * (1.0 + 0.5 * alpha);
        let shear_rate = 8.0 * speed / diameter * correction;
        let plug = ((4.0 - alpha) / (3.0 - alpha)).powf(n) * rheology.yield_stress;
        let wall_shear_stress = plug + rheology.consistency * shear_rate.powf(n);
        let reynolds_number = 8.0 * density * speed * speed / wall_shear_stress;
        let fanning = match mud.regime {
            RegimeChoice::Auto => fanning(reynolds_number, n),
            RegimeChoice::Laminar => 16.0 / reynolds_number,
        };
        let friction_gradient = 2.0 * fanning * density * speed * speed / diameter;
        if friction_gradient.is_finite() {
            Ok(Self { speed, wall_shear_stress, reynolds_number, fanning, friction_gradient })
        } else {
            Err(MudError::NotFinite("friction gradient by API RP 13D"))
        }
    }
}

/// Fanning factor over all regimes.
fn fanning(reynolds_number: f64, n: f64) -> f64 {
    let critical = 3470.0 - 1370.0 * n;
    let laminar = 16.0 / reynolds_number;
    let transitional = 16.0 * reynolds_number / (critical * critical);
    let log = n.max(LEAST_INDEX).log10();
    let turbulent = (log + 3.93) / 50.0 / reynolds_number.powf((1.75 - log) / 7.0);
    // By ratios of the smaller to the larger, whose powers do not overflow.
    let (least, most) = (transitional.min(turbulent), transitional.max(turbulent));
    let beyond_laminar = least * (1.0 + (least / most).powi(8)).powf(-0.125);
    let (least, most) = (beyond_laminar.min(laminar), beyond_laminar.max(laminar));
    most * (1.0 + (least / most).powi(12)).powf(1.0 / 12.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INCH: f64 = 0.0254;
    const FOOT: f64 = 0.3048;
    const PSI: f64 = 6_894.757_293_168;
    const PPG: f64 = 119.826_427_3;
    const GPM: f64 = 6.309_019_64e-5;
    /// lbf/100 ft2.
    const FIELD_STRESS: f64 = 0.478_802_589_8;

    fn mud(density: f64, flow_rate: f64, [yield_stress, consistency, flow_index]: [f64; 3]) -> Mud {
        Mud {
            density,
            flow_rate,
            yield_stress,
            consistency,
            flow_index,
            regime: RegimeChoice::Auto,
            rotation_factor: false,
            viscosity_eccentricity: false,
            bit_pressure_drop: 0.0,
            back_pressure: 0.0,
        }
    }

    fn annulus(hole: f64, outer: f64) -> FlowGeometry {
        FlowGeometry { hole_diameter: hole, outer_diameter: outer, inner_diameter: 0.5 * outer }
    }

    #[track_caller]
    fn assert_near(value: f64, expected: f64, tolerance: f64) {
        assert!((value / expected - 1.0).abs() < tolerance, "{value}, not {expected}");
    }

    #[test]
    fn a_newtonian_fluid_has_the_exact_laminar_losses_of_pipe_and_slot() {
        let oil = Mud { regime: RegimeChoice::Laminar, ..mud(900.0, 1e-3, [0.0, 0.05, 1.0]) };
        // Hagen and Poiseuille, 32 mu U / D^2, and the plane slot, 12 mu U / h^2 with D_h = 2 h.
        let pipe = Rp13dFlow::pipe(&oil, 0.1).unwrap();
        assert_near(pipe.friction_gradient, 32.0 * 0.05 * pipe.speed / 0.01, 1e-14);
        let slot = Rp13dFlow::annulus(&oil, &annulus(0.2, 0.16)).unwrap();
        assert_near(slot.friction_gradient, 12.0 * 0.05 * slot.speed / (0.02 * 0.02), 1e-14);
        // The blend of the regimes adds less than 1e-10 where the flow is laminar.
        let blend = Rp13dFlow::pipe(&Mud { regime: RegimeChoice::Auto, ..oil }, 0.1).unwrap();
        assert!(blend.reynolds_number < 300.0);
        assert_near(blend.friction_gradient, pipe.friction_gradient, 1e-10);
    }

    #[test]
    fn a_power_law_fluid_has_the_exact_laminar_losses_of_pipe_and_slot() {
        let thin = Mud { regime: RegimeChoice::Laminar, ..mud(1200.0, 5e-3, [0.0, 0.4, 0.6]) };
        // Q = pi n R^3 / (3 n + 1) (G R / 2 K)^(1/n) and U = n h / (2 (2 n + 1)) (G h / 2 K)^(1/n), solved for G.
        let (n, k): (f64, f64) = (0.6, 0.4);
        let radius: f64 = 0.05;
        let pipe = Rp13dFlow::pipe(&thin, 2.0 * radius).unwrap();
        let rate = 5e-3 * (3.0 * n + 1.0) / (std::f64::consts::PI * n * radius.powi(3));
        assert_near(pipe.friction_gradient, 2.0 * k / radius * rate.powf(n), 1e-13);
        let gap: f64 = 0.02;
        let slot = Rp13dFlow::annulus(&thin, &annulus(0.2, 0.16)).unwrap();
        let rate = slot.speed * 2.0 * (2.0 * n + 1.0) / (n * gap);
        assert_near(slot.friction_gradient, 2.0 * k / gap * rate.powf(n), 1e-13);
    }

    #[test]
    fn a_published_example_of_the_power_law_has_its_losses() {
        // Hydraulics of a well of 335 gal/min and 12.8 lb/gal, worked by hand with the formulas of RP 13D for power-law muds: 4 1/2 in pipe of
        // 3.826 in with n = 0.64 and K = 3.21 dyn s^n/cm2 over 11,641 ft, and the annulus in 8 5/8 in with n = 0.275 and K = 26.1 over 855 ft.
        // They print speeds of 560.23 and 151.47 ft/min, f = 0.006025 and 0.02342, and losses of 792.6 and 15.34 psi.
        let bore = Rp13dFlow::pipe(&mud(12.8 * PPG, 335.0 * GPM, [0.0, 0.321, 0.64]), 3.826 * INCH).unwrap();
        assert_near(bore.speed * 60.0 / FOOT, 560.23, 2e-3);
        assert_near(bore.reynolds_number, 8_667.0, 3e-3);
        assert_near(bore.fanning, 0.006_025, 2e-3);
        assert_near(bore.friction_gradient * 11_641.0 * FOOT / PSI, 792.6, 5e-3);
        let around = Rp13dFlow::annulus(
            &mud(12.8 * PPG, 335.0 * GPM, [0.0, 2.61, 0.275]),
            &annulus(8.625 * INCH, 4.5 * INCH),
        )
        .unwrap();
        assert_near(around.speed * 60.0 / FOOT, 151.47, 2e-3);
        assert_near(around.fanning, 0.023_42, 4e-3);
        assert_near(around.friction_gradient * 855.0 * FOOT / PSI, 15.34, 3e-3);
    }

    #[test]
    fn losses_of_a_yield_power_law_mud_are_those_of_the_field_units() {
        // The same formulas in gal/min, lb/gal, in, ft/min and lbf/100 ft2 with their constants of four digits (24.51, 1.6, 19.36, 1.076e-5), by a
        // program of its own: 5 in pipe of 4.276 in in 8 1/2 in at 500 gal/min and 10.5 lb/gal, over 1,000 ft.
        let (stress, k, n) = (2.728 / FIELD_STRESS, 0.1179 / FIELD_STRESS, 0.794_f64);
        let field = |diameter: f64, speed: f64, alpha: f64| {
            let rate = 1.6 * ((3.0 - alpha) * n + 1.0) / ((4.0 - alpha) * n) * (1.0 + alpha / 2.0) * speed
                / diameter;
            let wall = ((4.0 - alpha) / (3.0 - alpha)).powf(n) * stress + k * rate.powf(n);
            let re = 10.5 * speed * speed / (19.36 * wall);
            let turbulent = (n.log10() + 3.93) / 50.0 / re.powf((1.75 - n.log10()) / 7.0);
            let transitional = 16.0 * re / (3470.0 - 1370.0 * n).powi(2);
            let between = (transitional.powi(-8) + turbulent.powi(-8)).powf(-0.125);
            let f = (between.powi(12) + (16.0 / re).powi(12)).powf(1.0 / 12.0);
            1.076e-5 * 10.5 * speed * speed * f * 1000.0 / diameter
        };
        let mud = mud(10.5 * PPG, 500.0 * GPM, [2.728, 0.1179, n]);
        let pipe = Rp13dFlow::pipe(&mud, 4.276 * INCH).unwrap();
        let speed = 24.51 * 500.0 / 4.276_f64.powi(2);
        assert_near(pipe.friction_gradient * 1000.0 * FOOT / PSI, field(4.276, speed, 0.0), 2e-3);
        let around = Rp13dFlow::annulus(&mud, &annulus(8.5 * INCH, 5.0 * INCH)).unwrap();
        let speed = 24.51 * 500.0 / (8.5_f64.powi(2) - 25.0);
        assert_near(around.friction_gradient * 1000.0 * FOOT / PSI, field(3.5, speed, 1.0), 2e-3);
    }

    #[test]
    fn friction_is_smooth_through_the_regimes_and_falls_in_none_of_them_below_its_parts() {
        for n in [0.3, 0.55, 0.8, 1.0, 1.3] {
            let critical = 3470.0 - 1370.0 * n;
            let at = |re: f64| fanning(re, n);
            for limit in [critical, critical + 800.0] {
                let step = 1e-6 * limit;
                let slope = (at(limit + step) - at(limit - step)) / (2.0 * step);
                let (above, below) =
                    ((at(limit + step) - at(limit)) / step, (at(limit) - at(limit - step)) / step);
                assert!((above - below).abs() < 1e-3 * slope.abs().max(1e-9), "{n} {above} {below}");
            }
            // Far from the transition one branch is left.
            assert_near(at(100.0), 0.16, 1e-6);
            let re = 1e5_f64;
            assert_near(at(re), (n.log10() + 3.93) / 50.0 / re.powf((1.75 - n.log10()) / 7.0), 1e-6);
        }
        for re in [1e-200, 1e-20, 1e30] {
            assert!(fanning(re, 0.5).is_finite());
        }
    }

    #[test]
    fn still_mud_loses_nothing() {
        let still = mud(1200.0, 0.0, [5.0, 0.5, 0.6]);
        assert_eq!(Rp13dFlow::pipe(&still, 0.1), Ok(Rp13dFlow::default()));
        assert!(Rp13dFlow::pipe(&Mud { density: -1.0, ..still }, 0.1).is_err());
    }
}
