//! Bending of a straight pipe into the curved hole: without it the string is stress-free along the hole's axis.

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};

pub(crate) const TERM: Term = Term { at_rest: Some(at_rest), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    if context.is_straight() {
        no("the hole is straight along the string")
    } else {
        yes("the hole is curved")
    }
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    let [upper, lower] = element.frames;
    terms.nodal -= element.stiffness * element.chord.tangent_rotations(upper, lower);
}
