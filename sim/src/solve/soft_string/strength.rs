//! Limits of a cross-section: yield and buckling.

use drillsweep_scenario::Grade;

use crate::string::beam::BeamSection;

/// Factor of Lubinski's critical load of a string in a vertical hole, in (E I w^2)^(1/3) (Lubinski 1950, first order).
const VERTICAL: f64 = 1.94;

/// Limits of a cross-section.
#[derive(Debug, Clone)]
pub(crate) struct Strength {
    section: BeamSection,
    /// Yield strength \[Pa\], if the material has a grade.
    yield_strength: Option<f64>,
    /// Make-up torque of the connections \[N m\], if it is known.
    make_up_torque: Option<f64>,
    /// Buckling load of the string in a vertical hole \[N\].
    vertical: f64,
}

impl Strength {
    pub(crate) fn new(section: BeamSection, grade: Option<Grade>, weight: f64) -> Self {
        let vertical = VERTICAL * (section.bending_stiffness() * weight * weight).cbrt();
        Self { section, yield_strength: grade.map(Grade::yield_strength), make_up_torque: None, vertical }
    }

    /// The same cross-section with connections of a make-up torque \[N m\].
    #[must_use]
    pub(crate) fn with_make_up_torque(self, make_up_torque: Option<f64>) -> Self {
        Self { make_up_torque, ..self }
    }

    /// Torque over the make-up torque of the connections.
    pub(super) fn make_up_ratio(&self, torque: f64) -> Option<f64> {
        Some(torque.abs() / self.make_up_torque?)
    }

    /// Outer diameter \[m\].
    #[cfg(test)]
    pub(super) fn outer_diameter(&self) -> f64 {
        self.section.outer_diameter
    }

    /// Compression over the load from which a string that is pressed against its hole by a side force \[N/m\] buckles sinusoidally,
    /// 2 sqrt(E I N / r) with the radial clearance r (Dawson, Paslay: Drillpipe buckling in inclined holes, JPT 36, 1984; with the side force of a
    /// curved hole He, Kyllingstad, SPE Drilling & Completion 10, 1995), at least that of a vertical hole. It buckles helically from sqrt(2) times the load on
    /// (Chen, Lin, Cheatham, J. Energy Resources Technology 112, 1990).
    pub(super) fn buckling_ratio(&self, tension: f64, side_force: f64, hole_diameter: f64) -> f64 {
        let clearance = 0.5 * (hole_diameter - self.section.outer_diameter);
        let inclined = 2.0 * (self.section.bending_stiffness() * side_force / clearance).sqrt();
        let load = inclined.max(self.vertical);
        if tension < 0.0 && load > 0.0 && load.is_finite() { -tension / load } else { 0.0 }
    }

    /// Von Mises stress over the yield strength, at the outer surface of the part bent to a curvature \[1/m\].
    ///
    /// Still mud of one density in and around the pipe adds a hydrostatic stress to that of the effective tension, which does not yield.
    pub(super) fn yield_ratio(&self, tension: f64, torque: f64, curvature: f64) -> Option<f64> {
        let bending = self.section.carrying_radius() * self.section.youngs_modulus * curvature;
        let normal = tension.abs() / self.section.area + bending;
        Some(normal.hypot(3_f64.sqrt() * self.shear(torque)) / self.yield_strength?)
    }

    /// Tension \[N\] at which the part yields under a torque \[N m\], less the present one.
    pub(super) fn overpull(&self, tension: f64, torque: f64) -> Option<f64> {
        let left = self.yield_strength?.powi(2) - 3.0 * self.shear(torque).powi(2);
        Some(self.section.area * left.max(0.0).sqrt() - tension)
    }

    /// Shear stress at the outer surface \[Pa\].
    fn shear(&self, torque: f64) -> f64 {
        torque * self.section.carrying_radius() / self.section.polar_moment()
    }
}
