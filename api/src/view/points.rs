//! The table of a sweep: one row a point, with its parameters and its summary.

use std::borrow::Cow;
use std::collections::HashSet;

use drillsweep_quantity::{Variant, columns};
use drillsweep_scenario::PointError;
use drillsweep_table::{Column, Table};
use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use crate::judgement::{Judgement, MotionClass, OperatingLimits};
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
/// One row a point: `ordinal`, `state`, its `class` if it is [judged](PointsTable::judged), its parameters, the fields of its summary, of points that are verified the bias of each
/// statistic NAME against the reference as `bias_NAME`, and the `error` with its `error_time` \[s\] and `error_node`.
///
/// Columns are the union over all points, in the order in which they are first met; a point that has no
/// value has `null` there. Fields of the summary that are objects become columns named
/// `outer.inner`; lists become JSON text.
#[derive(Debug, Default)]
pub struct PointsTable {
    ordinals: Vec<Option<i64>>,
    states: Vec<Option<String>>,
    parameters: IndexMap<String, Vec<f64>>,
    /// Columns of the summaries' fields, as far as these have a value; none if no point has one yet.
    fields: IndexMap<String, Option<Column>>,
    /// The fields whose values are kept; none if all are.
    kept: Option<HashSet<String>>,
    /// Limits that classes are judged by; absent if they are not judged.
    limits: Option<OperatingLimits>,
    classes: Vec<Option<String>>,
    biases: IndexMap<String, Vec<f64>>,
    errors: Vec<Option<String>>,
    error_times: Vec<f64>,
    error_nodes: Vec<Option<i64>>,
}

impl PointsTable {
    /// A table that keeps, of the fields of summaries, the values of these alone; the columns of the others stay empty, of the kind that
    /// holds their values.
    pub fn keeping<'a>(fields: impl IntoIterator<Item = &'a str>) -> Self {
        let kept = fields.into_iter().map(str::to_owned).collect();
        PointsTable { kept: Some(kept), ..PointsTable::default() }
    }

    /// The same with the class of each point by limits.
    #[must_use]
    pub fn judged(mut self, limits: OperatingLimits) -> Self {
        self.limits = Some(limits);
        self
    }

    /// Limits by which classes are judged; absent unless the column is kept.
    fn judging(&self) -> Option<&OperatingLimits> {
        let is_kept = self.kept.as_ref().is_none_or(|kept| kept.contains(columns::CLASS.name));
        self.limits.as_ref().filter(|_| is_kept)
    }

    /// Adds the row of a point.
    ///
    /// # Errors
    /// Its summary is no JSON object.
    pub fn push(&mut self, point: PointSummary) -> serde_json::Result<()> {
        let row = self.ordinals.len();
        // A class follows from the whole summary, which is parsed once: its columns are then taken from the parsed object.
        let summary = point.summary.as_deref().filter(|_| self.judging().is_some());
        let parsed: Option<Map<String, Value>> = summary.map(serde_json::from_str).transpose()?;
        let class = self.judging().and_then(|limits| class(&point, parsed.as_ref(), limits));
        self.classes.push(class.map(|class| class.name().to_owned()));
        self.ordinals.push(Some(point.ordinal.into()));
        self.states.push(Some(point.state.to_string()));
        for (name, value) in point.parameters {
            put(&mut self.parameters, name, row, value);
        }
        let mut fields = Fields { columns: &mut self.fields, kept: self.kept.as_ref(), row };
        let object = Object { fields: &mut fields, path: "" };
        match (&parsed, &point.summary) {
            (Some(parsed), _) => object.deserialize(parsed)?,
            (None, Some(summary)) => object.deserialize(&mut serde_json::Deserializer::from_str(summary))?,
            (None, None) => {}
        }
        for (name, value) in point.biases {
            put(&mut self.biases, name, row, value);
        }
        self.error_times.push(point.error.as_ref().and_then(|error| error.time).unwrap_or(f64::NAN));
        self.error_nodes.push(point.error.as_ref().and_then(|error| error.node).map(i64::from));
        self.errors.push(point.error.map(|error| error.reason));
        Ok(())
    }

    /// The names of the parameters so far.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.parameters.keys().map(String::as_str)
    }

    /// The table of all rows.
    pub fn finish(self) -> Table {
        let rows = self.ordinals.len();
        let mut table = Table::default()
            .with(&columns::ORDINAL, Column::Integer(self.ordinals))
            .with(&columns::STATE, Column::Text(self.states));
        if self.limits.is_some() {
            table.push(&columns::CLASS, Column::Text(self.classes));
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

/// Class of a point with this summary by the limits; absent without a result.
fn class(
    point: &PointSummary,
    summary: Option<&Map<String, Value>>,
    limits: &OperatingLimits,
) -> Option<MotionClass> {
    let judgement = match &point.error {
        Some(error) => Judgement::of_failure(&error.reason, limits),
        None => Judgement::of_row(summary?, limits),
    };
    Some(judgement.class)
}

fn put(columns: &mut IndexMap<String, Vec<f64>>, name: String, row: usize, value: f64) {
    let values = columns.entry(name).or_default();
    values.resize(row, f64::NAN);
    values.push(value);
}

/// Puts a value into its row of a column, which becomes the narrowest kind that holds all: whole numbers, numbers, texts.
fn put_field(field: &mut Option<Column>, row: usize, value: Value) {
    let Some(column) = widened(field, &value) else { return };
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
fn widened<'c>(field: &'c mut Option<Column>, value: &Value) -> Option<&'c mut Column> {
    let wider = match (field.as_mut(), value) {
        (_, Value::Null) => return None,
        (None, Value::Number(number)) if number.is_i64() => Some(Column::Integer(Vec::new())),
        (None, Value::Number(_)) => Some(Column::Number(Vec::new())),
        (None, _) => Some(Column::Text(Vec::new())),
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
    kept: Option<&'t HashSet<String>>,
    row: usize,
}

impl Fields<'_> {
    fn put(&mut self, name: &str, value: Value) {
        if !self.columns.contains_key(name) {
            self.columns.insert(name.to_owned(), None);
        }
        let Some(field) = self.columns.get_mut(name) else { return };
        if self.kept.is_none_or(|kept| kept.contains(name)) {
            put_field(field, self.row, value);
        } else {
            widened(field, &value);
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
    use serde_json::json;

    fn table(points: impl IntoIterator<Item = PointSummary>) -> Table {
        let mut table = PointsTable::default();
        points.into_iter().for_each(|point| table.push(point).unwrap());
        table.finish()
    }

    #[test]
    fn a_column_is_the_narrowest_kind_that_holds_all_its_values() {
        let fields = [
            json!({"whole": 1, "number": 1, "words": 2, "late": null, "text": true}),
            json!({"whole": null, "number": 0.5, "words": "b", "text": [0.5]}),
            json!({"number": 2, "words": 3, "late": 7, "nothing": null}),
        ];
        let points = fields.into_iter().zip(1..).map(|(summary, ordinal)| PointSummary {
            ordinal,
            state: PointState::Succeeded,
            parameters: IndexMap::new(),
            summary: Some(summary.to_string()),
            biases: IndexMap::new(),
            error: None,
        });
        let points: Vec<PointSummary> = points.collect();
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
        let mut part = PointsTable::keeping(["words", "none"]);
        points.into_iter().for_each(|point| part.push(point).unwrap());
        let part = part.finish();
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
