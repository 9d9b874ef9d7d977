//! Weight of the mud in the bore less the buoyancy of the mud outside: without it the string has the weight of its steel.

use super::context::{Decision, EffectContext};
use super::context::{has_mud, no};
use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};

pub(crate) const TERM: Term = Term { at_rest: Some(at_rest), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    let mud = has_mud(context);
    if mud.active && !context.active.gravity { no("without gravity mud has no weight") } else { mud }
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    let Some((mud, _)) = element.mud else { return };
    let section = element.beam.section();
    terms.mass_per_length += mud.density * (section.bore_area() - section.displaced_area());
}
