//! The picture of values along the string.

use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::*;
use drillsweep_table::Table;

use crate::error::ChartError;
use crate::picture::{Drawing, Line, LinePlot, VerticalAxis};
use crate::shown::{Shown, axis, with_unit};
use crate::words::words;

/// Values along the string, depth downwards: C_f, or the `fields` that are given. A value of an element holds for its whole length, one of a
/// node for its depth.
///
/// # Errors
/// A problem that names the columns there are, if a field is none of them.
pub fn profile(
    table: &Table,
    fields: Option<&[String]>,
    title: &str,
    choice: &UnitChoice,
) -> Result<Drawing, ChartError> {
    let fallback = if table.columns.contains_key(FRICTION_COEFFICIENT.name) {
        FRICTION_COEFFICIENT.name
    } else {
        ECCENTRICITY.name
    };
    let names: Vec<&str> = match fields {
        Some(fields) => fields.iter().map(String::as_str).collect(),
        None => vec![fallback],
    };
    let is_of_nodes = table.columns.contains_key(MEASURED_DEPTH.name);
    let ends: &[&str] = if is_of_nodes {
        &[MEASURED_DEPTH.name]
    } else {
        &[MEASURED_DEPTH_TOP.name, MEASURED_DEPTH_BOTTOM.name]
    };
    let depths = ends.iter().map(|name| axis(table, name, choice)).collect::<Result<Vec<_>, _>>()?;
    let shown = Shown::of(table, &names, choice)?;
    let line = |(name, values): (&str, Vec<f64>)| Line {
        name: words(name),
        points: values
            .iter()
            .enumerate()
            .flat_map(|(row, value)| depths.iter().map(move |depth| [*value, depth[row]]))
            .collect(),
        is_marked: false,
    };
    let plot = LinePlot {
        title: title.to_owned(),
        x_label: shown.label(&[], choice),
        y_label: with_unit(MEASURED_DEPTH.name, choice),
        lines: shown.columns.into_iter().map(line).collect(),
        vertical: VerticalAxis::Depth,
        ..LinePlot::default()
    };
    Ok(plot.drawing())
}

#[cfg(test)]
mod tests {
    use drillsweep_table::Column;

    use super::*;

    fn column(values: &[f64]) -> Column {
        Column::Number(values.to_vec())
    }

    #[test]
    fn columns_of_one_picture_have_one_unit_and_exist() {
        let table = Table::default()
            .with("measured_depth_top", column(&[0.0, 10.0]))
            .with("measured_depth_bottom", column(&[10.0, 20.0]))
            .with("friction_coefficient", column(&[0.01, 0.02]))
            .with("torque", column(&[9940.0, 5219.0]))
            .with("regime", Column::Text(vec![None, None]));
        let svg = profile(&table, None, "C_f", &UnitChoice::default()).unwrap().svg();
        assert!(svg.contains("friction coefficient C_f") && svg.contains("measured depth [m]"));
        assert!(
            profile(&table, Some(&["torque".to_owned()]), "", &UnitChoice::default())
                .unwrap()
                .svg()
                .contains("torque [kN m]")
        );
        let refused = |fields: &[&str]| {
            let fields: Vec<String> = fields.iter().map(|field| (*field).to_owned()).collect();
            profile(&table, Some(&fields), "", &UnitChoice::default()).unwrap_err()
        };
        let name = "friction_coefficient".to_owned();
        assert_eq!(refused(&["torque", "friction_coefficient"]), ChartError::OtherUnit { name });
        assert_eq!(refused(&["regime"]), ChartError::Texts { name: "regime".to_owned() });
        let columns = table.columns.keys().cloned().collect();
        assert_eq!(refused(&["nothing"]), ChartError::NoSuchColumn { name: "nothing".to_owned(), columns });
    }
}
