//! Forced response of a scenario's string over the speed of rotation.

use drillsweep_quantity::columns::*;
use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{ComponentResponse, component_responses, forced_response};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_table::{Column, Table};

use crate::expand::Interruption;
use crate::problem::{ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::modes::{Excitation, MOST_SPEEDS};

/// Speeds of rotation of a response without any \[rpm\]: 40 to 240 in steps of 1.
const USUAL_SPEEDS: std::ops::RangeInclusive<u32> = 40..=240;

/// A forced response.
#[derive(Debug, Clone, PartialEq)]
pub struct ForcedRequest {
    /// Speeds of rotation \[rpm\]; none for 40 to 240 in steps of 1.
    pub speeds: Vec<f64>,
    /// Force that excites the string.
    pub excitation: Excitation,
}

impl ForcedRequest {
    /// Largest responses of each component of the string from the top, at every speed in increasing order. Each speed begins with a call of `interruption`.
    ///
    /// # Errors
    /// The scenario has no model or no equilibrium, the request is out of range, or the work was interrupted.
    pub fn rows(
        &self,
        scenario: &Scenario,
        interruption: Interruption<'_>,
    ) -> Result<Vec<ComponentResponse>, Box<ProblemDetails>> {
        let refused = |error: String| Box::new(ProblemDetails::new(ProblemKind::InvalidParameter, error));
        let none = |error: String| {
            let detail = format!("the scenario has no forced response: {error}");
            Box::new(ProblemDetails::new(ProblemKind::InvalidRequest, detail))
        };
        let model = Model::new(scenario).map_err(|error| none(error.to_string()))?;
        let equilibrium = Equilibrium::find(&model).map_err(|error| none(error.to_string()))?;
        let mut speeds: Vec<f64> = match &self.speeds[..] {
            [] => USUAL_SPEEDS.map(f64::from).collect(),
            speeds => speeds.to_vec(),
        };
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let responses = forced_response(&model, &equilibrium, &self.excitation, &speeds)
            .map_err(|error| refused(error.to_string()))?;
        let responses = responses.map(|response| {
            interruption()?;
            response.map_err(|error| refused(error.to_string()))
        });
        component_responses(&model, responses)
    }

    /// The same as a table, one row a component and speed.
    ///
    /// # Errors
    /// As [`ForcedRequest::rows`].
    pub fn table(
        &self,
        scenario: &Scenario,
        interruption: Interruption<'_>,
    ) -> Result<Table, Box<ProblemDetails>> {
        Ok(table(&self.rows(scenario, interruption)?))
    }
}

/// Responses of components as a table.
pub fn table(rows: &[ComponentResponse]) -> Table {
    let numbers =
        |number: &dyn Fn(&ComponentResponse) -> f64| Column::Number(rows.iter().map(number).collect());
    Table::default()
        .with(&COMPONENT, Column::Text(rows.iter().map(|row| Some(row.component.clone())).collect()))
        .with(&ROTATION_SPEED_RPM, numbers(&|row| row.rotation_speed_rpm))
        .with(&EXCITATION_FREQUENCY, numbers(&|row| row.frequency_hz))
        .with(&FORCED_DISPLACEMENT, numbers(&|row| row.displacement[0]))
        .with(&FORCED_DISPLACEMENT_DEPTH, numbers(&|row| row.displacement[1]))
        .with(&FORCED_ACCELERATION, numbers(&|row| row.acceleration))
        .with(&FORCED_SIDE_FORCE, numbers(&|row| row.side_force[0]))
        .with(&FORCED_SIDE_FORCE_DEPTH, numbers(&|row| row.side_force[1]))
        .with(&FORCED_BENDING_MOMENT, numbers(&|row| row.bending_moment))
        .with(&FORCED_BENDING_STRESS, numbers(&|row| row.bending_stress[0]))
        .with(&FORCED_BENDING_STRESS_DEPTH, numbers(&|row| row.bending_stress[1]))
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;
    use crate::expand::UNINTERRUPTED;

    #[test]
    fn a_response_has_a_row_a_component_and_speed_and_refuses_places_off_the_string() {
        let scenario = preset("paper-200m").unwrap();
        let mut request =
            ForcedRequest { speeds: vec![120.0, 60.0, 120.0], excitation: Excitation::Unbalance };
        let table = request.table(&scenario, UNINTERRUPTED).unwrap();
        assert_eq!(table.rows(), 2 * scenario.string.sections.len());
        let column = |name: &str| table.columns[name].numbers().unwrap();
        assert_eq!(column("rotation_speed_rpm")[..2], [60.0, 120.0]);
        assert_eq!(column("excitation_frequency")[..2], [1.0, 2.0]);
        assert!(column("forced_displacement").iter().any(|displacement| *displacement > 0.0));
        let stop = || Err(Box::new(ProblemDetails::new(ProblemKind::TooMuchWork, "enough")));
        assert_eq!(request.table(&scenario, &stop).unwrap_err().detail, "enough");
        request.excitation =
            Excitation::Turning { measured_depth: 201.0, amplitude: 1.0, per_revolution: 1.0 };
        let problem = request.table(&scenario, UNINTERRUPTED).unwrap_err();
        assert!(problem.status == 400 && problem.detail.contains("201 m"), "{problem:?}");
    }
}
