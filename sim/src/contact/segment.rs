//! Contact along an element: the law of the wall, integrated over the stretch of the element that is in the wall.
//!
//! The deflection between the nodes is that of the beam's shape functions. The gap r - j0 at both ends and in the middle gives a parabola, whose
//! positive part is the stretch in contact; the law acts at the two Gauss points of that stretch, each for half of its length. A rule
//! with fixed points, such as one at the nodes, switches a whole share of the length when a point enters the wall. This one grows from
//! zero, and it is exact for a rigid element. Forces step, by the error of the rule, only if a gap between two outer parts of one element closes.

use super::ContactNode;
use super::law::ContactParameters;
use super::motion::{LateralMotion, Surface};
use crate::linalg::{Lane, Mask};

/// An element of the string as it meets the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSegment<L> {
    /// Length l \[m\].
    pub length: L,
    /// a / (1 + a), with the shear parameter a of (6).
    pub shear_share: L,
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
    /// Place of the middle of the contact, from 0 at the upper end to 1; 1/2 without contact.
    pub middle: L,
}

/// Displacements of an element under forces on it: what makes the wall's force implicit along the element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentCompliance<L> {
    /// Upper triangle, row by row, of the matrix that gives the displacements in a plane for loads in it, the mean of both planes
    /// \[m/N, 1/N, 1/(N m)\].
    pub lateral: [L; 10],
    /// Twist by torque: at the upper end, between both ends, at the lower end \[rad/(N m)\].
    pub twist: [L; 3],
}

/// A part of an element, from 0 at the upper end to 1 at the lower one; empty if both ends are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch<L> {
    pub(super) from: L,
    pub(super) to: L,
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

/// Consistent nodal loads of the wall on an element in motion, at rotation speed Omega \[rad/s\]: the law (10) to (14) at the Gauss points of the
/// stretch in contact. False if no lane touches; then `force` is left as it is.
#[inline(always)]
pub fn dynamic_segment<L: Lane>(
    law: &ContactParameters<L>,
    segment: &ContactSegment<L>,
    motion: &SegmentMotion<L>,
    rotation_speed: L,
    force: &mut SegmentForce<L>,
) -> bool {
    let zero = L::splat(0.0);
    let Some((first, second)) = segment.contact(&motion.planes) else { return false };
    *force = SegmentForce::none();
    force.set_middle(&first);
    let (mut stretch, mut is_last) = (first, !second.is_anywhere());
    loop {
        let points = segment.points(law, &stretch, motion, rotation_speed, zero);
        let friction = |point: &Point<L>| {
            if law.has_friction {
                law.friction_coefficient(point.surface.sliding_speed) * point.normal.abs()
            } else {
                zero
            }
        };
        segment.add(law, &points[0], points[0].normal, friction(&points[0]), force);
        segment.add(law, &points[1], points[1].normal, friction(&points[1]), force);
        if is_last {
            return true;
        }
        (stretch, is_last) = (second, true);
    }
}

/// The loads of the same law that agree with the motion which they lead to, as far as the element's own loads move it: normal forces of both
/// points by one step of Newton's method, frictions of both by a solution of the whole friction curve. `force` holds the loads that
/// the motion was found with, or none, and takes the new ones; `speed` is the ratio of a change of velocity to that of displacement \[1/s\].
/// False if no lane touches; then `force` is left as it is.
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
    let Some((first, second)) = segment.contact(&motion.planes) else { return false };
    let (before_u, before_v, before_torque) = (force.load(0), force.load(1), force.torque);
    *force = SegmentForce::none();
    force.set_middle(&first);
    let (mut stretch, mut is_last) = (first, !second.is_anywhere());
    loop {
        let [p, q] = segment.points(law, &stretch, motion, rotation_speed, speed);
        // Loads that the motion was found with and that no earlier stretch of the element has replaced.
        let load_u = difference(&before_u, &force.load(0));
        let load_v = difference(&before_v, &force.load(1));
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
            let pressed = [normal[0].abs(), normal[1].abs()];
            let mut speeds = [p.surface.sliding_speed, q.surface.sliding_speed];
            let slow = speeds[0].abs().min(speeds[1].abs()).less_than(law.fast_sliding());
            if slow.any() {
                let radius = segment.wall.contact_radius;
                let torque = [before_torque[0] - force.torque[0], before_torque[1] - force.torque[1]];
                let along = |[n_u, n_v]: [L; 2], [u, v]: [L; 2]| n_u.mul_add(v, -(n_v * u));
                let free = |point: &Point<L>, moved: [L; 2]| {
                    let turned = compliance.twist_at(point.place.at, torque);
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
                let opposed = law.opposed_sliding_speeds([free(&p, moved_p), free(&q, moved_q)], responses);
                for (speed, opposed) in speeds.iter_mut().zip(opposed) {
                    *speed = L::select(slow, opposed, *speed);
                }
            }
            friction = [
                law.friction_coefficient(speeds[0]) * pressed[0],
                law.friction_coefficient(speeds[1]) * pressed[1],
            ];
        }
        segment.add(law, &p, normal[0], friction[0], force);
        segment.add(law, &q, normal[1], friction[1], force);
        if is_last {
            return true;
        }
        (stretch, is_last) = (second, true);
    }
}

impl<L: Lane> ContactSegment<L> {
    /// The stretches in contact, the second of them empty in most cases; `None` if no lane touches.
    #[inline(always)]
    fn contact(&self, planes: &[Plane<L>; 2]) -> Option<(Stretch<L>, Stretch<L>)> {
        let Reach { may_touch, whole } = self.reach(planes);
        if !may_touch.any() {
            return None;
        }
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        // A collar on its low side touches with the whole of most elements: no roots are taken there.
        if !(may_touch & !whole).any() {
            return Some((
                Stretch { from: zero, to: L::select(whole, one, zero) },
                Stretch { from: one, to: one },
            ));
        }
        let (mut first, mut second) = self.stretches(planes);
        first.from = L::select(whole, zero, first.from);
        first.to = L::select(whole, one, first.to);
        second.from = L::select(whole, one, second.from);
        first.is_anywhere().then_some((first, second))
    }

    /// False only if no lane touches: a look without roots.
    #[inline(always)]
    pub fn may_touch(&self, planes: &[Plane<L>; 2]) -> bool {
        self.reach(planes).may_touch.any()
    }

    /// Bounds on the gap without roots.
    ///
    /// (r^2 - j0^2) / (2 j0) has the sign of the gap and is no less, and a parabola reaches beyond its values at both ends and in the middle by a sixteenth
    /// of its second difference at most; twice that leaves room for the difference of the two parabolas.
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

    /// (u, v) at the upper end, in the middle and at the lower end \[m\]. In the middle the shear parameter does not matter.
    #[inline(always)]
    fn at_ends_and_middle(&self, [in_u, in_v]: &[Plane<L>; 2]) -> [[L; 2]; 3] {
        let eighth = L::splat(0.125) * self.length;
        let middle =
            |[a, turn_a, b, turn_b]: Plane<L>| eighth.mul_add(turn_a - turn_b, L::splat(0.5) * (a + b));
        [[in_u[0], in_v[0]], [middle(*in_u), middle(*in_v)], [in_u[2], in_v[2]]]
    }

    /// The parts of the element on which the parabola of the gap is positive: one, or the two outer ones if the gap closes at both ends only; of one
    /// alone the second is empty.
    #[inline(always)]
    pub(super) fn stretches(&self, planes: &[Plane<L>; 2]) -> (Stretch<L>, Stretch<L>) {
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        let gap = |[u, v]: [L; 2]| u.mul_add(u, v * v).sqrt() - self.wall.clearance;
        let [upper, middle, lower] = self.at_ends_and_middle(planes);
        let (upper, middle, lower) = (gap(upper), gap(middle), gap(lower));
        // upper + b x + c x^2
        let c = two * (upper + lower - two * middle);
        let b = lower - upper - c;
        let discriminant = b * b - L::splat(4.0) * c * upper;
        let crosses = discriminant.greater_than(zero);
        let root = discriminant.max(zero).sqrt();
        // The roots without the difference of what is nearly equal: downwards the gap has the slope -root, upwards +root.
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
        // Its extreme lies between the ends: a minimum, or a maximum.
        let has_minimum = falls & (-b).less_than(two * c);
        let has_maximum = b.greater_than(zero) & b.less_than(-(two * c));
        // Both ends in the wall: whole, unless the gap opens between them. One end: up to the crossing. None: between the crossings, if it closes there.
        let dips = from_top & to_bottom & crosses & has_minimum;
        let between = !from_top & !to_bottom & crosses & has_maximum;
        let touches = from_top | to_bottom | between;
        let ends_inside = dips | !to_bottom;
        let first = Stretch {
            from: L::select(touches & !from_top, clamped(up), zero),
            to: L::select(touches, L::select(ends_inside, clamped(down), one), zero),
        };
        let second = Stretch { from: L::select(dips, clamped(up), one), to: one };
        (first, second)
    }

    /// Interpolation at a place, 0 at the upper end to 1 at the lower one: the shape functions of a Timoshenko beam without load (Friedman and Kosmatka
    /// 1993).
    #[inline(always)]
    pub(super) fn place(&self, at: L) -> Place<L> {
        let (one, half) = (L::splat(1.0), L::splat(0.5));
        let (shear, bending) = (self.shear_share, one - self.shear_share);
        let rest = one - at;
        let (square, product) = (at * at, at * rest);
        let lower = bending * square * (L::splat(3.0) - at - at) + shear * at;
        // x (1 - x)^2 and x^2 (x - 1), less and plus half of x (1 - x) for the part that shears.
        let sheared = half * shear * product;
        let turn_upper = self.length * (bending * product).mul_add(rest, sheared);
        let turn_lower = -(self.length * (bending * product).mul_add(at, sheared));
        Place { at, shape: [one - lower, turn_upper, lower, turn_lower] }
    }

    /// Motion at a place.
    #[inline(always)]
    pub fn motion_at(&self, at: L, motion: &SegmentMotion<L>) -> LateralMotion<L> {
        self.place(at).motion(motion)
    }

    /// The Gauss points of a stretch.
    #[inline(always)]
    pub(super) fn gauss_points(&self, stretch: &Stretch<L>) -> [Place<L>; 2] {
        let length = stretch.to - stretch.from;
        let [upper, lower] = GAUSS;
        [
            self.place(length.mul_add(L::splat(upper), stretch.from)),
            self.place(length.mul_add(L::splat(lower), stretch.from)),
        ]
    }

    /// The wall as each Gauss point of a stretch meets it, with half of the stretch's length.
    #[inline(always)]
    pub(super) fn wall_of_a_point(&self, stretch: &Stretch<L>) -> ContactNode<L> {
        let share = L::splat(0.5) * (stretch.to - stretch.from);
        ContactNode {
            stiffness_share: share * self.wall.stiffness_share,
            damping_share: share * self.wall.damping_share,
            ..self.wall
        }
    }

    #[inline(always)]
    fn points(
        &self,
        law: &ContactParameters<L>,
        stretch: &Stretch<L>,
        motion: &SegmentMotion<L>,
        rotation_speed: L,
        speed: L,
    ) -> [Point<L>; 2] {
        let wall = self.wall_of_a_point(stretch);
        let [upper, lower] = self.gauss_points(stretch);
        [
            Point::at(upper, law, &wall, motion, rotation_speed, speed),
            Point::at(lower, law, &wall, motion, rotation_speed, speed),
        ]
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

impl<L: Lane> Point<L> {
    #[inline(always)]
    fn at(
        place: Place<L>,
        law: &ContactParameters<L>,
        wall: &ContactNode<L>,
        motion: &SegmentMotion<L>,
        rotation_speed: L,
        speed: L,
    ) -> Self {
        let zero = L::splat(0.0);
        let surface = Surface::of(wall, &place.motion(motion), rotation_speed);
        let stiffness = law.stiffness(surface.penetration) * wall.stiffness_share;
        let damping = law.damping(surface.penetration) * wall.damping_share;
        let normal = law.limited(damping.mul_add(surface.penetration_rate, stiffness * surface.penetration));
        Point {
            place,
            slope: L::select(surface.touches, damping.mul_add(speed, stiffness), zero),
            normal: L::select(surface.touches, normal, zero),
            surface,
        }
    }
}

impl<L: Lane> Stretch<L> {
    /// False if it is empty in all lanes.
    #[inline(always)]
    fn is_anywhere(&self) -> bool {
        self.from.less_than(self.to).any()
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
    /// Energy \[J\] that the wall stores along the element.
    pub fn potential_energy(&self, law: &ContactParameters<f64>, planes: &[Plane<f64>; 2]) -> f64 {
        self.in_contact(planes)
            .map(|(place, wall)| {
                let [u, v] = planes.each_ref().map(|plane| dot(&place.shape, plane));
                wall.stiffness_share * law.potential_energy(u.hypot(v) - wall.clearance)
            })
            .sum()
    }

    /// The Gauss points of all stretches in contact, with the wall as each meets it.
    pub(super) fn in_contact(
        &self,
        planes: &[Plane<f64>; 2],
    ) -> impl Iterator<Item = (Place<f64>, ContactNode<f64>)> + use<> {
        let segment = *self;
        self.stretches_in_contact(planes).flat_map(move |stretch| segment.points_of(&stretch))
    }

    /// The stretches in contact.
    pub(super) fn stretches_in_contact(
        &self,
        planes: &[Plane<f64>; 2],
    ) -> impl Iterator<Item = Stretch<f64>> + use<> {
        let none = Stretch { from: 0.0, to: 0.0 };
        let (first, second) = self.contact(planes).unwrap_or((none, none));
        [first, second].into_iter().filter(|stretch| stretch.from < stretch.to)
    }

    /// The Gauss points of a stretch, with the wall as each meets it.
    pub(super) fn points_of(&self, stretch: &Stretch<f64>) -> [(Place<f64>, ContactNode<f64>); 2] {
        let wall = self.wall_of_a_point(stretch);
        self.gauss_points(stretch).map(|place| (place, wall))
    }

    /// Derivatives of both ends of a stretch by the gaps at the upper end, in the middle and at the lower end \[1/m\]; zero at an end of the element.
    pub(super) fn ends_by_gaps(&self, planes: &[Plane<f64>; 2], stretch: &Stretch<f64>) -> [[f64; 3]; 2] {
        let [upper, middle, lower] =
            self.at_ends_and_middle(planes).map(|[u, v]| u.hypot(v) - self.wall.clearance);
        let c = 2.0 * (upper + lower - 2.0 * middle);
        let b = lower - upper - c;
        [stretch.from, stretch.to].map(|x| {
            let slope = b + 2.0 * c * x;
            if x <= 0.0 || x >= 1.0 || slope == 0.0 {
                return [0.0; 3];
            }
            [1.0 - 3.0 * x + 2.0 * x * x, 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)].map(|by| -by / slope)
        })
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

    /// The Gauss points of the whole element, with the wall as each meets it.
    pub(super) fn whole(&self) -> [(Place<f64>, ContactNode<f64>); 2] {
        self.points_of(&Stretch { from: 0.0, to: 1.0 })
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

    #[inline(always)]
    fn set_middle(&mut self, stretch: &Stretch<L>) {
        let touches = stretch.from.less_than(stretch.to);
        let middle = L::splat(0.5) * (stretch.from + stretch.to);
        self.middle = L::select(touches, middle, L::splat(0.5));
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

#[inline(always)]
fn difference<L: Lane>(a: &Plane<L>, b: &Plane<L>) -> Plane<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// Gauss points of order two on \[0, 1\]: (1 -+ 1/sqrt 3) / 2.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
