//! The right-hand side of the equations of motion: constant loads, unbalance, contact.

use crate::contact::{ContactNode, ContactParameters, LateralMotion, dynamic_contact};
use crate::linalg::{Four, Lane};
use crate::model::{DynamicSystem, Model, NodalVector};
use crate::string::MeshNode;

/// Contact forces of one evaluation, one entry a node.
pub(super) type ContactForces = Vec<NodeContact>;

/// What the wall does to one node.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct NodeContact {
    /// Normal and friction force along (u, v) \[N\].
    pub(super) force: [f64; 2],
    /// Friction torque about the string \[N m\].
    pub(super) torque: f64,
    /// Signed size of the normal force \[N\]; positive pushes inwards.
    pub(super) normal_force: f64,
    /// Distance from the axis while touching \[m\].
    pub(super) radius: f64,
    /// True while the node is in the wall.
    pub(super) touching: bool,
}

/// Everything that pushes the string.
#[derive(Debug, Clone)]
pub(super) struct Forces<const D: usize> {
    pub(super) load: NodalVector<D>,
    unbalance: Vec<crate::model::UnbalanceForce>,
    rotation_speed: f64,
    parameters: ContactParameters<Four>,
    /// Four nodes side by side, from the second one on; places beyond the bit can never touch.
    sites: Vec<ContactNode<Four>>,
    contact: bool,
    /// Where the twist stands among the degrees of freedom; none where it is held.
    twist: Option<usize>,
}

impl<const D: usize> Forces<D> {
    pub(super) fn new(model: &Model, system: &DynamicSystem<D>) -> Self {
        let effects = &model.effects;
        let parameters = ContactParameters::new(&model.scenario.contact, effects);
        // The clamped top node never touches.
        let sites = model.mesh.nodes[1..].chunks(LANES).map(|nodes| {
            let lanes = |value: fn(&MeshNode) -> f64, beyond: f64| {
                Four::new(std::array::from_fn(|lane| nodes.get(lane).map_or(beyond, value)))
            };
            ContactNode {
                clearance: lanes(|node| node.clearance, f64::INFINITY),
                contact_radius: lanes(|node| node.contact_radius, 0.0),
                share: lanes(|node| node.contact_share, 0.0),
            }
        });
        Self {
            load: system.load.clone(),
            unbalance: system.unbalance.clone(),
            rotation_speed: system.rotation_speed,
            parameters,
            sites: sites.collect(),
            contact: effects.contact,
            twist: system.twist(),
        }
    }

    /// Constant loads and unbalance at `time` \[s\].
    pub(super) fn external_into(&self, time: f64, out: &mut NodalVector<D>) {
        out.copy_from_slice(&self.load);
        for (node, force) in self.unbalance_at(time) {
            out[node][0] += force[0];
            out[node][1] += force[1];
        }
    }

    /// Unbalance forces (u, v) at `time` \[s\] with their nodes. The angle is reduced before the sine, so that late
    /// times lose no digits.
    pub(super) fn unbalance_at(&self, time: f64) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let angle = (self.rotation_speed * time).rem_euclid(std::f64::consts::TAU);
        self.unbalance.iter().map(move |force| {
            let (sine, cosine) = (angle + force.phase).sin_cos();
            (force.node, [force.amplitude * cosine, force.amplitude * sine])
        })
    }

    /// Contact forces for given displacements and velocities, four nodes at a time; the clamped top node never touches.
    pub(super) fn contact_into(&self, x: &[[f64; D]], v: &[[f64; D]], out: &mut ContactForces) {
        if !self.contact {
            return;
        }
        let rotation_speed = Four::splat(self.rotation_speed);
        let ((x, x_rest), (v, v_rest)) = (x[1..].as_chunks::<LANES>(), v[1..].as_chunks::<LANES>());
        let (x_rest, v_rest) = (padded(x_rest), padded(v_rest));
        for (group, (site, out)) in self.sites.iter().zip(out[1..].chunks_mut(LANES)).enumerate() {
            let (x, v) = (x.get(group).unwrap_or(&x_rest), v.get(group).unwrap_or(&v_rest));
            let motion = LateralMotion {
                u: side_by_side(x, 0),
                v: side_by_side(x, 1),
                u_rate: side_by_side(v, 0),
                v_rate: side_by_side(v, 1),
                theta_z_rate: self.twist.map_or(Four::splat(0.0), |twist| side_by_side(v, twist)),
            };
            let contact = dynamic_contact(&self.parameters, site, &motion, rotation_speed);
            let (force_u, force_v) = (contact.force_u.to_array(), contact.force_v.to_array());
            let (torque, normal) = (contact.torque_z.to_array(), contact.normal.to_array());
            let radius = (site.clearance + contact.penetration).to_array();
            let penetration = contact.penetration.to_array();
            for (lane, out) in out.iter_mut().enumerate() {
                *out = NodeContact {
                    force: [force_u[lane], force_v[lane]],
                    torque: torque[lane],
                    normal_force: normal[lane],
                    radius: radius[lane],
                    touching: penetration[lane] > 0.0,
                };
            }
        }
    }

    /// Adds contact forces to nodal forces.
    pub(super) fn add_contact(&self, nodal: &mut [[f64; D]], contact: &[NodeContact]) {
        for (nodal, contact) in nodal.iter_mut().zip(contact) {
            nodal[0] += contact.force[0];
            nodal[1] += contact.force[1];
            if let Some(twist) = self.twist {
                nodal[twist] += contact.torque;
            }
        }
    }
}

const LANES: usize = Four::LANES;

#[inline(always)]
fn side_by_side<const D: usize>(nodes: &[[f64; D]; LANES], dof: usize) -> Four {
    Four::new([nodes[0][dof], nodes[1][dof], nodes[2][dof], nodes[3][dof]])
}

/// Places beyond the bit filled with zeros.
fn padded<const D: usize>(nodes: &[[f64; D]]) -> [[f64; D]; LANES] {
    std::array::from_fn(|lane| nodes.get(lane).copied().unwrap_or([0.0; D]))
}
