//! Vocabulary of quantities in the OpenAPI document: units of a scenario's fields, and the columns of every table.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use drillsweep_quantity::Quantity;
use drillsweep_table::tables::{self, Layout};
use serde_json::{Map, Value, json};

/// Member of a schema with the unit of the field.
const UNIT: &str = "x-unit";

const SCHEMAS: &str = "#/components/schemas/";

/// Adds the unit of each numeric field of a scenario (`x-unit`), which may be a text with a unit, and the columns of each table to its route.
pub(crate) fn describe(document: &mut Value) {
    if let Some(schemas) = document["components"]["schemas"].as_object_mut() {
        name_units(schemas);
    }
    for layout in tables::ALL {
        let path = format!("/v1/sweeps/{{id}}/points/{{n}}/{}", layout.name);
        let Some(operation) = document["paths"].get_mut(&path).and_then(|path| path.get_mut("get")) else {
            continue;
        };
        let told = operation["description"].as_str().map_or_else(String::new, |text| format!("{text}\n\n"));
        operation["description"] = json!(told + &columns(layout));
    }
}

/// The columns of a table as Markdown.
fn columns(layout: &Layout) -> String {
    let mut text = "| column | unit | meaning |\n|---|---|---|\n".to_owned();
    let mut line = |name: String, quantity: &Quantity| {
        let unit = quantity
            .unit()
            .filter(|unit| *unit != drillsweep_quantity::units::RATIO.kept)
            .unwrap_or_default();
        let _ = writeln!(text, "| `{name}` | {unit} | {} |", quantity.meaning);
    };
    for quantity in layout.columns {
        line(quantity.name.to_owned(), quantity);
    }
    for quantity in layout.by_node {
        line(quantity.of("N"), quantity);
    }
    text.trim_end().to_owned()
}

/// Visits the schemas of a scenario, each under its first path.
fn name_units(schemas: &mut Map<String, Value>) {
    let mut waiting = vec![("Scenario".to_owned(), String::new())];
    let mut seen = BTreeSet::new();
    while let Some((name, path)) = waiting.pop() {
        if let Some(schema) = schemas.get_mut(&name).filter(|_| seen.insert(name)) {
            name_unit(schema, &path, &mut waiting);
        }
    }
}

fn name_unit(schema: &mut Value, path: &str, waiting: &mut Vec<(String, String)>) {
    if let Some(name) = schema["$ref"].as_str().and_then(|reference| reference.strip_prefix(SCHEMAS)) {
        waiting.push((name.to_owned(), path.to_owned()));
        return;
    }
    if is_number(schema) {
        if let Some(unit) = drillsweep_quantity::unit(path) {
            schema[UNIT] = json!(unit);
            allow_text(schema);
        }
        return;
    }
    for (field, schema) in schema.get_mut("properties").and_then(Value::as_object_mut).into_iter().flatten() {
        let path = if path.is_empty() { field.clone() } else { format!("{path}.{field}") };
        name_unit(schema, &path, waiting);
    }
    for forms in ["oneOf", "anyOf", "allOf"] {
        for form in schema.get_mut(forms).and_then(Value::as_array_mut).into_iter().flatten() {
            name_unit(form, path, waiting);
        }
    }
    if let Some(items) = schema.get_mut("items") {
        name_unit(items, path, waiting);
    }
}

/// A number, decimal or with a fraction, and a unit.
const WITH_UNIT: &str =
    r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?[-\s]*(\d+/\d+)?\s*(1/)?[^\s\d.,][^,]*$";

/// Allows a text with a unit in place of a number.
pub(super) fn allow_text(schema: &mut Value) {
    let kinds = match schema["type"].take() {
        Value::Array(kinds) => kinds,
        kind => vec![kind],
    };
    schema["type"] = kinds.into_iter().chain([json!("string")]).collect();
    schema["pattern"] = json!(WITH_UNIT);
}

fn is_number(schema: &Value) -> bool {
    let is_it = |kind: &Value| kind == "number" || kind == "integer";
    match &schema["type"] {
        Value::Array(kinds) => kinds.iter().any(is_it),
        kind => is_it(kind),
    }
}
