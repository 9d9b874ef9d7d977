//! One axis of a sweep: the name of a parameter, and the values that it takes.

use serde::{Deserialize, Deserializer, Serialize};

use crate::bounded;

/// The values of one swept parameter, listed or spaced between two ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, try_from = "AxisFields")]
pub enum Axis {
    /// `{"values": [...]}`: the values as listed, in that order.
    Values {
        /// The values, in the units of the field, 1 to 100,000.
        values: Vec<f64>,
    },
    /// `{"from", "to", "count", "scale"}`: `count` values from `from` to `to`, both ends included and exact.
    Range {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Number of values, 2 or more.
        count: u32,
        /// Spacing of the values between.
        scale: Scale,
    },
    /// `{"from", "to", "scale"}`: anything between, if the design draws the values (Latin hypercube, Sobol).
    Interval {
        /// Lower or upper end.
        from: f64,
        /// The other end.
        to: f64,
        /// Distribution of the values.
        scale: Scale,
    },
}

/// Spacing of the values between the ends of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Equal differences: `from + (to - from) i / (count - 1)`.
    #[default]
    Linear,
    /// Equal ratios: `from (to / from)^(i / (count - 1))`; both ends must be positive, or both negative.
    Log,
}

impl Axis {
    /// The number of values, without forming them; none if the design draws them.
    pub fn count(&self) -> Option<usize> {
        match self {
            Axis::Values { values } => Some(values.len()),
            Axis::Range { count, .. } => Some(*count as usize),
            Axis::Interval { .. } => None,
        }
    }

    /// The value of index `i` (from 0, below the count). Here and in [`Axis::at`] swept values are formed, and nowhere
    /// else, so that two requests for the same range name the same points to the last bit.
    pub fn value(&self, i: usize) -> f64 {
        match self {
            Axis::Values { values } => values[i],
            Axis::Range { to, count, .. } if i + 1 == *count as usize => *to,
            Axis::Range { from, to, count, scale } => {
                scale.between(*from, *to, i as f64, f64::from(count - 1))
            }
            Axis::Interval { from, to, scale } => scale.between(*from, *to, i as f64, 1.0),
        }
    }

    /// The value at `fraction` of the axis, 0 to 1 without the end: of an interval the value there, of a list the
    /// entry there, so that each is as likely as the others.
    pub fn at(&self, fraction: f64) -> f64 {
        match self {
            Axis::Values { values } => {
                values[((fraction * values.len() as f64) as usize).min(values.len() - 1)]
            }
            Axis::Range { from, to, scale, .. } | Axis::Interval { from, to, scale } => {
                scale.between(*from, *to, fraction, 1.0)
            }
        }
    }

    /// Problems of the axis itself: member (a JSON Pointer below the axis, empty for the axis), the value
    /// given, and the valid values. Whether a value makes sense physically is the scenario's matter.
    pub(crate) fn problems(&self) -> Vec<(&'static str, serde_json::Value, String)> {
        let mut problems = Vec::new();
        match self {
            Axis::Values { values } if values.is_empty() => {
                problems.push(("/values", serde_json::json!([]), "must list at least one value".to_owned()));
            }
            Axis::Values { .. } => {}
            Axis::Range { from, to, scale, .. } | Axis::Interval { from, to, scale } => {
                if let Axis::Range { count: count @ 0..2, .. } = self {
                    let detail = "must be 2 or more; a single value is written {\"values\": [x]}".to_owned();
                    problems.push(("/count", (*count).into(), detail));
                }
                if *scale == Scale::Log {
                    // Both ends may be negative, as weights on bit are.
                    let are_negative = *from < 0.0 && *to < 0.0;
                    for (member, end) in [("/from", *from), ("/to", *to)] {
                        if end <= 0.0 && !are_negative {
                            let detail =
                                "must be positive on a logarithmic scale, or both ends negative".to_owned();
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
            Axis::Range { .. } | Axis::Interval { .. } => String::new(),
        }
    }
}

impl Scale {
    /// The value at `part` of `whole` between the ends. The power is the pure one of `libm`, since a system's own may
    /// differ from another's in the last bit.
    fn between(self, from: f64, to: f64, part: f64, whole: f64) -> f64 {
        match self {
            Scale::Linear => from + (to - from) * part / whole,
            Scale::Log => from * libm::pow(to / from, part / whole),
        }
    }

    /// The part of the way from one end to the other at which `value` is.
    pub(crate) fn part(self, from: f64, to: f64, value: f64) -> f64 {
        match self {
            Scale::Linear => (value - from) / (to - from),
            Scale::Log => libm::log(value / from) / libm::log(to / from),
        }
    }

    /// The value in the middle of two.
    pub(crate) fn middle(self, a: f64, b: f64) -> f64 {
        match self {
            Scale::Linear => a + 0.5 * (b - a),
            Scale::Log => a * (b / a).sqrt(),
        }
    }
}

/// The members of an axis as they may come in. An untagged enum would only say that nothing matched; this
/// says which member is missing or too many.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `values`, or with `from` and `to`")]
struct AxisFields {
    #[serde(default, deserialize_with = "bounded::values")]
    values: Option<Vec<f64>>,
    #[serde(default, deserialize_with = "present")]
    from: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    to: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    count: Option<u32>,
    #[serde(default, deserialize_with = "present")]
    scale: Option<Scale>,
}

/// Takes the given value as it is: a `null` is neither one nor the absence of one.
fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
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
            AxisFields { from: Some(from), to: Some(to), count: None, scale, .. } => {
                Ok(Axis::Interval { from, to, scale: scale.unwrap_or_default() })
            }
            AxisFields { from: Some(_), .. } => Err("a range also needs `to`".to_owned()),
            AxisFields { to: Some(_), .. } => Err("a range also needs `from`".to_owned()),
            AxisFields { .. } => Err("an axis needs `values`, or `from`, `to` and `count`".to_owned()),
        }
    }
}

/// The name of a swept parameter: `flow_rate` \[m3/s\], `mud_density` \[kg/m3\], or the path of a numeric field of the
/// scenario.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(transparent)]
pub struct AxisName(String);

impl AxisName {
    /// Names of the parameters that have one in addition to their path, with that path.
    pub const NAMED: [(&str, &str); 2] = [("flow_rate", "mud.flow_rate"), ("mud_density", "mud.density")];

    /// The name as it is written.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The path of the scenario's field.
    pub fn scenario_path(&self) -> &str {
        AxisName::NAMED.iter().find(|(name, _)| *name == self.0).map_or(&self.0, |(_, path)| path)
    }
}

impl From<&str> for AxisName {
    fn from(name: &str) -> Self {
        AxisName(name.to_owned())
    }
}

mod schema {
    use utoipa::openapi::schema::{OneOf, Schema};
    use utoipa::openapi::{Ref, RefOr};
    use utoipa::{PartialSchema, ToSchema};

    use super::{Axis, Scale};

    /// The values as listed, in that order.
    #[derive(ToSchema)]
    #[schema(as = AxisValues)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only described")]
    struct Values {
        /// The values, in the units of the field, 1 to 100,000.
        #[schema(min_items = 1, max_items = 100_000)]
        values: Vec<f64>,
    }

    /// `count` values from `from` to `to`, both ends included and exact.
    #[derive(ToSchema)]
    #[schema(as = AxisRange)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only described")]
    struct Range {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Number of values, 2 to 100,000; usual 3 to 20, since a grid has the product of all axes' counts.
        #[schema(minimum = 2, maximum = 100_000)]
        count: u32,
        #[serde(default)]
        scale: Scale,
    }

    /// Anything from `from` to `to`, if the design draws the values (Latin hypercube, Sobol).
    #[derive(ToSchema)]
    #[schema(as = AxisInterval)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only described")]
    struct Interval {
        /// Lower or upper end.
        from: f64,
        /// The other end.
        to: f64,
        #[serde(default)]
        scale: Scale,
    }

    impl PartialSchema for Axis {
        fn schema() -> RefOr<Schema> {
            let mut forms = OneOf::new();
            forms.description =
                Some("The values of one swept parameter, listed or spaced between two ends.".to_owned());
            forms.items = ["AxisValues", "AxisRange", "AxisInterval"]
                .map(|name| RefOr::Ref(Ref::from_schema_name(name)))
                .to_vec();
            RefOr::T(Schema::OneOf(forms))
        }
    }

    impl ToSchema for Axis {
        fn name() -> std::borrow::Cow<'static, str> {
            "Axis".into()
        }

        fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
            fn collect<T: ToSchema>(schemas: &mut Vec<(String, RefOr<Schema>)>) {
                schemas.push((T::name().into_owned(), T::schema()));
                T::schemas(schemas);
            }
            collect::<Values>(schemas);
            collect::<Range>(schemas);
            collect::<Interval>(schemas);
            collect::<Scale>(schemas);
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
        (0..axis.count().unwrap()).map(|i| axis.value(i)).collect()
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

    #[test]
    fn a_fraction_of_an_interval_keeps_its_scale_and_of_a_list_picks_an_entry() {
        let linear = parse(r#"{"from": 1200, "to": 2000}"#).unwrap();
        assert_eq!([0.0, 0.25, 0.5].map(|fraction| linear.at(fraction)), [1200.0, 1400.0, 1600.0]);
        let log = parse(r#"{"from": 1e-2, "to": 1e2, "scale": "log"}"#).unwrap();
        assert!((log.at(0.5) - 1.0).abs() < 1e-15, "{}", log.at(0.5));
        let list = parse(r#"{"values": [7, 8, 9]}"#).unwrap();
        let picked = [0.0, 0.33, 0.34, 0.66, 0.67, 0.999].map(|fraction| list.at(fraction));
        assert_eq!(picked, [7.0, 7.0, 8.0, 8.0, 9.0, 9.0]);
    }

    #[test]
    fn values_of_a_scale_have_these_bits() {
        let log = parse(r#"{"from": 0.01, "to": 0.06, "count": 4, "scale": "log"}"#).unwrap();
        let bits: Vec<_> = values(&log).into_iter().map(f64::to_bits).collect();
        assert_eq!(bits, LOG_BITS);
    }

    /// Bits of 0.01 (6)^(i / 3), by `libm` 0.2.
    const LOG_BITS: [u64; 4] =
        [4576918229304087675, 4580894714928274227, 4584919399700666857, 4588807732320345784];

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
    fn the_message_names_missing_and_excess_fields() {
        for (text, message) in [
            (r#"{"from": 1, "count": 3}"#, "a range also needs `to`"),
            (r#"{}"#, "an axis needs `values`, or `from`, `to` and `count`"),
            (r#"{"values": [1], "count": 3}"#, "`values` excludes"),
            (r#"{"valeus": [1]}"#, "unknown field `valeus`"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
