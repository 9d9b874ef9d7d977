//! Contact data of nodes.

use drillsweep_scenario::ContactLaw;

use super::friction::Friction;
use crate::string::MeshNode;

/// Contact data of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactNode<L> {
    /// Radial clearance j0 \[m\].
    pub clearance: L,
    /// Radius R_e at which the string touches the wall \[m\].
    pub contact_radius: L,
    /// The node's largest stiffness over that of the law.
    pub stiffness_share: L,
    /// The node's largest damping over that of the law.
    pub damping_share: L,
    /// Friction of the hole section there; absent if it is that of the law.
    pub friction: Option<Friction<L>>,
}

impl ContactNode<f64> {
    /// Contact data of a node, on the wall of a law.
    pub fn new(node: &MeshNode, law: &ContactLaw) -> Self {
        Self {
            clearance: node.clearance,
            contact_radius: node.contact_radius,
            stiffness_share: node.stiffness_share,
            damping_share: node.damping_share,
            friction: Friction::of_hole(&node.hole, law),
        }
    }
}
