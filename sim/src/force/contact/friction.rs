//! Friction at the wall over the sliding speed, equation (14).

use drillsweep_scenario::{ContactLaw, Hole};

use crate::math::linalg::{Lane, Mask};

/// A friction curve, prepared for evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction<L> {
    /// mu_s.
    pub(super) at_break_away: L,
    /// 1 / (2 v_ref) \[s/m\]; zero without friction.
    half_slope: L,
    /// xi of (14).
    xi: L,
    /// Decay a of (14) \[s/m\].
    decay: L,
    /// 1/a \[m/s\], the scale of the sliding speed in (14); zero without friction, where every speed is far beyond it.
    reach: L,
}

impl<L: Lane> Friction<L> {
    /// Friction of mu_s and mu_d with the reference speed v_ref \[m/s\].
    pub fn new(static_friction: f64, dynamic_friction: f64, reference_speed: f64) -> Self {
        let frictionless = static_friction == 0.0;
        let ratio = if frictionless { 1.0 } else { dynamic_friction / static_friction };
        let xi = (1.0 - ratio).sqrt();
        let half_slope = if frictionless { 0.0 } else { 0.5 / reference_speed };
        // a = (1 - xi) / (2 v_ref mu_d); 1 - xi = (mu_d/mu_s) / (1 + xi) avoids the quotient 0/0 for mu_d = 0.
        let decay = if frictionless { 0.0 } else { half_slope / (static_friction * (1.0 + xi)) };
        Self {
            at_break_away: L::splat(static_friction),
            half_slope: L::splat(half_slope),
            xi: L::splat(xi),
            decay: L::splat(decay),
            reach: L::splat(if frictionless { 0.0 } else { 1.0 / decay }),
        }
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
    pub fn coefficient(&self, sliding_speed: L) -> L {
        let one = L::splat(1.0);
        let fade = one / self.decay.mul_add(sliding_speed.abs(), one);
        let shape = (one + self.xi).mul_add(fade, one - self.xi) * fade;
        sliding_speed * self.half_slope * shape
    }

    /// d(mu)/d(v_g) of (14) \[s/m\]: 1 / v_ref at rest, negative on the velocity-weakening branch.
    #[inline(always)]
    pub fn slope(&self, sliding_speed: L) -> L {
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
    pub fn opposed_speed(&self, unopposed: L, response: L) -> L {
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
    pub(super) fn opposed_speeds(&self, unopposed: [L; 2], response: [[L; 2]; 2]) -> [L; 2] {
        let (one, smallest) = (L::splat(1.0), L::splat(SMALLEST_RISE));
        let most = unopposed[0].abs() + unopposed[1].abs();
        let left = |speeds: &[L; 2], friction: [L; 2]| {
            [0, 1].map(|i| {
                response[i][0].mul_add(friction[0], response[i][1].mul_add(friction[1], speeds[i]))
                    - unopposed[i]
            })
        };
        let in_common = [
            self.opposed_speed(unopposed[0], response[0][0] + response[0][1]),
            self.opposed_speed(unopposed[1], response[1][0] + response[1][1]),
        ];
        let mut speeds = in_common;
        let mut moves = L::Mask::splat(true);
        let mut at_start = L::splat(0.0);
        for iteration in 0..OPPOSED_PAIR_ITERATIONS {
            let (first, first_slope) = self.with_slope(speeds[0]);
            let (second, second_slope) = self.with_slope(speeds[1]);
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
        let excess = left(&speeds, [self.coefficient(speeds[0]), self.coefficient(speeds[1])]);
        let is_closer = !excess[0].abs().max(excess[1].abs()).greater_than(at_start);
        [L::select(is_closer, speeds[0], in_common[0]), L::select(is_closer, speeds[1], in_common[1])]
    }

    /// [Coefficient](Self::coefficient) and [slope](Self::slope) of friction at a sliding speed \[m/s\], by one division.
    #[inline(always)]
    pub(super) fn with_slope(&self, sliding_speed: L) -> (L, L) {
        let one = L::splat(1.0);
        let run = self.decay * sliding_speed.abs();
        let fade = one / (run + one);
        let (twice, rest) = ((one + self.xi) * fade, one - self.xi);
        let shape = twice + rest;
        let friction = sliding_speed * self.half_slope * shape * fade;
        let slope = self.half_slope * fade * (shape - run * fade * (twice + shape));
        (friction, slope)
    }
}

impl Friction<f64> {
    /// Friction of a hole section; absent if it is that of the law.
    pub fn of_hole(hole: &Hole, law: &ContactLaw) -> Option<Self> {
        let (own, common) =
            ((hole.static_friction, hole.dynamic_friction), (law.static_friction, law.dynamic_friction));
        (own != common).then(|| Self::new(own.0, own.1, law.friction_reference_speed))
    }

    /// The same friction in every lane.
    pub fn in_lanes<L: Lane>(&self) -> Friction<L> {
        Self::of_lanes(|_| *self)
    }

    /// Friction of each lane.
    pub fn of_lanes<L: Lane>(friction: impl Fn(usize) -> Self) -> Friction<L> {
        let lanes = |value: fn(&Self) -> f64| {
            let mut lanes = L::splat(0.0);
            (0..L::LANES).for_each(|lane| lanes.set_lane(lane, value(&friction(lane))));
            lanes
        };
        Friction {
            at_break_away: lanes(|friction| friction.at_break_away),
            half_slope: lanes(|friction| friction.half_slope),
            xi: lanes(|friction| friction.xi),
            decay: lanes(|friction| friction.decay),
            reach: lanes(|friction| friction.reach),
        }
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
