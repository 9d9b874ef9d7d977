//! Distances to yield and buckling.

use serde::Serialize;

use super::laid::{Ends, Step};
use super::strength::Strength;

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
    /// Largest torque over the make-up torque of the connections; absent without one.
    pub make_up_ratio: Option<AtDepth>,
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

/// Forces and bending at one depth of a string.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    /// Measured depth \[m\].
    pub(crate) measured_depth: f64,
    /// Effective tension \[N\].
    pub(crate) tension: f64,
    /// Torque against the rotation \[N m\].
    pub(crate) torque: f64,
    /// Force of the wall \[N/m\].
    pub(crate) side_force: f64,
    /// Curvature of the hole \[1/m\].
    pub(crate) curvature: f64,
    /// Diameter of the hole \[m\].
    pub(crate) hole_diameter: f64,
}

impl Margins {
    /// Forces at an end of a step, the upper one (0) or the lower one (1), of which the extremes are kept.
    pub(super) fn note(&mut self, step: &Step<'_>, measured_depth: f64, ends: &Ends, end: usize) -> DragRow {
        let carried = Carried {
            measured_depth,
            tension: ends.tension[end],
            torque: ends.torque[end],
            side_force: ends.side_force[end],
            curvature: step.curvature,
            hole_diameter: step.hole_diameter,
        };
        self.keep(&step.part.strength, &carried)
    }

    /// Forces on a cross-section, of which the extremes are kept.
    pub(crate) fn keep(&mut self, strength: &Strength, carried: &Carried) -> DragRow {
        let Carried { measured_depth, tension, torque, side_force, curvature, hole_diameter } = *carried;
        let yield_ratio = strength.yield_ratio(tension, torque, curvature);
        let buckling_ratio = strength.buckling_ratio(tension, side_force, hole_diameter);
        let keep = |kept: &mut Option<AtDepth>, value: Option<f64>, sign: f64| {
            if let Some(value) = value
                && kept.is_none_or(|kept| sign * value > sign * kept.value)
            {
                *kept = Some(AtDepth { value, measured_depth });
            }
        };
        keep(&mut self.yield_ratio, yield_ratio, 1.0);
        keep(&mut self.make_up_ratio, strength.make_up_ratio(torque), 1.0);
        keep(&mut self.overpull, strength.overpull(tension, torque), -1.0);
        keep(&mut self.buckling_ratio, Some(buckling_ratio).filter(|ratio| *ratio > 0.0), 1.0);
        DragRow { measured_depth, tension, torque, side_force, yield_ratio, buckling_ratio }
    }
}
