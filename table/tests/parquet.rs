//! Tables through Parquet.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use bytes::Bytes;
use drillsweep_table::parquet::{StoredTable, Writer, read, write};
use drillsweep_table::{Column, Table, TableError};
use parquet::basic::{Compression, Encoding};
use parquet::file::reader::{FileReader, SerializedFileReader};

/// A recording of `rows` samples at 1 kHz with every type of column.
fn history(rows: usize) -> Table {
    let time: Vec<f64> = (0..rows).map(|row| row as f64 * 1e-3).collect();
    let regimes = (0..rows).map(|row| ["laminar", "turbulent", "übergang"][row % 3]);
    Table::default()
        .with("u_49", Column::Single(time.iter().map(|t| (7.0 * t).sin() as f32).collect()))
        .with("steps", Column::Integer((0..rows as i64).map(|row| Some(row - 5)).collect()))
        .with("regime", Column::Text(regimes.map(|regime| Some(regime.to_owned())).collect()))
        .with("time", Column::Number(time))
}

fn encode(table: &Table) -> Bytes {
    Bytes::from(write(table).unwrap())
}

fn rows_of(table: &Table, rows: std::ops::Range<usize>) -> Table {
    let cut = |(name, column): (&String, &Column)| (name.clone(), column.rows(rows.clone()));
    Table { columns: table.columns.iter().map(cut).collect(), ..table.clone() }
}

#[test]
fn a_table_comes_back_with_every_value_unit_and_name() {
    // Around the length of a row group, and none at all.
    for rows in [0, 1, 9_999, 10_000, 10_001, 25_000] {
        let table = history(rows);
        let bytes = encode(&table);
        assert_eq!(read(bytes.clone(), None, None).unwrap(), table, "{rows} rows");
        let stored = StoredTable::open(bytes).unwrap();
        assert_eq!((stored.layout(), stored.rows()), (&table.without_rows(), rows));
    }
    let empty = Table::default();
    assert_eq!(read(encode(&empty), None, None).unwrap(), empty);
}

#[test]
fn a_table_written_in_pieces_has_the_same_bytes() {
    for (rows, piece) in [(0, 1), (25_000, 25_000), (25_000, 777), (25_000, 10_000), (20_001, 19_999)] {
        let table = history(rows);
        let mut bytes = Vec::new();
        let mut writer = Writer::new(&mut bytes, &table.without_rows()).unwrap();
        for start in (0..rows).step_by(piece) {
            writer.write(&rows_of(&table, start..(start + piece).min(rows))).unwrap();
        }
        writer.finish().unwrap();
        assert!(bytes == write(&table).unwrap(), "{rows} rows by {piece}");
    }
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes, &history(0)).unwrap();
    let other = Table::default().with("time", Column::Number(vec![0.0]));
    assert!(matches!(writer.write(&other), Err(TableError::OtherColumns)));
}

#[test]
fn a_row_group_of_many_columns_is_as_small_as_one_of_few() {
    let samples = Column::Single(vec![0.5; 9_000]);
    let table = (0..2_400).fold(Table::default(), |table, n| table.with(format!("u_{n}"), samples.clone()));
    let reader = SerializedFileReader::new(encode(&table)).unwrap();
    let rows: Vec<i64> = reader.metadata().row_groups().iter().map(|group| group.num_rows()).collect();
    // 32 MiB of 9,600 bytes a row.
    assert_eq!(rows, [3_495, 3_495, 2_010]);
    assert_eq!(read(encode(&table), Some(&["u_7"]), Some(3_400..3_600)).unwrap().rows(), 200);
}

#[test]
fn floats_keep_every_bit() {
    let doubles =
        [0.0, -0.0, f64::MIN_POSITIVE / 2.0, 0.1, f64::MAX, f64::NEG_INFINITY, f64::NAN, -1.0 / 3.0];
    let singles = doubles.map(|value| value as f32);
    let table = Table::default()
        .with("double", Column::Number(doubles.to_vec()))
        .with("single", Column::Single(singles.to_vec()));
    let table = read(encode(&table), None, None).unwrap();
    let (Column::Number(read_doubles), Column::Single(read_singles)) =
        (&table.columns["double"], &table.columns["single"])
    else {
        panic!("{table:?}")
    };
    assert_eq!(
        doubles.map(f64::to_bits).as_slice(),
        read_doubles.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
    );
    assert_eq!(
        singles.map(f32::to_bits).as_slice(),
        read_singles.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
    );
}

#[test]
fn a_window_of_some_columns_is_the_same_cut_of_the_table() {
    let table = history(25_000);
    let bytes = encode(&table);
    for rows in [0..1, 0..10_000, 9_999..10_001, 12_345..23_456, 24_999..25_000, 5..5] {
        let window = read(bytes.clone(), None, Some(rows.clone())).unwrap();
        assert_eq!(window, rows_of(&table, rows.clone()), "{rows:?}");
    }
    let beyond = read(bytes.clone(), None, Some(24_000..99_000)).unwrap();
    assert_eq!(beyond, rows_of(&table, 24_000..25_000));
    assert_eq!(read(bytes.clone(), None, Some(99_000..99_001)).unwrap().rows(), 0);

    let part = read(bytes, Some(&["time", "u_49", "v_49"]), Some(100..200)).unwrap();
    let expected = rows_of(&table, 100..200);
    assert_eq!(part, expected.select(&["u_49".to_owned(), "time".to_owned()]).unwrap());
}

#[test]
fn a_window_is_read_from_its_own_row_groups_alone() {
    let table = history(30_000);
    let mut bytes = write(&table).unwrap();
    let reader = SerializedFileReader::new(Bytes::from(bytes.clone())).unwrap();
    assert_eq!(reader.num_row_groups(), 3);
    for group in [0, 2] {
        for column in reader.metadata().row_group(group).columns() {
            let (start, length) = column.byte_range();
            bytes[start as usize..(start + length) as usize].fill(0xff);
        }
    }
    let bytes = Bytes::from(bytes);
    let window = read(bytes.clone(), None, Some(10_000..20_000)).unwrap();
    assert_eq!(window, rows_of(&table, 10_000..20_000));
    assert!(matches!(read(bytes, None, None), Err(TableError::Parquet(_))));
}

#[test]
fn floats_are_split_into_byte_streams_and_everything_is_compressed() {
    let reader = SerializedFileReader::new(encode(&history(10_000))).unwrap();
    for column in reader.metadata().row_group(0).columns() {
        let is_float = ["u_49", "time"].contains(&column.column_path().string().as_str());
        let is_split = column.encodings().any(|encoding| encoding == Encoding::BYTE_STREAM_SPLIT);
        assert_eq!(is_split, is_float, "{}", column.column_path());
        assert!(matches!(column.compression(), Compression::ZSTD(_)));
    }
}

#[test]
fn a_foreign_file_is_an_error() {
    let mut ragged = history(10);
    ragged.push("short", Column::Integer(vec![Some(1)]));
    let error = write(&ragged).unwrap_err();
    assert_eq!(error.to_string(), "column \"short\" has 1 rows, the first one 10");

    let bytes = encode(&history(100));
    for broken in [Bytes::new(), Bytes::from_static(b"not parquet at all"), bytes.slice(..bytes.len() / 2)] {
        assert!(matches!(read(broken, None, None), Err(TableError::Parquet(_))));
    }
}

#[test]
fn missing_values_are_nan_or_empty() {
    let table = Table::default()
        .with("node", Column::Integer(vec![Some(1), None]))
        .with("error", Column::Text(vec![None, Some("diverged".to_owned())]));
    let table = read(encode(&table), None, None).unwrap();
    assert!(
        matches!(&table.columns["node"], Column::Number(values) if values[0] == 1.0 && values[1].is_nan())
    );
    assert_eq!(table.columns["error"], Column::Text(vec![Some(String::new()), Some("diverged".to_owned())]));
}

#[test]
fn a_unit_is_the_one_that_was_written() {
    let mut table = history(10);
    table.units.insert("u_49".to_owned(), "mm".to_owned());
    assert_eq!(read(encode(&table), None, None).unwrap().units["u_49"], "mm");
}
