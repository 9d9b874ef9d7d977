//! Contact along an element: the law of the wall, integrated over the part of the element that is in the wall.
//!
//! The deflection between the nodes is the parabola through its values at both ends and in the middle, and so is the gap g = r - j0. The wall stores
//! K_c/2 times the integral of g^2 over the part with a positive gap. Its forces are the exact derivatives of that energy, so that they do no work
//! along any closed path, and they change without steps as parts of the element come into the wall, merge and leave it. (A Gauss rule on that part
//! has neither property: its forces can excite a string that moves through them, and Newton's method found no equilibrium on elements longer than the
//! length over which the wall spreads a force.) The forces act at two points of the element, the Gauss points of the weight g, which carry the same
//! force and the same first three moments as the whole.

use nalgebra::Vector3;

use super::law::ContactParameters;
use super::motion::{LateralMotion, Surface};
use super::node::ContactNode;
use crate::math::linalg::{Lane, Mask};

/// Contact data of an element of the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSegment<L> {
    /// Length l \[m\].
    pub length: L,
    /// Clearance and contact radius of the element, and the shares of its whole length in stiffness and damping of the law.
    pub wall: ContactNode<L>,
}

/// Deflection and slope of both ends of an element in one plane: (u, theta_y) of the upper node and of the lower one, or (v, -theta_x)
/// \[m, rad\]; with forces, the loads that do work on these \[N, N m\].
pub type Plane<L> = [L; 4];

/// Motion of the ends of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentMotion<L> {
    /// Displacements in the planes of u and of v.
    pub planes: [Plane<L>; 2],
    /// Their rates.
    pub rates: [Plane<L>; 2],
    /// d(theta_z)/dt of both ends \[rad/s\].
    pub twist_rates: [L; 2],
}

/// Consistent nodal loads of the wall on an element; all zero without contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentForce<L> {
    /// Loads of the normal forces in the planes of u and of v.
    pub normal: [Plane<L>; 2],
    /// Loads of friction in the same planes.
    pub friction: [Plane<L>; 2],
    /// Friction torques about the string at both ends \[N m\].
    pub torque: [L; 2],
    /// Normal forces \[N\], shared between the ends in proportion to their nearness.
    pub ends: [L; 2],
    /// Centre of the pressure, from 0 at the upper end to 1; 1/2 without contact.
    pub middle: L,
}

/// Compliance of an element to loads on it, which makes the wall's force implicit along the element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentCompliance<L> {
    /// Upper triangle, row by row, of the matrix from loads in a plane to displacements in it, the mean of both planes
    /// \[m/N, 1/N, 1/(N m)\].
    pub lateral: [L; 10],
    /// Twist by torque: at the upper end, between both ends, at the lower end \[rad/(N m)\].
    pub twist: [L; 3],
}

/// A part of an element, from 0 at the upper end to 1 at the lower one; empty if both ends are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval<L> {
    pub(super) from: L,
    pub(super) to: L,
}

/// The gap along an element: `upper + rise x + bend x^2` \[m\], x from 0 at the upper end to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap<L> {
    upper: L,
    lower: L,
    rise: L,
    bend: L,
}

/// The parts of an element in the wall, with the gap along it.
struct Contact<L> {
    gap: Gap<L>,
    first: Interval<L>,
    /// The other part if a gap opens between two outer ones; empty in most cases.
    second: Interval<L>,
}

/// The penetration along an element, represented by two points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pressed<L> {
    /// Gauss points of the penetration as a weight.
    pub(super) places: [Place<L>; 2],
    /// Their parts of its integral, together 1.
    pub(super) parts: [L; 2],
    /// Mean penetration of the whole element \[m\], 0 out of the wall; zero without contact.
    pub(super) depth: L,
    /// Root mean square penetration of the whole element \[m\], 0 out of the wall.
    pub(super) rms: L,
    /// Part of the element in the wall.
    pub(super) share: L,
    /// Centre of the penetration; 1/2 without contact.
    middle: L,
}

/// Derivatives of a [`Pressed`] by the gaps at the upper end, in the middle and at the lower end.
pub(super) struct PressedSlopes {
    /// Of the places of both points \[1/m\].
    pub(super) at: [Vector3<f64>; 2],
    /// Of their parts \[1/m\].
    pub(super) parts: [Vector3<f64>; 2],
    /// Of the mean penetration.
    pub(super) depth: Vector3<f64>,
    /// Of the root mean square penetration.
    pub(super) rms: Vector3<f64>,
}

/// Comparison of whole elements with the wall, before any roots are taken.
struct Reach<L: Lane> {
    /// Lanes that may touch.
    may_touch: L::Mask,
    /// Lanes whose whole element is in the wall.
    whole: L::Mask,
}

/// Interpolation at one place of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place<L> {
    /// Place, from 0 at the upper end to 1 at the lower one.
    pub(super) at: L,
    /// Shape functions of the deflection.
    pub(super) shape: Plane<L>,
}

/// A point of an element in the wall.
#[derive(Debug, Clone, Copy)]
struct Point<L: Lane> {
    place: Place<L>,
    surface: Surface<L>,
    /// Change of the normal force by penetration in an implicit solve \[N/m\].
    slope: L,
    /// Normal force of the law \[N\].
    normal: L,
}

/// Consistent nodal loads of the wall on an element in motion, at rotation speed Omega \[rad/s\]: the law (10) to (14). False if no lane touches;
/// then
/// `force` is unchanged.
#[inline(always)]
pub fn dynamic_segment<L: Lane>(
    law: &ContactParameters<L>,
    segment: &ContactSegment<L>,
    motion: &SegmentMotion<L>,
    rotation_speed: L,
    force: &mut SegmentForce<L>,
) -> bool {
    let zero = L::splat(0.0);
    let Some(pressed) = segment.pressed(&motion.planes) else { return false };
    *force = SegmentForce::none();
    force.middle = pressed.middle;
    for point in segment.points(law, &pressed, motion, rotation_speed, zero) {
        let friction = if law.has_friction {
            law.friction_of(&segment.wall).coefficient(point.surface.sliding_speed) * point.normal.abs()
        } else {
            zero
        };
        segment.add(law, &point, point.normal, friction, force);
    }
    true
}

/// Loads of the same law that agree with the motion that they cause, as far as the element's own loads move it: normal forces of both
/// points by one step of Newton's method, frictions of both by a solution of the whole friction curve. On entry `force` holds the loads that
/// the motion was found with, or none, and on return the new ones; `speed` is the ratio of a change of velocity to that of displacement \[1/s\].
/// False if no lane touches; then `force` is unchanged.
#[inline(always)]
pub fn implicit_segment<L: Lane>(
    law: &ContactParameters<L>,
    segment: &ContactSegment<L>,
    motion: &SegmentMotion<L>,
    rotation_speed: L,
    (compliance, speed): (&SegmentCompliance<L>, L),
    force: &mut SegmentForce<L>,
) -> bool {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let Some(pressed) = segment.pressed(&motion.planes) else { return false };
    // Loads that the motion was found with.
    let (load_u, load_v, load_torque) = (force.load(0), force.load(1), force.torque);
    *force = SegmentForce::none();
    force.middle = pressed.middle;
    let [p, q] = segment.points(law, &pressed, motion, rotation_speed, speed);
    // Displacements of the ends by 1 N at each point.
    let (by_p, by_q) = (compliance.of_load(&p.place.shape), compliance.of_load(&q.place.shape));
    let own = [dot(&by_p, &p.place.shape), dot(&by_q, &q.place.shape)];
    let between = dot(&by_p, &q.place.shape);
    // Displacements of the points by those loads.
    let moved_p = [dot(&by_p, &load_u), dot(&by_p, &load_v)];
    let moved_q = [dot(&by_q, &load_u), dot(&by_q, &load_v)];

    let inwards = |[n_u, n_v]: [L; 2], [u, v]: [L; 2]| n_u.mul_add(u, n_v * v);
    let unloaded = [
        p.normal - p.slope * inwards(p.surface.normal, moved_p),
        q.normal - q.slope * inwards(q.surface.normal, moved_q),
    ];
    let rise = [p.slope.mul_add(own[0], one), q.slope.mul_add(own[1], one)];
    let coupling = [p.slope * between, q.slope * between];
    let per_determinant = one / (rise[0] * rise[1] - coupling[0] * coupling[1]);
    let normal = [
        law.limited((rise[1] * unloaded[0] - coupling[0] * unloaded[1]) * per_determinant),
        law.limited((rise[0] * unloaded[1] - coupling[1] * unloaded[0]) * per_determinant),
    ];

    let mut friction = [zero; 2];
    if law.has_friction {
        let curve = law.friction_of(&segment.wall);
        let pressed = [normal[0].abs(), normal[1].abs()];
        let mut speeds = [p.surface.sliding_speed, q.surface.sliding_speed];
        let slow = speeds[0].abs().min(speeds[1].abs()).less_than(curve.fast_sliding());
        if slow.any() {
            let radius = segment.wall.contact_radius;
            let along = |[n_u, n_v]: [L; 2], [u, v]: [L; 2]| n_u.mul_add(v, -(n_v * u));
            let free = |point: &Point<L>, moved: [L; 2]| {
                let turned = compliance.twist_at(point.place.at, load_torque);
                let way = turned.mul_add(radius, along(point.surface.normal, moved));
                point.surface.sliding_speed - speed * way
            };
            let twisted = |at: L, by: L| compliance.twist_at(at, [one - by, by]) * radius * radius;
            let response = |lateral: L, twist: L| {
                speed * twist.mul_add(law.torque_share, lateral * law.tangential_share)
            };
            let cross = response(between, twisted(p.place.at, q.place.at));
            let responses = [
                [response(own[0], twisted(p.place.at, p.place.at)) * pressed[0], cross * pressed[1]],
                [cross * pressed[0], response(own[1], twisted(q.place.at, q.place.at)) * pressed[1]],
            ];
            let opposed = curve.opposed_speeds([free(&p, moved_p), free(&q, moved_q)], responses);
            for (speed, opposed) in speeds.iter_mut().zip(opposed) {
                *speed = L::select(slow, opposed, *speed);
            }
        }
        friction = [curve.coefficient(speeds[0]) * pressed[0], curve.coefficient(speeds[1]) * pressed[1]];
    }
    segment.add(law, &p, normal[0], friction[0], force);
    segment.add(law, &q, normal[1], friction[1], force);
    true
}

impl<L: Lane> ContactSegment<L> {
    /// The penetration of an element; `None` if no lane touches.
    #[inline(always)]
    pub(super) fn pressed(&self, planes: &[Plane<L>; 2]) -> Option<Pressed<L>> {
        let Contact { gap, first, second } = self.contact(planes)?;
        let (zero, half, one) = (L::splat(0.0), L::splat(0.5), L::splat(1.0));
        let (mut moments, mut square) = gap.moments(&first);
        let mut share = first.length();
        if second.is_anywhere() {
            let (others, others_square) = gap.moments(&second);
            let [of_0, of_1, of_2, of_3] = others;
            // About the upper end of the first.
            let shift = second.from - first.from;
            let twice = shift.mul_add(of_0, of_1);
            let thrice = shift.mul_add(twice + of_1, of_2);
            moments[0] = moments[0] + of_0;
            moments[1] = moments[1] + twice;
            moments[2] = moments[2] + thrice;
            moments[3] = moments[3] + shift.mul_add(thrice + shift.mul_add(of_1, of_2 + of_2), of_3);
            square = square + others_square;
            share = share + second.length();
        }
        let touches = moments[0].greater_than(zero);
        let depth = L::select(touches, moments[0], zero);
        let per_depth = one / L::select(touches, depth, one);
        let [mean, second_moment, third_moment] = [1, 2, 3].map(|k| moments[k] * per_depth);
        let variance = (second_moment - mean * mean).max(zero);
        let third = third_moment - mean * (L::splat(3.0) * second_moment - (mean + mean) * mean);
        let deviation = variance.sqrt();
        let cube = variance * deviation;
        let is_wide = cube.greater_than(zero);
        let skew = L::select(is_wide, half * third, zero) / L::select(is_wide, cube, one);
        let root = skew.mul_add(skew, one).sqrt();
        let at = |side: L| (first.from + deviation.mul_add(skew + side, mean)).max(zero).min(one);
        let lean = half * skew / root;
        Some(Pressed {
            places: [self.place(at(-root)), self.place(at(root))],
            parts: [half + lean, half - lean],
            depth,
            rms: square.max(zero).sqrt(),
            share: L::select(touches, share, zero),
            middle: L::select(touches, first.from + mean, half),
        })
    }

    /// The parts in the wall; `None` if no lane touches.
    #[inline(always)]
    fn contact(&self, planes: &[Plane<L>; 2]) -> Option<Contact<L>> {
        let Reach { may_touch, whole } = self.reach(planes);
        if !may_touch.any() {
            return None;
        }
        let gap = self.gap(planes);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        // A collar on its low side touches with the whole of most elements: there no roots are needed.
        if !(may_touch & !whole).any() {
            let first = Interval { from: zero, to: L::select(whole, one, zero) };
            return Some(Contact { gap, first, second: Interval { from: one, to: one } });
        }
        let (mut first, mut second) = gap.intervals();
        first.from = L::select(whole, zero, first.from);
        first.to = L::select(whole, one, first.to);
        second.from = L::select(whole, one, second.from);
        first.is_anywhere().then_some(Contact { gap, first, second })
    }

    /// False only if no lane touches: a check without roots.
    #[inline(always)]
    pub fn may_touch(&self, planes: &[Plane<L>; 2]) -> bool {
        self.reach(planes).may_touch.any()
    }

    /// Bounds on the gap without roots.
    ///
    /// (r^2 - j0^2) / (2 j0) has the sign of the gap and is no less, and a parabola exceeds its values at both ends and in the middle by at most a
    /// sixteenth of its second difference; twice that covers the difference of the two parabolas.
    #[inline(always)]
    fn reach(&self, planes: &[Plane<L>; 2]) -> Reach<L> {
        let clearance = self.wall.clearance;
        let reach = clearance * clearance;
        let beyond = |[u, v]: [L; 2]| u.mul_add(u, v * v) - reach;
        let [upper, middle, lower] = self.at_ends_and_middle(planes);
        let (upper, middle, lower) = (beyond(upper), beyond(middle), beyond(lower));
        let bend = L::splat(0.25) * (upper + lower - middle - middle).abs();
        Reach {
            may_touch: upper.max(middle).max(lower).greater_than(-bend),
            whole: upper.min(middle).min(lower).greater_than(bend),
        }
    }

    /// (u, v) at the upper end, in the middle and at the lower end \[m\]. In the middle the shear parameter has no influence.
    #[inline(always)]
    fn at_ends_and_middle(&self, [in_u, in_v]: &[Plane<L>; 2]) -> [[L; 2]; 3] {
        let eighth = L::splat(0.125) * self.length;
        let middle =
            |[a, turn_a, b, turn_b]: Plane<L>| eighth.mul_add(turn_a - turn_b, L::splat(0.5) * (a + b));
        [[in_u[0], in_v[0]], [middle(*in_u), middle(*in_v)], [in_u[2], in_v[2]]]
    }

    /// The gap along the element.
    #[inline(always)]
    pub(super) fn gap(&self, planes: &[Plane<L>; 2]) -> Gap<L> {
        let two = L::splat(2.0);
        let gap = |[u, v]: [L; 2]| u.mul_add(u, v * v).sqrt() - self.wall.clearance;
        let [upper, middle, lower] = self.at_ends_and_middle(planes).map(gap);
        let bend = two * (upper + lower - two * middle);
        Gap { upper, lower, rise: lower - upper - bend, bend }
    }

    /// Interpolation at a place, 0 at the upper end to 1 at the lower one: the parabola through both ends and the middle of a Timoshenko beam without load
    /// (Friedman and Kosmatka 1993), on which its shear parameter has no influence.
    #[inline(always)]
    pub(super) fn place(&self, at: L) -> Place<L> {
        let rest = L::splat(1.0) - at;
        let turn = L::splat(0.5) * self.length * (at * rest);
        Place { at, shape: [rest, turn, at, -turn] }
    }

    /// Motion at a place.
    #[inline(always)]
    pub fn motion_at(&self, at: L, motion: &SegmentMotion<L>) -> LateralMotion<L> {
        self.place(at).motion(motion)
    }

    /// Share of its force that a point carries at a distance from the axis \[m\]: 1 beyond half the clearance, and down to zero on the axis.
    ///
    /// A string that crosses the hole within the element is short of the wall there, but the parabola through three distances is not. The
    /// direction of the force turns over as the point passes the axis, so that it must be zero there. On the wall the share is 1 to the bit: the
    /// parabola through three points of a helix stays beyond half its radius for turns up to a whole one.
    #[inline(always)]
    pub(super) fn reached(&self, radius: L) -> L {
        let share = (radius * (L::splat(2.0) / self.wall.clearance)).min(L::splat(1.0));
        share * (L::splat(2.0) - share)
    }

    #[inline(always)]
    fn points(
        &self,
        law: &ContactParameters<L>,
        pressed: &Pressed<L>,
        motion: &SegmentMotion<L>,
        rotation_speed: L,
        speed: L,
    ) -> [Point<L>; 2] {
        let stiffness = law.stiffness(pressed.rms) * self.wall.stiffness_share;
        let damping = law.damping(pressed.rms) * self.wall.damping_share * pressed.share;
        let (elastic, slope) = (stiffness * pressed.depth, damping.mul_add(speed, stiffness * pressed.share));
        let touches = pressed.depth.greater_than(L::splat(0.0));
        [0, 1].map(|k| {
            let (place, part) = (pressed.places[k], pressed.parts[k]);
            let surface = Surface::of(&self.wall, &place.motion(motion), rotation_speed);
            let part = part * self.reached(surface.penetration + self.wall.clearance);
            let normal = law.limited(part * damping.mul_add(surface.penetration_rate, elastic));
            Point { place, slope: part * slope, normal, surface: Surface { touches, ..surface } }
        })
    }

    /// Adds the loads of a normal force and a friction at a point.
    #[inline(always)]
    fn add(
        &self,
        law: &ContactParameters<L>,
        point: &Point<L>,
        normal: L,
        friction: L,
        force: &mut SegmentForce<L>,
    ) {
        let zero = L::splat(0.0);
        let Surface { touches, normal: [n_u, n_v], .. } = point.surface;
        let (normal, friction) = (L::select(touches, normal, zero), L::select(touches, friction, zero));
        let along = friction * law.tangential_share;
        let torque = friction * law.torque_share * self.wall.contact_radius;
        let (pushed_u, pushed_v) = (-(normal * n_u), -(normal * n_v));
        let (rubbed_u, rubbed_v) = (along * n_v, -(along * n_u));
        for k in 0..4 {
            let shape = point.place.shape[k];
            force.normal[0][k] = shape.mul_add(pushed_u, force.normal[0][k]);
            force.normal[1][k] = shape.mul_add(pushed_v, force.normal[1][k]);
            force.friction[0][k] = shape.mul_add(rubbed_u, force.friction[0][k]);
            force.friction[1][k] = shape.mul_add(rubbed_v, force.friction[1][k]);
        }
        for (end, share) in [L::splat(1.0) - point.place.at, point.place.at].into_iter().enumerate() {
            force.torque[end] = force.torque[end] - torque * share;
            force.ends[end] = normal.mul_add(share, force.ends[end]);
        }
    }
}

impl<L: Lane> Gap<L> {
    /// Gap at a place \[m\].
    #[inline(always)]
    fn at(&self, at: L) -> L {
        self.bend.mul_add(at, self.rise).mul_add(at, self.upper)
    }

    /// Integrals of the gap over a part of the element, with the powers 0 to 3 of the distance from its upper end as weights, and of its square.
    #[inline(always)]
    fn moments(&self, interval: &Interval<L>) -> ([L; 4], L) {
        let length = interval.length();
        // p + q t + r t^2, t from 0 to 1 along the part.
        let p = self.at(interval.from);
        let q = (self.bend + self.bend).mul_add(interval.from, self.rise) * length;
        let r = self.bend * length * length;
        let over = |k: f64| {
            r.mul_add(
                L::splat(1.0 / (k + 3.0)),
                q.mul_add(L::splat(1.0 / (k + 2.0)), p * L::splat(1.0 / (k + 1.0))),
            )
        };
        let [m_0, m_1, m_2, m_3] = [over(0.0), over(1.0), over(2.0), over(3.0)];
        let square = length * length;
        let moments = [length * m_0, square * m_1, square * length * m_2, square * square * m_3];
        (moments, length * r.mul_add(m_2, q.mul_add(m_1, p * m_0)))
    }

    /// The parts of the element with a positive gap: one, or the two outer ones if it closes at both ends only; the second part of a single one is
    /// empty.
    #[inline(always)]
    fn intervals(&self) -> (Interval<L>, Interval<L>) {
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        let Gap { upper, lower, rise: b, bend: c } = *self;
        let discriminant = b * b - L::splat(4.0) * c * upper;
        let crosses = discriminant.greater_than(zero);
        let root = discriminant.max(zero).sqrt();
        // The roots without the difference of nearly equal numbers: downwards the gap has the slope -root, upwards +root.
        let sum = b.abs() + root;
        let quotient = |a: L, b: L| {
            let is_zero = !(b.less_than(zero) | b.greater_than(zero));
            a / L::select(is_zero, one, b)
        };
        let (near, far) = (quotient(two * upper, sum), quotient(sum, two * c));
        let falls = b.less_than(zero);
        let (down, up) = (L::select(falls, near, -far), L::select(falls, far, -near));
        let clamped = |x: L| x.max(zero).min(one);
        let (from_top, to_bottom) = (upper.greater_than(zero), lower.greater_than(zero));
        // The gap's extreme lies between the ends: a minimum, or a maximum.
        let has_minimum = falls & (-b).less_than(two * c);
        let has_maximum = b.greater_than(zero) & b.less_than(-(two * c));
        // Both ends in the wall: whole, unless the gap opens between them. One end: up to the crossing. None: between the crossings, if it closes there.
        let dips = from_top & to_bottom & crosses & has_minimum;
        let between = !from_top & !to_bottom & crosses & has_maximum;
        let touches = from_top | to_bottom | between;
        let ends_inside = dips | !to_bottom;
        let first = Interval {
            from: L::select(touches & !from_top, clamped(up), zero),
            to: L::select(touches, L::select(ends_inside, clamped(down), one), zero),
        };
        let second = Interval { from: L::select(dips, clamped(up), one), to: one };
        (first, second)
    }
}

impl<L: Lane> Interval<L> {
    /// Length relative to that of the element.
    #[inline(always)]
    fn length(&self) -> L {
        (self.to - self.from).max(L::splat(0.0))
    }

    /// False if it is empty in all lanes.
    #[inline(always)]
    fn is_anywhere(&self) -> bool {
        self.from.less_than(self.to).any()
    }
}

impl Place<f64> {
    /// Derivatives of the shape functions by the place.
    pub(super) fn shape_slope(&self, length: f64) -> Plane<f64> {
        let turn = length * (0.5 - self.at);
        [-1.0, turn, 1.0, -turn]
    }
}

impl<L: Lane> Place<L> {
    #[inline(always)]
    fn motion(&self, motion: &SegmentMotion<L>) -> LateralMotion<L> {
        let [upper, lower] = motion.twist_rates;
        LateralMotion {
            u: dot(&self.shape, &motion.planes[0]),
            v: dot(&self.shape, &motion.planes[1]),
            u_rate: dot(&self.shape, &motion.rates[0]),
            v_rate: dot(&self.shape, &motion.rates[1]),
            theta_z_rate: (lower - upper).mul_add(self.at, upper),
        }
    }
}

impl ContactSegment<f64> {
    /// Derivative of [`Self::reached`] by the distance \[1/m\].
    pub(super) fn reached_slope(&self, radius: f64) -> f64 {
        let per_radius = 2.0 / self.wall.clearance;
        if radius * per_radius < 1.0 { 2.0 * per_radius * (1.0 - radius * per_radius) } else { 0.0 }
    }

    /// Energy \[J\] that the wall stores along the element.
    pub fn potential_energy(&self, law: &ContactParameters<f64>, planes: &[Plane<f64>; 2]) -> f64 {
        let rms = self.pressed(planes).map_or(0.0, |pressed| pressed.rms);
        self.wall.stiffness_share * law.potential_energy(rms)
    }

    /// Gauss points of order three on the parts in the wall, with their weights.
    pub(super) fn points_in_the_wall(
        &self,
        planes: &[Plane<f64>; 2],
    ) -> impl Iterator<Item = (Place<f64>, f64)> + use<> {
        let none = Interval { from: 0.0, to: 0.0 };
        let intervals = self.contact(planes).map_or([none; 2], |contact| [contact.first, contact.second]);
        let segment = *self;
        intervals.into_iter().filter(|interval| interval.from < interval.to).flat_map(move |interval| {
            let length = interval.length();
            THREE_POINTS
                .map(|(at, weight)| (segment.place(length.mul_add(at, interval.from)), weight * length))
        })
    }

    /// The penetration of an element with its derivatives by the gaps at the upper end, in the middle and at the lower end; `None` without
    /// contact.
    pub(super) fn pressed_with_slopes(
        &self,
        planes: &[Plane<f64>; 2],
    ) -> Option<(Pressed<f64>, PressedSlopes)> {
        let pressed = self.pressed(planes).filter(|pressed| pressed.depth > 0.0)?;
        let Contact { gap, first, .. } = self.contact(planes)?;
        // Ends of the parts move, but the gap is zero there: only the gap itself changes.
        let (mut moments, mut slopes, mut by_square) = ([0.0; 4], [Vector3::zeros(); 4], Vector3::zeros());
        for (Place { at: x, .. }, weight) in self.points_in_the_wall(planes) {
            let by_gaps = Vector3::from(parabola_through_ends_and_middle(x));
            let (gap, distance) = (gap.at(x), x - first.from);
            by_square += by_gaps * (2.0 * weight * gap);
            let mut power = weight;
            for (moment, slope) in moments.iter_mut().zip(&mut slopes) {
                *moment += power * gap;
                *slope += by_gaps * power;
                power *= distance;
            }
        }
        let raw = [1, 2, 3].map(|k| {
            let value = moments[k] / moments[0];
            (value, (slopes[k] - slopes[0] * value) / moments[0])
        });
        let [(mean, by_mean), (second, by_second), (third, by_third)] = raw;
        let variance = second - mean * mean;
        if variance <= 0.0 {
            return None;
        }
        let by_variance = by_second - by_mean * (2.0 * mean);
        let third_central = third - mean * (3.0 * second - 2.0 * mean * mean);
        let by_third_central =
            by_third - by_mean * (3.0 * second - 6.0 * mean * mean) - by_second * (3.0 * mean);
        let deviation = variance.sqrt();
        let by_deviation = by_variance / (2.0 * deviation);
        let cube = variance * deviation;
        let skew = 0.5 * third_central / cube;
        let by_skew = by_third_central * (0.5 / cube) - by_deviation * (3.0 * skew / deviation);
        let root = skew.hypot(1.0);
        let by_root = by_skew * (skew / root);
        let lean = by_skew * (0.5 / (root * root * root));
        let at = |side: f64| {
            by_mean + by_deviation * (skew + side * root) + (by_skew + by_root * side) * deviation
        };
        let by_rms = by_square / (2.0 * pressed.rms);
        Some((
            pressed,
            PressedSlopes { at: [at(-1.0), at(1.0)], parts: [lean, -lean], depth: slopes[0], rms: by_rms },
        ))
    }

    /// Unit vectors (u, v) from the axis at the upper end, in the middle and at the lower end, with these places; zero on the axis.
    pub(super) fn normals(&self, planes: &[Plane<f64>; 2]) -> [(Place<f64>, [f64; 2]); 3] {
        let places = [0.0, 0.5, 1.0].map(|at| self.place(at));
        let points = self.at_ends_and_middle(planes);
        [0, 1, 2].map(|k| {
            let [u, v] = points[k];
            let radius = u.hypot(v);
            (places[k], if radius > 0.0 { [u / radius, v / radius] } else { [0.0; 2] })
        })
    }

    /// The Gauss points of the whole element, with the contact data of each.
    pub(super) fn whole(&self) -> [(Place<f64>, ContactNode<f64>); 2] {
        let half = ContactNode {
            stiffness_share: 0.5 * self.wall.stiffness_share,
            damping_share: 0.5 * self.wall.damping_share,
            ..self.wall
        };
        GAUSS.map(|at| (self.place(at), half))
    }
}

impl<L: Lane> SegmentForce<L> {
    /// No contact.
    pub fn none() -> Self {
        let zero = L::splat(0.0);
        Self {
            normal: [[zero; 4]; 2],
            friction: [[zero; 4]; 2],
            torque: [zero; 2],
            ends: [zero; 2],
            middle: L::splat(0.5),
        }
    }

    /// All loads in a plane.
    #[inline(always)]
    pub fn load(&self, plane: usize) -> Plane<L> {
        let (normal, friction) = (&self.normal[plane], &self.friction[plane]);
        [normal[0] + friction[0], normal[1] + friction[1], normal[2] + friction[2], normal[3] + friction[3]]
    }
}

impl<L: Lane> SegmentCompliance<L> {
    /// Displacements in a plane by a load in it.
    #[inline(always)]
    fn of_load(&self, load: &Plane<L>) -> Plane<L> {
        let [aa, ab, ac, ad, bb, bc, bd, cc, cd, dd] = self.lateral;
        [
            dot(&[aa, ab, ac, ad], load),
            dot(&[ab, bb, bc, bd], load),
            dot(&[ac, bc, cc, cd], load),
            dot(&[ad, bd, cd, dd], load),
        ]
    }

    /// Twist at a place by torques at both ends.
    #[inline(always)]
    fn twist_at(&self, at: L, [upper, lower]: [L; 2]) -> L {
        let [own_upper, between, own_lower] = self.twist;
        let above = own_upper.mul_add(upper, between * lower);
        let below = between.mul_add(upper, own_lower * lower);
        (below - above).mul_add(at, above)
    }
}

/// Work of loads on the motion of an element's ends in one plane, or displacement at a place by its shape functions.
#[inline(always)]
pub fn dot<L: Lane>(a: &Plane<L>, b: &Plane<L>) -> L {
    let halves = [a[0].mul_add(b[0], a[1] * b[1]), a[2].mul_add(b[2], a[3] * b[3])];
    halves[0] + halves[1]
}

/// Parts of the values at the upper end, in the middle and at the lower end in that of the parabola through them at a place.
pub(super) fn parabola_through_ends_and_middle(x: f64) -> [f64; 3] {
    [(1.0 - x) * (1.0 - 2.0 * x), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)]
}

/// Gauss points of order two on \[0, 1\]: (1 -+ 1/sqrt 3) / 2.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Gauss points of order three on \[0, 1\] with their weights: (1 -+ sqrt(3/5)) / 2 and the middle.
const THREE_POINTS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
