//! The picture of a node's path across its hole.

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{UnitChoice, units};
use drillsweep_table::Table;

use crate::error::ChartError;
use crate::picture::{Drawing, OrbitPlot};
use crate::shown::{node_of, numbers};

/// Position and direction of the hole at a node, for the picture of its orbit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hole {
    /// The radius at which the string touches the wall \[m\].
    pub clearance: Option<f64>,
    /// Angle of the low side, from u towards v \[rad\]; none if the hole is vertical.
    pub low_side: Option<f64>,
}

/// The path of a node across its hole: the whole hole, or with `zoom` the motion alone with the hole as an inset; unless that is said,
/// the motion alone if it is below a tenth of the hole.
///
/// # Errors
/// The table is not an orbit.
pub fn orbit(
    table: &Table,
    hole: &Hole,
    title: &str,
    zoom: Option<bool>,
    choice: &UnitChoice,
) -> Result<Drawing, ChartError> {
    let unit = choice.shown(U.name).unwrap_or(units::WIDTH.shown);
    let (time, u, v) = (numbers(table, TIME.name)?, numbers(table, U.name)?, numbers(table, V.name)?);
    let window = match (time.first(), time.last()) {
        (Some(first), Some(last)) => format!(", {first:.2} to {last:.2} s"),
        _ => String::new(),
    };
    let plot = OrbitPlot {
        title: title.to_owned(),
        subtitle: format!("{}{window}; the mark is the end", node_of(table, choice)),
        path: u.iter().zip(v).map(|(u, v)| [unit.of(*u), unit.of(v)]).collect(),
        wall: hole.clearance.map(|clearance| unit.of(clearance)),
        low_side: hole.low_side,
        unit: unit.symbol.to_owned(),
        zoom,
    };
    Ok(plot.drawing())
}
