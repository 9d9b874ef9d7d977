//! Errors of tables.

use ::parquet::errors::ParquetError;

/// Errors of writing and reading tables.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The bytes are not of this program's form, or cannot be encoded.
    #[error("parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// The target does not take the table.
    #[error("the table cannot be written: {0}")]
    Sink(#[from] std::io::Error),
    /// Columns of different length.
    #[error("column {name:?} has {rows} rows, the first one {expected}")]
    Ragged {
        /// The column.
        name: String,
        /// Its length.
        rows: usize,
        /// The first column's length.
        expected: usize,
    },
    /// A piece of a table with other columns than the ones before it.
    #[error("a piece of a table has other columns than the table")]
    OtherColumns,
    /// A column of a type that is not used here.
    #[error("column {0:?} has a type that is not used here")]
    UnknownType(String),
    /// A text that is not UTF-8.
    #[error("column {0:?} holds text that is not UTF-8")]
    NotUtf8(String),
}
