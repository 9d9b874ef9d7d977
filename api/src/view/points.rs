//! The table of a sweep: one row a point, with its parameters and its summary.

use drillsweep_table::quantity::{Variant, columns};
use drillsweep_table::{Column, Table};
use indexmap::{IndexMap, IndexSet};
use serde_json::{Map, Value};

use crate::point::{PointError, PointState};

/// What the table needs to know of a point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSummary {
    /// Number of the point in its sweep, from 1.
    pub ordinal: u32,
    /// Where the point stands.
    pub state: PointState,
    /// Its parameters, by axis name.
    pub parameters: IndexMap<String, f64>,
    /// The scalar results, if there are any.
    pub summary: Option<Map<String, Value>>,
    /// The bias of its statistics, by their names, where it is verified.
    pub biases: IndexMap<String, f64>,
    /// Why it failed, if it did.
    pub error: Option<PointError>,
}

/// One row a point: `ordinal`, `state`, its parameters, the fields of its summary, of points that are verified the bias of each
/// statistic NAME against the reference as `bias_NAME`, and the `error` with its `error_time` \[s\] and `error_node`.
///
/// Columns are the union over all points, in the order in which they are first met; a point that has no
/// value has `null` there. Fields of the summary that are objects become columns named
/// `outer.inner`; lists become JSON text.
pub fn points(rows: &[PointSummary]) -> Table {
    let mut table = Table::default()
        .with(&columns::ORDINAL, Column::Integer(rows.iter().map(|row| Some(row.ordinal.into())).collect()))
        .with(&columns::STATE, Column::Text(rows.iter().map(|row| Some(row.state.to_string())).collect()));

    let parameters: IndexSet<&str> =
        rows.iter().flat_map(|row| row.parameters.keys().map(String::as_str)).collect();
    for name in &parameters {
        let values = rows.iter().map(|row| row.parameters.get(*name).copied().unwrap_or(f64::NAN));
        table.push(*name, Column::Number(values.collect()));
    }

    let summaries: Vec<IndexMap<String, Value>> =
        rows.iter().map(|row| row.summary.as_ref().map_or_else(IndexMap::new, flatten)).collect();
    let fields: IndexSet<&str> =
        summaries.iter().flat_map(|summary| summary.keys().map(String::as_str)).collect();
    for name in &fields {
        // A summary's own flow rate would only repeat the parameter of that name.
        if !table.columns.contains_key(*name) {
            table
                .push(*name, column(&summaries.iter().map(|summary| summary.get(*name)).collect::<Vec<_>>()));
        }
    }

    let statistics: IndexSet<&str> =
        rows.iter().flat_map(|row| row.biases.keys().map(String::as_str)).collect();
    for name in statistics {
        let values = rows.iter().map(|row| row.biases.get(name).copied().unwrap_or(f64::NAN));
        table.push(Variant::Bias.of(name), Column::Number(values.collect()));
    }

    let errors = || rows.iter().map(|row| row.error.as_ref());
    table
        .with(
            &columns::ERROR,
            Column::Text(errors().map(|error| error.map(|error| error.reason.clone())).collect()),
        )
        .with(
            &columns::ERROR_TIME,
            Column::Number(errors().map(|error| error.and_then(|e| e.time).unwrap_or(f64::NAN)).collect()),
        )
        .with(
            &columns::ERROR_NODE,
            Column::Integer(errors().map(|error| error.and_then(|e| e.node).map(i64::from)).collect()),
        )
}

fn flatten(summary: &Map<String, Value>) -> IndexMap<String, Value> {
    let mut fields = IndexMap::new();
    for (name, value) in summary {
        match value {
            Value::Object(inner) => {
                fields.extend(
                    flatten(inner).into_iter().map(|(inner, value)| (format!("{name}.{inner}"), value)),
                );
            }
            value => {
                fields.insert(name.clone(), value.clone());
            }
        }
    }
    fields
}

/// The narrowest kind of column that holds all values.
fn column(values: &[Option<&Value>]) -> Column {
    let given = || values.iter().flatten().filter(|value| !value.is_null());
    if given().all(|value| value.is_i64()) && given().next().is_some() {
        return Column::Integer(values.iter().map(|value| value.and_then(Value::as_i64)).collect());
    }
    if given().all(|value| value.is_number()) {
        let number = |value: &Option<&Value>| value.and_then(Value::as_f64).unwrap_or(f64::NAN);
        return Column::Number(values.iter().map(number).collect());
    }
    let text = |value: &Option<&Value>| match value {
        None | Some(Value::Null) => None,
        Some(Value::String(text)) => Some(text.clone()),
        Some(other) => Some(other.to_string()),
    };
    Column::Text(values.iter().map(text).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::point::FailureClass;
    use serde_json::json;

    #[test]
    fn points_without_a_result_have_null_where_others_have_a_value() {
        let parameters = |density| [("mud_density".to_owned(), density)].into();
        let summary =
            json!({"steps": 60000, "residual": 0.5, "orbit": {"radius": 0.037}, "regimes": ["laminar"]});
        let done = PointSummary {
            ordinal: 1,
            state: PointState::Succeeded,
            parameters: parameters(1200.0),
            summary: summary.as_object().cloned(),
            biases: [("orbit_radius_rms_49".to_owned(), -0.25)].into(),
            error: None,
        };
        let failed = PointSummary {
            ordinal: 2,
            state: PointState::Failed,
            parameters: parameters(1500.0),
            summary: None,
            biases: IndexMap::new(),
            error: Some(PointError {
                class: FailureClass::Physical,
                reason: "diverged".to_owned(),
                time: Some(1.5),
                node: Some(49),
                details: Map::new(),
            }),
        };
        let json = serde_json::to_value(points(&[done, failed])).unwrap();
        assert_eq!(
            json["columns"],
            json!({
                "ordinal": [1, 2],
                "state": ["succeeded", "failed"],
                "mud_density": [1200.0, 1500.0],
                "steps": [60000, null],
                "residual": [0.5, null],
                "orbit.radius": [0.037, null],
                "regimes": ["[\"laminar\"]", null],
                "bias_orbit_radius_rms_49": [-0.25, null],
                "error": [null, "diverged"],
                "error_time": [null, 1.5],
                "error_node": [null, 49],
            })
        );
        assert_eq!(
            json["units"],
            json!({
                "mud_density": "kg/m3", "error_time": "s", "residual": "J", "bias_orbit_radius_rms_49": "1",
            })
        );
    }
}
