//! The contact force of a resting node, with its tangent.

use super::body::BodyMotion;
use super::law::ContactParameters;
use super::node::ContactNode;

/// Action of the wall on a node at rest, with its derivatives; all zero if the node does not touch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StaticContactForce {
    /// Force along u \[N\].
    pub force_u: f64,
    /// Force along v \[N\].
    pub force_v: f64,
    /// Torque about e3 \[N m\].
    pub torque_z: f64,
    /// Force along e3 \[N\].
    pub force_w: f64,
    /// Normal force F_n = K_c P \[N\].
    pub normal: f64,
    /// Penetration P \[m\].
    pub penetration: f64,
    /// Derivatives of `force_u`, `force_v`, `torque_z` and `force_w` (rows) by u and v (columns) \[N/m, N\].
    pub tangent: [[f64; 2]; 4],
}

/// The quasi-static force (36): F_n = K_c P with [friction](ContactParameters::friction_at_rest) of a string that slides as it moves as a
/// body.
pub fn static_contact(
    law: &ContactParameters<f64>,
    node: &ContactNode<f64>,
    u: f64,
    v: f64,
    motion: BodyMotion,
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
    let friction = law.friction_at_rest(node, motion);
    let tangential = friction.about * law.tangential_share;
    let torque_arm = friction.about * law.torque_share * node.contact_radius;
    let axial = friction.along * law.tangential_share;
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
        force_w: -normal * axial,
        normal,
        penetration,
        // A step along u goes n_u along the normal and -n_v along the tangent; one along v, n_v and n_u.
        tangent: [
            [derivative(normal_u, -normal_v, 0), derivative(normal_v, normal_u, 0)],
            [derivative(normal_u, -normal_v, 1), derivative(normal_v, normal_u, 1)],
            [-slope * normal_u * torque_arm, -slope * normal_v * torque_arm],
            [-slope * normal_u * axial, -slope * normal_v * axial],
        ],
    }
}

/// The force of a wall of growing sharpness and friction on a resting node, with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SmoothContactForce {
    /// Force along u and v \[N\], torque about e3 \[N m\] and force along e3 \[N\].
    pub force: [f64; 4],
    /// Their derivatives (rows) by u and v (columns) \[N/m, N\].
    pub tangent: [[f64; 2]; 4],
    /// Their derivatives by the width of the wall \[N/m, N\].
    pub by_width: [f64; 4],
    /// Their derivatives by the share of the friction \[N, N m\].
    pub by_friction: [f64; 4],
}

/// [`static_contact`] with a share of its friction on a wall that acts over a `width` \[m\] about its position: smooth everywhere, and
/// equal to it at width 0 and share 1.
///
/// Radius and penetration are R = sqrt(r^2 + width^2) and P = (g + sqrt(g^2 + width^2)) / 2 with the gap g = R - sqrt(j0^2 + width^2): far from
/// the wall the force falls like that of a logarithmic barrier, K_c width^2 / (4 |g|).
pub fn smooth_static_contact(
    law: &ContactParameters<f64>,
    node: &ContactNode<f64>,
    [u, v]: [f64; 2],
    motion: BodyMotion,
    width: f64,
    friction_share: f64,
) -> SmoothContactForce {
    let radius = u.hypot(v).hypot(width);
    let clearance = node.clearance.hypot(width);
    let gap = radius - clearance;
    let root = gap.hypot(width);
    if radius == 0.0 || root == 0.0 {
        return SmoothContactForce::default();
    }
    // (gap + root) / 2 without the difference of nearly equal numbers.
    let penetration = if gap > 0.0 { 0.5 * (gap + root) } else { 0.5 * width * width / (root - gap) };
    let whole_friction = law.friction_at_rest(node, motion);
    let friction = friction_share * whole_friction.about;
    let tangential = friction * law.tangential_share;
    let torque_arm = law.torque_share * node.contact_radius;
    let axial = whole_friction.along * law.tangential_share;
    let (normal_u, normal_v) = (u / radius, v / radius);

    // The force is -F_n d with d = n + mu t for u and v, mu R_e for the torque, and the axial share of mu along e3.
    let normal = law.stiffness(penetration) * penetration * node.stiffness_share;
    let slope = law.elastic_slope(penetration) * node.stiffness_share;
    let direction = [
        normal_u - tangential * normal_v,
        normal_v + tangential * normal_u,
        friction * torque_arm,
        friction_share * axial,
    ];
    let change = |normal_by: f64, normal_turns: [f64; 2]| {
        let [by_u, by_v] = normal_turns;
        let turned = [by_u - tangential * by_v, by_v + tangential * by_u, 0.0, 0.0];
        std::array::from_fn(|row| -(slope * normal_by * direction[row] + normal * turned[row]))
    };
    let by_gap = penetration / root;
    let across = -normal_u * normal_v / radius;
    let by_u: [f64; 4] = change(by_gap * normal_u, [(1.0 - normal_u * normal_u) / radius, across]);
    let by_v: [f64; 4] = change(by_gap * normal_v, [across, (1.0 - normal_v * normal_v) / radius]);
    let gap_by_width = width / radius - width / clearance;
    let shrinks = -width / (radius * radius);
    SmoothContactForce {
        force: direction.map(|direction| -normal * direction),
        tangent: std::array::from_fn(|row| [by_u[row], by_v[row]]),
        by_width: change(
            0.5 * (gap_by_width + (gap * gap_by_width + width) / root),
            [normal_u * shrinks, normal_v * shrinks],
        ),
        by_friction: [
            -normal * whole_friction.about * (-normal_v * law.tangential_share),
            -normal * whole_friction.about * (normal_u * law.tangential_share),
            -normal * whole_friction.about * torque_arm,
            -normal * axial,
        ],
    }
}
