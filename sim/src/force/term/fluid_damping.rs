//! Damping of lateral motion by the mud, by its axial flow (C_f) and by the string's rotation (k): without it the mud takes no energy.

use super::account::Account;
use super::context::has_mud;
use super::contribution::Term;
use super::element::{ElementInMotion, MotionTerms};

pub(crate) const TERM: Term = Term { in_motion: Some(in_motion), ..Term::new(has_mud) };

/// Energy dissipated by the mud: int v^T (mud damping) v dt.
pub(crate) const DISSIPATED: Account = Account::taken("dissipated_fluid", |booked| booked.matrices);

fn in_motion(element: &ElementInMotion<'_>, terms: &mut MotionTerms) {
    let Some(flow) = element.flow else { return };
    let matrix = element.lateral_mass * (flow.friction_damping + flow.rotation_damping);
    terms.add_damping(Some(&DISSIPATED), matrix);
}
