//! Source of a table that is written piece by piece, so that it need not be in memory as a whole.

use std::borrow::Cow;
use std::io::Write;
use std::iter::once;

use crate::error::TableError;
use crate::table::Table;

/// Destination of a written table.
pub type Sink<'s> = dyn Write + Send + 's;

/// A table in pieces, from which formats are written.
pub trait Source {
    /// The columns in their order with types and units, and the attributes. It may have rows: all of them.
    fn layout(&self) -> &Table;

    /// All columns, in pieces of some rows, in their order.
    fn by_rows(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>>;

    /// All rows, in pieces of some columns, in their order.
    fn by_columns(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>>;
}

/// One piece.
impl Source for Table {
    fn layout(&self) -> &Table {
        self
    }

    fn by_rows(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>> {
        once(Ok(Cow::Borrowed(self)))
    }

    fn by_columns(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>> {
        once(Ok(Cow::Borrowed(self)))
    }
}
