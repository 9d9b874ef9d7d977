//! Stability maps: growth of small motions of bit and string over rotation speed and weight on bit.
//!
//! Bit and rock are a feedback of the motion of the bit on weight and torque on bit (`feedback`); the string is a receptance, motion of the bit by a load on it. The
//! receptances are those of uniform rods and shafts, solved exactly by waves (`chain`), tabulated once along the imaginary axis (`table`), so that a point
//! of the map costs microseconds: the roots with growth are counted by the winding of the characteristic function, then found (`roots`; docs/model/stability-map.md).

mod chain;
mod feedback;
mod grid;
mod roots;
mod table;

pub use chain::AxialTop;
pub use grid::{MOST_POINTS, StabilityError, StabilityGrid, StabilityMap, StabilityPoint, stability_map};

#[cfg(test)]
mod tests;
