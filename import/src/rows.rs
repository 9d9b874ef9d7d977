//! Rows of files with their meaning and their problems.

use std::fmt;

use drillsweep_scenario::SurveyStation;
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
    /// Column, as spreadsheets name it (`A`), or element of a WITSML file; absent if the whole row is meant.
    pub column: Option<String>,
    /// Text of the cell, shortened.
    pub text: String,
    /// Fault, in words.
    pub problem: String,
}

impl CellProblem {
    /// A problem of a row, from 0, in a column or in the whole of it.
    pub(crate) fn new(row: usize, column: Option<&str>, text: &str, problem: impl Into<String>) -> Self {
        const LONGEST: usize = 40;
        let text = text.chars().take(LONGEST).collect();
        Self { row: row + 1, column: column.map(str::to_owned), text, problem: problem.into() }
    }
}

impl fmt::Display for CellProblem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "row {}", self.row)?;
        if let Some(column) = &self.column {
            write!(formatter, ", column {column}")?;
        }
        if !self.text.is_empty() {
            write!(formatter, ", `{}`", self.text)?;
        }
        write!(formatter, ": {}", self.problem)
    }
}

/// Largest number of stations.
pub(crate) const MOST_STATIONS: usize = 10_000;

/// A station with the row that it stands in, from 0.
pub(crate) type Row = (usize, SurveyStation);

/// Stations, meanings of columns and problems of a file.
pub(crate) type Rows = (Vec<Row>, Vec<UnderstoodColumn>, Vec<CellProblem>);

/// Name of a column as spreadsheets have it: A to Z, AA, AB.
pub(crate) fn column_name(index: usize) -> String {
    let mut name = String::new();
    let mut rest = index + 1;
    while rest > 0 {
        rest -= 1;
        name.insert(0, char::from(b'A' + (rest % 26) as u8));
        rest /= 26;
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_as_in_spreadsheets() {
        let names = [0, 25, 26, 51, 52, 701, 702].map(column_name);
        assert_eq!(names, ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }
}
