//! Torque and drag of a scenario over bit depth, by motion and friction: a broomstick.

use drillsweep_quantity::columns::*;
use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::soft_string::{AtDepth, BroomstickRow, Margins, SoftString, SoftStringError};
use drillsweep_table::{Column, Table};

use crate::problem::{ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::soft_string::{DragMode, DragSettings};

/// Bit depths of a broomstick without any, from the top down.
const USUAL_DEPTHS: u32 = 40;

/// Cases of a broomstick.
#[derive(Debug, Clone, PartialEq)]
pub struct Broomstick {
    /// Motions and loads.
    pub modes: Vec<DragMode>,
    /// Bit depths \[m\]; none for 40 of equal steps, the last at the end of the string.
    pub depths: Vec<f64>,
    /// Friction factors of the whole hole; none for the dynamic friction of each hole section.
    pub friction: Vec<f64>,
    /// Travelling weight and axial speed.
    pub settings: DragSettings,
}

impl Broomstick {
    /// Forces of every case.
    ///
    /// # Errors
    /// The scenario has no string in a well, a bit depth is not on the string, or there are too many cases.
    pub fn rows(&self, scenario: &Scenario) -> Result<Vec<BroomstickRow>, SoftStringError> {
        let string = SoftString::new(scenario)?;
        let usual = |i: u32| string.length() * f64::from(i) / f64::from(USUAL_DEPTHS);
        let depths = match &self.depths[..] {
            [] => (1..=USUAL_DEPTHS).map(usual).collect(),
            depths => depths.to_vec(),
        };
        let friction = match &self.friction[..] {
            [] => vec![None],
            friction => friction.iter().copied().map(Some).collect(),
        };
        string.broomstick(&self.modes, &friction, &depths, &self.settings)
    }

    /// Forces of every case as a table.
    ///
    /// # Errors
    /// As [`Broomstick::rows`], as a problem of the parameter.
    pub fn table(&self, scenario: &Scenario) -> Result<Table, Box<ProblemDetails>> {
        let rows = self.rows(scenario);
        Ok(table(
            &rows.map_err(|error| ProblemDetails::new(ProblemKind::InvalidParameter, error.to_string()))?,
        ))
    }
}

/// A broomstick as a table, one row a case.
pub fn table(rows: &[BroomstickRow]) -> Table {
    let numbers = |number: &dyn Fn(&BroomstickRow) -> Option<f64>| {
        Column::Number(rows.iter().map(|row| number(row).unwrap_or(f64::NAN)).collect())
    };
    let margin = |margin: fn(&Margins) -> Option<AtDepth>| {
        let value = numbers(&|row| Some(margin(&row.margins)?.value));
        (value, numbers(&|row| Some(margin(&row.margins)?.measured_depth)))
    };
    let (yields, yields_at) = margin(|margins| margins.yield_ratio);
    let (overpull, overpull_at) = margin(|margins| margins.overpull);
    let (buckles, buckles_at) = margin(|margins| margins.buckling_ratio);
    Table::default()
        .with(&DRAG_MODE, Column::Text(rows.iter().map(|row| Some(row.mode.name().to_owned())).collect()))
        .with(&FRICTION_FACTOR, numbers(&|row| row.friction))
        .with(&BIT_DEPTH, numbers(&|row| Some(row.bit_depth)))
        .with(&HOOK_LOAD, numbers(&|row| Some(row.hook_load)))
        .with(&SURFACE_TORQUE, numbers(&|row| Some(row.surface_torque)))
        .with(&LARGEST_YIELD_RATIO, yields)
        .with(&LARGEST_YIELD_RATIO_DEPTH, yields_at)
        .with(&OVERPULL_MARGIN, overpull)
        .with(&OVERPULL_MARGIN_DEPTH, overpull_at)
        .with(&LARGEST_BUCKLING_RATIO, buckles)
        .with(&LARGEST_BUCKLING_RATIO_DEPTH, buckles_at)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;

    #[test]
    fn a_broomstick_ends_at_the_string_and_has_a_row_a_case() {
        let scenario = preset("paper-200m").unwrap();
        let modes = vec![DragMode::PickUp, DragMode::Rotate];
        let settings = DragSettings::default();
        let mut broomstick = Broomstick { modes, depths: Vec::new(), friction: Vec::new(), settings };
        let table = broomstick.table(&scenario).unwrap();
        assert_eq!(table.rows(), 80);
        let column = |table: &Table, name: &str| table.columns[name].numbers().unwrap();
        let depths = column(&table, "bit_depth");
        assert_eq!((depths[0], depths[39], depths[40]), (5.0, 200.0, 5.0));
        assert!(column(&table, "friction_factor").iter().all(|friction| friction.is_nan()));
        // Off bottom, rotating; the stiff string of this scenario has 12.00 kN in flowing mud, whose drag lifts it.
        let last = *column(&table, "hook_load").last().unwrap();
        assert!((12.00e3..12.5e3).contains(&last), "{last}");
        broomstick.depths = vec![201.0];
        let problem = broomstick.table(&scenario).unwrap_err();
        assert!(problem.detail.contains("201 m"), "{problem:?}");
    }
}
