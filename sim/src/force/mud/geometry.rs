//! Geometry of the flow past a section.

use std::f64::consts::FRAC_PI_4;

use crate::string::beam::BeamSection;

/// Diameters for the flow of mud. Bodies only: a gauge of stabilizer or bit narrows contact, not flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowGeometry {
    /// Diameter of the hole D_ch \[m\].
    pub hole_diameter: f64,
    /// Outer diameter of the pipe D_o \[m\].
    pub outer_diameter: f64,
    /// Inner diameter of the pipe D_i \[m\].
    pub inner_diameter: f64,
}

impl FlowGeometry {
    /// Geometry of the flow past a string's section in a hole \[m\].
    pub fn past(section: &BeamSection, hole_diameter: f64) -> Self {
        Self { hole_diameter, outer_diameter: section.outer_diameter, inner_diameter: section.inner_diameter }
    }

    /// Area of the bore A_i \[m2\].
    pub fn bore_area(&self) -> f64 {
        FRAC_PI_4 * self.inner_diameter.powi(2)
    }

    /// Area that the pipe's body displaces A_o \[m2\].
    pub fn displaced_area(&self) -> f64 {
        FRAC_PI_4 * self.outer_diameter.powi(2)
    }

    /// Area of the annulus \[m2\].
    pub fn annulus_area(&self) -> f64 {
        FRAC_PI_4 * (self.hole_diameter.powi(2) - self.outer_diameter.powi(2))
    }

    /// Mean speed in the annulus \[m/s\] of a flow rate \[m3/s\].
    pub fn annulus_speed(&self, flow_rate: f64) -> f64 {
        flow_rate / self.annulus_area()
    }
}
