//! Pressure losses of the mud's circuit: their formulas, the bit's nozzles, and the lines on the surface.

use serde::{Deserialize, Serialize};

/// Discharge coefficient of bit nozzles (API RP 13D).
const NOZZLE_DISCHARGE: f64 = 0.95;

/// Inner diameter of the pipe in which surface lines are customarily expressed \[m\], 3.826 in.
const SURFACE_DIAMETER: f64 = 3.826 * 0.0254;

/// The pressures of the mud's circuit (docs/model/hydraulics.md). They are reported and move nothing: damping, drag and the friction
/// coefficient C_f follow `mud` whatever stands here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Hydraulics {
    /// Formulas of the reported pressures: `eccentric` (a string that lies in its hole as the equilibrium found it), `concentric` (the same
    /// friction with the string in the middle) or `rp13d` (API RP 13D, concentric); absent means `eccentric`. A string on the low side loses
    /// about half of the pressure of a concentric one in the annulus, so that `eccentric` gives the lowest equivalent circulating density.
    #[serde(default)]
    pub losses: PressureLosses,
    /// Diameters of the bit's nozzles \[m\], at most 24, each at most 0.1; none unless given. Usual 0.006 to 0.02 (8/32 to 24/32 in). In
    /// place of `mud.bit_pressure_drop`: the loss grows with the square of the flow rate.
    #[serde(default)]
    pub nozzles: Vec<f64>,
    /// Total flow area of the bit's nozzles \[m2\] in place of their diameters, above 0 and at most 0.1; absent means that of `nozzles`.
    /// Usual 2e-4 to 1e-3 (0.3 to 1.5 in2). Half of the area takes four times the pressure.
    #[serde(default)]
    pub nozzle_area: Option<f64>,
    /// Discharge coefficient of the nozzles C_d, 0.5 to 1.2; 0.95 unless given, that of API RP 13D; 0.98 to 1.03 were measured at modern
    /// bits. The loss goes with 1 / C_d^2.
    #[serde(default = "nozzle_discharge")]
    pub discharge_coefficient: f64,
    /// Pressure drop over motor, turbine, telemetry and other tools in the string \[Pa\] at the scenario's flow rate, 0 or more; 0 unless
    /// given, usual 5e5 to 8e6; above 1.1e8 is warned of. It raises the standpipe pressure by as much.
    #[serde(default)]
    pub tool_pressure_drop: f64,
    /// Surface equipment (standpipe, hose, swivel, kelly) as a case of API RP 13D and IADC, 1 to 4, from the narrowest to the widest; absent
    /// means none. Its loss is part of the standpipe pressure alone.
    #[serde(default)]
    pub surface_case: Option<u32>,
    /// Length of the surface lines \[m\] as pipe of `surface_diameter`, in place of a case, 0 to 10000; 0 unless given, usual 50 to 300.
    #[serde(default)]
    pub surface_length: f64,
    /// Inner diameter of the surface lines \[m\], above 0 and at most 0.5; 0.0971804 (3.826 in) unless given, the pipe in which surface
    /// lines are customarily expressed. The loss goes with about its power of -4.8.
    #[serde(default = "surface_diameter")]
    pub surface_diameter: f64,
}

impl Default for Hydraulics {
    fn default() -> Self {
        Self {
            losses: PressureLosses::default(),
            nozzles: Vec::new(),
            nozzle_area: None,
            discharge_coefficient: NOZZLE_DISCHARGE,
            tool_pressure_drop: 0.0,
            surface_case: None,
            surface_length: 0.0,
            surface_diameter: SURFACE_DIAMETER,
        }
    }
}

impl Hydraulics {
    /// Total flow area of the nozzles \[m2\]; absent without nozzles.
    pub fn flow_area(&self) -> Option<f64> {
        let of_diameters = || self.nozzles.iter().map(|d| std::f64::consts::FRAC_PI_4 * d * d).sum();
        self.nozzle_area.or_else(|| (!self.nozzles.is_empty()).then(of_diameters))
    }
}

fn nozzle_discharge() -> f64 {
    NOZZLE_DISCHARGE
}

fn surface_diameter() -> f64 {
    SURFACE_DIAMETER
}

/// Formulas of pressure losses: `eccentric`, `concentric` or `rp13d`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PressureLosses {
    /// Friction of the model at the string's eccentricity in the equilibrium.
    #[default]
    Eccentric,
    /// Friction of the model with the string in the middle of the hole.
    Concentric,
    /// Formulas of API RP 13D (2006, 2010) for a yield-power-law mud and a string in the middle.
    Rp13d,
}

impl PressureLosses {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Eccentric, Self::Concentric, Self::Rp13d];

    /// The name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eccentric => "eccentric",
            Self::Concentric => "concentric",
            Self::Rp13d => "rp13d",
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::preset;

    #[test]
    fn losses_have_the_names_of_the_documents() {
        for losses in PressureLosses::ALL {
            assert_eq!(serde_json::to_value(losses).unwrap(), json!(losses.name()));
        }
    }

    #[test]
    fn absent_fields_are_the_defaults() {
        let read: Hydraulics = serde_json::from_value(json!({})).unwrap();
        assert_eq!(read, Hydraulics::default());
        assert_eq!(preset("paper-200m").unwrap().hydraulics, Hydraulics::default());
    }

    #[test]
    fn nozzles_are_written_in_field_units_and_make_an_area() {
        let nozzles = json!(["16/32 in", "16/32 in", "16/32 in"]);
        let scenario = preset("paper-200m").unwrap().with("hydraulics.nozzles", nozzles).unwrap();
        // Three 16s have 0.589 in2 in every table of nozzles.
        let area = scenario.hydraulics.flow_area().unwrap() / (0.0254 * 0.0254);
        assert!((area - 0.589).abs() < 5e-4, "{area}");
        let given = scenario.with("hydraulics.nozzle_area", json!("0.69 in2")).unwrap();
        assert!((given.hydraulics.flow_area().unwrap() / 4.4516e-4 - 1.0).abs() < 1e-4);
    }
}
