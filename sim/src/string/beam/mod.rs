//! Two-node Timoshenko beam elements in their chord frame (docs/model/beam.md).
//!
//! A 12-vector holds (u, v, w, theta_x, theta_y, theta_z) of the upper node, then of the lower one. u and v
//! are lateral, w points downhole; u' = theta_y - gamma_x and v' = -theta_x + gamma_y. Every integral is
//! exact: the integrands are polynomials of degree 6 at most and the quadrature is exact to degree 7.

mod chord;
mod element;
mod section;
mod shape;

pub use chord::Chord;
pub use element::BeamElement;
pub use section::BeamSection;
pub use shape::Shape;

use crate::math::dof::DOFS;

/// A 12 x 12 element matrix.
pub type ElementMatrix = nalgebra::SMatrix<f64, { 2 * DOFS }, { 2 * DOFS }>;

/// A 12-vector of one element.
pub type ElementVector = nalgebra::SVector<f64, { 2 * DOFS }>;
