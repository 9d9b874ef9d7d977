//! Columns of a table in the words and units in which engineers read them.

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Quantity, Unit, UnitChoice, units};
use drillsweep_table::Table;
use indexmap::IndexMap;
use serde_json::Value;

use crate::error::ChartError;
use crate::picture::axis::three_digits;
use crate::place::{Place, at_place};
use crate::words::words;

/// Columns that are shown on one axis, in its unit.
pub(crate) struct Shown<'t> {
    pub(crate) columns: Vec<(&'t str, Vec<f64>)>,
    unit: Option<Unit>,
}

impl<'t> Shown<'t> {
    /// The numeric columns of these names, in the unit of the first; they must be kept in one unit.
    pub(crate) fn of(table: &'t Table, names: &[&str], choice: &UnitChoice) -> Result<Self, ChartError> {
        Self::within(table, names, names.first().and_then(|name| choice.shown(name)))
    }

    /// The same in a unit of one's own.
    pub(crate) fn within(table: &'t Table, names: &[&str], unit: Option<Unit>) -> Result<Self, ChartError> {
        let mut columns = Vec::new();
        for name in names {
            let Some((name, _)) = table.columns.get_key_value(*name) else {
                return Err(ChartError::no_such_column(table, name));
            };
            if names
                .first()
                .is_some_and(|first| drillsweep_quantity::unit(first) != drillsweep_quantity::unit(name))
            {
                return Err(ChartError::OtherUnit { name: name.to_owned() });
            }
            columns.push((name.as_str(), numbers(table, name)?));
        }
        if let Some(unit) = unit {
            for value in columns.iter_mut().flat_map(|(_, values)| values) {
                *value = unit.of(*value);
            }
        }
        Ok(Shown { columns, unit })
    }

    /// Label of the axis; for a column of one of the `places`, with its position.
    pub(crate) fn label(&self, places: &[Place], choice: &UnitChoice) -> String {
        let name = match self.columns.as_slice() {
            [(only, _)] => at_place(only, places, choice),
            several => common_words(several.iter().map(|(name, _)| *name)),
        };
        match self.unit {
            Some(unit) => format!("{name} [{}]", unit.symbol),
            None => name,
        }
    }
}

/// A value of a column in the unit in which it is shown.
pub(crate) fn amount(name: &str, value: f64, choice: &UnitChoice) -> String {
    match choice.shown(name) {
        Some(unit) => format!("{} {}", three_digits(unit.of(value)), unit.symbol),
        None => three_digits(value),
    }
}

/// Words that columns have in common: their quantity, or else its dimension.
fn common_words<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let quantities: Vec<&Quantity> = names.filter_map(drillsweep_quantity::of).collect();
    match quantities.as_slice() {
        [] => String::new(),
        [first, rest @ ..] if rest.iter().all(|other| other == first) => first.label.to_owned(),
        [first, ..] if first.units == Some(&units::WIDTH) => "displacement".to_owned(),
        [first, ..] => first.units.map_or("value", |units| units.dimension).to_owned(),
    }
}

pub(crate) fn with_unit(name: &str, choice: &UnitChoice) -> String {
    match choice.shown(name) {
        Some(unit) => format!("{} [{}]", words(name), unit.symbol),
        None => words(name),
    }
}

/// The values of an axis, in the unit in which it is shown.
pub(crate) fn axis(table: &Table, name: &str, choice: &UnitChoice) -> Result<Vec<f64>, ChartError> {
    let values = numbers(table, name)?;
    let unit = choice.shown(name);
    Ok(values.into_iter().map(|value| unit.map_or(value, |unit| unit.of(value))).collect())
}

/// The node that a table is of, with its component and its depth.
pub(crate) fn node_of(table: &Table, choice: &UnitChoice) -> String {
    let attribute = |name: &str| table.attributes.get(name).and_then(Value::as_f64);
    match (attribute(NODE.name), attribute(MEASURED_DEPTH.name)) {
        (Some(node), Some(depth)) => {
            let unit = choice.depth();
            let component = table.attributes.get(COMPONENT.name).and_then(Value::as_str);
            let component = component.map_or_else(String::new, |name| format!("{name}, "));
            format!("{component}node {node} at {:.2} {}", unit.of(depth), unit.symbol)
        }
        _ => String::new(),
    }
}

/// The values of a numeric column; missing ones are not finite.
pub(crate) fn numbers(table: &Table, name: &str) -> Result<Vec<f64>, ChartError> {
    match table.columns.get(name) {
        Some(column) => column.numbers().ok_or_else(|| ChartError::Texts { name: name.to_owned() }),
        None => Err(ChartError::no_such_column(table, name)),
    }
}

/// The title of a picture: its subject, with the parameters.
pub fn caption(what: &str, parameters: &IndexMap<String, f64>, choice: &UnitChoice) -> String {
    let value =
        |(name, value): (&String, &f64)| format!(", {} {}", words(name), amount(name, *value, choice));
    let values: String = parameters.iter().map(value).collect();
    format!("{what}{values}")
}
