//! One point of a sweep as the service shows it.

use drillsweep_scenario::Scenario;
use indexmap::IndexMap;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The state of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PointState {
    /// Waiting for a worker.
    Queued,
    /// A worker simulates it.
    Running,
    /// Its result is there.
    Succeeded,
    /// It ended without a result; `error` says why. Final unless the sweep is retried.
    Failed,
    /// It was cancelled before it had a result.
    Cancelled,
}

impl PointState {
    /// The name on the wire.
    pub fn as_str(self) -> &'static str {
        match self {
            PointState::Queued => "queued",
            PointState::Running => "running",
            PointState::Succeeded => "succeeded",
            PointState::Failed => "failed",
            PointState::Cancelled => "cancelled",
        }
    }
}

impl std::fmt::Display for PointState {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.as_str())
    }
}

/// One row of a sweep's list of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointRow {
    /// Number of the point in its sweep, from 1, the first axis varying slowest.
    pub ordinal: u32,
    /// Its state.
    pub state: PointState,
    /// The swept parameters of this point, by axis name, then the other axes' values of the scenario.
    pub parameters: IndexMap<String, f64>,
    /// Simulated time over duration, 0 to 1.
    pub progress: f64,
    /// How often a worker has started it.
    pub attempts: u64,
    /// Why it failed; of a point that has succeeded, why its last recomputation failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<PointError>,
    /// Where to read more.
    pub links: PointLinks,
}

/// A page of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointList {
    /// The points, by ordinal.
    pub points: Vec<PointRow>,
    /// Cursor of the next page; absent on the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}

/// A page of points, with the fields of each that were asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct SelectedPointList {
    /// The points, by ordinal.
    pub points: Vec<Map<String, Value>>,
    /// Cursor of the next page; absent on the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}

impl PointRow {
    /// The fields of a row in a list.
    pub const FIELDS: [&'static str; 7] =
        ["ordinal", "state", "parameters", "progress", "attempts", "error", "links"];
}

/// A failed point, in the list over all sweeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Failure {
    /// Identifier of its sweep.
    pub sweep: String,
    /// The name given to the sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep_name: Option<String>,
    /// Owner of the sweep.
    pub owner: String,
    /// When it failed.
    pub at: Timestamp,
    /// The point as in the list of its sweep.
    #[serde(flatten)]
    pub point: PointRow,
}

/// A page of failed points, the latest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct FailureList {
    /// The points.
    pub failures: Vec<Failure>,
    /// Cursor of the next page; absent on the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}

/// The files of a point's result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ArtifactList {
    /// One entry a file, by name.
    pub artifacts: Vec<ArtifactEntry>,
}

/// One file of a point's result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ArtifactEntry {
    /// Its name within the result.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its size.
    pub bytes: u64,
    /// Rows of the table in it.
    pub rows: u64,
    /// BLAKE3 hash of its content, its `ETag`.
    pub hash: String,
    /// When it was deleted, having expired.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expired: Option<Timestamp>,
    /// Where it is.
    pub link: String,
}

/// Contents of an archive of a sweep, and what it lacks: `manifest.json` in it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ExportManifest {
    /// Number of files of points in the archive.
    pub files: u64,
    /// Those that were asked for, belong to results, and are not in it.
    pub missing: Vec<MissingFile>,
}

/// A file of a point that cannot be had.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct MissingFile {
    /// Number of the point in the sweep, from 1.
    #[schema(minimum = 1)]
    pub point: u32,
    /// Name of the table.
    pub table: String,
    /// Why it cannot be had, and what becomes of it.
    pub reason: String,
}

/// Everything about one point but its tables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointDetail {
    /// The point as in the list.
    #[serde(flatten)]
    pub row: PointRow,
    /// Content hash of scenario and physics version: equal keys, equal results.
    pub key: String,
    /// The scenario as simulated: preset, changes and axes applied.
    pub scenario: Box<Scenario>,
    /// The scalar results; the same fields make up the point's row in the sweep's table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub summary: Option<Map<String, Value>>,
    /// Which code computed it, where, and at what cost. Where it was recomputed (`cache=refresh`) and differs,
    /// which equal keys rule out, `disagreement` says what `differs` and has the provenance of the `earlier` result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provenance: Option<Map<String, Value>>,
    /// Names of the tables that the run produced.
    #[serde(default)]
    pub tables: Vec<String>,
}

/// Why a point has failed; workers store this very form.
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

/// Where to read more about a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointLinks {
    /// The point itself.
    #[serde(rename = "self")]
    pub this: String,
    /// Its sweep.
    pub sweep: String,
}

impl PointLinks {
    /// The links of point `ordinal` of the sweep `id`.
    pub fn new(id: &str, ordinal: u32) -> Self {
        let sweep = format!("/v1/sweeps/{id}");
        PointLinks { this: format!("{sweep}/points/{ordinal}"), sweep }
    }
}
