//! Reading Parquet tables: only the requested row groups and columns, from wherever the bytes are.

use std::borrow::Cow;
use std::io;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use ::parquet::basic::Type as PhysicalType;
use ::parquet::column::reader::ColumnReader;
use ::parquet::data_type::ByteArray;
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::ParquetStatisticsPolicy;
use ::parquet::file::reader::{ChunkReader, FileReader, Length, RowGroupReader, SerializedFileReader};
use ::parquet::file::serialized_reader::ReadOptionsBuilder;
use bytes::Bytes;

use super::format::{ROW_GROUP, UNIT_PREFIX};
use crate::error::TableError;
use crate::source::Source;
use crate::table::{Column, Table};

/// Bytes of the values of a piece in memory, unless one row or one column has more.
const PIECE_BYTES: usize = 16 << 20;

/// The same of a piece of rows, unless a row group has more than [`PIECES_OF_GROUP`] times as many: a long table is written in little memory.
const ROWS_BYTES: usize = 512 << 10;

/// Pieces of a row group at most. For each of them the columns are read from the beginning of the row group.
const PIECES_OF_GROUP: usize = 8;

/// Bytes that are read at once, from a multiple of them on.
const BLOCK: u64 = 256 << 10;

/// A file of which any part can be read.
pub trait ReadAt: Send + Sync + 'static {
    /// Length of the file \[bytes\].
    fn length(&self) -> u64;

    /// The bytes of a range that lies in the file.
    ///
    /// # Errors
    /// They cannot be read.
    fn read_at(&self, range: Range<u64>) -> io::Result<Bytes>;
}

impl ReadAt for Bytes {
    fn length(&self) -> u64 {
        self.len() as u64
    }

    fn read_at(&self, range: Range<u64>) -> io::Result<Bytes> {
        let place = |at: u64| usize::try_from(at).ok().filter(|at| *at <= self.len());
        let (start, end) = place(range.start).zip(place(range.end)).ok_or(io::ErrorKind::UnexpectedEof)?;
        Ok(self.slice(start..end))
    }
}

/// A table in a Parquet file that [`write()`](super::write()) or a [`Writer`](super::Writer) has written. Of the file its footer is in
/// memory, nothing else.
pub struct StoredTable<R: ReadAt> {
    reader: SerializedFileReader<Blocks<R>>,
    layout: Table,
    /// Beginnings of the row groups, and the end of the last one \[rows\].
    bounds: Vec<usize>,
}

impl<R: ReadAt> StoredTable<R> {
    /// Reads the footer.
    ///
    /// # Errors
    /// The bytes are not such a table.
    pub fn open(source: R) -> Result<Self, TableError> {
        // Statistics are not needed, and take more memory than all else in a footer.
        let options = ReadOptionsBuilder::new()
            .with_column_stats_policy(ParquetStatisticsPolicy::SkipAll)
            .with_encoding_stats_policy(ParquetStatisticsPolicy::SkipAll)
            .with_size_stats_policy(ParquetStatisticsPolicy::SkipAll)
            .build();
        let reader = SerializedFileReader::new_with_options(Blocks::of(source), options)?;
        let metadata = reader.metadata().file_metadata();
        let mut layout = Table::default();
        for descriptor in metadata.schema_descr().columns() {
            let name = descriptor.name();
            let column = match descriptor.physical_type() {
                PhysicalType::DOUBLE => Column::Number(Vec::new()),
                PhysicalType::FLOAT => Column::Single(Vec::new()),
                PhysicalType::INT64 => Column::Integer(Vec::new()),
                PhysicalType::BYTE_ARRAY => Column::Text(Vec::new()),
                _ => return Err(TableError::UnknownType(name.to_owned())),
            };
            layout.push(name, column);
        }
        // Units are the written ones, or else those of the vocabulary.
        for entry in metadata.key_value_metadata().into_iter().flatten() {
            if let (Some(name), Some(unit)) = (entry.key.strip_prefix(UNIT_PREFIX), &entry.value)
                && layout.columns.contains_key(name)
            {
                layout.units.insert(name.to_owned(), unit.clone());
            }
        }
        let mut bounds = vec![0];
        let mut end = 0;
        for group in reader.metadata().row_groups() {
            end += group.num_rows().unsigned_abs() as usize;
            bounds.push(end);
        }
        Ok(Self { reader, layout, bounds })
    }

    /// The columns with types and units, without a row.
    pub fn layout(&self) -> &Table {
        &self.layout
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.bounds.last().copied().unwrap_or_default()
    }

    /// Bytes of memory that it takes to write the columns of `layout` in another format, some rows at a time.
    pub fn memory_by_rows(&self, layout: &Table) -> u64 {
        let metadata = self.reader.metadata();
        let groups = metadata.row_groups();
        let rows = groups.iter().map(|group| group.num_rows().unsigned_abs() as usize).max().unwrap_or(0);
        let width: usize = layout.columns.values().map(width).sum();
        // A page as it lies there, and decompressed.
        let chunks = groups.iter().flat_map(|group| group.columns());
        let page = chunks.map(|chunk| chunk.uncompressed_size().unsigned_abs()).max().unwrap_or(0);
        metadata.memory_size() as u64 + (rows_of_piece(rows, width) * width) as u64 + 2 * page + BLOCK
    }

    /// Some columns of some rows, in the order of the file. Columns that there are not, and rows beyond the end, are left out.
    ///
    /// # Errors
    /// The bytes cannot be read or are not such a table.
    pub fn read(&self, columns: &[&str], rows: Range<usize>) -> Result<Table, TableError> {
        let mut table = self.layout.clone();
        table.columns.retain(|name, _| columns.contains(&name.as_str()));
        table.units.retain(|name, _| columns.contains(&name.as_str()));
        self.fill(&mut table, rows, Thinning::NONE)?;
        Ok(table)
    }

    /// The part with the columns, units and attributes of `layout`, which has columns of this table without rows, in any order; of
    /// `rows` every `stride`-th from the first on.
    ///
    /// # Errors
    /// A column is none of this table's.
    pub fn cut(self, layout: Table, rows: Range<usize>, stride: usize) -> Result<Cut<R>, TableError> {
        self.cut_runs(layout, rows, 1, stride)
    }

    /// The same of every `stride`-th run of `run` rows, such as the rows of one time.
    ///
    /// # Errors
    /// As [`StoredTable::cut`].
    pub fn cut_runs(
        self,
        layout: Table,
        rows: Range<usize>,
        run: usize,
        stride: usize,
    ) -> Result<Cut<R>, TableError> {
        for (name, column) in &layout.columns {
            let own = self.layout.columns.get(name).map(std::mem::discriminant);
            if own != Some(std::mem::discriminant(column)) || !column.is_empty() {
                return Err(TableError::OtherColumns);
            }
        }
        let end = rows.end.min(self.rows());
        let rows = rows.start.min(end)..end;
        let thinning = Thinning { origin: rows.start, run: run.max(1), stride: stride.max(1) };
        Ok(Cut { rows, thinning, layout, stored: self })
    }

    /// Adds to the columns of `table`, which are columns of this one, those of some rows that stay.
    fn fill(&self, table: &mut Table, rows: Range<usize>, thinning: Thinning) -> Result<(), TableError> {
        let mut columns = Vec::with_capacity(table.columns.len());
        for (name, column) in &mut table.columns {
            let index = self.layout.columns.get_index_of(name).ok_or(TableError::OtherColumns)?;
            columns.push((index, name.as_str(), column));
        }
        for (number, bounds) in self.bounds.windows(2).enumerate() {
            let first = thinning.first_from(rows.start.max(bounds[0]));
            let within = first..rows.end.min(bounds[1]);
            if within.is_empty() {
                continue;
            }
            let group = self.reader.get_row_group(number)?;
            for (index, name, column) in &mut columns {
                read_column(group.as_ref(), *index, name, (bounds[0], within.clone()), thinning, column)?;
            }
        }
        Ok(())
    }
}

/// Selection of rows: every `stride`-th of runs of `run` rows, counted from the row `origin` on.
#[derive(Clone, Copy)]
struct Thinning {
    origin: usize,
    run: usize,
    stride: usize,
}

impl Thinning {
    const NONE: Thinning = Thinning { origin: 0, run: 1, stride: 1 };

    /// True if a row, which is not before the origin, stays.
    fn keeps(&self, row: usize) -> bool {
        self.stride == 1 || ((row - self.origin) / self.run).is_multiple_of(self.stride)
    }

    /// The first row that stays and is not before `row`.
    fn first_from(&self, row: usize) -> usize {
        if self.keeps(row) {
            return row;
        }
        let period = self.run * self.stride;
        self.origin + (row - self.origin).div_ceil(period) * period
    }

    /// Number of `rows`, from the origin on, that stay.
    fn count(&self, rows: usize) -> usize {
        let period = self.run * self.stride;
        rows / period * self.run + (rows % period).min(self.run)
    }
}

/// A part of a stored table.
pub struct Cut<R: ReadAt> {
    stored: StoredTable<R>,
    layout: Table,
    rows: Range<usize>,
    thinning: Thinning,
}

impl<R: ReadAt> Cut<R> {
    /// The part as a table in memory.
    ///
    /// # Errors
    /// The bytes cannot be read or are not such a table.
    pub fn read(&self) -> Result<Table, TableError> {
        let mut table = self.layout.clone();
        self.stored.fill(&mut table, self.rows.clone(), self.thinning)?;
        Ok(table)
    }

    /// Some rows of the part, by their numbers in it, which ascend; as a table in memory. Rows that there are not are left out.
    ///
    /// # Errors
    /// The bytes cannot be read or are not such a table.
    pub fn rows_at(&self, rows: &[usize]) -> Result<Table, TableError> {
        let mut table = self.layout.clone();
        let mut waiting = rows.iter().copied().peekable();
        let mut first = 0;
        for piece in self.by_rows() {
            let piece = piece?;
            let end = first + piece.rows();
            while let Some(row) = waiting.next_if(|row| *row < end) {
                table.append(&piece, row - first..row - first + 1, rows.len());
            }
            first = end;
        }
        Ok(table)
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.thinning.count(self.rows.len())
    }

    /// Rows of the stored table that make the next piece after `start`: of one row group, and of bounded bytes.
    fn piece_from(&self, start: usize) -> Option<Range<usize>> {
        if start >= self.rows.end {
            return None;
        }
        let bounds = &self.stored.bounds;
        let group = bounds.partition_point(|bound| *bound <= start);
        let (group_start, group_end) = (bounds[group - 1], bounds[group]);
        let width: usize = self.layout.columns.values().map(width).sum();
        let most = rows_of_piece(group_end - group_start, width).saturating_mul(self.thinning.stride);
        Some(start..start.saturating_add(most).min(group_end).min(self.rows.end))
    }
}

/// Rows of a piece of a row group with this many rows of `width` bytes.
fn rows_of_piece(rows: usize, width: usize) -> usize {
    let most = (ROWS_BYTES / width.max(1)).max(rows.div_ceil(PIECES_OF_GROUP));
    most.min(PIECE_BYTES / width.max(1)).min(rows).max(1)
}

impl<R: ReadAt> Source for Cut<R> {
    fn layout(&self) -> &Table {
        &self.layout
    }

    fn by_rows(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>> {
        let mut next = self.rows.start;
        std::iter::from_fn(move || {
            let piece = self.piece_from(next)?;
            next = self.thinning.first_from(piece.end).min(self.rows.end);
            let mut table = self.layout.clone();
            Some(self.stored.fill(&mut table, piece, self.thinning).map(|()| Cow::Owned(table)))
        })
    }

    fn by_columns(&self) -> impl Iterator<Item = Result<Cow<'_, Table>, TableError>> {
        let columns: Vec<(&String, &Column)> = self.layout.columns.iter().collect();
        let mut next = 0;
        std::iter::from_fn(move || {
            let mut bytes = 0;
            let fits = |(_, column): &&(&String, &Column)| {
                bytes += self.rows() * width(column);
                bytes <= PIECE_BYTES
            };
            let count = columns[next..].iter().take_while(fits).count().max(1);
            let piece = columns.get(next..(next + count).min(columns.len()))?;
            next += piece.len();
            if piece.is_empty() {
                return None;
            }
            let own = piece.iter().map(|&(name, column)| (name.clone(), column.clone()));
            let mut table = Table { columns: own.collect(), ..Table::default() };
            Some(self.stored.fill(&mut table, self.rows.clone(), self.thinning).map(|()| Cow::Owned(table)))
        })
    }
}

/// A file, read in blocks; the last one is kept, since what is read next mostly lies in it.
struct Blocks<R>(Arc<Inner<R>>);

struct Inner<R> {
    file: R,
    last: Mutex<Option<(u64, Bytes)>>,
}

impl<R> Clone for Blocks<R> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<R: ReadAt> Blocks<R> {
    fn of(file: R) -> Self {
        Self(Arc::new(Inner { file, last: Mutex::default() }))
    }

    /// Bytes from a place to the end of its block; none at the end of the file.
    fn from(&self, start: u64) -> io::Result<Bytes> {
        let length = self.0.file.length();
        if start >= length {
            return Ok(Bytes::new());
        }
        let first = start / BLOCK * BLOCK;
        let within = usize::try_from(start - first).map_err(io::Error::other)?;
        let mut last = self.0.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, block)) = last.as_ref().filter(|(place, _)| *place == first) {
            return Ok(block.slice(within..));
        }
        *last = None;
        let block = self.0.file.read_at(first..length.min(first + BLOCK))?;
        *last = Some((first, block.clone()));
        Ok(block.slice(within..))
    }
}

impl<R: ReadAt> Length for Blocks<R> {
    fn len(&self) -> u64 {
        self.0.file.length()
    }
}

impl<R: ReadAt> ChunkReader for Blocks<R> {
    type T = BlockReader<R>;

    fn get_read(&self, start: u64) -> Result<BlockReader<R>, ParquetError> {
        Ok(BlockReader { blocks: self.clone(), position: start })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let end = start.checked_add(length as u64).filter(|end| *end <= self.len());
        let end =
            end.ok_or_else(|| ParquetError::EOF(format!("the file has no {length} bytes at {start}")))?;
        Ok(self.0.file.read_at(start..end)?)
    }
}

/// Reads on from a place.
struct BlockReader<R> {
    blocks: Blocks<R>,
    position: u64,
}

impl<R: ReadAt> io::Read for BlockReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = self.blocks.from(self.position)?;
        let count = bytes.len().min(buffer.len());
        buffer[..count].copy_from_slice(&bytes[..count]);
        self.position += count as u64;
        Ok(count)
    }
}

/// Bytes at the end of a file that say how long its footer is.
pub const FOOTER_END: u64 = 8;

/// Bytes of memory that it takes to read this many columns of a stored table and write them in another format, a piece at a time, at most: by
/// the length of its file, the file's last [`FOOTER_END`] bytes, and its rows; for all columns `u64::MAX`. Parquet takes [`MEMORY_OF_WRITER`](crate::parquet::MEMORY_OF_WRITER) in addition.
pub fn memory(length: u64, end: &[u8], rows: u64, columns: u64) -> u64 {
    /// Memory of the footer as it is read and decoded, per byte of its length; writing Parquet makes another one.
    const OF_FOOTER: u64 = 8;
    /// Bytes in the footer for a column of a row group, at least.
    const OF_CHUNK: u64 = 40;
    /// Memory of a number, at most: a whole one that may be missing.
    const OF_VALUE: u64 = size_of::<Option<i64>>() as u64;
    let footer = match end {
        [a, b, c, d, _, _, _, _] => u64::from(u32::from_le_bytes([*a, *b, *c, *d])).min(length),
        _ => length,
    };
    let row_groups = rows.div_ceil(ROW_GROUP as u64).max(1);
    let column = rows.saturating_mul(OF_VALUE);
    let all = column.saturating_mul((footer / OF_CHUNK / row_groups).min(columns));
    // A piece may have a column alone, and each column of it may become an array.
    footer.saturating_mul(OF_FOOTER) + all.min(PIECE_BYTES as u64).max(column) + column + BLOCK
}

/// Bytes of a value in memory; of a text, without the text itself.
fn width(column: &Column) -> usize {
    match column {
        Column::Single(_) => size_of::<f32>(),
        Column::Number(_) => size_of::<f64>(),
        Column::Integer(_) => size_of::<Option<i64>>(),
        Column::Text(_) => size_of::<Option<String>>(),
    }
}

/// Reads a Parquet table: some columns or all, some rows or all. Rows beyond the end are left out. Units are those that were written,
/// or else those of the vocabulary.
///
/// # Errors
/// The bytes are not a table that [`write()`](super::write()) writes.
pub fn read(bytes: Bytes, columns: Option<&[&str]>, rows: Option<Range<usize>>) -> Result<Table, TableError> {
    let stored = StoredTable::open(bytes)?;
    let all: Vec<&str> = stored.layout.columns.keys().map(String::as_str).collect();
    stored.read(columns.unwrap_or(&all), rows.unwrap_or(0..usize::MAX))
}

/// Adds those of some rows of a row group, which begins at the row `start`, to a column that stay.
fn read_column(
    group: &dyn RowGroupReader,
    index: usize,
    name: &str,
    (start, rows): (usize, Range<usize>),
    thinning: Thinning,
    column: &mut Column,
) -> Result<(), TableError> {
    macro_rules! read {
        ($reader:expr, $values:expr, $convert:expr) => {{
            let mut reader = $reader;
            reader.skip_records(rows.start - start)?;
            let mut values = Vec::with_capacity(rows.len());
            reader.read_records(rows.len(), None, None, &mut values)?;
            for (row, value) in rows.zip(values) {
                if thinning.keeps(row) {
                    $values.push($convert(value)?);
                }
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
