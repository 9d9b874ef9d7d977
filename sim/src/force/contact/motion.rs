//! The contact force of a moving node.

use super::law::ContactParameters;
use super::node::ContactNode;
use crate::math::linalg::{Lane, Mask};

/// Displacements and rates of a node that contact depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralMotion<L> {
    /// u \[m\].
    pub u: L,
    /// v \[m\].
    pub v: L,
    /// du/dt \[m/s\].
    pub u_rate: L,
    /// dv/dt \[m/s\].
    pub v_rate: L,
    /// d(theta_z)/dt \[rad/s\], without the imposed rotation.
    pub theta_z_rate: L,
}

/// Action of the wall on a node; all zero if it does not touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce<L> {
    /// Force along u \[N\].
    pub force_u: L,
    /// Force along v \[N\].
    pub force_v: L,
    /// Torque about e3 \[N m\].
    pub torque_z: L,
    /// Normal force F_n \[N\], positive off the wall.
    pub normal: L,
    /// Elastic part K_c P of the normal force \[N\]; the rest, times the penetration rate, is dissipated.
    pub elastic: L,
    /// Friction mu |F_n| \[N\], of the sign of the sliding speed.
    pub friction: L,
    /// Sliding speed v_g of the string's surface \[m/s\], (12).
    pub sliding_speed: L,
    /// Penetration P \[m\].
    pub penetration: L,
    /// dP/dt \[m/s\].
    pub penetration_rate: L,
}

/// Compliance of a node's motion at the end of a solve to its own contact force, which makes the force implicit at the node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yielding<L> {
    /// Lateral displacement by a lateral force \[m/N\].
    pub lateral: L,
    /// Displacement of the surface at the contact radius by a friction force there, twist included \[m/N\].
    pub surface: L,
    /// Speed by displacement \[1/s\].
    pub speed: L,
    /// Force along u and v that the motion was found with \[N\].
    pub force: [L; 2],
    /// Normal force that the motion was found with \[N\].
    pub normal: L,
    /// Friction that the motion was found with \[N\], of the sign of the sliding speed.
    pub friction: L,
}

/// The force of the wall on a node in motion, (10) to (14), at rotation speed Omega \[rad/s\].
#[inline(always)]
pub fn dynamic_contact<L: Lane>(
    law: &ContactParameters<L>,
    node: &ContactNode<L>,
    motion: &LateralMotion<L>,
    rotation_speed: L,
) -> ContactForce<L> {
    contact_force(law, node, motion, rotation_speed, |normal, _| normal, |sliding_speed, _| sliding_speed)
}

/// Displacement along the wall of a node under its own normal force, over its distance from the axis, from which on the direction of
/// that force is implicit too. If the direction is taken from the contact iteration before, an error of its angle is multiplied by this ratio;
/// from one on, contact iterations diverge.
const TURNS_WITH_ITS_FORCE: f64 = 0.5;

/// The force of the same law that agrees with the motion that it causes, as far as the node's own force moves it: in the
/// normal direction by one step of Newton's method, along the surface by a solution of the whole friction curve. A node whose clearance is so
/// small that its own force turns it about the axis is first moved to its place of rest in that force. If the motion
/// agrees with the force that it was found with, the force is that of [`dynamic_contact`].
#[inline(always)]
pub fn implicit_contact<L: Lane>(
    law: &ContactParameters<L>,
    node: &ContactNode<L>,
    motion: &LateralMotion<L>,
    rotation_speed: L,
    yielding: &Yielding<L>,
) -> ContactForce<L> {
    // The terms g |F| and the distance j0 + |F| / K, both times K.
    let (stiffness, normal) = (law.largest_stiffness() * node.stiffness_share, yielding.normal.abs());
    let distance = stiffness.mul_add(node.clearance, normal);
    let turns =
        (stiffness * yielding.lateral * normal).greater_than(L::splat(TURNS_WITH_ITS_FORCE) * distance);
    if turns.any() {
        let (settled, normal) = settle(law, node, motion, yielding, turns);
        return implicit_force(law, node, &settled, rotation_speed, &Yielding { normal, ..*yielding });
    }
    implicit_force(law, node, motion, rotation_speed, yielding)
}

/// Places at which nodes that turn with their own force come to rest in it, with their normal force; other nodes stay unchanged.
///
/// Without its force F n + F_t t, F along the normal n = x/r and friction F_t along the tangent t, such a node would be at
/// `y = x + g (F n + F_t t)`. It comes to r along the new normal with `y = (r + g F(r)) n + g F_t t`, which yields both: n by the
/// direction of y, r by its length, here with the wall's whole stiffness.
#[inline(always)]
fn settle<L: Lane>(
    law: &ContactParameters<L>,
    node: &ContactNode<L>,
    motion: &LateralMotion<L>,
    yielding: &Yielding<L>,
    turns: L::Mask,
) -> (LateralMotion<L>, L) {
    let LateralMotion { u, v, u_rate, v_rate, theta_z_rate } = *motion;
    let Yielding { lateral, speed, force: [force_u, force_v], friction, .. } = *yielding;
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (free_u, free_v) = (u - lateral * force_u, v - lateral * force_v);
    let squared = free_u.mul_add(free_u, free_v * free_v);
    let somewhere = turns & squared.greater_than(zero);
    let distance = L::select(somewhere, squared, one).sqrt();
    // Friction cannot turn the normal beyond the direction of the force on the node.
    let across = lateral * friction * law.tangential_share / distance;
    let across = across.abs().min(L::splat(LARGEST_TURN)).copysign(across);
    let along = (one - across * across).sqrt();
    let (unit_u, unit_v) = (free_u / distance, free_v / distance);
    let (normal_u, normal_v) =
        (along.mul_add(unit_u, across * unit_v), along.mul_add(unit_v, -(across * unit_u)));
    let stiffness = law.largest_stiffness() * node.stiffness_share;
    let pushed = (along * distance - node.clearance).max(zero) / stiffness.mul_add(lateral, one);
    let radius = (along * distance).min(node.clearance + pushed);
    let (settled_u, settled_v) = (normal_u * radius, normal_v * radius);
    let settled = LateralMotion {
        u: L::select(somewhere, settled_u, u),
        v: L::select(somewhere, settled_v, v),
        u_rate: L::select(somewhere, speed.mul_add(settled_u - u, u_rate), u_rate),
        v_rate: L::select(somewhere, speed.mul_add(settled_v - v, v_rate), v_rate),
        theta_z_rate,
    };
    (settled, L::select(somewhere, stiffness * pushed, yielding.normal))
}

/// Sine of the largest angle by which friction is taken to turn the normal of a node that [settles](settle): short of a right angle, beyond
/// which nothing would press the node on the wall. The exact value is without a derivation; contact iterations correct its effect.
const LARGEST_TURN: f64 = 0.9;

#[inline(always)]
fn implicit_force<L: Lane>(
    law: &ContactParameters<L>,
    node: &ContactNode<L>,
    motion: &LateralMotion<L>,
    rotation_speed: L,
    yielding: &Yielding<L>,
) -> ContactForce<L> {
    let Yielding { lateral, surface, speed, normal: normal_before, friction: friction_before, .. } =
        *yielding;
    let normal = |normal: L, penetration: L| {
        let stiffness = law.stiffness(penetration) * node.stiffness_share;
        let slope = (law.damping(penetration) * node.damping_share).mul_add(speed, stiffness) * lateral;
        law.limited(slope.mul_add(normal_before, normal) / (slope + L::splat(1.0)))
    };
    let friction_speed = |sliding_speed: L, normal: L| {
        let curve = law.friction_of(node);
        if !sliding_speed.abs().less_than(curve.fast_sliding()).any() {
            return sliding_speed;
        }
        let response = surface * speed;
        curve.opposed_speed(response.mul_add(friction_before, sliding_speed), response * normal)
    };
    contact_force(law, node, motion, rotation_speed, normal, friction_speed)
}

/// The force with a normal force `normal_force(F_n, P)` and friction at the sliding speed `friction_speed(v_g, |F_n|)`.
#[inline(always)]
fn contact_force<L: Lane>(
    law: &ContactParameters<L>,
    node: &ContactNode<L>,
    motion: &LateralMotion<L>,
    rotation_speed: L,
    normal_force: impl FnOnce(L, L) -> L,
    friction_speed: impl FnOnce(L, L) -> L,
) -> ContactForce<L> {
    let zero = L::splat(0.0);
    // Squares first: most nodes need no square root.
    if !is_outside(node, motion).any() {
        return ContactForce::none();
    }
    let Surface { touches, normal: [normal_u, normal_v], penetration, penetration_rate, sliding_speed } =
        Surface::of(node, motion, rotation_speed);

    let elastic = law.stiffness(penetration) * penetration * node.stiffness_share;
    let damping = law.damping(penetration) * node.damping_share;
    let normal = law.limited(damping.mul_add(penetration_rate, elastic));
    let normal = normal_force(normal, penetration);
    let friction = if law.has_friction {
        law.friction_of(node).coefficient(friction_speed(sliding_speed, normal.abs())) * normal.abs()
    } else {
        zero
    };
    let tangential = friction * law.tangential_share;
    let torque = friction * law.torque_share * node.contact_radius;

    let where_touching = |value| L::select(touches, value, zero);
    ContactForce {
        force_u: where_touching(tangential.mul_add(normal_v, -(normal * normal_u))),
        force_v: where_touching(-normal.mul_add(normal_v, tangential * normal_u)),
        torque_z: where_touching(-torque),
        normal: where_touching(normal),
        elastic: where_touching(elastic),
        friction: where_touching(friction),
        sliding_speed: where_touching(sliding_speed),
        penetration: where_touching(penetration),
        penetration_rate: where_touching(penetration_rate),
    }
}

/// Nodes farther from the axis than their clearance.
#[inline(always)]
fn is_outside<L: Lane>(node: &ContactNode<L>, motion: &LateralMotion<L>) -> L::Mask {
    let LateralMotion { u, v, .. } = *motion;
    u.mul_add(u, v * v).greater_than(node.clearance * node.clearance)
}

/// Motion of the string's surface along and into the wall.
#[derive(Debug, Clone, Copy)]
pub struct Surface<L: Lane> {
    /// Lanes in the wall; the other values are valid off the axis.
    pub touches: L::Mask,
    /// Unit vector (u, v) from the axis.
    pub normal: [L; 2],
    /// Penetration P \[m\].
    pub penetration: L,
    /// dP/dt \[m/s\].
    pub penetration_rate: L,
    /// Sliding speed v_g \[m/s\], (12).
    pub sliding_speed: L,
}

impl<L: Lane> Surface<L> {
    /// The surface at a node, or at a point of an element, at rotation speed Omega \[rad/s\].
    #[inline(always)]
    pub fn of(node: &ContactNode<L>, motion: &LateralMotion<L>, rotation_speed: L) -> Self {
        let LateralMotion { u, v, u_rate, v_rate, theta_z_rate } = *motion;
        let (zero, squared) = (L::splat(0.0), u.mul_add(u, v * v));
        // Short of the wall too: an element in the wall carries its force at points of a parabola that stray from it by a little.
        let radius = L::select(squared.greater_than(zero), squared, L::splat(1.0)).sqrt();
        let penetration = radius - node.clearance;
        let touches = is_outside(node, motion) & penetration.greater_than(zero);
        let per_radius = L::splat(1.0) / radius;
        let [normal_u, normal_v] = [u * per_radius, v * per_radius];
        let whirl_speed = normal_u.mul_add(v_rate, -(normal_v * u_rate));
        Self {
            touches,
            normal: [normal_u, normal_v],
            penetration,
            penetration_rate: normal_u.mul_add(u_rate, normal_v * v_rate),
            sliding_speed: (rotation_speed + theta_z_rate).mul_add(node.contact_radius, whirl_speed),
        }
    }
}

impl<L: Lane> ContactForce<L> {
    /// No contact.
    pub fn none() -> Self {
        let zero = L::splat(0.0);
        ContactForce {
            force_u: zero,
            force_v: zero,
            torque_z: zero,
            normal: zero,
            elastic: zero,
            friction: zero,
            sliding_speed: zero,
            penetration: zero,
            penetration_rate: zero,
        }
    }
}
