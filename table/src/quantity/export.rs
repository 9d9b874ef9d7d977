//! The vocabulary for programs that are not written in Rust.

use serde_json::{Value, json};

use super::{Quantity, Unit, all, units};

/// The vocabulary as JSON, by name: symbol, dimension, the unit in which a quantity is kept, those in which it is shown and read in the
/// oil field with their sizes in the unit in which it is kept, label and meaning. What a quantity does not have is absent.
pub fn json() -> Value {
    let quantities: serde_json::Map<String, Value> =
        all().map(|quantity| (quantity.name.to_owned(), entry(quantity))).collect();
    Value::Object(quantities)
}

fn entry(quantity: &Quantity) -> Value {
    let mut entry = serde_json::Map::new();
    entry.insert("label".into(), json!(quantity.label));
    for (name, text) in [("symbol", quantity.symbol), ("meaning", quantity.meaning)] {
        if !text.is_empty() {
            entry.insert(name.into(), json!(text));
        }
    }
    if let Some(units) = quantity.units {
        let unit = |unit: &Unit| json!({ "unit": unit.symbol, "size": unit.size });
        entry.insert("dimension".into(), json!(units.dimension));
        entry.insert("unit".into(), json!(units.kept));
        if units != &units::RATIO {
            entry.insert("shown".into(), unit(&units.shown));
            entry.insert("field".into(), unit(&units.field));
        }
    }
    Value::Object(entry)
}
