//! A sweep as the service shows it.

use drillsweep_table::{Column, Table};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::axis::AxisName;
use crate::problem::FieldProblem;
use crate::refinement::RefinementState;
use crate::request::{AppendRequest, SweepRequest};
use crate::view::verification::WorstBias;

/// A sweep with its counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Sweep {
    /// Identifier.
    pub id: String,
    /// The name given to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Owner, whose share of the workers it counts against.
    pub owner: String,
    /// Words to find it by.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Names of the parameters that it varies, in the order of its request; absent for a single point.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(example = json!(["flow_rate", "mud_density"]))]
    pub varied: Vec<AxisName>,
    /// Its state as a whole.
    pub state: SweepState,
    /// Points by state.
    pub counts: PointCounts,
    /// Progress and results of the verification of a sample of the points by the reference; absent if none is verified.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verification: Option<SweepVerification>,
    /// Fraction of the work that is done, reference runs included, running points counted by their simulated time; 1 when every point
    /// and every reference run is final.
    pub progress: f64,
    /// Reason why its queued points do not begin, for lack of a worker; absent while there is one that could compute them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waiting_for: Option<WaitingFor>,
    /// Higher goes first among the sweeps of one owner.
    pub priority: i64,
    /// Time of its submission.
    pub created: Timestamp,
    /// Time at which its last point, or the last reference run that verifies one, became final.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finished: Option<Timestamp>,
    /// True if the sweep and its data are kept regardless of age.
    #[serde(default)]
    pub pinned: bool,
    /// Time from which it may be deleted, once all its points are final and unless it is pinned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expires: Option<Timestamp>,
    /// Raised by every requested change: what `PATCH` sets, pause, cancellation, retry, further points. The `ETag` of
    /// the sweep begins with it.
    #[serde(default)]
    pub revision: u64,
    /// Warnings about valid requests that are probably not meant; in the answer to a submission only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<FieldProblem>,
    /// State of the refinement that was requested; in the answer to a refinement only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<RefinementState>,
    /// Request of the sweep; left out of lists, and if it is longer than 64 KiB (`links.request`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<Box<SweepRequest>>,
    /// Later requests, the points of each after those before: the latest hundred of 64 KiB, all in an export; left out of lists.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub appended: Vec<AppendRequest>,
    /// Links to more of it.
    pub links: SweepLinks,
}

/// A worker that queued points wait for: one of their version of the physics, since no other one may compute them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct WaitingFor {
    /// Version of the physics by which the points are computed.
    pub physics_version: i64,
    /// Physics versions of the workers with a heartbeat in the last 100 s; none without workers.
    pub worker_physics_versions: Vec<i64>,
    /// The same in words.
    pub reason: String,
}

impl WaitingFor {
    /// Worker that points of a version wait for, given the versions of the workers that are there.
    pub fn new(physics_version: i64, worker_physics_versions: Vec<i64>) -> Self {
        let others: Vec<String> = worker_physics_versions.iter().map(i64::to_string).collect();
        let there = match others.as_slice() {
            [] => "no worker has sent a heartbeat in the last 100 s".to_owned(),
            [one] => format!("workers with a heartbeat in the last 100 s compute version {one}"),
            several => {
                format!("workers with a heartbeat in the last 100 s compute versions {}", several.join(", "))
            }
        };
        let reason = format!("queued points wait for a worker of physics version {physics_version}: {there}");
        WaitingFor { physics_version, worker_physics_versions, reason }
    }
}

/// Data that go with a sweep that is deleted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct SweepDeletion {
    /// True if nothing was deleted, and this only shows what would be.
    pub dry_run: bool,
    /// Points of the sweep.
    pub points: u64,
    /// Results that no other sweep has. They go with the next collection, and so do their tables.
    pub results: u64,
    /// Size of their tables.
    pub bytes: u64,
}

/// The state of a sweep as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SweepState {
    /// Some points, or reference runs that verify some, are not final yet.
    Running,
    /// Some are not final yet, and those that are queued are not started.
    Paused,
    /// Every point and every reference run is final, succeeded or failed; `counts` says how many of each.
    Completed,
    /// It was cancelled.
    Cancelled,
}

impl SweepState {
    /// The name on the wire.
    pub fn as_str(self) -> &'static str {
        match self {
            SweepState::Running => "running",
            SweepState::Paused => "paused",
            SweepState::Completed => "completed",
            SweepState::Cancelled => "cancelled",
        }
    }
}

/// Numbers of points by state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PointCounts {
    /// All points.
    pub total: u64,
    /// Waiting for a worker.
    pub queued: u64,
    /// Being simulated.
    pub running: u64,
    /// With a result.
    pub succeeded: u64,
    /// Ended without a result.
    pub failed: u64,
    /// Cancelled.
    pub cancelled: u64,
}

/// Progress and results of the verification of a sample of a sweep's points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct SweepVerification {
    /// The reference runs by state; `total` is how many were wanted.
    pub counts: PointCounts,
    /// The bias of orbit size that is farthest from zero, once a point is verified; shown with the sweep itself, and left out of lists,
    /// event streams and answers to changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst: Option<WorstBias>,
    /// Biases beyond the accuracy's promise, in words; likewise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// The columns of a sweep's table, as far as its points have any.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ColumnList {
    /// The columns, in their order.
    pub columns: Vec<ColumnEntry>,
}

/// A column without its values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ColumnEntry {
    /// Its name; `GET /v1/quantities` has its meaning.
    pub name: String,
    /// Kind of its values.
    pub kind: ColumnKind,
    /// The unit of its values, if they have one; `1` of ratios.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// Kind of the values of a column; of every kind some may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColumnKind {
    /// Whole numbers.
    Integer,
    /// Numbers.
    Number,
    /// Texts.
    Text,
}

impl ColumnList {
    /// The columns of a table.
    pub fn of(table: &Table) -> Self {
        let entry = |(name, column): (&String, &Column)| ColumnEntry {
            name: name.clone(),
            kind: match column {
                Column::Integer(_) => ColumnKind::Integer,
                Column::Number(_) | Column::Single(_) => ColumnKind::Number,
                Column::Text(_) => ColumnKind::Text,
            },
            unit: table.units.get(name).cloned(),
        };
        Self { columns: table.columns.iter().map(entry).collect() }
    }
}

/// Links to more of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct SweepLinks {
    /// The sweep itself.
    #[serde(rename = "self")]
    pub this: String,
    /// Its request.
    pub request: String,
    /// Its points.
    pub points: String,
    /// One row a point, with its summary.
    pub table: String,
    /// Results of verifying a sample of the points.
    pub verification: String,
    /// A stream of events.
    pub events: String,
    /// Everything in one archive.
    pub export: String,
    /// Cancels it (POST).
    pub cancel: String,
    /// Retries its failed and cancelled points (POST).
    pub retry: String,
    /// Pauses it: queued points are not started (POST).
    pub pause: String,
    /// Resumes it (POST).
    pub resume: String,
}

impl SweepLinks {
    /// The links of the sweep `id`.
    pub fn new(id: &str) -> Self {
        let this = format!("/v1/sweeps/{id}");
        SweepLinks {
            request: format!("{this}/request"),
            points: format!("{this}/points"),
            table: format!("{this}/table"),
            verification: format!("{this}/verification"),
            events: format!("{this}/events"),
            export: format!("{this}/export"),
            cancel: format!("{this}/cancel"),
            retry: format!("{this}/retry"),
            pause: format!("{this}/pause"),
            resume: format!("{this}/resume"),
            this,
        }
    }
}

/// A page of sweeps, newest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct SweepList {
    /// The sweeps.
    pub sweeps: Vec<Sweep>,
    /// Cursor of the next page; absent on the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}
