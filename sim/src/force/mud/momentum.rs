//! Mass and momentum of the two flows past a section, and the annulus' added mass.

use drillsweep_scenario::Mud;

use super::damping::added_mass_coefficient;
use super::geometry::FlowGeometry;

/// Masses and momentum fluxes of the two flows past one section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowMomentum {
    /// M_f U_i^2 \[N\].
    pub bore_flux: f64,
    /// rho_f A_o U_o^2 \[N\].
    pub annulus_flux: f64,
    /// Mass of mud in the bore per length M_f \[kg/m\].
    pub bore_mass: f64,
    /// Mass displaced per length rho_f A_o \[kg/m\].
    pub displaced_mass: f64,
    /// Added mass coefficient chi, equation (28).
    pub added_mass_coefficient: f64,
    /// Coriolis coefficient 2 M_f U_i - 2 chi rho_f A_o U_o \[kg/s\].
    pub coriolis: f64,
}

impl FlowMomentum {
    /// The fluxes for the mean speeds of `mud` past a section.
    pub fn new(mud: &Mud, geometry: &FlowGeometry) -> Self {
        let [bore_area, displaced_area] = [geometry.bore_area(), geometry.displaced_area()];
        let bore_mass = mud.density * bore_area;
        let displaced_mass = mud.density * displaced_area;
        let bore_speed = if bore_area > 0.0 { mud.flow_rate / bore_area } else { 0.0 };
        let annulus_speed = geometry.annulus_speed(mud.flow_rate);
        let chi = added_mass_coefficient(geometry);
        Self {
            bore_flux: bore_mass * bore_speed * bore_speed,
            annulus_flux: displaced_mass * annulus_speed * annulus_speed,
            bore_mass,
            displaced_mass,
            added_mass_coefficient: chi,
            coriolis: 2.0 * (bore_mass * bore_speed - chi * displaced_mass * annulus_speed),
        }
    }

    /// Mass of mud that moves sideways with the string, inside and outside \[kg/m\].
    pub fn lateral_mass(&self) -> f64 {
        self.bore_mass + self.added_mass_coefficient * self.displaced_mass
    }

    /// M_f U_i^2 + chi rho_f A_o U_o^2 \[N\]: reduction by the flows of the tension that holds the string straight.
    pub fn lateral_flux(&self) -> f64 {
        self.bore_flux + self.added_mass_coefficient * self.annulus_flux
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use drillsweep_scenario::preset;

    use super::*;

    /// Diameters of areas of 1/4, 2 and 5 m2: the annulus has 3 m2.
    #[test]
    fn both_flows_carry_the_mass_of_the_flow_rate() {
        let diameter = |area: f64| (4.0 * area / PI).sqrt();
        let geometry = FlowGeometry {
            hole_diameter: diameter(5.0),
            outer_diameter: diameter(2.0),
            inner_diameter: diameter(0.25),
        };
        let mud = Mud {
            density: 3.0,
            flow_rate: 0.6,
            ..preset("paper-200m").expect("a preset").mud.expect("a mud")
        };
        // U_i = 0.6 / (1/4) = 2.4 m/s, U_o = 0.6 / 3 = 0.2 m/s, chi = (5 + 2) / (5 - 2).
        let momentum = FlowMomentum::new(&mud, &geometry);
        for (found, expected) in [
            (momentum.bore_mass, 0.75),
            (momentum.displaced_mass, 6.0),
            (momentum.bore_flux, 0.75 * 2.4 * 2.4),
            (momentum.annulus_flux, 6.0 * 0.2 * 0.2),
            (momentum.added_mass_coefficient, 7.0 / 3.0),
            (momentum.coriolis, 2.0 * (0.75 * 2.4 - 14.0 * 0.2)),
            (momentum.lateral_mass(), 0.75 + 14.0),
            (momentum.lateral_flux(), 0.75 * 2.4 * 2.4 + 14.0 * 0.2 * 0.2),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-14, "{found} instead of {expected}");
        }
    }
}
