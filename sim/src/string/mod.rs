//! The string in its hole: path of the well, sections of the beam, and the mesh along the measured depth.

mod auto;
pub mod beam;
mod boundaries;
mod mesh;
pub mod well;

pub use mesh::{
    ElementKind, MAX_ELEMENTS, MeshElement, MeshError, MeshNode, NodeUnbalance, SNAP_FRACTION, StringMesh,
};
