//! The picture of a stability map.

use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::*;
use drillsweep_table::Table;

use crate::error::ChartError;
use crate::picture::{Drawing, MapPoint, Spacing, SweepMap};
use crate::shown::{axis, with_unit};

/// A column of a stability map over rotation speed and weight on bit. Growth is zero if no motion grows; points whose motions could not be counted are crossed
/// out.
///
/// # Errors
/// The table has no such column of numbers.
pub fn stability_map(
    table: &Table,
    column: &str,
    title: &str,
    choice: &UnitChoice,
) -> Result<Drawing, ChartError> {
    let numbers = |name: &str| axis(table, name, choice);
    let (speeds, weights) = (numbers(ROTATION_SPEED_RPM.name)?, numbers(STABILITY_WEIGHT.name)?);
    let (values, growing) = (numbers(column)?, numbers(GROWING_MOTIONS.name)?);
    let value = |row: usize| {
        let is_quiet = column == STABILITY_GROWTH_RATE.name && growing[row] == 0.0;
        if is_quiet { 0.0 } else { values[row] }
    };
    let points = (0..table.rows()).map(|row| MapPoint {
        x: speeds[row],
        y: weights[row],
        value: value(row),
        ..MapPoint::default()
    });
    let map = SweepMap {
        title: title.to_owned(),
        x_label: with_unit(ROTATION_SPEED_RPM.name, choice),
        y_label: with_unit(STABILITY_WEIGHT.name, choice),
        value_label: with_unit(column, choice),
        points: points.collect(),
        spacing: Spacing::ToScale,
        ..SweepMap::default()
    };
    Ok(map.drawing())
}

#[cfg(test)]
mod tests {
    use drillsweep_table::Column;

    use super::*;

    #[test]
    fn a_window_is_over_speed_and_weight_and_zero_if_nothing_grows() {
        let table = Table::default()
            .with(&ROTATION_SPEED_RPM, Column::Number(vec![60.0, 60.0, 120.0, 120.0]))
            .with(&STABILITY_WEIGHT, Column::Number(vec![5e4, 1e5, 5e4, 1e5]))
            .with(&GROWING_MOTIONS, Column::Integer(vec![Some(1), Some(2), Some(0), None]))
            .with(&STABILITY_GROWTH_RATE, Column::Number(vec![0.5, 0.75, f64::NAN, f64::NAN]));
        let draw = |column: &str| stability_map(&table, column, "Stability", &UnitChoice::default());
        let growth = draw(STABILITY_GROWTH_RATE.name).unwrap().svg();
        for text in ["Stability", "rotation speed [rpm]", "weight on bit [kN]", "0.75"] {
            assert!(growth.contains(text), "{text}");
        }
        assert!(draw(GROWING_MOTIONS.name).is_ok());
        assert!(draw("no_such").is_err());
    }
}
