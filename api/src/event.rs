//! Events of a sweep, as they happen.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::point::PointState;

/// The data of an event `point`: a result that points of the sweep share, or that verifies some, has come to a new state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointEvent {
    /// The points, by their numbers in the sweep; none where it is only the reference run of some.
    pub ordinals: Vec<u32>,
    /// The points that the result verifies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub verifies: Vec<u32>,
    /// Where they stand now.
    pub state: PointState,
    /// When it happened.
    pub at: Timestamp,
}

/// The data of an event `deleted`: a sweep is no longer there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct DeletedSweep {
    /// The sweep.
    pub id: String,
}
