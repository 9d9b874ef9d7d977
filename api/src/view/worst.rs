//! Worst values of points with their places: of one point, or of all points of a sweep.

use drillsweep_quantity::Quantity;
use drillsweep_quantity::columns::*;

use crate::judgement::{MotionClass, Scalars};

/// Loads whose largest values are reported. The depth of NAME is the column `NAME_depth`.
static LOADS: [&Quantity; 13] = [
    &BIT_STICK_SLIP_SEVERITY,
    &LARGEST_LATERAL_ACCELERATION_RMS,
    &LARGEST_LATERAL_ACCELERATION,
    &LARGEST_AXIAL_ACCELERATION,
    &LARGEST_TANGENTIAL_ACCELERATION,
    &LARGEST_SHOCK_RATE_10G,
    &LARGEST_SIDE_FORCE,
    &LARGEST_BENDING_STRESS,
    &LARGEST_EQUIVALENT_STRESS,
    &LARGEST_YIELD_RATIO,
    &LARGEST_FATIGUE_RATE,
    &LARGEST_ORBIT_SIZE,
    &LARGEST_BUCKLING_RATIO,
];

/// Parts of a result's error.
static ERRORS: [&Quantity; 4] = [&TIME_ERROR, &MESH_ERROR, &SAMPLING_ERROR, &WHOLE_ERROR];

/// Largest value of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstValue {
    /// The column.
    pub quantity: &'static Quantity,
    /// The value, in the column's unit.
    pub value: f64,
    /// Measured depth of its place \[m\]; absent of values without one.
    pub depth: Option<f64>,
    /// Number of the point, from 1.
    pub ordinal: u32,
}

/// Largest values of some points, as they are put together point by point.
#[derive(Debug, Clone, Default)]
pub struct WorstValues {
    loads: [Option<WorstValue>; LOADS.len()],
    errors: [Option<WorstValue>; ERRORS.len()],
    point: Option<(MotionClass, f64, u32)>,
}

impl WorstValues {
    /// Adds a finished point with its class by limits.
    pub fn push(&mut self, ordinal: u32, row: &impl Scalars, class: MotionClass) {
        for (worst, quantity) in self.loads.iter_mut().zip(LOADS) {
            raise(worst, quantity, ordinal, row);
        }
        for (worst, quantity) in self.errors.iter_mut().zip(ERRORS) {
            raise(worst, quantity, ordinal, row);
        }
        let size = row.number(LARGEST_LATERAL_ACCELERATION_RMS.name).unwrap_or(0.0);
        let is_worse = |(worst, largest, _): (MotionClass, f64, u32)| {
            class < worst || (class == worst && size > largest)
        };
        if self.point.is_none_or(is_worse) {
            self.point = Some((class, size, ordinal));
        }
    }

    /// Largest loads, without those that no point has.
    pub fn loads(&self) -> impl Iterator<Item = &WorstValue> {
        self.loads.iter().flatten()
    }

    /// Largest errors, without those that no point states.
    pub fn errors(&self) -> impl Iterator<Item = &WorstValue> {
        self.errors.iter().flatten()
    }

    /// Number of the worst point with a result: of the most severe class that with the largest lateral acceleration.
    pub fn point(&self) -> Option<u32> {
        self.point.map(|(_, _, ordinal)| ordinal)
    }
}

fn raise(worst: &mut Option<WorstValue>, quantity: &'static Quantity, ordinal: u32, row: &impl Scalars) {
    let Some(value) = row.number(quantity.name) else { return };
    if worst.is_none_or(|worst| value.abs() > worst.value.abs()) {
        let depth = row.number(&format!("{}_depth", quantity.name));
        *worst = Some(WorstValue { quantity, value, depth, ordinal });
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    #[test]
    fn the_largest_values_have_their_points_and_depths() {
        let mut worst = WorstValues::default();
        for (ordinal, class, acceleration, force) in [
            (1, MotionClass::Quiet, 30.0, json!(5.0)),
            (2, MotionClass::Impacts, 10.0, json!(9.0)),
            (3, MotionClass::Impacts, 20.0, Value::Null),
        ] {
            let row = json!({
                "largest_lateral_acceleration_rms": acceleration, "largest_lateral_acceleration_rms_depth": 10 * ordinal, "largest_side_force": force,
                "whole_error": 0.01 * f64::from(ordinal),
            });
            worst.push(ordinal, row.as_object().unwrap(), class);
        }
        let loads: Vec<_> = worst
            .loads()
            .map(|worst| (worst.quantity.name, worst.value, worst.depth, worst.ordinal))
            .collect();
        assert_eq!(
            loads,
            [("largest_lateral_acceleration_rms", 30.0, Some(10.0), 1), ("largest_side_force", 9.0, None, 2)]
        );
        assert_eq!(worst.errors().map(|worst| worst.ordinal).collect::<Vec<_>>(), [3]);
        assert_eq!(worst.point(), Some(3));
        assert_eq!(WorstValues::default().point(), None);
    }

    #[test]
    fn depths_of_loads_are_columns() {
        for quantity in LOADS.iter().filter(|quantity| **quantity != &BIT_STICK_SLIP_SEVERITY) {
            let depth = format!("{}_depth", quantity.name);
            assert!(drillsweep_quantity::of(&depth).is_some(), "{depth}");
        }
    }
}
