//! Histories as recorded, over a window and thinned by stride.

use drillsweep_table::quantity::columns;
use drillsweep_table::{Column, Table};

use super::window;

/// The rows of a time-major table over a half-open window \[from, to) of its column `time`.
///
/// With `max_points` every k-th row from the first of the window stays, k the smallest that leaves at most as
/// many. Equal intervals of time survive, extremes between the rows that stay do not: an orbit is thinned
/// by its extremes instead ([`super::orbit`]). The attribute `samples` is the number of rows in the window.
/// A table without a column `time` comes back as it is.
pub fn history(table: Table, from: Option<f64>, to: Option<f64>, max_points: Option<usize>) -> Table {
    let Some(Column::Number(time)) = table.columns.get(columns::TIME.name) else { return table };
    let range = window::samples(time, from, to);
    let samples = range.len();
    let stride = max_points.map_or(1, |max_points| samples.div_ceil(max_points.max(1)).max(1));
    let mut thinned = Table { attributes: table.attributes, ..Table::default() };
    for (name, column) in table.columns {
        thinned.push(name, column.rows(range.clone().step_by(stride)));
    }
    thinned.attribute("samples", samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stride_is_the_smallest_that_fits() {
        let time: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-3).collect();
        let table = Table::default().with("time", Column::Number(time.clone()));
        for (max_points, rows) in [(1000, 1000), (999, 500), (500, 500), (300, 250), (1, 1)] {
            let thinned = history(table.clone(), None, None, Some(max_points));
            assert_eq!(thinned.rows(), rows, "at most {max_points}");
        }
        let window = history(table, Some(0.5), Some(0.75), None);
        assert_eq!(window.columns["time"], Column::Number(time[500..750].to_vec()));
        assert_eq!(window.attributes["samples"], 250);
    }
}
