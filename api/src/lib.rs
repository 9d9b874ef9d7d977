//! The contract of the service: requests, answers, and their derivation from results.
//!
//! A [`SweepRequest`] is [expanded](expand()) into the points to compute; their results are shown as a
//! [`Sweep`], as [points](point) and as [tables](drillsweep_table::Table); errors as [problems](problem). The
//! [`view`]s cut orbits, spectra and the sweep's table from the stored tables.
//!
//! Everything here is pure: no clock, files, SQL or HTTP.

pub mod analysis;
pub mod axis;
mod bounded;
pub mod cost;
mod design;
pub mod dry_run;
pub mod event;
pub mod expand;
pub mod forced;
pub mod in_units;
pub mod judgement;
mod listed;
pub mod mode_shapes;
pub mod point;
pub mod preset;
pub mod problem;
pub mod refine;
pub mod refinement;
pub mod request;
pub mod service;
mod signs;
pub mod stability_map;
pub mod sweep;
pub mod time_span;
pub mod torque_drag;
pub mod verify;
pub mod view;

pub use axis::{Axis, AxisName, Scale};
pub use dry_run::{DryRun, PlannedPoint, PlannedVerification};
pub use event::PointEvent;
pub use expand::{
    Expansion, Interruption, PointKey, PointKeys, SweepPoint, UNINTERRUPTED, check_patch, expand,
    expand_added, key_text,
};
pub use listed::ListedPoints;
pub use point::{
    ArtifactEntry, ArtifactList, ErrorPlace, ExportManifest, Failure, FailureList, MissingFile, PointDetail,
    PointLinks, PointList, PointRow, PointState, SelectedPointList,
};
pub use preset::{pipes, preset_detail, presets};
pub use problem::{FieldProblem, PROBLEM_MEDIA_TYPE, ProblemDetails, ProblemKind};
pub use refine::RefinedSamples;
pub use refinement::{Refinement, RefinementState};
pub use request::{AppendRequest, Design, RunRequest, SweepPatch, SweepRequest};
pub use service::{
    Collected, Collection, Health, LIMITS, Limits, Login, PipeList, Queue, Retention, ScenarioDetail,
    ScenarioEntry, ScenarioFile, ScenarioFormat, ScenarioList, Session, Worker, WorkerList,
};
pub use signs::Signs;
pub use sweep::{
    ColumnEntry, ColumnKind, ColumnList, PointCounts, Sweep, SweepDeletion, SweepLinks, SweepList,
    SweepState, SweepVerification, WaitingFor,
};
pub use verify::{promise_of_scenario, sample};

pub use drillsweep_scenario::{
    DrillString, FailureClass, PointError, Scenario, ScenarioRequest, compose, read_strictly,
};
pub use drillsweep_sim::PHYSICS_VERSION;
