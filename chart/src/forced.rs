//! The picture of a forced response.

use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::*;
use drillsweep_table::{Column, Table};

use crate::error::ChartError;
use crate::picture::{Drawing, Line, LinePlot};
use crate::shown::{axis, with_unit};

/// A column of a forced response over the speed of rotation: a line for each component of the string.
///
/// # Errors
/// The table has no such column of numbers.
pub fn forced_response(
    table: &Table,
    column: &str,
    title: &str,
    choice: &UnitChoice,
) -> Result<Drawing, ChartError> {
    let values = axis(table, column, choice)?;
    let speeds = axis(table, ROTATION_SPEED_RPM.name, choice)?;
    let Some(Column::Text(components)) = table.columns.get(COMPONENT.name) else {
        return Err(ChartError::no_such_column(table, COMPONENT.name));
    };
    let mut lines: Vec<Line> = Vec::new();
    for (row, component) in components.iter().enumerate() {
        let point = [speeds[row], values[row]];
        // Two components of one name are two lines: the speed begins again.
        let goes_on = |line: &&mut Line| {
            Some(line.name.as_str()) == component.as_deref()
                && line.points.last().is_some_and(|last| last[0] < point[0])
        };
        match lines.last_mut().filter(goes_on) {
            Some(line) => line.points.push(point),
            None => lines.push(Line {
                name: component.clone().unwrap_or_default(),
                points: vec![point],
                is_marked: false,
            }),
        }
    }
    let plot = LinePlot {
        title: title.to_owned(),
        x_label: with_unit(ROTATION_SPEED_RPM.name, choice),
        y_label: with_unit(column, choice),
        lines,
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_has_a_line_for_each_component() {
        let names = ["pipe", "pipe", "bit", "bit"].map(|name| Some(name.to_owned()));
        let table = Table::default()
            .with(&COMPONENT, Column::Text(names.to_vec()))
            .with(&ROTATION_SPEED_RPM, Column::Number(vec![60.0, 120.0, 60.0, 120.0]))
            .with(&FORCED_DISPLACEMENT, Column::Number(vec![1e-3, 2e-3, 3e-3, 1e-3]));
        let draw = |column: &str| forced_response(&table, column, "Response", &UnitChoice::default());
        let svg = draw(FORCED_DISPLACEMENT.name).unwrap().svg();
        for text in ["pipe", "bit", "rotation speed [rpm]", "forced displacement [mm]"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(draw("no_such").is_err());
    }
}
