//! The law of the wall: stiffness, damping and friction.

use std::f64::consts::PI;

use drillsweep_scenario::{ActiveEffects, Adhesion, ContactLaw, StartFriction};

use super::body::BodyMotion;
use super::friction::Friction;
use super::node::ContactNode;
use crate::math::linalg::Lane;

/// A [`ContactLaw`] with its switches, prepared for evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactParameters<L> {
    stiffness: Saturating<L>,
    damping: Saturating<L>,
    /// Least normal force \[N\]: zero without adhesion, minus infinity with it.
    least_normal_force: L,
    /// Friction of nodes without one of their own.
    pub(super) friction: Friction<L>,
    /// True if there is friction: without it, its coefficient is not evaluated.
    pub(super) has_friction: bool,
    /// Friction of a node at rest.
    at_rest: StartFriction,
    /// 1 if friction pushes along the wall, 0 if that is switched off.
    pub(super) tangential_share: L,
    /// 1 if friction turns the string, 0 if that is switched off.
    pub(super) torque_share: L,
}

/// Friction coefficients of a node at rest, with the signs of the surface's velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionAtRest {
    /// About the axis.
    pub about: f64,
    /// Along the axis.
    pub along: f64,
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
        let share = |is_on: bool| L::splat(if is_on { 1.0 } else { 0.0 });
        ContactParameters {
            stiffness: Saturating::new(law.stiffness, law.stiffness_sharpness),
            damping: Saturating::new(law.unit_damping(), law.damping_sharpness),
            least_normal_force: L::splat(match law.adhesion {
                Adhesion::Allowed => f64::NEG_INFINITY,
                Adhesion::None => 0.0,
            }),
            friction: Friction::new(law.static_friction, law.dynamic_friction, law.friction_reference_speed),
            has_friction: law.static_friction != 0.0 && (effects.friction || effects.friction_torque),
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

    /// Friction of a node: its own, or that of the law.
    #[inline(always)]
    pub fn friction_of<'a>(&'a self, node: &'a ContactNode<L>) -> &'a Friction<L> {
        node.friction.as_ref().unwrap_or(&self.friction)
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

    /// Friction coefficients about the axis and along it of a node at rest on a string that moves as a body: mu along the direction of the surface's
    /// velocity (Omega R_e, V), with mu_s at break-away (36), or mu at the sliding speed (14). Without motion friction has no sense, and is zero.
    pub fn friction_at_rest(&self, node: &ContactNode<f64>, motion: BodyMotion) -> FrictionAtRest {
        let friction = self.friction_of(node);
        let [about, along] = motion.direction(node.contact_radius);
        let coefficient = match self.at_rest {
            StartFriction::BreakAway => friction.at_break_away,
            StartFriction::Sliding => {
                friction.coefficient((motion.rotation_speed * node.contact_radius).hypot(motion.axial_speed))
            }
        };
        FrictionAtRest { about: about * coefficient, along: along * coefficient }
    }

    /// Friction of a contact node in each lane; absent if all have that of the law.
    pub fn friction_of_lanes<'a, L: Lane>(
        &self,
        node: impl Fn(usize) -> Option<&'a ContactNode<f64>>,
    ) -> Option<Friction<L>> {
        let own = |lane: usize| node(lane)?.friction;
        let is_needed = (0..L::LANES).any(|lane| own(lane).is_some());
        is_needed.then(|| Friction::of_lanes(|lane| own(lane).unwrap_or(self.friction)))
    }

    /// The same law in every lane.
    pub fn in_lanes<L: Lane>(&self) -> ContactParameters<L> {
        let splat = L::splat;
        ContactParameters {
            stiffness: self.stiffness.in_lanes(),
            damping: self.damping.in_lanes(),
            least_normal_force: splat(self.least_normal_force),
            friction: self.friction.in_lanes(),
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

/// Value of y below which the series is summed; nine terms leave a remainder below y^18.
const SERIES_LIMIT: f64 = 0.1;
const SERIES_TERMS: u32 = 9;
