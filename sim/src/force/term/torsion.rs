//! Torsional motion: without it every twist stays at its static value and is not solved for.

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use crate::math::dof::THETA_Z;

pub(crate) const TERM: Term = Term { moves: Some(THETA_Z), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    match (context.active.friction_torque, context.is_straight()) {
        (true, _) => yes("friction twists the string"),
        (false, false) => yes("the curved hole couples twist with bending"),
        (false, true) => no("a straight string without friction torque has no excitation of torsion"),
    }
}
