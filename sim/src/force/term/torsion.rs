//! Torsional motion: without it every twist stays at its static value and is not solved for.

use drillsweep_scenario::{ExcitationDirection, ExcitingForce};

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use crate::math::dof::THETA_Z;

pub(crate) const TERM: Term = Term { moves: Some(THETA_Z), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    let EffectContext { scenario, active } = context;
    let is_torsional = |force: &ExcitingForce| force.direction == ExcitationDirection::Torsional;
    if active.friction_torque {
        yes("friction twists the string")
    } else if active.bit_rock {
        yes("torque on bit changes with the speed of the bit")
    } else if active.excitation && scenario.excitation.iter().any(is_torsional) {
        yes("a torque excites the string")
    } else if !context.is_straight() {
        yes("the curved hole couples twist with bending")
    } else {
        no("a straight string without friction torque has no excitation of torsion")
    }
}
