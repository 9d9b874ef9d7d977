//! Tangential friction at contacts: without it the wall pushes along its normal alone.
//!
//! Its law is in [`crate::force::contact`], not here: friction is a coefficient times the normal force, at the same penetration and sliding speed
//! as the normal force, and an implicit solve makes both agree with one motion. Separate effects would each search for the node on
//! the wall, four nodes at a time in the innermost loop of a step.

use super::{FRICTION_WORK, ROTATION_WORK};
use crate::force::term::{Account, Term, has_friction};
use crate::math::linalg::Lane;

pub(crate) const TERM: Term = Term::new(has_friction);

/// Energy dissipated by sliding: work of the drive against the friction torque less the work of friction on the motion.
///
/// This is int mu |F_n| |v_g| dt, and never falls, if friction both pushes along the wall and turns the string. With
/// [`friction_torque`](super::friction_torque) off the drive works against nothing, so that only the work of the tangential
/// force is left, with its sign turned: negative if friction drives a backward whirl. With this effect off and the torque on it is the
/// torque's alone, and can be negative if whirl is faster than the rotation.
pub(crate) const DISSIPATED: Account = Account::taken("dissipated_friction", |booked| {
    booked.by_force(ROTATION_WORK) - booked.by_force(FRICTION_WORK)
})
.passed_on();

/// Power \[W\] of friction on a node's motion, from the power of the whole contact force and torque and that of the normal force.
#[inline(always)]
pub(crate) fn power<L: Lane>(whole: L, normal: L) -> L {
    whole - normal
}
