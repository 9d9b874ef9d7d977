//! Tables as NumPy's archives: a `.npy` array a column in an uncompressed zip file, as `numpy.load` reads it.

use std::io::{self, Seek, SeekFrom, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::error::TableError;
use crate::source::{Sink, Source};
use crate::table::{Column, Table};

/// Bytes to whose multiple the header is padded (NPY format 1.0).
const ALIGNMENT: usize = 64;

/// Values of a column that are converted at once.
const VALUES: usize = 8 << 10;

/// The table as an NPZ archive. Numbers are `float64`, whole numbers `int64` (or `float64` with NaN if one is
/// missing), texts `str` (empty if one is missing). The arrays of no dimension `attributes_json` and `units_json`
/// hold what the JSON form has under these names. The same table gives the same bytes. One piece of some columns and one array are in
/// memory.
///
/// # Errors
/// A piece cannot be read, the archive would be too large for its format, or the sink fails.
pub fn write_to(source: &impl Source, sink: &mut Sink<'_>) -> Result<(), TableError> {
    let mut tail = Tail::new(sink);
    archive(source, &mut tail)?;
    Ok(tail.send()?)
}

/// Target that an archive can be written to.
trait Place: Write + Seek {}

impl<T: Write + Seek> Place for T {}

fn archive(source: &impl Source, place: &mut dyn Place) -> Result<(), TableError> {
    let mut archive = ZipWriter::new(place);
    for piece in source.by_columns() {
        put_columns(&mut archive, piece?.as_ref())?;
    }
    end(archive, source.layout())
}

fn put_columns(archive: &mut ZipWriter<&mut dyn Place>, piece: &Table) -> Result<(), TableError> {
    for (name, column) in &piece.columns {
        begin(archive, name, column.len().saturating_mul(8))?;
        put_column(archive, column)?;
    }
    Ok(())
}

fn end(mut archive: ZipWriter<&mut dyn Place>, layout: &Table) -> Result<(), TableError> {
    let attributes = serde_json::to_string(&layout.attributes).map_err(io::Error::from)?;
    let units = serde_json::to_string(&layout.units).map_err(io::Error::from)?;
    for (name, text) in [("attributes_json", &attributes), ("units_json", &units)] {
        begin(&mut archive, name, text.len().saturating_mul(4))?;
        put_texts(&mut archive, &[text], "()")?;
    }
    archive.finish().map_err(io::Error::from)?;
    Ok(())
}

/// Begins an array of about this many bytes.
fn begin(archive: &mut ZipWriter<&mut dyn Place>, name: &str, bytes: usize) -> io::Result<()> {
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    Ok(archive.start_file(format!("{name}.npy"), options.large_file(bytes > 1 << 31))?)
}

fn put_column(sink: &mut dyn Write, column: &Column) -> io::Result<()> {
    let shape = format!("({},)", column.len());
    match column {
        Column::Number(values) => put_array(sink, "<f8", &shape, values, |value| value.to_le_bytes()),
        Column::Single(values) => {
            put_array(sink, "<f8", &shape, values, |value| f64::from(*value).to_le_bytes())
        }
        Column::Integer(values) if values.iter().all(Option::is_some) => {
            put_array(sink, "<i8", &shape, values, |value| value.unwrap_or_default().to_le_bytes())
        }
        Column::Integer(values) => {
            let number = |value: &Option<i64>| value.map_or(f64::NAN, |value| value as f64);
            put_array(sink, "<f8", &shape, values, |value| number(value).to_le_bytes())
        }
        Column::Text(values) => {
            let values: Vec<&str> = values.iter().map(|value| value.as_deref().unwrap_or_default()).collect();
            put_texts(sink, &values, &shape)
        }
    }
}

/// Texts as NumPy keeps them: UTF-32, each as long as the longest, padded with zeros.
fn put_texts(sink: &mut dyn Write, values: &[&str], shape: &str) -> io::Result<()> {
    let length = values.iter().map(|value| value.chars().count()).max().unwrap_or(0).max(1);
    put_header(sink, &format!("<U{length}"), shape)?;
    for value in values {
        let characters = value.chars().map(u32::from).chain(std::iter::repeat(0)).take(length);
        sink.write_all(&characters.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())?;
    }
    Ok(())
}

fn put_array<T>(
    sink: &mut dyn Write,
    kind: &str,
    shape: &str,
    values: &[T],
    bytes: impl Fn(&T) -> [u8; 8],
) -> io::Result<()> {
    put_header(sink, kind, shape)?;
    for values in values.chunks(VALUES) {
        sink.write_all(&values.iter().flat_map(&bytes).collect::<Vec<u8>>())?;
    }
    Ok(())
}

fn put_header(sink: &mut dyn Write, kind: &str, shape: &str) -> io::Result<()> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let before = 10 + header.len() + 1;
    header.extend(std::iter::repeat_n(' ', before.next_multiple_of(ALIGNMENT) - before));
    header.push('\n');
    sink.write_all(b"\x93NUMPY\x01\x00")?;
    // A header is far shorter than the 64 KiB that version 1.0 allows.
    sink.write_all(&(header.len() as u16).to_le_bytes())?;
    sink.write_all(header.as_bytes())
}

/// The end of an archive, as long as it may still change: the header of an array is completed once its checksum is known, and then
/// all of it goes to the sink.
struct Tail<'t, 's> {
    sink: &'t mut Sink<'s>,
    kept: Vec<u8>,
    /// Bytes that have gone to the sink.
    sent: u64,
    /// In what is kept.
    position: usize,
}

impl<'t, 's> Tail<'t, 's> {
    fn new(sink: &'t mut Sink<'s>) -> Self {
        Self { sink, kept: Vec::new(), sent: 0, position: 0 }
    }

    fn send(&mut self) -> io::Result<()> {
        self.sink.write_all(&self.kept)?;
        self.sent += self.kept.len() as u64;
        self.kept.clear();
        self.position = 0;
        Ok(())
    }
}

impl Write for Tail<'_, '_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let replaced = (self.kept.len() - self.position).min(bytes.len());
        self.kept[self.position..self.position + replaced].copy_from_slice(&bytes[..replaced]);
        self.kept.extend_from_slice(&bytes[replaced..]);
        self.position += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Tail<'_, '_> {
    /// Only to what is kept. Whoever comes back to the end has completed what is before it.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => place.checked_sub(self.sent),
            SeekFrom::Current(by) => (self.position as u64).checked_add_signed(by),
            SeekFrom::End(by) => (self.kept.len() as u64).checked_add_signed(by),
        };
        let place = place.and_then(|place| usize::try_from(place).ok());
        let place = place.filter(|place| *place <= self.kept.len()).ok_or(io::ErrorKind::InvalidInput)?;
        let is_back = self.position < place && place == self.kept.len();
        self.position = place;
        let absolute = self.sent + place as u64;
        if is_back {
            self.send()?;
        }
        Ok(absolute)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Read};

    use super::*;

    fn write(table: &Table) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_to(table, &mut bytes).unwrap();
        bytes
    }

    fn file(archive: &[u8], name: &str) -> Vec<u8> {
        let mut archive = zip::ZipArchive::new(Cursor::new(archive)).unwrap();
        let mut bytes = Vec::new();
        archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn an_array_has_the_bytes_that_numpy_writes() {
        // numpy.save(file, numpy.array([1.0, nan, -2.5])) of NumPy 1.26.
        let expected = {
            let mut bytes =
                b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }".to_vec();
            bytes.resize(127, b' ');
            bytes.push(b'\n');
            for value in [1.0, f64::NAN, -2.5] {
                bytes.extend(value.to_le_bytes());
            }
            bytes
        };
        let table = Table::default()
            .with("time", Column::Number(vec![1.0, f64::NAN, -2.5]))
            .with("node", Column::Integer(vec![Some(1), None, Some(3)]))
            .with("regime", Column::Text(vec![Some("Größe".to_owned()), None, Some("a".to_owned())]))
            .attribute("samples", 3);
        let archive = write(&table);
        assert_eq!(file(&archive, "time.npy"), expected);
        assert_eq!(archive, write(&table));
        let regime = file(&archive, "regime.npy");
        assert!(regime.starts_with(b"\x93NUMPY\x01\x00v\x00{'descr': '<U5', "));
        assert_eq!(regime.len(), 128 + 3 * 5 * 4);
        assert_eq!(regime[128 + 8..128 + 12], u32::from('ö').to_le_bytes());
        assert!(file(&archive, "node.npy").windows(3).any(|part| part == b"<f8"));
        assert!(file(&archive, "attributes_json.npy").windows(3).any(|part| part == b"<U1"));
    }

    #[test]
    fn a_streamed_archive_equals_one_written_to_a_file() {
        let long: Vec<f64> = (0..100_000).map(f64::from).collect();
        let table = Table::default()
            .with("time", Column::Number(long.clone()))
            .with("nothing", Column::Number(Vec::new()))
            .with("u_49", Column::Single(long.iter().map(|value| *value as f32).collect()));
        let mut whole = Cursor::new(Vec::new());
        archive(&table, &mut whole).unwrap();
        let whole = whole.into_inner();
        assert!(write(&table) == whole);

        // The first arrays have left when the last one is begun.
        let mut sent = Vec::new();
        archive(&table, &mut Tail::new(&mut sent)).unwrap();
        assert!(sent.len() > 1_000_000 && sent.len() < whole.len());
        assert!(whole.starts_with(&sent));
    }
}
