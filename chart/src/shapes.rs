//! The picture of shapes of modes.

use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::*;
use drillsweep_table::{Column, Table};

use crate::error::ChartError;
use crate::picture::{Drawing, Line, LinePlot, VerticalAxis};
use crate::shown::{axis, with_unit};

/// Shapes drawn, of the lowest frequencies.
const MOST_LINES: f64 = 8.0;

/// Shapes of modes over measured depth, which grows downwards: a line for the main motion of each of the first eight modes.
///
/// # Errors
/// The table is none of shapes.
pub fn mode_shapes(table: &Table, title: &str, choice: &UnitChoice) -> Result<Drawing, ChartError> {
    let number = |name: &str| axis(table, name, choice);
    let (modes, frequencies, depths) =
        (number(MODE.name)?, number(FREQUENCY.name)?, number(MEASURED_DEPTH.name)?);
    let [lateral, axial, torsional] =
        [number(LATERAL_SHAPE.name)?, number(AXIAL_SHAPE.name)?, number(TORSIONAL_SHAPE.name)?];
    let Some(Column::Text(kinds)) = table.columns.get(MODE_KIND.name) else {
        return Err(ChartError::no_such_column(table, MODE_KIND.name));
    };
    let mut lines: Vec<Line> = Vec::new();
    for (row, kind) in kinds.iter().enumerate().filter(|(row, _)| modes[*row] <= MOST_LINES) {
        let kind = kind.as_deref().unwrap_or_default();
        let shape = match kind {
            "axial" => &axial,
            "torsional" => &torsional,
            _ => &lateral,
        };
        if lines.len() < modes[row] as usize {
            let name = format!("{}: {:.3} {}, {kind}", modes[row], frequencies[row], unit(choice));
            lines.push(Line { name, points: Vec::new(), is_marked: false });
        }
        if let Some(line) = lines.last_mut() {
            line.points.push([shape[row], depths[row]]);
        }
    }
    let plot = LinePlot {
        title: title.to_owned(),
        x_label: "displacement relative to the largest".to_owned(),
        y_label: with_unit(MEASURED_DEPTH.name, choice),
        lines,
        vertical: VerticalAxis::Depth,
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

/// Symbol of the unit of frequencies.
fn unit(choice: &UnitChoice) -> &'static str {
    choice.shown(FREQUENCY.name).map_or("", |unit| unit.symbol)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_has_a_line_named_by_its_frequency_and_motion() {
        let kinds = ["torsional", "torsional", "backward", "backward"].map(|name| Some(name.to_owned()));
        let table = Table::default()
            .with(&MODE, Column::Number(vec![1.0, 1.0, 2.0, 2.0]))
            .with(&FREQUENCY, Column::Number(vec![2.15, 2.15, 3.5, 3.5]))
            .with(&MODE_KIND, Column::Text(kinds.to_vec()))
            .with(&MEASURED_DEPTH, Column::Number(vec![0.0, 200.0, 0.0, 200.0]))
            .with(&LATERAL_SHAPE, Column::Number(vec![0.0, 0.0, 0.0, 1.0]))
            .with(&AXIAL_SHAPE, Column::Number(vec![0.0; 4]))
            .with(&TORSIONAL_SHAPE, Column::Number(vec![0.0, 1.0, 0.0, 0.1]));
        let svg = mode_shapes(&table, "Modes", &UnitChoice::default()).unwrap().svg();
        for text in ["1: 2.150 Hz, torsional", "2: 3.500 Hz, backward", "measured depth [m]"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(mode_shapes(&Table::default(), "Modes", &UnitChoice::default()).is_err());
    }
}
