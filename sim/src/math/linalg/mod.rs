//! Block-tridiagonal kernels, and the nodal vectors of a time step.
//!
//! A string is a chain, so every matrix of it couples a node to its two neighbours only: a
//! [`BlockTridiagonal`] of [`Block`]s of as many rows as a node has degrees of freedom, factored once by [`Factor`].
//!
//! A time step holds four neighbouring nodes of one string side by side in a [`NodalField`], and multiplies by a [`MatrixPair`] or takes
//! the form of a [`SkewPart`]. Laws of a node are written over a [`Lane`], one node or [`Four`], with the same operations in the same order.
//! Only [`Factor::solve_field`], a recurrence along the string, goes node by node.

/// The body for every degree of freedom in turn, unrolled: otherwise the compiler keeps a loop with a counter.
macro_rules! each_dof {
    ($count:expr, $dof:ident, $body:block) => {
        each_dof!($count, $dof, $body, 0 1 2 3 4 5)
    };
    ($count:expr, $dof:ident, $body:block, $($value:literal)*) => {
        $(
            let $dof: usize = $value;
            if $dof < $count $body
        )*
    };
}
pub(crate) use each_dof;

mod block;
mod factor;
mod field;
mod four;
mod lane;
mod pair;
mod singular;
mod skew;
mod split;
mod tridiagonal;

#[cfg(test)]
mod tests;

pub use crate::math::dof::DOFS;
pub use block::Block;
pub use factor::Factor;
pub use field::{Neighbourhood, NodalField, after, next_lane};
pub use four::{Four, FourMask};
pub use lane::{Lane, Mask};
pub use pair::{General, MatrixPair, Storage, Symmetric};
pub use singular::SingularBlock;
pub use skew::{SkewPart, WeightedPair};
pub use tridiagonal::{BlockTridiagonal, InverseBands, can_couple};

/// One row of values for every node.
pub type BlockVector<const D: usize = DOFS> = Vec<[f64; D]>;
