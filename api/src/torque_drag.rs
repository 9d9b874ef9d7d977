//! Torque and drag of a scenario over bit depth, by motion and friction: a broomstick. Friction factors from measured hook loads and torques.

use drillsweep_quantity::columns::*;
use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::soft_string::{
    AtDepth, BroomstickRow, DragCase, FitError, FitSettings, Margins, SoftString,
};
use drillsweep_sim::solve::stiff_string::stiff_row;
use drillsweep_table::{Column, Table};
use serde::{Deserialize, Serialize};

use crate::expand::Interruption;
use crate::problem::{FieldProblem, ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::soft_string::{DragMode, DragSettings, FrictionFit, MeasuredPoint};

/// Largest number of cases of one stiff broomstick: modes times friction factors times depths.
const MOST_STIFF_CASES: usize = 60;

/// Largest number of measured points of one fit.
const MOST_MEASURED_POINTS: usize = 500;

/// Bit depths of a broomstick without any, from the top down.
const USUAL_DEPTHS: u32 = 40;

/// Cases of a broomstick.
#[derive(Debug, Clone, PartialEq)]
pub struct Broomstick {
    /// Motions and loads.
    pub modes: Vec<DragMode>,
    /// Bit depths \[m\]; none for 40 of equal steps, the last at the scenario's, and for that alone with a stiff string.
    pub depths: Vec<f64>,
    /// Friction factors of the whole hole; none for the dynamic friction of each hole section.
    pub friction: Vec<f64>,
    /// Travelling weight and axial speed.
    pub settings: DragSettings,
    /// True for the equilibria of the finite elements in place of the soft string.
    pub is_stiff: bool,
}

impl Broomstick {
    /// Forces of every case. Each case of the stiff string begins with a call of `interruption`.
    ///
    /// # Errors
    /// The scenario has no string in a well, a bit depth is not on the string, there are too many cases, a stiff string has no equilibrium, or the work was
    /// interrupted; as a problem of the parameter.
    pub fn rows(
        &self,
        scenario: &Scenario,
        interruption: Interruption<'_>,
    ) -> Result<Vec<BroomstickRow>, Box<ProblemDetails>> {
        let string = SoftString::new(scenario).map_err(|error| refused(&error))?;
        let usual = |i: u32| string.bit_depth() * f64::from(i) / f64::from(USUAL_DEPTHS);
        let depths = match &self.depths[..] {
            [] if self.is_stiff => vec![string.bit_depth()],
            [] => (1..=USUAL_DEPTHS).map(usual).collect(),
            depths => depths.to_vec(),
        };
        let friction = match &self.friction[..] {
            [] => vec![None],
            friction => friction.iter().copied().map(Some).collect(),
        };
        // The soft string, which takes microseconds, checks all cases.
        let soft = string
            .broomstick(&self.modes, &friction, &depths, &self.settings)
            .map_err(|error| refused(&error))?;
        if !self.is_stiff {
            return Ok(soft);
        }
        if soft.len() > MOST_STIFF_CASES {
            let requested = soft.len();
            return Err(refused(&format!(
                "{requested} cases of the stiff string are requested, of {MOST_STIFF_CASES} at most"
            )));
        }
        let stiff = |row: &BroomstickRow| {
            interruption()?;
            let case = DragCase { mode: row.mode, bit_depth: row.bit_depth, friction: row.friction };
            stiff_row(scenario, &case, &self.settings).map_err(|error| refused(&error))
        };
        soft.iter().map(stiff).collect()
    }

    /// Forces of every case as a table.
    ///
    /// # Errors
    /// As [`Broomstick::rows`].
    pub fn table(
        &self,
        scenario: &Scenario,
        interruption: Interruption<'_>,
    ) -> Result<Table, Box<ProblemDetails>> {
        Ok(table(&self.rows(scenario, interruption)?))
    }
}

fn refused(error: &impl ToString) -> Box<ProblemDetails> {
    Box::new(ProblemDetails::new(ProblemKind::InvalidParameter, error.to_string()))
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
    let (made_up, made_up_at) = margin(|margins| margins.make_up_ratio);
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
        .with(&LARGEST_MAKE_UP_RATIO, made_up)
        .with(&LARGEST_MAKE_UP_RATIO_DEPTH, made_up_at)
        .with(&LARGEST_BUCKLING_RATIO, buckles)
        .with(&LARGEST_BUCKLING_RATIO_DEPTH, buckles_at)
}

/// Hook loads and torques measured at the surface, to which friction factors are fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FrictionRequest {
    /// Measured points, 1 to 500.
    pub points: Vec<MeasuredPoint>,
    /// Weight of top drive and travelling block \[N\], part of the hook loads; 0 unless given.
    #[serde(default)]
    pub travelling_weight: f64,
    /// Axial speed of points of the mode `ream` \[m/s\], downhole positive.
    #[serde(default)]
    pub axial_speed: Option<f64>,
    /// Standard deviation of a measured hook load \[N\], which weighs hook loads against torques; 10 kN unless given.
    #[serde(default = "hook_load_deviation")]
    pub hook_load_deviation: f64,
    /// Standard deviation of a measured torque \[N m\]; 1 kN m unless given.
    #[serde(default = "torque_deviation")]
    pub torque_deviation: f64,
}

fn hook_load_deviation() -> f64 {
    FitSettings::default().hook_load_deviation
}

fn torque_deviation() -> f64 {
    FitSettings::default().torque_deviation
}

impl FrictionRequest {
    /// Friction factors of the hole sections of a scenario that fit the measurements best, by least squares on the soft string.
    ///
    /// # Errors
    /// There are too many points, a point is not on the string, a number is out of range, or the points do not determine the factors.
    pub fn fit(&self, scenario: &Scenario) -> Result<FrictionFit, Box<ProblemDetails>> {
        let refused = |pointer: String, detail: String| {
            let problem = FieldProblem { pointer: Some(pointer), parameter: None, got: None, detail };
            Box::new(ProblemDetails::invalid_request(vec![problem]))
        };
        if !(1..=MOST_MEASURED_POINTS).contains(&self.points.len()) {
            let detail = format!("must be 1 to {MOST_MEASURED_POINTS} points, not {}", self.points.len());
            return Err(refused("/points".to_owned(), detail));
        }
        let settings = FitSettings {
            drag: DragSettings { travelling_weight: self.travelling_weight, axial_speed: self.axial_speed },
            hook_load_deviation: self.hook_load_deviation,
            torque_deviation: self.torque_deviation,
        };
        let string = SoftString::new(scenario)
            .map_err(|error| ProblemDetails::new(ProblemKind::InvalidRequest, error.to_string()))?;
        string.fit_friction(&self.points, &settings).map_err(|error| {
            let pointer = match error {
                FitError::Case { point, .. } => format!("/points/{point}"),
                FitError::Number(_) | FitError::Undetermined { .. } | FitError::NotConverged => {
                    "/points".to_owned()
                }
            };
            refused(pointer, error.to_string())
        })
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;
    use crate::expand::UNINTERRUPTED;

    #[test]
    fn a_broomstick_ends_at_the_string_and_has_a_row_a_case() {
        let scenario = preset("paper-200m").unwrap();
        let modes = vec![DragMode::PickUp, DragMode::Rotate];
        let settings = DragSettings::default();
        let mut broomstick =
            Broomstick { modes, depths: Vec::new(), friction: Vec::new(), settings, is_stiff: false };
        let table = broomstick.table(&scenario, UNINTERRUPTED).unwrap();
        assert_eq!(table.rows(), 80);
        let column = |table: &Table, name: &str| table.columns[name].numbers().unwrap();
        let depths = column(&table, "bit_depth");
        assert_eq!((depths[0], depths[39], depths[40]), (5.0, 200.0, 5.0));
        assert!(column(&table, "friction_factor").iter().all(|friction| friction.is_nan()));
        // Off bottom, rotating; the stiff string of this scenario has 12.00 kN in flowing mud, whose drag lifts it.
        let last = *column(&table, "hook_load").last().unwrap();
        assert!((12.00e3..12.5e3).contains(&last), "{last}");
        let stiff =
            Broomstick { is_stiff: true, ..broomstick.clone() }.table(&scenario, UNINTERRUPTED).unwrap();
        // In flowing mud, with the dynamic friction of the scenario as the soft string.
        assert_eq!(column(&stiff, "bit_depth"), [200.0, 200.0]);
        let (up, soft) = (column(&stiff, "hook_load"), column(&table, "hook_load"));
        assert!((up[1] / 12.00e3 - 1.0).abs() < 1e-2 && up[0] > up[1] && up[0] < soft[39], "{up:?}");
        let many = Broomstick { is_stiff: true, friction: vec![0.2; 31], ..broomstick.clone() };
        let problem = many.table(&scenario, UNINTERRUPTED).unwrap_err();
        assert!(problem.detail.contains("62 cases"), "{problem:?}");
        broomstick.depths = vec![201.0];
        let problem = broomstick.table(&scenario, UNINTERRUPTED).unwrap_err();
        assert!(problem.detail.contains("201 m"), "{problem:?}");
    }

    #[test]
    fn friction_is_fitted_to_points_of_the_string_and_others_are_refused() {
        let scenario = preset("paper-200m").unwrap();
        let broomstick = Broomstick {
            modes: vec![DragMode::PickUp, DragMode::SlackOff],
            depths: vec![120.0, 200.0],
            friction: vec![0.27],
            settings: DragSettings { travelling_weight: 2e5, axial_speed: None },
            is_stiff: false,
        };
        let point = |row: &BroomstickRow| serde_json::json!({ "bit_depth": row.bit_depth, "mode": row.mode.name(), "hook_load": row.hook_load });
        let points: Vec<_> = broomstick.rows(&scenario, UNINTERRUPTED).unwrap().iter().map(point).collect();
        let request = |points: &[serde_json::Value]| -> FrictionRequest {
            serde_json::from_value(serde_json::json!({ "points": points, "travelling_weight": 2e5 })).unwrap()
        };
        let fit = request(&points).fit(&scenario).unwrap();
        assert!((fit.friction[0].friction - 0.27).abs() < 1e-8, "{fit:?}");
        let refused = |points: &[serde_json::Value]| {
            let problem = request(points).fit(&scenario).unwrap_err();
            (problem.status, problem.errors[0].pointer.clone().unwrap())
        };
        assert_eq!(refused(&[]), (422, "/points".to_owned()));
        let mut beyond = points.clone();
        beyond[2]["bit_depth"] = 201.0.into();
        assert_eq!(refused(&beyond), (422, "/points/2".to_owned()));
        assert_eq!(refused(&vec![points[0].clone(); 501]), (422, "/points".to_owned()));
        // A point without a measurement determines nothing.
        beyond[2] = serde_json::json!({ "bit_depth": 200.0, "mode": "rotate" });
        assert_eq!(refused(&beyond[2..3]), (422, "/points".to_owned()));
    }
}
