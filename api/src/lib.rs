//! The contract of the service: what is asked for, what is answered, and how it is derived from results.
//!
//! A [`SweepRequest`] is [expanded](expand()) into the points to compute; what comes of them is shown as a
//! [`Sweep`], as [points](point) and as [tables](drillsweep_table::Table); what goes wrong as [problems](problem). The
//! [`view`]s cut orbits, spectra and the sweep's table from what workers stored.
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
mod listed;
pub mod point;
pub mod preset;
pub mod problem;
pub mod request;
pub mod service;
pub mod sweep;
pub mod time_span;
pub mod verify;
pub mod view;

pub use axis::{Axis, AxisName, Scale};
pub use dry_run::{DryRun, PlannedPoint, PlannedVerification};
pub use event::PointEvent;
pub use expand::{
    Expansion, Interruption, PointKey, PointKeys, SweepPoint, UNINTERRUPTED, check_patch, compose, expand,
    expand_added, key_text,
};
pub use listed::ListedPoints;
pub use point::{
    ArtifactEntry, ArtifactList, ExportManifest, Failure, FailureClass, FailureList, MissingFile,
    PointDetail, PointError, PointLinks, PointList, PointRow, PointState, SelectedPointList,
};
pub use preset::{preset_detail, presets};
pub use problem::{FieldProblem, PROBLEM_MEDIA_TYPE, ProblemDetails, ProblemKind};
pub use request::{AppendRequest, Design, RunRequest, SweepPatch, SweepRequest};
pub use service::{
    Collected, Collection, Health, LIMITS, Limits, Login, Queue, Retention, ScenarioDetail, ScenarioEntry,
    ScenarioFile, ScenarioFormat, ScenarioList, Session, Worker, WorkerList,
};
pub use sweep::{
    ColumnEntry, ColumnKind, ColumnList, PointCounts, Sweep, SweepDeletion, SweepLinks, SweepList,
    SweepState, SweepVerification, WaitingFor,
};
pub use verify::{promise_of_scenario, sample};

pub use drillsweep_scenario::{ScenarioRequest, read_strictly};
pub use drillsweep_sim::PHYSICS_VERSION;
