//! The right-hand side of the equations of motion: constant loads, unbalance, contact.

use crate::contact::{ContactNode, ContactParameters, LateralMotion, dynamic_contact};
use crate::model::{DynamicSystem, Model, NodalVector};

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
pub(super) struct Forces {
    pub(super) load: NodalVector,
    unbalance: Vec<crate::model::UnbalanceForce>,
    rotation_speed: f64,
    parameters: ContactParameters<f64>,
    sites: Vec<ContactNode<f64>>,
    contact: bool,
}

impl Forces {
    pub(super) fn new(model: &Model, system: &DynamicSystem) -> Self {
        let effects = &model.scenario.effects;
        let parameters = ContactParameters::new(&model.scenario.contact, effects);
        let sites = model
            .mesh
            .nodes
            .iter()
            .map(|node| ContactNode { clearance: node.clearance, contact_radius: node.contact_radius });
        Self {
            load: system.load.clone(),
            unbalance: system.unbalance.clone(),
            rotation_speed: system.rotation_speed,
            parameters,
            sites: sites.collect(),
            contact: effects.contact.is_on(),
        }
    }

    /// Constant loads and unbalance at `time` \[s\].
    pub(super) fn external_into(&self, time: f64, out: &mut NodalVector) {
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

    /// Contact forces for given displacements and velocities; the clamped top node never touches.
    pub(super) fn contact_into(&self, x: &[[f64; 6]], v: &[[f64; 6]], out: &mut ContactForces) {
        if !self.contact {
            return;
        }
        for (((site, x), v), out) in self.sites.iter().zip(x).zip(v).zip(out.iter_mut()).skip(1) {
            let motion = LateralMotion { u: x[0], v: x[1], u_rate: v[0], v_rate: v[1], theta_z_rate: v[5] };
            let contact = dynamic_contact(&self.parameters, site, &motion, self.rotation_speed);
            *out = NodeContact {
                force: [contact.force_u, contact.force_v],
                torque: contact.torque_z,
                normal_force: contact.normal,
                radius: site.clearance + contact.penetration,
                touching: contact.penetration > 0.0,
            };
        }
    }
}

/// Adds contact forces to nodal forces.
pub(super) fn add_contact(forces: &mut [[f64; 6]], contact: &[NodeContact]) {
    for (force, contact) in forces.iter_mut().zip(contact) {
        force[0] += contact.force[0];
        force[1] += contact.force[1];
        force[5] += contact.torque;
    }
}
