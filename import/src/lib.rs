//! Parts of a scenario from files of other programs.
//!
//! A file is read into a [`Grid`] of texts ([`grid`]), or into elements if it is XML. Columns are recognised by their headings and units;
//! the answer shows what was understood, and each cell that was not, by row and column. Nothing is guessed silently: a depth without a unit is
//! refused, and an assumed unit is named as assumed.

mod error;
pub mod grid;
mod headings;
pub mod hole;
mod kind;
mod las;
mod measure;
pub mod measured;
pub mod mud;
mod number;
mod rows;
mod sheet;
pub mod survey;
pub mod tally;
pub mod witsml;

pub use error::ImportError;
pub use grid::{Grid, GridError};
pub use hole::{HoleImport, HoleOptions, hole};
pub use measure::AssumedUnits;
pub use measured::{MeasuredImport, MeasuredOptions, MeasuredRow, measured};
pub use mud::{MudAnswer, MudError, MudFit, MudReport, MudRequest, Reading};
pub use rows::{CellProblem, MOST_BYTES, MOST_PROBLEMS, UnderstoodColumn};
pub use survey::{Survey, SurveyOptions, survey};
pub use tally::{Tally, TallyLengths, TallyOptions, TallyOrder, UnderstoodComponent, tally};
