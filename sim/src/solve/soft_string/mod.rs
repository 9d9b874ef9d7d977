//! Torque and drag of a soft string (docs/model/soft-string.md).
//!
//! A string without bending stiffness lies on the axis of the hole. Its effective tension T and its torque M follow from the bit upward:
//! dT/dl = w t_z + a mu N, dM/dl = c mu N R, with the side force N = |T kappa + w (e_z - t_z t)| per length, the buoyed weight w, the tangent t, the
//! curvature kappa of the survey's arcs, and the axial and circumferential shares a and c of friction, which opposes the velocity (Omega R, V) of the
//! string's surface (Johancsik, Friesen, Dawson: Torque and drag in directional wells, JPT 36, 1984). Friction across the hole does not move the
//! string off the low side, as usual in the field.

mod broomstick;
mod case;
mod error;
mod fit;
mod laid;
mod margins;
mod mode;
mod strength;
mod string;

#[cfg(test)]
mod tests;

pub use broomstick::BroomstickRow;
pub use case::{DragCase, DragResult};
pub use error::{MOST_BROOMSTICK_CASES, SoftStringError};
pub use fit::{FitError, FitSettings, FittedFriction, FrictionFit, MeasuredPoint, PointResidual};
pub(crate) use margins::Carried;
pub use margins::{AtDepth, DragRow, Margins};
pub use mode::{DragMode, DragSettings};
pub(crate) use strength::Strength;
pub use string::SoftString;
