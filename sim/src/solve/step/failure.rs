//! Failures of a run.

use crate::math::linalg::SingularBlock;

/// Reason for which a run ended without a result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TransientError {
    /// A matrix cannot be factored.
    #[error("the matrix of a step is singular at node {}", .0.row + 1)]
    Singular(#[from] SingularBlock),
    /// A fixed step is beyond the explicit method's stability limit.
    #[error("a step of {step:.3e} s is beyond the stability limit of rk4 for this mesh, {limit:.3e} s")]
    StepBeyondStability {
        /// Requested step \[s\].
        step: f64,
        /// The largest stable one \[s\].
        limit: f64,
    },
    /// The contact is so stiff that no step is short enough.
    #[error(
        "two contact iterations need the step of {step:.3e} s cut into more than {most} parts at node {node}: its contact is too stiff for \
         its mass; an accuracy with a tolerance (draft, standard, reference) adapts its steps to it"
    )]
    ContactTooStiff {
        /// Requested step \[s\].
        step: f64,
        /// Parts into which a step may be cut.
        most: u32,
        /// The node with the stiffest contact for its mass, from 1.
        node: usize,
    },
    /// The samples cannot be kept, or those of a suspended run are missing.
    #[error("the recorded samples cannot be kept: {0}")]
    Histories(String),
    /// The motion left every bound.
    #[error("diverged at t = {time:.6} s, node {node} (depth {measured_depth:.2} m): {reason}")]
    Diverged {
        /// Simulated time \[s\] up to which the state was finite and inside the hole.
        time: f64,
        /// Node, from 1.
        node: usize,
        /// Its measured depth \[m\].
        measured_depth: f64,
        /// Observed reason.
        reason: DivergenceReason,
    },
}

/// Sign by which a divergence was recognised.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DivergenceReason {
    /// A value was not finite.
    #[error("a displacement or velocity is not finite")]
    NotFinite,
    /// A node was pushed far into the rock.
    #[error("the string is {radius:.3} m off the axis of a hole of radius {hole_radius:.3} m")]
    OutsideHole {
        /// Distance from the axis \[m\].
        radius: f64,
        /// Radius of the hole \[m\].
        hole_radius: f64,
    },
    /// The energy balance is off by more than the method's error allows.
    #[error(
        "the energy ledger leaves {residual:.3e} J, more than its bound of {bound:.3e} J: the steps are too long for this contact"
    )]
    EnergyNotConserved {
        /// Energy left over \[J\].
        residual: f64,
        /// Its bound \[J\].
        bound: f64,
    },
    /// The adaptive step shrank to nothing.
    #[error("the adaptive step collapsed")]
    StepCollapsed,
}

impl TransientError {
    /// Node with the first sign of the failure, from 1; absent if it is the whole string's.
    pub fn node(&self) -> Option<usize> {
        match self {
            Self::Singular(block) => Some(block.row + 1),
            Self::StepBeyondStability { .. } | Self::Histories(_) => None,
            Self::ContactTooStiff { node, .. } | Self::Diverged { node, .. } => Some(*node),
        }
    }
}
