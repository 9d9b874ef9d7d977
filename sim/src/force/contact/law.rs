//! The laws of normal force and friction of one node.

use std::f64::consts::PI;

use drillsweep_scenario::{ActiveEffects, Adhesion, ContactLaw, StartFriction};

use super::node::ContactNode;
use crate::math::linalg::{Lane, Mask};

/// A [`ContactLaw`] with its switches, prepared for evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactParameters<L> {
    stiffness: Saturating<L>,
    damping: Saturating<L>,
    /// Least normal force \[N\]: zero without adhesion, minus infinity with it.
    least_normal_force: L,
    /// mu_s.
    static_friction: L,
    /// 1 / (2 v_ref) \[s/m\]; zero without friction.
    half_slope: L,
    /// xi of (14).
    xi: L,
    /// Decay a of (14) \[s/m\].
    decay: L,
    /// 1/a \[m/s\], the scale of the sliding speed in (14); infinite without friction.
    reach: L,
    /// True if there is friction: without it, its coefficient is not evaluated.
    pub(super) has_friction: bool,
    /// Friction of a node at rest.
    at_rest: StartFriction,
    /// 1 if friction pushes along the wall, 0 if that is switched off.
    pub(super) tangential_share: L,
    /// 1 if friction turns the string, 0 if that is switched off.
    pub(super) torque_share: L,
}

/// A coefficient that rises by an arctangent from half its limit at P = 0 (11).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Saturating<L> {
    half_limit: L,
    limit_over_pi: L,
    /// pi lambda \[1/m\].
    sharpness: L,
}

impl<L: Lane> ContactParameters<L> {
    /// The same law in every lane.
    ///
    /// `friction` off removes the force along the wall and `friction_torque` off the torque about the axis, each
    /// on its own. The caller checks that there is contact at all.
    pub fn new(law: &ContactLaw, effects: &ActiveEffects) -> Self {
        let (static_friction, dynamic_friction) = (law.static_friction, law.dynamic_friction);
        let frictionless = static_friction == 0.0;
        let ratio = if frictionless { 1.0 } else { dynamic_friction / static_friction };
        let xi = (1.0 - ratio).sqrt();
        let half_slope = if frictionless { 0.0 } else { 0.5 / law.friction_reference_speed };
        // a = (1 - xi) / (2 v_ref mu_d); 1 - xi = (mu_d/mu_s) / (1 + xi) avoids the quotient 0/0 for mu_d = 0.
        let decay = if frictionless { 0.0 } else { half_slope / (static_friction * (1.0 + xi)) };
        let share = |is_on: bool| L::splat(if is_on { 1.0 } else { 0.0 });
        ContactParameters {
            stiffness: Saturating::new(law.stiffness, law.stiffness_sharpness),
            damping: Saturating::new(law.unit_damping(), law.damping_sharpness),
            least_normal_force: L::splat(match law.adhesion {
                Adhesion::Allowed => f64::NEG_INFINITY,
                Adhesion::None => 0.0,
            }),
            static_friction: L::splat(static_friction),
            half_slope: L::splat(half_slope),
            xi: L::splat(xi),
            decay: L::splat(decay),
            reach: L::splat(1.0 / decay),
            has_friction: !frictionless && (effects.friction || effects.friction_torque),
            at_rest: StartFriction::default(),
            tangential_share: share(effects.friction),
            torque_share: share(effects.friction_torque),
        }
    }

    /// Stiffness K_c(P) \[N/m\], (11), of a node with the whole stiffness of the law.
    #[inline(always)]
    pub fn stiffness(&self, penetration: L) -> L {
        self.stiffness.at(penetration)
    }

    /// Damping C_c(P) \[N s/m\], (11), of a node with the whole damping of the law.
    #[inline(always)]
    pub fn damping(&self, penetration: L) -> L {
        self.damping.at(penetration)
    }

    /// Stiffness K_c \[N/m\] far inside the wall, of a node with the whole stiffness of the law.
    #[inline(always)]
    pub(super) fn largest_stiffness(&self) -> L {
        self.stiffness.half_limit + self.stiffness.half_limit
    }

    /// A normal force \[N\], which does not pull if the law has no adhesion.
    #[inline(always)]
    pub(super) fn limited(&self, normal_force: L) -> L {
        normal_force.max(self.least_normal_force)
    }

    /// The sliding speed \[m/s\] from which on friction hardly changes with it: the curve's slope is below a hundredth of that at
    /// rest, whatever mu_d / mu_s.
    #[inline(always)]
    pub(super) fn fast_sliding(&self) -> L {
        L::splat(FAST_SLIDING) * self.reach
    }

    /// Friction coefficient mu(v_g) of (14), odd in the sliding speed \[m/s\]: slope 1 / v_ref at rest, mu_s
    /// at its peak 2 v_ref mu_d / (xi (1 - xi)), mu_d for fast sliding.
    #[inline(always)]
    pub fn friction_coefficient(&self, sliding_speed: L) -> L {
        let one = L::splat(1.0);
        let fade = one / self.decay.mul_add(sliding_speed.abs(), one);
        let shape = (one + self.xi).mul_add(fade, one - self.xi) * fade;
        sliding_speed * self.half_slope * shape
    }

    /// d(mu)/d(v_g) of (14) \[s/m\]: 1 / v_ref at rest, negative on the velocity-weakening branch.
    #[inline(always)]
    pub fn friction_slope(&self, sliding_speed: L) -> L {
        let one = L::splat(1.0);
        let run = self.decay * sliding_speed.abs();
        let fade = one / (run + one);
        let twice = (one + self.xi) * fade;
        let shape = (twice + (one - self.xi)) * fade;
        self.half_slope * (shape - run * fade * fade * (twice + twice + (one - self.xi)))
    }

    /// Solves `s + response mu(s) = unopposed` for the sliding speed s \[m/s\]. `response` \[m/s\], 0 or more, is the reduction of the sliding speed
    /// by a friction coefficient of one, and `unopposed` is the sliding speed without friction. Of several solutions the one nearest to rest is
    /// returned.
    ///
    /// In `q = a s`, with `w = 1 + q`, `rho = response / (2 v_ref)` and `tau = a unopposed`, the equation is
    /// `f(q) = q + rho q (2 + (1 - xi) q) / w^2 - tau = 0`, and f w^2 is a cubic. Halley's method finds its root with one division an
    /// iteration. It starts from the root of the quadratic with `2 q / (1 + (3 + xi)/2 q)` in place of the friction curve, which has the
    /// curve's slope and curvature at rest. A lane stays unchanged once it has converged, so that its bits do not depend on its
    /// neighbours.
    #[inline(always)]
    pub fn opposed_sliding_speed(&self, unopposed: L, response: L) -> L {
        let splat = L::splat;
        let (zero, one, two) = (splat(0.0), splat(1.0), splat(2.0));
        let limit = unopposed.abs();
        let (tau, rho) = (self.decay * limit, self.half_slope * response);
        let (above, twice_rho) = (one + self.xi, rho + rho);
        let (second, first) = (rho.mul_add(one - self.xi, two - tau), one - (tau + tau) + twice_rho);

        let bend = splat(0.5) * (two + above);
        let linear = one + twice_rho - bend * tau;
        let root = (splat(4.0) * bend).mul_add(tau, linear * linear).sqrt();
        let mut q = ((tau + tau) / (linear + root)).min(tau);
        let mut moves = L::Mask::splat(true);
        for _ in 0..OPPOSED_ITERATIONS {
            let w = one + q;
            let cube = w * w * w;
            // f w^2, f' w^3 and f'' w^4.
            let value = (q + second).mul_add(q, first).mul_add(q, -tau);
            let slope = twice_rho.mul_add(above - self.xi * w, cube).max(splat(SMALLEST_RISE) * cube);
            let curvature = twice_rho * (two * self.xi * w - splat(3.0) * above);
            let square = slope * slope;
            let divisor = (square + square - value * curvature).max(square);
            let next = (q - two * value * slope * w / divisor).max(zero).min(tau);
            let step = (next - q).abs();
            q = L::select(moves, next, q);
            moves = moves & step.greater_than(splat(LAST_STEP) * w);
            if !moves.any() {
                break;
            }
        }
        (q * self.reach).min(limit).copysign(unopposed)
    }

    /// Solves `s_i + sum_j response_ij mu(s_j) = unopposed_i` for the sliding speeds s_i \[m/s\] of two points that move with each other's
    /// friction. `response` \[m/s\] is the change of the sliding speeds (rows) by friction coefficients of one (columns).
    ///
    /// Newton's method starts from the speeds that the points would have with one common friction coefficient. Bounds hold on the velocity-weakening
    /// branch: each step's matrix is kept regular, and no speed exceeds the sum of the unopposed ones.
    #[inline(always)]
    pub(super) fn opposed_sliding_speeds(&self, unopposed: [L; 2], response: [[L; 2]; 2]) -> [L; 2] {
        let (one, smallest) = (L::splat(1.0), L::splat(SMALLEST_RISE));
        let most = unopposed[0].abs() + unopposed[1].abs();
        let left = |speeds: &[L; 2], friction: [L; 2]| {
            [0, 1].map(|i| {
                response[i][0].mul_add(friction[0], response[i][1].mul_add(friction[1], speeds[i]))
                    - unopposed[i]
            })
        };
        let in_common = [
            self.opposed_sliding_speed(unopposed[0], response[0][0] + response[0][1]),
            self.opposed_sliding_speed(unopposed[1], response[1][0] + response[1][1]),
        ];
        let mut speeds = in_common;
        let mut moves = L::Mask::splat(true);
        let mut at_start = L::splat(0.0);
        for iteration in 0..OPPOSED_PAIR_ITERATIONS {
            let (first, first_slope) = self.friction_with_slope(speeds[0]);
            let (second, second_slope) = self.friction_with_slope(speeds[1]);
            let excess = left(&speeds, [first, second]);
            if iteration == 0 {
                at_start = excess[0].abs().max(excess[1].abs());
            }
            let rise = [
                response[0][0].mul_add(first_slope, one).max(smallest),
                response[1][1].mul_add(second_slope, one).max(smallest),
            ];
            let coupling = [response[0][1] * second_slope, response[1][0] * first_slope];
            let determinant = (rise[0] * rise[1] - coupling[0] * coupling[1]).max(smallest);
            let per_determinant = one / determinant;
            let step = [
                (rise[1] * excess[0] - coupling[0] * excess[1]) * per_determinant,
                (rise[0] * excess[1] - coupling[1] * excess[0]) * per_determinant,
            ];
            for (speed, step) in speeds.iter_mut().zip(step) {
                *speed = L::select(moves, (*speed - step).max(-most).min(most), *speed);
            }
            let largest = step[0].abs().max(step[1].abs()) * self.decay;
            moves = moves & largest.greater_than(L::splat(LAST_PAIR_STEP));
            if !moves.any() {
                break;
            }
        }
        // Next to a fold, if friction falls faster than the speeds, steps may lead away.
        let excess =
            left(&speeds, [self.friction_coefficient(speeds[0]), self.friction_coefficient(speeds[1])]);
        let is_closer = !excess[0].abs().max(excess[1].abs()).greater_than(at_start);
        [L::select(is_closer, speeds[0], in_common[0]), L::select(is_closer, speeds[1], in_common[1])]
    }

    /// [Coefficient](Self::friction_coefficient) and [slope](Self::friction_slope) of friction at a sliding speed \[m/s\], by one division.
    #[inline(always)]
    pub(super) fn friction_with_slope(&self, sliding_speed: L) -> (L, L) {
        let one = L::splat(1.0);
        let run = self.decay * sliding_speed.abs();
        let fade = one / (run + one);
        let (twice, rest) = ((one + self.xi) * fade, one - self.xi);
        let shape = twice + rest;
        let friction = sliding_speed * self.half_slope * shape * fade;
        let slope = self.half_slope * fade * (shape - run * fade * (twice + shape));
        (friction, slope)
    }

    /// Energy \[J\] stored by the contact stiffness of such a node, the integral of K_c(p) p from 0 to P; zero without contact.
    pub fn potential_energy(&self, penetration: L) -> L {
        let p = penetration.max(L::splat(0.0));
        self.stiffness.first_moment(p)
    }

    /// d(K_c(P) P)/dP.
    #[inline(always)]
    pub(super) fn elastic_slope(&self, penetration: L) -> L {
        let saturation = self.stiffness.sharpness * penetration;
        let rise = self.stiffness.limit_over_pi * saturation / saturation.mul_add(saturation, L::splat(1.0));
        self.stiffness(penetration) + rise
    }
}

impl ContactParameters<f64> {
    /// The law with another friction of nodes at rest; that in motion is the same.
    #[must_use]
    pub fn with_friction_at_rest(self, at_rest: StartFriction) -> Self {
        Self { at_rest, ..self }
    }

    /// The law with a share of its friction, at rest and in motion.
    #[cfg(test)]
    pub(super) fn with_friction_share(self, share: f64) -> Self {
        Self {
            tangential_share: share * self.tangential_share,
            torque_share: share * self.torque_share,
            ..self
        }
    }

    /// Friction coefficient of a node at rest in a frame that turns with `rotation_speed` Omega \[rad/s\], in its sense: mu_s at
    /// break-away (36), or mu at the sliding speed Omega R_e (14). Without rotation friction has no sense, and is zero.
    pub fn friction_at_rest(&self, node: &ContactNode<f64>, rotation_speed: f64) -> f64 {
        match self.at_rest {
            StartFriction::BreakAway if rotation_speed == 0.0 => 0.0,
            StartFriction::BreakAway => rotation_speed.signum() * self.static_friction,
            StartFriction::Sliding => self.friction_coefficient(rotation_speed * node.contact_radius),
        }
    }

    /// The same law in every lane.
    pub fn in_lanes<L: Lane>(&self) -> ContactParameters<L> {
        let splat = L::splat;
        ContactParameters {
            stiffness: self.stiffness.in_lanes(),
            damping: self.damping.in_lanes(),
            least_normal_force: splat(self.least_normal_force),
            static_friction: splat(self.static_friction),
            half_slope: splat(self.half_slope),
            xi: splat(self.xi),
            decay: splat(self.decay),
            reach: splat(self.reach),
            has_friction: self.has_friction,
            at_rest: self.at_rest,
            tangential_share: splat(self.tangential_share),
            torque_share: splat(self.torque_share),
        }
    }
}

impl Saturating<f64> {
    fn in_lanes<L: Lane>(&self) -> Saturating<L> {
        Saturating {
            half_limit: L::splat(self.half_limit),
            limit_over_pi: L::splat(self.limit_over_pi),
            sharpness: L::splat(self.sharpness),
        }
    }
}

impl<L: Lane> Saturating<L> {
    fn new(limit: f64, sharpness: f64) -> Self {
        Saturating {
            half_limit: L::splat(0.5 * limit),
            limit_over_pi: L::splat(limit / PI),
            sharpness: L::splat(PI * sharpness),
        }
    }

    #[inline(always)]
    fn at(&self, penetration: L) -> L {
        (self.sharpness * penetration).atan().mul_add(self.limit_over_pi, self.half_limit)
    }

    /// The integral of the coefficient times p from 0 to P >= 0.
    ///
    /// With y = sharpness P, the integral of p atan(sharpness p) is ((1 + y^2) atan y - y) / (2 sharpness^2);
    /// for small y that bracket is 2 y^3 (1/3 - y^2/15 + y^4/35 - ...), summed here as a series.
    fn first_moment(&self, penetration: L) -> L {
        let y = self.sharpness * penetration;
        let y_squared = y * y;
        let terms = (1..=SERIES_TERMS).rev().map(|k| {
            let k = k as f64;
            let sign = if k % 2.0 == 1.0 { 1.0 } else { -1.0 };
            sign / ((2.0 * k - 1.0) * (2.0 * k + 1.0))
        });
        let series = terms.fold(L::splat(0.0), |sum, term| sum.mul_add(y_squared, L::splat(term)));
        let small = y * series;
        let large = L::splat(0.5) * (y.atan() + (y.atan() - y) / y_squared);
        let bend = L::select(y.less_than(L::splat(SERIES_LIMIT)), small, large);
        penetration * penetration * self.limit_over_pi.mul_add(bend, L::splat(0.5) * self.half_limit)
    }
}

/// Sliding speed of fast sliding in multiples of 1/a of (14).
const FAST_SLIDING: f64 = 16.0;

/// Largest number of iterations for an opposed sliding speed. Over responses and speeds with a single solution (f' above 0.05), most
/// need one and a few in a thousand more than three, and they leave less than 1e-8 of mu_s; next to a fold, beyond which friction falls faster
/// than the speed, no number of them is enough for all.
const OPPOSED_ITERATIONS: usize = 6;

/// Largest number of Newton iterations for two such speeds: they leave less than 1e-5 m/s of the equations of the tested laws.
const OPPOSED_PAIR_ITERATIONS: usize = 6;

/// Change of q, over w, after which a lane has converged: an iteration cubes the error.
const LAST_STEP: f64 = 1e-3;

/// Change of both times a after which a lane has converged: Newton's method squares the error.
const LAST_PAIR_STEP: f64 = 1e-4;

/// Least slope of the equation of the sliding speed, if friction falls faster than the speed: it bounds an iteration to ten times the
/// step without friction.
const SMALLEST_RISE: f64 = 0.1;

/// Value of y below which the series is summed; nine terms leave a remainder below y^18.
const SERIES_LIMIT: f64 = 0.1;
const SERIES_TERMS: u32 = 9;
