//! Judgement of a point: class of its motion by limits, in words and with evidence, and causes of its spectral lines.
//!
//! A judgement follows from the point's row of the sweep's table, so that limits apply without a new run.

mod limits;
mod lines;

use drillsweep_quantity::columns::*;
use drillsweep_quantity::units::{self, Unit};
use drillsweep_quantity::{CLASSES, Name, Quantity};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use limits::{LimitChanges, LimitError, OperatingLimits};
pub use lines::{Cause, CauseKind, Line, LineCause, Motion, line_causes, mode_bands};

/// Class of a point, the most severe first.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum MotionClass {
    /// The run, or the search for its equilibrium, failed.
    Failed,
    /// The string leaves its equilibrium without vibrating about it.
    Buckled,
    /// The bit stops and breaks loose, or nearly so.
    StickSlip,
    /// A part of the string whirls against its rotation.
    BackwardWhirl,
    /// Nodes are accelerated by impacts.
    Impacts,
    /// A column exceeds its limit.
    OverLimit,
    /// The motion has not settled: it grows, or its statistics still change.
    Growing,
    /// A part of the string whirls with its rotation.
    ForwardWhirl,
    /// None of the others.
    Quiet,
    /// The result has no loads: there was no run in time, or an earlier version computed it.
    NotJudged,
}

impl MotionClass {
    /// All classes, the most severe first.
    pub const ALL: [Self; 10] = [
        Self::Failed,
        Self::Buckled,
        Self::StickSlip,
        Self::BackwardWhirl,
        Self::Impacts,
        Self::OverLimit,
        Self::Growing,
        Self::ForwardWhirl,
        Self::Quiet,
        Self::NotJudged,
    ];

    /// The name in requests and responses.
    pub fn name(self) -> &'static str {
        CLASSES[self as usize].name
    }
}

/// Judgement of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Judgement {
    /// The most severe class that applies.
    pub class: MotionClass,
    /// Its finding in words.
    pub sentence: String,
    /// Everything that was found, the most severe first; of a quiet point how quiet it is.
    pub findings: Vec<Finding>,
    /// Limits that were applied, by column, in the column's unit.
    pub limits: OperatingLimits,
}

/// Finding about a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Finding {
    /// Class that it supports.
    pub class: MotionClass,
    /// The finding in words, with numbers.
    pub sentence: String,
    /// Columns of the point's row that it rests on, with their values.
    pub evidence: IndexMap<String, Value>,
}

impl Judgement {
    /// Judgement of a finished point by its row.
    pub fn of_row(row: &impl Scalars, limits: &OperatingLimits) -> Self {
        let row = Row(row);
        let found = [
            row.buckling(limits),
            row.stick_slip(limits),
            row.whirl(limits, MotionClass::BackwardWhirl),
            row.impacts(limits),
        ];
        let mut findings: Vec<Finding> = found.into_iter().flatten().collect();
        findings.extend(row.over_limits(limits));
        findings.extend(row.growing());
        findings.extend(row.whirl(limits, MotionClass::ForwardWhirl));
        if findings.is_empty() {
            findings.push(row.quiet().unwrap_or_else(|| row.not_judged()));
        }
        Self::new(findings, limits)
    }

    /// Judgement of a point that failed for a reason.
    pub fn of_failure(reason: &str, limits: &OperatingLimits) -> Self {
        let finding = Finding {
            class: MotionClass::Failed,
            sentence: format!("The point failed: {reason}"),
            evidence: IndexMap::new(),
        };
        Self::new(vec![finding], limits)
    }

    fn new(findings: Vec<Finding>, limits: &OperatingLimits) -> Self {
        let (class, sentence) = findings
            .first()
            .map_or((MotionClass::Quiet, String::new()), |first| (first.class, first.sentence.clone()));
        Self { class, sentence, findings, limits: limits.clone() }
    }
}

/// Kinds of instability that push a string aside.
const BUCKLING: [&str; 3] = ["buckling", "torque_buckling", "flow_divergence"];

/// Scalars of a point by column: of its summary, or of its row in a table.
pub trait Scalars {
    /// Number, in the column's unit; absent of a missing value or a text.
    fn number(&self, column: &str) -> Option<f64>;

    /// Text; absent of a missing value or a number.
    fn text(&self, column: &str) -> Option<&str>;

    /// Value of any kind; absent of a missing one.
    fn value(&self, column: &str) -> Option<Value>;
}

impl Scalars for Map<String, Value> {
    fn number(&self, column: &str) -> Option<f64> {
        self.get(column)?.as_f64()
    }

    fn text(&self, column: &str) -> Option<&str> {
        self.get(column)?.as_str()
    }

    fn value(&self, column: &str) -> Option<Value> {
        self.get(column).filter(|value| !value.is_null()).cloned()
    }
}

#[derive(Clone, Copy)]
struct Row<'a>(&'a dyn Scalars);

impl<'a> Row<'a> {
    fn number(self, quantity: &Quantity) -> Option<f64> {
        self.0.number(quantity.name)
    }

    fn text(self, quantity: &Quantity) -> Option<&'a str> {
        self.0.text(quantity.name)
    }

    fn finding(self, class: MotionClass, sentence: String, columns: &[&Quantity]) -> Finding {
        let value = |quantity: &&Quantity| Some((quantity.name.to_owned(), self.0.value(quantity.name)?));
        Finding { class, sentence, evidence: columns.iter().filter_map(value).collect() }
    }

    /// Buckling by the stability of the equilibrium, or by the compression against its limit.
    fn buckling(self, limits: &OperatingLimits) -> Option<Finding> {
        let columns: [&Quantity; 5] = [
            &INSTABILITY,
            &INSTABILITY_GROWTH_RATE,
            &INSTABILITY_FREQUENCY_HZ,
            &LARGEST_BUCKLING_RATIO,
            &LARGEST_BUCKLING_RATIO_DEPTH,
        ];
        let found = |sentence: String| Some(self.finding(MotionClass::Buckled, sentence, &columns));
        if let Some(kind) = self.text(&INSTABILITY).filter(|kind| BUCKLING.contains(kind)) {
            let by = match kind {
                "buckling" => "compression",
                "torque_buckling" => "torque",
                _ => "the flow",
            };
            let rate = self.number(&INSTABILITY_GROWTH_RATE).unwrap_or(0.0);
            return found(format!(
                "Buckled by {by}: small motions about the equilibrium grow with {rate:.3} 1/s"
            ));
        }
        let ratio = self.number(&LARGEST_BUCKLING_RATIO)?;
        if ratio < limits.of(&LARGEST_BUCKLING_RATIO)? {
            return None;
        }
        let shape = if ratio < std::f64::consts::SQRT_2 { "sinusoidal" } else { "helical" };
        let depth = self.number(&LARGEST_BUCKLING_RATIO_DEPTH).unwrap_or(0.0);
        found(format!(
            "Buckled, {shape}: compression is {ratio:.2} of the sinusoidal buckling load at {depth:.1} m"
        ))
    }

    fn stick_slip(self, limits: &OperatingLimits) -> Option<Finding> {
        let severity = self.number(&BIT_STICK_SLIP_SEVERITY)?;
        if severity < limits.of(&BIT_STICK_SLIP_SEVERITY)? {
            return None;
        }
        let [least, largest] =
            [&BIT_SPEED_MIN, &BIT_SPEED_MAX].map(|speed| rpm(self.number(speed).unwrap_or(0.0)));
        let mut sentence = "Stick-slip".to_owned();
        if let Some(frequency) = self.number(&BIT_LINE_FREQUENCY_HZ) {
            sentence += &format!(" at {frequency:.2} Hz");
        }
        sentence +=
            &format!(": the bit turns between {least:.1} and {largest:.1} rpm, severity {severity:.2}");
        match (self.number(&BIT_STICK_FRACTION), self.number(&BIT_LINE_FREQUENCY_HZ)) {
            (Some(share), Some(frequency)) if share > 0.0 && frequency > 0.0 => {
                sentence +=
                    &format!(", and stops for {:.2} s of every {:.2} s", share / frequency, 1.0 / frequency);
            }
            (Some(share), _) if share > 0.0 => {
                sentence += &format!(", and stops for {:.0} % of the time", 1e2 * share);
            }
            _ => {}
        }
        Some(self.finding(
            MotionClass::StickSlip,
            sentence,
            &[
                &BIT_STICK_SLIP_SEVERITY,
                &BIT_SPEED_MIN,
                &BIT_SPEED_MEAN,
                &BIT_SPEED_MAX,
                &BIT_STICK_FRACTION,
                &BIT_LINE_FREQUENCY_HZ,
                &BIT_LINE_AMPLITUDE,
            ],
        ))
    }

    /// Whirl in one sense over more of the string's length than its limit.
    fn whirl(self, limits: &OperatingLimits, class: MotionClass) -> Option<Finding> {
        let (column, sense) = match class {
            MotionClass::BackwardWhirl => (&BACKWARD_WHIRL_FRACTION, "Backward"),
            _ => (&FORWARD_WHIRL_FRACTION, "Forward"),
        };
        let share = self.number(column).filter(|share| *share > 0.0)?;
        if share < limits.of(column)? {
            return None;
        }
        let mut sentence = format!("{sense} whirl over {:.0} % of the string", 1e2 * share);
        let mut columns: Vec<&Quantity> = vec![column];
        let is_backward = class == MotionClass::BackwardWhirl;
        // The fastest whirl may be of the other sense.
        let rotation = self.number(&BIT_SPEED_MEAN).unwrap_or(1.0);
        let fastest = self.number(&FASTEST_WHIRL_SPEED);
        if let Some(speed) = fastest.filter(|speed| (speed * rotation < 0.0) == is_backward) {
            let depth = self.number(&FASTEST_WHIRL_DEPTH).unwrap_or(0.0);
            sentence += &format!(", fastest {:.0} rpm at {depth:.1} m", rpm(speed));
            columns.extend([&FASTEST_WHIRL_SPEED, &FASTEST_WHIRL_DEPTH]);
        }
        let rolling = self.number(&ROLLING_WHIRL_FRACTION).filter(|share| is_backward && *share > 0.0);
        if let Some(rolling) = rolling {
            sentence += &format!("; {:.0} % of the string rolls on the wall", 1e2 * rolling);
            columns.push(&ROLLING_WHIRL_FRACTION);
        }
        Some(self.finding(class, sentence, &columns))
    }

    fn impacts(self, limits: &OperatingLimits) -> Option<Finding> {
        let rate = self.number(&LARGEST_SHOCK_RATE_10G).filter(|rate| *rate > 0.0)?;
        if rate < limits.of(&LARGEST_SHOCK_RATE_10G)? {
            return None;
        }
        let depth = self.number(&LARGEST_SHOCK_RATE_10G_DEPTH).unwrap_or(0.0);
        let peak = self.number(&LARGEST_LATERAL_ACCELERATION).unwrap_or(0.0);
        let sentence = format!(
            "Impacts: {:.0} shocks a minute above 10 g at {depth:.1} m, at most {:.1} g",
            60.0 * rate,
            units::ACCELERATION.shown.of(peak)
        );
        Some(self.finding(
            MotionClass::Impacts,
            sentence,
            &[
                &LARGEST_SHOCK_RATE_10G,
                &LARGEST_SHOCK_RATE_10G_DEPTH,
                &LARGEST_SHOCK_RATE_50G,
                &LARGEST_LATERAL_ACCELERATION,
                &LARGEST_LATERAL_ACCELERATION_DEPTH,
            ],
        ))
    }

    /// Columns above their limits, but for those that classes have of their own.
    fn over_limits(self, limits: &OperatingLimits) -> Vec<Finding> {
        let exceeded = |(column, limit): (&str, f64)| {
            let value = self.0.number(column).filter(|value| value.abs() > limit)?;
            let name = Name::parse(column)?;
            let shown = name.units().map_or(Unit { symbol: "", size: 1.0 }, |units| units.shown);
            let symbol = if shown.symbol == "1" { String::new() } else { format!(" {}", shown.symbol) };
            let depth_column = format!("{column}_depth");
            let depth = self.0.number(&depth_column);
            let place = depth.map_or_else(String::new, |depth| format!(" at {depth:.1} m"));
            let sentence = format!(
                "Over limit: {name}{place} is {}{symbol}, above {}{symbol}",
                significant(shown.of(value)),
                significant(shown.of(limit))
            );
            let mut evidence = IndexMap::from([(column.to_owned(), Value::from(value))]);
            evidence.extend(depth.map(|depth| (depth_column, Value::from(depth))));
            Some(Finding { class: MotionClass::OverLimit, sentence, evidence })
        };
        limits.of_columns().filter_map(exceeded).collect()
    }

    fn growing(self) -> Option<Finding> {
        let regime = self.text(&MOTION_REGIME)?;
        let mode = self.number(&GROWING_MODE_HZ);
        if regime != "not_settled" && mode.is_none() {
            return None;
        }
        let mut sentence = "Not settled by the end of the run".to_owned();
        if let Some(halves) = self.number(&HALVES_DIFFER) {
            sentence += &format!(": the halves of the window differ by {:.1} %", 1e2 * halves);
        }
        if let Some(frequency) = mode {
            let rate = self.number(&GROWING_MODE_RATE).unwrap_or(0.0);
            sentence +=
                &format!("; torsion at {frequency:.2} Hz still grows, while small with {rate:.3} 1/s");
        }
        Some(self.finding(
            MotionClass::Growing,
            sentence,
            &[&MOTION_REGIME, &HALVES_DIFFER, &GROWING_MODE_HZ, &GROWING_MODE_RATE],
        ))
    }

    fn quiet(self) -> Option<Finding> {
        let acceleration = self.number(&LARGEST_LATERAL_ACCELERATION_RMS)?;
        let depth = self.number(&LARGEST_LATERAL_ACCELERATION_RMS_DEPTH).unwrap_or(0.0);
        let mut sentence = format!(
            "Quiet: lateral acceleration at most {} g rms, at {depth:.1} m",
            significant(units::ACCELERATION.shown.of(acceleration))
        );
        if let Some(severity) = self.number(&BIT_STICK_SLIP_SEVERITY) {
            sentence += &format!("; stick-slip severity of the bit {}", significant(severity));
        }
        let columns = [
            &LARGEST_LATERAL_ACCELERATION_RMS,
            &LARGEST_LATERAL_ACCELERATION_RMS_DEPTH,
            &BIT_STICK_SLIP_SEVERITY,
        ];
        Some(self.finding(MotionClass::Quiet, sentence, &columns))
    }

    fn not_judged(self) -> Finding {
        let reason = match self.text(&MOTION_REGIME) {
            Some(_) => "the result is of an earlier version, without loads",
            None => "there is no run in time",
        };
        self.finding(MotionClass::NotJudged, format!("Not judged: {reason}"), &[])
    }
}

fn rpm(speed: f64) -> f64 {
    units::ANGULAR_SPEED.field.of(speed)
}

/// A number to three significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    format!("{value:.*}", digits.clamp(0, 12) as usize)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn judged(row: &Value, limits: &str) -> Judgement {
        let limits = OperatingLimits::parse(limits).unwrap();
        Judgement::of_row(row.as_object().unwrap(), &limits)
    }

    #[test]
    fn classes_are_those_of_the_vocabulary_in_its_order() {
        let names = MotionClass::ALL.map(|class| serde_json::to_value(class).unwrap());
        assert_eq!(names, CLASSES.map(|class| json!(class.name)));
        assert!(
            MotionClass::ALL.is_sorted()
                && MotionClass::ALL.iter().all(|class| names.contains(&json!(class.name())))
        );
    }

    #[test]
    fn stick_slip_reports_speeds_and_time_at_rest() {
        let row = json!({
            "motion_regime": "irregular", "bit_stick_slip_severity": 1.09, "bit_speed_min": -0.42, "bit_speed_mean": 12.566, "bit_speed_max": 26.9,
            "bit_stick_fraction": 0.25, "bit_line_frequency_hz": 2.0, "largest_lateral_acceleration_rms": 0.7,
        });
        let judgement = judged(&row, "");
        assert_eq!(judgement.class, MotionClass::StickSlip);
        assert_eq!(
            judgement.sentence,
            "Stick-slip at 2.00 Hz: the bit turns between -4.0 and 256.9 rpm, severity 1.09, and stops for 0.12 s of every 0.50 s"
        );
        assert_eq!(judgement.findings[0].evidence["bit_speed_min"], json!(-0.42));
        assert_eq!(judged(&row, "bit_stick_slip_severity:1.2").class, MotionClass::Quiet);
        assert_eq!(judged(&row, "bit_stick_slip_severity:off").class, MotionClass::Quiet);
        assert_eq!(
            judged(&json!({ "tension_top": 1.0 }), "").sentence,
            "Not judged: there is no run in time"
        );
    }

    #[test]
    fn a_column_above_its_limit_is_named_with_its_place() {
        let row = json!({
            "motion_regime": "regular", "bit_stick_slip_severity": 0.2, "largest_side_force": 12e3, "largest_lateral_acceleration_rms": 0.7, "largest_side_force_depth": 165.04,
        });
        assert_eq!(judged(&row, "").class, MotionClass::Quiet);
        let judgement = judged(&row, "largest_side_force:8000");
        assert_eq!(judgement.class, MotionClass::OverLimit);
        assert_eq!(
            judgement.sentence,
            "Over limit: largest side force of all nodes at 165.0 m is 12.0 kN, above 8.00 kN"
        );
    }

    #[test]
    fn the_most_severe_class_comes_first_and_the_others_follow() {
        let row = json!({
            "motion_regime": "not_settled", "halves_differ": 0.3, "growing_mode_hz": 2.16, "growing_mode_rate": 0.09, "bit_stick_slip_severity": 0.4,
            "backward_whirl_fraction": 0.4, "forward_whirl_fraction": 0.2, "rolling_whirl_fraction": 0.1, "fastest_whirl_speed": -30.0,
            "fastest_whirl_depth": 187.0, "bit_speed_mean": 12.0, "largest_shock_rate_10g": 0.5, "largest_shock_rate_10g_depth": 150.0,
            "largest_lateral_acceleration": 200.0, "stable": false, "instability": "buckling", "instability_growth_rate": 0.5,
        });
        let judgement = judged(&row, "");
        let classes: Vec<_> = judgement.findings.iter().map(|finding| finding.class).collect();
        assert!(classes.is_sorted(), "{classes:?}");
        assert_eq!(
            classes,
            [
                MotionClass::Buckled,
                MotionClass::BackwardWhirl,
                MotionClass::Impacts,
                MotionClass::Growing,
                MotionClass::ForwardWhirl
            ]
        );
        assert_eq!(
            judgement.findings[1].sentence,
            "Backward whirl over 40 % of the string, fastest -286 rpm at 187.0 m; 10 % of the string rolls on the wall"
        );
        assert_eq!(judgement.findings[4].sentence, "Forward whirl over 20 % of the string");
    }

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in
            [(0.0, "0"), (0.012_34, "0.0123"), (1.234_5, "1.23"), (123.45, "123"), (-98.76, "-98.8")]
        {
            assert_eq!(significant(value), text);
        }
    }
}
