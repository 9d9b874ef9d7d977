//! Pressures of the mud's circuit by three sets of formulas side by side (docs/model/hydraulics.md).
//!
//! Friction of the model past the string where the equilibrium found it (`eccentric`), the same past a string in the middle of its hole
//! (`concentric`), and API RP 13D (`rp13d`). Those of the model stand at rest and, if the string turns, with the laminar friction that its
//! rotation thins; API RP 13D has no formula for rotation.

mod circuit;
mod column;
mod error;

#[cfg(test)]
mod tests;

pub use circuit::{Circuit, CircuitDepth, CircuitPart, Conduit};
pub use column::CircuitColumn;
pub use error::CircuitError;
