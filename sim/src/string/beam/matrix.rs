//! Matrices and vectors of one element.

use crate::math::dof::DOFS;

/// A 12 x 12 element matrix.
pub type ElementMatrix = nalgebra::SMatrix<f64, { 2 * DOFS }, { 2 * DOFS }>;

/// A 12-vector of one element.
pub type ElementVector = nalgebra::SVector<f64, { 2 * DOFS }>;
