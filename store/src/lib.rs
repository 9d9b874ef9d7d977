//! Store of sweeps, of work items to be computed, of their results, and of the blobs with their arrays.
//!
//! The only crate that knows SQL and blobs. It knows nothing of drillstrings: a work item is a 32-byte key, the
//! text of a scenario, a state. Every write happens in one statement or one immediate transaction, and every
//! write of a worker carries the fencing token that it was given, so that a late worker changes nothing.

mod access;
mod blob;
mod blob_id;
mod care;
mod engine;
mod error;
mod metrics;
mod store;
mod sweep;
mod work;

pub use access::session::SessionRecord;
pub use access::token::{NewToken, TokenRecord, TokenScope, TokenSecret, TokensPresent};
pub use blob::file::NamedFile;
pub use blob::location::{LocationError, ObjectsLocation};
pub use blob::store::BlobStore;
pub use blob_id::BlobId;
pub use care::census::Census;
pub use care::check::CheckReport;
pub use care::garbage::{Collection, Garbage, RetentionPolicy};
pub use care::repair::{Repair, RepairReport};
pub use care::transfer::{SourceUse, TransferError, TransferProgress, TransferReport, transfer};
pub use engine::backoff::with_backoff;
pub use engine::location::DatabaseLocation;
pub use engine::notification::Changes;
pub use engine::role::Role;
pub use error::{Result, StoreError};
pub use metrics::Metrics;
pub use store::{Store, StoreConfig};
pub use sweep::change::{ChangeOutcome, DeleteOutcome, SweepChanges};
pub use sweep::event::Event;
pub use sweep::failure::{FailureFilter, FailurePlace, FailureRecord};
pub use sweep::point::{Artifact, PointRecord, TableRecord};
pub use sweep::record::{SweepFilter, SweepRecord};
pub use sweep::submit::{
    Addition, AppendOutcome, CachePolicy, NewPoint, NewSweep, NewVerification, SubmitOutcome,
};
pub use sweep::verification::VerificationRecord;
pub use work::lease::{Lease, Renewal};
pub use work::queue::{Claim, Finished, NewArtifact, NewResult, QueueDepths};
pub use work::scenario::ScenarioText;
pub use work::state::{Stage, StateCounts, TRANSITIONS, Transition, WorkKey, WorkState};
pub use work::worker::WorkerRecord;
