//! Tables in chosen units.

use std::borrow::Cow;

use drillsweep_quantity::{Unit, UnitChoice};
use indexmap::IndexMap;
use serde_json::Value;

use crate::error::TableError;
use crate::source::Source;
use crate::table::{Column, Table};

/// A source whose columns are converted piece by piece. Its layout has no rows.
pub struct InUnits<'s, S> {
    source: &'s S,
    layout: Table,
    units: IndexMap<String, Unit>,
}

impl<'s, S: Source> InUnits<'s, S> {
    /// The source in the units of a choice.
    pub fn new(source: &'s S, choice: &UnitChoice) -> Self {
        let units = units_of(source.layout(), choice);
        let mut layout = source.layout().without_rows();
        convert(&mut layout, &units);
        layout.name_units(choice);
        Self { source, layout, units }
    }

    fn converted<'p>(&self, piece: Result<Cow<'p, Table>, TableError>) -> Result<Cow<'p, Table>, TableError> {
        let mut piece = piece?;
        if piece.columns.keys().any(|name| self.units.contains_key(name)) {
            convert(piece.to_mut(), &self.units);
        }
        Ok(piece)
    }
}

impl<S: Source> Source for InUnits<'_, S> {
    fn layout(&self) -> &Table {
        &self.layout
    }

    fn by_rows(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>> {
        self.source.by_rows().map(|piece| self.converted(piece))
    }

    fn by_columns(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>> {
        self.source.by_columns().map(|piece| self.converted(piece))
    }
}

impl Table {
    /// The same in the units of a choice, with the attributes that are quantities of the vocabulary; `units` names those units, too.
    #[must_use]
    pub fn in_units(mut self, choice: &UnitChoice) -> Self {
        if !choice.is_kept() {
            let units = units_of(&self, choice);
            convert(&mut self, &units);
            self.name_units(choice);
        }
        self
    }

    /// Names the chosen units of columns and attributes, and converts the latter.
    fn name_units(&mut self, choice: &UnitChoice) {
        for name in self.columns.keys() {
            if let Some(unit) = choice.unit(name) {
                self.units.insert(name.clone(), unit.symbol.to_owned());
            }
        }
        let units = &mut self.units;
        for (name, value) in &mut self.attributes {
            convert_attribute(name, value, choice, units);
        }
    }
}

/// Units of the columns that are kept in another one.
fn units_of(layout: &Table, choice: &UnitChoice) -> IndexMap<String, Unit> {
    let numbers = layout.columns.iter().filter(|(_, column)| !matches!(column, Column::Text(_)));
    let units = numbers.filter_map(|(name, _)| Some((name.clone(), choice.unit(name)?)));
    units.filter(|(_, unit)| unit.size != 1.0).collect()
}

fn convert(table: &mut Table, units: &IndexMap<String, Unit>) {
    for (name, column) in &mut table.columns {
        let Some(unit) = units.get(name) else { continue };
        match column {
            Column::Number(values) => values.iter_mut().for_each(|value| *value = unit.written(*value)),
            Column::Single(values) => {
                values.iter_mut().for_each(|value| *value = unit.of(f64::from(*value)) as f32);
            }
            Column::Integer(values) => {
                let number = |value: &Option<i64>| value.map_or(f64::NAN, |value| unit.written(value as f64));
                *column = Column::Number(values.iter().map(number).collect());
            }
            Column::Text(_) => {}
        }
    }
}

/// Converts an attribute that is a number of a quantity, and such members of objects in it.
fn convert_attribute(
    name: &str,
    value: &mut Value,
    choice: &UnitChoice,
    units: &mut IndexMap<String, String>,
) {
    match value {
        Value::Number(number) => {
            let Some(unit) = choice.unit(name) else { return };
            if unit.size != 1.0
                && let Some(number) = number.as_f64()
            {
                *value = unit.written(number).into();
            }
            units.entry(name.to_owned()).or_insert_with(|| unit.symbol.to_owned());
        }
        Value::Object(members) => {
            for (name, value) in members {
                convert_attribute(name, value, choice, units);
            }
        }
        Value::Array(entries) => {
            for entry in entries.iter_mut().filter(|entry| entry.is_object()) {
                convert_attribute(name, entry, choice, units);
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::{csv, json as json_format, npz, parquet};

    /// A pound a gallon \[kg/m3\].
    const PPG: f64 = 0.453_592_37 / 0.003_785_411_784;

    fn choice(text: &str) -> UnitChoice {
        UnitChoice::parse(text).unwrap()
    }

    fn table() -> Table {
        Table::default()
            .with("ordinal", Column::Integer(vec![Some(1), Some(2)]))
            .with("mud_density", Column::Number(vec![10.5 * PPG, f64::NAN]))
            .with("operation.weight_on_bit", Column::Integer(vec![None, Some(-50_000)]))
            .with("u_49", Column::Single(vec![0.0127, f32::NAN]))
            .with("friction_coefficient", Column::Number(vec![0.03, 0.02]))
            .with("class", Column::Text(vec![None, Some("quiet".to_owned())]))
            .attribute("node", 49)
            .attribute("measured_depth", 304.8)
            .attribute("peaks", json!([{"frequency": 2.0, "amplitude": 0.0254}]))
    }

    #[test]
    fn columns_and_attributes_are_converted_and_their_units_named() {
        let written =
            serde_json::to_value(table().in_units(&choice("field,friction_coefficient:%"))).unwrap();
        let weight = -50_000.0 / 4_448.221_615_260_5;
        assert_eq!(
            written,
            json!({
                "attributes": {"node": 49, "measured_depth": 1000.0, "peaks": [{"frequency": 2.0, "amplitude": 1.0}]},
                "columns": {
                    "ordinal": [1, 2],
                    "mud_density": [10.5, null],
                    "operation.weight_on_bit": [null, weight],
                    "u_49": [0.5, null],
                    "friction_coefficient": [3.0, 2.0],
                    "class": [null, "quiet"],
                },
                "units": {
                    "mud_density": "ppg", "operation.weight_on_bit": "klbf", "u_49": "in", "friction_coefficient": "%",
                    "measured_depth": "ft", "frequency": "Hz", "amplitude": "in",
                },
            })
        );
        let kept = serde_json::to_value(table().in_units(&UnitChoice::default())).unwrap();
        assert_eq!(kept, serde_json::to_value(table()).unwrap());
    }

    #[test]
    fn a_source_in_pieces_has_the_bytes_of_the_converted_table() {
        // A stored table, whose whole numbers are all present.
        let stored = bytes::Bytes::from(parquet::write(&table()).unwrap());
        let open = || {
            let stored = parquet::StoredTable::open(stored.clone()).unwrap();
            let layout = stored.layout().clone().attribute("measured_depth", 304.8);
            stored.cut(layout, 0..usize::MAX, 1).unwrap()
        };
        for text in ["field", "si", "mud_density:ppg", "field,u_49:mm"] {
            let choice = choice(text);
            let (part, whole) = (open(), open().read().unwrap().in_units(&choice));
            let pieces = InUnits::new(&part, &choice);
            let mut written = [const { Vec::new() }; 4];
            let [json, csv, npz, parquet] = &mut written;
            json_format::write_to(&pieces, json).unwrap();
            csv::write_to(&pieces, csv).unwrap();
            npz::write_to(&pieces, npz).unwrap();
            parquet::write_to(&pieces, parquet).unwrap();
            let mut expected = [const { Vec::new() }; 4];
            let [json, csv, npz, parquet] = &mut expected;
            json_format::write_to(&whole, json).unwrap();
            csv::write_to(&whole, csv).unwrap();
            npz::write_to(&whole, npz).unwrap();
            parquet::write_to(&whole, parquet).unwrap();
            assert!(written == expected, "{text}");
            let read = crate::parquet::read(bytes::Bytes::from(written[3].clone()), None, None).unwrap();
            assert_eq!(read.units["mud_density"], choice.unit("mud_density").unwrap().symbol);
        }
    }
}
