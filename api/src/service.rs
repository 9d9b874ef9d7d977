//! Answers of the service about itself.

use drillsweep_scenario::{CataloguePipe, Scenario, ScenarioRequest};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::design::SOBOL_AXES;
use crate::problem::{FieldProblem, ProblemDetails};

/// Bounds of requests to the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Limits {
    /// Points in one sweep.
    pub points_per_sweep: usize,
    /// Axes of one sweep, and parameters of a listed point.
    pub axes_per_sweep: usize,
    /// Changes (`set`) in one request.
    pub changes_per_request: usize,
    /// JSON values in one request body, those of `axes` and `points` not counted.
    pub values_per_request: usize,
    /// Bytes in one request body.
    pub body_bytes: usize,
    /// Bytes in the text of a scenario file.
    pub scenario_file_bytes: usize,
    /// Entries in one page of a list.
    pub page_size: u32,
    /// Seconds for which one request may wait for a change.
    pub wait_seconds: u64,
    /// Lowest priority.
    pub lowest_priority: i32,
    /// Highest priority.
    pub highest_priority: i32,
    /// Characters in a sweep's name.
    pub name_length: usize,
    /// Characters in an owner's name.
    pub owner_length: usize,
    /// Tags of a sweep.
    pub tags_per_sweep: usize,
    /// Characters in a tag.
    pub tag_length: usize,
    /// Requests that an owner may make per second, on average.
    pub requests_per_second: u32,
    /// Requests that an owner may make at once (the size of the token bucket).
    pub request_burst: u32,
    /// Event streams that an owner may have open, and as many long polls.
    pub held_answers_per_owner: usize,
    /// Points of an owner that may be queued or running.
    pub open_points_per_owner: u64,
}

/// The limits in force, except those of an owner: these are the defaults of an operator's settings.
pub const LIMITS: Limits = Limits {
    points_per_sweep: 100_000,
    axes_per_sweep: SOBOL_AXES,
    changes_per_request: 200,
    values_per_request: 50_000,
    body_bytes: 16 << 20,
    scenario_file_bytes: 512 << 10,
    page_size: 500,
    wait_seconds: 60,
    lowest_priority: -10,
    highest_priority: 10,
    name_length: 200,
    owner_length: 100,
    tags_per_sweep: 20,
    tag_length: 100,
    requests_per_second: 200,
    request_burst: 1_000,
    held_answers_per_owner: 100,
    open_points_per_owner: 500_000,
};

/// The catalogue of pipes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PipeList {
    /// Its pipes by size.
    pub pipes: Vec<CataloguePipe>,
}

/// The preset scenarios.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ScenarioList {
    /// One entry a preset.
    pub scenarios: Vec<ScenarioEntry>,
}

/// A preset in the list.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ScenarioEntry {
    /// Its name, as a sweep's `preset`.
    pub name: String,
    /// Description in a line.
    pub description: String,
    /// The whole scenario.
    pub link: String,
}

/// A preset in full.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ScenarioDetail {
    /// Its name, as a sweep's `preset`.
    pub name: String,
    /// Description in a line.
    pub description: String,
    /// The scenario.
    pub scenario: Box<Scenario>,
}

/// The text of a scenario file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Format of the text.
    pub format: ScenarioFormat,
    /// The whole file: a scenario, or `preset` or `scenario` with changes in `set`.
    pub text: String,
}

/// Format of a scenario file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ScenarioFormat {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

impl ScenarioFile {
    /// Request of the file. It is not validated yet.
    ///
    /// # Errors
    /// The first place at which the text is not of its format, or no scenario.
    pub fn read(&self) -> Result<ScenarioRequest, Box<ProblemDetails>> {
        let refused = |detail: String| {
            let error =
                FieldProblem { pointer: Some("/text".to_owned()), parameter: None, got: None, detail };
            Box::new(ProblemDetails::invalid_request(vec![error]))
        };
        let most = LIMITS.scenario_file_bytes;
        if self.text.len() > most {
            return Err(refused(format!("must have at most {most} bytes; it has {}", self.text.len())));
        }
        let read = match self.format {
            ScenarioFormat::Toml => ScenarioRequest::from_toml(&self.text),
            ScenarioFormat::Json => ScenarioRequest::from_json(&self.text),
        };
        read.map_err(|problem| refused(problem.to_string()))
    }
}

/// The worker processes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct WorkerList {
    /// One entry a process.
    pub workers: Vec<Worker>,
}

/// One worker process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Worker {
    /// Identifier.
    pub id: String,
    /// The machine that it runs on.
    pub host: String,
    /// Process number there.
    pub process: i64,
    /// Version of its program.
    pub version: String,
    /// Version of its numbers; it computes only points submitted under the same.
    pub physics_version: i64,
    /// Time of its start.
    pub started: Timestamp,
    /// Its last heartbeat.
    pub seen: Timestamp,
}

/// The queue over all sweeps, in results to be computed: points that share a key are one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Queue {
    /// Queued for a worker.
    pub queued: u64,
    /// Wanted by paused sweeps only.
    pub paused: u64,
    /// To be retried later.
    pub waiting_for_retry: u64,
    /// Being computed.
    pub running: u64,
}

/// Ages at which data are deleted, and the last collection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Retention {
    /// Interval at which the service deletes expired data; absent if it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval_seconds: Option<f64>,
    /// Age at which recordings (histories and snapshots) expire.
    pub recordings_days: f64,
    /// Age at which other tables of points expire.
    pub tables_days: f64,
    /// Age at which events are forgotten.
    pub events_days: f64,
    /// The last collection, by the service or by `drillsweep gc`; absent if there was none yet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<Collection>,
}

/// A garbage collection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Collection {
    /// Start of the last collection.
    pub started: Timestamp,
    /// End of the last completed collection; before `started` while one is under way, or if the last one failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended: Option<Timestamp>,
    /// Deletions of the one that ended last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deleted: Option<Collected>,
}

/// Deletions of a garbage collection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(default)]
pub struct Collected {
    /// Expired sweeps.
    pub sweeps: u64,
    /// Results that belonged to no sweep any more.
    pub results: u64,
    /// Tables that reached their age.
    pub artifacts: u64,
    /// Scenarios that no point was left of.
    pub scenarios: u64,
    /// Events.
    pub events: u64,
    /// Stored files.
    pub blobs: u64,
    /// Their size.
    pub blob_bytes: u64,
    /// Parts of uploads that were never finished.
    pub unfinished_uploads: u64,
    /// Their size.
    pub unfinished_bytes: u64,
}

/// The answer of the health checks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Health {
    /// `ok`.
    pub status: String,
}

/// A token to log in by.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Login {
    /// Its text.
    pub token: String,
}

/// The session of a browser.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Session {
    /// True if requests need a token.
    pub tokens_required: bool,
    /// Owner of the sweeps that are submitted in the session; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub owner: Option<String>,
    /// The name of its token.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Permissions of the token: `read`, `submit` or `admin`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scope: Option<String>,
    /// End of the session.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expires: Option<Timestamp>,
}
