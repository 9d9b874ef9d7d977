//! Errors of charts.

use drillsweep_table::Table;

/// Table or choice that no picture shows. Messages do not repeat the value that was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChartError {
    /// No column was chosen.
    #[error("a picture needs a column; there are {}", .columns.join(", "))]
    NoField {
        /// Numeric columns of the table that are no parameters.
        columns: Vec<String>,
    },
    /// The table lacks a column.
    #[error("there is no such column; there are {}", .columns.join(", "))]
    NoSuchColumn {
        /// Its name.
        name: String,
        /// Columns of the table.
        columns: Vec<String>,
    },
    /// A column has another unit than the first one chosen.
    #[error("the columns of a picture must have one unit; {name} has another than the first")]
    OtherUnit {
        /// Its name.
        name: String,
    },
    /// A column holds texts.
    #[error("is a column of texts, which a picture cannot show")]
    Texts {
        /// Its name.
        name: String,
    },
    /// The slice holds a parameter that the sweep lacks.
    #[error("the sweep has no such parameter; it has {}", .parameters.join(", "))]
    NoSuchParameter {
        /// Its name.
        name: String,
        /// Parameters of the sweep.
        parameters: Vec<String>,
    },
    /// The slice holds a parameter at a value that no point has.
    #[error("no point has this value of {parameter}; the nearest are {}", listed(.nearest))]
    NoSuchValue {
        /// Name of the parameter.
        parameter: String,
        /// Value of the slice, in the units of the table.
        value: f64,
        /// Nearest values of points, in the same units.
        nearest: Vec<f64>,
    },
}

impl ChartError {
    pub(crate) fn no_such_column(table: &Table, name: &str) -> Self {
        ChartError::NoSuchColumn { name: name.to_owned(), columns: table.columns.keys().cloned().collect() }
    }
}

fn listed(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}
