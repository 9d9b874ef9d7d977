//! The table of a sweep: one row a point, with its parameters and its summary.

use indexmap::{IndexMap, IndexSet};
use serde_json::{Map, Value};

use crate::point::PointRow;
use crate::table::{Column, Table};

/// One row a point: `ordinal`, `state`, its parameters, the fields of its summary, and `error`.
///
/// Columns are the union over all points, in the order in which they are first met; a point that has no
/// value has `null` there. Fields of the summary that are objects become columns named
/// `outer.inner`; lists become JSON text.
pub fn points<'a>(rows: impl IntoIterator<Item = (&'a PointRow, Option<&'a Map<String, Value>>)>) -> Table {
    let rows: Vec<_> = rows.into_iter().collect();
    let mut table = Table::default()
        .with("ordinal", Column::Integer(rows.iter().map(|(row, _)| Some(row.ordinal.into())).collect()))
        .with("state", Column::Text(rows.iter().map(|(row, _)| Some(row.state.to_string())).collect()));

    let parameters: IndexSet<&str> =
        rows.iter().flat_map(|(row, _)| row.parameters.keys().map(String::as_str)).collect();
    for name in &parameters {
        let values = rows.iter().map(|(row, _)| row.parameters.get(*name).copied().unwrap_or(f64::NAN));
        table.push(*name, Column::Number(values.collect()));
    }

    let summaries: Vec<IndexMap<String, Value>> =
        rows.iter().map(|(_, summary)| summary.map_or_else(IndexMap::new, flatten)).collect();
    let fields: IndexSet<&str> =
        summaries.iter().flat_map(|summary| summary.keys().map(String::as_str)).collect();
    for name in &fields {
        // A summary's own flow rate would only repeat the parameter of that name.
        if !table.columns.contains_key(*name) {
            table.push(*name, column(summaries.iter().map(|summary| summary.get(*name)).collect()));
        }
    }

    let errors = rows.iter().map(|(row, _)| row.error.as_ref().map(|error| error.reason.clone()));
    table.with("error", Column::Text(errors.collect()))
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
fn column(values: Vec<Option<&Value>>) -> Column {
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
    use crate::point::{FailureClass, PointError, PointLinks, PointState};
    use serde_json::json;

    fn row(ordinal: u32, state: PointState, density: f64, error: Option<&str>) -> PointRow {
        PointRow {
            ordinal,
            state,
            parameters: [("mud_density".to_owned(), density)].into(),
            progress: 1.0,
            attempts: 1,
            error: error.map(|reason| PointError {
                class: FailureClass::Physical,
                reason: reason.to_owned(),
                time: Some(1.5),
                node: Some(49),
                details: Map::new(),
            }),
            links: PointLinks { this: String::new(), sweep: String::new() },
        }
    }

    #[test]
    fn points_without_a_result_have_null_where_others_have_a_value() {
        let rows = [
            row(1, PointState::Succeeded, 1200.0, None),
            row(2, PointState::Failed, 1500.0, Some("diverged")),
        ];
        let summary =
            json!({"steps": 60000, "residual": 0.5, "orbit": {"radius": 0.037}, "regimes": ["laminar"]});
        let table = points([(&rows[0], summary.as_object()), (&rows[1], None)]);
        let json = serde_json::to_value(&table).unwrap();
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
                "error": [null, "diverged"],
            })
        );
        assert_eq!(json["units"]["mud_density"], "kg/m3");
    }
}
