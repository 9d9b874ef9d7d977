//! The points of the design `list`, as a table: a hundred thousand maps would take ten times the memory.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeMap, SerializeSeq};
use serde::{Deserialize, Serialize, Serializer};

use crate::axis::AxisName;
use crate::bounded::Bound;
use crate::service::LIMITS;

/// Points with a value for each parameter that the first of them names. On the wire each is an object.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ListedPoints {
    /// The parameters, in the order of the first point.
    names: Vec<AxisName>,
    /// Points by parameters, point after point; NaN for parameters that a point does not name.
    values: Vec<f64>,
    number: usize,
    /// Indices of points with other parameters than the first, in ascending order.
    uneven: Vec<usize>,
}

impl ListedPoints {
    /// Points with a value for each of the names.
    pub(crate) fn new(names: Vec<AxisName>, points: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let mut number = 0;
        let values = points.into_iter().inspect(|_| number += 1).flatten().collect();
        Self { names, values, number, uneven: Vec::new() }
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.number
    }

    /// True of no points.
    pub fn is_empty(&self) -> bool {
        self.number == 0
    }

    /// The parameters, in the order of the first point.
    pub fn names(&self) -> &[AxisName] {
        &self.names
    }

    /// The values of point `index`, from 0, in the order of the names.
    pub fn values(&self, index: usize) -> &[f64] {
        &self.values[index * self.names.len()..][..self.names.len()]
    }

    /// Changes all values, by the name of the parameter.
    pub(crate) fn change(&mut self, change: impl Fn(&AxisName, f64) -> f64) {
        let count = self.names.len().max(1);
        for (index, value) in self.values.iter_mut().enumerate() {
            if let Some(name) = self.names.get(index % count) {
                *value = change(name, *value);
            }
        }
    }

    /// Indices of points with other parameters than the first.
    pub(crate) fn uneven(&self) -> &[usize] {
        &self.uneven
    }
}

impl Serialize for ListedPoints {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct Point<'p>(&'p ListedPoints, usize);

        impl Serialize for Point<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let Point(points, index) = *self;
                let mut members = serializer.serialize_map(Some(points.names.len()))?;
                for (name, value) in points.names.iter().zip(points.values(index)) {
                    members.serialize_entry(name, value)?;
                }
                members.end()
            }
        }

        let mut entries = serializer.serialize_seq(Some(self.number))?;
        for index in 0..self.number {
            entries.serialize_element(&Point(self, index))?;
        }
        entries.end()
    }
}

impl<'de> Deserialize<'de> for ListedPoints {
    fn deserialize<D: Deserializer<'de>>(format: D) -> Result<Self, D::Error> {
        format.deserialize_seq(Points)
    }
}

const POINTS: Bound = Bound { most: LIMITS.points_per_sweep, entries: "points in a sweep" };
const PARAMETERS: Bound = Bound { most: LIMITS.axes_per_sweep, entries: "parameters" };

struct Points;

impl<'de> Visitor<'de> for Points {
    type Value = ListedPoints;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a sequence")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<ListedPoints, A::Error> {
        let mut points = ListedPoints::default();
        while entries.next_element_seed(Next(&mut points))?.is_some() {}
        Ok(points)
    }
}

/// The next point, which is added to those before.
struct Next<'p>(&'p mut ListedPoints);

impl<'de> DeserializeSeed<'de> for Next<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, format: D) -> Result<(), D::Error> {
        format.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Next<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a map")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        let Next(points) = self;
        let index = points.number;
        POINTS.check(index)?;
        let start = points.values.len();
        points.values.resize(start + points.names.len(), f64::NAN);
        let mut named = 0;
        let mut is_even = true;
        while let Some(name) = members.next_key::<AxisName>()? {
            PARAMETERS.check(named)?;
            let value = members.next_value()?;
            match points.names.iter().position(|known| *known == name) {
                Some(place) => points.values[start + place] = value,
                None if index == 0 => {
                    points.names.push(name);
                    points.values.push(value);
                }
                None => is_even = false,
            }
            named += 1;
        }
        if !is_even || named != points.names.len() {
            points.uneven.push(index);
        }
        points.number += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_survive_json_in_the_order_of_the_first() {
        let text = r#"[{"b":1.0,"a":2.0},{"a":4.0,"b":3.0}]"#;
        let points: ListedPoints = serde_json::from_str(text).unwrap();
        assert_eq!((points.len(), points.values(1)), (2, [3.0, 4.0].as_slice()));
        assert_eq!(points.uneven(), [0; 0]);
        assert_eq!(serde_json::to_string(&points).unwrap(), r#"[{"b":1.0,"a":2.0},{"b":3.0,"a":4.0}]"#);
    }

    #[test]
    fn points_with_other_parameters_than_the_first_are_known() {
        let text = r#"[{"a":1,"b":2},{"a":1},{"a":1,"c":2},{"b":2,"a":1},{"a":1,"b":2,"c":3},{}]"#;
        let points: ListedPoints = serde_json::from_str(text).unwrap();
        assert_eq!((points.len(), points.uneven()), (6, [1, 2, 4, 5].as_slice()));
    }

    #[test]
    fn a_list_is_read_up_to_the_points_of_a_sweep() {
        let most = LIMITS.points_per_sweep;
        let list = |number: usize| format!("[{}{{}}]", "{},".repeat(number - 1));
        assert_eq!(serde_json::from_str::<ListedPoints>(&list(most)).unwrap().len(), most);
        // The rest is not read.
        let beyond = list(most + 1).replace(']', " then anything");
        let refused = serde_json::from_str::<ListedPoints>(&beyond).unwrap_err().to_string();
        assert!(refused.starts_with("there may be at most 100000 points"), "{refused}");
    }
}
