//! The string in its hole: path of the well, sections of the beam, and the mesh along the measured depth.

mod auto;
pub mod beam;
mod boundaries;
mod error;
mod mesh;
pub mod well;

pub use boundaries::{ElementKind, SNAP_FRACTION};
pub(crate) use boundaries::{UniformPart, stretches};
pub use error::{MAX_ELEMENTS, MeshError};
pub(crate) use mesh::nearest_node;
pub use mesh::{MeshElement, MeshNode, NodeUnbalance, StringMesh};
