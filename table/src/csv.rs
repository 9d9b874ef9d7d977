//! Tables as comma-separated values (RFC 4180).

use std::fmt::Write as _;

use crate::error::TableError;
use crate::source::{Sink, Source};
use crate::table::{Column, Table};

/// One line a row, after a line of column names; a missing value is empty. Numbers have the fewest digits that give the same number
/// back, as in JSON.
///
/// # Errors
/// The columns differ in length.
pub fn write(table: &Table) -> Result<String, TableError> {
    let mut bytes = Vec::new();
    write_to(table, &mut bytes)?;
    String::from_utf8(bytes).map_err(|error| std::io::Error::other(error).into())
}

/// The same to a sink; it holds one piece of some rows in memory.
///
/// # Errors
/// A piece cannot be read, the columns differ in length, or the sink fails.
pub fn write_to(source: &impl Source, sink: &mut Sink<'_>) -> Result<(), TableError> {
    let mut writer = ::csv::Writer::from_writer(sink);
    writer.write_record(source.layout().columns.keys()).map_err(failed)?;
    for piece in source.by_rows() {
        write_rows(&mut writer, piece?.as_ref()).map_err(failed)?;
    }
    Ok(writer.flush()?)
}

fn failed(error: ::csv::Error) -> TableError {
    TableError::Sink(error.into())
}

fn write_rows(writer: &mut ::csv::Writer<&mut Sink<'_>>, table: &Table) -> Result<(), ::csv::Error> {
    let mut number = String::new();
    for row in 0..table.rows() {
        for column in table.columns.values() {
            number.clear();
            let value = match column {
                Column::Integer(values) => values.get(row).map(|value| {
                    if let Some(value) = value {
                        let _ = write!(number, "{value}");
                    }
                }),
                Column::Number(values) => values.get(row).map(|value| put(&mut number, *value)),
                Column::Single(values) => values.get(row).map(|value| put(&mut number, f64::from(*value))),
                Column::Text(values) => {
                    if let Some(text) = values.get(row) {
                        writer.write_field(text.as_deref().unwrap_or_default())?;
                    }
                    continue;
                }
            };
            // A column that has ended leaves the record short, which the writer refuses.
            if value.is_some() {
                writer.write_field(&number)?;
            }
        }
        writer.write_record(None::<&[u8]>)?;
    }
    Ok(())
}

fn put(text: &mut String, value: f64) {
    if value.is_finite() {
        let _ = write!(text, "{value:?}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_values_are_empty_and_special_characters_quoted() {
        let table = Table::default()
            .with("node", Column::Integer(vec![Some(1), None]))
            .with("radius", Column::Number(vec![1e-7, f64::NAN]))
            .with("u", Column::Single(vec![0.5, f32::NAN]))
            .with("error", Column::Text(vec![None, Some("diverged, at once".to_owned())]));
        assert_eq!(write(&table).unwrap(), "node,radius,u,error\n1,1e-7,0.5,\n,,,\"diverged, at once\"\n");
    }

    #[test]
    fn columns_of_different_length_are_refused() {
        let table = Table::default()
            .with("time", Column::Number(vec![0.0, 1.0]))
            .with("u", Column::Number(vec![0.0]));
        assert!(write(&table).is_err());
    }
}
