//! The right-hand side of the equations of motion: constant loads, unbalance, contact.

use crate::contact::{ContactNode, ContactParameters, LateralMotion, dynamic_contact};
use crate::linalg::{Four, Lane, Mask};
use crate::model::{DynamicSystem, Model, NodalVector, UnbalanceForce};
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
    /// Signed size of the normal force \[N\]; positive pushes inwards.
    pub(super) normal_force: Four,
    /// Distance from the axis where a node touches, 1 elsewhere \[m\].
    pub(super) radius: Four,
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
        Self { groups: (1..nodes).step_by(LANES).map(GroupContact::none).collect() }
    }

    /// The groups of which any node touches.
    pub(super) fn touching(&self) -> impl Iterator<Item = &GroupContact> {
        self.groups.iter().filter(|group| group.penetration.is_some())
    }

    /// Visits every node in turn with what the wall does to it.
    #[inline(always)]
    pub(super) fn each_node(&self, nodes: usize, mut visit: impl FnMut(usize, NodeContact)) {
        visit(0, NodeContact::default());
        for group in &self.groups {
            let penetration = group.penetration.map_or([0.0; LANES], Four::to_array);
            let normal_force = group.normal_force.to_array();
            for lane in 0..LANES.min(nodes - group.first) {
                let touching = penetration[lane] > 0.0;
                visit(group.first + lane, NodeContact { normal_force: normal_force[lane], touching });
            }
        }
    }
}

impl GroupContact {
    fn none(first: usize) -> Self {
        let zero = Four::splat(0.0);
        GroupContact {
            first,
            penetration: None,
            force: [zero; 2],
            torque: zero,
            normal_force: zero,
            radius: Four::splat(1.0),
        }
    }
}

/// Everything that pushes the string.
#[derive(Debug, Clone)]
pub(super) struct Forces<const D: usize> {
    pub(super) load: NodalVector<D>,
    unbalance: Vec<TurningForce>,
    rotation_speed: f64,
    parameters: ContactParameters<Four>,
    /// Four nodes side by side, from the second one on; places beyond the bit can never touch.
    sites: Vec<ContactNode<Four>>,
    contact: bool,
    /// Whether the last degree of freedom is the twist.
    has_twist: bool,
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
            unbalance: system.unbalance.iter().map(TurningForce::new).collect(),
            rotation_speed: system.rotation_speed,
            parameters,
            sites: sites.collect(),
            contact: effects.contact,
            has_twist: system.has_twist(),
        }
    }

    /// Adds the unbalance at `time` \[s\] to nodal forces.
    pub(super) fn add_unbalance(&self, time: f64, nodal: &mut [[f64; D]]) {
        for (node, force) in self.unbalance_at(time) {
            nodal[node][0] += force[0];
            nodal[node][1] += force[1];
        }
    }

    /// Unbalance forces (u, v) at `time` \[s\] with their nodes. The angle is reduced before the sine, so that late
    /// times lose no digits.
    pub(super) fn unbalance_at(&self, time: f64) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let angle = (self.rotation_speed * time).rem_euclid(std::f64::consts::TAU);
        let (sine, cosine) = angle.sin_cos();
        self.unbalance.iter().map(move |TurningForce { node, at_start: [u, v] }| {
            (*node, [u * cosine - v * sine, u * sine + v * cosine])
        })
    }

    /// Contact forces for given displacements and velocities, and in `all` what they come to with the `others`. The clamped top node
    /// never touches. `rates` gives the rate of a degree of freedom of four nodes from the first one on.
    pub(super) fn contact_into(
        &self,
        x: &[[f64; D]],
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ContactForces,
        others: &[[f64; D]],
        all: &mut [[f64; D]],
    ) {
        all.copy_from_slice(others);
        if !self.contact {
            return;
        }
        let rotation_speed = Four::splat(self.rotation_speed);
        for (site, out) in self.sites.iter().zip(&mut out.groups) {
            let (u, v_along) = (side_by_side(x, out.first, 0), side_by_side(x, out.first, 1));
            let radius_squared = u.mul_add(u, v_along * v_along);
            // Most groups are far from the wall: their rates are not even looked at.
            if !radius_squared.greater_than(site.clearance * site.clearance).any() {
                if out.penetration.is_some() {
                    *out = GroupContact::none(out.first);
                }
                continue;
            }
            let motion = LateralMotion {
                u,
                v: v_along,
                u_rate: rates(out.first, 0),
                v_rate: rates(out.first, 1),
                theta_z_rate: if self.has_twist { rates(out.first, D - 1) } else { Four::splat(0.0) },
            };
            let contact = dynamic_contact(&self.parameters, site, &motion, rotation_speed);
            let touches = contact.penetration.greater_than(Four::splat(0.0));
            let radius = Four::select(touches, site.clearance + contact.penetration, Four::splat(1.0));
            *out = GroupContact {
                first: out.first,
                penetration: touches.any().then_some(contact.penetration),
                force: [contact.force_u, contact.force_v],
                torque: contact.torque_z,
                normal_force: contact.normal,
                radius,
            };
            let (u, v, torque) =
                (contact.force_u.to_array(), contact.force_v.to_array(), contact.torque_z.to_array());
            for (lane, all) in all[out.first..].iter_mut().take(LANES).enumerate() {
                all[0] += u[lane];
                all[1] += v[lane];
                if self.has_twist {
                    all[D - 1] += torque[lane];
                }
            }
        }
    }
}

/// An unbalance force: its parts along u and v at the start, which turn with the string.
#[derive(Debug, Clone, Copy)]
struct TurningForce {
    node: usize,
    at_start: [f64; 2],
}

impl TurningForce {
    fn new(force: &UnbalanceForce) -> Self {
        let (sine, cosine) = force.phase.sin_cos();
        Self { node: force.node, at_start: [force.amplitude * cosine, force.amplitude * sine] }
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
