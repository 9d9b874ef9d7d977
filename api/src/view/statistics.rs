//! Positions and sizes of the orbits of a window.

use drillsweep_quantity::columns;
use drillsweep_sim::math::signal::{OrbitStatistics, orbit_statistics};
use drillsweep_table::{Column, Table};

use super::orbit::Motion;
use crate::problem::ProblemDetails;

/// The statistics of recorded nodes over a window, one row a node.
#[derive(Debug, Default)]
pub struct StatisticsTable {
    nodes: Vec<Option<i64>>,
    depths: Vec<f64>,
    statistics: Vec<OrbitStatistics>,
    samples: usize,
}

impl StatisticsTable {
    /// Adds a node with all samples of its motion.
    ///
    /// # Errors
    /// There are none.
    pub fn push(
        &mut self,
        node: u32,
        measured_depth: f64,
        motion: &Motion<'_>,
    ) -> Result<(), Box<ProblemDetails>> {
        let Some(statistics) = orbit_statistics(motion.u, motion.v) else {
            let detail = "the window holds no samples";
            return Err(ProblemDetails::invalid_parameter("from", None, detail).into());
        };
        self.nodes.push(Some(node.into()));
        self.depths.push(measured_depth);
        self.statistics.push(statistics);
        self.samples = motion.time.len();
        Ok(())
    }

    /// The table; its attribute `samples` is the number of samples in the window.
    pub fn finish(self) -> Table {
        let column =
            |value: fn(&OrbitStatistics) -> f64| Column::Number(self.statistics.iter().map(value).collect());
        Table::default()
            .with(&columns::NODE, Column::Integer(self.nodes.clone()))
            .with(&columns::MEASURED_DEPTH, Column::Number(self.depths.clone()))
            .with(&columns::ORBIT_RADIUS_RMS, column(|orbit| orbit.orbit_radius_rms))
            .with(&columns::ORBIT_MEAN_RADIUS, column(|orbit| orbit.mean_radius))
            .with(&columns::ORBIT_RADIUS_DEVIATION, column(|orbit| orbit.radius_deviation))
            .with(&columns::ORBIT_LARGEST_RADIUS, column(|orbit| orbit.largest_radius))
            .with(&columns::ORBIT_SMALLEST_RADIUS, column(|orbit| orbit.smallest_radius))
            .with(&columns::ORBIT_OFFSET, column(|orbit| orbit.mean_u.hypot(orbit.mean_v)))
            .with(&columns::PEAK_TO_PEAK_U, column(|orbit| orbit.peak_to_peak_u))
            .with(&columns::PEAK_TO_PEAK_V, column(|orbit| orbit.peak_to_peak_v))
            .attribute("samples", self.samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_circle_about_a_point_has_its_radius_and_offset() {
        let time: Vec<f64> = (0..1000).map(|row| f64::from(row) * 1e-3).collect();
        let u: Vec<f64> = time.iter().map(|t| 4e-3 + 5e-3 * (2.0 * TAU * t).cos()).collect();
        let v: Vec<f64> = time.iter().map(|t| 3e-3 + 5e-3 * (2.0 * TAU * t).sin()).collect();
        let mut table = StatisticsTable::default();
        table.push(49, 57.73, &Motion { time: &time, u: &u, v: &v }).unwrap();
        let table = table.finish();
        let value = |name: &str| table.columns[name].numbers().unwrap()[0];
        for (name, expected) in [
            ("node", 49.0),
            ("orbit_radius_rms", 5e-3),
            ("orbit_offset", 5e-3),
            ("orbit_largest_radius", 1e-2),
            ("peak_to_peak_u", 1e-2),
        ] {
            // The largest radius lies between two samples, 6 mrad apart at most.
            assert!((value(name) / expected - 1.0).abs() < 2e-5, "{name}: {}", value(name));
        }
        // Mean square radius: the offset's and the circle's.
        let mean_square = value("orbit_mean_radius").powi(2) + value("orbit_radius_deviation").powi(2);
        assert!((mean_square / 5e-5 - 1.0).abs() < 1e-12);
        assert_eq!(table.attributes["samples"], 1000);

        let nothing = Motion { time: &[], u: &[], v: &[] };
        let problem = StatisticsTable::default().push(49, 57.73, &nothing).unwrap_err();
        assert_eq!(problem.errors[0].parameter.as_deref(), Some("from"));
    }
}
