//! The vocabulary of results and scenarios: what the name of a column or of a field stands for.
//!
//! A [`Quantity`] has a name, a symbol, units and a label. Names of columns are put together from it here, and taken apart here: a
//! number of a node (`u_49`), a spectrum window (`line_amplitude_49_w1`), what became of it in an ensemble or beside a reference
//! (`spread_`, `ensemble_mean_`, `reference_`, `bias_`).

pub mod columns;
mod export;
mod name;
mod parameters;
pub mod tables;
pub mod units;

pub use export::{QuantityEntry, UnitEntry, entries, json};
pub use name::{Name, Place, Variant};
pub use units::{Unit, Units};

/// One quantity.
#[derive(Debug, PartialEq)]
pub struct Quantity {
    /// Its name in columns; of a field of a scenario its path without indices, such as `string.sections.length`.
    pub name: &'static str,
    /// Its symbol in the equations of the model; empty where it has none.
    pub symbol: &'static str,
    /// Its units; none of names, and of numbers of things.
    pub units: Option<&'static Units>,
    /// Its name in pictures.
    pub label: &'static str,
    /// Its meaning, in a sentence; empty of fields of a scenario, whose own documentation gives it.
    pub meaning: &'static str,
}

impl Quantity {
    /// The unit in which it is kept and served (`1` for ratios).
    pub fn unit(&self) -> Option<&'static str> {
        self.units.map(|units| units.kept)
    }

    /// The name of its column for a node, which is numbered from 1 at the top.
    pub fn at_node(&self, node: usize) -> String {
        format!("{}_{node}", self.name)
    }

    /// The name of its column for a node by the text of its [`Place`]: its number, or a depth.
    pub fn at(&self, place: &str) -> String {
        format!("{}_{place}", self.name)
    }

    /// The name of its column for one of several things that there are columns for, such as `orbit_size_2_percent` of `cost_cpu_time`.
    pub fn of(&self, detail: &str) -> String {
        format!("{}_{detail}", self.name)
    }

    /// The name of its column for a node by the text of its [`Place`] and a spectrum window, which is numbered from 1.
    pub fn in_window(&self, place: &str, window: usize) -> String {
        format!("{}_{place}_w{window}", self.name)
    }
}

impl From<&Quantity> for String {
    fn from(quantity: &Quantity) -> String {
        quantity.name.to_owned()
    }
}

/// The quantity that a column's name or a scenario's path stands for, if it is one of the vocabulary.
pub fn of(name: &str) -> Option<&'static Quantity> {
    Name::parse(name).map(|name| name.quantity)
}

/// The unit of a column, or of a field of a scenario (`1` for ratios); none for names, numbers of things and unknown columns.
pub fn unit(name: &str) -> Option<&'static str> {
    Name::parse(name)?.unit()
}

/// All quantities: those of columns, then those of fields of a scenario.
pub fn all() -> impl Iterator<Item = &'static Quantity> {
    columns::ALL.iter().copied().chain(parameters::ALL)
}
