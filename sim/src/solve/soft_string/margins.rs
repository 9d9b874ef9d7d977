//! Distances to yield and buckling.

use serde::Serialize;

use super::laid::{Ends, Step};

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

/// Forces at one depth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct DragRow {
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Effective tension \[N\].
    pub tension: f64,
    /// Torque against the rotation \[N m\].
    pub torque: f64,
    /// Force of the wall \[N/m\], just below this depth.
    pub side_force: f64,
    /// Von Mises stress over the yield strength; absent without a grade.
    pub yield_ratio: Option<f64>,
    /// Compression over the sinusoidal buckling load, 0 in tension; helical from sqrt(2) on.
    pub buckling_ratio: f64,
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
