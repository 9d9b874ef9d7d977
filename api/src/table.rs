//! Tables on the wire: objects of columns.

use std::fmt::Write as _;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::openapi::schema::AnyOfBuilder;
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

use crate::problem::ProblemDetails;

/// A table by columns, all of one length. A value that does not exist is `null`, never NaN.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
pub struct Table {
    /// What holds for the table as a whole, such as the node, its depth, or the number of samples.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub attributes: IndexMap<String, Value>,
    /// The columns, by name.
    #[schema(example = json!({"time": [0.0, 0.001], "u_49": [0.0129, 0.0131]}))]
    pub columns: IndexMap<String, Column>,
    /// Units of the columns that have one (`1` for ratios), by column name.
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
    /// Texts.
    Text(Vec<Option<String>>),
}

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

impl Column {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Column::Integer(values) => values.len(),
            Column::Number(values) => values.len(),
            Column::Text(values) => values.len(),
        }
    }

    /// True when there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Table {
    /// Adds a column, with the unit that its name stands for.
    pub fn push(&mut self, name: impl Into<String>, column: Column) {
        let name = name.into();
        if let Some(unit) = crate::units::unit(&name) {
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

    /// Sets an attribute of the table as a whole.
    #[must_use]
    pub fn attribute(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.attributes.insert(name.to_owned(), value.into());
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

    /// The problem that the table has no such column; it names those that there are.
    pub fn no_such_column(&self, name: &str) -> Box<ProblemDetails> {
        let names: Vec<&str> = self.columns.keys().map(String::as_str).collect();
        let detail = format!("there is no such column; there are {}", names.join(", "));
        ProblemDetails::invalid_parameter("fields", Some(name), detail).into()
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.columns.values().next().map_or(0, Column::len)
    }

    /// One line a row, after a line of column names; a missing value is empty. Numbers have the fewest digits that
    /// give the same number back, as in JSON.
    pub fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        self.write_csv(&mut writer).expect("records of one length can be written to memory");
        let bytes = writer.into_inner().expect("memory can be written to");
        String::from_utf8(bytes).expect("texts make a text")
    }

    fn write_csv(&self, writer: &mut csv::Writer<Vec<u8>>) -> Result<(), csv::Error> {
        writer.write_record(self.columns.keys())?;
        let mut number = String::new();
        for row in 0..self.rows() {
            for column in self.columns.values() {
                number.clear();
                match column {
                    Column::Integer(values) => {
                        if let Some(value) = values[row] {
                            let _ = write!(number, "{value}");
                        }
                        writer.write_field(&number)?;
                    }
                    Column::Number(values) => {
                        if values[row].is_finite() {
                            let _ = write!(number, "{:?}", values[row]);
                        }
                        writer.write_field(&number)?;
                    }
                    Column::Text(values) => {
                        writer.write_field(values[row].as_deref().unwrap_or_default())?;
                    }
                }
            }
            writer.write_record(None::<&[u8]>)?;
        }
        Ok(())
    }
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
    fn csv_leaves_missing_values_empty_and_quotes_what_needs_it() {
        let table = Table::default()
            .with("node", Column::Integer(vec![Some(1), None]))
            .with("radius", Column::Number(vec![1e-7, f64::NAN]))
            .with("error", Column::Text(vec![None, Some("diverged, at once".to_owned())]));
        assert_eq!(table.csv(), "node,radius,error\n1,1e-7,\n,,\"diverged, at once\"\n");
    }
}
