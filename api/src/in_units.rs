//! Documents of a point in chosen units: modes, diagnosis and cost study.
//!
//! Depths, amplitudes, and the values of columns and statistics are converted. Frequencies, rates and times keep the units that names and descriptions give, and sentences
//! those of their words.

use std::collections::BTreeMap;

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Unit, UnitChoice};
use drillsweep_study::cost::{CostErrors, CostReport, CostRow, Quantity};
use serde::Serialize;
use serde_json::Value;

use crate::analysis::{Diagnosis, Modes};

/// Document in chosen units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InUnits<T> {
    /// The document.
    #[serde(flatten)]
    pub document: T,
    /// Units of the converted numbers: by field, of evidence and limits by column, of values of a cost study by `quantity`. Absent if the request chooses no units.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub units: BTreeMap<String, String>,
}

impl<T: Convert> InUnits<T> {
    /// The document in the units of a choice.
    pub fn new(mut document: T, choice: &UnitChoice) -> Self {
        let mut units = ChosenUnits { choice, named: BTreeMap::new() };
        if !choice.is_kept() {
            document.convert(&mut units);
        }
        Self { document, units: units.named }
    }
}

/// Document whose numbers can be converted from the units in which they are kept.
pub trait Convert {
    /// Converts them, and takes the units that it names.
    fn convert(&mut self, units: &mut ChosenUnits<'_>);
}

/// Units of a choice, and the names under which a document has taken them.
#[derive(Debug)]
pub struct ChosenUnits<'c> {
    choice: &'c UnitChoice,
    named: BTreeMap<String, String>,
}

impl ChosenUnits<'_> {
    /// The unit of a column of the vocabulary, which the document names by `name`; `None` of a column without a unit.
    fn unit(&mut self, name: &str, column: &str) -> Option<Unit> {
        let unit = self.choice.unit(column)?;
        self.named.insert(name.to_owned(), unit.symbol.to_owned());
        Some(unit)
    }
}

fn write<'v>(unit: Option<Unit>, values: impl IntoIterator<Item = &'v mut f64>) {
    if let Some(unit) = unit {
        values.into_iter().for_each(|value| *value = unit.written(*value));
    }
}

impl Convert for Modes {
    fn convert(&mut self, units: &mut ChosenUnits<'_>) {
        let depth = units.unit("measured_depth", MEASURED_DEPTH.name);
        let extent = units.unit("extent", MEASURED_DEPTH.name);
        for mode in &mut self.modes {
            write(depth, [&mut mode.measured_depth]);
            write(extent, &mut mode.extent);
        }
    }
}

impl Convert for Diagnosis {
    fn convert(&mut self, units: &mut ChosenUnits<'_>) {
        for (column, value) in self.judgement.findings.iter_mut().flat_map(|finding| &mut finding.evidence) {
            if let Some(number) = value.as_f64()
                && let Some(unit) = units.unit(column, column)
            {
                *value = Value::from(unit.written(number));
            }
        }
        for (column, limit) in self.judgement.limits.values_mut() {
            write(units.unit(column, column), [limit]);
        }
        let depth = units.unit("measured_depth", MEASURED_DEPTH.name);
        let amplitude = units.unit("amplitude", AMPLITUDE.name);
        for line in &mut self.lines {
            let mode = line.cause.as_mut().and_then(|cause| cause.mode.as_mut());
            write(depth, mode.map(|mode| &mut mode.measured_depth));
            write(depth, [&mut line.measured_depth]);
            write(amplitude, [&mut line.amplitude]);
        }
    }
}

impl Convert for CostReport {
    fn convert(&mut self, units: &mut ChosenUnits<'_>) {
        let depth = units.unit("measured_depth", MEASURED_DEPTH.name);
        let mut unit_of = |quantity: Quantity| units.unit(quantity.name(), column_of(quantity));
        for agreement in &mut self.agreements {
            let unit = unit_of(agreement.quantity);
            for node in &mut agreement.nodes {
                write(depth, &mut node.measured_depth);
                write(unit, &mut node.values);
            }
        }
        let lists =
            [&mut self.references, &mut self.methods, &mut self.starts, &mut self.meshes, &mut self.effects];
        for CostRow { errors, .. } in lists.into_iter().flatten() {
            let Some(errors) = errors else { continue };
            let CostErrors {
                orbit_size,
                radius_deviation,
                mean_radius,
                contact_force,
                torsional_speed,
                lines,
                ..
            } = errors;
            for (quantity, error) in [
                (Quantity::OrbitSize, orbit_size),
                (Quantity::RadiusDeviation, radius_deviation),
                (Quantity::MeanRadius, mean_radius),
                (Quantity::ContactForce, contact_force),
                (Quantity::TorsionalSpeed, torsional_speed),
            ] {
                let Some(error) = error else { continue };
                let unit = unit_of(quantity);
                write(depth, &mut error.measured_depth);
                for node in &mut error.nodes {
                    write(depth, &mut node.measured_depth);
                    write(unit, [&mut node.reference, &mut node.value]);
                }
            }
            let Some(lines) = lines else { continue };
            let amplitude = unit_of(Quantity::Lines);
            for line in &mut lines.named {
                write(depth, [&mut line.measured_depth]);
                write(amplitude, [&mut line.amplitude]);
            }
            write(depth, lines.spurious.iter_mut().map(|line| &mut line.measured_depth));
        }
    }
}

/// The column of the vocabulary whose units a quantity of a cost study has.
fn column_of(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::OrbitSize => ORBIT_RADIUS_RMS.name,
        Quantity::RadiusDeviation => ORBIT_RADIUS_DEVIATION.name,
        Quantity::MeanRadius => ORBIT_MEAN_RADIUS.name,
        Quantity::ContactForce => NORMAL_FORCE.name,
        Quantity::TorsionalSpeed => THETA_Z_RATE.name,
        Quantity::Lines => LINE_AMPLITUDE.name,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::cost::tests::report;
    use crate::judgement::{Judgement, Line, Motion, OperatingLimits, line_causes};

    /// International foot and inch \[m\], pound-force \[N\].
    const FOOT: f64 = 0.3048;
    const INCH: f64 = 0.0254;
    const POUND_FORCE: f64 = 4.448_221_615_260_5;

    fn json_in<T: Convert + Serialize>(document: T, units: &str) -> Value {
        let units = UnitChoice::parse(units).unwrap();
        serde_json::to_value(InUnits::new(document, &units)).unwrap()
    }

    #[test]
    fn a_document_without_chosen_units_is_the_document() {
        let unchanged = InUnits::new(report(), &UnitChoice::default());
        assert_eq!(serde_json::to_value(unchanged).unwrap(), serde_json::to_value(report()).unwrap());
    }

    #[test]
    fn a_diagnosis_has_evidence_limits_and_lines_in_their_units() {
        let row = json!({
            "largest_bending_stress": 250e6, "largest_bending_stress_depth": 304.8, "bit_stick_slip_severity": 0.5,
            "motion_regime": "settled",
        });
        let row = row.as_object().unwrap();
        let line = Line {
            node: 3,
            measured_depth: 609.6,
            window: [0.0, 10.0],
            frequency_hz: 2.0,
            amplitude: 0.0127,
        };
        let judgement = Judgement::of_row(row, &OperatingLimits::default());
        let diagnosis = Diagnosis { judgement, lines: line_causes(&[line], &Motion::default()) };
        let field = json_in(diagnosis.clone(), "field,largest_bending_stress_depth:m");
        let evidence = &field["findings"][0]["evidence"];
        assert_eq!(evidence["largest_bending_stress_depth"], 304.8);
        // A ksi is a thousand pounds-force on a square inch.
        let ksi = 1e3 * POUND_FORCE / (INCH * INCH);
        let stress = evidence["largest_bending_stress"].as_f64().unwrap();
        assert!((stress * ksi / 250e6 - 1.0).abs() < 1e-14, "{stress}");
        assert_eq!(field["limits"]["largest_bending_stress"], 20.0);
        assert_eq!(field["limits"]["largest_lateral_acceleration_rms"], 2.0);
        assert_eq!(
            (&field["lines"][0]["measured_depth"], &field["lines"][0]["amplitude"]),
            (&json!(2000.0), &json!(0.5))
        );
        assert_eq!(
            (&field["lines"][0]["frequency_hz"], &field["lines"][0]["window"]),
            (&json!(2.0), &json!([0.0, 10.0]))
        );
        let units = &field["units"];
        assert_eq!(
            ["measured_depth", "amplitude", "largest_bending_stress", "largest_bending_stress_depth"]
                .map(|name| &units[name]),
            ["ft", "in", "ksi", "m"]
        );
        assert_eq!(field["sentence"], diagnosis.judgement.sentence);
        let si = json_in(diagnosis, "si");
        assert_eq!(si["lines"][0]["amplitude"], 12.7);
    }

    #[test]
    fn a_cost_study_has_depths_and_values_in_their_units_and_its_errors_as_they_are() {
        let (kept, field) = (serde_json::to_value(report()).unwrap(), json_in(report(), "field"));
        let of = |report: &Value, pointer: &str| report.pointer(pointer).unwrap().as_f64().unwrap();
        let node = "/methods/0/errors/orbit_size/nodes/0";
        for (member, factor) in
            [("measured_depth", FOOT), ("reference", INCH), ("value", INCH), ("bias", 1.0)]
        {
            let pointer = format!("{node}/{member}");
            let (kept, shown) = (of(&kept, &pointer), of(&field, &pointer));
            assert!((shown * factor - kept).abs() <= 2.0 * f64::EPSILON * kept.abs(), "{member}: {shown}");
        }
        assert_eq!(
            (&field["units"]["measured_depth"], &field["units"]["orbit_size"]),
            (&json!("ft"), &json!("in"))
        );
        assert_eq!(field["methods"][0]["cpu_time"], kept["methods"][0]["cpu_time"]);
        assert_eq!(json_in(report(), "orbit_radius_rms:mm")["units"]["orbit_size"], "mm");
    }
}
