//! Steps in time: methods, contact iterations, forces and works of a step.

pub(crate) mod adaptive;
pub(crate) mod choice;
pub(crate) mod dense;
pub(crate) mod energy;
pub(crate) mod error_estimate;
pub(crate) mod esdirk;
mod failure;
pub(crate) mod forces;
pub(crate) mod generalized_alpha;
pub(crate) mod grid;
pub(crate) mod implicit;
pub(crate) mod matrix_work;
pub(crate) mod method;
pub(crate) mod nodal;
pub(crate) mod rk4;
pub(crate) mod stability;
pub(crate) mod state;
pub(crate) mod work;

pub use adaptive::SMALLEST_MOTION;
pub use choice::{longest_step, resolved_hz, rk4_stability_limit, step_count, step_problem, torsion_step};
pub use energy::EnergyRow;
pub use error_estimate::ErrorEstimate;
pub use failure::{DivergenceReason, TransientError};
pub use implicit::ContactIterations;
