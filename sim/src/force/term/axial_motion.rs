//! Axial motion: without it every axial displacement stays at its static value and is not solved for.

use drillsweep_scenario::{ExcitationDirection, ExcitingForce};

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use crate::math::dof::W;

pub(crate) const TERM: Term = Term { moves: Some(W), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    let is_axial = |force: &ExcitingForce| force.direction == ExcitationDirection::Axial;
    if context.active.excitation && context.scenario.excitation.iter().any(is_axial) {
        yes("an axial force excites the string")
    } else if context.is_straight() {
        no("a straight string has no excitation of axial motion")
    } else {
        yes("the curved hole couples axial motion with bending")
    }
}
