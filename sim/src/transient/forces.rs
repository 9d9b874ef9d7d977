//! The right-hand side of the equations of motion: constant loads, unbalance, contact.

use crate::contact::{
    ContactForce, ContactNode, ContactParameters, LateralMotion, Yielding, dynamic_contact, implicit_contact,
};
use crate::effect::unbalance::TurningForces;
use crate::freedom::{Freedoms, U, V};
use crate::linalg::{Block, Four, Lane, Mask, NodalField};
use crate::model::Model;
use crate::motion::DynamicSystem;

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
    /// Friction mu |F_n| \[N\], of the sign of the sliding speed.
    friction: Four,
    /// Sliding speed \[m/s\].
    sliding_speed: Four,
    /// Distance from the axis where a node touches, 1 elsewhere \[m\].
    pub(super) radius: Four,
}

/// What the wall does to one node.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct NodeContact {
    /// Signed size of the normal force \[N\]; positive pushes inwards.
    pub(super) normal_force: f64,
    /// Speed of the string's surface along the wall \[m/s\].
    pub(super) sliding_speed: f64,
    /// True while the node is in the wall.
    pub(super) touching: bool,
}

/// How every node gives way to its own contact forces in a solve: four nodes side by side.
#[derive(Debug, Clone)]
pub(super) struct Compliance {
    groups: Vec<GroupCompliance>,
}

/// How four nodes give way to their own contact forces.
#[derive(Debug, Clone, Copy)]
struct GroupCompliance {
    /// Lateral displacement by a lateral force \[m/N\].
    lateral: Four,
    /// Displacement of the surface by a friction force at it \[m/N\].
    surface: Four,
}

/// What the last sweep of a solve still changed at nodes that touch.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct SweepChange {
    /// Largest change of a lateral displacement \[m\].
    pub(super) lateral: f64,
    /// Largest change of a friction coefficient.
    pub(super) friction: f64,
}

impl SweepChange {
    /// Whether neither exceeds its bound; a change that is not a number does.
    pub(super) fn is_within(&self, bound: &SweepChange) -> bool {
        self.lateral <= bound.lateral && self.friction <= bound.friction
    }

    /// Takes in the change of another solve of the same step.
    pub(super) fn merge(&mut self, other: SweepChange) {
        self.lateral = self.lateral.max(other.lateral);
        self.friction = self.friction.max(other.friction);
    }
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

    /// Raises `peaks` to the normal forces where they are larger \[N\], four nodes side by side.
    pub(super) fn add_to_peaks(&self, peaks: &mut [Four]) {
        for (group, contact) in self.touching() {
            peaks[group] = contact.normal_force.max(peaks[group]);
        }
    }

    /// Takes over what the wall does elsewhere.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.groups.copy_from_slice(&other.groups);
    }

    /// Visits every node in turn with what the wall does to it.
    #[inline(always)]
    pub(super) fn each_node(&self, nodes: usize, mut visit: impl FnMut(usize, NodeContact)) {
        for (first, group) in (0..).step_by(LANES).zip(&self.groups) {
            let penetration = group.penetration.map_or([0.0; LANES], Four::to_array);
            let normal_force = group.normal_force.to_array();
            let sliding_speed = group.sliding_speed.to_array();
            for lane in 0..LANES.min(nodes - first) {
                let touching = penetration[lane] > 0.0;
                let [normal_force, sliding_speed] = [normal_force, sliding_speed].map(|values| values[lane]);
                visit(first + lane, NodeContact { normal_force, sliding_speed, touching });
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
            friction: zero,
            sliding_speed: zero,
            radius: Four::splat(1.0),
        }
    }
}

/// Everything that pushes the string.
#[derive(Debug, Clone)]
pub(super) struct Forces<const D: usize> {
    pub(super) load: NodalField<D>,
    pub(super) unbalance: TurningForces,
    rotation_speed: f64,
    parameters: ContactParameters<Four>,
    /// Four nodes side by side; those that are no contact sites have a clearance that nothing reaches.
    sites: Vec<ContactNode<Four>>,
    contact: bool,
    freedoms: Freedoms<D>,
}

impl<const D: usize> Forces<D> {
    pub(super) fn new(model: &Model, system: &DynamicSystem<D>) -> Self {
        let sites = model.wall.sites().chunks(LANES).map(|sites| {
            let lanes = |value: fn(&ContactNode<f64>) -> f64, never: f64| {
                let of_lane = |lane: usize| sites.get(lane)?.as_ref();
                Four::new(std::array::from_fn(|lane| of_lane(lane).map_or(never, value)))
            };
            ContactNode {
                clearance: lanes(|site| site.clearance, f64::INFINITY),
                contact_radius: lanes(|site| site.contact_radius, 0.0),
                stiffness_share: lanes(|site| site.stiffness_share, 0.0),
                damping_share: lanes(|site| site.damping_share, 0.0),
            }
        });
        Self {
            load: NodalField::from_nodes(&system.load),
            unbalance: TurningForces::new(&system.unbalance, system.rotation_speed),
            rotation_speed: system.rotation_speed,
            parameters: model.wall.law().in_lanes(),
            sites: sites.collect(),
            contact: model.effects.contact,
            freedoms: system.freedoms,
        }
    }

    /// How the nodes give way to their own contact forces, from the blocks on the diagonal of a stage matrix' inverse.
    pub(super) fn compliance(&self, inverse: &[Block<D>]) -> Compliance {
        let site = |(first, site): (usize, &ContactNode<Four>)| {
            let of_lanes = |value: &dyn Fn(&Block<D>, f64) -> f64| {
                Four::new(std::array::from_fn(|lane| {
                    inverse
                        .get(first + lane)
                        .map_or(0.0, |block| value(block, site.contact_radius.lane(lane)))
                }))
            };
            let lateral = |block: &Block<D>| 0.5 * (block[(U, U)] + block[(V, V)]);
            let twist = |block: &Block<D>| self.freedoms.twist().map_or(0.0, |twist| block[(twist, twist)]);
            GroupCompliance {
                lateral: of_lanes(&|block, _| lateral(block)),
                surface: of_lanes(&|block, radius| lateral(block) + radius * radius * twist(block)),
            }
        };
        Compliance { groups: (0..).step_by(LANES).zip(&self.sites).map(site).collect() }
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
        let law = |group: usize, motion: &LateralMotion<Four>, _: &GroupContact| {
            dynamic_contact(&self.parameters, &self.sites[group], motion, Four::splat(self.rotation_speed))
        };
        self.contact_by(law, x, rates, out, others, all);
    }

    /// What the wall does to the nodes of a motion, by the law alone.
    pub(super) fn contact_at(&self, x: &NodalField<D>, v: &NodalField<D>, out: &mut ContactForces) {
        if !self.contact {
            return;
        }
        let law = |group: usize, motion: &LateralMotion<Four>, _: &GroupContact| {
            dynamic_contact(&self.parameters, &self.sites[group], motion, Four::splat(self.rotation_speed))
        };
        let rates = |group: usize, dof: usize| v.groups()[group][dof];
        for (group, (x, out)) in x.groups().iter().zip(&mut out.groups).enumerate() {
            self.push(group, &law, x, &rates, out, &mut [Four::splat(0.0); D]);
        }
    }

    /// The same as [implicit](implicit_contact) forces, where `out` holds those that the motion was found with and the nodes give way
    /// with `compliance`, at `speed` \[1/s\] of the displacement.
    pub(super) fn implicit_contact_into(
        &self,
        (compliance, speed): (&Compliance, f64),
        x: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ContactForces,
        others: &NodalField<D>,
        all: &mut NodalField<D>,
    ) {
        let law = |group: usize, motion: &LateralMotion<Four>, before: &GroupContact| {
            let GroupCompliance { lateral, surface } = compliance.groups[group];
            let yielding = Yielding {
                lateral,
                surface,
                speed: Four::splat(speed),
                force: before.force,
                normal: before.normal_force,
                friction: before.friction,
            };
            let rotation_speed = Four::splat(self.rotation_speed);
            implicit_contact(&self.parameters, &self.sites[group], motion, rotation_speed, &yielding)
        };
        self.contact_by(law, x, rates, out, others, all);
    }

    #[inline(always)]
    fn contact_by(
        &self,
        law: impl Fn(usize, &LateralMotion<Four>, &GroupContact) -> ContactForce<Four>,
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
                self.push(group, &law, &x[group], &rates, &mut out[group], &mut forces);
            }
            all[group] = forces;
        }
    }

    /// What changes of the motion between two sweeps of a solve come to where nodes touch: `x` less `before` in displacements, times
    /// `speed` \[1/s\] in velocities.
    pub(super) fn sweep_change(
        &self,
        contact: &ContactForces,
        x: &NodalField<D>,
        before: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        speed: f64,
    ) -> SweepChange {
        let mut most = [Four::splat(0.0); 2];
        for (group, _) in contact.touching() {
            let (x, before) = (&x.groups()[group], &before.groups()[group]);
            let change: [Four; D] = std::array::from_fn(|dof| x[dof] - before[dof]);
            let lateral = change[U].abs().max(change[V].abs());
            most[0] = lateral.max(most[0]);
            let faster = change.map(|change| change * Four::splat(speed));
            let rates = std::array::from_fn(|dof| rates(group, dof));
            most[1] = self.friction_change(group, x, &rates, &faster).max(most[1]);
        }
        let [lateral, friction] = most.map(|most| most.to_array().into_iter().fold(0.0, f64::max));
        SweepChange { lateral, friction }
    }

    /// By how much friction coefficients change for a change of velocities, four nodes side by side: by the slope of the friction curve
    /// at their sliding speed.
    #[inline(always)]
    pub(super) fn friction_change(
        &self,
        group: usize,
        x: &[Four; D],
        v: &[Four; D],
        change: &[Four; D],
    ) -> Four {
        let (site, zero) = (&self.sites[group], Four::splat(0.0));
        let (along_u, along_v) = (x[U], x[V]);
        let radius_squared = along_u.mul_add(along_u, along_v * along_v);
        let touches = radius_squared.greater_than(site.clearance * site.clearance);
        let per_radius = Four::splat(1.0) / Four::select(touches, radius_squared, Four::splat(1.0)).sqrt();
        let surface_speed = |rates: &[Four; D], rotation_speed: Four| {
            let twist = self.freedoms.twist().map_or(rotation_speed, |twist| rotation_speed + rates[twist]);
            twist.mul_add(site.contact_radius, (along_u * rates[V] - along_v * rates[U]) * per_radius)
        };
        let slope = self.parameters.friction_slope(surface_speed(v, Four::splat(self.rotation_speed)));
        Four::select(touches, (slope * surface_speed(change, zero)).abs(), zero)
    }

    /// What the wall does to four nodes by a law, and in `forces` what that adds to the others.
    #[inline(always)]
    fn push(
        &self,
        group: usize,
        law: &impl Fn(usize, &LateralMotion<Four>, &GroupContact) -> ContactForce<Four>,
        x: &[Four; D],
        rates: &impl Fn(usize, usize) -> Four,
        out: &mut GroupContact,
        forces: &mut [Four; D],
    ) {
        let (site, u, v) = (&self.sites[group], x[U], x[V]);
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
            u_rate: rates(group, U),
            v_rate: rates(group, V),
            theta_z_rate: self.freedoms.twist().map_or(Four::splat(0.0), |twist| rates(group, twist)),
        };
        let contact = law(group, &motion, out);
        let touches = contact.penetration.greater_than(Four::splat(0.0));
        let radius = Four::select(touches, site.clearance + contact.penetration, Four::splat(1.0));
        *out = GroupContact {
            penetration: touches.any().then_some(contact.penetration),
            force: [contact.force_u, contact.force_v],
            torque: contact.torque_z,
            normal_force: contact.normal,
            friction: contact.friction,
            sliding_speed: contact.sliding_speed,
            radius,
        };
        forces[U] = forces[U] + contact.force_u;
        forces[V] = forces[V] + contact.force_v;
        if let Some(twist) = self.freedoms.twist() {
            forces[twist] = forces[twist] + contact.torque_z;
        }
    }
}

const LANES: usize = Four::LANES;
