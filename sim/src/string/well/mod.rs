//! The well path: a survey interpolated by minimum curvature, and the frames that its nodes carry
//! (docs/model/well.md).
//!
//! The global frame is X north, Y east, Z down, with its origin at the survey's first station. Between two
//! stations the path is a circular arc, so that position, tangent and curvature are closed formulas, and so
//! is the rotation that carries a section's axes from one depth to another without twist.

mod arc;
mod frame;
mod path;

pub use frame::NodeFrame;
pub use path::{WellError, WellPath};
