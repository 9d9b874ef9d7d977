//! The vocabulary for programs that are not written in Rust.

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Value, json};

use crate::all::all;
use crate::classes::{CLASSES, Class};
use crate::columns;
use crate::definition::Quantity;
use crate::units::{self, Unit};

/// Meaning of a name: a column without its node and spectrum window, or a field of a scenario by its path without indices.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct QuantityEntry {
    /// Its name in pictures and texts, in the words of the field.
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
    /// Words of a column of texts that has few, in their order: classes of points, the most severe first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<WordEntry>,
}

/// A word of a column of texts.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct WordEntry {
    /// The word, such as `stick_slip`.
    pub word: &'static str,
    /// Its colour in pictures, such as `#d55e00`.
    pub colour: String,
}

/// A further unit of a served quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct UnitEntry {
    /// Symbol, such as `mm`.
    pub unit: &'static str,
    /// Size in the served unit: 0.001 for a millimetre of a length in metres.
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
    let word = |class: &Class| WordEntry { word: class.name, colour: class.css() };
    QuantityEntry {
        label: quantity.label,
        symbol: named(quantity.symbol),
        meaning: named(quantity.meaning),
        dimension: quantity.units.map(|units| units.dimension),
        unit: quantity.units.map(|units| units.kept),
        shown: in_units.map(|units| unit(&units.shown)),
        field: in_units.map(|units| unit(&units.field)),
        words: if quantity == &columns::CLASS { CLASSES.iter().map(word).collect() } else { Vec::new() },
    }
}
