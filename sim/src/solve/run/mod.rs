//! The run in time: equation (37) from the equilibrium at rest, unbalance on from t = 0.
//!
//! Tension, torque and the mud's coefficients are frozen at the equilibrium (docs/model/motion.md). A [`Control`](crate::control::Control) watches, cancels and suspends
//! a run; a suspended run continues from its [`Checkpoint`] to the
//! same bits as one that was never interrupted.

mod checkpoint;
mod contact_statistics;
mod disturbance;
mod histories;
mod loads;
mod recorded;
mod records;
mod settle;
mod snapshots;
mod step_loop;
#[cfg(test)]
mod tests;
mod transient;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use contact_statistics::ContactStatistics;
pub use disturbance::{DISTURBANCE, disturbance};
pub use histories::{Histories, NodeHistory, Series};
pub use loads::{
    CYCLE_BYTES, ElementLoads, LOAD_BYTES, LoadRecords, NodeLoads, Peak, RmsAndPeak, SHOCKS_G, Span,
};
pub use recorded::{additional_bit, recorded_nodes};
pub use records::{Outcome, Records, TransientEffort};
pub use settle::{
    MotionRegime, OrbitInterval, Settling, course_samples, kept_window_at_most, orbit_window_at_most,
    shortest_run, spectrum_windows_at_most, twin_time,
};
pub use snapshots::{SNAPSHOT_BLOCK_BYTES, SnapshotBlock, SnapshotSeries, SnapshotTimes};
pub use step_loop::{BLOCK_BYTES, Block, Keep, LEDGER_RATE_HZ};
pub use transient::Transient;

pub use crate::solve::step::{ContactIterations, DivergenceReason, EnergyRow, ErrorEstimate, TransientError};
