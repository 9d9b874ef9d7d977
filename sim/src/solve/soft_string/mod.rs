//! Torque and drag of a soft string (docs/model/soft-string.md).
//!
//! A string without bending stiffness lies on the axis of the hole. Its effective tension T and its torque M follow from the bit upward:
//! dT/dl = w t_z + a mu N, dM/dl = c mu N R, with the side force N = |T kappa + w (e_z - t_z t)| per length, the buoyed weight w, the tangent t, the
//! curvature kappa of the survey's arcs, and the axial and circumferential shares a and c of friction, which opposes the velocity (Omega R, V) of the
//! string's surface (Johancsik, Friesen, Dawson: Torque and drag in directional wells, JPT 36, 1984). Friction across the hole does not move the
//! string off the low side, as usual in the field.

mod broomstick;
mod fit;
mod laid;
mod margins;
mod mode;

#[cfg(test)]
mod tests;

use drillsweep_scenario::{Hole, Operation, Scenario};
use serde::Serialize;

pub use broomstick::{BroomstickRow, MOST_BROOMSTICK_CASES};
pub use fit::{FitError, FitSettings, FittedFriction, FrictionFit, MeasuredPoint, PointResidual};
pub use margins::{AtDepth, Margins};
pub use mode::DragMode;

use crate::force::effect::active_effects;
use crate::force::term::gravity;
use crate::string::beam::BeamSection;
use crate::string::well::{WellError, WellPath};
use crate::string::{ElementKind, MeshError, UniformPart, stretches};
use laid::LaidString;
use margins::Strength;

/// Excess \[m\] of a bit depth over the string's length that is rounding.
const DEPTH_ROUNDING: f64 = 1e-6;

/// Reason for which a scenario has no torque and drag.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SoftStringError {
    /// The survey does not describe a path.
    #[error("well: {0}")]
    Well(#[from] WellError),
    /// The string has no sections.
    #[error("string: {0}")]
    String(#[from] MeshError),
    /// The bit is above the top or below the end of the string.
    #[error(
        "the bit is at {bit_depth} m; it must be on the string of {length} m, which is shortened at its top"
    )]
    BitDepth {
        /// Measured depth of the bit \[m\].
        bit_depth: f64,
        /// Length of the whole string \[m\].
        length: f64,
    },
    /// The mode `ream` has no axial speed.
    #[error("the mode ream needs an axial speed in m/s, negative upwards")]
    NoAxialSpeed,
    /// A friction factor is negative or not finite.
    #[error("a friction factor of {0} is not a number of 0 or greater")]
    Friction(f64),
    /// Too many cases of a broomstick are requested.
    #[error("{0} cases are requested, of {MOST_BROOMSTICK_CASES} at most")]
    TooManyCases(usize),
}

/// A string on the axis of its hole.
#[derive(Debug, Clone)]
pub struct SoftString {
    path: WellPath,
    /// Parts from the top.
    parts: Vec<Part>,
    length: f64,
    /// Depths at which hole sections begin \[m\].
    section_tops: Vec<f64>,
    /// The hole above all sections, then that of each section.
    holes: Vec<Hole>,
    operation: Operation,
}

/// A part of one cross-section.
#[derive(Debug, Clone)]
struct Part {
    /// Measured depths of its ends with the whole string in the hole \[m\].
    ends: [f64; 2],
    /// Buoyed weight \[N/m\].
    weight: f64,
    /// Radius at which it touches the wall \[m\]: that of its tool joints if they are larger.
    contact_radius: f64,
    strength: Strength,
}

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

/// Settings of all cases.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DragSettings {
    /// Weight of top drive and travelling block, part of the hook load \[N\].
    pub travelling_weight: f64,
    /// Axial speed of the mode `ream` \[m/s\], downhole positive.
    pub axial_speed: Option<f64>,
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

impl SoftString {
    /// The string of a scenario, with the weight of its effects.
    ///
    /// # Errors
    /// The survey has no path or the string no sections; a validated scenario has both.
    pub fn new(scenario: &Scenario) -> Result<Self, SoftStringError> {
        let effects = active_effects(scenario);
        let acceleration = gravity::acceleration(effects.gravity);
        let mud = scenario.mud.filter(|_| effects.buoyancy).map_or(0.0, |mud| mud.density);
        let uniform = stretches(scenario)?;
        let joints = |index: usize| {
            let neighbours = [index.checked_sub(1), Some(index + 1)].into_iter().flatten();
            let joints = neighbours.filter_map(|index| uniform.get(index));
            joints.filter(|part| part.kind == ElementKind::ToolJoint).map(|joint| joint.outer_diameter)
        };
        let part = |(index, part): (usize, &UniformPart)| {
            let section = BeamSection::pipe(part.outer_diameter, part.inner_diameter, &part.material);
            let mass =
                section.density * section.area + mud * (section.bore_area() - section.displaced_area());
            // A body with joints at both ends hangs between them.
            let carried = part.kind == ElementKind::DrillpipeBody && joints(index).count() == 2;
            let joint = if carried { joints(index).fold(0.0, f64::max) } else { 0.0 };
            Part {
                ends: [part.top, part.bottom],
                weight: acceleration * mass,
                contact_radius: 0.5 * part.outer_diameter.max(joint),
                strength: Strength::new(section, part.material.grade, acceleration * mass),
            }
        };
        let parts: Vec<Part> = uniform.iter().enumerate().map(part).collect();
        let sections = 0..scenario.well.section.len();
        Ok(Self {
            path: WellPath::new(&scenario.well)?,
            length: parts.last().map_or(0.0, |part| part.ends[1]),
            parts,
            section_tops: scenario.well.section.iter().map(|section| section.from).collect(),
            holes: std::iter::once(None)
                .chain(sections.map(Some))
                .map(|index| scenario.hole_of(index))
                .collect(),
            operation: scenario.operation,
        })
    }

    /// Length of the whole string \[m\].
    pub fn length(&self) -> f64 {
        self.length
    }

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

    /// Friction factors of the hole above all sections and of each section.
    fn friction(&self, common: Option<f64>) -> Result<Vec<f64>, SoftStringError> {
        match common {
            Some(friction) if !(friction.is_finite() && friction >= 0.0) => {
                Err(SoftStringError::Friction(friction))
            }
            _ => Ok(self.holes.iter().map(|hole| common.unwrap_or(hole.dynamic_friction)).collect()),
        }
    }

    /// The string with its bit at a depth \[m\], shortened at its top.
    fn laid(&self, bit_depth: f64) -> Result<LaidString<'_>, SoftStringError> {
        if bit_depth > 0.0 && bit_depth <= self.length + DEPTH_ROUNDING {
            Ok(LaidString::new(self, bit_depth))
        } else {
            Err(SoftStringError::BitDepth { bit_depth, length: self.length })
        }
    }
}
