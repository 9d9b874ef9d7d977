//! Failures of torque and drag.

use crate::string::MeshError;
use crate::string::well::WellError;

/// Largest number of cases of one broomstick: modes times friction factors times depths.
pub const MOST_BROOMSTICK_CASES: usize = 5_000;

/// Reason for which a scenario has no torque and drag.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SoftStringError {
    /// The survey does not describe a path.
    #[error("well: {0}")]
    Well(#[from] WellError),
    /// The string has no sections.
    #[error("string: {0}")]
    String(#[from] MeshError),
    /// The bit is above the top, or below the end of the whole string or of the survey.
    #[error(
        "the bit is at {bit_depth} m; it must be above 0 and at most {deepest} m, the end of string and survey, and the string is shortened at its top"
    )]
    BitDepth {
        /// Measured depth of the bit \[m\].
        bit_depth: f64,
        /// Largest bit depth \[m\].
        deepest: f64,
    },
    /// The mode `ream` has no axial speed.
    #[error("the mode ream needs an axial speed in m/s, negative upwards")]
    NoAxialSpeed,
    /// A friction factor is negative or not finite.
    #[error("a friction factor of {0} is not a number of 0 or greater")]
    Friction(f64),
    /// Too many cases of a broomstick are requested.
    #[error("{0} cases are requested, of {MOST_BROOMSTICK_CASES} at most")]
    TooManyCases(usize),
}
