//! Tables as NumPy's archives: a `.npy` array a column in an uncompressed zip file, as `numpy.load` reads it.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::table::{Column, Table};

/// Bytes to whose multiple the header is padded (NPY format 1.0).
const ALIGNMENT: usize = 64;

/// The table as an NPZ archive. Numbers are `float64`, whole numbers `int64` (or `float64` with NaN where one is
/// missing), texts `str` (empty where one is missing). The arrays of no dimension `attributes_json` and `units_json`
/// hold what the JSON form has under these names. The same table gives the same bytes.
///
/// # Errors
/// When the archive would be too large for its format.
pub fn write(table: &Table) -> Result<Vec<u8>, zip::result::ZipError> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    let json = |value: serde_json::Result<String>| value.unwrap_or_default();
    let attributes = json(serde_json::to_string(&table.attributes));
    let units = json(serde_json::to_string(&table.units));
    let mut add = |name: &str, array: &[u8]| -> Result<(), zip::result::ZipError> {
        let options = options.large_file(array.len() > 1 << 31);
        archive.start_file(format!("{name}.npy"), options)?;
        Ok(archive.write_all(array)?)
    };
    for (name, column) in &table.columns {
        add(name, &array(column))?;
    }
    add("attributes_json", &texts(&[&attributes], "()"))?;
    add("units_json", &texts(&[&units], "()"))?;
    Ok(archive.finish()?.into_inner())
}

fn array(column: &Column) -> Vec<u8> {
    let shape = format!("({},)", column.len());
    match column {
        Column::Number(values) => npy("<f8", &shape, values.iter().flat_map(|value| value.to_le_bytes())),
        Column::Integer(values) => match values.iter().copied().collect::<Option<Vec<i64>>>() {
            Some(values) => npy("<i8", &shape, values.iter().flat_map(|value| value.to_le_bytes())),
            None => {
                let number = |value: &Option<i64>| value.map_or(f64::NAN, |value| value as f64);
                npy("<f8", &shape, values.iter().map(number).flat_map(f64::to_le_bytes))
            }
        },
        Column::Single(values) => {
            npy("<f8", &shape, values.iter().flat_map(|value| f64::from(*value).to_le_bytes()))
        }
        Column::Text(values) => {
            let values: Vec<&str> = values.iter().map(|value| value.as_deref().unwrap_or_default()).collect();
            texts(&values, &shape)
        }
    }
}

/// Texts as NumPy keeps them: UTF-32, each as long as the longest, padded with zeros.
fn texts(values: &[&str], shape: &str) -> Vec<u8> {
    let length = values.iter().map(|value| value.chars().count()).max().unwrap_or(0).max(1);
    let padded = |value: &&str| {
        let characters: Vec<u32> = value.chars().map(u32::from).collect();
        characters.into_iter().chain(std::iter::repeat(0)).take(length)
    };
    npy(&format!("<U{length}"), shape, values.iter().flat_map(padded).flat_map(u32::to_le_bytes))
}

fn npy(kind: &str, shape: &str, data: impl Iterator<Item = u8>) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let before = 10 + header.len() + 1;
    header.extend(std::iter::repeat_n(' ', before.next_multiple_of(ALIGNMENT) - before));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    // A header is far shorter than the 64 KiB that version 1.0 allows.
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

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
        let archive = write(&table).unwrap();
        assert_eq!(file(&archive, "time.npy"), expected);
        assert_eq!(archive, write(&table).unwrap());
        let regime = file(&archive, "regime.npy");
        assert!(regime.starts_with(b"\x93NUMPY\x01\x00v\x00{'descr': '<U5', "));
        assert_eq!(regime.len(), 128 + 3 * 5 * 4);
        assert_eq!(regime[128 + 8..128 + 12], u32::from('ö').to_le_bytes());
        assert!(file(&archive, "node.npy").windows(3).any(|part| part == b"<f8"));
        assert!(file(&archive, "attributes_json.npy").windows(3).any(|part| part == b"<U1"));
    }
}
