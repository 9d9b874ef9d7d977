//! Retention: ages of data, and the interval of garbage collection.

use std::collections::BTreeMap;
use std::time::Duration;

use drillsweep_store::RetentionPolicy;
use drillsweep_table::tables::{HISTORY, SNAPSHOTS};

const DAY: Duration = Duration::from_secs(86_400);

/// Retention of data.
#[derive(Debug, Clone)]
pub struct RetentionConfig {
    /// Ages by kind of data.
    pub policy: RetentionPolicy,
    /// Time between collections; `None` if the service does not collect.
    pub interval: Option<Duration>,
}

impl Default for RetentionConfig {
    /// Recordings (histories, from which orbits and spectra are cut, and snapshots) are kept for 30 days, other tables for a year, events
    /// for 30 days.
    fn default() -> Self {
        let policy = RetentionPolicy {
            artifact_ages: Self::of_recordings(30 * DAY),
            other_artifacts: 365 * DAY,
            events: 30 * DAY,
            blob_grace: DAY,
        };
        RetentionConfig { policy, interval: None }
    }
}

impl RetentionConfig {
    /// Ages of all tables that are recordings.
    pub fn of_recordings(age: Duration) -> BTreeMap<String, Duration> {
        [&HISTORY, &SNAPSHOTS].map(|layout| (layout.name.to_owned(), age)).into()
    }
}
