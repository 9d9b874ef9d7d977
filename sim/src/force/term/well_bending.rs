//! Bending of a straight pipe into the curved hole: without it the string is stress-free along the hole's axis.

use super::contribution::Term;
use super::element::{ElementAtRest, RestTerms};
use super::scene::{Call, Scene};
use super::scene::{no, yes};

pub(crate) const TERM: Term = Term { at_rest: Some(at_rest), ..Term::new(called_for) };

fn called_for(scene: &Scene<'_>) -> Call {
    if scene.is_straight() { no("the hole is straight along the string") } else { yes("the hole is curved") }
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    let [upper, lower] = element.frames;
    terms.nodal -= element.stiffness * element.chord.tangent_rotations(upper, lower);
}
