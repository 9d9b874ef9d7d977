//! Degrees of freedom of a node, linear algebra of chains, orbits and spectra.

pub mod dof;
pub mod linalg;
pub mod signal;
