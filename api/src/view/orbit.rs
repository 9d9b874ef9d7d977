//! The orbit of one node: its path in the plane across the hole.

use drillsweep_quantity::columns;
use drillsweep_table::{Column, Table};

use super::window;

/// The recorded lateral motion of one node.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// Recording times \[s\].
    pub time: &'a [f64],
    /// Displacement u \[m\], one value a time.
    pub u: &'a [f64],
    /// Displacement v \[m\], one value a time.
    pub v: &'a [f64],
}

impl<'a> Motion<'a> {
    /// The samples of a half-open window \[from, to); an absent end is open.
    pub fn window(&self, from: Option<f64>, to: Option<f64>) -> Motion<'a> {
        let range = window::samples(self.time, from, to);
        Motion { time: &self.time[range.clone()], u: &self.u[range.clone()], v: &self.v[range] }
    }
}

/// The fewest points to which an orbit can be thinned: one run of samples, its extremes in u and in v.
pub const FEWEST_POINTS: usize = 4;

/// The orbit over a half-open window: columns `time`, `u`, `v`, `radius`, in order of time.
///
/// With `max_points` (4 or more) the orbit is thinned to at most as many samples: the window is cut into
/// `max_points / 4` runs of samples, and of each those with the smallest and the largest u and v stay. What
/// stays are recorded samples, and the box around the thinned orbit is that around the whole one.
/// The attribute `samples` is the number of samples in the window.
pub fn orbit(motion: &Motion<'_>, from: Option<f64>, to: Option<f64>, max_points: Option<usize>) -> Table {
    let Motion { time, u, v } = motion.window(from, to);
    let kept = match max_points {
        Some(max_points) if max_points < time.len() => extremes(u, v, max_points.max(FEWEST_POINTS) / 4),
        _ => (0..time.len()).collect(),
    };
    let take = |values: &[f64]| kept.iter().map(|&i| values[i]).collect();
    Table::default()
        .with(&columns::TIME, Column::Number(take(time)))
        .with(&columns::U, Column::Number(take(u)))
        .with(&columns::V, Column::Number(take(v)))
        .with(&columns::RADIUS, Column::Number(kept.iter().map(|&i| u[i].hypot(v[i])).collect()))
        .attribute("samples", time.len())
}

/// The samples with the smallest and largest u and v of each of `runs` equal runs, in order, each once.
fn extremes(u: &[f64], v: &[f64], runs: usize) -> Vec<usize> {
    let mut kept = Vec::with_capacity(4 * runs);
    for run in 0..runs {
        let range = run * u.len() / runs..(run + 1) * u.len() / runs;
        let mut of_run: Vec<usize> = [u, v]
            .into_iter()
            .flat_map(|values| {
                let by_value = |&a: &usize, &b: &usize| values[a].total_cmp(&values[b]);
                [range.clone().min_by(by_value), range.clone().max_by(by_value)]
            })
            .flatten()
            .collect();
        of_run.sort_unstable();
        of_run.dedup();
        kept.extend(of_run);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn column<'t>(table: &'t Table, name: &str) -> &'t [f64] {
        match &table.columns[name] {
            Column::Number(values) => values,
            other => panic!("{name} is {other:?}"),
        }
    }

    #[test]
    fn a_circle_has_one_radius() {
        let time: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-3).collect();
        let u: Vec<f64> = time.iter().map(|t| 0.03 * (12.0 * t).cos()).collect();
        let v: Vec<f64> = time.iter().map(|t| 0.03 * (12.0 * t).sin()).collect();
        let motion = Motion { time: &time, u: &u, v: &v };
        let table = orbit(&motion, Some(0.2), Some(0.7), None);
        assert_eq!(table.rows(), 500);
        assert_eq!(column(&table, "time")[0], 0.2);
        for radius in column(&table, "radius") {
            assert!((radius - 0.03).abs() < 1e-16);
        }
    }

    proptest! {
        #[test]
        fn thinning_keeps_the_extremes_and_the_order(
            path in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 1..400),
            max_points in FEWEST_POINTS..200,
        ) {
            let time: Vec<f64> = (0..path.len()).map(|i| i as f64).collect();
            let (u, v): (Vec<f64>, Vec<f64>) = path.iter().copied().unzip();
            let thinned = orbit(&Motion { time: &time, u: &u, v: &v }, None, None, Some(max_points));
            prop_assert!(thinned.rows() <= max_points);
            for (name, whole) in [("u", &u), ("v", &v)] {
                let extreme = |values: &[f64]| {
                    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
                };
                prop_assert_eq!(extreme(column(&thinned, name)), extreme(whole));
            }
            let times = column(&thinned, "time");
            prop_assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
            for (row, &instant) in times.iter().enumerate() {
                prop_assert_eq!(column(&thinned, "u")[row], u[instant as usize]);
            }
        }
    }
}
