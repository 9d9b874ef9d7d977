//! Pictures of results, as SVG and PNG.
//!
//! [`profile`], [`history`], [`orbit`], [`spectrum`] and [`sweep`] take the very table that is served as JSON or CSV and choose
//! the shown columns, their units and names; [`work_precision`] does so for a cost study. [`string()`] draws the string of a scenario. The result is laid out
//! on a page and written by [`picture`], which knows nothing of tables.

mod cost;
mod error;
mod forced;
mod history;
mod orbit;
pub mod picture;
mod place;
mod profile;
mod shapes;
mod shown;
mod spectrum;
mod stability_map;
mod string;
mod sweep;
mod torque_drag;
mod words;

pub use cost::work_precision;
pub use error::ChartError;
pub use forced::forced_response;
pub use history::{Bit, history, rotation, shown_of_history};
pub use orbit::{Hole, orbit};
pub use picture::{Drawing, PictureError, Spacing};
pub use place::Place;
pub use profile::profile;
pub use shapes::mode_shapes;
pub use shown::caption;
pub use spectrum::spectrum;
pub use stability_map::stability_map;
pub use string::string;
pub use sweep::{SweepView, sweep};
pub use torque_drag::broomstick;

/// Width of a picture as PNG, in pixels: twice its natural size, so that it is sharp on fine screens and in print.
pub const PNG_WIDTH: u32 = 1600;
