//! Stability map of a scenario's bit and drive.

use drillsweep_quantity::columns::*;
use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::stability_map::{
    StabilityError, StabilityGrid, StabilityMap, StabilityPoint, stability_map,
};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate_stability_map;
use drillsweep_table::{Column, Table};

use crate::expand::Interruption;
use crate::problem::{ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::stability_map::{AxialTop, MOST_POINTS};

/// Speeds of rotation of a map without any \[rpm\]: 60 to 200 in steps of 2.
const USUAL_SPEEDS: std::ops::RangeInclusive<u32> = 30..=100;

/// A stability map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StabilityRequest {
    /// Speeds of rotation \[rpm\]; none for 60 to 200 in steps of 2.
    pub speeds: Vec<f64>,
    /// Weights on bit \[N\], positive: compression; none for that of the scenario.
    pub weights: Vec<f64>,
    /// Axial condition of the top.
    pub axial_top: AxialTop,
}

/// Reason for which there is no map.
enum Refusal {
    Map(StabilityError),
    Interrupted(Box<ProblemDetails>),
}

impl From<StabilityError> for Refusal {
    fn from(error: StabilityError) -> Self {
        Self::Map(error)
    }
}

impl StabilityRequest {
    /// Growth at every speed and weight in increasing order. Each speed and point begins with a call of `interruption`.
    ///
    /// # Errors
    /// The scenario is not valid or has no equilibrium, the request is out of range, or the work was interrupted.
    pub fn map(
        &self,
        scenario: &Scenario,
        interruption: Interruption<'_>,
    ) -> Result<StabilityMap, Box<ProblemDetails>> {
        let none = |error: String| {
            let detail = format!("the scenario has no stability map: {error}");
            Box::new(ProblemDetails::new(ProblemKind::InvalidRequest, detail))
        };
        validate_stability_map(scenario).map_err(|error| none(error.to_string()))?;
        let model = Model::new(scenario).map_err(|error| none(error.to_string()))?;
        let equilibrium = Equilibrium::find(&model).map_err(|error| none(error.to_string()))?;
        let sorted = |values: &[f64]| {
            let mut values = values.to_vec();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let grid = StabilityGrid {
            speeds: match &self.speeds[..] {
                [] => USUAL_SPEEDS.map(|half| 2.0 * f64::from(half)).collect(),
                speeds => sorted(speeds),
            },
            weights: match &self.weights[..] {
                [] => vec![-scenario.operation.weight_on_bit],
                weights => sorted(weights),
            },
            axial_top: self.axial_top,
        };
        let interrupted = || interruption().map_err(Refusal::Interrupted);
        stability_map(scenario, &model, &equilibrium, &grid, interrupted).map_err(|refusal| match refusal {
            Refusal::Interrupted(problem) => problem,
            Refusal::Map(error) => {
                Box::new(ProblemDetails::new(ProblemKind::InvalidParameter, error.to_string()))
            }
        })
    }
}

/// Points of a map as a table.
pub fn table(points: &[StabilityPoint]) -> Table {
    let numbers = |number: &dyn Fn(&StabilityPoint) -> Option<f64>| {
        Column::Number(points.iter().map(|point| number(point).unwrap_or(f64::NAN)).collect())
    };
    let whole = |number: &dyn Fn(&StabilityPoint) -> Option<usize>| {
        Column::Integer(points.iter().map(|point| number(point).map(|count| count as i64)).collect())
    };
    Table::default()
        .with(&ROTATION_SPEED_RPM, numbers(&|point| Some(point.rotation_speed_rpm)))
        .with(&STABILITY_WEIGHT, numbers(&|point| Some(point.weight_on_bit)))
        .with(&STABILITY_TORQUE, numbers(&|point| Some(point.torque_on_bit)))
        .with(&RATE_OF_PENETRATION, numbers(&|point| point.rate_of_penetration))
        .with(&GROWING_MOTIONS, whole(&|point| point.growing))
        .with(&STABILITY_GROWTH_RATE, numbers(&|point| point.growth_rate))
        .with(&STABILITY_FREQUENCY, numbers(&|point| point.frequency_hz))
        .with(&STABILITY_COMPLETE, whole(&|point| Some(usize::from(point.complete))))
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;
    use crate::expand::UNINTERRUPTED;

    #[test]
    fn a_window_has_a_row_a_speed_and_weight_and_refuses_what_has_none() {
        let scenario = preset("wells/stick-slip-1000m").unwrap();
        let request = StabilityRequest {
            speeds: vec![240.0, 120.0],
            weights: vec![1e5, 2e4],
            axial_top: AxialTop::Advance,
        };
        let points = request.map(&scenario, UNINTERRUPTED).unwrap().points;
        let table = table(&points);
        let column = |name: &str| table.columns[name].numbers().unwrap();
        assert_eq!(column("rotation_speed_rpm"), [120.0, 120.0, 240.0, 240.0]);
        assert_eq!(column("stability_weight"), [2e4, 1e5, 2e4, 1e5]);
        // Torque follows the weight at the speed of the scenario.
        assert!((points[1].torque_on_bit / points[0].torque_on_bit - 5.0).abs() < 1e-9);
        assert!(points[1].growth_rate > points[3].growth_rate, "{points:?}");
        let refused = |request: &StabilityRequest, scenario: &Scenario| {
            request.map(scenario, UNINTERRUPTED).unwrap_err().detail.clone()
        };
        let many = StabilityRequest {
            speeds: (1..=101).map(f64::from).collect(),
            weights: vec![],
            ..request.clone()
        };
        let many = StabilityRequest { weights: (1..=100).map(f64::from).collect(), ..many };
        assert!(refused(&many, &scenario).contains("10000 at most"));
        assert!(refused(&request, &preset("paper-200m").unwrap()).contains("constant torque"));
        let stop = || Err(Box::new(ProblemDetails::new(ProblemKind::TooMuchWork, "enough")));
        assert_eq!(request.map(&scenario, &stop).unwrap_err().detail, "enough");
    }
}
