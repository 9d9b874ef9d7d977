//! One axis of a sweep: the values that one parameter takes.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The values of one swept parameter, listed or spaced between two ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(untagged, try_from = "AxisFields", deny_unknown_fields)]
pub enum Axis {
    /// `{"values": [...]}`: the values as listed, in that order.
    #[schema(title = "AxisValues")]
    Values {
        /// The values, in SI units.
        #[schema(min_items = 1)]
        values: Vec<f64>,
    },
    /// `{"from", "to", "count", "scale"}`: `count` values from `from` to `to`, both ends included and exact.
    #[schema(title = "AxisRange")]
    Range {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Number of values, 2 or more.
        #[schema(minimum = 2)]
        count: u32,
        /// How the values between are spaced.
        #[serde(default)]
        #[schema(inline)]
        scale: Scale,
    },
}

/// Spacing of the values between the ends of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Equal differences: `from + (to - from) i / (count - 1)`.
    #[default]
    Linear,
    /// Equal ratios: `from (to / from)^(i / (count - 1))`; both ends must be positive.
    Log,
}

impl Axis {
    /// The number of values, without forming them.
    pub fn count(&self) -> usize {
        match self {
            Axis::Values { values } => values.len(),
            Axis::Range { count, .. } => *count as usize,
        }
    }

    /// The value of index `i` (from 0). This is the only place where swept values are formed, so that two
    /// requests for the same range name the same points to the last bit.
    pub fn value(&self, i: usize) -> f64 {
        match self {
            Axis::Values { values } => values[i],
            Axis::Range { to, count, .. } if i + 1 == *count as usize => *to,
            Axis::Range { from, to, count, scale } => {
                let fraction = (i as f64, f64::from(count - 1));
                match scale {
                    Scale::Linear => from + (to - from) * fraction.0 / fraction.1,
                    Scale::Log => from * (to / from).powf(fraction.0 / fraction.1),
                }
            }
        }
    }

    /// What is wrong with the axis itself: member (a JSON Pointer below the axis, empty for the axis), what
    /// was given, and what would be valid. Whether a value makes sense physically is the scenario's matter.
    pub(crate) fn problems(&self) -> Vec<(&'static str, serde_json::Value, String)> {
        let mut problems = Vec::new();
        match self {
            Axis::Values { values } if values.is_empty() => {
                problems.push(("/values", serde_json::json!([]), "must list at least one value".to_owned()));
            }
            Axis::Values { .. } => {}
            Axis::Range { from, to, count, scale } => {
                if *count < 2 {
                    let detail = "must be 2 or more; a single value is written {\"values\": [x]}".to_owned();
                    problems.push(("/count", (*count).into(), detail));
                }
                if *scale == Scale::Log {
                    for (member, end) in [("/from", *from), ("/to", *to)] {
                        if end <= 0.0 {
                            let detail = "must be positive on a logarithmic scale".to_owned();
                            problems.push((member, end.into(), detail));
                        }
                    }
                }
            }
        }
        problems
    }

    /// The member of the axis that decides value `i`, as a JSON Pointer below the axis: the list entry, the
    /// end of the range, or the axis as a whole for a value in between.
    pub(crate) fn member(&self, i: usize) -> String {
        match self {
            Axis::Values { .. } => format!("/values/{i}"),
            Axis::Range { .. } if i == 0 => "/from".to_owned(),
            Axis::Range { count, .. } if i + 1 == *count as usize => "/to".to_owned(),
            Axis::Range { .. } => String::new(),
        }
    }
}

/// The members of an axis as they may come in. An untagged enum would only say that nothing matched; this
/// says which member is missing or too many.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisFields {
    values: Option<Vec<f64>>,
    from: Option<f64>,
    to: Option<f64>,
    count: Option<u32>,
    scale: Option<Scale>,
}

impl TryFrom<AxisFields> for Axis {
    type Error = String;

    fn try_from(fields: AxisFields) -> Result<Self, String> {
        match fields {
            AxisFields { values: Some(values), from: None, to: None, count: None, scale: None } => {
                Ok(Axis::Values { values })
            }
            AxisFields { values: Some(_), .. } => {
                Err("`values` excludes `from`, `to`, `count` and `scale`".to_owned())
            }
            AxisFields { from: Some(from), to: Some(to), count: Some(count), scale, .. } => {
                Ok(Axis::Range { from, to, count, scale: scale.unwrap_or_default() })
            }
            AxisFields { from, to, count, .. } => {
                let given = [("from", from.is_some()), ("to", to.is_some()), ("count", count.is_some())];
                let missing: Vec<_> = given
                    .iter()
                    .filter(|(_, is_given)| !is_given)
                    .map(|(name, _)| format!("`{name}`"))
                    .collect();
                Err(if missing.len() == given.len() {
                    "an axis needs `values`, or `from`, `to` and `count`".to_owned()
                } else {
                    format!("a range needs {} too", missing.join(" and "))
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parse(text: &str) -> Result<Axis, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    fn values(axis: &Axis) -> Vec<f64> {
        (0..axis.count()).map(|i| axis.value(i)).collect()
    }

    #[test]
    fn a_linear_range_has_equal_steps_and_exact_ends() {
        let axis = parse(r#"{"from": 1200, "to": 2100, "count": 4}"#).unwrap();
        assert_eq!(values(&axis), [1200.0, 1500.0, 1800.0, 2100.0]);
    }

    #[test]
    fn a_logarithmic_range_has_equal_ratios() {
        let axis = parse(r#"{"from": 0.01, "to": 10, "count": 4, "scale": "log"}"#).unwrap();
        let expected = [0.01, 0.1, 1.0, 10.0];
        for (value, expected) in values(&axis).into_iter().zip(expected) {
            assert!((value / expected - 1.0).abs() < 4.0 * f64::EPSILON, "{value} instead of {expected}");
        }
    }

    proptest! {
        #[test]
        fn both_ends_are_exact(from in 1e-6..1e6_f64, to in 1e-6..1e6_f64, count in 2u32..2000, log: bool) {
            let scale = if log { Scale::Log } else { Scale::Linear };
            let axis = Axis::Range { from, to, count, scale };
            prop_assert_eq!(axis.value(0).to_bits(), from.to_bits());
            prop_assert_eq!(axis.value(count as usize - 1).to_bits(), to.to_bits());
        }

        #[test]
        fn an_axis_survives_json(from in -1e6..1e6_f64, to in -1e6..1e6_f64, count in 2u32..2000) {
            let axis = Axis::Range { from, to, count, scale: Scale::Linear };
            let text = serde_json::to_string(&axis).unwrap();
            prop_assert_eq!(parse(&text).unwrap(), axis);
        }
    }

    #[test]
    fn the_message_names_what_is_missing_or_too_many() {
        for (text, message) in [
            (r#"{"from": 1, "count": 3}"#, "a range needs `to` too"),
            (r#"{}"#, "an axis needs `values`, or `from`, `to` and `count`"),
            (r#"{"values": [1], "count": 3}"#, "`values` excludes"),
            (r#"{"valeus": [1]}"#, "unknown field `valeus`"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
