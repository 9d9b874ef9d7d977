//! Failures of the mesh.

/// Largest number of elements of a string.
pub const MAX_ELEMENTS: usize = 20_000;

/// A string that cannot be cut into elements. Sections, gauges and masses are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The string has no sections.
    #[error("the string has no sections")]
    NoSections,
    /// A section has no pieces, or its pieces have no length.
    #[error("section {section} has no length")]
    NoLength {
        /// The section.
        section: usize,
    },
    /// Two tool joints leave nothing of the piece's body, or have no length.
    #[error("section {section} has no room for a body between its tool joints")]
    NoRoomForToolJoints {
        /// The section.
        section: usize,
    },
    /// A target element length is not a positive number.
    #[error("the target element length {0} m is not a positive number")]
    Target(f64),
    /// The mesh has more than [`MAX_ELEMENTS`] elements.
    #[error("the mesh has more than {MAX_ELEMENTS} elements")]
    TooManyElements,
    /// A gauge, mass or excitation is above the top or below the bit.
    #[error("{what} {index} at {measured_depth} m is not on the string")]
    OffString {
        /// "gauge", "unbalance mass" or "excitation".
        what: &'static str,
        /// Its place in the list.
        index: usize,
        /// Its measured depth \[m\].
        measured_depth: f64,
    },
}
