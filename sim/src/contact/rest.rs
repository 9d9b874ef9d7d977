//! The contact force of a resting node, with its tangent.

use super::ContactNode;
use super::law::ContactParameters;

/// What the wall does to a node at rest, and how that changes; all zero where it does not touch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StaticContactForce {
    /// Force along u \[N\].
    pub force_u: f64,
    /// Force along v \[N\].
    pub force_v: f64,
    /// Torque about e3 \[N m\].
    pub torque_z: f64,
    /// Normal force F_n = K_c P \[N\].
    pub normal: f64,
    /// Penetration P \[m\].
    pub penetration: f64,
    /// Derivatives of `force_u`, `force_v` and `torque_z` (rows) by u and v (columns) \[N/m, N\].
    pub tangent: [[f64; 2]; 3],
}

/// The quasi-static force (36): F_n = K_c P with friction mu_s as if the string slid in the sense of its
/// rotation Omega \[rad/s\]. Without rotation there is no sense to take, so there is no friction.
pub fn static_contact(
    law: &ContactParameters<f64>,
    node: &ContactNode<f64>,
    u: f64,
    v: f64,
    rotation_speed: f64,
) -> StaticContactForce {
    let radius_squared = u.mul_add(u, v * v);
    if radius_squared <= node.clearance * node.clearance {
        return StaticContactForce::default();
    }
    let radius = radius_squared.sqrt();
    let penetration = radius - node.clearance;
    if penetration <= 0.0 {
        return StaticContactForce::default();
    }
    let sense = if rotation_speed == 0.0 { 0.0 } else { rotation_speed.signum() };
    let friction = sense * law.static_friction();
    let tangential = friction * law.tangential_share;
    let torque_arm = friction * law.torque_share * node.contact_radius;
    let (normal_u, normal_v) = (u / radius, v / radius);

    // The force is -F_n d with the direction d = n + mu t. d turns with n; F_n changes along n only.
    let normal = law.stiffness(penetration) * penetration * node.stiffness_share;
    let slope = law.elastic_slope(penetration) * node.stiffness_share;
    let direction = [normal_u - tangential * normal_v, normal_v + tangential * normal_u];
    let turned = [-normal_v - tangential * normal_u, normal_u - tangential * normal_v];
    let derivative = |along: f64, across: f64, row: usize| {
        -(slope * along * direction[row] + normal / radius * across * turned[row])
    };
    StaticContactForce {
        force_u: -normal * direction[0],
        force_v: -normal * direction[1],
        torque_z: -normal * torque_arm,
        normal,
        penetration,
        // A step along u goes n_u along the normal and -n_v along the tangent; one along v, n_v and n_u.
        tangent: [
            [derivative(normal_u, -normal_v, 0), derivative(normal_v, normal_u, 0)],
            [derivative(normal_u, -normal_v, 1), derivative(normal_v, normal_u, 1)],
            [-slope * normal_u * torque_arm, -slope * normal_v * torque_arm],
        ],
    }
}
