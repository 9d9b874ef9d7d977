//! Tables that are written while they are read: the bytes are those of the table in memory.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bytes::Bytes;
use drillsweep_table::parquet::{Cut, ReadAt, StoredTable};
use drillsweep_table::{Column, Source, Table, TableError, csv, json, npz, parquet};

/// 25,000 samples with every type of column, and values that no format has digits for.
fn history() -> Table {
    let time: Vec<f64> = (0..25_000).map(|row| f64::from(row) * 1e-3).collect();
    let gap = |row: usize, value: f32| if row % 7_001 == 3 { f32::NAN } else { value };
    let motion = time.iter().enumerate().map(|(row, time)| gap(row, (7.0 * time).sin() as f32));
    let regimes = (0..time.len()).map(|row| ["laminar", "\"turbulent\", at last", "übergang"][row % 3]);
    Table::default()
        .with("u_49", Column::Single(motion.collect()))
        .with("steps", Column::Integer((0..25_000).map(Some).collect()))
        .with("regime", Column::Text(regimes.map(|regime| Some(regime.to_owned())).collect()))
        .with("time", Column::Number(time))
}

fn stored(table: &Table) -> StoredTable<Bytes> {
    StoredTable::open(parquet::write(table).unwrap().into()).unwrap()
}

fn cut(table: &Table, columns: &[&str], rows: Range<usize>, (run, stride): (usize, usize)) -> Cut<Bytes> {
    let stored = stored(table);
    let names: Vec<String> = columns.iter().map(|&name| name.to_owned()).collect();
    let layout = stored.layout().select(&names).unwrap().attribute("samples", rows.len());
    match run {
        1 => stored.cut(layout, rows, stride).unwrap(),
        _ => stored.cut_runs(layout, rows, run, stride).unwrap(),
    }
}

fn all_formats(source: &impl Source) -> [Vec<u8>; 4] {
    let mut formats = [const { Vec::new() }; 4];
    let [csv, json, npz, parquet] = &mut formats;
    csv::write_to(source, csv).unwrap();
    json::write_to(source, json).unwrap();
    npz::write_to(source, npz).unwrap();
    parquet::write_to(source, parquet).unwrap();
    formats
}

#[test]
fn a_part_of_a_stored_table_is_written_as_the_same_part_in_memory() {
    let table = history();
    for (columns, rows, run, stride) in [
        (&["u_49", "steps", "regime", "time"][..], 0..25_000, 1, 1),
        (&["time", "u_49"], 9_998..20_003, 1, 1),
        (&["regime", "time"], 5..24_999, 1, 7),
        (&["time"], 3..24_000, 1, 12_000),
        (&["time", "steps"], 100..100, 1, 1),
        (&[], 0..25_000, 1, 1),
        // Every run of 297 rows, every third one, and one that is cut off by the end.
        (&["steps", "u_49"], 297..24_057, 297, 1),
        (&["steps", "regime"], 297..24_057, 297, 3),
        (&["time", "steps"], 9_000..25_000, 4_000, 2),
        (&["steps"], 0..25_000, 12_001, 2),
        (&["steps"], 24_000..25_000, 600, 4),
    ] {
        let part = cut(&table, columns, rows.clone(), (run, stride));
        let kept = || rows.clone().filter(|row| ((row - rows.start) / run).is_multiple_of(stride));
        let mut expected = Table::default().attribute("samples", rows.len());
        for &name in columns {
            expected.push(name, table.columns[name].rows(kept()));
        }
        assert_eq!(part.rows(), kept().count());
        let read = part.read().unwrap();
        // As text, in which missing numbers equal each other.
        let text = serde_json::to_string(&expected).unwrap();
        assert_eq!(serde_json::to_string(&read).unwrap(), text);
        assert!(all_formats(&part) == all_formats(&expected), "{columns:?} {rows:?} by {run} of {stride}");
        assert_eq!(all_formats(&part)[1], text.into_bytes(), "JSON is what serde makes of a table");
    }
}

#[test]
fn an_unknown_column_is_refused() {
    let wider = Table::default().with("u_50", Column::Single(Vec::new()));
    assert!(matches!(stored(&history()).cut(wider, 0..1, 1), Err(TableError::OtherColumns)));
    let other_type = Table::default().with("time", Column::Single(Vec::new()));
    assert!(matches!(stored(&history()).cut(other_type, 0..1, 1), Err(TableError::OtherColumns)));
}

/// A file of which it is counted how many bytes are read.
struct Counted {
    bytes: Bytes,
    read: Arc<AtomicU64>,
}

impl ReadAt for Counted {
    fn length(&self) -> u64 {
        self.bytes.length()
    }

    fn read_at(&self, range: Range<u64>) -> std::io::Result<Bytes> {
        self.read.fetch_add(range.end - range.start, Ordering::Relaxed);
        self.bytes.read_at(range)
    }
}

#[test]
fn only_requested_columns_are_read() {
    let noise = |seed: u64| {
        let mut state = seed;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32
        };
        Column::Single((0..100_000).map(|_| next()).collect())
    };
    let table = (1..=20).fold(Table::default(), |table, n| table.with(format!("u_{n}"), noise(n)));
    let bytes = Bytes::from(parquet::write(&table).unwrap());
    let read = Arc::new(AtomicU64::new(0));
    let counted = Counted { bytes: bytes.clone(), read: read.clone() };
    let stored = StoredTable::open(counted).unwrap();
    let footer = read.swap(0, Ordering::Relaxed);
    let block = 256 << 10;
    assert!(bytes.len() as u64 > 20 * block);
    assert!(footer <= 2 * block, "the footer alone: {footer}");
    // Two of ten row groups of one column of twenty: 40 kB each, in one block or at the border of two.
    assert_eq!(stored.read(&["u_7"], 35_000..45_000).unwrap().rows(), 10_000);
    let part = read.swap(0, Ordering::Relaxed);
    assert!(part <= 4 * block, "{part} of {}", bytes.len());
}
