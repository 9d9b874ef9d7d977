//! Derivatives of the contact force of a node that slides at the speed of rotation, by its motion.

use super::law::ContactParameters;
use super::node::ContactNode;

/// Derivatives of the contact's force about a state without vibration, with the sign of a left-hand side: the wall's contribution
/// to stiffness and damping. Rows are the forces along u and v and the torque about e3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingTangent {
    /// Derivatives by u, v and the twist (whose column is zero) \[N/m, N\].
    pub stiffness: [[f64; 3]; 3],
    /// Derivatives by the rates of u, v and the twist \[N s/m, N s, N m s\].
    pub damping: [[f64; 3]; 3],
}

/// The tangent of [`dynamic_contact`](super::dynamic_contact) at (u, v) without any rates, at rotation speed Omega \[rad/s\]: normal
/// stiffness and damping, friction's direction that turns with the node, and the slope of the friction curve at the
/// sliding speed. `None` if the node does not touch.
pub fn sliding_tangent(
    law: &ContactParameters<f64>,
    node: &ContactNode<f64>,
    u: f64,
    v: f64,
    rotation_speed: f64,
) -> Option<SlidingTangent> {
    let radius = u.hypot(v);
    let penetration = radius - node.clearance;
    if penetration <= 0.0 {
        return None;
    }
    let (normal, tangent) = ([u / radius, v / radius], [-v / radius, u / radius]);
    let force = law.stiffness(penetration) * penetration * node.stiffness_share;
    let slope = law.elastic_slope(penetration) * node.stiffness_share;
    let damping = law.damping(penetration) * node.damping_share;
    let sliding_speed = rotation_speed * node.contact_radius;
    let curve = law.friction_of(node);
    let friction = curve.coefficient(sliding_speed);
    let friction_slope = force * curve.slope(sliding_speed);
    let (along, about) = (law.tangential_share, law.torque_share * node.contact_radius);

    // The force is -F_n (n + mu t), the torque -mu F_n R_e. F_n changes along n; n and t turn with a step along t; mu changes with
    // the sliding speed, which is the rate along t and R_e times the rate of the twist.
    let pushed = [
        normal[0] + along * friction * tangent[0],
        normal[1] + along * friction * tangent[1],
        about * friction,
    ];
    let turned = [tangent[0] - along * friction * normal[0], tangent[1] - along * friction * normal[1], 0.0];
    let rubbed = [along * tangent[0], along * tangent[1], about];
    let speed = [tangent[0], tangent[1], node.contact_radius];
    let normal = [normal[0], normal[1], 0.0];
    let tangent = [tangent[0], tangent[1], 0.0];
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| {
        std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)))
    };
    Some(SlidingTangent {
        stiffness: matrix(&|row, column| {
            slope * pushed[row] * normal[column] + force / radius * turned[row] * tangent[column]
        }),
        damping: matrix(&|row, column| {
            damping * pushed[row] * normal[column] + friction_slope * rubbed[row] * speed[column]
        }),
    })
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{ActiveEffects, preset};

    use super::*;
    use crate::force::contact::{LateralMotion, dynamic_contact};

    #[test]
    fn tangent_is_the_derivative_of_the_force() {
        let mut contact = preset("paper-200m").unwrap().contact;
        (contact.stiffness_sharpness, contact.damping_sharpness) = (3e3, 2e3);
        let law = ContactParameters::<f64>::new(&contact, &ActiveEffects::ALL);
        let node = ContactNode {
            clearance: 0.027,
            contact_radius: 0.081,
            stiffness_share: 0.7,
            damping_share: 1.9,
            friction: None,
        };
        let (u, v) = (0.0274 * 0.6, -0.0274 * 0.8);
        for rotation_speed in [12.566, 0.3, -2.0, 0.0] {
            let force = |x: [f64; 3], rate: [f64; 3]| {
                let motion = LateralMotion {
                    u: u + x[0],
                    v: v + x[1],
                    u_rate: rate[0],
                    v_rate: rate[1],
                    theta_z_rate: rate[2],
                };
                let contact = dynamic_contact(&law, &node, &motion, rotation_speed);
                [contact.force_u, contact.force_v, contact.torque_z]
            };
            let tangent = sliding_tangent(&law, &node, u, v, rotation_speed).unwrap();
            for column in 0..3 {
                let unit = |size: f64| std::array::from_fn(|i| if i == column { size } else { 0.0 });
                let zero = [0.0; 3];
                let (ahead, behind) = (force(unit(1e-7), zero), force(unit(-1e-7), zero));
                let (faster, slower) = (force(zero, unit(1e-6)), force(zero, unit(-1e-6)));
                for row in 0..3 {
                    let by_place = -(ahead[row] - behind[row]) / 2e-7;
                    let by_rate = -(faster[row] - slower[row]) / 2e-6;
                    assert!((by_place - tangent.stiffness[row][column]).abs() < 1e-4 * 7e6);
                    assert!(
                        (by_rate - tangent.damping[row][column]).abs() < 1e-4 * (7e3 + by_rate.abs()),
                        "{rotation_speed} rad/s ({row}, {column}): {by_rate} against {}",
                        tangent.damping[row][column]
                    );
                }
            }
        }
        assert!(sliding_tangent(&law, &node, 0.02, 0.0, 1.0).is_none());
    }
}
