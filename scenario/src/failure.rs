//! Failures of points, as workers store them and the service shows them.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Error of a failed point, in the form that workers store.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointError {
    /// The class of failure.
    pub class: FailureClass,
    /// Explanation in words.
    pub reason: String,
    /// Simulated time at which it happened \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Node at which it happened, 1 at the top.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<u32>,
    /// Anything else that the worker noted, such as the last finite state.
    #[serde(flatten)]
    pub details: Map<String, Value>,
}

impl PointError {
    /// A failure with its reason alone.
    pub fn new(class: FailureClass, reason: impl Into<String>) -> Self {
        PointError { class, reason: reason.into(), time: None, node: None, details: Map::new() }
    }
}

/// Class of the failure that ended a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FailureClass {
    /// The simulation itself: it diverged, or there is no equilibrium. Would happen again.
    Physical,
    /// Disk, database or object store, or a stored scenario that no worker could read, after all retries.
    Infrastructure,
    /// Workers died on it too often.
    Crash,
    /// It ran longer than allowed.
    Timeout,
    /// It was cancelled while it ran.
    Cancelled,
    /// It is of an earlier physics version, which no worker computes any more.
    Outdated,
}

impl FailureClass {
    /// The name on the wire.
    pub fn as_str(self) -> &'static str {
        match self {
            FailureClass::Physical => "physical",
            FailureClass::Infrastructure => "infrastructure",
            FailureClass::Crash => "crash",
            FailureClass::Timeout => "timeout",
            FailureClass::Cancelled => "cancelled",
            FailureClass::Outdated => "outdated",
        }
    }
}
