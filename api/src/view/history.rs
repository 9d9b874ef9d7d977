//! Histories as recorded, over a window and thinned: by stride, or to the extremes of each column.

use drillsweep_quantity::columns;
use drillsweep_table::{Column, Table};
use serde::Deserialize;

/// Choice of the rows of a history that stay if at most a number of them is requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Decimation {
    /// Every k-th row: equal intervals of time, and extremes between them are lost.
    #[default]
    Stride,
    /// The rows with the smallest and the largest value of each column, of as many equal stretches of time as there is room for: a line
    /// drawn through them has the outline of the whole history. Intervals of time differ.
    Minmax,
}

/// Stride at which the rows of a window are kept so that at most `max_points` of its `samples` stay: the smallest one; 1 if that is
/// not requested.
pub fn stride(samples: usize, max_points: Option<usize>) -> usize {
    max_points.map_or(1, |max_points| samples.div_ceil(max_points.max(1)).max(1))
}

/// The rows with the extremes of each column, chosen from the rows of a history as they come.
///
/// The history is cut into as many runs of rows as `max_points` allows, of equal number to within one; of each run the rows stay that have
/// the smallest and the largest value of a column other than `time`, the first of them if several have it.
#[derive(Debug)]
pub struct Extremes {
    rows: usize,
    runs: usize,
    /// The run that rows are added to, and the row that comes next.
    run: usize,
    next: usize,
    /// Place of each column that counts, and the rows of the run so far with its smallest and largest value.
    columns: Vec<(usize, Option<Ends>)>,
    kept: Vec<usize>,
}

/// Two rows and their values: the smallest, and the largest.
type Ends = [(usize, f64); 2];

impl Extremes {
    /// The fewest rows to which a table of these columns can be thinned.
    pub fn fewest(layout: &Table) -> usize {
        2 * counted(layout).len()
    }

    /// Selection from a history of `rows` in the columns of `layout`, of which at most `max_points` stay.
    pub fn new(layout: &Table, rows: usize, max_points: usize) -> Self {
        let columns: Vec<_> = counted(layout).into_iter().map(|place| (place, None)).collect();
        let runs = (max_points / (2 * columns.len()).max(1)).max(1);
        Self { rows, runs, run: 0, next: 0, columns, kept: Vec::new() }
    }

    /// Takes in the rows that come next.
    pub fn add(&mut self, piece: &Table) {
        for row in 0..piece.rows() {
            if self.next >= (self.run + 1) * self.rows / self.runs {
                self.end_run();
            }
            for (place, found) in &mut self.columns {
                let Some(value) = piece.columns.get_index(*place).and_then(|(_, column)| number(column, row))
                else {
                    continue;
                };
                let [least, largest] = found.get_or_insert([(self.next, value); 2]);
                if value < least.1 {
                    *least = (self.next, value);
                }
                if value > largest.1 {
                    *largest = (self.next, value);
                }
            }
            self.next += 1;
        }
    }

    /// The numbers of the rows that stay, ascending.
    pub fn finish(mut self) -> Vec<usize> {
        self.end_run();
        self.kept
    }

    fn end_run(&mut self) {
        let mut of_run: Vec<usize> = self
            .columns
            .iter_mut()
            .filter_map(|(_, found)| found.take())
            .flatten()
            .map(|(row, _)| row)
            .collect();
        of_run.sort_unstable();
        of_run.dedup();
        self.kept.extend(of_run);
        // Some runs are empty if there are fewer rows than runs.
        while self.run + 1 < self.runs && self.next >= (self.run + 1) * self.rows / self.runs {
            self.run += 1;
        }
    }
}

/// Indices of the columns whose extremes count: all but `time`, or `time` if there is no other.
fn counted(layout: &Table) -> Vec<usize> {
    let others: Vec<usize> = (0..layout.columns.len()).filter(|place| !is_time(layout, *place)).collect();
    if others.is_empty() { (0..layout.columns.len()).collect() } else { others }
}

fn is_time(layout: &Table, place: usize) -> bool {
    layout.columns.get_index(place).is_some_and(|(name, _)| name == columns::TIME.name)
}

fn number(column: &Column, row: usize) -> Option<f64> {
    let value = match column {
        Column::Integer(values) => values.get(row).copied().flatten()? as f64,
        Column::Number(values) => *values.get(row)?,
        Column::Single(values) => f64::from(*values.get(row)?),
        Column::Text(_) => return None,
    };
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_stride_is_the_smallest_that_fits() {
        for (max_points, rows) in [(1000, 1000), (999, 500), (500, 500), (300, 250), (1, 1)] {
            assert_eq!((0..1000).step_by(stride(1000, Some(max_points))).len(), rows, "at most {max_points}");
        }
        assert_eq!((stride(1000, None), stride(0, Some(10))), (1, 1));
    }

    fn table(u: &[f64], v: &[f64]) -> Table {
        let time = (0..u.len()).map(|row| row as f64).collect();
        let single = |values: &[f64]| Column::Single(values.iter().map(|value| *value as f32).collect());
        Table::default().with("time", Column::Number(time)).with("u_49", single(u)).with("v_49", single(v))
    }

    #[test]
    fn a_peak_of_one_sample_stays_that_every_stride_misses() {
        let mut u = vec![0.0; 60_000];
        u[12_345] = 1.0;
        u[45_678] = -1.0;
        let mut extremes = Extremes::new(&table(&[], &[]), u.len(), 1000);
        for piece in u.chunks(7_001) {
            extremes.add(&table(piece, piece));
        }
        let kept = extremes.finish();
        assert!(kept.contains(&12_345) && kept.contains(&45_678));
        assert!(kept.len() <= 1000);
    }

    proptest! {
        #[test]
        fn decimated_samples_have_the_bounds_of_the_whole_in_any_pieces(
            path in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 1..400),
            max_points in 4_usize..300,
            piece in 1_usize..100,
        ) {
            // As they are kept.
            let single = |value: f64| f64::from(value as f32);
            let (u, v): (Vec<f64>, Vec<f64>) = path.iter().map(|(u, v)| (single(*u), single(*v))).unzip();
            let mut extremes = Extremes::new(&table(&[], &[]), u.len(), max_points);
            for (u, v) in u.chunks(piece).zip(v.chunks(piece)) {
                extremes.add(&table(u, v));
            }
            let kept = extremes.finish();
            prop_assert!(kept.len() <= max_points);
            prop_assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
            for values in [&u, &v] {
                let of = |rows: &mut dyn Iterator<Item = f64>| {
                    rows.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
                };
                let (kept, whole) =
                    (of(&mut kept.iter().map(|row| values[*row])), of(&mut values.iter().copied()));
                prop_assert_eq!(kept, whole);
            }
        }
    }
}
