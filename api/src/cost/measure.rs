//! Errors of a cost study that a diagram can show.

use std::str::FromStr;

use drillsweep_study::cost::{CostReport, CostRow, Quantity};
use serde::de::IntoDeserializer;
use serde::de::value::Error as ValueError;
use serde::{Deserialize, Serialize};

/// The error that a chart shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Error of the orbit's size, over the orbit window.
    OrbitSize,
    /// Error of the standard deviation of the distance from the hole's axis, over the orbit window.
    RadiusDeviation,
    /// Error of the trajectory, until histories part.
    Trajectory,
}

impl Measure {
    /// All measures, the usual ones first.
    const ALL: [Measure; 3] = [Measure::OrbitSize, Measure::RadiusDeviation, Measure::Trajectory];

    /// Orbit size; the deviation of the radius, or else trajectories, if no run has an error of orbit size to show.
    pub fn usual(report: &CostReport) -> Self {
        let has_any = |measure: &Measure| report.compared().any(|row| measure.of(row) > 0.0);
        Measure::ALL.into_iter().find(has_any).unwrap_or(Measure::OrbitSize)
    }

    /// The size of a run's error, relative; zero, which no diagram shows, if it has none.
    pub fn of(self, row: &CostRow) -> f64 {
        let bias = |quantity| Some(row.errors.as_ref()?.statistic(quantity)?.bias.abs());
        let error = match self {
            Measure::Trajectory => row.errors.as_ref().and_then(|errors| errors.trajectory),
            Measure::OrbitSize => bias(Quantity::OrbitSize),
            Measure::RadiusDeviation => bias(Quantity::RadiusDeviation),
        };
        error.unwrap_or(0.0)
    }
}

impl FromStr for Measure {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Measure::deserialize(name.into_deserializer())
            .map_err(|_: ValueError| "must be orbit_size, radius_deviation or trajectory".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::tests::report;

    #[test]
    fn trajectories_are_shown_without_other_measures() {
        let mut report = report();
        assert_eq!(Measure::usual(&report), Measure::OrbitSize);
        for row in report.references.iter_mut().chain(&mut report.methods) {
            if let Some(errors) = &mut row.errors {
                errors.orbit_size = None;
            }
        }
        assert_eq!(Measure::usual(&report), Measure::Trajectory);
    }

    #[test]
    fn a_measure_is_read_as_it_is_written() {
        for measure in Measure::ALL {
            let written = serde_json::to_value(measure).unwrap();
            assert_eq!(written.as_str().unwrap().parse(), Ok(measure));
        }
        assert!("orbit".parse::<Measure>().is_err());
    }
}
