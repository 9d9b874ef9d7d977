//! Weight of the mud in the bore less the buoyancy of the mud outside: without it the string has the weight of its steel.

use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};
use super::scene::{Call, Scene};
use super::scene::{has_mud, no};

pub(crate) const TERM: Term = Term { at_rest: Some(at_rest), ..Term::new(called_for) };

fn called_for(scene: &Scene<'_>) -> Call {
    let mud = has_mud(scene);
    if mud.active && !scene.active.gravity { no("without gravity mud has no weight") } else { mud }
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    let Some((mud, _)) = element.mud else { return };
    let section = element.beam.section();
    terms.mass_per_length += mud.density * (section.bore_area() - section.displaced_area());
}
