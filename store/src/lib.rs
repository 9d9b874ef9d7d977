//! Store of sweeps, of work items to be computed, of their results, and of the blobs with their arrays.
//!
//! The only crate that knows SQL and blobs. It knows nothing of drillstrings: a work item is a 32-byte key, the
//! text of a scenario, a state. Every write happens in one statement or one immediate transaction, and every
//! write of a worker carries the fencing token that it was given, so that a late worker changes nothing.

mod blob;
mod census;
mod check;
mod connection;
mod database;
mod error;
mod event;
mod failure;
mod hash_tree;
mod machine;
mod metrics;
mod migration;
mod notification;
mod patience;
mod point;
mod probe;
mod query;
mod queue;
mod repair;
mod retention;
mod session;
mod sql;
mod state;
mod submit;
mod sweep;
mod token;
mod transfer;
mod upload;
mod verification;
mod worker;

pub use blob::{BlobId, BlobStore, LocationError, NamedFile, ObjectsLocation};
pub use census::Census;
pub use check::CheckReport;
pub use connection::{Role, Store, StoreConfig};
pub use database::DatabaseLocation;
pub use error::{Result, StoreError};
pub use event::{Event, SweepMark};
pub use failure::{FailureFilter, FailurePlace, FailureRecord};
pub use metrics::Metrics;
pub use notification::Changes;
pub use patience::patiently;
pub use point::{Artifact, PointRecord, ScenarioText, TableRecord};
pub use queue::{Claim, Finished, Lease, NewArtifact, NewResult, QueueDepths, Renewal};
pub use repair::{Repair, RepairReport};
pub use retention::{Collection, Garbage, RetentionPolicy};
pub use session::SessionRecord;
pub use state::{Stage, StateCounts, TRANSITIONS, Transition, WorkKey, WorkState};
pub use submit::{Addition, AppendOutcome, CachePolicy, NewPoint, NewSweep, NewVerification, SubmitOutcome};
pub use sweep::{ChangeOutcome, DeleteOutcome, SweepChanges, SweepFilter, SweepRecord};
pub use token::{NewToken, TokenRecord, TokenScope, TokenSecret, TokensPresent};
pub use transfer::{SourceUse, TransferError, TransferProgress, TransferReport, transfer};
pub use verification::VerificationRecord;
pub use worker::WorkerRecord;
