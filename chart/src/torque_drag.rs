//! The picture of a broomstick.

use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::*;
use drillsweep_table::{Column, Table};

use crate::error::ChartError;
use crate::picture::{Drawing, Line, LinePlot, VerticalAxis};
use crate::shown::{axis, with_unit};

/// Hook load, or another column, over the depth of the bit, which grows downwards: a line for each motion and friction factor.
///
/// # Errors
/// The table has no such column of numbers.
pub fn broomstick(
    table: &Table,
    column: &str,
    title: &str,
    choice: &UnitChoice,
) -> Result<Drawing, ChartError> {
    let values = axis(table, column, choice)?;
    let depths = axis(table, BIT_DEPTH.name, choice)?;
    let friction = axis(table, FRICTION_FACTOR.name, choice)?;
    let Some(Column::Text(modes)) = table.columns.get(DRAG_MODE.name) else {
        return Err(ChartError::no_such_column(table, DRAG_MODE.name));
    };
    let mut lines: Vec<Line> = Vec::new();
    for (row, mode) in modes.iter().enumerate() {
        let mode = mode.as_deref().unwrap_or_default().replace('_', " ");
        let name = if friction[row].is_nan() { mode } else { format!("{mode}, {}", friction[row]) };
        let point = [values[row], depths[row]];
        match lines.last_mut().filter(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => lines.push(Line { name, points: vec![point], is_marked: false }),
        }
    }
    let plot = LinePlot {
        title: title.to_owned(),
        x_label: with_unit(column, choice),
        y_label: with_unit(BIT_DEPTH.name, choice),
        lines,
        vertical: VerticalAxis::Depth,
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broomstick_has_a_line_for_each_motion_and_friction() {
        let column = |values: &[f64]| Column::Number(values.to_vec());
        let text = |values: [&str; 4]| Column::Text(values.map(|value| Some(value.to_owned())).to_vec());
        let table = Table::default()
            .with(&DRAG_MODE, text(["pick_up", "pick_up", "pick_up", "rotate"]))
            .with(&FRICTION_FACTOR, column(&[0.2, 0.2, 0.3, f64::NAN]))
            .with(&BIT_DEPTH, column(&[1000.0, 2000.0, 1000.0, 1000.0]))
            .with(&HOOK_LOAD, column(&[4e5, 8e5, 5e5, 3e5]))
            .with(&SURFACE_TORQUE, column(&[0.0, 0.0, 0.0, 5e3]));
        let svg = broomstick(&table, HOOK_LOAD.name, "Broomstick", &UnitChoice::default()).unwrap().svg();
        for text in ["pick up, 0.2", "pick up, 0.3", ">rotate<", "hook load [kN]", "bit depth [m]"] {
            assert!(svg.contains(text), "{text}");
        }
        let torque =
            broomstick(&table, SURFACE_TORQUE.name, "", &UnitChoice::parse("field").unwrap()).unwrap().svg();
        assert!(torque.contains("surface torque [ft lbf]") && torque.contains("bit depth [ft]"));
        assert!(broomstick(&table, "no_such", "", &UnitChoice::default()).is_err());
        assert!(broomstick(&Table::default(), HOOK_LOAD.name, "", &UnitChoice::default()).is_err());
    }
}
