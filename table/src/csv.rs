//! Tables as comma-separated values (RFC 4180).

use std::fmt::Write as _;

use drillsweep_quantity::units::RATIO;

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
    write_below(source.layout().columns.keys().cloned(), source, sink)
}

/// The same with units in the first line: `mud_density [ppg]`; ratios have none.
///
/// # Errors
/// As [`write_to`].
pub fn write_with_units(source: &impl Source, sink: &mut Sink<'_>) -> Result<(), TableError> {
    let Table { columns, units, .. } = source.layout();
    let head = |name: &String| match units.get(name).filter(|unit| *unit != RATIO.kept) {
        Some(unit) => format!("{name} [{unit}]"),
        None => name.clone(),
    };
    write_below(columns.keys().map(head), source, sink)
}

/// Lines of values below the first line.
fn write_below(
    heads: impl Iterator<Item = String>,
    source: &impl Source,
    sink: &mut Sink<'_>,
) -> Result<(), TableError> {
    let mut writer = ::csv::Writer::from_writer(sink);
    writer.write_record(heads.collect::<Vec<_>>()).map_err(failed)?;
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
    fn units_stand_in_the_first_line_on_request() {
        let table = Table::default()
            .with("node", Column::Integer(vec![Some(1)]))
            .with("measured_depth", Column::Number(vec![1.5]))
            .with("friction_coefficient", Column::Number(vec![0.5]));
        let mut bytes = Vec::new();
        write_with_units(&table, &mut bytes).unwrap();
        assert_eq!(bytes, b"node,measured_depth [m],friction_coefficient\n1,1.5,0.5\n");
    }

    #[test]
    fn columns_of_different_length_are_refused() {
        let table = Table::default()
            .with("time", Column::Number(vec![0.0, 1.0]))
            .with("u", Column::Number(vec![0.0]));
        assert!(write(&table).is_err());
    }
}
