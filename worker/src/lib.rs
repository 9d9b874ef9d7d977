//! A worker process: it claims points, simulates them one after the other, keeps their leases from a thread of its
//! own, and stores the results.
//!
//! One process simulates one point at a time, sequentially: the numbers do not depend on how many run. The async
//! runtime does input and output only; [`compute`] is plain code on a thread of low priority that may be cancelled
//! through the simulation's own control handle.

mod calibration;
mod compute;
mod cost;
mod encode;
mod error;
mod lease;
mod memory;
mod metrics;
mod priority;
mod provenance;
mod run_loop;
mod spool;
mod stopwatch;
mod tables;

pub use calibration::calibrate;
pub use compute::{Computation, Computed, compute, compute_from, simulated_time_total};
pub use cost::{cost_study, study_cpu_time, study_time};
pub use encode::{ArtifactError, EncodedArtifact};
pub use error::ComputeError;
pub use provenance::{Provenance, RunProvenance, WorkerProvenance};
pub use run_loop::{WorkerConfig, WorkerError, host_name, run};
pub use spool::{Spool, Suspended, SuspendedError};
