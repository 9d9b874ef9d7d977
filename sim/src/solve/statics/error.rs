//! Failures of the search for an equilibrium.

use super::overload::{self, Overload};
use crate::force::mud::MudError;
use crate::math::linalg::SingularBlock;

/// Reason for which no equilibrium was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StaticsError {
    /// Newton's method did not converge.
    #[error(
        "no equilibrium after {iterations} iterations: the largest unbalanced force is {residual:.3e} N at node {node}; {}",
        overload::verdict(overload.as_ref())
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// Largest unbalanced force \[N\].
        residual: f64,
        /// Node with that force, from 1.
        node: usize,
        /// Instability that the string has in every position; absent if none was found.
        overload: Option<Overload>,
    },
    /// The tangent broke down.
    #[error("the tangent stiffness is singular at node {}", .0.row + 1)]
    Singular(#[from] SingularBlock),
    /// Forces balance in positions outside the hole only, which belong to the equations and not to a string.
    #[error(
        "no equilibrium in the hole: forces balance with node {node} at {radius:.3e} m from the axis, beyond {farthest:.3e} m"
    )]
    OutsideHole {
        /// Node farthest from the axis, from 1.
        node: usize,
        /// Its distance \[m\].
        radius: f64,
        /// Distance beyond which a node is outside \[m\].
        farthest: f64,
    },
    /// The flow past the string has no solution.
    #[error("the mud at node {node}: {error}")]
    Mud {
        /// Upper node of the first element without a solution, from 1.
        node: usize,
        /// Error in its computation.
        error: MudError,
    },
    /// The iteration between equilibrium and hydraulics did not converge.
    #[error(
        "the equilibrium of string and mud did not converge: eccentricities still change by {change:.1e} after {passes} hydraulic passes, most at node {node}"
    )]
    HydraulicsNotConverged {
        /// Passes made.
        passes: usize,
        /// Last change of an eccentricity.
        change: f64,
        /// Upper node of the element with the largest change, from 1.
        node: usize,
    },
}

impl StaticsError {
    /// Node with the largest sign of the failure, from 1.
    pub fn node(&self) -> usize {
        match self {
            Self::NotConverged { node, .. } | Self::Mud { node, .. } => *node,
            Self::OutsideHole { node, .. } | Self::HydraulicsNotConverged { node, .. } => *node,
            Self::Singular(block) => block.row + 1,
        }
    }

    /// The failure with the instability that the string has in every position.
    pub(super) fn with_overload(self, find: impl FnOnce() -> Option<Overload>) -> Self {
        match self {
            Self::NotConverged { iterations, residual, node, .. } => {
                Self::NotConverged { iterations, residual, node, overload: find() }
            }
            other => other,
        }
    }
}
