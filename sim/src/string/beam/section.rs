//! Cross-section properties of a pipe.

use std::f64::consts::PI;

use drillsweep_scenario::{Material, Tube};

/// A pipe's cross-section with its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamSection {
    /// Outer diameter D_o \[m\].
    pub outer_diameter: f64,
    /// Inner diameter D_i \[m\].
    pub inner_diameter: f64,
    /// Outer and inner diameter of the tube that carries loads \[m\].
    pub carrying: [f64; 2],
    /// Area of that tube S \[m2\].
    pub area: f64,
    /// Second moment of area I \[m4\].
    pub second_moment: f64,
    /// Area reduced for shear S_r = k_S S \[m2\] (Cowper 1966, hollow circle).
    pub shear_area: f64,
    /// Young's modulus E \[Pa\].
    pub youngs_modulus: f64,
    /// Shear modulus G = E / 2(1 + nu) \[Pa\].
    pub shear_modulus: f64,
    /// Density, of all of the mass in the tube that carries loads \[kg/m3\].
    pub density: f64,
}

impl BeamSection {
    /// The section of a pipe that carries loads with all of its wall.
    pub fn pipe(outer_diameter: f64, inner_diameter: f64, material: &Material) -> Self {
        Self::of(&Tube::plain(outer_diameter, inner_diameter, *material))
    }

    /// The section of a pipe (docs/model/beam.md, Section).
    pub fn of(tube: &Tube) -> Self {
        let Tube { outer_diameter, inner_diameter, carrying: [outer, inner], material } = *tube;
        let nu = material.poissons_ratio;
        let ratio = (inner / outer).powi(2);
        let plus = (1.0 + ratio).powi(2);
        let shear_coefficient =
            6.0 * (1.0 + nu) * plus / ((7.0 + 6.0 * nu) * plus + (20.0 + 12.0 * nu) * ratio);
        let area = PI / 4.0 * (outer.powi(2) - inner.powi(2));
        Self {
            outer_diameter,
            inner_diameter,
            carrying: tube.carrying,
            area,
            second_moment: PI / 64.0 * (outer.powi(4) - inner.powi(4)),
            shear_area: shear_coefficient * area,
            youngs_modulus: material.youngs_modulus,
            shear_modulus: material.youngs_modulus / (2.0 * (1.0 + nu)),
            density: material.density,
        }
    }

    /// Polar second moment of area I_p = 2 I \[m4\].
    pub fn polar_moment(&self) -> f64 {
        2.0 * self.second_moment
    }

    /// Bore area A_i \[m2\].
    pub fn bore_area(&self) -> f64 {
        PI / 4.0 * self.inner_diameter.powi(2)
    }

    /// Area displaced by the body A_o \[m2\].
    pub fn displaced_area(&self) -> f64 {
        PI / 4.0 * self.outer_diameter.powi(2)
    }

    /// Axial stiffness E S \[N\].
    pub fn axial_stiffness(&self) -> f64 {
        self.youngs_modulus * self.area
    }

    /// Torsional stiffness G I_p \[N m2\].
    pub fn torsional_stiffness(&self) -> f64 {
        self.shear_modulus * self.polar_moment()
    }

    /// Bending stiffness E I \[N m2\].
    pub fn bending_stiffness(&self) -> f64 {
        self.youngs_modulus * self.second_moment
    }

    /// Speed of axial waves sqrt(E / rho) \[m/s\].
    pub fn axial_wave_speed(&self) -> f64 {
        (self.youngs_modulus / self.density).sqrt()
    }

    /// Speed of torsional waves sqrt(G / rho) \[m/s\].
    pub fn torsional_wave_speed(&self) -> f64 {
        (self.shear_modulus / self.density).sqrt()
    }

    /// Force by the speed of an axial wave, S sqrt(rho E) \[N s/m\].
    pub fn axial_impedance(&self) -> f64 {
        self.area * (self.density * self.youngs_modulus).sqrt()
    }

    /// Torque by the speed of a torsional wave, I_p sqrt(rho G) \[N m s\].
    pub fn torsional_impedance(&self) -> f64 {
        self.polar_moment() * (self.density * self.shear_modulus).sqrt()
    }

    /// Outer radius of the tube that carries loads \[m\].
    pub fn carrying_radius(&self) -> f64 {
        0.5 * self.carrying[0]
    }

    /// Bending stress at that radius r by a moment of 1 N m, r / I \[1/m3\].
    pub fn outer_bending_stress(&self) -> f64 {
        self.carrying_radius() / self.second_moment
    }

    /// Half the difference of hoop and radial stress \[1\] at a radius \[m\] of the wall by a bore pressure of 1 Pa above the annulus' (Lame); zero at
    /// the middle of a solid bar.
    pub fn pressure_shear(&self, radius: f64) -> f64 {
        if radius == 0.0 {
            return 0.0;
        }
        let [outer, inner] = self.carrying.map(|diameter| 0.25 * diameter * diameter);
        outer * inner / ((outer - inner) * radius * radius)
    }

    /// Shear parameter a = 12 E I / (G S_r l^2) of an element of length `length` \[m\], equation (6).
    pub fn shear_parameter(&self, length: f64) -> f64 {
        12.0 * self.bending_stiffness() / (self.shear_modulus * self.shear_area * length * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material =
        Material { youngs_modulus: 2.03e11, density: 7900.0, poissons_ratio: 0.3, grade: None };

    #[test]
    fn cowpers_coefficient_has_its_solid_and_thin_limits() {
        // Cowper (1966): solid circle 6(1+nu)/(7+6nu), thin tube 2(1+nu)/(4+3nu).
        let solid = BeamSection::pipe(0.1, 0.0, &STEEL);
        assert!((solid.shear_area / solid.area - 6.0 * 1.3 / 8.8).abs() < 1e-14);
        let thin = BeamSection::pipe(0.1, 0.1 * (1.0 - 1e-9), &STEEL);
        assert!((thin.shear_area / thin.area - 2.0 * 1.3 / 4.9).abs() < 1e-8);
    }
}
