//! Failures of the circuit's pressures.

use crate::force::mud::MudError;

/// Reason for which a scenario has no pressures.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CircuitError {
    /// The scenario has no mud.
    #[error("the hole is dry: without mud there are no pressures")]
    NoMud,
    /// A flow has no solution.
    #[error("{losses}, {place}: {error}")]
    Mud {
        /// Formulas.
        losses: &'static str,
        /// Part of the circuit.
        place: String,
        /// Error in its computation.
        error: MudError,
    },
}
