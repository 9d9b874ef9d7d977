//! Signs of forces at the bit: those of the model, or those in which drillers speak.

use drillsweep_quantity::{Name, Variant, entry, of};
use drillsweep_scenario::Scenario;
use drillsweep_table::{Column, Table};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::axis::{Axis, AxisName};
use crate::listed::ListedPoints;

/// Signs of weight on bit and torque on bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Signs {
    /// Compression is negative, and so is a torque on bit that opposes clockwise rotation.
    #[default]
    Model,
    /// Both are positive: `operation.weight_on_bit` is compression, `operation.torque_on_bit` opposes clockwise rotation.
    Driller,
}

/// The section and its fields whose signs differ.
const SECTION: &str = "operation";
const FIELDS: [&str; 2] = ["weight_on_bit", "torque_on_bit"];

/// True for the path of a field whose signs differ.
fn differs(path: &str) -> bool {
    path.strip_prefix(SECTION)
        .and_then(|rest| rest.strip_prefix('.'))
        .is_some_and(|field| FIELDS.contains(&field))
}

/// A number of the other sign; zero has none, so that equal points have equal keys.
fn turned(number: f64) -> f64 {
    0.0 - number
}

impl Signs {
    /// True for the signs of the model, in which results are kept.
    pub fn is_model(&self) -> bool {
        *self == Signs::Model
    }

    /// A table with its weights and torques on bit in these signs, from those of the model.
    #[must_use]
    pub fn of_table(self, mut table: Table) -> Table {
        if self.is_model() {
            return table;
        }
        for (name, column) in &mut table.columns {
            let is_value = |name: &Name<'_>| name.variant == Variant::Value;
            if !differs(name) || !Name::parse(name).as_ref().is_some_and(is_value) {
                continue;
            }
            match column {
                Column::Number(values) => values.iter_mut().for_each(|value| *value = turned(*value)),
                Column::Single(values) => values.iter_mut().for_each(|value| *value = 0.0 - *value),
                Column::Integer(values) => values.iter_mut().flatten().for_each(|value| *value = -*value),
                Column::Text(_) => {}
            }
        }
        table
    }
}

/// Turns the forces at the bit of a scenario, given in full.
pub(crate) fn turn_scenario(scenario: &mut Scenario) {
    let operation = &mut scenario.operation;
    operation.weight_on_bit = turned(operation.weight_on_bit);
    operation.torque_on_bit = turned(operation.torque_on_bit);
}

/// Turns those of a change by its path: the fields, or the section that holds them.
pub(crate) fn turn_change(path: &str, value: &mut Value) {
    match value {
        Value::Object(fields) if path == SECTION => {
            for name in FIELDS {
                if let Some(value) = fields.get_mut(name) {
                    turn_value(&format!("{SECTION}.{name}"), value);
                }
            }
        }
        value if differs(path) => turn_value(path, value),
        _ => {}
    }
}

/// Turns a number, or a text of a number with its unit; what is neither is refused later.
fn turn_value(path: &str, value: &mut Value) {
    let number = match value {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => {
            of(path).and_then(|quantity| quantity.units).and_then(|units| entry::read(text, units).ok())
        }
        _ => None,
    };
    if let Some(number) = number {
        *value = turned(number).into();
    }
}

/// Turns those of axes.
pub(crate) fn turn_axes(axes: &mut IndexMap<AxisName, Axis>) {
    for (_, axis) in axes.iter_mut().filter(|(name, _)| differs(name.scenario_path())) {
        match axis {
            Axis::Values { values } => values.iter_mut().for_each(|value| *value = turned(*value)),
            Axis::Range { from, to, .. } | Axis::Interval { from, to, .. } => {
                (*from, *to) = (turned(*from), turned(*to));
            }
        }
    }
}

/// Turns those of listed points.
pub(crate) fn turn_points(points: &mut ListedPoints) {
    points.change(|name, value| if differs(name.scenario_path()) { turned(value) } else { value });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_weight_and_torque_on_bit_in_the_requested_signs() {
        let table = Table::default()
            .with("operation.weight_on_bit", Column::Number(vec![-5e4, 0.0, f64::NAN]))
            .with("operation.rotation_speed_rpm", Column::Number(vec![60.0, 90.0, -60.0]))
            .with("torque", Column::Number(vec![-1.0, 2.0, 3.0]));
        let turned = Signs::Driller.of_table(table.clone());
        let text = serde_json::to_string(&turned.columns).unwrap();
        assert_eq!(
            text,
            r#"{"operation.weight_on_bit":[50000.0,0.0,null],"operation.rotation_speed_rpm":[60.0,90.0,-60.0],"torque":[-1.0,2.0,3.0]}"#
        );
        let text = serde_json::to_string(&table.columns).unwrap();
        assert_eq!(serde_json::to_string(&Signs::Model.of_table(table).columns).unwrap(), text);
    }
}
