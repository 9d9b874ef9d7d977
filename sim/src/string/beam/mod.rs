//! Two-node Timoshenko beam elements in their chord frame (docs/model/beam.md).
//!
//! A 12-vector holds (u, v, w, theta_x, theta_y, theta_z) of the upper node, then of the lower one. u and v
//! are lateral, w points downhole; u' = theta_y - gamma_x and v' = -theta_x + gamma_y. Every integral is
//! exact: the integrands are polynomials of degree 6 at most and the quadrature is exact to degree 7.

mod chord;
mod element;
mod matrix;
mod section;
mod shape;

pub use chord::Chord;
pub use element::BeamElement;
pub use matrix::{ElementMatrix, ElementVector};
pub use section::BeamSection;
pub use shape::Shape;
