//! Distances to yield and buckling.

use drillsweep_scenario::Grade;
use serde::Serialize;

use super::DragRow;
use super::laid::{Ends, Step};
use crate::string::beam::BeamSection;

/// Factor of Lubinski's critical load of a string in a vertical hole, in (E I w^2)^(1/3) (Lubinski 1950, first order).
const VERTICAL: f64 = 1.94;

/// A value with its place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct AtDepth {
    /// The value.
    pub value: f64,
    /// Measured depth \[m\].
    pub measured_depth: f64,
}

/// Distances of a string to its limits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, utoipa::ToSchema)]
pub struct Margins {
    /// Largest von Mises stress over the yield strength, bending in the curved hole included; absent without a grade.
    pub yield_ratio: Option<AtDepth>,
    /// Least additional tension \[N\] by which a part with this torque yields, without bending; absent without a grade.
    pub overpull: Option<AtDepth>,
    /// Largest compression over the sinusoidal buckling load; helical from sqrt(2) on. Absent without compression.
    pub buckling_ratio: Option<AtDepth>,
}

/// Limits of a cross-section.
#[derive(Debug, Clone)]
pub(super) struct Strength {
    section: BeamSection,
    /// Yield strength \[Pa\], if the material has a grade.
    yield_strength: Option<f64>,
    /// Buckling load of the string in a vertical hole \[N\].
    vertical: f64,
}

impl Strength {
    pub(super) fn new(section: BeamSection, grade: Option<Grade>, weight: f64) -> Self {
        let vertical = VERTICAL * (section.bending_stiffness() * weight * weight).cbrt();
        Self { section, yield_strength: grade.map(Grade::yield_strength), vertical }
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
    fn buckling_ratio(&self, tension: f64, side_force: f64, hole_diameter: f64) -> f64 {
        let clearance = 0.5 * (hole_diameter - self.section.outer_diameter);
        let inclined = 2.0 * (self.section.bending_stiffness() * side_force / clearance).sqrt();
        let load = inclined.max(self.vertical);
        if tension < 0.0 && load > 0.0 && load.is_finite() { -tension / load } else { 0.0 }
    }

    /// Von Mises stress over the yield strength, at the outer surface of the part bent to a curvature \[1/m\].
    ///
    /// Still mud of one density in and around the pipe adds a hydrostatic stress to that of the effective tension, which does not yield.
    fn yield_ratio(&self, tension: f64, torque: f64, curvature: f64) -> Option<f64> {
        let bending = 0.5 * self.section.outer_diameter * self.section.youngs_modulus * curvature;
        let normal = tension.abs() / self.section.area + bending;
        Some(normal.hypot(3_f64.sqrt() * self.shear(torque)) / self.yield_strength?)
    }

    /// Tension \[N\] at which the part yields under a torque \[N m\], less the present one.
    fn overpull(&self, tension: f64, torque: f64) -> Option<f64> {
        let left = self.yield_strength?.powi(2) - 3.0 * self.shear(torque).powi(2);
        Some(self.section.area * left.max(0.0).sqrt() - tension)
    }

    /// Shear stress at the outer surface \[Pa\].
    fn shear(&self, torque: f64) -> f64 {
        torque * 0.5 * self.section.outer_diameter / self.section.polar_moment()
    }
}

impl Margins {
    /// Forces at an end of a step, the upper one (0) or the lower one (1), of which the extremes are kept.
    pub(super) fn note(&mut self, step: &Step<'_>, measured_depth: f64, ends: &Ends, end: usize) -> DragRow {
        let (tension, torque, side_force) = (ends.tension[end], ends.torque[end], ends.side_force[end]);
        let strength = &step.part.strength;
        let yield_ratio = strength.yield_ratio(tension, torque, step.curvature);
        let buckling_ratio = strength.buckling_ratio(tension, side_force, step.hole_diameter);
        let keep = |kept: &mut Option<AtDepth>, value: Option<f64>, sign: f64| {
            if let Some(value) = value
                && kept.is_none_or(|kept| sign * value > sign * kept.value)
            {
                *kept = Some(AtDepth { value, measured_depth });
            }
        };
        keep(&mut self.yield_ratio, yield_ratio, 1.0);
        keep(&mut self.overpull, strength.overpull(tension, torque), -1.0);
        keep(&mut self.buckling_ratio, Some(buckling_ratio).filter(|ratio| *ratio > 0.0), 1.0);
        DragRow { measured_depth, tension, torque, side_force, yield_ratio, buckling_ratio }
    }
}
