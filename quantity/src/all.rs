//! All quantities of the vocabulary.

use crate::definition::Quantity;
use crate::{columns, parameters};

/// All quantities: those of columns, then those of fields of a scenario.
pub fn all() -> impl Iterator<Item = &'static Quantity> {
    columns::ALL.iter().copied().chain(parameters::ALL)
}
