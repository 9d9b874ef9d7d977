//! The contact force of a moving node.

use super::ContactNode;
use super::law::ContactParameters;
use crate::linalg::{Lane, Mask};

/// Displacements and rates of a node that contact asks for.
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

/// What the wall does to a node; all zero where it does not touch.
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
    /// Sliding speed v_g of the string's surface \[m/s\], (12).
    pub sliding_speed: L,
    /// Penetration P \[m\].
    pub penetration: L,
    /// dP/dt \[m/s\].
    pub penetration_rate: L,
}

/// The force of the wall on a node in motion, (10) to (14), at rotation speed Omega \[rad/s\].
#[inline(always)]
pub fn dynamic_contact<L: Lane>(
    law: &ContactParameters<L>,
    node: &ContactNode<L>,
    motion: &LateralMotion<L>,
    rotation_speed: L,
) -> ContactForce<L> {
    let LateralMotion { u, v, u_rate, v_rate, theta_z_rate } = *motion;
    let zero = L::splat(0.0);
    // Squares first: most nodes need no square root.
    let radius_squared = u.mul_add(u, v * v);
    let outside = radius_squared.greater_than(node.clearance * node.clearance);
    if !outside.any() {
        return ContactForce::none();
    }
    let radius = L::select(outside, radius_squared, L::splat(1.0)).sqrt();
    let penetration = radius - node.clearance;
    let touches = outside & penetration.greater_than(zero);
    let per_radius = L::splat(1.0) / radius;
    let (normal_u, normal_v) = (u * per_radius, v * per_radius);
    let penetration_rate = normal_u.mul_add(u_rate, normal_v * v_rate);
    let whirl_speed = normal_u.mul_add(v_rate, -(normal_v * u_rate));
    let sliding_speed = (rotation_speed + theta_z_rate).mul_add(node.contact_radius, whirl_speed);

    let whole = law.stiffness(penetration) * penetration;
    let elastic = whole * node.share;
    let normal = law.normal_force(penetration, penetration_rate, whole) * node.share;
    let friction =
        if law.has_friction { law.friction_coefficient(sliding_speed) * normal.abs() } else { zero };
    let tangential = friction * law.tangential_share;
    let torque = friction * law.torque_share * node.contact_radius;

    let where_touching = |value| L::select(touches, value, zero);
    ContactForce {
        force_u: where_touching(tangential.mul_add(normal_v, -(normal * normal_u))),
        force_v: where_touching(-normal.mul_add(normal_v, tangential * normal_u)),
        torque_z: where_touching(-torque),
        normal: where_touching(normal),
        elastic: where_touching(elastic),
        sliding_speed: where_touching(sliding_speed),
        penetration: where_touching(penetration),
        penetration_rate: where_touching(penetration_rate),
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
            sliding_speed: zero,
            penetration: zero,
            penetration_rate: zero,
        }
    }
}
