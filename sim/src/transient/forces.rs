//! The right-hand side of the equations of motion: constant loads, unbalance, contact.

use crate::contact::{ContactNode, ContactParameters, LateralMotion, dynamic_contact};
use crate::linalg::{Four, Lane, Mask, NodalField};
use crate::model::{DynamicSystem, Model, UnbalanceForce};
use crate::string::MeshNode;

/// What the wall does to every node, as of one evaluation: four nodes side by side.
#[derive(Debug, Clone)]
pub(super) struct ContactForces {
    groups: Vec<GroupContact>,
}

/// What the wall does to four nodes; zero where one does not touch.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroupContact {
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
        Self { groups: vec![GroupContact::none(); nodes.div_ceil(LANES)] }
    }

    /// The groups of which any node touches, with their numbers.
    pub(super) fn touching(&self) -> impl Iterator<Item = (usize, &GroupContact)> {
        self.groups.iter().enumerate().filter(|(_, group)| group.penetration.is_some())
    }

    /// Visits every node in turn with what the wall does to it.
    #[inline(always)]
    pub(super) fn each_node(&self, nodes: usize, mut visit: impl FnMut(usize, NodeContact)) {
        for (first, group) in (0..).step_by(LANES).zip(&self.groups) {
            let penetration = group.penetration.map_or([0.0; LANES], Four::to_array);
            let normal_force = group.normal_force.to_array();
            for lane in 0..LANES.min(nodes - first) {
                let touching = penetration[lane] > 0.0;
                visit(first + lane, NodeContact { normal_force: normal_force[lane], touching });
            }
        }
    }
}

impl GroupContact {
    fn none() -> Self {
        let zero = Four::splat(0.0);
        GroupContact {
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
    pub(super) load: NodalField<D>,
    unbalance: Vec<TurningForce>,
    rotation_speed: f64,
    parameters: ContactParameters<Four>,
    /// Four nodes side by side; the clamped top node and places beyond the bit can never touch.
    sites: Vec<ContactNode<Four>>,
    contact: bool,
    /// Whether the last degree of freedom is the twist.
    has_twist: bool,
}

impl<const D: usize> Forces<D> {
    pub(super) fn new(model: &Model, system: &DynamicSystem<D>) -> Self {
        let effects = &model.effects;
        let parameters = ContactParameters::new(&model.scenario.contact, effects);
        let sites = (0..model.mesh.nodes.len()).step_by(LANES).map(|first| {
            let lanes = |value: fn(&MeshNode) -> f64, never: f64| {
                Four::new(std::array::from_fn(|lane| match first + lane {
                    0 => never,
                    node => model.mesh.nodes.get(node).map_or(never, value),
                }))
            };
            ContactNode {
                clearance: lanes(|node| node.clearance, f64::INFINITY),
                contact_radius: lanes(|node| node.contact_radius, 0.0),
                share: lanes(|node| node.contact_share, 0.0),
            }
        });
        Self {
            load: NodalField::from_nodes(&system.load),
            unbalance: system.unbalance.iter().map(TurningForce::new).collect(),
            rotation_speed: system.rotation_speed,
            parameters,
            sites: sites.collect(),
            contact: effects.contact,
            has_twist: system.has_twist(),
        }
    }

    /// Adds the unbalance at `time` \[s\] to nodal forces.
    pub(super) fn add_unbalance(&self, time: f64, nodal: &mut NodalField<D>) {
        for (node, force) in self.unbalance_at(time) {
            nodal[(node, 0)] += force[0];
            nodal[(node, 1)] += force[1];
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

    /// Contact forces for given displacements and velocities, and in `all` what they come to with the `others`. The clamped
    /// top node never touches. `rates` gives the rate of a degree of freedom of a group.
    pub(super) fn contact_into(
        &self,
        x: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ContactForces,
        others: &NodalField<D>,
        all: &mut NodalField<D>,
    ) {
        let n = self.sites.len();
        let (x, others, out) = (&x.groups()[..n], &others.groups()[..n], &mut out.groups[..n]);
        let all = &mut all.groups_mut()[..n];
        for group in 0..n {
            let mut forces = others[group];
            if self.contact {
                self.push(group, &x[group], &rates, &mut out[group], &mut forces);
            }
            all[group] = forces;
        }
    }

    /// What the wall does to four nodes, and in `forces` what that adds to the others.
    #[inline(always)]
    fn push(
        &self,
        group: usize,
        x: &[Four; D],
        rates: &impl Fn(usize, usize) -> Four,
        out: &mut GroupContact,
        forces: &mut [Four; D],
    ) {
        let (site, u, v) = (&self.sites[group], x[0], x[1]);
        let radius_squared = u.mul_add(u, v * v);
        // Most groups are far from the wall: their rates are not even looked at.
        if !radius_squared.greater_than(site.clearance * site.clearance).any() {
            if out.penetration.is_some() {
                *out = GroupContact::none();
            }
            return;
        }
        let motion = LateralMotion {
            u,
            v,
            u_rate: rates(group, 0),
            v_rate: rates(group, 1),
            theta_z_rate: if self.has_twist { rates(group, D - 1) } else { Four::splat(0.0) },
        };
        let contact = dynamic_contact(&self.parameters, site, &motion, Four::splat(self.rotation_speed));
        let touches = contact.penetration.greater_than(Four::splat(0.0));
        let radius = Four::select(touches, site.clearance + contact.penetration, Four::splat(1.0));
        *out = GroupContact {
            penetration: touches.any().then_some(contact.penetration),
            force: [contact.force_u, contact.force_v],
            torque: contact.torque_z,
            normal_force: contact.normal,
            radius,
        };
        forces[0] = forces[0] + contact.force_u;
        forces[1] = forces[1] + contact.force_v;
        if self.has_twist {
            forces[D - 1] = forces[D - 1] + contact.torque_z;
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
