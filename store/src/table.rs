//! Tables of columns as Parquet: byte-stream-split and zstd, in row groups small enough to read a window of a long
//! history without the rest.

use std::ops::Range;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, Encoding, Repetition, Type as PhysicalType, ZstdLevel};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};

/// Rows of a row group.
const ROW_GROUP: usize = 10_000;

/// Prefix of the metadata keys that hold units.
const UNIT_PREFIX: &str = "unit.";

/// Named columns of one length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
}

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Unit of its values, such as `m/s`.
    pub unit: Option<String>,
    /// Its values.
    pub data: ColumnData,
}

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnData {
    /// Numbers of double precision.
    F64(Vec<f64>),
    /// Numbers of single precision.
    F32(Vec<f32>),
    /// Whole numbers.
    I64(Vec<i64>),
    /// Texts.
    Text(Vec<String>),
}

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
    /// A column of a type that is not used here.
    #[error("column {0:?} has a type that is not used here")]
    UnknownType(String),
    /// A text that is not UTF-8.
    #[error("column {0:?} holds text that is not UTF-8")]
    NotUtf8(String),
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.data.len())
    }

    /// Adds a column.
    pub fn push(&mut self, name: impl Into<String>, unit: Option<&str>, data: ColumnData) {
        self.columns.push(Column { name: name.into(), unit: unit.map(str::to_owned), data });
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}

impl ColumnData {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            ColumnData::F64(values) => values.len(),
            ColumnData::F32(values) => values.len(),
            ColumnData::I64(values) => values.len(),
            ColumnData::Text(values) => values.len(),
        }
    }

    /// True when there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn physical_type(&self) -> PhysicalType {
        match self {
            ColumnData::F64(_) => PhysicalType::DOUBLE,
            ColumnData::F32(_) => PhysicalType::FLOAT,
            ColumnData::I64(_) => PhysicalType::INT64,
            ColumnData::Text(_) => PhysicalType::BYTE_ARRAY,
        }
    }
}

/// A table as Parquet.
///
/// # Errors
/// When the columns differ in length.
pub fn encode_parquet(table: &Table) -> Result<Vec<u8>, TableError> {
    let rows = table.rows();
    let mut fields = Vec::with_capacity(table.columns.len());
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(3)?))
        .set_dictionary_enabled(false)
        .set_created_by("drillsweep".to_owned());
    let mut units = Vec::new();
    for column in &table.columns {
        if column.data.len() != rows {
            return Err(TableError::Ragged {
                name: column.name.clone(),
                rows: column.data.len(),
                expected: rows,
            });
        }
        let physical = column.data.physical_type();
        let converted =
            if physical == PhysicalType::BYTE_ARRAY { ConvertedType::UTF8 } else { ConvertedType::NONE };
        fields.push(Arc::new(
            Type::primitive_type_builder(&column.name, physical)
                .with_repetition(Repetition::REQUIRED)
                .with_converted_type(converted)
                .build()?,
        ));
        if matches!(column.data, ColumnData::F64(_) | ColumnData::F32(_)) {
            let path = ColumnPath::new(vec![column.name.clone()]);
            properties = properties.set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT);
        }
        if let Some(unit) = &column.unit {
            units.push(KeyValue::new(format!("{UNIT_PREFIX}{}", column.name), unit.clone()));
        }
    }
    let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);
    let properties = Arc::new(properties.set_key_value_metadata(Some(units)).build());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties)?;
    let mut start = 0;
    while start < rows || (start == 0 && rows == 0) {
        let end = (start + ROW_GROUP).min(rows);
        let mut group = writer.next_row_group()?;
        write_group(&mut group, table, start..end)?;
        group.close()?;
        if rows == 0 {
            break;
        }
        start = end;
    }
    writer.close()?;
    Ok(bytes)
}

fn write_group(
    group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>,
    table: &Table,
    rows: Range<usize>,
) -> Result<(), TableError> {
    for column in &table.columns {
        let Some(mut writer) = group.next_column()? else { break };
        let rows = rows.clone();
        match &column.data {
            ColumnData::F64(values) => {
                writer.typed::<DoubleType>().write_batch(&values[rows], None, None)?;
            }
            ColumnData::F32(values) => {
                writer.typed::<FloatType>().write_batch(&values[rows], None, None)?;
            }
            ColumnData::I64(values) => {
                writer.typed::<Int64Type>().write_batch(&values[rows], None, None)?;
            }
            ColumnData::Text(values) => {
                let texts: Vec<ByteArray> =
                    values[rows].iter().map(|text| ByteArray::from(text.as_str())).collect();
                writer.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
            }
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

/// Reads a Parquet table: some columns or all, some rows or all. Rows beyond the end are left out.
///
/// # Errors
/// When the bytes are not a table that [`encode_parquet`] writes.
pub fn decode_parquet(
    bytes: Bytes,
    columns: Option<&[&str]>,
    rows: Option<Range<usize>>,
) -> Result<Table, TableError> {
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
        let mut data = match descriptor.physical_type() {
            PhysicalType::DOUBLE => ColumnData::F64(Vec::new()),
            PhysicalType::FLOAT => ColumnData::F32(Vec::new()),
            PhysicalType::INT64 => ColumnData::I64(Vec::new()),
            PhysicalType::BYTE_ARRAY => ColumnData::Text(Vec::new()),
            _ => return Err(TableError::UnknownType(name.to_owned())),
        };
        let mut start = 0;
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group)?;
            let group_rows = group.metadata().num_rows().unsigned_abs() as usize;
            let from = wanted.start.clamp(start, start + group_rows) - start;
            let to = wanted.end.clamp(start, start + group_rows) - start;
            if from < to {
                read_column(group.as_ref(), index, name, from..to, &mut data)?;
            }
            start += group_rows;
        }
        table.columns.push(Column { name: name.to_owned(), unit: unit(name), data });
    }
    Ok(table)
}

fn read_column(
    group: &dyn RowGroupReader,
    index: usize,
    name: &str,
    rows: Range<usize>,
    data: &mut ColumnData,
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
    match (group.get_column_reader(index)?, data) {
        (ColumnReader::DoubleColumnReader(reader), ColumnData::F64(values)) => {
            read!(reader, values, Ok::<f64, TableError>);
        }
        (ColumnReader::FloatColumnReader(reader), ColumnData::F32(values)) => {
            read!(reader, values, Ok::<f32, TableError>);
        }
        (ColumnReader::Int64ColumnReader(reader), ColumnData::I64(values)) => {
            read!(reader, values, Ok::<i64, TableError>);
        }
        (ColumnReader::ByteArrayColumnReader(reader), ColumnData::Text(values)) => {
            let text = |bytes: ByteArray| {
                bytes.as_utf8().map(str::to_owned).map_err(|_| TableError::NotUtf8(name.to_owned()))
            };
            read!(reader, values, text);
        }
        _ => return Err(TableError::UnknownType(name.to_owned())),
    }
    Ok(())
}
