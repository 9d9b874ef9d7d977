//! Block-tridiagonal kernels over a lane type.
//!
//! A string is a chain, so every matrix of it couples a node to its two neighbours only: a
//! [`BlockTridiagonal`] of [`Block`]s of as many rows as a node has degrees of freedom, factored once by [`Factor`]. All kernels are written over a
//! [`Lane`]: one `f64`, or several sweep points side by side, with the same operations in the same order.

mod block;
mod column;
mod factor;
mod four;
mod lane;
mod pair;
mod skew;
mod tridiagonal;

#[cfg(test)]
mod tests;

pub use block::{Block, DOFS};
pub use factor::{Factor, SingularBlock};
pub use four::{Four, FourMask};
pub use lane::{Lane, Mask};
pub use pair::MatrixPair;
pub use skew::{SkewPart, WeightedPair};
pub use tridiagonal::BlockTridiagonal;

/// One row of values for every node.
pub type BlockVector<L, const D: usize = DOFS> = Vec<[L; D]>;
