//! Forces of the wall in motion.

use super::change::IterationChange;
use super::segments::{LawAlong, SegmentForces, Segments};
use crate::force::contact::{
    ContactForce, ContactNode, ContactParameters, ContactSegment, LateralMotion, SegmentCompliance,
    SegmentForce, SegmentMotion, Surface, Wall, Yielding, dynamic_contact, dynamic_segment, implicit_contact,
    implicit_segment,
};
use crate::math::dof::{Dofs, U, V};
use crate::math::linalg::{Block, Four, InverseBands, Lane, Mask, NodalField};

/// Contact forces of one evaluation: at nodes, four at a time, and along elements.
#[derive(Debug, Clone)]
pub(crate) struct ContactForces {
    groups: Vec<GroupContact>,
    pub(crate) along: SegmentForces,
    /// Motion of each node's surface, four at a time, and its share of the normal forces, if the wall acts along elements: known at the ends of
    /// steps alone.
    surfaces: Vec<NodeSurfaces>,
}

/// Motion of the surfaces of four nodes on a wall that acts along elements.
#[derive(Debug, Clone, Copy)]
struct NodeSurfaces {
    /// Penetrations \[m\]; zero for a node off the wall.
    penetration: Four,
    /// Sliding speeds \[m/s\].
    sliding_speed: Four,
    /// Shares of the normal forces along the adjoining elements \[N\].
    normal_force: Four,
    /// Friction coefficients at the sliding speeds.
    friction_coefficient: Four,
}

/// Action of the wall on four nodes; zero for a node off the wall.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodesAtWall {
    /// Penetrations \[m\].
    pub(crate) penetration: Four,
    /// Signed sizes of the normal forces \[N\]; positive pushes inwards.
    pub(crate) normal_force: Four,
    /// Sliding speeds \[m/s\].
    pub(crate) sliding_speed: Four,
    /// Powers of friction against sliding \[W\], positive.
    pub(crate) sliding_power: Four,
}

/// Action of the wall on four nodes; zero for a node that does not touch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GroupContact {
    /// Penetrations \[m\] if any node touches.
    penetration: Option<Four>,
    /// Normal and friction force along u and v \[N\].
    pub(crate) force: [Four; 2],
    /// Friction torque about the string \[N m\].
    pub(crate) torque: Four,
    /// Signed size of the normal force \[N\]; positive pushes inwards.
    pub(crate) normal_force: Four,
    /// Friction mu |F_n| \[N\], of the sign of the sliding speed.
    friction: Four,
    /// Sliding speed \[m/s\].
    sliding_speed: Four,
    /// Distance from the axis of a node that touches, 1 for others \[m\].
    pub(crate) radius: Four,
}

/// Action of the wall on one node.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct NodeContact {
    /// Signed size of the normal force \[N\]; positive pushes inwards.
    pub(crate) normal_force: f64,
    /// Speed of the string's surface along the wall \[m/s\].
    pub(crate) sliding_speed: f64,
    /// True while the node is in the wall.
    pub(crate) touching: bool,
}

/// Compliance of every node to its own contact forces in a solve, four nodes at a time.
#[derive(Debug, Clone)]
pub(crate) struct Compliance {
    groups: Vec<GroupCompliance>,
    along: Vec<SegmentCompliance<Four>>,
}

/// Compliance of four nodes to their own contact forces.
#[derive(Debug, Clone, Copy)]
struct GroupCompliance {
    /// Lateral displacement by a lateral force \[m/N\].
    lateral: Four,
    /// Displacement of the surface by a friction force at it \[m/N\].
    surface: Four,
}

impl ContactForces {
    /// Contact forces of a string that does not touch.
    pub(crate) fn none<const D: usize>(forces: &WallForces<D>) -> Self {
        let groups = forces.sites.len();
        let none = NodeSurfaces {
            penetration: Four::ZERO,
            sliding_speed: Four::ZERO,
            normal_force: Four::ZERO,
            friction_coefficient: Four::ZERO,
        };
        Self {
            groups: vec![GroupContact::none(); groups],
            along: SegmentForces::none(&forces.segments),
            surfaces: vec![none; if forces.segments.is_empty() { 0 } else { groups }],
        }
    }

    /// The groups with a touching node, with their numbers.
    pub(crate) fn touching(&self) -> impl Iterator<Item = (usize, &GroupContact)> {
        self.groups.iter().enumerate().filter(|(_, group)| group.penetration.is_some())
    }

    /// Raises `peaks` to the larger normal forces \[N\], four nodes at a time; `sums` is scratch of the same size.
    pub(crate) fn add_to_peaks(&self, peaks: &mut [Four], sums: &mut [Four]) {
        if self.surfaces.is_empty() {
            for (group, contact) in self.touching() {
                peaks[group] = contact.normal_force.max(peaks[group]);
            }
            return;
        }
        for (sum, contact) in sums.iter_mut().zip(&self.groups) {
            *sum = contact.normal_force;
        }
        self.along.add_normal_forces(sums, |sum| sum);
        for (peak, sum) in peaks.iter_mut().zip(sums) {
            *peak = sum.max(*peak);
        }
    }

    /// Takes over the contact forces of another evaluation, but for the motion of the nodes' surfaces.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.groups.copy_from_slice(&other.groups);
        self.along.copy_from(&other.along);
    }

    /// Action of the wall on a group of four nodes, at the end of a step.
    #[inline(always)]
    pub(crate) fn nodes_at_wall(&self, group: usize) -> NodesAtWall {
        let of_node = &self.groups[group];
        let at_node = NodesAtWall {
            penetration: of_node.penetration.unwrap_or(Four::ZERO),
            normal_force: of_node.normal_force,
            sliding_speed: of_node.sliding_speed,
            sliding_power: of_node.friction * of_node.sliding_speed,
        };
        let Some(surfaces) = self.surfaces.get(group) else { return at_node };
        let along = surfaces.friction_coefficient * surfaces.normal_force.abs() * surfaces.sliding_speed;
        NodesAtWall {
            penetration: surfaces.penetration,
            normal_force: at_node.normal_force + surfaces.normal_force,
            sliding_speed: surfaces.sliding_speed,
            sliding_power: at_node.sliding_power + along,
        }
    }

    /// Visits every node in turn with the action of the wall on it.
    #[inline(always)]
    pub(crate) fn each_node(&self, nodes: usize, mut visit: impl FnMut(usize, NodeContact)) {
        for index in 0..self.groups.len() {
            let first = LANES * index;
            let NodesAtWall { penetration, normal_force, sliding_speed, .. } = self.nodes_at_wall(index);
            let [penetration, sliding_speed, normal_force] =
                [penetration, sliding_speed, normal_force].map(Four::to_array);
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

/// Forces of the wall on a string that solves for D degrees of freedom a node.
#[derive(Debug, Clone)]
pub(crate) struct WallForces<const D: usize> {
    rotation_speed: f64,
    parameters: ContactParameters<Four>,
    /// Contact data, four nodes at a time; nodes that are no contact sites have an unreachable clearance.
    sites: Vec<ContactNode<Four>>,
    /// Groups with a node that the wall pushes as a node: all, or those of gauges if it acts along elements.
    pushed: Vec<bool>,
    segments: Segments<D>,
    freedoms: Dofs<D>,
}

impl<const D: usize> WallForces<D> {
    /// Forces of a wall on a string that turns with `rotation_speed` \[rad/s\]; without contact at nodes if it does not `act`.
    pub(crate) fn new(
        wall: &Wall,
        acts: bool,
        freedoms: Dofs<D>,
        held: &[[bool; D]],
        rotation_speed: f64,
    ) -> Self {
        let sites = wall.sites().chunks(LANES).map(|sites| {
            let lanes = |value: fn(&ContactNode<f64>) -> f64, never: f64| {
                let of_lane = |lane: usize| sites.get(lane)?.as_ref();
                Four::new(std::array::from_fn(|lane| of_lane(lane).map_or(never, value)))
            };
            ContactNode {
                clearance: lanes(|site| site.clearance, f64::INFINITY),
                contact_radius: lanes(|site| site.contact_radius, 0.0),
                stiffness_share: lanes(|site| site.stiffness_share, 0.0),
                damping_share: lanes(|site| site.damping_share, 0.0),
                friction: wall.law().friction_of_lanes(|lane| sites.get(lane)?.as_ref()),
            }
        });
        let sites: Vec<_> = sites.collect();
        let has_share = |site: &ContactNode<Four>| {
            (site.stiffness_share.greater_than(Four::ZERO) | site.damping_share.greater_than(Four::ZERO))
                .any()
        };
        Self {
            rotation_speed,
            parameters: wall.law().in_lanes(),
            pushed: sites.iter().map(|site| acts && has_share(site)).collect(),
            segments: Segments::new(wall, freedoms, held, rotation_speed),
            sites,
            freedoms,
        }
    }

    /// The wall along the elements.
    pub(crate) fn segments(&self) -> &Segments<D> {
        &self.segments
    }

    /// Index of the twist among the degrees of freedom; absent if it is not solved for.
    pub(crate) fn twist(&self) -> Option<usize> {
        self.freedoms.twist()
    }

    /// Radii of the nodes' surfaces at the wall \[m\], four at a time; zero for a node that cannot touch.
    pub(crate) fn contact_radii(&self) -> impl Iterator<Item = Four> {
        self.sites.iter().map(|site| site.contact_radius)
    }

    /// Compliance of nodes and elements under their own contact forces, from blocks of a stage matrix' inverse.
    pub(crate) fn compliance(&self, bands: &InverseBands<D>) -> Compliance {
        let inverse = &bands.diagonal;
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
        Compliance {
            groups: (0..).step_by(LANES).zip(&self.sites).map(site).collect(),
            along: self.segments.compliance(bands),
        }
    }

    /// Contact forces for given displacements and velocities, with their sum with the `others` in `all`. The clamped
    /// top node never touches. `rates` returns the rate of a degree of freedom of a group.
    pub(crate) fn contact_into(
        &self,
        x: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ContactForces,
        others: &NodalField<D>,
        all: &mut NodalField<D>,
    ) {
        self.contact_by(self.law(), self.law_along(), x, rates, out, others, all);
    }

    /// Computes the action of the wall on the nodes of a motion, by the law alone.
    pub(crate) fn contact_at(&self, x: &NodalField<D>, v: &NodalField<D>, out: &mut ContactForces) {
        let (law, law_along) = (self.law(), self.law_along());
        let rates = |group: usize, dof: usize| v.groups()[group][dof];
        let pushed = x.groups().iter().zip(&mut out.groups).enumerate();
        for (group, (x, out)) in pushed.filter(|&(group, _)| self.pushed[group]) {
            self.push(group, &law, x, &rates, out, &mut [Four::splat(0.0); D]);
        }
        if self.segments.is_empty() {
            return;
        }
        self.segments.evaluate(&law_along, x, &rates, &mut out.along);
        let twist = self.freedoms.twist();
        for (group, ((x, site), surfaces)) in
            x.groups().iter().zip(&self.sites).zip(&mut out.surfaces).enumerate()
        {
            let motion = lateral_motion(x, |dof| rates(group, dof), twist);
            let surface = Surface::of(site, &motion, Four::splat(self.rotation_speed));
            let touching = |value| Four::select(surface.touches, value, Four::ZERO);
            *surfaces = NodeSurfaces {
                penetration: touching(surface.penetration),
                sliding_speed: touching(surface.sliding_speed),
                normal_force: Four::ZERO,
                friction_coefficient: touching(
                    self.parameters.friction_of(site).coefficient(surface.sliding_speed),
                ),
            };
        }
        out.along.add_normal_forces(&mut out.surfaces, |surfaces| &mut surfaces.normal_force);
    }

    /// The law at nodes.
    #[inline(always)]
    fn law(&self) -> impl Fn(usize, &LateralMotion<Four>, &GroupContact) -> ContactForce<Four> {
        |group, motion, _| {
            dynamic_contact(&self.parameters, &self.sites[group], motion, Four::splat(self.rotation_speed))
        }
    }

    /// The law along elements.
    #[inline(always)]
    fn law_along(&self) -> impl LawAlong {
        |segment: &ContactSegment<Four>,
         _: usize,
         motion: &SegmentMotion<Four>,
         force: &mut SegmentForce<Four>| {
            dynamic_segment(&self.parameters, segment, motion, Four::splat(self.rotation_speed), force)
        }
    }

    /// The same with [implicit](implicit_contact) forces: on entry `out` holds the forces that the motion was found with. The nodes have the
    /// `compliance`, with velocities of `speed` \[1/s\] times the displacement.
    pub(crate) fn implicit_contact_into(
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
        let along = |segment: &ContactSegment<Four>,
                     group: usize,
                     motion: &SegmentMotion<Four>,
                     force: &mut SegmentForce<Four>| {
            let yielding = (&compliance.along[group], Four::splat(speed));
            let rotation_speed = Four::splat(self.rotation_speed);
            implicit_segment(&self.parameters, segment, motion, rotation_speed, yielding, force)
        };
        self.contact_by(law, along, x, rates, out, others, all);
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "two laws, a motion, and where the forces go")]
    fn contact_by(
        &self,
        law: impl Fn(usize, &LateralMotion<Four>, &GroupContact) -> ContactForce<Four>,
        law_along: impl LawAlong,
        x: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ContactForces,
        others: &NodalField<D>,
        all: &mut NodalField<D>,
    ) {
        let n = self.sites.len();
        {
            let (x, others, out) = (&x.groups()[..n], &others.groups()[..n], &mut out.groups[..n]);
            let (all, pushed) = (&mut all.groups_mut()[..n], &self.pushed[..n]);
            for group in 0..n {
                let mut forces = others[group];
                if pushed[group] {
                    self.push(group, &law, &x[group], &rates, &mut out[group], &mut forces);
                }
                all[group] = forces;
            }
        }
        if !self.segments.is_empty() {
            self.segments.add_forces(&law_along, x, &rates, &mut out.along, all);
        }
    }

    /// Effect at touching nodes of the changes of the motion between two contact iterations of a solve: `x` less `before` in displacements, times
    /// `speed` \[1/s\] in velocities.
    pub(crate) fn iteration_change(
        &self,
        contact: &ContactForces,
        x: &NodalField<D>,
        before: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        speed: f64,
    ) -> IterationChange {
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
        let mut change = IterationChange { lateral, friction };
        let along = &contact.along;
        change.merge(self.segments.iteration_change(&self.parameters, along, x, before, &rates, speed));
        change
    }

    /// Largest change of a friction coefficient along elements in contact for a change of velocities, four elements at a time.
    pub(crate) fn largest_friction_change_along(
        &self,
        contact: &ContactForces,
        x: &NodalField<D>,
        v: &NodalField<D>,
        change: &impl Fn(usize, usize) -> Four,
    ) -> Four {
        let rates = |group: usize, dof: usize| v.groups()[group][dof];
        contact.along.touching().fold(Four::ZERO, |most, touching| {
            self.segments.friction_change(&self.parameters, touching, x, &rates, change).max(most)
        })
    }

    /// Changes of friction coefficients for a change of velocities, four nodes at a time: by the slope of the friction curve
    /// at their sliding speed.
    #[inline(always)]
    pub(crate) fn friction_change(
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
        let sliding_speed = surface_speed(v, Four::splat(self.rotation_speed));
        let slope = self.parameters.friction_of(site).slope(sliding_speed);
        Four::select(touches, (slope * surface_speed(change, zero)).abs(), zero)
    }

    /// Computes the action of the wall on four nodes by a law, and adds it to the other forces in `forces`.
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
        // Most groups are far from the wall: their rates are not read.
        if !radius_squared.greater_than(site.clearance * site.clearance).any() {
            if out.penetration.is_some() {
                *out = GroupContact::none();
            }
            return;
        }
        let motion = lateral_motion(x, |dof| rates(group, dof), self.freedoms.twist());
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

/// Motion of four nodes for their contact, from their displacements and the rate of each degree of freedom.
#[inline(always)]
fn lateral_motion<const D: usize>(
    x: &[Four; D],
    rates: impl Fn(usize) -> Four,
    twist: Option<usize>,
) -> LateralMotion<Four> {
    LateralMotion {
        u: x[U],
        v: x[V],
        u_rate: rates(U),
        v_rate: rates(V),
        theta_z_rate: twist.map_or(Four::ZERO, rates),
    }
}

const LANES: usize = Four::LANES;
