//! The right-hand side of the equations of motion: constant loads, unbalance, contact.

use crate::contact::{ContactNode, ContactParameters, LateralMotion, dynamic_contact};
use crate::linalg::{Four, Lane, Mask};
use crate::model::{DynamicSystem, Model, NodalVector};
use crate::string::MeshNode;

/// What the wall does to every node, as of one evaluation: four nodes side by side, from the second one on.
#[derive(Debug, Clone)]
pub(super) struct ContactForces {
    groups: Vec<GroupContact>,
}

/// What the wall does to four nodes; zero where one does not touch.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroupContact {
    /// The first of the nodes, from 0; those beyond the bit never touch.
    pub(super) first: usize,
    /// Penetrations \[m\] if any node touches.
    penetration: Option<Four>,
    /// Normal and friction force along u and v \[N\].
    pub(super) force: [Four; 2],
    /// Friction torque about the string \[N m\].
    pub(super) torque: Four,
    /// Signed size of the normal force over the distance from the axis \[N/m\]; positive pushes inwards.
    pub(super) normal_by_radius: Four,
    normal_force: Four,
}

/// What the wall does to one node.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct NodeContact {
    /// Signed size of the normal force \[N\]; positive pushes inwards.
    pub(super) normal_force: f64,
    /// True while the node is in the wall.
    pub(super) touching: bool,
}

impl ContactForces {
    /// No contact at any of so many nodes.
    pub(super) fn none(nodes: usize) -> Self {
        let zero = Four::splat(0.0);
        let group = |first| GroupContact {
            first,
            penetration: None,
            force: [zero; 2],
            torque: zero,
            normal_by_radius: zero,
            normal_force: zero,
        };
        Self { groups: (1..nodes).step_by(LANES).map(group).collect() }
    }

    /// The groups of which any node touches.
    pub(super) fn touching(&self) -> impl Iterator<Item = &GroupContact> {
        self.groups.iter().filter(|group| group.penetration.is_some())
    }

    /// The force on every node, from the first one on.
    pub(super) fn nodes(&self) -> impl Iterator<Item = NodeContact> {
        let nodes = self.groups.iter().flat_map(|group| {
            let penetration = group.penetration.map_or([0.0; LANES], Four::to_array);
            let normal_force = group.normal_force.to_array();
            std::array::from_fn::<_, LANES, _>(|lane| NodeContact {
                normal_force: normal_force[lane],
                touching: penetration[lane] > 0.0,
            })
        });
        std::iter::once(NodeContact::default()).chain(nodes)
    }
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

    /// Contact forces for given displacements and velocities; the clamped top node never touches.
    pub(super) fn contact_into(&self, x: &[[f64; D]], v: &[[f64; D]], out: &mut ContactForces) {
        if !self.contact {
            return;
        }
        let rotation_speed = Four::splat(self.rotation_speed);
        for (site, out) in self.sites.iter().zip(&mut out.groups) {
            let (u, v_along) = (side_by_side(x, out.first, 0), side_by_side(x, out.first, 1));
            let radius_squared = u.mul_add(u, v_along * v_along);
            // Most groups are far from the wall: their rates are not even looked at.
            if !radius_squared.greater_than(site.clearance * site.clearance).any() {
                if out.penetration.take().is_some() {
                    out.normal_force = Four::splat(0.0);
                }
                continue;
            }
            let motion = LateralMotion {
                u,
                v: v_along,
                u_rate: side_by_side(v, out.first, 0),
                v_rate: side_by_side(v, out.first, 1),
                theta_z_rate: self.twist.map_or(Four::splat(0.0), |twist| side_by_side(v, out.first, twist)),
            };
            let contact = dynamic_contact(&self.parameters, site, &motion, rotation_speed);
            let touches = contact.penetration.greater_than(Four::splat(0.0));
            let radius = Four::select(touches, site.clearance + contact.penetration, Four::splat(1.0));
            *out = GroupContact {
                first: out.first,
                penetration: touches.any().then_some(contact.penetration),
                force: [contact.force_u, contact.force_v],
                torque: contact.torque_z,
                normal_by_radius: contact.normal / radius,
                normal_force: contact.normal,
            };
        }
    }

    /// Adds contact forces to nodal forces.
    pub(super) fn add_contact(&self, nodal: &mut [[f64; D]], contact: &ContactForces) {
        for group in contact.touching() {
            let (u, v) = (group.force[0].to_array(), group.force[1].to_array());
            let torque = group.torque.to_array();
            for (lane, nodal) in nodal[group.first..].iter_mut().take(LANES).enumerate() {
                nodal[0] += u[lane];
                nodal[1] += v[lane];
                if let Some(twist) = self.twist {
                    nodal[twist] += torque[lane];
                }
            }
        }
    }
}

const LANES: usize = Four::LANES;

/// A degree of freedom of four nodes from `first` on; zero beyond the bit.
#[inline(always)]
pub(super) fn side_by_side<const D: usize>(nodes: &[[f64; D]], first: usize, dof: usize) -> Four {
    match &nodes[first..] {
        [a, b, c, d, ..] => Four::new([a[dof], b[dof], c[dof], d[dof]]),
        rest => Four::new(std::array::from_fn(|lane| rest.get(lane).map_or(0.0, |node| node[dof]))),
    }
}
