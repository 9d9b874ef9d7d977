//! Stiffening by the effective tension: without it tension changes no lateral stiffness.

use super::context::yes;
use super::context::{Decision, EffectContext};
use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};

pub(crate) const TERM: Term = Term { at_rest: Some(at_rest), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    if context.active.gravity {
        yes("weight and weight on bit load the string")
    } else {
        yes("weight on bit, drag and the wall load the string")
    }
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    terms.by_tension = Some(element.beam.tension_stiffening());
}
