//! One point of a sweep as the service shows it.

use drillsweep_scenario::{PointError, Scenario};
use drillsweep_sim::string::StringMesh;
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
    /// It ended without a result; `error` has the reason. Final unless the sweep is retried.
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
    /// Number of attempts.
    pub attempts: u64,
    /// Reason of its failure; of a point that has succeeded, reason of the failure of its last recomputation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<PointError>,
    /// Links to more of it.
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

/// A page of points, with the requested fields of each.
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
    /// Time of the failure.
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
    /// Time of its deletion, once expired.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expired: Option<Timestamp>,
    /// Link to the file.
    pub link: String,
}

/// Contents of an archive of a sweep, with missing files: `manifest.json` in it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ExportManifest {
    /// Number of files of points in the archive.
    pub files: u64,
    /// Requested files that belong to results and are not in the export.
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
    /// Reason of its absence, and the consequence.
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
    /// Code, machine, times and cost of the result. If it was recomputed (`cache=refresh`) and differs,
    /// which equal keys rule out, `disagreement` has the members `differs` with the names that differ, and `earlier` with the provenance of the earlier result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provenance: Option<Map<String, Value>>,
    /// Names of the tables that the run produced.
    #[serde(default)]
    pub tables: Vec<String>,
    /// Place of the node of its error; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_place: Option<ErrorPlace>,
}

/// Place on the string at which a point failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ErrorPlace {
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Name of the component; empty if its section has none.
    pub component: String,
}

impl ErrorPlace {
    /// Place of a node, from 1 at the top, of a scenario; `None` if its string has no such node.
    pub fn of(scenario: &Scenario, node: u32) -> Option<Self> {
        let mesh = StringMesh::new(scenario).ok()?;
        let measured_depth = mesh.nodes.get(node.checked_sub(1)? as usize)?.measured_depth;
        let component = scenario.string.component_at(measured_depth).to_owned();
        Some(Self { measured_depth, component })
    }
}

/// Links to more of a point.
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
