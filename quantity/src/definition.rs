//! Quantities, each with its name, symbol, units, label and meaning.

use crate::units::Units;

/// One quantity.
#[derive(Debug, PartialEq)]
pub struct Quantity {
    /// Its name in columns; of a field of a scenario its path without indices, such as `string.sections.length`.
    pub name: &'static str,
    /// Its symbol in the equations of the model; empty if it has none.
    pub symbol: &'static str,
    /// Its units; none of names, and of numbers of things.
    pub units: Option<&'static Units>,
    /// Its name in pictures and texts, in the words of the field.
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

    /// The name of its column for a node by the text of its [`Place`](super::Place): its number, or a depth.
    pub fn at(&self, place: &str) -> String {
        format!("{}_{place}", self.name)
    }

    /// The name of its column for one of several things that there are columns for, such as `orbit_size_2_percent` of `cost_cpu_time`.
    pub fn of(&self, detail: &str) -> String {
        format!("{}_{detail}", self.name)
    }

    /// The name of its column for a node by the text of its [`Place`](super::Place) and a spectrum window, which is numbered from 1.
    pub fn in_window(&self, place: &str, window: usize) -> String {
        format!("{}_{place}_w{window}", self.name)
    }
}

impl From<&Quantity> for String {
    fn from(quantity: &Quantity) -> String {
        quantity.name.to_owned()
    }
}
