//! Part of a point's result that is kept.

use serde::{Deserialize, Serialize};

use crate::{NodeChoice, TimeWindow};

/// Data kept of a point in addition to its row of scalars, which is always there: `"summary"`, `"spectra"`,
/// `{"orbits": {...}}` or `"full"`. Each class has all that the one before it has, but for the spectra, which follow from histories.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outputs {
    /// Nothing.
    Summary,
    /// The tables `profile`, `statics`, `contacts` and `energy`, and `spectra`: the full spectra of the recorded nodes over the
    /// spectrum windows. No histories.
    Spectra,
    /// The same tables but for `spectra`, and `history` in part.
    Orbits(OrbitOutputs),
    /// The same tables, and `history` whole: any orbit and any spectrum can be cut from it.
    #[default]
    Full,
}

/// Which part of the histories is kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OrbitOutputs {
    /// Histories of these nodes, which must be recorded; absent means all that are.
    #[serde(default)]
    pub nodes: Option<Vec<NodeChoice>>,
    /// Their samples in this half-open window, of 8 samples at least; absent means the whole run.
    #[serde(default)]
    pub window: Option<TimeWindow>,
    /// Every how many samples one is kept, from the first of the window on; 1 or more, 1 unless given, usual 1 to 10. Storage falls
    /// in proportion. Nothing is smoothed: frequencies above half the rate that is left fold back into spectra of what is kept.
    #[serde(default = "super::one")]
    pub decimation: u32,
}

impl Default for OrbitOutputs {
    fn default() -> Self {
        Self { nodes: None, window: None, decimation: 1 }
    }
}
