//! Failure of a factorisation.

/// A pivot block could not be inverted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the pivot block of row {row} is singular")]
pub struct SingularBlock {
    /// Block row, counted from 0.
    pub row: usize,
}
