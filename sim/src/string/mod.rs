//! The string's mesh: elements, nodes, gauges and masses along the measured depth.

mod auto;
mod boundaries;
mod mesh;

pub use mesh::{
    ElementKind, MAX_ELEMENTS, MeshElement, MeshError, MeshNode, NodeUnbalance, SNAP_FRACTION, StringMesh,
};
