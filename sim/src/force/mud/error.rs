//! Errors in the computation of mud.

/// A mud or a cross-section whose flow cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MudError {
    /// A quantity is not finite or lies outside its range.
    #[error("{quantity} is {value}; it must be {range}")]
    OutOfRange {
        /// The quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The range in words.
        range: &'static str,
    },
    /// The pipe does not fit into the hole, or the bore not into the pipe.
    #[error(
        "diameters must be ordered, 0 < inner {inner_diameter} < outer {outer_diameter} < hole {hole_diameter}"
    )]
    Diameters {
        /// D_i \[m\].
        inner_diameter: f64,
        /// D_o \[m\].
        outer_diameter: f64,
        /// D_ch \[m\].
        hole_diameter: f64,
    },
    /// The inputs are admissible one by one, but a result exceeds floating point.
    #[error("the {0} of this flow is not a finite number")]
    NotFinite(&'static str),
    /// Depths do not fit the steps of a pressure profile: it needs one node more than steps.
    #[error("{nodes} node depths do not fit {steps} elements")]
    NodeCount {
        /// Number of node depths.
        nodes: usize,
        /// Number of elements.
        steps: usize,
    },
}

/// Passes `value` on if `admissible`, and names it otherwise.
pub(super) fn check(
    quantity: &'static str,
    value: f64,
    range: &'static str,
    admissible: bool,
) -> Result<f64, MudError> {
    if admissible && value.is_finite() {
        Ok(value)
    } else {
        Err(MudError::OutOfRange { quantity, value, range })
    }
}
