//! Request for a refinement of a sweep, and its state.

use serde::{Deserialize, Serialize};

use crate::axis::AxisName;
use crate::bounded;

/// Largest budget of a request.
pub(crate) const MOST_POINTS: u32 = 1_000;

/// Request to divide edges between points whose classes or values differ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// `class`, or a column of numbers of the sweep's table.
    #[schema(example = "class")]
    pub by: String,
    /// One or two of the sweep's parameters, over which points are neighbours; absent means all, if they are one or two.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "bounded::pair")]
    #[schema(max_items = 2, example = json!(["flow_rate", "mud_density"]))]
    pub over: Vec<AxisName>,
    /// Longest edge that is not divided, as a part of the range of each of these parameters, 0.001 to 0.5; 0.02 unless given.
    #[serde(default = "resolution")]
    #[schema(minimum = 0.001, maximum = 0.5)]
    pub resolution: f64,
    /// For a column: smallest difference of values that is divided, as a part of the range of all values, 0.001 to 1; 0.1 unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.001, maximum = 1.0)]
    pub difference: Option<f64>,
    /// For classes: changes of the service's limits, `COLUMN:VALUE` in the column's unit or `COLUMN:off`, separated by commas.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "bit_stick_slip_severity:0.5")]
    pub limits: Option<String>,
    /// Largest number of points to add, 1 to 1,000; 100 unless given. The longest edges come first.
    #[serde(default = "budget")]
    #[schema(minimum = 1, maximum = 1_000)]
    pub budget: u32,
}

fn resolution() -> f64 {
    0.02
}

fn budget() -> u32 {
    100
}

/// State of a refinement before its new points have results.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct RefinementState {
    /// Edges between different points that are longer than the resolution; 0 once everything that the samples show is located.
    pub open_edges: u64,
    /// Longest of them, as a part of the range of a parameter; 0 without any.
    pub longest_edge: f64,
    /// Points proposed in this request. Those that the sweep has already, without results yet, are not added again.
    pub proposed: u64,
}
