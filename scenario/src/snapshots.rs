//! When the motion of the whole string is kept.

use serde::{Deserialize, Serialize};

use crate::{Scenario, TimeWindow};

/// Snapshots of the whole string: of every node its displacements and the normal force of the wall, at a rate that is modest beside the
/// recording rate, as the table `snapshots`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Snapshots {
    /// Snapshots per second of simulated time \[Hz\], above 0: `recording.rate_hz` or a whole part of it, such as 25 of 1000; usual 10
    /// to 50. Motion faster than half of it looks slower than it is. Storage grows in proportion: 300 nodes at 25 Hz take some 0.1 MB
    /// a second. All nodes together may have 3.4e7 of them, about 1 GB.
    pub rate_hz: f64,
    /// Half-open window in which they are kept, of 2 snapshots at least; absent means the whole run. A short one at a high rate shows an
    /// impact, a long one at a low rate how whirl and stick-slip set in.
    #[serde(default)]
    pub window: Option<TimeWindow>,
}

impl Scenario {
    /// The window in which snapshots are kept: what `recording.snapshots` says, or the whole run; none without snapshots.
    pub fn snapshot_window(&self) -> Option<TimeWindow> {
        let whole = TimeWindow { from: 0.0, to: self.duration };
        self.recording.snapshots.map(|snapshots| snapshots.window.unwrap_or(whole))
    }
}
