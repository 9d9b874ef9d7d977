//! Operating window of a sweep: the classes of its points over its parameters.

use drillsweep_quantity::columns::*;
use drillsweep_table::{Column, Table};
use indexmap::IndexMap;
use serde_json::{Map, Value};

use super::points::{PointSummary, PointsTable};
use super::worst::WorstValues;
use crate::judgement::{Judgement, MotionClass, OperatingLimits, Scalars};

/// Operating window as it is put together point by point: a row a point with its parameters, its class by limits, whether the class is uncertain, and
/// its finding in words. Points without a result have no class.
#[derive(Debug)]
pub struct OperatingWindow {
    limits: OperatingLimits,
    ordinals: Vec<Option<i64>>,
    parameters: IndexMap<String, Vec<f64>>,
    classes: Vec<Option<MotionClass>>,
    uncertain: Vec<Option<String>>,
    sentences: Vec<Option<String>>,
    worst: WorstValues,
}

impl OperatingWindow {
    /// Empty window by limits.
    pub fn new(limits: OperatingLimits) -> Self {
        Self {
            limits,
            ordinals: Vec::new(),
            parameters: IndexMap::new(),
            classes: Vec::new(),
            uncertain: Vec::new(),
            sentences: Vec::new(),
            worst: WorstValues::default(),
        }
    }

    /// Window of a table by limits.
    pub fn of_table(points: &PointsTable, limits: OperatingLimits) -> Self {
        let mut window = Self::new(limits);
        for point in points.rows() {
            window.add(point.ordinal(), point.parameters(), point.error(), point.scalars());
        }
        window
    }

    /// Adds a point.
    ///
    /// # Errors
    /// Its summary is no JSON object.
    pub fn push(&mut self, point: &PointSummary) -> serde_json::Result<()> {
        let summary: Option<Map<String, Value>> =
            point.summary.as_deref().map(serde_json::from_str).transpose()?;
        let error = point.error.as_ref().map(|error| error.reason.as_str());
        let parameters = point.parameters.iter().map(|(name, value)| (name.as_str(), *value));
        self.add(point.ordinal, parameters, error, summary.as_ref());
        Ok(())
    }

    fn add<'p>(
        &mut self,
        ordinal: u32,
        parameters: impl Iterator<Item = (&'p str, f64)>,
        error: Option<&str>,
        scalars: Option<&impl Scalars>,
    ) {
        let row = self.ordinals.len();
        self.ordinals.push(Some(ordinal.into()));
        for (name, value) in parameters {
            let values = match self.parameters.get_mut(name) {
                Some(values) => values,
                None => self.parameters.entry(name.to_owned()).or_default(),
            };
            values.resize(row, f64::NAN);
            values.push(value);
        }
        let (judgement, uncertain) = match (error, scalars) {
            (Some(reason), _) => (Some(Judgement::of_failure(reason, &self.limits)), None),
            (None, Some(scalars)) => {
                let judgement = Judgement::of_row(scalars, &self.limits);
                let uncertain = uncertainty(scalars, &judgement);
                self.worst.push(ordinal, scalars, judgement.class);
                (Some(judgement), uncertain)
            }
            (None, None) => (None, None),
        };
        self.classes.push(judgement.as_ref().map(|judgement| judgement.class));
        self.sentences.push(judgement.map(|judgement| judgement.sentence));
        self.uncertain.push(uncertain);
    }

    /// The names of the parameters so far.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.parameters.keys().map(String::as_str)
    }

    /// Largest values of the points so far.
    pub fn worst(&self) -> &WorstValues {
        &self.worst
    }

    /// Table of all rows, with the limits and the number of points of each class as attributes.
    pub fn finish(self) -> Table {
        let rows = self.ordinals.len();
        let count =
            |class: MotionClass| self.classes.iter().filter(|of_point| **of_point == Some(class)).count();
        let counts: Map<String, Value> = MotionClass::ALL
            .into_iter()
            .filter(|class| count(*class) > 0)
            .map(|class| (class.name().to_owned(), count(class).into()))
            .collect();
        let mut table = Table::default()
            .attribute("limits", serde_json::json!(self.limits))
            .attribute("points_by_class", Value::Object(counts))
            .with(&ORDINAL, Column::Integer(self.ordinals));
        for (name, mut values) in self.parameters {
            values.resize(rows, f64::NAN);
            table.push(name, Column::Number(values));
        }
        let classes = self.classes.into_iter().map(|class| class.map(|class| class.name().to_owned()));
        table
            .with(&CLASS, Column::Text(classes.collect()))
            .with(&CLASS_UNCERTAIN, Column::Text(self.uncertain))
            .with(&SENTENCE, Column::Text(self.sentences))
    }
}

/// Reason for which the class of a point is uncertain: its statistics have not settled, or its estimated error reaches across a limit; absent otherwise.
fn uncertainty(row: &impl Scalars, judgement: &Judgement) -> Option<String> {
    if row.text(MOTION_REGIME.name) == Some("not_settled") {
        return Some("not settled".to_owned());
    }
    let (kind, error) = row
        .number(WHOLE_ERROR.name)
        .map(|error| ("estimated", error))
        .or_else(|| row.number(PROMISED_ERROR.name).map(|error| ("promised", error)))?;
    let other = [1.0 + error, 1.0 / (1.0 + error)]
        .map(|factor| Judgement::of_row(row, &judgement.limits.scaled(factor)).class)
        .into_iter()
        .find(|class| *class != judgement.class)?;
    Some(format!("{} within the {kind} error of {:.1} %", other.name(), 1e2 * error))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::PointState;

    fn point(ordinal: u32, severity: Option<f64>, error: f64) -> PointSummary {
        let summary = severity.map(|severity| {
            json!({ "motion_regime": "regular", "bit_stick_slip_severity": severity, "whole_error": error, "largest_lateral_acceleration_rms": 0.1 }).to_string()
        });
        PointSummary {
            ordinal,
            state: PointState::Succeeded,
            parameters: IndexMap::from([("mud.density".to_owned(), 1200.0)]),
            summary,
            biases: IndexMap::new(),
            error: None,
        }
    }

    #[test]
    fn classes_near_a_limit_are_uncertain_by_the_estimated_error() {
        let mut window = OperatingWindow::new(OperatingLimits::default());
        let mut points = PointsTable::default();
        for (ordinal, severity, error) in [
            (1, Some(0.5), 0.02),
            (2, Some(0.99), 0.02),
            (3, Some(1.01), 0.02),
            (4, Some(1.1), 0.02),
            (5, None, 0.0),
        ] {
            window.push(&point(ordinal, severity, error)).unwrap();
            points.push(point(ordinal, severity, error)).unwrap();
        }
        let table = window.finish();
        assert_eq!(OperatingWindow::of_table(&points, OperatingLimits::default()).finish(), table);
        let texts = |quantity: &str| match &table.columns[quantity] {
            Column::Text(texts) => {
                texts.iter().map(|text| text.as_deref().unwrap_or("-").to_owned()).collect::<Vec<_>>()
            }
            _ => panic!("no texts"),
        };
        assert_eq!(texts("class"), ["quiet", "quiet", "stick_slip", "stick_slip", "-"]);
        let near = [
            "-",
            "stick_slip within the estimated error of 2.0 %",
            "quiet within the estimated error of 2.0 %",
            "-",
            "-",
        ];
        assert_eq!(texts("class_uncertain"), near);
        assert_eq!(table.attributes["points_by_class"], json!({ "stick_slip": 2, "quiet": 2 }));
    }
}
