//! Hook load and surface torque over bit depth and friction.

use serde::Serialize;

use super::error::{MOST_BROOMSTICK_CASES, SoftStringError};
use super::margins::Margins;
use super::mode::{DragMode, DragSettings};
use super::string::SoftString;

/// Forces at the surface in one case, with the margins of the whole string.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct BroomstickRow {
    /// Motion and loads.
    pub mode: DragMode,
    /// Friction factor of the whole hole; absent if each hole section has its own.
    pub friction: Option<f64>,
    /// Measured depth of the bit \[m\].
    pub bit_depth: f64,
    /// Tension at the top with the travelling weight \[N\].
    pub hook_load: f64,
    /// Torque at the top \[N m\].
    pub surface_torque: f64,
    /// Distances to yield and buckling.
    pub margins: Margins,
}

impl SoftString {
    /// Forces of every mode with every friction factor at every bit depth, in this order of nesting.
    ///
    /// # Errors
    /// As [`SoftString::forces`], or there are more than [`MOST_BROOMSTICK_CASES`] cases.
    pub fn broomstick(
        &self,
        modes: &[DragMode],
        friction: &[Option<f64>],
        depths: &[f64],
        settings: &DragSettings,
    ) -> Result<Vec<BroomstickRow>, SoftStringError> {
        let per_depth = modes.len().saturating_mul(friction.len());
        let cases = per_depth.saturating_mul(depths.len());
        if cases > MOST_BROOMSTICK_CASES {
            return Err(SoftStringError::TooManyCases(cases));
        }
        let motions = modes.iter().map(|&mode| Ok((mode, mode.motion(&self.operation, settings)?)));
        let motions: Vec<_> = motions.collect::<Result<_, SoftStringError>>()?;
        let factors = friction.iter().map(|&common| Ok((common, self.friction(common)?)));
        let factors: Vec<_> = factors.collect::<Result<_, SoftStringError>>()?;
        let mut rows = vec![Vec::with_capacity(depths.len()); per_depth];
        for &bit_depth in depths {
            // The same steps for all modes and factors.
            let laid = self.laid(bit_depth)?;
            let cases = motions.iter().flat_map(|motion| factors.iter().map(move |factor| (motion, factor)));
            for (rows, (&(mode, motion), (common, factors))) in rows.iter_mut().zip(cases) {
                let mut margins = Margins::default();
                let top = laid.forces(factors, &motion, mode.bit_loads(&self.operation), |step, ends| {
                    for (end, &depth) in step.depths.iter().enumerate() {
                        margins.note(step, depth, ends, end);
                    }
                });
                rows.push(BroomstickRow {
                    mode,
                    friction: *common,
                    bit_depth,
                    hook_load: top.tension + settings.travelling_weight,
                    surface_torque: top.torque,
                    margins,
                });
            }
        }
        Ok(rows.into_iter().flatten().collect())
    }
}
