//! Tables as Parquet: byte-stream-split and zstd, in row groups small enough to read a window of a long history without the rest.

use std::io::Write;
use std::ops::Range;
use std::sync::Arc;

use ::parquet::basic::{Compression, ConvertedType, Encoding, Repetition, Type as PhysicalType, ZstdLevel};
use ::parquet::column::reader::ColumnReader;
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use ::parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use ::parquet::schema::types::{ColumnPath, Type};
use bytes::Bytes;

use crate::table::{Column, Table};

/// Rows of a row group at most.
const ROW_GROUP: usize = 10_000;

/// Bytes of a row group at most, before compression: what writing or reading a table of many columns takes at once.
const ROW_GROUP_BYTES: usize = 32 << 20;

/// Prefix of the metadata keys that hold units.
const UNIT_PREFIX: &str = "unit.";

/// Why a table cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The bytes are not what this program writes, or cannot be encoded.
    #[error("parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// Columns of different length.
    #[error("column {name:?} has {rows} rows, the first one {expected}")]
    Ragged {
        /// The column.
        name: String,
        /// Its length.
        rows: usize,
        /// The first column's length.
        expected: usize,
    },
    /// A piece of a table with other columns than the ones before it.
    #[error("a piece of a table has other columns than the table")]
    OtherColumns,
    /// A column of a type that is not used here.
    #[error("column {0:?} has a type that is not used here")]
    UnknownType(String),
    /// A text that is not UTF-8.
    #[error("column {0:?} holds text that is not UTF-8")]
    NotUtf8(String),
}

/// A table as Parquet, without its attributes. Every column is required there: a missing number is NaN (whole numbers of which one is
/// missing become numbers of double precision), a missing text is empty. The same table gives the same bytes.
///
/// # Errors
/// When the columns differ in length.
pub fn write(table: &Table) -> Result<Vec<u8>, TableError> {
    let mut writer = Writer::new(Vec::new(), table)?;
    writer.write(table)?;
    writer.finish()
}

/// Writes a table piece by piece, as [`write()`] writes it in one; it holds one row group in memory, whatever the length of the table.
/// How a table is cut into pieces does not change the bytes.
pub struct Writer<W: Write + Send> {
    file: SerializedFileWriter<W>,
    types: Vec<PhysicalType>,
    rows_of_group: usize,
    /// The rows that do not make a row group yet, in the columns of the layout.
    pending: Table,
    has_groups: bool,
}

impl<W: Write + Send> Writer<W> {
    /// A writer of tables with the columns of `layout`, which may have rows: what is missing among its whole numbers says
    /// whether something may be missing.
    ///
    /// # Errors
    /// When the sink fails.
    pub fn new(sink: W, layout: &Table) -> Result<Self, TableError> {
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
    /// When the columns are not those of the layout or differ in length, or the sink fails.
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
                self.pending.append(rows, start..end);
                if self.pending.rows() == self.rows_of_group {
                    self.write_pending()?;
                }
            }
            start = end;
        }
        Ok(())
    }

    /// Writes what is left, and the file's footer.
    ///
    /// # Errors
    /// When the sink fails.
    pub fn finish(mut self) -> Result<W, TableError> {
        // A table without rows has a row group without rows.
        if self.pending.rows() > 0 || !self.has_groups {
            self.write_pending()?;
        }
        Ok(self.file.into_inner()?)
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

fn write_group<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
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

/// Names of the columns of a Parquet table, without reading them.
///
/// # Errors
/// When the bytes are not Parquet.
pub fn column_names(bytes: Bytes) -> Result<Vec<String>, TableError> {
    let reader = SerializedFileReader::new(bytes)?;
    let schema = reader.metadata().file_metadata().schema_descr();
    Ok(schema.columns().iter().map(|column| column.name().to_owned()).collect())
}

/// Reads a Parquet table: some columns or all, some rows or all. Rows beyond the end are left out. Units are those that were written,
/// or where none were those of the vocabulary.
///
/// # Errors
/// When the bytes are not a table that [`write()`] writes.
pub fn read(bytes: Bytes, columns: Option<&[&str]>, rows: Option<Range<usize>>) -> Result<Table, TableError> {
    let wanted = rows.unwrap_or(0..usize::MAX);
    let reader = SerializedFileReader::new(bytes)?;
    let metadata = reader.metadata().file_metadata();
    let units = metadata.key_value_metadata();
    let unit = |name: &str| {
        let key = format!("{UNIT_PREFIX}{name}");
        units?.iter().find(|entry| entry.key == key)?.value.clone()
    };
    let mut table = Table::default();
    for (index, descriptor) in metadata.schema_descr().columns().iter().enumerate() {
        let name = descriptor.name();
        if columns.is_some_and(|columns| !columns.contains(&name)) {
            continue;
        }
        let mut column = match descriptor.physical_type() {
            PhysicalType::DOUBLE => Column::Number(Vec::new()),
            PhysicalType::FLOAT => Column::Single(Vec::new()),
            PhysicalType::INT64 => Column::Integer(Vec::new()),
            PhysicalType::BYTE_ARRAY => Column::Text(Vec::new()),
            _ => return Err(TableError::UnknownType(name.to_owned())),
        };
        let mut start = 0;
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group)?;
            let group_rows = group.metadata().num_rows().unsigned_abs() as usize;
            let from = wanted.start.clamp(start, start + group_rows) - start;
            let to = wanted.end.clamp(start, start + group_rows) - start;
            if from < to {
                read_column(group.as_ref(), index, name, from..to, &mut column)?;
            }
            start += group_rows;
        }
        table.push(name, column);
        if let Some(unit) = unit(name) {
            table.units.insert(name.to_owned(), unit);
        }
    }
    Ok(table)
}

fn read_column(
    group: &dyn RowGroupReader,
    index: usize,
    name: &str,
    rows: Range<usize>,
    column: &mut Column,
) -> Result<(), TableError> {
    macro_rules! read {
        ($reader:expr, $values:expr, $convert:expr) => {{
            let mut reader = $reader;
            reader.skip_records(rows.start)?;
            let mut values = Vec::with_capacity(rows.len());
            reader.read_records(rows.len(), None, None, &mut values)?;
            for value in values {
                $values.push($convert(value)?);
            }
        }};
    }
    match (group.get_column_reader(index)?, column) {
        (ColumnReader::DoubleColumnReader(reader), Column::Number(values)) => {
            read!(reader, values, Ok::<f64, TableError>);
        }
        (ColumnReader::FloatColumnReader(reader), Column::Single(values)) => {
            read!(reader, values, Ok::<f32, TableError>);
        }
        (ColumnReader::Int64ColumnReader(reader), Column::Integer(values)) => {
            read!(reader, values, |value| Ok::<_, TableError>(Some(value)));
        }
        (ColumnReader::ByteArrayColumnReader(reader), Column::Text(values)) => {
            let text = |bytes: ByteArray| match bytes.as_utf8() {
                Ok(text) => Ok(Some(text.to_owned())),
                Err(_) => Err(TableError::NotUtf8(name.to_owned())),
            };
            read!(reader, values, text);
        }
        _ => return Err(TableError::UnknownType(name.to_owned())),
    }
    Ok(())
}
