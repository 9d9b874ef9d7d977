//! Reasons for which a file is not imported.

use thiserror::Error;

use crate::grid::GridError;
use crate::rows::CellProblem;
use crate::witsml::WitsmlError;

/// Reason for which a file is no survey, tally or hole.
#[derive(Debug, Error)]
pub enum ImportError {
    /// It is no table.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// It is no WITSML of the kind that is read.
    #[error("the XML cannot be read: {0}")]
    Witsml(#[from] WitsmlError),
    /// No row has the headings.
    #[error("no row has headings of {0}")]
    NoHeadings(&'static str),
    /// The unit of a column is not known.
    #[error("column {column} (`{heading}`) has no unit: give that of {quantity}, {valid}")]
    NoUnit {
        /// Column, as spreadsheets name it.
        column: String,
        /// Its heading.
        heading: String,
        /// Quantity of the column, in words.
        quantity: &'static str,
        /// Valid units, in words.
        valid: &'static str,
        /// Option of the reader that gives it.
        option: &'static str,
    },
    /// A unit does not fit.
    #[error("column {column} (`{heading}`) must have the unit of {quantity}: {valid}")]
    Unit {
        /// Column, as spreadsheets name it.
        column: String,
        /// Its heading.
        heading: String,
        /// Quantity of the column.
        quantity: &'static str,
        /// Valid units, in words.
        valid: String,
    },
    /// The file leaves open what an option of the reader decides.
    #[error("{open}: give `{option}`, {valid}")]
    Open {
        /// Option of the reader.
        option: &'static str,
        /// Open question, in words.
        open: String,
        /// Valid values of the option.
        valid: String,
    },
    /// The file has too few usable rows.
    #[error("the file has {count} usable {rows}; the least number is {needed}{}", first(.problems))]
    TooFew {
        /// Usable rows.
        count: usize,
        /// Rows that are needed.
        needed: usize,
        /// Name of the rows.
        rows: &'static str,
        /// Problems of the others.
        problems: Vec<CellProblem>,
    },
    /// The file has too many rows.
    #[error("the file has more than {most} {rows}")]
    TooMany {
        /// Largest number.
        most: usize,
        /// Name of the rows.
        rows: &'static str,
    },
}

impl ImportError {
    /// Option of the reader that the error is about; `None` if the file itself is at fault.
    pub fn option(&self) -> Option<&'static str> {
        match self {
            Self::NoUnit { option, .. } | Self::Open { option, .. } => Some(option),
            Self::Grid(GridError::NoSheet { .. }) => Some("sheet"),
            _ => None,
        }
    }

    /// Problems of single cells.
    pub fn problems(&self) -> &[CellProblem] {
        match self {
            Self::TooFew { problems, .. } => problems,
            _ => &[],
        }
    }
}

fn first(problems: &[CellProblem]) -> String {
    problems.first().map_or_else(String::new, |first| format!(" ({first})"))
}
