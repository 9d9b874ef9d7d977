use std::f64::consts::{PI, TAU};

use drillsweep_scenario::{ActiveEffects, Adhesion, ContactLaw, StartFriction, WallLaw};

use super::*;
use crate::math::dof::{DOFS, THETA_X, THETA_Y, THETA_Z, U, V, W};
use crate::math::linalg::{Four, Lane};
use crate::string::beam::{ElementMatrix, ElementVector, Shape};

/// The law of the paper's 200 m base case (Table 5).
const BASE: ContactLaw = ContactLaw {
    law: WallLaw::PerNode,
    stiffness: 1e7,
    damping: 1e4,
    stiffness_per_length: None,
    damping_per_length: None,
    stiffness_sharpness: 7e7,
    damping_sharpness: 7e4,
    adhesion: Adhesion::Allowed,
    static_friction: 0.3,
    dynamic_friction: 0.2,
    friction_reference_speed: 0.033,
};

/// A law soft enough that differences and quadratures resolve its arctangents.
const SOFT: ContactLaw = ContactLaw { stiffness_sharpness: 1e4, damping_sharpness: 3e3, ..BASE };

const FRICTIONLESS: ContactLaw = ContactLaw { static_friction: 0.0, dynamic_friction: 0.0, ..BASE };

const NODE: ContactNode<f64> = ContactNode {
    clearance: 0.04,
    contact_radius: 0.0635,
    stiffness_share: 1.0,
    damping_share: 1.0,
    friction: None,
};

/// Rotation at a speed \[rad/s\].
fn turning(rotation_speed: f64) -> BodyMotion {
    BodyMotion::rotation(rotation_speed)
}

fn parameters(law: &ContactLaw) -> ContactParameters<f64> {
    ContactParameters::new(law, &ActiveEffects::ALL)
}

/// K_c P by (11) with the system's arctangent.
fn elastic_force(law: &ContactLaw, p: f64) -> f64 {
    0.5 * law.stiffness * (2.0 / PI * (PI * law.stiffness_sharpness * p).atan() + 1.0) * p
}

/// C_c by (11) with the system's arctangent.
fn damping(law: &ContactLaw, p: f64) -> f64 {
    0.5 * law.damping * (2.0 / PI * (PI * law.damping_sharpness * p).atan() + 1.0)
}

fn assert_close(actual: f64, expected: f64, relative: f64) {
    assert!((actual - expected).abs() <= relative * expected.abs(), "{actual:e} instead of {expected:e}");
}

#[test]
fn stiffness_and_damping_rise_by_their_arctangents() {
    let law = parameters(&BASE);
    // atan(1) = pi/4 at P = 1 / (pi lambda): three quarters of the limit.
    assert_close(law.stiffness(1.0 / (PI * 7e7)), 7.5e6, 1e-14);
    assert_close(law.damping(1.0 / (PI * 7e4)), 7.5e3, 1e-14);
    // atan(sqrt 3) = pi/3: five sixths.
    assert_close(law.stiffness(3f64.sqrt() / (PI * 7e7)), 1e7 * 5.0 / 6.0, 1e-14);
    // Half at the wall, all of it deep inside: 1 - atan-tail 1 / (pi y).
    assert_close(law.stiffness(0.0), 5e6, 1e-15);
    assert_close(law.damping(0.0), 5e3, 1e-15);
    let y = PI * 7e7 * 5e-5;
    assert_close(law.stiffness(5e-5), 1e7 * (1.0 - 1.0 / (PI * y)), 1e-12);
}

#[test]
fn the_damper_pulls_only_with_adhesion() {
    let leaving = LateralMotion { u: 0.0401, v: 0.0, u_rate: -1.0, v_rate: 0.0, theta_z_rate: 0.0 };
    // K_c P = 1 kN less C_c = 10 kN at 1 m/s.
    let expected = elastic_force(&BASE, 1e-4) - damping(&BASE, 1e-4);
    let pulled = dynamic_contact(&parameters(&FRICTIONLESS), &NODE, &leaving, 0.0);
    assert!(expected < -8e3);
    assert_close(pulled.normal, expected, 1e-12);
    assert_close(pulled.force_u, -expected, 1e-12);

    let clamped = ContactLaw { adhesion: Adhesion::None, ..BASE };
    let free = dynamic_contact(&parameters(&clamped), &NODE, &leaving, 12.0);
    assert_eq!((free.normal, free.force_u, free.force_v, free.torque_z), (0.0, 0.0, 0.0, 0.0));
    let arriving = LateralMotion { u_rate: 1.0, ..leaving };
    let pushed = dynamic_contact(&parameters(&clamped), &NODE, &arriving, 0.0);
    assert_close(pushed.normal, elastic_force(&BASE, 1e-4) + damping(&BASE, 1e-4), 1e-12);
}

#[test]
fn a_node_has_its_own_shares_of_stiffness_and_damping() {
    let motion = LateralMotion { u: 0.0402, v: 0.0, u_rate: 0.3, v_rate: 0.0, theta_z_rate: 0.0 };
    let node = ContactNode { stiffness_share: 0.3, damping_share: 2.0, ..NODE };
    let force = dynamic_contact(&parameters(&FRICTIONLESS), &node, &motion, 12.0);
    let (elastic, damped) = (0.3 * elastic_force(&BASE, 2e-4), 2.0 * damping(&BASE, 2e-4) * 0.3);
    assert_close(force.elastic, elastic, 1e-11);
    assert_close(force.normal, elastic + damped, 1e-11);
    let at_rest = static_contact(&parameters(&FRICTIONLESS), &node, 0.0402, 0.0, turning(12.0));
    assert_close(at_rest.normal, elastic, 1e-11);
    // A length may have damping if a node has none: shares are then of 1 N s/m.
    let undamped = ContactLaw { law: WallLaw::PerLength, damping: 0.0, ..FRICTIONLESS };
    let node = ContactNode { stiffness_share: 0.3, damping_share: 2e4, ..NODE };
    let force = dynamic_contact(&parameters(&undamped), &node, &motion, 12.0);
    assert_close(force.normal, elastic + damped, 1e-11);
}

/// Friction uses |F_n|, as in (12), so a pulling wall still brakes.
#[test]
fn friction_of_a_pulling_wall_still_brakes() {
    let leaving = LateralMotion { u: 0.0401, v: 0.0, u_rate: -1.0, v_rate: 0.0, theta_z_rate: 0.0 };
    let force = dynamic_contact(&parameters(&BASE), &NODE, &leaving, 12.0);
    assert!(force.normal < 0.0 && force.force_v < 0.0 && force.torque_z < 0.0);
}

#[test]
fn the_wall_pushes_back_and_brakes_at_eight_angles_and_both_senses() {
    let law = parameters(&BASE);
    let (radius, rate) = (0.0402, 0.3);
    let penetration = radius - NODE.clearance;
    let normal = elastic_force(&BASE, penetration) + damping(&BASE, penetration) * rate;
    for eighth in 0..8 {
        let (sin, cos) = (f64::from(eighth) * TAU / 8.0 + 0.1).sin_cos();
        for (rotation_speed, whirl_speed) in [(12.6, 0.05), (-12.6, 0.05), (12.6, -3.0), (-12.6, -0.05)] {
            let motion = LateralMotion {
                u: radius * cos,
                v: radius * sin,
                u_rate: rate * cos - whirl_speed * sin,
                v_rate: rate * sin + whirl_speed * cos,
                theta_z_rate: 0.4,
            };
            let force = dynamic_contact(&law, &NODE, &motion, rotation_speed);
            let sliding = whirl_speed + (rotation_speed + 0.4) * NODE.contact_radius;
            let friction = law.friction.coefficient(sliding) * normal;
            assert!(friction * sliding > 0.0);
            assert_close(force.penetration, penetration, 1e-12);
            assert_close(force.penetration_rate, rate, 1e-13);
            assert_close(force.sliding_speed, sliding, 1e-12);
            assert_close(force.normal, normal, 1e-12);
            assert_close(force.force_u, -normal * cos + friction * sin, 1e-11);
            assert_close(force.force_v, -normal * sin - friction * cos, 1e-11);
            assert_close(force.torque_z, -friction * NODE.contact_radius, 1e-11);
        }
    }
}

#[test]
fn there_is_no_force_short_of_the_wall() {
    let law = parameters(&BASE);
    let motion = LateralMotion { u: 0.0, v: 0.0, u_rate: 1.0, v_rate: -1.0, theta_z_rate: 0.0 };
    for radius in [0.0, 0.02, NODE.clearance] {
        let at = LateralMotion { u: radius, ..motion };
        assert_eq!(dynamic_contact(&law, &NODE, &at, 12.0), ContactForce::none());
        assert_eq!(static_contact(&law, &NODE, radius, 0.0, turning(12.0)), StaticContactForce::default());
    }
    let no_clearance = ContactNode { clearance: 0.0, ..NODE };
    assert_eq!(dynamic_contact(&law, &no_clearance, &motion, 12.0), ContactForce::none());
    assert_eq!(static_contact(&law, &no_clearance, 0.0, 0.0, turning(12.0)), StaticContactForce::default());
}

#[test]
fn friction_peaks_at_mu_s_falls_to_mu_d_and_starts_with_slope_one_over_v_ref() {
    for (mu_s, mu_d, v_ref) in [(0.3, 0.2, 0.033), (0.5, 0.1, 0.001), (0.25, 0.24, 0.2)] {
        let scenario = ContactLaw {
            static_friction: mu_s,
            dynamic_friction: mu_d,
            friction_reference_speed: v_ref,
            ..BASE
        };
        let law = parameters(&scenario);
        let mu = |v: f64| law.friction.coefficient(v);
        let xi = (1.0 - mu_d / mu_s).sqrt();
        let peak = 2.0 * v_ref * mu_d / (xi * (1.0 - xi));
        assert_close(mu(peak), mu_s, 1e-14);
        assert!((1..1000).all(|i| mu(peak * f64::from(i) / 100.0) <= mu_s * (1.0 + 1e-14)));
        assert!(mu(0.9 * peak) < mu_s && mu(1.1 * peak) < mu_s);
        // The remainder of the peak falls as 1/v, here by a factor of up to 32.
        assert_close(mu(1e13 * v_ref), mu_d, 1e-11);
        // Second-order one-sided: the law is odd, with a kink in its second derivative at rest.
        let step = 1e-6 * v_ref;
        assert_close((4.0 * mu(step) - mu(2.0 * step)) / (2.0 * step), 1.0 / v_ref, 1e-10);
        assert_eq!(mu(0.0), 0.0);
        assert_eq!(mu(-0.7 * peak), -mu(0.7 * peak));
    }
}

/// The curve (14) peaks at 2 v_ref mu_d / (xi (1 - xi)), 0.054 m/s in the base case.
#[test]
fn friction_of_the_base_case_peaks_at_the_published_speed() {
    let law = parameters(&BASE);
    let peak = (1..2000)
        .map(|i| f64::from(i) * 1e-4)
        .max_by(|a, b| law.friction.coefficient(*a).total_cmp(&law.friction.coefficient(*b)));
    assert!((peak.expect("speeds") - 0.054).abs() < 5e-4);
}

#[test]
fn friction_limits_without_falling_branch_without_dynamic_part_and_without_friction() {
    let of = |static_friction, dynamic_friction| {
        parameters(&ContactLaw { static_friction, dynamic_friction, ..BASE })
    };
    // mu_s = mu_d: mu = mu_s [1 - 1/(1 + a v)^2], a = 1/(2 v_ref mu_d), rises without a peak.
    let equal = of(0.3, 0.3);
    let a = 1.0 / (2.0 * 0.033 * 0.3);
    for v in [0.001, 0.1, 10.0] {
        assert_close(equal.friction.coefficient(v), 0.3 * (1.0 - (1.0 + a * v).powi(-2)), 1e-12);
    }
    // mu_d = 0: mu = (v / v_ref) / (1 + a v)^2, a = 1/(4 v_ref mu_s), peaks at mu_s for a v = 1 and dies out.
    let falling = of(0.3, 0.0);
    assert_close(falling.friction.coefficient(4.0 * 0.033 * 0.3), 0.3, 1e-14);
    assert!(falling.friction.coefficient(1e6) < 1e-6);
    let none = of(0.0, 0.0);
    assert!([-1.0, 0.0, 1.0, 1e6].iter().all(|v| none.friction.coefficient(*v) == 0.0));
}

#[test]
fn friction_force_and_friction_torque_switch_off_separately() {
    let motion = LateralMotion { u: 0.0402, v: 0.0, u_rate: 0.0, v_rate: 0.1, theta_z_rate: 0.0 };
    let with = |friction, friction_torque| {
        let law =
            ContactParameters::new(&BASE, &ActiveEffects { friction, friction_torque, ..ActiveEffects::ALL });
        let moving = dynamic_contact(&law, &NODE, &motion, 12.0);
        let resting = static_contact(&law, &NODE, 0.0402, 0.0, turning(12.0));
        [moving.force_v, moving.torque_z, resting.force_v, resting.torque_z].map(|force| force != 0.0)
    };
    assert_eq!(with(true, true), [true, true, true, true]);
    assert_eq!(with(false, true), [false, true, false, true]);
    assert_eq!(with(true, false), [true, false, true, false]);
    assert_eq!(with(false, false), [false, false, false, false]);
}

#[test]
fn static_friction_acts_in_the_sense_of_rotation() {
    let law = parameters(&BASE);
    let (sin, cos) = 0.7f64.sin_cos();
    let force = |speed| static_contact(&law, &NODE, 0.0402 * cos, 0.0402 * sin, turning(speed));
    let normal = elastic_force(&BASE, 0.0402 - 0.04);
    for (speed, friction) in [(12.6, 0.3), (-12.6, -0.3), (0.0, 0.0)] {
        let force = force(speed);
        assert_close(force.normal, normal, 1e-11);
        assert_close(force.force_u, normal * (-cos + friction * sin), 1e-11);
        assert_close(force.force_v, normal * (-sin - friction * cos), 1e-11);
        assert_close(force.torque_z, -friction * normal * NODE.contact_radius, 1e-11);
    }
}

#[test]
fn friction_of_the_sliding_start_is_that_of_the_curve_at_the_speed_of_the_surface() {
    let law = parameters(&BASE).with_friction_at_rest(StartFriction::Sliding);
    // (14) as printed.
    let xi = (1.0f64 - 0.2 / 0.3).sqrt();
    let decay = (1.0 - xi) / (2.0 * 0.033 * 0.2);
    let printed = |v: f64| {
        let fade = 1.0 + decay * v.abs();
        v / (2.0 * 0.033) * ((1.0 - xi) / fade + (1.0 + xi) / (fade * fade))
    };
    let (u, v) = (0.0402 * 0.7f64.cos(), 0.0402 * 0.7f64.sin());
    for speed in [12.6, -12.6, 0.3, 0.0] {
        let force = static_contact(&law, &NODE, u, v, turning(speed));
        let friction = printed(speed * NODE.contact_radius) * force.normal;
        assert_close(force.torque_z, -friction * NODE.contact_radius, 1e-12);
        // The same force as of a node that the turning frame carries along the wall.
        let still = LateralMotion { u, v, u_rate: 0.0, v_rate: 0.0, theta_z_rate: 0.0 };
        let moving = dynamic_contact(&law, &NODE, &still, speed);
        assert_close(force.force_u, moving.force_u, 1e-12);
        assert_close(force.force_v, moving.force_v, 1e-12);
    }
}

#[test]
fn a_share_of_the_friction_scales_friction_alone() {
    for start in [StartFriction::BreakAway, StartFriction::Sliding] {
        let whole = parameters(&BASE).with_friction_at_rest(start);
        let force = |law| static_contact(&law, &NODE, 0.0402, 0.0, turning(12.6));
        let (of_whole, of_share) = (force(whole), force(whole.with_friction_share(0.25)));
        assert_close(of_share.force_u, of_whole.force_u, 1e-15);
        assert_close(of_share.force_v, 0.25 * of_whole.force_v, 1e-15);
        assert_close(of_share.torque_z, 0.25 * of_whole.torque_z, 1e-15);
    }
}

/// The error of a central difference falls by four with half the step, until rounding takes over.
#[test]
fn static_tangent_is_the_derivative_to_second_order() {
    let law = parameters(&SOFT);
    for (angle, rotation_speed) in [(0.3f64, 12.6), (2.0, -12.6), (4.4, 12.6), (5.5, 0.0)] {
        let (u, v) = (0.04003 * angle.cos(), 0.04003 * angle.sin());
        let at = |u, v| {
            let force = static_contact(&law, &NODE, u, v, turning(rotation_speed));
            [force.force_u, force.force_v, force.torque_z]
        };
        let tangent = static_contact(&law, &NODE, u, v, turning(rotation_speed)).tangent;
        let scale = tangent.as_flattened().iter().fold(0.0f64, |largest, entry| largest.max(entry.abs()));
        let error = |step: f64| {
            let by_u = [at(u + step, v), at(u - step, v)];
            let by_v = [at(u, v + step), at(u, v - step)];
            let mut largest = 0.0f64;
            for row in 0..3 {
                for (column, [ahead, behind]) in [by_u, by_v].iter().enumerate() {
                    let difference = (ahead[row] - behind[row]) / (2.0 * step);
                    largest = largest.max((difference - tangent[row][column]).abs());
                }
            }
            largest / scale
        };
        let order = (error(2e-6) / error(1e-6)).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
        assert!(error(1e-8) < 1e-6);
    }
}

#[test]
fn smooth_wall_has_the_derivatives_of_its_force() {
    let law = parameters(&SOFT);
    let at = |[u, v, width, friction]: [f64; 4]| {
        smooth_static_contact(&law, &NODE, [u, v], turning(12.6), width, friction).force
    };
    // In the middle of the hole, short of the wall, and in it.
    for (u, v) in [(0.0, 0.0), (0.02, -0.01), (0.03, 0.026), (-0.03, 0.027)] {
        for width in [1e-2, 1e-3] {
            let point = [u, v, width, 0.6];
            let contact = smooth_static_contact(&law, &NODE, [u, v], turning(12.6), width, 0.6);
            for row in 0..3 {
                let [by_u, by_v] = contact.tangent[row];
                let derivatives = [by_u, by_v, contact.by_width[row], contact.by_friction[row]];
                for (place, derivative) in derivatives.into_iter().enumerate() {
                    let step = if place == 3 { 1e-4 } else { 1e-4 * width };
                    let moved = |by: f64| {
                        let mut moved = point;
                        moved[place] += by;
                        at(moved)[row]
                    };
                    let difference = (moved(step) - moved(-step)) / (2.0 * step);
                    // K_c is the largest derivative by a length, K_c width that of a force by the share.
                    let scale = if place == 3 { SOFT.stiffness * width } else { SOFT.stiffness };
                    assert!(
                        (difference - derivative).abs() < 1e-6 * scale,
                        "({u}, {v}) at {width} m, row {row} by {place}: {derivative} is {difference}"
                    );
                }
            }
        }
    }
}

#[test]
fn smooth_wall_becomes_the_wall_as_its_width_goes_to_zero() {
    let law = parameters(&BASE);
    for (u, v) in [(0.01, 0.02), (0.0305, 0.026), (-0.0241, 0.0321)] {
        let sharp = static_contact(&law, &NODE, u, v, turning(-12.6));
        let expected = [sharp.force_u, sharp.force_v, sharp.torque_z];
        let error = |width: f64| {
            let smooth = smooth_static_contact(&law, &NODE, [u, v], turning(-12.6), width, 1.0);
            let pairs = smooth.force.into_iter().zip(expected);
            pairs.fold(0.0f64, |most, (smooth, sharp)| most.max((smooth - sharp).abs()))
        };
        // With the square of the width, in newtons of K_c width^2 / (4 |gap|).
        let (coarse, fine) = (error(1e-5), error(1e-6));
        assert!(fine < 0.011 * coarse && coarse < 10.0, "({u}, {v}): {coarse} N, {fine} N");
    }
}

#[test]
fn potential_energy_is_the_integral_of_the_elastic_force() {
    for law in [SOFT, BASE] {
        let parameters = parameters(&law);
        let width = 1.0 / (PI * law.stiffness_sharpness);
        for saturation in [1e-6, 1e-3, 0.0999, 0.1001, 0.3, 1.0, 5.0, 40.0] {
            let p = saturation * width;
            // Gauss-Legendre with 5 points on 400 pieces: exact to rounding for a piece below a tenth of the width.
            let integral = gauss(0.0, p, 400, |p| elastic_force(&law, p));
            assert_close(parameters.potential_energy(p), integral, 2e-14);
        }
    }
    let law = parameters(&BASE);
    assert_eq!(law.potential_energy(0.0), 0.0);
    assert_eq!(law.potential_energy(-1e-3), 0.0);
    // Deep inside, by atan y = pi/2 - 1/y + ...: k_c (P^2/2 - P/(pi s) + 1/(4 s^2)) with s = pi lambda_k.
    let (p, s) = (1e-4, PI * 7e7);
    assert_close(law.potential_energy(p), 1e7 * (0.5 * p * p - p / (PI * s) + 0.25 / (s * s)), 1e-12);
}

fn gauss(from: f64, to: f64, pieces: u32, f: impl Fn(f64) -> f64) -> f64 {
    let half = 0.5 * (to - from) / f64::from(pieces);
    let (inner, outer) = ((10.0f64 / 7.0).sqrt(), 70.0f64.sqrt());
    let points = [
        (0.0, 128.0 / 225.0),
        ((5.0 - 2.0 * inner).sqrt() / 3.0, (322.0 + 13.0 * outer) / 900.0),
        ((5.0 + 2.0 * inner).sqrt() / 3.0, (322.0 - 13.0 * outer) / 900.0),
    ];
    let piece = |i: u32| {
        let centre = from + half * f64::from(2 * i + 1);
        let sum = |(x, weight): &(f64, f64)| {
            if *x == 0.0 {
                weight * f(centre)
            } else {
                weight * (f(centre - x * half) + f(centre + x * half))
            }
        };
        half * points.iter().map(sum).sum::<f64>()
    };
    (0..pieces).map(piece).sum()
}

/// One mass thrown at the wall, integrated by Runge-Kutta from touch to parting.
struct Bounce {
    /// Speed of parting [m/s], positive.
    speed: f64,
    /// Work of the damper [J], integrated alongside from the law as printed.
    damper_work: f64,
    /// Largest error of kinetic plus potential plus dissipated energy on the way [J].
    largest_imbalance: f64,
}

const MASS: f64 = 60.0;
const ARRIVAL_SPEED: f64 = 0.5;

fn bounce(law: &ContactLaw, step: f64) -> Bounce {
    let parameters = parameters(law);
    let (cos, sin) = (0.6, 0.8);
    let rates = |[p, speed, _]: [f64; 3]| {
        let r = NODE.clearance + p;
        let motion = LateralMotion {
            u: r * cos,
            v: r * sin,
            u_rate: speed * cos,
            v_rate: speed * sin,
            theta_z_rate: 0.0,
        };
        let force = dynamic_contact(&parameters, &NODE, &motion, 0.0);
        [speed, (force.force_u * cos + force.force_v * sin) / MASS, damping(law, p) * speed * speed]
    };
    let advanced = |state: [f64; 3], rate: [f64; 3], step: f64| -> [f64; 3] {
        std::array::from_fn(|i| state[i] + step * rate[i])
    };
    let runge_kutta = |state: [f64; 3], step: f64| {
        let k1 = rates(state);
        let k2 = rates(advanced(state, k1, 0.5 * step));
        let k3 = rates(advanced(state, k2, 0.5 * step));
        let k4 = rates(advanced(state, k3, step));
        let mean = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        advanced(state, mean, step)
    };
    let kinetic = |speed: f64| 0.5 * MASS * speed * speed;
    // Just inside the wall, so that no step straddles the jump of the damping there.
    let touch = 1e-10;
    let mut state = [touch, ARRIVAL_SPEED, 0.0];
    let total = |[p, speed, work]: [f64; 3]| kinetic(speed) + parameters.potential_energy(p) + work;
    let mut largest_imbalance = 0.0f64;
    loop {
        let next = runge_kutta(state, step);
        if next[0] < touch {
            break;
        }
        state = next;
        largest_imbalance = largest_imbalance.max((total(state) - total([touch, ARRIVAL_SPEED, 0.0])).abs());
    }
    let (mut shorter, mut longer) = (0.0, step);
    for _ in 0..60 {
        let middle = 0.5 * (shorter + longer);
        if runge_kutta(state, middle)[0] < touch { longer = middle } else { shorter = middle }
    }
    let [_, speed, damper_work] = runge_kutta(state, shorter);
    Bounce { speed: -speed, damper_work, largest_imbalance }
}

#[test]
fn an_undamped_bounce_keeps_its_energy() {
    let law = ContactLaw { damping: 0.0, static_friction: 0.0, dynamic_friction: 0.0, ..SOFT };
    let bounce = bounce(&law, 1e-6);
    let kinetic = 0.5 * MASS * ARRIVAL_SPEED * ARRIVAL_SPEED;
    assert_close(bounce.speed, ARRIVAL_SPEED, 1e-10);
    assert!(bounce.largest_imbalance < 1e-10 * kinetic, "{:e}", bounce.largest_imbalance);
}

#[test]
fn a_damped_bounce_loses_the_work_of_its_damper() {
    let law = ContactLaw { static_friction: 0.0, dynamic_friction: 0.0, ..SOFT };
    let bounce = bounce(&law, 1e-6);
    let lost = 0.5 * MASS * (ARRIVAL_SPEED * ARRIVAL_SPEED - bounce.speed * bounce.speed);
    assert!(lost > 2.0);
    assert_close(bounce.damper_work, lost, 1e-9);
    assert!(bounce.largest_imbalance < 1e-9 * lost, "{:e}", bounce.largest_imbalance);
}

/// With arctangents as sharp as steps the wall is a spring and a dashpot, whose coefficient of restitution at
/// P = 0 is exp(-zeta pi / sqrt(1 - zeta^2)).
#[test]
fn a_sharp_wall_has_the_restitution_of_spring_and_dashpot() {
    let sharpness = 1e18;
    let law = ContactLaw {
        stiffness_sharpness: sharpness,
        damping_sharpness: sharpness,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        ..BASE
    };
    let zeta = law.damping / (2.0 * (law.stiffness * MASS).sqrt());
    let expected = ARRIVAL_SPEED * (-zeta * PI / (1.0 - zeta * zeta).sqrt()).exp();
    // The touch at 1e-10 m instead of 0 shifts the phase by 1e-7.
    assert_close(bounce(&law, 1e-6).speed, expected, 1e-6);
}

#[test]
fn a_lane_has_the_bits_of_a_node_alone() {
    let radii = [0.0402, 0.03, 0.0, 0.041];
    let law = ContactParameters::<f64>::new(&BASE, &ActiveEffects::ALL);
    let four = ContactParameters::<Four>::new(&BASE, &ActiveEffects::ALL);
    let node = ContactNode {
        clearance: Four::splat(NODE.clearance),
        contact_radius: Four::splat(0.0635),
        stiffness_share: Four::splat(1.0),
        damping_share: Four::splat(1.0),
        friction: None,
    };
    let motion = LateralMotion {
        u: Four::new(radii.map(|r| 0.6 * r)),
        v: Four::new(radii.map(|r| -0.8 * r)),
        u_rate: Four::new([0.2, -1.0, 0.1, -0.7]),
        v_rate: Four::new([0.0, 0.3, 0.2, -0.4]),
        theta_z_rate: Four::new([1.0, -2.0, 0.0, -15.0]),
    };
    let together = dynamic_contact(&four, &node, &motion, Four::splat(12.6));
    for lane in 0..4 {
        let motion = LateralMotion {
            u: motion.u.lane(lane),
            v: motion.v.lane(lane),
            u_rate: motion.u_rate.lane(lane),
            v_rate: motion.v_rate.lane(lane),
            theta_z_rate: motion.theta_z_rate.lane(lane),
        };
        let alone = dynamic_contact(&law, &NODE, &motion, 12.6);
        assert_eq!(together.force_u.lane(lane), alone.force_u);
        assert_eq!(together.force_v.lane(lane), alone.force_v);
        assert_eq!(together.torque_z.lane(lane), alone.torque_z);
        assert_eq!(together.normal.lane(lane), alone.normal);
        assert_eq!(together.sliding_speed.lane(lane), alone.sliding_speed);
    }
}

/// Bisection finds the same friction, over laws, responses and speeds with a single solution.
#[test]
fn a_sliding_speed_that_gives_way_solves_its_equation() {
    for (static_friction, dynamic_friction) in [(0.3, 0.2), (0.3, 0.0), (0.3, 0.3), (0.3, 0.29), (2.0, 1.0)] {
        for friction_reference_speed in [1e-4, 0.033, 1.0] {
            let law = ContactLaw { static_friction, dynamic_friction, friction_reference_speed, ..SOFT };
            let parameters: ContactParameters<f64> = parameters(&law);
            let fast = parameters.friction.fast_sliding();
            let powers =
                |from: i32, to: i32| (8 * from..=8 * to).map(|eighth| 10_f64.powf(f64::from(eighth) / 8.0));
            for (response, unopposed) in powers(-4, 4).flat_map(|r| powers(-5, 1).map(move |u| (r, u * fast)))
            {
                let response = response * law.friction_reference_speed;
                let left = |speed: f64| speed + response * parameters.friction.coefficient(speed) - unopposed;
                let rises = |speed: f64| 1.0 + response * parameters.friction.slope(speed) > 0.05;
                if !powers(-3, 1).all(|speed| rises(speed * fast)) {
                    continue;
                }
                let (mut below, mut above) = (0.0, unopposed);
                for _ in 0..60 {
                    let middle = 0.5 * (below + above);
                    if left(middle) < 0.0 { below = middle } else { above = middle }
                }
                let exact = parameters.friction.coefficient(above);
                for sign in [1.0, -1.0] {
                    let speed = parameters.friction.opposed_speed(sign * unopposed, response);
                    assert!(speed * sign >= 0.0 && speed.abs() <= unopposed);
                    let error =
                        (parameters.friction.coefficient(speed) - sign * exact).abs() / static_friction;
                    assert!(error < 1e-8, "{law:?}, {response}, {unopposed}: {error:e}");
                }
            }
        }
    }
}

/// Friction that falls faster than the speed has several solutions: the one nearest to rest is taken.
#[test]
fn a_node_that_could_stick_or_slide_sticks() {
    let parameters: ContactParameters<f64> =
        parameters(&ContactLaw { static_friction: 0.3, dynamic_friction: 0.1, ..SOFT });
    for response in [3.0, 30.0, 300.0] {
        let peak = (1..2000)
            .map(|i| 1e-4 * f64::from(i))
            .map(|speed| speed + response * parameters.friction.coefficient(speed));
        let most = peak.clone().zip(peak.skip(1)).find(|(now, next)| next < now).unwrap().0;
        for unopposed in [0.1, 0.5, 0.9].map(|share| share * most) {
            let speed = parameters.friction.opposed_speed(unopposed, response);
            let left = speed + response * parameters.friction.coefficient(speed) - unopposed;
            assert!(left.abs() < 1e-7 * unopposed, "{response}, {unopposed}: {left:e}");
            assert!(parameters.friction.slope(speed) > 0.0, "{response}, {unopposed}: slides at {speed}");
        }
    }
}

/// A lane that has converged does not change while its neighbours iterate on.
#[test]
fn opposed_lanes_are_independent() {
    let one = parameters(&SOFT);
    let four = one.in_lanes::<Four>();
    let (unopposed, response) = ([0.5, 1e-3, -0.3, 0.08], [1.3, 2e-2, 0.2, 1e-5]);
    let together = four.friction.opposed_speed(Four::new(unopposed), Four::new(response));
    for lane in 0..4 {
        assert_eq!(together.lane(lane), one.friction.opposed_speed(unopposed[lane], response[lane]));
    }
}

#[test]
fn friction_hardly_changes_in_fast_sliding() {
    for (static_friction, dynamic_friction) in [(0.3, 0.2), (0.3, 0.0), (0.3, 0.299), (1.0, 0.5)] {
        let parameters = parameters(&ContactLaw { static_friction, dynamic_friction, ..SOFT });
        let fast: f64 = parameters.friction.fast_sliding();
        assert!(parameters.friction.slope(fast).abs() < 0.01 * parameters.friction.slope(0.0));
    }
}

/// One node on a spring and a damper of the wall, in one step of the implicit Euler method: the implicit force is the one that agrees with the solved
/// motion, in one evaluation from any guess.
#[test]
fn an_implicit_force_agrees_with_the_motion_that_it_leads_to() {
    let law = ContactLaw { stiffness_sharpness: 1e12, damping_sharpness: 1e12, ..SOFT };
    let parameters = parameters(&law);
    let (compliance, rate) = (2e-8, 4e3);
    let r0 = NODE.clearance + 1e-4;
    // The node along u: displacement r0 + compliance * force, velocities from rest by the rate.
    let motion = |force: [f64; 2]| LateralMotion {
        u: r0 + compliance * force[0],
        v: 0.0,
        u_rate: rate * compliance * force[0],
        v_rate: 0.03 + rate * compliance * force[1],
        theta_z_rate: 0.0,
    };
    let mut force = [0.0; 2];
    let mut yielding =
        Yielding { lateral: compliance, surface: compliance, speed: rate, force, normal: 0.0, friction: 0.0 };
    for _ in 0..2 {
        let contact = implicit_contact(&parameters, &NODE, &motion(force), 0.0, &yielding);
        force = [contact.force_u, contact.force_v];
        (yielding.force, yielding.normal, yielding.friction) = (force, contact.normal, contact.friction);
    }
    let exact = dynamic_contact(&parameters, &NODE, &motion(force), 0.0);
    assert!(exact.normal > 100.0 && exact.friction > 1.0, "{exact:?}");
    assert!((exact.force_u / force[0] - 1.0).abs() < 1e-6, "{exact:?} against {force:?}");
    assert!((exact.force_v / force[1] - 1.0).abs() < 1e-6, "{exact:?} against {force:?}");
}

/// The same of a node that its own force turns about the axis: with almost no clearance the wall holds it sideways as stiffly as outwards,
/// so that a force of the right size in the direction of the last contact iteration would throw it across.
#[test]
fn an_implicit_force_holds_a_node_without_clearance_in_its_place() {
    let law = ContactLaw { stiffness: 1e9, stiffness_sharpness: 1e15, damping_sharpness: 1e15, ..BASE };
    let parameters = parameters(&law);
    let (compliance, rate) = (2e-8, 4e3);
    for clearance in [1e-9, 1e-7] {
        let node = ContactNode { clearance, ..NODE };
        // Its place without the wall; its velocity from there is the rate times the displacement, and its surface slides accordingly.
        let free = [3e-5, -4e-5];
        let motion = |force: [f64; 2]| LateralMotion {
            u: free[0] + compliance * force[0],
            v: free[1] + compliance * force[1],
            u_rate: rate * compliance * force[0],
            v_rate: rate * compliance * force[1],
            theta_z_rate: 0.0,
        };
        let mut force = [-2000.0, 0.0];
        let mut yielding = Yielding {
            lateral: compliance,
            surface: compliance,
            speed: rate,
            force,
            normal: 2000.0,
            friction: 0.0,
        };
        let mut iterate = || {
            let contact = implicit_contact(&parameters, &node, &motion(force), 12.6, &yielding);
            force = [contact.force_u, contact.force_v];
            (yielding.force, yielding.normal, yielding.friction) = (force, contact.normal, contact.friction);
            force
        };
        // Friction turns with the direction, which the next contact iteration knows: the remainder falls by mu an iteration.
        let iterates = [iterate(), iterate(), iterate(), iterate(), iterate(), iterate()];
        let exact = dynamic_contact(&parameters, &node, &motion(iterates[5]), 12.6);
        let size = exact.force_u.hypot(exact.force_v);
        let off = |force: [f64; 2]| (force[0] - iterates[5][0]).hypot(force[1] - iterates[5][1]) / size;
        assert!(exact.normal > 1000.0, "{exact:?}");
        let left = (exact.force_u - iterates[5][0]).hypot(exact.force_v - iterates[5][1]) / size;
        assert!(left < 1e-2, "clearance {clearance}: {left}, {exact:?} against {iterates:?}");
        assert!(off(iterates[1]) < 0.1, "two iterations: {iterates:?}");
    }
}

/// Friction of the contact iteration before, out of all proportion to the push, turns such a node by less than a right angle: the wall still holds
/// it, and the iterations come to the same force as from any other start.
#[test]
fn friction_of_the_previous_iteration_cannot_turn_a_node_off_the_wall() {
    let law = ContactLaw { stiffness: 1e9, stiffness_sharpness: 1e15, damping_sharpness: 1e15, ..BASE };
    let parameters = parameters(&law);
    let node = ContactNode { clearance: 1e-7, ..NODE };
    let (compliance, rate) = (2e-8, 4e3);
    // The wall along u; without it the node would be at 5e-5 m, where friction of 2500 N would move it by its whole distance.
    let motion = |[force_u, force_v]: [f64; 2]| LateralMotion {
        u: 5e-5 + compliance * force_u,
        v: compliance * force_v,
        u_rate: rate * compliance * force_u,
        v_rate: rate * compliance * force_v,
        theta_z_rate: 0.0,
    };
    let iterates = |friction: f64| {
        let mut force = [-2000.0, 0.0];
        let mut yielding = Yielding {
            lateral: compliance,
            surface: compliance,
            speed: rate,
            force,
            normal: 2000.0,
            friction,
        };
        [(); 10].map(|()| {
            let contact = implicit_contact(&parameters, &node, &motion(force), 12.6, &yielding);
            force = [contact.force_u, contact.force_v];
            yielding = Yielding { force, normal: contact.normal, friction: contact.friction, ..yielding };
            contact
        })
    };
    let settled = iterates(0.0)[9];
    for friction in [2400.0, 2600.0, 1e4, 1e6] {
        for friction in [friction, -friction] {
            let iterations = iterates(friction);
            assert!(iterations.iter().all(|contact| contact.normal > 0.0), "{friction}: {iterations:?}");
            let off =
                (iterations[9].force_u - settled.force_u).hypot(iterations[9].force_v - settled.force_v);
            assert!(off < 1e-2 * settled.normal, "{friction}: {:?} for {settled:?}", iterations[9]);
        }
    }
}

/// A joint of 0.3 m in a hole that leaves it 27 mm.
const SEGMENT: ContactSegment<f64> = ContactSegment {
    length: 0.3,
    wall: ContactNode {
        clearance: 0.027,
        contact_radius: 0.081,
        stiffness_share: 0.6,
        damping_share: 0.6,
        friction: None,
    },
};

/// Nodal values of a straight element in the plane of u, from its deflections at both ends \[m\].
fn rigid(upper: f64, lower: f64) -> ElementVector {
    let mut values = ElementVector::zeros();
    let slope = (lower - upper) / SEGMENT.length;
    (values[U], values[DOFS + U]) = (upper, lower);
    (values[THETA_Y], values[DOFS + THETA_Y]) = (slope, slope);
    values
}

fn motion_of(values: &ElementVector, rates: &ElementVector) -> SegmentMotion<f64> {
    SegmentMotion {
        planes: planes(values),
        rates: planes(rates),
        twist_rates: [rates[THETA_Z], rates[DOFS + THETA_Z]],
    }
}

#[test]
fn an_element_deflects_on_the_wall_as_its_beam_does_at_its_ends_and_in_the_middle() {
    for a in [0.0, 0.3, 40.0] {
        for at in [0.0, 0.5, 1.0] {
            let wanted = Shape::at(at, SEGMENT.length, a).deflection;
            let found = SEGMENT.place(at).shape;
            assert!(
                found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-15),
                "{a} {at}"
            );
        }
    }
}

#[test]
fn loads_are_derivatives_of_the_energy_of_any_part_in_the_wall() {
    let clearance = SEGMENT.wall.clearance;
    let mut next = numbers();
    let mut parts = [0; 4];
    for _ in 0..3000 {
        let size = 1e-4;
        let mut values = rigid(clearance + size * next(), clearance + size * next());
        (values[THETA_Y], values[DOFS + THETA_Y]) =
            (values[THETA_Y] + 20.0 * size * next(), values[DOFS + THETA_Y] + 20.0 * size * next());
        for sharpness in [1e14, 3e3] {
            let law = parameters(&ContactLaw { stiffness_sharpness: sharpness, ..FRICTIONLESS });
            let energy = |values: &ElementVector| SEGMENT.potential_energy(&law, &planes(values));
            let Some(contact) = static_segment(&law, &SEGMENT, &values, turning(1.0)) else { continue };
            assert!(SEGMENT.may_touch(&planes(&values)));
            let [upper, _, lower] = [0.0, 0.5, 1.0].map(|at| {
                let shape = SEGMENT.place(at).shape;
                shape.iter().zip(planes(&values)[0]).map(|(shape, value)| shape * value).sum::<f64>()
                    > clearance
            });
            parts[2 * usize::from(upper) + usize::from(lower)] += 1;
            for dof in [U, THETA_Y, DOFS + U, DOFS + THETA_Y] {
                let unit = ElementVector::from_fn(|i, _| if i == dof { 1e-9 } else { 0.0 });
                let work = (energy(&(values - unit)) - energy(&(values + unit))) / 2e-9;
                // Of second order in the step, and of a lower one if contact begins or parts merge.
                assert!(
                    (work - contact.force[dof]).abs() < 1e-5 * (1.0 + contact.force.norm()),
                    "{dof}: {work} against {}",
                    contact.force[dof]
                );
            }
            assert!((contact.tangent - contact.tangent.transpose()).norm() < 1e-12 * contact.tangent.norm());
        }
    }
    assert!(parts.iter().all(|&count| count > 100), "{parts:?}");
}

#[test]
fn the_wall_along_a_rigid_element_is_the_integral_over_the_part_in_it() {
    // A wall so sharp that its stiffness is whole: with the gap g(x) linear the force is k int g dx and its moment k int g x dx over g > 0.
    let law = parameters(&ContactLaw { stiffness_sharpness: 1e14, ..FRICTIONLESS });
    let stiffness = 1e7 * SEGMENT.wall.stiffness_share / SEGMENT.length;
    let clearance = SEGMENT.wall.clearance;
    for (upper, lower) in [(1e-4, 3e-4), (3e-4, 1e-9), (-1e-4, 2e-4), (5e-4, -3e-4), (-1e-6, 1e-3)] {
        let values = rigid(clearance + upper, clearance + lower);
        let contact = static_segment(&law, &SEGMENT, &values, turning(1.0)).unwrap();
        // The part from the zero of the gap to the end that is in the wall.
        let slope = (lower - upper) / SEGMENT.length;
        let zero = (-upper / slope).clamp(0.0, SEGMENT.length);
        let (from, to) = if lower > upper { (zero, SEGMENT.length) } else { (0.0, zero) };
        let (from, to) = if upper > 0.0 && lower > 0.0 { (0.0, SEGMENT.length) } else { (from, to) };
        let integral = |power: i32| {
            let of = |x: f64| {
                let p = f64::from(power);
                upper * x.powi(power + 1) / (p + 1.0) + slope * x.powi(power + 2) / (p + 2.0)
            };
            stiffness * (of(to) - of(from))
        };
        let (force, moment) = (integral(0), integral(1));
        let [at_upper, at_lower] = contact.ends;
        assert_close(at_upper + at_lower, force, 1e-9);
        assert_close(at_lower * SEGMENT.length, moment, 1e-9);
        let mut moving = SegmentForce::none();
        assert!(dynamic_segment(
            &law,
            &SEGMENT,
            &motion_of(&values, &ElementVector::zeros()),
            0.0,
            &mut moving
        ));
        assert_close(moving.middle * SEGMENT.length, moment / force, 1e-9);
        assert_close(moving.ends[0] + moving.ends[1], force, 1e-9);
        // The loads do the same work on rigid motions.
        let work = |motion: &ElementVector| contact.force.dot(motion);
        assert_close(work(&rigid(1.0, 1.0)), -force, 1e-9);
        assert_close(work(&rigid(0.0, 1.0)), -moment / SEGMENT.length, 1e-9);
        // The wall stores the work done against it: k g^2 / 2 along that part, of which the force is the derivative.
        let energy = |by: f64| {
            let values = rigid(clearance + upper + by, clearance + lower + by);
            SEGMENT.potential_energy(&law, &planes(&values))
        };
        let step = 1e-9;
        assert_close((energy(step) - energy(-step)) / (2.0 * step), force, 1e-5);
    }
    // Short of the wall there is none, and the loads of the caller stay.
    for values in [rigid(0.02, 0.0269), rigid(clearance - 1e-9, clearance - 1e-4)] {
        assert!(static_segment(&law, &SEGMENT, &values, turning(1.0)).is_none());
        let before = SegmentForce { ends: [1.0, 2.0], ..SegmentForce::none() };
        let mut force = before;
        let motion = motion_of(&values, &ElementVector::zeros());
        assert!(!dynamic_segment(&law, &SEGMENT, &motion, 0.0, &mut force));
        assert_eq!(force, before);
    }
    assert!(!SEGMENT.may_touch(&planes(&rigid(0.01, 0.01))));
}

#[test]
fn contact_of_an_element_grows_from_zero_at_any_place() {
    let law = parameters(&FRICTIONLESS);
    let clearance = SEGMENT.wall.clearance;
    // Bulging between its ends, and rolling over one end.
    let bulge = |by: f64| {
        let mut values = rigid(clearance - 2e-5 + by, clearance - 2e-5 + by);
        (values[THETA_Y], values[DOFS + THETA_Y]) = (2e-4, -3e-4);
        values
    };
    let roll = |by: f64| rigid(clearance + by, clearance - 1e-4 + by);
    // Hollow: from both ends, which merge in the middle.
    let hollow = |by: f64| {
        let mut values = rigid(clearance + by, clearance + 2e-5 + by);
        (values[THETA_Y], values[DOFS + THETA_Y]) = (-1e-3, 1e-3);
        values
    };
    let loads = |values: &ElementVector| {
        static_segment(&law, &SEGMENT, values, turning(1.0))
            .map_or(ElementVector::zeros(), |contact| contact.force)
    };
    for motion in [&bulge as &dyn Fn(f64) -> ElementVector, &roll, &hollow] {
        // From off the wall to whole contact: no step of the loads is larger than the whole stiffness allows.
        let (step, most) = (1e-8, 1.1 * 1e7 * SEGMENT.wall.stiffness_share);
        let mut before = loads(&motion(-1.2e-4));
        let mut touched = 0;
        for k in 1..24_000 {
            let now = loads(&motion(-1.2e-4 + f64::from(k) * step));
            let jump = (now - before).abs().max();
            assert!(jump <= most * step, "{jump} N at {k}");
            touched += u32::from(now != ElementVector::zeros() && before == ElementVector::zeros());
            before = now;
        }
        assert_eq!(touched, 1);
    }
}

#[test]
fn tangents_along_an_element_are_derivatives_of_its_loads() {
    let soft = ContactLaw { stiffness_sharpness: 3e3, damping_sharpness: 2e3, ..BASE };
    let law = parameters(&soft);
    let clearance = SEGMENT.wall.clearance;
    let mut values = rigid(clearance + 3e-4, clearance + 5e-4);
    (values[V], values[DOFS + V], values[THETA_X]) = (4e-3, 3e-3, 1e-3);
    let zero = ElementVector::zeros();
    let static_force = |values: &ElementVector| static_segment(&law, &SEGMENT, values, turning(1.0)).unwrap();
    let moving = |values: &ElementVector, rates: &ElementVector| {
        let mut force = SegmentForce::none();
        assert!(dynamic_segment(&law, &SEGMENT, &motion_of(values, rates), 12.0, &mut force));
        let mut loads = ElementVector::zeros();
        let (in_u, in_v) = (force.load(0), force.load(1));
        for (end, node) in [(0, 0), (2, DOFS)] {
            (loads[node + U], loads[node + THETA_Y]) = (in_u[end], in_u[end + 1]);
            (loads[node + V], loads[node + THETA_X]) = (in_v[end], -in_v[end + 1]);
        }
        [loads[THETA_Z], loads[DOFS + THETA_Z]] = force.torque;
        loads
    };
    let sliding = sliding_segment(&law, &SEGMENT, &values, 12.0).unwrap();
    for dof in 0..2 * DOFS {
        let unit = ElementVector::from_fn(|i, _| if i == dof { 1e-7 } else { 0.0 });
        let by_place = (static_force(&(values + unit)).force - static_force(&(values - unit)).force) / 2e-7;
        let found = static_force(&values).tangent.column(dof).into_owned();
        assert!((by_place - found).norm() < 1e-5 * static_force(&values).tangent.norm(), "{dof}");
        let by_place = (moving(&(values - unit), &zero) - moving(&(values + unit), &zero)) / 2e-7;
        assert!((by_place - sliding.stiffness.column(dof)).norm() < 1e-5 * sliding.stiffness.norm(), "{dof}");
        let by_rate = (moving(&values, &(-unit)) - moving(&values, &unit)) / 2e-7;
        assert!((by_rate - sliding.damping.column(dof)).norm() < 1e-4 * sliding.damping.norm(), "{dof}");
    }
}

#[test]
fn tangent_of_a_partial_contact_follows_its_moving_end() {
    let law = parameters(&BASE);
    let clearance = SEGMENT.wall.clearance;
    for (upper, lower) in [(3e-4, -2e-4), (-1e-4, 4e-4)] {
        let mut values = rigid(clearance + upper, clearance + lower);
        values[THETA_Y] += 3e-4;
        let force = |values: &ElementVector| static_segment(&law, &SEGMENT, values, turning(1.0)).unwrap();
        let tangent = force(&values).tangent;
        for dof in [U, V, THETA_X, THETA_Y, DOFS + U, DOFS + V, DOFS + THETA_X, DOFS + THETA_Y] {
            let unit = ElementVector::from_fn(|i, _| if i == dof { 1e-9 } else { 0.0 });
            let found = (force(&(values + unit)).force - force(&(values - unit)).force) / 2e-9;
            // With the end fixed it would be off by per cents.
            assert!((found - tangent.column(dof)).norm() < 1e-6 * tangent.norm(), "{upper} {lower} {dof}");
        }
    }
}

/// An element that crosses the hole between its middle and its lower end, whose parabola of distances is in the wall there.
fn across_the_hole(lower: f64) -> ElementVector {
    let clearance = SEGMENT.wall.clearance;
    let mut values = rigid(0.2 * clearance, lower * clearance);
    // The middle at 1.06 clearances.
    let turn = 4.0 / SEGMENT.length * clearance * (1.06 - 0.5 * (0.2 + lower));
    (values[THETA_Y], values[DOFS + THETA_Y]) = (turn, -turn);
    (values[V], values[DOFS + V]) = (0.01 * clearance, -0.02 * clearance);
    values
}

#[test]
fn tangent_of_an_element_across_the_hole_is_the_derivative_of_its_loads() {
    let law = parameters(&ContactLaw { stiffness_sharpness: 3e3, ..BASE });
    let mut next = numbers();
    let mut faded = 0;
    for _ in 0..200 {
        let mut values = across_the_hole(-1.02 + 0.1 * next());
        for (dof, size) in [(U, 1e-2), (V, 3e-2), (DOFS + V, 3e-2), (THETA_X, 2e-2), (DOFS + THETA_X, 2e-2)] {
            values[dof] += size * next();
        }
        let Some(contact) = static_segment(&law, &SEGMENT, &values, turning(1.0)) else { continue };
        let pressed = SEGMENT.pressed(&planes(&values)).unwrap();
        faded += usize::from(pressed.places.iter().any(|place| {
            let [u, v] = planes(&values).map(|plane| dot(&place.shape, &plane));
            SEGMENT.reached(u.hypot(v)) < 1.0
        }));
        for dof in [U, V, THETA_X, THETA_Y, DOFS + U, DOFS + V, DOFS + THETA_X, DOFS + THETA_Y] {
            let unit = ElementVector::from_fn(|i, _| if i == dof { 1e-9 } else { 0.0 });
            let force = |by: &ElementVector| {
                static_segment(&law, &SEGMENT, by, turning(1.0)).map_or(ElementVector::zeros(), |of| of.force)
            };
            let found = (force(&(values + unit)) - force(&(values - unit))) / 2e-9;
            let off = (found - contact.tangent.column(dof)).norm();
            assert!(off < 1e-4 * contact.tangent.norm(), "{dof}: {off:e} of {:e}", contact.tangent.norm());
        }
    }
    assert!(faded > 20, "{faded}");
}

/// The loads on an element whose point crosses the axis of the hole change with the step, at rest and in motion.
#[test]
fn loads_do_not_jump_as_a_string_crosses_the_axis_within_an_element() {
    let law = parameters(&FRICTIONLESS);
    let loads = |lower: f64| {
        let mut values = across_the_hole(lower);
        values[DOFS + V] = 1e-9;
        values[V] = 0.0;
        let mut moving = SegmentForce::none();
        let moves =
            dynamic_segment(&law, &SEGMENT, &motion_of(&values, &ElementVector::zeros()), 0.0, &mut moving);
        let resting = static_segment(&law, &SEGMENT, &values, turning(1.0));
        assert_eq!(moves, resting.is_some());
        let resting = resting.map_or(ElementVector::zeros(), |contact| contact.force);
        if moves {
            assert_close(moving.load(0)[2], resting[DOFS + U], 1e-9);
        }
        resting
    };
    let steps = 4000;
    let step = 0.6 / f64::from(steps);
    let of: Vec<ElementVector> = (0..=steps).map(|k| loads(-1.3 + step * f64::from(k))).collect();
    let largest = of.iter().fold(0.0_f64, |most, loads| most.max(loads.amax()));
    let jump = of.windows(2).fold(0.0_f64, |most, pair| most.max((pair[1] - pair[0]).amax()));
    assert!(largest > 0.0 && jump < 0.01 * largest, "{jump} N of {largest} N");
}

/// Pseudo-random numbers in \[-1, 1).
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A compliance like that of a stage: positive definite, nearly the same for both ends.
fn compliance() -> SegmentCompliance<f64> {
    SegmentCompliance {
        lateral: [6e-9, -2e-9, 3e-9, 4e-9, 5e-8, -4e-9, -1e-8, 6e-9, 2e-9, 5e-8],
        twist: [4e-6, 3.6e-6, 4e-6],
    }
}

#[test]
fn a_lane_has_the_bits_of_an_element_alone() {
    let laws =
        [BASE, SOFT].map(|law| (parameters(&law), ContactParameters::<Four>::new(&law, &ActiveEffects::ALL)));
    let mut next = numbers();
    let four = |values: [f64; 4]| Four::new(values);
    let wide = |value: fn(&ContactSegment<f64>) -> f64| Four::splat(value(&SEGMENT));
    let segment = ContactSegment {
        length: wide(|segment| segment.length),
        wall: ContactNode {
            clearance: wide(|segment| segment.wall.clearance),
            contact_radius: wide(|segment| segment.wall.contact_radius),
            stiffness_share: wide(|segment| segment.wall.stiffness_share),
            damping_share: wide(|segment| segment.wall.damping_share),
            friction: None,
        },
    };
    let single = compliance();
    let wide_compliance =
        SegmentCompliance { lateral: single.lateral.map(Four::splat), twist: single.twist.map(Four::splat) };
    let mut touched = 0;
    for round in 0..400 {
        let size = if round % 2 == 0 { 3e-4 } else { 3e-3 };
        let motions: [SegmentMotion<f64>; 4] = std::array::from_fn(|_| {
            let mut values = rigid(0.027 + size * next(), 0.027 + size * next());
            for dof in [THETA_X, THETA_Y, DOFS + THETA_X, DOFS + THETA_Y] {
                values[dof] += 10.0 * size * next();
            }
            motion_of(&values, &ElementVector::from_fn(|_, _| next()))
        });
        let lanes = |of: &dyn Fn(&SegmentMotion<f64>) -> f64| four(motions.each_ref().map(of));
        let plane = |p: usize| -> [[Four; 4]; 2] {
            let of = |k: usize| [lanes(&|motion| motion.planes[p][k]), lanes(&|motion| motion.rates[p][k])];
            let pairs = [of(0), of(1), of(2), of(3)];
            [pairs.map(|[x, _]| x), pairs.map(|[_, rate]| rate)]
        };
        let ([x_u, r_u], [x_v, r_v]) = (plane(0), plane(1));
        let motion = SegmentMotion {
            planes: [x_u, x_v],
            rates: [r_u, r_v],
            twist_rates: [0, 1].map(|end| lanes(&|motion| motion.twist_rates[end])),
        };
        for (law, wide_law) in &laws {
            let mut forces = SegmentForce::none();
            dynamic_segment(wide_law, &segment, &motion, Four::splat(0.3), &mut forces);
            let before = forces;
            let yielding = (&wide_compliance, Four::splat(1e3));
            implicit_segment(wide_law, &segment, &motion, Four::splat(0.3), yielding, &mut forces);
            for (lane, motion) in motions.iter().enumerate() {
                let mut force = SegmentForce::none();
                touched += u32::from(dynamic_segment(law, &SEGMENT, motion, 0.3, &mut force));
                assert_eq!(force, lane_of(&before, lane));
                implicit_segment(law, &SEGMENT, motion, 0.3, (&single, 1e3), &mut force);
                assert_eq!(force, lane_of(&forces, lane));
            }
        }
    }
    assert!((800..2800).contains(&touched), "{touched}");
}

fn lane_of(force: &SegmentForce<Four>, lane: usize) -> SegmentForce<f64> {
    let of = |value: Four| value.lane(lane);
    SegmentForce {
        normal: force.normal.map(|plane| plane.map(of)),
        friction: force.friction.map(|plane| plane.map(of)),
        torque: force.torque.map(of),
        ends: force.ends.map(of),
        middle: of(force.middle),
    }
}

#[test]
fn implicit_loads_agree_with_the_motion_that_they_lead_to() {
    // x = x_free + G load: the element alone, pressed into the wall and rubbed along it, fast, slowly, and held by friction.
    let (law, compliance, speed) = (parameters(&BASE), compliance(), 1e3);
    let [aa, ab, ac, ad, bb, bc, bd, cc, cd, dd] = compliance.lateral;
    let lateral = [[aa, ab, ac, ad], [ab, bb, bc, bd], [ac, bc, cc, cd], [ad, bd, cd, dd]];
    for rotation_speed in [12.0, 0.5, 0.02] {
        let free = rigid(0.027 + 2e-5, 0.027 + 5e-5);
        let mut force = SegmentForce::none();
        let moved = |force: &SegmentForce<f64>| {
            let mut motion = motion_of(&free, &ElementVector::zeros());
            for plane in 0..2 {
                let load = force.load(plane);
                for (k, row) in lateral.iter().enumerate() {
                    let by_load: f64 = row.iter().zip(load).map(|(g, load)| g * load).sum();
                    motion.planes[plane][k] += by_load;
                    motion.rates[plane][k] += speed * by_load;
                }
            }
            let [own, between, _] = compliance.twist;
            let [upper, lower] = force.torque;
            motion.twist_rates =
                [speed * (own * upper + between * lower), speed * (between * upper + own * lower)];
            motion
        };
        let mut iterations = 0;
        let mut change = f64::INFINITY;
        while change > 1e-6 {
            let before = force.ends[0] + force.ends[1] + force.torque[0];
            let yielding = (&compliance, speed);
            assert!(implicit_segment(&law, &SEGMENT, &moved(&force), rotation_speed, yielding, &mut force));
            change = (force.ends[0] + force.ends[1] + force.torque[0] - before).abs();
            iterations += 1;
            assert!(iterations <= 8, "{rotation_speed} rad/s: {change} N");
        }
        // The loads are those of the law itself on the motion that they cause.
        let mut own = SegmentForce::none();
        assert!(dynamic_segment(&law, &SEGMENT, &moved(&force), rotation_speed, &mut own));
        assert_close(own.ends[0] + own.ends[1], force.ends[0] + force.ends[1], 1e-6);
        assert_close(own.torque[0] + own.torque[1], force.torque[0] + force.torque[1], 1e-4);
    }
}

#[test]
fn two_sliding_speeds_that_give_way_solve_their_equations() {
    let law = parameters(&BASE);
    // Points of one element that move alike or differently; fast ones with responses that have a single solution.
    let (all, small): (&[f64], &[f64]) = (&[1e-3, 0.03, 0.3, 3.0, 30.0], &[1e-3, 0.03, 0.1]);
    for (unopposed, shares, responses) in [
        ([1e-3, 2e-3], [0.5, 0.9, 0.99], all),
        ([0.05, 0.04], [0.5, 0.9, 0.99], all),
        ([-0.4, -0.45], [0.5, 0.9, 0.99], small),
        ([1.5, 1.4], [0.5, 0.9, 0.99], small),
        ([0.2, -0.01], [0.0, 0.2, 0.5], small),
        ([0.6, 0.3], [0.0, 0.2, 0.5], small),
    ] {
        for &response in responses {
            for share in shares {
                let matrix = [[response, share * response], [share * response, 1.1 * response]];
                let speeds = law.friction.opposed_speeds(unopposed, matrix);
                let friction = speeds.map(|speed| law.friction.coefficient(speed));
                for i in 0..2 {
                    let opposed = speeds[i] + matrix[i][0] * friction[0] + matrix[i][1] * friction[1];
                    let left = (opposed - unopposed[i]).abs();
                    assert!(left < 1e-5, "{unopposed:?} {matrix:?}: {left} m/s");
                }
            }
        }
    }
}

/// Planes of an element turned about the axis of the hole.
fn turned([in_u, in_v]: [Plane<f64>; 2], angle: f64) -> [Plane<f64>; 2] {
    let (sin, cos) = angle.sin_cos();
    let combined = |a: f64, b: f64| std::array::from_fn(|k| a * in_u[k] + b * in_v[k]);
    [combined(cos, -sin), combined(sin, cos)]
}

#[test]
fn loads_on_an_element_turn_with_it_about_the_axis() {
    let (law, compliance) = (parameters(&BASE), compliance());
    let mut next = numbers();
    let mut touched = 0;
    for _ in 0..300 {
        let mut values = rigid(0.027 + 3e-4 * next(), 0.027 + 3e-4 * next());
        for dof in [V, DOFS + V, THETA_X, THETA_Y, DOFS + THETA_X, DOFS + THETA_Y] {
            values[dof] += 3e-3 * next();
        }
        let motion = motion_of(&values, &ElementVector::from_fn(|_, _| 0.1 * next()));
        let loads = |angle: f64| {
            let motion = SegmentMotion {
                planes: turned(motion.planes, angle),
                rates: turned(motion.rates, angle),
                ..motion
            };
            let mut force = SegmentForce::none();
            assert_eq!(
                dynamic_segment(&law, &SEGMENT, &motion, 0.3, &mut force),
                SEGMENT.potential_energy(&law, &motion.planes) > 0.0
            );
            let at_once = force;
            implicit_segment(&law, &SEGMENT, &motion, 0.3, (&compliance, 1e3), &mut force);
            [at_once, force].map(|force| (turned([force.load(0), force.load(1)], -angle), force.torque))
        };
        let straight = loads(0.0);
        touched += usize::from(straight[0].1 != [0.0; 2]);
        for angle in [0.7, 2.0, -1.1] {
            for ((found, torque), (expected, expected_torque)) in loads(angle).into_iter().zip(straight) {
                let size = expected.as_flattened().iter().fold(0.0f64, |most, load| most.max(load.abs()));
                let pairs = found.as_flattened().iter().zip(expected.as_flattened());
                let torques = torque.iter().zip(&expected_torque);
                assert!(
                    pairs.chain(torques).all(|(found, expected)| (found - expected).abs() <= 1e-7 * size),
                    "{angle}: {found:?} {torque:?} instead of {expected:?} {expected_torque:?}"
                );
            }
        }
    }
    assert!(touched > 100, "{touched}");
}

/// Straight, bulging and hollow elements: in the wall with their whole length, one end, the middle and both ends.
fn elements_in_the_wall() -> [ElementVector; 6] {
    let clearance = SEGMENT.wall.clearance;
    let bent = |gap: f64, turn: f64| {
        let mut values = rigid(clearance + gap, clearance + 1.3 * gap);
        values[THETA_Y] += turn;
        values[DOFS + THETA_Y] -= turn;
        values
    };
    [
        rigid(clearance + 3e-4, clearance + 3e-4),
        rigid(clearance + 3e-4, clearance + 1e-4),
        rigid(clearance + 3e-4, clearance - 2e-4),
        rigid(clearance - 1e-4, clearance + 4e-4),
        bent(-1e-4, 4e-3),
        bent(1e-4, -4e-3),
    ]
}

/// Normal force on an element in the wall whose both planes move by `by` along u, at the rate `rate` \[N\].
fn pushed(law: &ContactParameters<f64>, values: &ElementVector, by: f64, rate: f64) -> f64 {
    let mut force = SegmentForce::none();
    let motion = motion_of(&(values + rigid(by, by)), &rigid(rate, rate));
    assert!(dynamic_segment(law, &SEGMENT, &motion, 0.0, &mut force));
    force.ends[0] + force.ends[1]
}

#[test]
fn the_damper_of_an_element_acts_over_its_part_in_the_wall() {
    let sharp = ContactLaw { stiffness_sharpness: 1e14, damping_sharpness: 1e14, ..FRICTIONLESS };
    let law = parameters(&sharp);
    let (cells, rate) = (20_000, 0.02);
    for values in elements_in_the_wall() {
        let in_the_wall = (0..cells).filter(|&cell| {
            let shape = SEGMENT.place((f64::from(cell) + 0.5) / f64::from(cells)).shape;
            dot(&shape, &planes(&values)[0]) > SEGMENT.wall.clearance
        });
        let part = in_the_wall.count() as f64 / f64::from(cells);
        let damping = sharp.damping * SEGMENT.wall.damping_share * part;
        // Each end of a part is known to half a cell.
        assert_close(
            pushed(&law, &values, 0.0, rate) - pushed(&law, &values, 0.0, 0.0),
            damping * rate,
            5e-4,
        );
        let tangent = sliding_segment(&law, &SEGMENT, &values, 12.0).unwrap();
        let shift = rigid(1.0, 1.0);
        assert_close(shift.dot(&(tangent.damping * shift)), damping, 5e-4);
    }
}

/// Compliance of an element that moves sideways and twists as a whole.
fn compliance_of_a_whole(lateral: f64, twist: f64) -> SegmentCompliance<f64> {
    SegmentCompliance {
        lateral: [lateral, 0.0, lateral, 0.0, 0.0, 0.0, 0.0, lateral, 0.0, 0.0],
        twist: [twist; 3],
    }
}

/// Force of an element that moves as a whole with the compliance g, at the end of a step: `F = N(x + g (L - F))`, x the motion found with the load L.
/// One step of Newton's method leads to `(N + N' g L) / (1 + N' g)`, N' by the place and by the speed with it.
#[test]
fn implicit_normal_forces_along_an_element_are_one_step_of_newtons_method() {
    let law = parameters(&ContactLaw { stiffness_sharpness: 1e14, damping_sharpness: 1e14, ..FRICTIONLESS });
    let (lateral, speed) = (3e-8, 700.0);
    for values in elements_in_the_wall() {
        let by_place = (pushed(&law, &values, 1e-8, 0.0) - pushed(&law, &values, -1e-8, 0.0)) / 2e-8;
        let by_rate = (pushed(&law, &values, 0.0, 1e-3) - pushed(&law, &values, 0.0, -1e-3)) / 2e-3;
        let rise = lateral * (by_place + speed * by_rate);
        for load in [0.0, 200.0] {
            let mut force = SegmentForce::none();
            force.normal[0] = [-0.25 * load, 0.0, -0.75 * load, 0.0];
            let motion = motion_of(&values, &ElementVector::zeros());
            let compliance = compliance_of_a_whole(lateral, 0.0);
            assert!(implicit_segment(&law, &SEGMENT, &motion, 0.0, (&compliance, speed), &mut force));
            let expected = (pushed(&law, &values, 0.0, 0.0) + rise * load) / (1.0 + rise);
            assert_close(force.ends[0] + force.ends[1], expected, 1e-6);
            let [upper, _, lower, _] = force.load(0);
            assert_close(upper + lower, -expected, 1e-6);
        }
    }
}

/// Sliding speed of an element that moves as a whole: `s = s_0 - c f (g_s + g_t R^2) mu(s) N` with the share f of the friction. A friction of 1 N takes
/// c g_s from it by its way along the wall, and c g_t R^2 by its twist.
#[test]
fn implicit_friction_along_an_element_solves_the_friction_curve() {
    let (radius, speed) = (SEGMENT.wall.contact_radius, 1e3);
    let (lateral, twist) = (1e-8, 4e-6);
    let compliance = compliance_of_a_whole(lateral, twist);
    let values = rigid(0.0273, 0.0273);
    for share in [1.0, 0.25] {
        let law = parameters(&BASE).with_friction_share(share);
        for rotation_speed in [4.0, 0.5, -0.5, 0.02] {
            // The motion without friction, and with one that gave the surface another speed.
            for before in [0.0, 3.0] {
                let mut force = SegmentForce::none();
                force.friction[1] = [-0.5 * before, 0.0, -0.5 * before, 0.0];
                force.torque = [-0.5 * before * radius; 2];
                let mut motion = motion_of(&values, &ElementVector::zeros());
                motion.rates[1] = [-speed * lateral * before, 0.0, -speed * lateral * before, 0.0];
                motion.twist_rates = [-speed * twist * before * radius; 2];
                assert!(implicit_segment(
                    &law,
                    &SEGMENT,
                    &motion,
                    rotation_speed,
                    (&compliance, speed),
                    &mut force
                ));
                let normal = force.ends[0] + force.ends[1];
                let opposed = |sliding: f64| {
                    let friction = normal * law.friction.coefficient(sliding);
                    sliding + speed * share * (lateral + twist * radius * radius) * friction
                };
                let free = rotation_speed.abs() * radius;
                let (mut below, mut above) = (0.0, free);
                for _ in 0..60 {
                    let middle = 0.5 * (below + above);
                    if opposed(middle) < free { below = middle } else { above = middle }
                }
                let friction = share * normal * law.friction.coefficient(rotation_speed.signum() * below);
                // The solution leaves less than 1e-5 m/s, at a slope of up to 1 / v_ref.
                let margin = share * normal * 1e-5 / BASE.friction_reference_speed;
                let [upper, _, lower, _] = force.friction[1];
                let (along, about) = (upper + lower, force.torque[0] + force.torque[1]);
                assert!(
                    (along + friction).abs() < margin,
                    "{share} {rotation_speed}: {along} N for {friction} N"
                );
                assert!(
                    (about + friction * radius).abs() < margin * radius,
                    "{share} {rotation_speed}: {about} N m"
                );
            }
        }
    }
}

#[test]
fn loads_of_friction_along_an_element_are_linear_in_its_share() {
    let mut values = rigid(0.0272, 0.0274);
    (values[V], values[DOFS + V]) = (2e-3, 3e-3);
    let moving = |law: &ContactParameters<f64>| {
        let mut force = SegmentForce::none();
        let motion = motion_of(&values, &ElementVector::zeros());
        assert!(dynamic_segment(law, &SEGMENT, &motion, 12.0, &mut force));
        let [upper, lower] = force.torque;
        ElementVector::from_iterator([force.load(0), force.load(1), [upper, lower, 0.0, 0.0]].concat())
    };
    let of = |share: f64| {
        let law = parameters(&BASE).with_friction_share(share);
        let resting = static_segment(&law, &SEGMENT, &values, turning(12.0)).unwrap();
        let sliding = sliding_segment(&law, &SEGMENT, &values, 12.0).unwrap();
        [
            ElementMatrix::from_diagonal(&moving(&law)),
            ElementMatrix::from_diagonal(&resting.force),
            resting.tangent,
            sliding.stiffness,
            sliding.damping,
        ]
    };
    for ((whole, quarter), none) in of(1.0).into_iter().zip(of(0.25)).zip(of(0.0)) {
        let off = (quarter - none) - (whole - none) * 0.25;
        assert!(whole != none && off.norm() < 1e-14 * whole.norm(), "{off}");
    }
}

/// A shift of the twist turns both ends alike, so that a row of the damping adds up to what the wall does to one end.
#[test]
fn rubbing_of_an_element_is_the_part_of_its_damping_that_acts_on_the_twist() {
    for values in elements_in_the_wall() {
        let tangent = sliding_segment(&parameters(&BASE), &SEGMENT, &values, 0.3).unwrap();
        for (end, row) in [THETA_Z, DOFS + THETA_Z].into_iter().enumerate() {
            let by_twist = tangent.damping[(row, THETA_Z)] + tangent.damping[(row, DOFS + THETA_Z)];
            assert!(by_twist != 0.0);
            assert_close(tangent.rubbing[end], by_twist, 1e-13);
        }
    }
}

#[test]
fn smooth_wall_along_an_element_has_the_derivatives_of_its_force() {
    let law = parameters(&SOFT);
    let mut values = rigid(0.02, 0.028);
    (values[V], values[DOFS + V], values[THETA_X]) = (0.01, -0.004, 2e-3);
    let (width, share) = (1e-3, 0.6);
    let at = |values: &ElementVector, width: f64, share: f64| {
        smooth_static_segment(&law, &SEGMENT, values, turning(12.6), width, share)
    };
    let here = at(&values, width, share);
    let assert_derivative =
        |ahead: ElementVector, behind: ElementVector, step: f64, derivative: ElementVector| {
            let found = (ahead - behind) / (2.0 * step);
            assert!(derivative.norm() > 0.0);
            assert!((found - derivative).norm() < 1e-5 * derivative.norm(), "{found} against {derivative}");
        };
    let step = 1e-7;
    for dof in (0..2 * DOFS).filter(|dof| [U, V, THETA_X, THETA_Y].contains(&(dof % DOFS))) {
        let unit = ElementVector::from_fn(|i, _| if i == dof { step } else { 0.0 });
        let (ahead, behind) = (at(&(values + unit), width, share), at(&(values - unit), width, share));
        assert_derivative(ahead.force, behind.force, step, here.tangent.column(dof).into_owned());
    }
    let (ahead, behind) = (at(&values, width + step, share), at(&values, width - step, share));
    assert_derivative(ahead.force, behind.force, step, here.by_width);
    let (ahead, behind) = (at(&values, width, share + 1e-3), at(&values, width, share - 1e-3));
    assert_derivative(ahead.force, behind.force, 1e-3, here.by_friction);
}

/// Two Gauss points integrate a linear gap exactly: then the smooth wall has the force of the wall itself in the limit.
#[test]
fn smooth_wall_along_an_element_becomes_the_wall_as_its_width_goes_to_zero() {
    let law = parameters(&ContactLaw { stiffness_sharpness: 1e14, ..BASE });
    for values in &elements_in_the_wall()[..2] {
        let wall = static_segment(&law, &SEGMENT, values, turning(-12.6)).unwrap().force;
        let error = |width: f64| {
            (smooth_static_segment(&law, &SEGMENT, values, turning(-12.6), width, 1.0).force - wall).norm()
                / wall.norm()
        };
        let (coarse, fine) = (error(1e-5), error(1e-6));
        assert!(fine < 0.011 * coarse && coarse < 0.01, "{coarse} {fine}");
    }
    let [of_upper, of_lower] = whole_segment(&SEGMENT).map(|(_, wall)| wall);
    for share in
        [|wall: &ContactNode<f64>| wall.stiffness_share, |wall: &ContactNode<f64>| wall.damping_share]
    {
        assert_close(share(&of_upper) + share(&of_lower), share(&SEGMENT.wall), 1e-15);
    }
}

#[test]
fn an_element_across_the_hole_touches_on_both_sides_alike() {
    let law = parameters(&FRICTIONLESS);
    let outside = SEGMENT.wall.clearance + 2e-4;
    let contact = static_segment(&law, &SEGMENT, &rigid(outside, -outside), turning(1.0)).unwrap();
    assert!(contact.force[U] < -1.0 && contact.tangent.norm().is_finite());
    assert_close(contact.force[DOFS + U], -contact.force[U], 1e-12);
    assert_close(contact.ends[0], contact.ends[1], 1e-12);
}

/// A node with shares of stiffness and damping is one with the whole of a law of that stiffness and damping.
#[test]
fn shares_of_a_node_scale_the_law() {
    let sharp = ContactLaw { stiffness: 1e9, stiffness_sharpness: 1e15, damping_sharpness: 1e15, ..BASE };
    for law in [SOFT, sharp] {
        let scaled = ContactLaw { stiffness: 0.3 * law.stiffness, damping: 2.0 * law.damping, ..law };
        let (law, scaled) = (parameters(&law), parameters(&scaled));
        // With the small clearance the node's own force turns it about the axis.
        for clearance in [0.03, 1e-7] {
            let whole = ContactNode { clearance, ..NODE };
            let shared = ContactNode { stiffness_share: 0.3, damping_share: 2.0, ..whole };
            let (u, v) = (0.6 * (clearance + 5e-5), -0.8 * (clearance + 5e-5));
            let motion = LateralMotion { u, v, u_rate: 0.02, v_rate: -0.01, theta_z_rate: 0.1 };
            let yielding = Yielding {
                lateral: 2e-8,
                surface: 3e-8,
                speed: 4e3,
                force: [-900.0, 1200.0],
                normal: 1500.0,
                friction: 200.0,
            };
            let forces = |law: &ContactParameters<f64>, node: &ContactNode<f64>| {
                let moving = dynamic_contact(law, node, &motion, 0.3);
                let implicit = implicit_contact(law, node, &motion, 0.3, &yielding);
                let resting = static_contact(law, node, u, v, turning(0.3));
                let smooth = smooth_static_contact(law, node, [u, v], turning(0.3), 1e-5, 0.6);
                let sliding = sliding_tangent(law, node, u, v, 0.3).unwrap();
                let of_motion =
                    [moving, implicit].map(|contact| [contact.force_u, contact.force_v, contact.torque_z]);
                [
                    of_motion.as_flattened(),
                    &[resting.force_u, resting.force_v, resting.torque_z],
                    resting.tangent.as_flattened(),
                    &smooth.force,
                    smooth.tangent.as_flattened(),
                    &smooth.by_width,
                    &smooth.by_friction,
                    sliding.stiffness.as_flattened(),
                    sliding.damping.as_flattened(),
                ]
                .concat()
            };
            for (found, expected) in forces(&law, &shared).into_iter().zip(forces(&scaled, &whole)) {
                assert_close(found, expected, 1e-11);
            }
        }
    }
}

#[test]
fn forces_on_a_node_turn_with_it_about_the_axis() {
    let sharp = ContactLaw { stiffness: 1e9, stiffness_sharpness: 1e15, damping_sharpness: 1e15, ..BASE };
    for (law, clearance) in [(SOFT, 0.04), (sharp, 1e-7)] {
        let law = parameters(&law);
        let node = ContactNode { clearance, ..NODE };
        let forces = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let turned = |[u, v]: [f64; 2], sin: f64| [cos * u - sin * v, sin * u + cos * v];
            let ([u, v], [u_rate, v_rate]) =
                (turned([clearance + 5e-5, 0.0], sin), turned([0.02, -0.05], sin));
            let motion = LateralMotion { u, v, u_rate, v_rate, theta_z_rate: 0.1 };
            let yielding = Yielding {
                lateral: 2e-8,
                surface: 3e-8,
                speed: 4e3,
                force: turned([-1500.0, -300.0], sin),
                normal: 1500.0,
                friction: 300.0,
            };
            let moving = dynamic_contact(&law, &node, &motion, 0.3);
            let implicit = implicit_contact(&law, &node, &motion, 0.3, &yielding);
            [moving, implicit].map(|contact| {
                let [along, across] = turned([contact.force_u, contact.force_v], -sin);
                [along, across, contact.torque_z]
            })
        };
        let straight = forces(0.0);
        for angle in [0.7, 2.0, -1.1] {
            for (found, expected) in forces(angle).as_flattened().iter().zip(straight.as_flattened()) {
                assert_close(*found, *expected, 1e-9);
            }
        }
    }
}

#[test]
fn shares_of_the_friction_multiply() {
    let law = parameters(&BASE);
    assert_eq!(law.with_friction_share(0.5).with_friction_share(0.25), law.with_friction_share(0.125));
    let none = ContactParameters::new(
        &BASE,
        &ActiveEffects { friction: false, friction_torque: false, ..ActiveEffects::ALL },
    );
    assert_eq!(none.with_friction_share(0.5), none);
}

#[test]
fn friction_and_its_slope_by_one_division_are_those_of_the_curve() {
    for (static_friction, dynamic_friction) in [(0.3, 0.2), (0.3, 0.0), (0.3, 0.3)] {
        let law = parameters(&ContactLaw { static_friction, dynamic_friction, ..BASE });
        for speed in [-2.0, -0.05, 0.0, 1e-4, 0.03, 0.4, 20.0] {
            let (friction, slope) = law.friction.with_slope(speed);
            assert!((friction - law.friction.coefficient(speed)).abs() < 1e-15);
            assert!((slope - law.friction.slope(speed)).abs() < 1e-14 * law.friction.slope(0.0));
        }
    }
}

#[test]
fn a_wall_of_no_width_is_the_wall() {
    let law = parameters(&BASE);
    for (u, v) in [(0.0, 0.0), (0.01, -0.02), (NODE.clearance, 0.0), (0.0302, 0.0268)] {
        let sharp = static_contact(&law, &NODE, u, v, turning(12.6));
        let smooth = smooth_static_contact(&law, &NODE, [u, v], turning(12.6), 0.0, 1.0);
        for (found, expected) in smooth.force.into_iter().zip([sharp.force_u, sharp.force_v, sharp.torque_z])
        {
            assert_close(found, expected, 1e-9);
        }
    }
}

#[test]
fn a_share_of_the_friction_of_the_law_is_one_of_the_smooth_wall() {
    let (law, less) = (parameters(&BASE), parameters(&BASE).with_friction_share(0.25));
    let of = |law, share| smooth_static_contact(law, &NODE, [0.03, -0.026], turning(12.6), 1e-3, share);
    let (found, expected) = (of(&less, 1.0), of(&law, 0.25));
    assert_eq!(
        (found.force, found.tangent, found.by_width),
        (expected.force, expected.tangent, expected.by_width)
    );
    assert_eq!(found.by_friction, expected.by_friction.map(|force| 0.25 * force));
}

/// Force at the end of a step, with the compliance g: `F = N(x + g (L - F))`, x the motion found with the load L. One step of Newton's method leads to
/// `(N + N' g L) / (1 + N' g)`, N' by the place and by the speed with it.
#[test]
fn an_implicit_normal_force_is_one_step_of_newtons_method() {
    let law = ContactLaw { stiffness_sharpness: 1e14, damping_sharpness: 1e14, ..FRICTIONLESS };
    let (parameters, lateral, speed) = (parameters(&law), 3e-8, 700.0);
    let rise = lateral * (law.stiffness + speed * law.damping);
    for load in [0.0, 200.0, 5000.0] {
        let motion = LateralMotion { u: 0.0, v: -0.0403, u_rate: 0.0, v_rate: 0.02, theta_z_rate: 0.0 };
        let yielding =
            Yielding { lateral, surface: lateral, speed, force: [0.0, load], normal: load, friction: 0.0 };
        let free = dynamic_contact(&parameters, &NODE, &motion, 0.0).normal;
        let implicit = implicit_contact(&parameters, &NODE, &motion, 0.0, &yielding);
        assert_close(implicit.normal, (free + rise * load) / (1.0 + rise), 1e-9);
        assert_close(implicit.force_v, implicit.normal, 1e-12);
    }
}

/// Node without friction along the wall: it stays on the line through its place without the wall, r_0 from the axis. Its force solves
/// `F = K (r - j_0) + C s (r - r_0)`, `r = r_0 - g F`, and is found at once, from a force in any direction.
#[test]
fn a_node_without_clearance_and_friction_is_pushed_back_the_way_it_came() {
    let law = ContactLaw { stiffness: 1e9, stiffness_sharpness: 1e15, damping_sharpness: 1e15, ..BASE };
    let parameters = ContactParameters::new(&law, &ActiveEffects { friction: false, ..ActiveEffects::ALL });
    let (lateral, speed, free) = (2e-8, 4e3, [3e-5, -4e-5]);
    for clearance in [1e-9, 1e-7, 1e-5] {
        let node = ContactNode { clearance, ..NODE };
        for force in [[-2000.0, 0.0], [-1200.0, -900.0]] {
            let [u, v] = [0, 1].map(|k| free[k] + lateral * force[k]);
            let [u_rate, v_rate] = force.map(|force| speed * lateral * force);
            let motion = LateralMotion { u, v, u_rate, v_rate, theta_z_rate: 0.0 };
            let yielding =
                Yielding { lateral, surface: lateral, speed, force, normal: 2000.0, friction: 300.0 };
            let contact = implicit_contact(&parameters, &node, &motion, 12.6, &yielding);
            let expected =
                law.stiffness * (5e-5 - clearance) / (1.0 + lateral * (law.stiffness + speed * law.damping));
            assert_close(contact.normal, expected, 1e-6);
            assert_close(contact.force_u, -0.6 * expected, 1e-6);
            assert_close(contact.force_v, 0.8 * expected, 1e-6);
            assert!(contact.torque_z < 0.0);
        }
    }
}

#[test]
fn an_implicit_lane_has_the_bits_of_a_node_alone() {
    let law = ContactLaw { stiffness: 1e9, ..BASE };
    let (one, four) = (parameters(&law), parameters(&law).in_lanes::<Four>());
    // Turned by its own force, short of the wall, not turned, and on the axis.
    let (clearances, radii) = ([1e-7, 0.04, 0.04, 1e-7], [5e-5, 0.03, 0.04001, 0.0]);
    let wide = Four::splat;
    let node = ContactNode {
        clearance: Four::new(clearances),
        contact_radius: wide(0.0635),
        stiffness_share: wide(1.0),
        damping_share: wide(1.0),
        friction: None,
    };
    let motion = LateralMotion {
        u: Four::new(radii.map(|r| 0.6 * r)),
        v: Four::new(radii.map(|r| -0.8 * r)),
        u_rate: wide(0.01),
        v_rate: wide(-0.02),
        theta_z_rate: wide(0.3),
    };
    let yielding = Yielding {
        lateral: wide(2e-8),
        surface: wide(3e-8),
        speed: wide(4e3),
        force: [wide(-1200.0), wide(900.0)],
        normal: wide(1500.0),
        friction: wide(200.0),
    };
    let together = implicit_contact(&four, &node, &motion, wide(0.3), &yielding);
    for (lane, clearance) in clearances.into_iter().enumerate() {
        let node = ContactNode { clearance, ..NODE };
        let motion = LateralMotion {
            u: motion.u.lane(lane),
            v: motion.v.lane(lane),
            u_rate: 0.01,
            v_rate: -0.02,
            theta_z_rate: 0.3,
        };
        let yielding = Yielding {
            lateral: 2e-8,
            surface: 3e-8,
            speed: 4e3,
            force: [-1200.0, 900.0],
            normal: 1500.0,
            friction: 200.0,
        };
        let alone = implicit_contact(&one, &node, &motion, 0.3, &yielding);
        assert_eq!(together.force_u.lane(lane), alone.force_u);
        assert_eq!(together.force_v.lane(lane), alone.force_v);
        assert_eq!(together.torque_z.lane(lane), alone.torque_z);
        assert_eq!(together.normal.lane(lane), alone.normal);
    }
}

/// A string of three elements with its upper two nodes alike, a gauge and a held end.
fn wall(effects: &ActiveEffects) -> Wall {
    let gauge = ContactNode { clearance: 0.001, ..NODE };
    let element = |share: f64| ContactSegment {
        length: 2.0,
        wall: ContactNode { stiffness_share: share, damping_share: 10.0 * share, ..NODE },
    };
    let sites = [Some(NODE), Some(NODE), Some(gauge), None];
    Wall::new(&BASE, effects, sites.into_iter(), [0.2, 0.4, 0.8].map(element).into_iter())
}

#[test]
fn a_wall_has_the_elements_and_the_nodes_that_are_free_to_touch_it() {
    let along = wall(&ActiveEffects::ALL);
    assert_eq!(along.segments().len(), 3);
    assert_eq!(along.touchable().map(|(node, _)| node).collect::<Vec<_>>(), [0, 1, 2]);
    let off = wall(&ActiveEffects { contact: false, ..ActiveEffects::ALL });
    assert!(off.segments().is_empty() && off.touchable().next().is_none());
}

#[test]
fn friction_of_a_wall_at_rest_is_static_or_that_of_sliding() {
    let wall = wall(&ActiveEffects::ALL);
    let mu = |wall: &Wall| wall.law().friction_at_rest(&NODE, turning(0.5)).about;
    assert_eq!(mu(&wall), BASE.static_friction);
    let sliding = wall.with_friction_at_rest(StartFriction::Sliding);
    assert_eq!(mu(&sliding), wall.law().friction.coefficient(0.5 * NODE.contact_radius));
}

#[test]
fn friction_of_a_string_that_turns_and_moves_opposes_the_velocity_of_its_surface() {
    let static_force = |at_rest, motion| {
        static_contact(&parameters(&BASE).with_friction_at_rest(at_rest), &NODE, 0.0402, 0.0, motion)
    };
    for at_rest in [StartFriction::BreakAway, StartFriction::Sliding] {
        // A surface as fast along the axis as about it slides at 45 degrees.
        let speed = 0.3;
        let motion = BodyMotion { rotation_speed: speed / NODE.contact_radius, axial_speed: -speed };
        let force = static_force(at_rest, motion);
        let slid = speed * 2.0_f64.sqrt();
        let mu = match at_rest {
            StartFriction::BreakAway => BASE.static_friction,
            StartFriction::Sliding => parameters(&BASE).friction.coefficient(slid),
        };
        let share = mu * force.normal / 2.0_f64.sqrt();
        assert_close(force.force_v, -share, 1e-12);
        assert_close(force.force_w, share, 1e-12);
        assert_close(force.torque_z, -share * NODE.contact_radius, 1e-12);
        // Without rotation all friction is along the axis.
        let pulled = static_force(at_rest, BodyMotion { rotation_speed: 0.0, axial_speed: -slid });
        assert_close(pulled.force_w, mu * force.normal, 1e-12);
        assert_eq!((pulled.force_v, pulled.torque_z), (0.0, 0.0));
    }
    let slow =
        |axial_speed| static_force(StartFriction::Sliding, BodyMotion { axial_speed, ..turning(12.0) });
    assert_close(slow(1e-9).force_v, slow(0.0).force_v, 1e-12);
}

#[test]
fn axial_friction_has_its_tangent_at_nodes_and_along_elements() {
    let law = parameters(&SOFT).with_friction_at_rest(StartFriction::Sliding);
    let motion = BodyMotion { rotation_speed: 9.0, axial_speed: 0.4 };
    let (u, v) = (0.0402 * 0.8, 0.0402 * 0.6);
    let node = |u, v| static_contact(&law, &NODE, u, v, motion);
    let smooth = |u: f64, v: f64| smooth_static_contact(&law, &NODE, [u, v], motion, 1e-3, 0.7);
    let step = 1e-8;
    for (column, [by_u, by_v]) in [[step, 0.0], [0.0, step]].into_iter().enumerate() {
        let (ahead, behind) = (node(u + by_u, v + by_v), node(u - by_u, v - by_v));
        let slope = (ahead.force_w - behind.force_w) / (2.0 * step);
        assert_close(node(u, v).tangent[3][column], slope, 1e-6);
        let (ahead, behind) = (smooth(u + by_u, v + by_v), smooth(u - by_u, v - by_v));
        let slope = (ahead.force[3] - behind.force[3]) / (2.0 * step);
        assert_close(smooth(u, v).tangent[3][column], slope, 1e-6);
    }
    let values = rigid(0.0402, 0.0405);
    let of = |values: &ElementVector| static_segment(&law, &SEGMENT, values, motion).unwrap();
    let contact = of(&values);
    let direction = law.friction_at_rest(&SEGMENT.wall, motion);
    let drag = contact.force[W] + contact.force[DOFS + W];
    assert_close(drag, -direction.along * (contact.ends[0] + contact.ends[1]), 1e-12);
    for column in [U, THETA_Y, DOFS + U, DOFS + THETA_Y] {
        let moved = |by: f64| {
            let mut values = values;
            values[column] += by;
            of(&values).force
        };
        let slope = (moved(step) - moved(-step)) / (2.0 * step);
        for row in [W, DOFS + W] {
            assert_close(contact.tangent[(row, column)], slope[row], 1e-5);
        }
    }
}

/// Nodal values of a bent element of a helix at `radius` \[m\], of which both ends are `angle` \[rad\] from its middle.
fn helical(radius: f64, angle: f64) -> ElementVector {
    let (sin, cos) = angle.sin_cos();
    let mut values = rigid(radius * cos, radius * cos);
    (values[V], values[DOFS + V]) = (-radius * sin, radius * sin);
    // The parabola through both ends goes through the middle at the radius.
    let turn = 4.0 * radius * (1.0 - cos) / SEGMENT.length;
    (values[THETA_Y], values[DOFS + THETA_Y]) = (turn, -turn);
    let lean = -2.0 * radius * sin / SEGMENT.length;
    (values[THETA_X], values[DOFS + THETA_X]) = (lean, lean);
    values
}

/// Elements on a helix have their ends and their middle in the wall, and so the whole parabola through these gaps, but not all of the parabolas of u and v.
#[test]
fn loads_on_an_element_that_only_slides_with_the_rotation_are_those_at_rest() {
    let law = parameters(&BASE).with_friction_at_rest(StartFriction::Sliding);
    let helices = [1e-3, 1e-4, 1e-5, 1e-6].map(|gap| helical(SEGMENT.wall.clearance + gap, 0.5));
    for values in elements_in_the_wall().into_iter().chain(helices) {
        let resting = static_segment(&law, &SEGMENT, &values, turning(2.0)).unwrap();
        let mut moving = SegmentForce::none();
        let motion = motion_of(&values, &ElementVector::zeros());
        assert!(dynamic_segment(&law, &SEGMENT, &motion, 2.0, &mut moving));
        for (found, expected) in moving.ends.into_iter().zip(resting.ends) {
            assert_close(found, expected, 1e-12);
        }
        let [in_u, in_v] = planes(&resting.force);
        let size = resting.force.norm();
        for (found, expected) in
            [moving.load(0), moving.load(1)].as_flattened().iter().zip([in_u, in_v].as_flattened())
        {
            assert!((found - expected).abs() < 1e-12 * size, "{moving:?} instead of {resting:?}");
        }
    }
}
