//! Normal contact with the borehole: without it a node passes through the wall. Its law is [`crate::force::contact`], which the time step evaluates
//! four nodes at a time.

use super::{FRICTION_WORK, NORMAL_WORK};
use crate::force::term::{Account, Decision, EffectContext, Term, yes};
use crate::math::dof::LATERAL;
use crate::math::linalg::Lane;

pub(crate) const TERM: Term = Term::new(decide);

/// Energy dissipated by the contacts' dampers: energy that the wall takes from the motion along its normals and does not store.
pub(crate) const DISSIPATED: Account =
    Account::taken("dissipated_contact", |booked| -booked.by_force(NORMAL_WORK) - booked.wall);

/// Work of the wall's normal and friction forces on the motion, for comparison with the ledger's residual.
pub(crate) const WORK: Account =
    Account::beside("contact_work", |booked| booked.by_force(NORMAL_WORK) + booked.by_force(FRICTION_WORK));

fn decide(_: &EffectContext<'_>) -> Decision {
    yes("the string may reach the wall; until then only the distance is computed")
}

/// Power \[W\] of a normal force \[N\] on a node's motion, along the radius at the distance \[m\] from the axis at which it was
/// evaluated.
#[inline(always)]
pub(crate) fn power<L: Lane>(
    normal_force: L,
    distance: L,
    [u, v]: [L; LATERAL],
    [u_rate, v_rate]: [L; LATERAL],
) -> L {
    -(normal_force / distance * u_rate.mul_add(u, v_rate * v))
}
