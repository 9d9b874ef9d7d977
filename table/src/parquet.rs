//! Tables as Parquet: byte-stream-split and zstd, in row groups small enough to read a window of a long history without the rest.

use std::ops::Range;
use std::sync::Arc;

use ::parquet::basic::{Compression, ConvertedType, Encoding, Repetition, Type as PhysicalType, ZstdLevel};
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use ::parquet::schema::types::{ColumnPath, Type};

use self::format::{ROW_GROUP, UNIT_PREFIX};
use crate::error::TableError;
use crate::source::{Sink, Source};
use crate::table::{Column, Table};

mod format;
mod read;

pub use read::{Cut, FOOTER_END, ReadAt, StoredTable, memory, read};

/// Bytes of a row group at most, before compression: the memory of writing or reading a table of many columns.
const ROW_GROUP_BYTES: usize = 32 << 20;

/// Bytes of memory that a [`Writer`] takes at most, in addition to its footer.
pub const MEMORY_OF_WRITER: u64 = ROW_GROUP_BYTES as u64;

/// A table as Parquet, without its attributes. Every column is required there: a missing number is NaN (whole numbers of which one is
/// missing become numbers of double precision), a missing text is empty. The same table gives the same bytes.
///
/// # Errors
/// The columns differ in length.
pub fn write(table: &Table) -> Result<Vec<u8>, TableError> {
    let mut bytes = Vec::new();
    write_to(table, &mut bytes)?;
    Ok(bytes)
}

/// The same to a sink, from pieces of some rows; it holds one of them and a row group in memory.
///
/// # Errors
/// A piece cannot be read, the columns differ in length, or the sink fails.
pub fn write_to(source: &impl Source, sink: &mut Sink<'_>) -> Result<(), TableError> {
    let mut writer = Writer::new(sink, source.layout())?;
    for piece in source.by_rows() {
        writer.write(piece?.as_ref())?;
    }
    writer.finish()
}

/// Writes a table piece by piece, as [`write()`] writes it in one; it holds one row group in memory, whatever the length of the table.
/// The bytes do not depend on the pieces into which a table is cut.
pub struct Writer<'t, 's> {
    file: SerializedFileWriter<&'t mut Sink<'s>>,
    types: Vec<PhysicalType>,
    rows_of_group: usize,
    /// The rows that do not make a row group yet, in the columns of the layout.
    pending: Table,
    has_groups: bool,
}

impl<'t, 's> Writer<'t, 's> {
    /// A writer of tables with the columns of `layout`, which may have rows: what is missing among its whole numbers says
    /// whether something may be missing.
    ///
    /// # Errors
    /// The sink fails.
    pub fn new(sink: &'t mut Sink<'s>, layout: &Table) -> Result<Self, TableError> {
        // Other levels of Zstandard are not built (`.cargo/config.toml`).
        let mut properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::try_new(3)?))
            .set_dictionary_enabled(false)
            .set_created_by("drillsweep".to_owned());
        let mut units = Vec::new();
        let mut fields = Vec::with_capacity(layout.columns.len());
        let types: Vec<PhysicalType> = layout.columns.values().map(physical_type).collect();
        for (name, &physical) in layout.columns.keys().zip(&types) {
            let converted =
                if physical == PhysicalType::BYTE_ARRAY { ConvertedType::UTF8 } else { ConvertedType::NONE };
            fields.push(Arc::new(
                Type::primitive_type_builder(name, physical)
                    .with_repetition(Repetition::REQUIRED)
                    .with_converted_type(converted)
                    .build()?,
            ));
            if matches!(physical, PhysicalType::DOUBLE | PhysicalType::FLOAT) {
                let path = ColumnPath::new(vec![name.clone()]);
                properties = properties.set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT);
            }
            if let Some(unit) = layout.units.get(name) {
                units.push(KeyValue::new(format!("{UNIT_PREFIX}{name}"), unit.clone()));
            }
        }
        let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);
        let properties = Arc::new(properties.set_key_value_metadata(Some(units)).build());
        Ok(Self {
            file: SerializedFileWriter::new(sink, schema, properties)?,
            rows_of_group: rows_of_group(&types),
            types,
            pending: layout.without_rows(),
            has_groups: false,
        })
    }

    /// Adds rows.
    ///
    /// # Errors
    /// The columns are not those of the layout or differ in length, or the sink fails.
    pub fn write(&mut self, rows: &Table) -> Result<(), TableError> {
        let count = rows.rows();
        for (name, column) in &rows.columns {
            if column.len() != count {
                return Err(TableError::Ragged { name: name.clone(), rows: column.len(), expected: count });
            }
        }
        if !rows.has_columns_of(&self.pending) {
            return Err(TableError::OtherColumns);
        }
        let mut start = 0;
        while start < count {
            let end = (start + self.rows_of_group - self.pending.rows()).min(count);
            if end - start == self.rows_of_group {
                self.write_group(rows, start..end)?;
            } else {
                self.pending.append(rows, start..end, self.rows_of_group);
                if self.pending.rows() == self.rows_of_group {
                    self.write_pending()?;
                }
            }
            start = end;
        }
        Ok(())
    }

    /// Writes the rest, and the file's footer.
    ///
    /// # Errors
    /// The sink fails.
    pub fn finish(mut self) -> Result<(), TableError> {
        // A table without rows has a row group without rows.
        if self.pending.rows() > 0 || !self.has_groups {
            self.write_pending()?;
        }
        self.file.finish()?;
        Ok(())
    }

    fn write_pending(&mut self) -> Result<(), TableError> {
        let emptied = self.pending.without_rows();
        let pending = std::mem::replace(&mut self.pending, emptied);
        self.write_group(&pending, 0..pending.rows())
    }

    fn write_group(&mut self, table: &Table, rows: Range<usize>) -> Result<(), TableError> {
        let mut group = self.file.next_row_group()?;
        write_group(&mut group, table, &self.types, rows)?;
        group.close()?;
        self.has_groups = true;
        Ok(())
    }
}

/// Rows of a row group of columns of these types.
fn rows_of_group(types: &[PhysicalType]) -> usize {
    let width: usize =
        types.iter().map(|physical| if *physical == PhysicalType::FLOAT { 4 } else { 8 }).sum();
    (ROW_GROUP_BYTES / width.max(1)).clamp(1, ROW_GROUP)
}

/// The type in which a column is kept.
fn physical_type(column: &Column) -> PhysicalType {
    match column {
        Column::Integer(values) if values.iter().all(Option::is_some) => PhysicalType::INT64,
        Column::Integer(_) | Column::Number(_) => PhysicalType::DOUBLE,
        Column::Single(_) => PhysicalType::FLOAT,
        Column::Text(_) => PhysicalType::BYTE_ARRAY,
    }
}

fn write_group(
    group: &mut SerializedRowGroupWriter<'_, &mut Sink<'_>>,
    table: &Table,
    types: &[PhysicalType],
    rows: Range<usize>,
) -> Result<(), TableError> {
    for (column, physical) in table.columns.values().zip(types) {
        let Some(mut writer) = group.next_column()? else { break };
        let rows = rows.clone();
        match (column, physical) {
            (Column::Number(values), PhysicalType::DOUBLE) => {
                writer.typed::<DoubleType>().write_batch(&values[rows], None, None)?;
            }
            (Column::Single(values), PhysicalType::FLOAT) => {
                writer.typed::<FloatType>().write_batch(&values[rows], None, None)?;
            }
            (Column::Integer(values), PhysicalType::INT64) => {
                let values: Option<Vec<i64>> = values[rows].iter().copied().collect();
                let values = values.ok_or(TableError::OtherColumns)?;
                writer.typed::<Int64Type>().write_batch(&values, None, None)?;
            }
            (Column::Integer(values), PhysicalType::DOUBLE) => {
                let number = |value: &Option<i64>| value.map_or(f64::NAN, |value| value as f64);
                let values: Vec<f64> = values[rows].iter().map(number).collect();
                writer.typed::<DoubleType>().write_batch(&values, None, None)?;
            }
            (Column::Text(values), PhysicalType::BYTE_ARRAY) => {
                let text = |text: &Option<String>| ByteArray::from(text.as_deref().unwrap_or_default());
                let texts: Vec<ByteArray> = values[rows].iter().map(text).collect();
                writer.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
            }
            _ => return Err(TableError::OtherColumns),
        }
        writer.close()?;
    }
    Ok(())
}
