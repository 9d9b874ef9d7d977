//! Contact along the elements of a string, four elements at a time.
//!
//! Element e joins the nodes e and e + 1, so that the elements of a group begin at the nodes of the group of the same number and end at those after
//! each of them.

use super::change::IterationChange;
use crate::force::contact::{
    ContactNode, ContactParameters, ContactSegment, Plane, SegmentCompliance, SegmentForce, SegmentMotion,
    Surface, Wall, dot,
};
use crate::math::dof::{Dofs, THETA_X, THETA_Y, U, V};
use crate::math::linalg::{Four, InverseBands, Lane, NodalField, next_lane};

/// Contact data of elements; empty if the wall acts at the nodes alone.
#[derive(Debug, Clone)]
pub(crate) struct Segments<const D: usize> {
    /// Groups of four elements; elements that do not exist have an unreachable clearance.
    groups: Vec<ContactSegment<Four>>,
    freedoms: Dofs<D>,
    /// Places of theta_x and theta_y in a node's values.
    bending: [usize; 2],
    /// Degrees of freedom that the wall does not move, as (node, degree of freedom).
    held: Vec<(usize, usize)>,
    rotation_speed: Four,
}

/// Loads of the wall along elements in one evaluation.
#[derive(Debug, Clone)]
pub(crate) struct SegmentForces {
    groups: Vec<SegmentForce<Four>>,
    /// Groups with a touching element; the loads of the others are undefined.
    touches: Vec<bool>,
}

/// A law of the wall along four elements at a time: replaces their loads, from their group and their motion. False if none touches.
pub(crate) trait LawAlong:
    Fn(&ContactSegment<Four>, usize, &SegmentMotion<Four>, &mut SegmentForce<Four>) -> bool
{
}

impl<F> LawAlong for F where
    F: Fn(&ContactSegment<Four>, usize, &SegmentMotion<Four>, &mut SegmentForce<Four>) -> bool
{
}

/// Powers \[W\] of the wall along elements, and the sum of its torques.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SegmentPower {
    pub(crate) normal: Four,
    pub(crate) friction: Four,
    /// Sum of the torques \[N m\].
    pub(crate) torque: Four,
}

impl SegmentForces {
    /// Loads of elements that do not touch.
    pub(super) fn none<const D: usize>(segments: &Segments<D>) -> Self {
        let groups = segments.groups.len();
        Self { groups: vec![SegmentForce::none(); groups], touches: vec![false; groups] }
    }

    /// The groups of elements with a touching one, with their numbers.
    pub(crate) fn touching(&self) -> impl Iterator<Item = (usize, &SegmentForce<Four>)> {
        let groups = self.groups.iter().zip(&self.touches).enumerate();
        groups.filter(|(_, (_, touches))| **touches).map(|(group, (force, _))| (group, force))
    }

    /// Takes over other loads.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.groups.copy_from_slice(&other.groups);
        self.touches.copy_from_slice(&other.touches);
    }

    /// Adds each node's share of the normal forces \[N\] to the values that `of` selects from a group of four nodes.
    pub(super) fn add_normal_forces<T>(&self, nodes: &mut [T], of: impl Fn(&mut T) -> &mut Four) {
        for (group, force) in self.touching() {
            let [upper, lower] = force.ends;
            add_to_both(nodes, group, upper, lower, &of);
        }
    }
}

impl<const D: usize> Segments<D> {
    pub(super) fn new(wall: &Wall, freedoms: Dofs<D>, held: &[[bool; D]], rotation_speed: f64) -> Self {
        let groups = wall.segments().chunks(LANES).map(|segments| {
            let lanes = |value: fn(&ContactSegment<f64>) -> f64, never: f64| {
                Four::new(std::array::from_fn(|lane| segments.get(lane).map_or(never, value)))
            };
            ContactSegment {
                length: lanes(|segment| segment.length, 1.0),
                wall: ContactNode {
                    clearance: lanes(|segment| segment.wall.clearance, f64::INFINITY),
                    contact_radius: lanes(|segment| segment.wall.contact_radius, 0.0),
                    stiffness_share: lanes(|segment| segment.wall.stiffness_share, 0.0),
                    damping_share: lanes(|segment| segment.wall.damping_share, 0.0),
                    friction: wall.law().friction_of_lanes(|lane| Some(&segments.get(lane)?.wall)),
                },
            }
        });
        let place = |dof: usize| freedoms.place(dof).unwrap_or(0);
        let held = held
            .iter()
            .enumerate()
            .flat_map(|(node, held)| (0..D).filter(|&dof| held[dof]).map(move |dof| (node, dof)));
        Self {
            groups: groups.collect(),
            bending: [place(THETA_X), place(THETA_Y)],
            held: held.collect(),
            freedoms,
            rotation_speed: Four::splat(rotation_speed),
        }
    }

    /// True if the wall does not act along elements.
    pub(super) fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Compliance of elements under loads along them, from blocks of a stage matrix' inverse.
    pub(super) fn compliance(&self, inverse: &InverseBands<D>) -> Vec<SegmentCompliance<Four>> {
        let nodes = inverse.diagonal.len();
        let is_held = |node: usize, dof: usize| self.held.contains(&(node, dof));
        // The entry of the inverse at degrees of freedom of both ends of an element, from 0 to 2 D - 1; none if held.
        let entry = |element: usize, row: usize, column: usize| {
            let (row_node, column_node) = (element + row / D, element + column / D);
            let place = (row % D, column % D);
            if column_node >= nodes || is_held(row_node, place.0) || is_held(column_node, place.1) {
                return 0.0;
            }
            if row_node == column_node {
                inverse.diagonal[row_node][place]
            } else {
                inverse.upper[row_node][place]
            }
        };
        let [turn_u, turn_v] = [self.bending[1], self.bending[0]];
        let planes = [[U, turn_u, D + U, D + turn_u], [V, turn_v, D + V, D + turn_v]];
        let signs = [[1.0; 4], [1.0, -1.0, 1.0, -1.0]];
        let pairs = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3)];
        let of_group = |group: usize| {
            let lanes = |value: &dyn Fn(usize) -> f64| {
                Four::new(std::array::from_fn(|lane| value(LANES * group + lane)))
            };
            let lateral = pairs.map(|(i, j)| {
                lanes(&|element| {
                    let of_plane = |plane: usize| {
                        signs[plane][i] * signs[plane][j] * entry(element, planes[plane][i], planes[plane][j])
                    };
                    0.5 * (of_plane(0) + of_plane(1))
                })
            });
            let twist = [(0, 0), (0, D), (D, D)].map(|(i, j)| {
                self.freedoms
                    .twist()
                    .map_or(Four::ZERO, |twist| lanes(&|element| entry(element, twist + i, twist + j)))
            });
            SegmentCompliance { lateral, twist }
        };
        (0..self.groups.len()).map(of_group).collect()
    }

    /// Writes the loads of the wall by `law`, from the group, its elements' motion and the loads so far, to `out`, and adds them to `all`.
    #[inline(always)]
    pub(super) fn add_forces(
        &self,
        law: &impl LawAlong,
        x: &NodalField<D>,
        rates: &impl Fn(usize, usize) -> Four,
        out: &mut SegmentForces,
        all: &mut NodalField<D>,
    ) {
        for group in 0..self.groups.len() {
            if self.replace(group, law, x, rates, out) {
                self.add(group, &out.groups[group], all.groups_mut());
            }
        }
    }

    /// Writes the loads of the wall by `law` to `out`.
    pub(super) fn evaluate(
        &self,
        law: &impl LawAlong,
        x: &NodalField<D>,
        rates: &impl Fn(usize, usize) -> Four,
        out: &mut SegmentForces,
    ) {
        for group in 0..self.groups.len() {
            self.replace(group, law, x, rates, out);
        }
    }

    /// Replaces the loads of the wall on a group of elements by those of `law`; false if none of them touches.
    #[inline(always)]
    fn replace(
        &self,
        group: usize,
        law: &impl LawAlong,
        x: &NodalField<D>,
        rates: &impl Fn(usize, usize) -> Four,
        out: &mut SegmentForces,
    ) -> bool {
        let segment = &self.groups[group];
        let planes = self.planes(group, &|group, dof| value(x, group, dof));
        let (force, touches) = (&mut out.groups[group], &mut out.touches[group]);
        // Most elements are far from the wall: their rates are not read.
        if !segment.may_touch(&planes) {
            *touches = false;
            return false;
        }
        if !*touches {
            *force = SegmentForce::none();
        }
        let groups = x.groups().len();
        let rates = |group: usize, dof: usize| if group < groups { rates(group, dof) } else { Four::ZERO };
        let motion = SegmentMotion {
            planes,
            rates: self.planes(group, &rates),
            twist_rates: self.twists(group, &rates),
        };
        *touches = law(segment, group, &motion, force);
        *touches
    }

    /// Adds loads on a group of elements to those of its nodes.
    #[inline(always)]
    fn add(&self, group: usize, force: &SegmentForce<Four>, all: &mut [[Four; D]]) {
        let ([turn_x, turn_y], (in_u, in_v)) = (self.bending, (force.load(0), force.load(1)));
        let mut add = |dof: usize, upper: Four, lower: Four| {
            add_to_both(all, group, upper, lower, |node: &mut [Four; D]| &mut node[dof]);
        };
        add(U, in_u[0], in_u[2]);
        add(V, in_v[0], in_v[2]);
        add(turn_y, in_u[1], in_u[3]);
        add(turn_x, -in_v[1], -in_v[3]);
        if let Some(twist) = self.freedoms.twist() {
            add(twist, force.torque[0], force.torque[1]);
        }
    }

    /// Powers of loads on groups of elements that move with `velocity`.
    #[inline(always)]
    pub(crate) fn power(&self, forces: &SegmentForces, velocity: &NodalField<D>) -> SegmentPower {
        let mut power = SegmentPower { normal: Four::ZERO, friction: Four::ZERO, torque: Four::ZERO };
        for (group, force) in forces.touching() {
            let rates = self.planes(group, &|group, dof| value(velocity, group, dof));
            let [upper, lower] = self.twists(group, &|group, dof| value(velocity, group, dof));
            for (plane, rates) in rates.iter().enumerate() {
                power.normal = power.normal + dot(&force.normal[plane], rates);
                power.friction = power.friction + dot(&force.friction[plane], rates);
            }
            power.friction = force.torque[0].mul_add(upper, force.torque[1].mul_add(lower, power.friction));
            power.torque = power.torque + (force.torque[0] + force.torque[1]);
        }
        power
    }

    /// Changes between two iterations of a solve at touching elements, as in
    /// [`WallForces::iteration_change`](super::WallForces::iteration_change).
    pub(super) fn iteration_change(
        &self,
        law: &ContactParameters<Four>,
        forces: &SegmentForces,
        x: &NodalField<D>,
        before: &NodalField<D>,
        rates: &impl Fn(usize, usize) -> Four,
        speed: f64,
    ) -> IterationChange {
        let (mut lateral, mut friction) = (Four::ZERO, Four::ZERO);
        let speed = Four::splat(speed);
        for (group, force) in forces.touching() {
            let change = |group: usize, dof: usize| value(x, group, dof) - value(before, group, dof);
            for plane in self.planes(group, &change) {
                lateral = plane[0].abs().max(plane[2].abs()).max(lateral);
            }
            let faster = |group: usize, dof: usize| change(group, dof) * speed;
            friction = self.friction_change(law, (group, force), x, rates, &faster).max(friction);
        }
        let largest = |values: Four| values.to_array().into_iter().fold(0.0, f64::max);
        IterationChange { lateral: largest(lateral), friction: largest(friction) }
    }

    /// Changes of the friction coefficient in the middle of the contact of each element for a change of velocities: by the slope of the
    /// friction curve at the sliding speed there.
    #[inline(always)]
    pub(super) fn friction_change(
        &self,
        law: &ContactParameters<Four>,
        (group, force): (usize, &SegmentForce<Four>),
        x: &NodalField<D>,
        rates: &impl Fn(usize, usize) -> Four,
        change: &impl Fn(usize, usize) -> Four,
    ) -> Four {
        let segment = &self.groups[group];
        let groups = x.groups().len();
        let rates = |group: usize, dof: usize| if group < groups { rates(group, dof) } else { Four::ZERO };
        let change = |group: usize, dof: usize| if group < groups { change(group, dof) } else { Four::ZERO };
        let planes = self.planes(group, &|group, dof| value(x, group, dof));
        let at_rates = SegmentMotion {
            planes,
            rates: self.planes(group, &rates),
            twist_rates: self.twists(group, &rates),
        };
        let at_change = SegmentMotion {
            planes,
            rates: self.planes(group, &change),
            twist_rates: self.twists(group, &change),
        };
        let surface_of = |motion: &SegmentMotion<Four>, rotation_speed: Four| {
            Surface::of(&segment.wall, &segment.motion_at(force.middle, motion), rotation_speed)
        };
        let surface = surface_of(&at_rates, self.rotation_speed);
        let faster = surface_of(&at_change, Four::ZERO).sliding_speed;
        let slope = law.friction_of(&segment.wall).slope(surface.sliding_speed);
        Four::select(surface.touches, (slope * faster).abs(), Four::ZERO)
    }

    /// Displacements or rates of a group of elements in the planes of u and v, from those by group and degree of freedom of the nodes.
    #[inline(always)]
    fn planes(&self, group: usize, values: &impl Fn(usize, usize) -> Four) -> [Plane<Four>; 2] {
        let [turn_x, turn_y] = self.bending;
        let both = |dof: usize| {
            let own = values(group, dof);
            (own, next_lane(own, values(group + 1, dof)))
        };
        let ((u_a, u_b), (v_a, v_b)) = (both(U), both(V));
        let ((x_a, x_b), (y_a, y_b)) = (both(turn_x), both(turn_y));
        [[u_a, y_a, u_b, y_b], [v_a, -x_a, v_b, -x_b]]
    }

    #[inline(always)]
    fn twists(&self, group: usize, values: &impl Fn(usize, usize) -> Four) -> [Four; 2] {
        self.freedoms.twist().map_or([Four::ZERO; 2], |twist| {
            let own = values(group, twist);
            [own, next_lane(own, values(group + 1, twist))]
        })
    }
}

/// Values of a group of nodes, zeros after the last one.
#[inline(always)]
fn value<const D: usize>(field: &NodalField<D>, group: usize, dof: usize) -> Four {
    field.padded(group)[dof]
}

/// Adds values of the upper and the lower end of each element of a group to those of the nodes.
#[inline(always)]
fn add_to_both<T>(nodes: &mut [T], group: usize, upper: Four, lower: Four, of: impl Fn(&mut T) -> &mut Four) {
    let [a, b, c, last] = lower.to_array();
    let own = of(&mut nodes[group]);
    *own = *own + (upper + Four::new([0.0, a, b, c]));
    if let Some(next) = nodes.get_mut(group + 1) {
        let next = of(next);
        *next = *next + Four::new([last, 0.0, 0.0, 0.0]);
    }
}

const LANES: usize = Four::LANES;
