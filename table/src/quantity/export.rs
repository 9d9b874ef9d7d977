//! The vocabulary for programs that are not written in Rust.

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Value, json};

use super::all::all;
use super::definition::Quantity;
use super::units::{self, Unit};

/// Meaning of a name: a column without its node and spectrum window, or a field of a scenario by its path without indices.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct QuantityEntry {
    /// Its name in pictures.
    pub label: &'static str,
    /// Its symbol in the equations of the model, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symbol: Option<&'static str>,
    /// Its meaning, in a sentence; absent of fields of a scenario, whose schema gives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub meaning: Option<&'static str>,
    /// Kind of quantity, such as `length`; absent, like all units, of names and numbers of things.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dimension: Option<&'static str>,
    /// The unit in which it is served and requests give it; `1` of ratios.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// The unit in which it is shown; absent of ratios.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shown: Option<UnitEntry>,
    /// The unit in which the oil field reads it; absent of ratios.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<UnitEntry>,
}

/// A unit beside the one in which a quantity is served.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct UnitEntry {
    /// How it is written, such as `mm`.
    pub unit: &'static str,
    /// How many of the served unit one of it is: 0.001 for a millimetre of a length in metres.
    pub size: f64,
}

/// The vocabulary by name, columns first.
pub fn entries() -> IndexMap<&'static str, QuantityEntry> {
    all().map(|quantity| (quantity.name, entry(quantity))).collect()
}

/// The same as JSON.
pub fn json() -> Value {
    json!(entries())
}

fn entry(quantity: &Quantity) -> QuantityEntry {
    let unit = |unit: &Unit| UnitEntry { unit: unit.symbol, size: unit.size };
    let named = |text: &'static str| Some(text).filter(|text| !text.is_empty());
    let in_units = quantity.units.filter(|units| *units != &units::RATIO);
    QuantityEntry {
        label: quantity.label,
        symbol: named(quantity.symbol),
        meaning: named(quantity.meaning),
        dimension: quantity.units.map(|units| units.dimension),
        unit: quantity.units.map(|units| units.kept),
        shown: in_units.map(|units| unit(&units.shown)),
        field: in_units.map(|units| unit(&units.field)),
    }
}
