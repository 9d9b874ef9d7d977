//! Tangential friction at contacts: without it the wall pushes along its normal alone.
//!
//! Its law is in [`crate::force::contact`], not here: friction is a coefficient times the normal force, at the penetration and the sliding speed
//! that the normal force is found with, and an implicit solve makes both agree with one motion. Apart, each would look for the node on
//! the wall again, four nodes at a time in the innermost loop of a step.

use super::{FRICTION_WORK, ROTATION_WORK};
use crate::force::term::{Account, Term, has_friction};
use crate::math::linalg::Lane;

pub(crate) const TERM: Term = Term::new(has_friction);

/// Energy dissipated by sliding: what the drive does against the friction torque less the work of friction on the motion.
///
/// This is int mu |F_n| |v_g| dt, and never falls, where friction both pushes along the wall and turns the string. With
/// [`friction_torque`](super::friction_torque) off the drive has nothing to work against, so that what is left is the work of the tangential
/// force alone, with its sign turned: negative where friction drives a backward whirl. With this effect off and the torque on it is the
/// torque's alone, and can be negative where whirl outruns the rotation.
pub(crate) const DISSIPATED: Account = Account::taken("dissipated_friction", |booked| {
    booked.by_force(ROTATION_WORK) - booked.by_force(FRICTION_WORK)
})
.passed_on();

/// Power \[W\] of friction on a node's motion, of the power of the whole contact force and torque and that of the normal force.
#[inline(always)]
pub(crate) fn power<L: Lane>(whole: L, normal: L) -> L {
    whole - normal
}
