//! The table of a sweep: one row a point, with its parameters and its summary.

use std::borrow::Cow;
use std::collections::HashSet;

use drillsweep_quantity::{Variant, columns};
use drillsweep_scenario::PointError;
use drillsweep_table::{Column, Table};
use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use crate::judgement::{Judgement, OperatingLimits, Scalars};
use crate::point::PointState;

/// Data of a point that the table needs.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSummary {
    /// Number of the point in its sweep, from 1.
    pub ordinal: u32,
    /// State of the point.
    pub state: PointState,
    /// Its parameters, by axis name.
    pub parameters: IndexMap<String, f64>,
    /// The scalar results, if there are any: a JSON object.
    pub summary: Option<String>,
    /// The bias of its statistics, by their names, if it is verified.
    pub biases: IndexMap<String, f64>,
    /// Reason of its failure, if it failed.
    pub error: Option<PointError>,
}

/// The table of a sweep as it is put together point by point, so that in addition only the current point is in memory. Summaries go into
/// their columns as they are parsed: of a hundred thousand points they are hundreds of megabytes.
///
/// One row a point: `ordinal`, `state`, its [class](PointsTable::classes) if the table is finished with it, its parameters, the fields of its summary, of points that are verified the bias of each
/// statistic NAME against the reference as `bias_NAME`, and the `error` with its `error_time` \[s\] and `error_node`.
///
/// Columns are the union over all points, in the order in which they are first met; a point that has no
/// value has `null` there. Fields of the summary that are objects become columns named
/// `outer.inner`; lists become JSON text.
#[derive(Debug, Clone, Default)]
pub struct PointsTable {
    ordinals: Vec<Option<i64>>,
    states: Vec<Option<String>>,
    parameters: IndexMap<String, Vec<f64>>,
    /// Columns of the summaries' fields, as far as these have a value; none if no point has one yet.
    fields: IndexMap<String, Option<Column>>,
    /// Fields whose values are kept; none if all are.
    kept: Option<HashSet<String>>,
    has_summary: Vec<bool>,
    biases: IndexMap<String, Vec<f64>>,
    errors: Vec<Option<String>>,
    error_times: Vec<f64>,
    error_nodes: Vec<Option<i64>>,
    /// Number of rows that the columns take without growing.
    expected: usize,
}

impl PointsTable {
    /// Table without a row, whose columns take as many rows without growing.
    pub fn for_rows(rows: usize) -> Self {
        Self { expected: rows, ..Self::default() }
    }

    /// The same for the values of these fields of summaries alone, to which rows are [appended](PointsTable::append).
    pub fn of_fields(names: &[String], rows: usize) -> Self {
        Self { kept: Some(names.iter().cloned().collect()), ..Self::for_rows(rows) }
    }

    /// Adds the row of a point.
    ///
    /// # Errors
    /// Its summary is no JSON object.
    pub fn push(&mut self, point: PointSummary) -> serde_json::Result<()> {
        let row = self.ordinals.len();
        self.ordinals.push(Some(point.ordinal.into()));
        self.states.push(Some(point.state.to_string()));
        for (name, value) in point.parameters {
            put(&mut self.parameters, name, row, value);
        }
        if let Some(summary) = &point.summary {
            let mut fields = Fields { columns: &mut self.fields, next: 0, row, expected: self.expected };
            Object { fields: &mut fields, path: "" }
                .deserialize(&mut serde_json::Deserializer::from_str(summary))?;
        }
        for (name, value) in point.biases {
            put(&mut self.biases, name, row, value);
        }
        self.has_summary.push(point.summary.is_some());
        self.error_times.push(point.error.as_ref().and_then(|error| error.time).unwrap_or(f64::NAN));
        self.error_nodes.push(point.error.as_ref().and_then(|error| error.node).map(i64::from));
        self.errors.push(point.error.map(|error| error.reason));
        Ok(())
    }

    /// Adds the rows of another table, with the values of the fields that this table keeps.
    pub fn append(&mut self, other: PointsTable) {
        let row = self.ordinals.len();
        self.ordinals.extend(other.ordinals);
        self.states.extend(other.states);
        self.has_summary.extend(other.has_summary);
        self.errors.extend(other.errors);
        self.error_times.extend(other.error_times);
        self.error_nodes.extend(other.error_nodes);
        for (own, others) in [(&mut self.parameters, other.parameters), (&mut self.biases, other.biases)] {
            for (name, values) in others {
                let column = own.entry(name).or_default();
                column.resize(row, f64::NAN);
                column.extend(values);
            }
        }
        for (name, column) in other.fields {
            let is_kept = self.kept.as_ref().is_none_or(|kept| kept.contains(&name));
            let field = self.fields.entry(name).or_default();
            let Some(column) = column else { continue };
            if is_kept {
                for (value, row) in values(column).zip(row..) {
                    put_field(field, row, self.expected, value);
                }
            } else if let Some(value) = values(column).find(|value| !value.is_null()) {
                widened(field, &value, 0);
            }
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.ordinals.len()
    }

    /// True without a row.
    pub fn is_empty(&self) -> bool {
        self.ordinals.is_empty()
    }

    /// The table with the values of these fields of summaries alone; columns of the others stay empty, of the same kind.
    #[must_use]
    pub fn keeping(&self, names: &[String]) -> Self {
        let kept: HashSet<String> = names.iter().cloned().collect();
        let field = |(name, column): (&String, &Option<Column>)| {
            let column = column.as_ref().map(|column| match kept.contains(name) {
                true => column.clone(),
                false => column.rows(0..0),
            });
            (name.clone(), column)
        };
        Self {
            ordinals: self.ordinals.clone(),
            states: self.states.clone(),
            parameters: self.parameters.clone(),
            fields: self.fields.iter().map(field).collect(),
            has_summary: self.has_summary.clone(),
            biases: self.biases.clone(),
            errors: self.errors.clone(),
            error_times: self.error_times.clone(),
            error_nodes: self.error_nodes.clone(),
            kept: Some(kept),
            expected: self.expected,
        }
    }

    /// Class of each point by limits; absent without a result.
    pub fn classes(&self, limits: &OperatingLimits) -> Vec<Option<String>> {
        let class = |row: PointRow<'_>| {
            let judgement = match row.error() {
                Some(reason) => Judgement::of_failure(reason, limits),
                None => Judgement::of_row(row.scalars()?, limits),
            };
            Some(judgement.class.name().to_owned())
        };
        self.rows().map(class).collect()
    }

    /// Rows in order.
    pub fn rows(&self) -> impl Iterator<Item = PointRow<'_>> {
        (0..self.ordinals.len()).map(|row| PointRow { table: self, row })
    }

    /// Memory of the values \[bytes\].
    pub fn memory(&self) -> usize {
        let texts = |values: &[Option<String>]| {
            size_of_val(values)
                + values.iter().flatten().map(|text| text.len() + MEMORY_OF_ALLOCATION).sum::<usize>()
        };
        let field = |column: &Column| match column {
            Column::Integer(values) => size_of_val(values.as_slice()),
            Column::Number(values) => size_of_val(values.as_slice()),
            Column::Single(values) => size_of_val(values.as_slice()),
            Column::Text(values) => texts(values),
        };
        let numbers = self.parameters.values().chain(self.biases.values());
        numbers.map(|values| size_of_val(values.as_slice())).sum::<usize>()
            + self.fields.values().flatten().map(field).sum::<usize>()
            + texts(&self.states)
            + texts(&self.errors)
            + self.ordinals.len() * (2 * size_of::<Option<i64>>() + size_of::<f64>())
    }

    /// The names of the parameters so far.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.parameters.keys().map(String::as_str)
    }

    /// The table of all rows, with the class of each point if there are classes.
    pub fn finish(self, classes: Option<Vec<Option<String>>>) -> Table {
        let rows = self.ordinals.len();
        let mut table = Table::default()
            .with(&columns::ORDINAL, Column::Integer(self.ordinals))
            .with(&columns::STATE, Column::Text(self.states));
        if let Some(classes) = classes {
            table.push(&columns::CLASS, Column::Text(classes));
        }
        for (name, mut values) in self.parameters {
            values.resize(rows, f64::NAN);
            table.push(name, Column::Number(values));
        }
        for (name, column) in self.fields {
            // A summary's own flow rate would only repeat the parameter of that name.
            if !table.columns.contains_key(&name) {
                let mut column = column.unwrap_or(Column::Number(Vec::new()));
                if self.kept.as_ref().is_none_or(|kept| kept.contains(&name)) {
                    fill(&mut column, rows);
                }
                table.push(name, column);
            }
        }
        for (name, mut values) in self.biases {
            values.resize(rows, f64::NAN);
            table.push(Variant::Bias.of(&name), Column::Number(values));
        }
        table
            .with(&columns::ERROR, Column::Text(self.errors))
            .with(&columns::ERROR_TIME, Column::Number(self.error_times))
            .with(&columns::ERROR_NODE, Column::Integer(self.error_nodes))
    }
}

/// Overhead of an allocation \[bytes\], of common allocators.
const MEMORY_OF_ALLOCATION: usize = 16;

/// Row of a point.
#[derive(Debug, Clone, Copy)]
pub struct PointRow<'t> {
    table: &'t PointsTable,
    row: usize,
}

impl<'t> PointRow<'t> {
    /// Number of the point in its sweep, from 1.
    pub fn ordinal(&self) -> u32 {
        self.table.ordinals[self.row].and_then(|ordinal| ordinal.try_into().ok()).unwrap_or_default()
    }

    /// Parameters of the point, by axis name.
    pub fn parameters(&self) -> impl Iterator<Item = (&'t str, f64)> {
        let row = self.row;
        let values =
            self.table.parameters.iter().filter_map(move |(name, values)| Some((name, *values.get(row)?)));
        values.filter(|(_, value)| !value.is_nan()).map(|(name, value)| (name.as_str(), value))
    }

    /// Reason of its failure, if it failed.
    pub fn error(&self) -> Option<&'t str> {
        self.table.errors[self.row].as_deref()
    }

    /// Its scalar results, if there are any.
    pub fn scalars(&self) -> Option<&impl Scalars> {
        self.table.has_summary[self.row].then_some(self)
    }
}

impl Scalars for PointRow<'_> {
    fn number(&self, column: &str) -> Option<f64> {
        match self.table.fields.get(column)?.as_ref()? {
            Column::Integer(values) => values.get(self.row).copied().flatten().map(|value| value as f64),
            Column::Number(values) => values.get(self.row).copied().filter(|value| value.is_finite()),
            Column::Single(values) => {
                values.get(self.row).map(|value| f64::from(*value)).filter(|value| value.is_finite())
            }
            Column::Text(_) => None,
        }
    }

    fn text(&self, column: &str) -> Option<&str> {
        match self.table.fields.get(column)?.as_ref()? {
            Column::Text(values) => values.get(self.row)?.as_deref(),
            _ => None,
        }
    }

    fn value(&self, column: &str) -> Option<Value> {
        self.text(column).map(Value::from).or_else(|| self.number(column).map(Value::from))
    }
}

fn put(columns: &mut IndexMap<String, Vec<f64>>, name: String, row: usize, value: f64) {
    let values = columns.entry(name).or_default();
    values.resize(row, f64::NAN);
    values.push(value);
}

/// Puts a value into its row of a column, which becomes the narrowest kind that holds all: whole numbers, numbers, texts.
fn put_field(field: &mut Option<Column>, row: usize, expected: usize, value: Value) {
    let Some(column) = widened(field, &value, expected) else { return };
    fill(column, row);
    match column {
        Column::Integer(values) => values.push(value.as_i64()),
        Column::Number(values) => values.push(value.as_f64().unwrap_or(f64::NAN)),
        Column::Single(values) => values.push(value.as_f64().unwrap_or(f64::NAN) as f32),
        Column::Text(values) => values.push(Some(match value {
            Value::String(text) => text,
            other => other.to_string(),
        })),
    }
}

/// The column as one that can hold a value; none of no value.
fn widened<'c>(field: &'c mut Option<Column>, value: &Value, expected: usize) -> Option<&'c mut Column> {
    let wider = match (field.as_mut(), value) {
        (_, Value::Null) => return None,
        (None, Value::Number(number)) if number.is_i64() => {
            Some(Column::Integer(Vec::with_capacity(expected)))
        }
        (None, Value::Number(_)) => Some(Column::Number(Vec::with_capacity(expected))),
        (None, _) => Some(Column::Text(Vec::with_capacity(expected))),
        (Some(column), Value::Number(number)) if matches!(column, Column::Integer(_)) && !number.is_i64() => {
            Some(Column::Number(column.numbers().unwrap_or_default()))
        }
        (Some(Column::Text(_)), _) | (Some(_), Value::Number(_)) => None,
        (Some(column), _) => Some(Column::Text(texts(column))),
    };
    if let Some(wider) = wider {
        *field = Some(wider);
    }
    field.as_mut()
}

/// Values of a column in order; null for missing ones.
fn values(column: Column) -> Box<dyn Iterator<Item = Value>> {
    match column {
        Column::Integer(values) => Box::new(values.into_iter().map(Value::from)),
        Column::Number(values) => Box::new(values.into_iter().map(Value::from)),
        Column::Single(values) => Box::new(values.into_iter().map(Value::from)),
        Column::Text(values) => Box::new(values.into_iter().map(Value::from)),
    }
}

/// Missing values up to this many rows.
fn fill(column: &mut Column, rows: usize) {
    match column {
        Column::Integer(values) => values.resize(rows, None),
        Column::Number(values) => values.resize(rows, f64::NAN),
        Column::Single(values) => values.resize(rows, f32::NAN),
        Column::Text(values) => values.resize(rows, None),
    }
}

/// The values as texts, numbers as JSON has them.
fn texts(column: &mut Column) -> Vec<Option<String>> {
    let number = |value: f64| value.is_finite().then(|| Value::from(value).to_string());
    match column {
        Column::Text(values) => std::mem::take(values),
        Column::Integer(values) => values.iter().map(|value| value.map(|value| value.to_string())).collect(),
        Column::Number(values) => values.iter().copied().map(number).collect(),
        Column::Single(values) => values.iter().map(|value| number((*value).into())).collect(),
    }
}

/// Columns of the fields of a point's summary.
struct Fields<'t> {
    columns: &'t mut IndexMap<String, Option<Column>>,
    /// Index of the column after the one that was put last: summaries of a sweep have the same fields in the same order.
    next: usize,
    row: usize,
    expected: usize,
}

impl Fields<'_> {
    fn put(&mut self, name: &str, value: Value) {
        let index = match self.columns.get_index(self.next) {
            Some((known, _)) if known == name => self.next,
            _ => match self.columns.get_index_of(name) {
                Some(index) => index,
                None => self.columns.insert_full(name.to_owned(), None).0,
            },
        };
        self.next = index + 1;
        if let Some((_, field)) = self.columns.get_index_mut(index) {
            put_field(field, self.row, self.expected, value);
        }
    }
}

/// A summary, or an object in one, whose fields have the path before their names.
struct Object<'f, 't> {
    fields: &'f mut Fields<'t>,
    path: &'f str,
}

/// The value of a field.
struct Field<'f, 't> {
    fields: &'f mut Fields<'t>,
    name: &'f str,
}

#[derive(Deserialize)]
struct Name<'a>(#[serde(borrow)] Cow<'a, str>);

impl<'de> DeserializeSeed<'de> for Object<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Object<'_, '_> {
    type Value = ();

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(Name(name)) = map.next_key()? {
            let name = match self.path {
                "" => name,
                path => format!("{path}.{name}").into(),
            };
            map.next_value_seed(Field { fields: self.fields, name: &name })?;
        }
        Ok(())
    }
}

impl<'de> DeserializeSeed<'de> for Field<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Field<'_, '_> {
    type Value = ();

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("a value")
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.fields.put(self.name, Value::Null);
        Ok(())
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        self.fields.put(self.name, value.into());
        Ok(())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<(), E> {
        self.fields.put(self.name, value.into());
        Ok(())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        self.fields.put(self.name, value.into());
        Ok(())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        self.fields.put(self.name, value.into());
        Ok(())
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<(), E> {
        self.fields.put(self.name, value.into());
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element::<Value>()? {
            values.push(value);
        }
        self.fields.put(self.name, Value::Array(values));
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<(), A::Error> {
        Object { fields: self.fields, path: self.name }.visit_map(map)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drillsweep_scenario::FailureClass;
    use serde_json::{Map, json};

    fn of_points(points: impl IntoIterator<Item = PointSummary>) -> PointsTable {
        let mut table = PointsTable::default();
        points.into_iter().for_each(|point| table.push(point).unwrap());
        table
    }

    fn succeeded(summaries: &[Value]) -> Vec<PointSummary> {
        let point = |(summary, ordinal): (&Value, u32)| PointSummary {
            ordinal,
            state: PointState::Succeeded,
            parameters: [("mud_density".to_owned(), f64::from(ordinal))].into(),
            summary: Some(summary.to_string()),
            biases: IndexMap::new(),
            error: None,
        };
        summaries.iter().zip(1..).map(point).collect()
    }

    fn table(points: impl IntoIterator<Item = PointSummary>) -> Table {
        of_points(points).finish(None)
    }

    #[test]
    fn classes_of_a_table_are_those_of_its_summaries() {
        let limits = OperatingLimits::default();
        let summaries = [
            json!({"motion_regime": "regular", "bit_stick_slip_severity": 1, "bit_speed_min": 0.0}),
            json!({"motion_regime": "not_settled", "bit_stick_slip_severity": null, "halves_differ": 0.2}),
            json!({"motion_regime": "regular", "instability": "buckling", "largest_lateral_acceleration_rms": 1.5}),
            json!({"largest_lateral_acceleration_rms": 0.1, "motion_regime": "regular"}),
            json!({}),
        ];
        let class = |summary: &Value| {
            Some(Judgement::of_row(summary.as_object().unwrap(), &limits).class.name().to_owned())
        };
        let expected: Vec<Option<String>> = summaries.iter().map(class).collect();
        assert_eq!(of_points(succeeded(&summaries)).classes(&limits), expected);
        assert_eq!(expected.iter().collect::<HashSet<_>>().len(), 5, "of five kinds: {expected:?}");
    }

    #[test]
    fn a_column_is_the_narrowest_kind_that_holds_all_its_values() {
        let fields = [
            json!({"whole": 1, "number": 1, "words": 2, "late": null, "text": true}),
            json!({"whole": null, "number": 0.5, "words": "b", "text": [0.5]}),
            json!({"number": 2, "words": 3, "late": 7, "nothing": null}),
        ];
        let points = succeeded(&fields);
        let table = table(points.clone());
        assert_eq!(table.columns["whole"], Column::Integer(vec![Some(1), None, None]));
        assert_eq!(table.columns["number"], Column::Number(vec![1.0, 0.5, 2.0]));
        let texts =
            |values: [Option<&str>; 3]| Column::Text(values.map(|text| text.map(str::to_owned)).into());
        assert_eq!(table.columns["words"], texts([Some("2"), Some("b"), Some("3")]));
        assert_eq!(table.columns["text"], texts([Some("true"), Some("[0.5]"), None]));
        assert_eq!(table.columns["late"], Column::Integer(vec![None, None, Some(7)]));
        assert!(
            matches!(&table.columns["nothing"], Column::Number(values) if values.iter().all(|v| v.is_nan()))
        );

        // A table that keeps some of them has the same columns, empty but for those.
        let kept = ["words".to_owned(), "none".to_owned()];
        let part = of_points(points.clone()).keeping(&kept).finish(None);

        // Tables of its rows one by one make up the same.
        let [mut appended, mut whole] = [PointsTable::of_fields(&kept, 3), PointsTable::for_rows(3)];
        for point in &points {
            appended.append(of_points([point.clone()]));
            whole.append(of_points([point.clone()]));
        }
        // As JSON, in which missing numbers are equal.
        let json = |table: &Table| serde_json::to_value(table).unwrap();
        assert_eq!(json(&appended.finish(None)), json(&part));
        assert_eq!(json(&whole.finish(None)), json(&table));
        assert_eq!(part.without_rows().columns, table.without_rows().columns);
        assert!(part.columns.keys().eq(table.columns.keys()), "in the same order");
        assert_eq!(part.columns["words"], table.columns["words"]);
        assert_eq!(part.columns["number"], Column::Number(Vec::new()));
    }

    #[test]
    fn points_without_a_result_have_null_values() {
        let parameters = |density| [("mud_density".to_owned(), density)].into();
        let summary =
            json!({"steps": 60000, "residual": 0.5, "orbit": {"radius": 0.037}, "regimes": ["laminar"]});
        let done = PointSummary {
            ordinal: 1,
            state: PointState::Succeeded,
            parameters: parameters(1200.0),
            summary: Some(summary.to_string()),
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
        let json = serde_json::to_value(table([done, failed])).unwrap();
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
