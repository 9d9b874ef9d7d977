//! Pressures lost outside of the string's friction: at the nozzles of the bit and in the lines on the surface.

use drillsweep_scenario::{Hydraulics, Mud, PressureLosses};

use super::error::{MudError, check};
use super::losses::bore_gradient;

/// A psi \[Pa\], a lb/gal \[kg/m3\] and 100 gal/min \[m3/s\], in which the coefficients of surface equipment are published.
const PSI: f64 = 4.448_221_615_260_5 / (0.0254 * 0.0254);
const PPG: f64 = 0.453_592_37 / 0.003_785_411_784;
const HUNDRED_GPM: f64 = 0.378_541_178_4 / 60.0;

/// Coefficients C_sc of surface equipment, cases 1 to 4 (API RP 13D, 2006), in psi, lb/gal and 100 gal/min.
const SURFACE_COEFFICIENTS: [f64; 4] = [1.0, 0.36, 0.22, 0.15];

/// Exponent of the flow rate in the loss of surface equipment (API RP 13D).
const SURFACE_EXPONENT: f64 = 1.86;

/// Number of cases of surface equipment.
pub const SURFACE_CASES: u32 = SURFACE_COEFFICIENTS.len() as u32;

/// Pressures lost in the circuit next to friction along the string \[Pa\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CircuitLosses {
    /// At the bit: given, or through its nozzles, rho Q^2 / (2 C_d^2 A^2).
    pub bit: f64,
    /// Over tools in the string.
    pub tools: f64,
    /// In the lines on the surface.
    pub surface: f64,
}

impl CircuitLosses {
    /// Losses of a mud; surface lines given by their length follow the formulas `losses`.
    ///
    /// # Errors
    /// A mud property is out of its range, or a loss is not finite.
    pub fn new(mud: &Mud, hydraulics: &Hydraulics, losses: PressureLosses) -> Result<Self, MudError> {
        let bit = match hydraulics.flow_area() {
            Some(area) => nozzle_loss(mud.density, mud.flow_rate, area, hydraulics.discharge_coefficient),
            None => mud.bit_pressure_drop,
        };
        let case = hydraulics.surface_case.and_then(|case| usize::try_from(case).ok()?.checked_sub(1));
        let surface = match case.and_then(|case| SURFACE_COEFFICIENTS.get(case)) {
            Some(coefficient) => surface_loss(mud.density, mud.flow_rate, *coefficient),
            None if hydraulics.surface_length > 0.0 => {
                hydraulics.surface_length * bore_gradient(mud, hydraulics.surface_diameter, losses)?
            }
            None => 0.0,
        };
        for (quantity, value) in [("pressure drop at the bit", bit), ("loss in the surface lines", surface)] {
            check(quantity, value, "finite", true)?;
        }
        Ok(Self { bit, tools: hydraulics.tool_pressure_drop, surface })
    }
}

/// Pressure lost through nozzles, rho Q^2 / (2 C_d^2 A^2) \[Pa\], of a density \[kg/m3\], flow rate \[m3/s\] and area \[m2\].
fn nozzle_loss(density: f64, flow_rate: f64, area: f64, discharge_coefficient: f64) -> f64 {
    0.5 * density * (flow_rate / (discharge_coefficient * area)).powi(2)
}

/// Pressure lost in surface equipment, C_sc rho Q^1.86 \[Pa\].
fn surface_loss(density: f64, flow_rate: f64, coefficient: f64) -> f64 {
    coefficient * PSI * (density / PPG) * (flow_rate / HUNDRED_GPM).powf(SURFACE_EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use drillsweep_scenario::preset;

    #[test]
    fn nozzles_lose_what_the_field_formula_gives() {
        // rho Q^2 / (12032 C_d^2 TFA^2) in psi, lb/gal, gal/min and in2; by the defined sizes of these units the constant is 12034.
        let (density, flow, area) = (11.5 * PPG, 8.03 * HUNDRED_GPM, 0.69 * 0.0254 * 0.0254);
        for discharge in [0.95_f64, 1.0, 0.82] {
            let field = 11.5 * 803.0_f64.powi(2) / (12_032.0 * discharge.powi(2) * 0.69_f64.powi(2));
            let loss = nozzle_loss(density, flow, area, discharge) / PSI;
            assert!((loss / field - 1.0).abs() < 2e-4, "{loss} {field}");
        }
        // An example of a mud engineers' manual: 803 gal/min, 11.5 lb/gal and 0.69 in2 with C_d = 0.95 lose 1,435 psi.
        assert!((nozzle_loss(density, flow, area, 0.95) / PSI - 1_435.0).abs() < 1.0);
    }

    #[test]
    fn cases_of_surface_equipment_agree_with_two_other_tables() {
        // IADC: 1e-5 k rho Q^1.86 in psi, lb/gal and gal/min with k = 19, 7, 4 and 3, which have one digit.
        for (coefficient, k) in SURFACE_COEFFICIENTS.iter().zip([19.0, 7.0, 4.0, 3.0]) {
            let iadc = 1e-5 * k * 10.0 * 500.0_f64.powf(1.86);
            let loss = surface_loss(10.0 * PPG, 5.0 * HUNDRED_GPM, *coefficient) / PSI;
            assert!((loss - iadc).abs() < 1e-5 * 0.5 * 10.0 * 500.0_f64.powf(1.86), "{loss} {iadc}");
        }
        // Equivalent lengths of 3.826 in pipe are 2,600, 946, 610 and 424 ft in a mud engineers' manual: the same cases within a tenth of each other,
        // but half as much more than these coefficients in a usual mud, as one of its examples has it: 41.53 psi of case 3 at 335 gal/min
        // and 12.8 lb/gal with n = 0.64 and K = 3.21 dyn s^n/cm2.
        for (coefficient, feet) in SURFACE_COEFFICIENTS.iter().zip([2_600.0, 946.0, 610.0, 424.0]) {
            assert!((feet / 2_600.0 / coefficient - 1.0_f64).abs() < 0.1, "{feet}");
        }
        let mud = preset("paper-200m").unwrap().mud.unwrap();
        let mud = Mud {
            density: 12.8 * PPG,
            flow_rate: 3.35 * HUNDRED_GPM,
            yield_stress: 0.0,
            consistency: 0.321,
            flow_index: 0.64,
            ..mud
        };
        let lines = Hydraulics { surface_length: 610.0 * 0.3048, ..preset("paper-200m").unwrap().hydraulics };
        let equivalent = CircuitLosses::new(&mud, &lines, PressureLosses::Rp13d).unwrap().surface / PSI;
        assert!((equivalent / 41.53 - 1.0).abs() < 5e-3, "{equivalent}");
        let loss = surface_loss(mud.density, mud.flow_rate, SURFACE_COEFFICIENTS[2]) / PSI;
        assert!((equivalent / loss - 1.5).abs() < 0.1, "{equivalent} of {loss}");
    }

    #[test]
    fn a_bit_without_nozzles_loses_what_is_given() {
        let mut scenario = preset("paper-200m").unwrap();
        let mud = Mud { bit_pressure_drop: 3e6, ..scenario.mud.unwrap() };
        let of = |hydraulics: &Hydraulics| CircuitLosses::new(&mud, hydraulics, PressureLosses::Eccentric);
        assert_eq!(of(&scenario.hydraulics), Ok(CircuitLosses { bit: 3e6, ..CircuitLosses::default() }));
        scenario.hydraulics.nozzles = vec![0.01; 3];
        scenario.hydraulics.tool_pressure_drop = 1e6;
        scenario.hydraulics.surface_length = 100.0;
        let found = of(&scenario.hydraulics).unwrap();
        assert!(found.bit > 0.0 && found.bit != 3e6 && found.tools == 1e6 && found.surface > 0.0);
    }
}
