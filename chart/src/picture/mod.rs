//! Pictures of results, as SVG and PNG.
//!
//! A chart, such as a [`WorkPrecisionChart`] or a [`LinePlot`], lays itself out as a [`Drawing`]: a list of shapes in a fixed
//! page. The drawing is written as SVG, and PNG is that SVG in pixels, so the two show the same picture. Labels keep clear
//! of each other by the metrics of the font that PNG is set in. That font is built in: nothing depends on what the machine
//! has installed.
//!
//! A further kind of picture is one file that builds a [`Drawing`] from a [`PlotAxis`] for each direction,
//! the plot area with its grid, and the placing of labels.

pub mod axis;
mod drawing;
mod geometry;
mod heading;
mod label;
mod line_plot;
mod marker;
mod orbit;
mod plot_area;
mod png;
mod simplify;
mod string_sketch;
mod svg;
mod sweep_map;
mod text;
mod work_precision;

pub use axis::{PlotAxis, Tick};
pub use drawing::Drawing;
pub use line_plot::{Label, Line, LinePlot, Shade, VerticalAxis};
pub use orbit::OrbitPlot;
pub use png::PictureError;
pub use string_sketch::{Part, PartKind, StringSketch};
pub use sweep_map::{MapPoint, Spacing, SweepMap, Word};
pub use work_precision::{Point, RequestedAccuracy, Series, WorkPrecisionChart};
