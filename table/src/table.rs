//! The table: columns by name, of one length.

use std::ops::Range;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use drillsweep_quantity::unit;

/// A table by columns, all of one length. A value that does not exist is `null`, never NaN.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Table {
    /// Attributes of the table as a whole, such as the node, its depth, or the number of samples.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub attributes: IndexMap<String, Value>,
    /// The columns, by name.
    #[schema(example = json!({"time": [0.0, 0.001], "u_49": [0.0129, 0.0131]}))]
    pub columns: IndexMap<String, Column>,
    /// Units of the columns that have one (`1` for ratios), by column name; in units that a request chooses, also of attributes.
    #[schema(example = json!({"time": "s", "u_49": "m"}))]
    pub units: IndexMap<String, String>,
}

/// The values of one column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Column {
    /// Whole numbers.
    Integer(Vec<Option<i64>>),
    /// Numbers; those that are not finite in memory are `null` on the wire.
    #[serde(with = "finite_or_null")]
    Number(Vec<f64>),
    /// Numbers in single precision, in which recorded samples are kept; read from JSON they are [`Column::Number`].
    #[serde(with = "finite_or_null_single")]
    Single(Vec<f32>),
    /// Texts.
    Text(Vec<Option<String>>),
}

impl Column {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Column::Integer(values) => values.len(),
            Column::Number(values) => values.len(),
            Column::Single(values) => values.len(),
            Column::Text(values) => values.len(),
        }
    }

    /// True when there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of these rows, in their order.
    ///
    /// # Panics
    /// At a row that there is not.
    #[must_use]
    pub fn rows(&self, rows: impl Iterator<Item = usize>) -> Column {
        match self {
            Column::Integer(values) => Column::Integer(rows.map(|row| values[row]).collect()),
            Column::Number(values) => Column::Number(rows.map(|row| values[row]).collect()),
            Column::Single(values) => Column::Single(rows.map(|row| values[row]).collect()),
            Column::Text(values) => Column::Text(rows.map(|row| values[row].clone()).collect()),
        }
    }

    fn append(&mut self, other: &Column, rows: Range<usize>, most: usize) {
        match (self, other) {
            (Column::Integer(own), Column::Integer(values)) => extend(own, &values[rows], most),
            (Column::Number(own), Column::Number(values)) => extend(own, &values[rows], most),
            (Column::Single(own), Column::Single(values)) => extend(own, &values[rows], most),
            (Column::Text(own), Column::Text(values)) => extend(own, &values[rows], most),
            _ => panic!("a column is continued in another type"),
        }
    }

    /// The same in double precision, if it is in single; every value is kept.
    #[must_use]
    pub fn widened(self) -> Column {
        match self {
            Column::Single(values) => Column::Number(values.into_iter().map(f64::from).collect()),
            column => column,
        }
    }

    /// The values as numbers, a missing one as NaN; none of texts.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Column::Integer(values) => {
                Some(values.iter().map(|value| value.map_or(f64::NAN, |value| value as f64)).collect())
            }
            Column::Number(values) => Some(values.clone()),
            Column::Single(values) => Some(values.iter().copied().map(f64::from).collect()),
            Column::Text(_) => None,
        }
    }
}

impl Table {
    /// Adds a column, with the unit that its name stands for.
    pub fn push(&mut self, name: impl Into<String>, column: Column) {
        let name = name.into();
        if let Some(unit) = unit(&name) {
            self.units.insert(name.clone(), unit.to_owned());
        }
        self.columns.insert(name, column);
    }

    /// The same with columns added one after the other.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, column: Column) -> Self {
        self.push(name, column);
        self
    }

    /// The columns with their units and types, without a row.
    #[must_use]
    pub fn without_rows(&self) -> Self {
        let emptied = |(name, column): (&String, &Column)| (name.clone(), column.rows(0..0));
        Self {
            attributes: self.attributes.clone(),
            columns: self.columns.iter().map(emptied).collect(),
            units: self.units.clone(),
        }
    }

    /// True if another table has columns of the same names and types, in the same order.
    pub(crate) fn has_columns_of(&self, other: &Table) -> bool {
        let type_of = |(name, column)| (name, std::mem::discriminant::<Column>(column));
        self.columns.iter().map(type_of).eq(other.columns.iter().map(type_of))
    }

    /// Adds some rows of a table with the same columns; as memory for the next ones is set aside, `most` rows are thought of at most.
    ///
    /// # Panics
    /// Names or types of the columns differ, or there are no such rows.
    pub(crate) fn append(&mut self, other: &Table, rows: Range<usize>, most: usize) {
        for (name, column) in &other.columns {
            self.columns[name].append(column, rows.clone(), most);
        }
    }

    /// Sets an attribute of the table as a whole.
    #[must_use]
    pub fn attribute(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.attributes.insert(name.to_owned(), value.into());
        self
    }

    /// The same with all numbers in double precision.
    #[must_use]
    pub fn widened(mut self) -> Self {
        self.columns = self.columns.into_iter().map(|(name, column)| (name, column.widened())).collect();
        self
    }

    /// The table of some columns, in the order in which they are named.
    ///
    /// # Errors
    /// The name that is no column's.
    pub fn select(&self, names: &[String]) -> Result<Table, String> {
        let mut selected = Table { attributes: self.attributes.clone(), ..Table::default() };
        for name in names {
            let column = self.columns.get(name).ok_or_else(|| name.clone())?;
            selected.push(name, column.clone());
            if let Some(unit) = self.units.get(name) {
                selected.units.insert(name.clone(), unit.clone());
            }
        }
        Ok(selected)
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.columns.values().next().map_or(0, Column::len)
    }
}

/// Adds values. Memory is doubled as a vector doubles it, but not beyond what `most` values take: what a row group takes would depend on
/// how its rows are cut into pieces.
fn extend<T: Clone>(own: &mut Vec<T>, values: &[T], most: usize) {
    let needed = own.len() + values.len();
    if needed > own.capacity() {
        own.reserve_exact(most.min(2 * needed).max(needed) - own.len());
    }
    own.extend_from_slice(values);
}

mod finite_or_null {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(values.iter().map(|value| value.is_finite().then_some(*value)))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
        let values = Vec::<Option<f64>>::deserialize(deserializer)?;
        Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
    }
}

mod finite_or_null_single {
    use serde::{Deserialize, Deserializer, Serializer};

    /// As the numbers in double precision that they are: the digits are the same whatever precision a table is held in.
    pub(super) fn serialize<S: Serializer>(values: &[f32], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(values.iter().map(|value| value.is_finite().then_some(f64::from(*value))))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
        let values = Vec::<Option<f32>>::deserialize(deserializer)?;
        Ok(values.into_iter().map(|value| value.unwrap_or(f32::NAN)).collect())
    }
}

/// Schema of the columns for the OpenAPI document.
mod schema {
    use utoipa::openapi::schema::AnyOfBuilder;
    use utoipa::openapi::{RefOr, Schema};
    use utoipa::{PartialSchema, ToSchema};

    use super::Column;

    impl PartialSchema for Column {
        /// Any of the forms: whole numbers are numbers too, and an empty column is one of each.
        fn schema() -> RefOr<Schema> {
            let forms = [
                (<Vec<Option<i64>>>::schema(), "Whole numbers."),
                (
                    <Vec<Option<f64>>>::schema(),
                    "Numbers; those that are not finite in memory are `null` on the wire.",
                ),
                (<Vec<Option<String>>>::schema(), "Texts."),
            ];
            let mut schema = AnyOfBuilder::new().description(Some("The values of one column."));
            for (mut form, description) in forms {
                if let RefOr::T(Schema::Array(array)) = &mut form {
                    array.description = Some(description.to_owned());
                }
                schema = schema.item(form);
            }
            Schema::AnyOf(schema.build()).into()
        }
    }

    impl ToSchema for Column {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_number_is_null_on_the_wire() {
        let table = Table::default().with("time", Column::Number(vec![0.0, f64::NAN, f64::INFINITY, 2.5]));
        let json = serde_json::to_value(&table).unwrap();
        assert_eq!(
            json,
            serde_json::json!({"columns": {"time": [0.0, null, null, 2.5]}, "units": {"time": "s"}})
        );
    }

    #[test]
    fn columns_keep_their_kind_through_json() {
        let table = Table::default()
            .with("node", Column::Integer(vec![Some(1), None]))
            .with("time", Column::Number(vec![1.0, 2.0]))
            .with("regime", Column::Text(vec![Some("laminar".to_owned()), None]));
        let text = serde_json::to_string(&table).unwrap();
        assert_eq!(serde_json::from_str::<Table>(&text).unwrap(), table);
    }

    #[test]
    fn single_precision_reads_the_same_held_in_double() {
        let table = Table::default().with("u_49", Column::Single(vec![0.1, -2.5e-7, f32::NAN, f32::MAX]));
        let text = serde_json::to_string(&table).unwrap();
        assert!(text.contains("0.10000000149011612"), "{text}");
        let widened = table.widened();
        assert_eq!(serde_json::to_string(&widened).unwrap(), text);
        assert!(
            matches!(&widened.columns["u_49"], Column::Number(values) if values[0] == f64::from(0.1_f32))
        );
    }
}
