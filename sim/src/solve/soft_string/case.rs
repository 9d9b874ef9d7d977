//! Forces on a string in one load case.

use serde::Serialize;

use super::error::SoftStringError;
use super::margins::{DragRow, Margins};
use super::mode::{DragMode, DragSettings};
use super::string::SoftString;

/// Choice of a load case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DragCase {
    /// Motion and loads.
    pub mode: DragMode,
    /// Measured depth of the bit \[m\].
    pub bit_depth: f64,
    /// Friction factor of the whole hole; absent means the dynamic friction of each hole section.
    pub friction: Option<f64>,
}

/// Forces on a string in one case.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct DragResult {
    /// Motion and loads.
    pub mode: DragMode,
    /// Measured depth of the bit \[m\].
    pub bit_depth: f64,
    /// Tension at the top with the travelling weight \[N\].
    pub hook_load: f64,
    /// Torque at the top \[N m\].
    pub surface_torque: f64,
    /// Force of the wall on the whole string, summed along it \[N\].
    pub side_force: f64,
    /// Distances to yield and buckling.
    pub margins: Margins,
    /// Forces along the string, from the top.
    pub profile: Vec<DragRow>,
}

impl SoftString {
    /// Forces of a case, with their course along the string.
    ///
    /// # Errors
    /// The bit is not on the string, a friction factor is negative, or reaming has no axial speed.
    pub fn forces(&self, case: &DragCase, settings: &DragSettings) -> Result<DragResult, SoftStringError> {
        let DragCase { mode, bit_depth, friction } = *case;
        let motion = mode.motion(&self.operation, settings)?;
        let friction = self.friction(friction)?;
        let laid = self.laid(bit_depth)?;
        let mut margins = Margins::default();
        let mut profile = Vec::with_capacity(laid.steps.len() + 1);
        let bit = mode.bit_loads(&self.operation);
        let top = laid.forces(&friction, &motion, bit, |step, ends| {
            for (end, &measured_depth) in step.depths.iter().enumerate().rev() {
                let row = margins.note(step, measured_depth, ends, end);
                if end == 0 || profile.is_empty() {
                    profile.push(row);
                }
            }
        });
        profile.reverse();
        Ok(DragResult {
            mode,
            bit_depth,
            hook_load: top.tension + settings.travelling_weight,
            surface_torque: top.torque,
            side_force: top.side_force,
            margins,
            profile,
        })
    }
}
