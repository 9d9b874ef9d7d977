//! Axial motion: without it every axial displacement stays at its static value and is not solved for.

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use crate::math::dof::W;

pub(crate) const TERM: Term = Term { moves: Some(W), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    if context.is_straight() {
        no("a straight string has no excitation of axial motion")
    } else {
        yes("the curved hole couples axial motion with bending")
    }
}
