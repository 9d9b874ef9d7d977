//! The vocabulary of results and scenarios: meanings of the names of columns and fields.
//!
//! A [`Quantity`] has a name, a symbol, units and a label, its name in the words of the field. Names of columns are put together from it here, and taken apart here: a
//! number of a node (`u_49`), a spectrum window (`line_amplitude_49_w1`), its statistic over an ensemble or relative to a reference
//! (`spread_`, `ensemble_mean_`, `reference_`, `bias_`).

mod all;
mod choice;
mod classes;
pub mod columns;
mod definition;
pub mod entry;
mod export;
mod name;
mod parameters;
pub mod units;

pub use all::all;
pub use choice::{ChoiceError, UnitChoice};
pub use classes::{CLASSES, Class};
pub use definition::Quantity;
pub use export::{QuantityEntry, UnitEntry, WordEntry, entries, json};
pub use name::{Name, Place, Variant};
pub use units::{Unit, UnitSystem, Units};

/// The quantity that a column's name or a scenario's path stands for, if it is one of the vocabulary.
pub fn of(name: &str) -> Option<&'static Quantity> {
    Name::parse(name).map(|name| name.quantity)
}

/// The unit of a column, or of a field of a scenario (`1` for ratios); none for names, numbers of things and unknown columns.
pub fn unit(name: &str) -> Option<&'static str> {
    Name::parse(name)?.unit()
}
