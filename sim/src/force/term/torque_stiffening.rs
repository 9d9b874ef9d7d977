//! Stiffening by the internal torque: without it torque couples no lateral motion.

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};

pub(crate) const TERM: Term = Term { at_rest: Some(at_rest), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    match (context.scenario.operation.torque_on_bit != 0.0, context.active.friction_torque) {
        (true, _) => yes("torque on bit"),
        (false, true) => yes("friction twists the string"),
        // A curved hole guides torque but does not produce it.
        (false, false) => no("nothing twists the string"),
    }
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    terms.by_torque = Some(element.beam.torque_stiffening());
}
