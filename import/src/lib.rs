//! Parts of a scenario from files of other programs.
//!
//! A file is read into a [`Grid`] of texts ([`grid`]), or into stations at once if it is XML. Columns are recognised by their headings and units;
//! the answer shows what was understood, and each cell that was not, by row and column. Nothing is guessed silently: a depth without a unit is
//! refused, and an assumed unit is named as assumed.

pub mod grid;
mod headings;
mod las;
pub mod mud;
mod number;
mod rows;
pub mod survey;
pub mod witsml;

pub use grid::{Grid, GridError};
pub use mud::{MudError, MudFit, MudReport, Reading};
pub use rows::{CellProblem, MOST_BYTES, MOST_PROBLEMS, UnderstoodColumn};
pub use survey::{Survey, SurveyError, SurveyOptions, survey};
