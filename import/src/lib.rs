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
pub mod survey;
mod witsml;

pub use grid::{Grid, GridError};
pub use mud::{MudError, MudFit, MudReport, Reading};
pub use survey::{Survey, SurveyError, SurveyOptions, survey};

use serde::Serialize;

/// Largest file \[bytes\].
pub const MOST_BYTES: usize = 8 << 20;

/// Largest number of problems that are reported; further rows are not read.
pub const MOST_PROBLEMS: usize = 100;

/// Meaning of a column of a file.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct UnderstoodColumn {
    /// Quantity, such as `measured_depth`.
    pub quantity: &'static str,
    /// Column, as spreadsheets name it (`A`), or element of a WITSML file.
    pub column: String,
    /// Heading in the file.
    pub heading: String,
    /// Unit of its numbers.
    pub unit: String,
    /// True if the file does not give the unit.
    pub is_assumed: bool,
}

/// A cell that could not be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
pub struct CellProblem {
    /// Row, from 1, as editors and spreadsheets count.
    pub row: usize,
    /// Column, as spreadsheets name it; absent if the whole row is meant.
    pub column: Option<String>,
    /// Text of the cell, shortened.
    pub text: String,
    /// What is wrong, in words.
    pub problem: String,
}

impl CellProblem {
    fn new(row: usize, column: Option<usize>, text: &str, problem: impl Into<String>) -> Self {
        const LONGEST: usize = 40;
        let text = text.chars().take(LONGEST).collect();
        Self { row: row + 1, column: column.map(grid::column_name), text, problem: problem.into() }
    }
}
