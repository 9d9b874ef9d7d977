//! Added mass of the mud inside and outside, equation (28): without it only steel moves.

use super::context::has_mud;
use super::contribution::Term;
use super::element::{ElementInMotion, MotionTerms};

pub(crate) const TERM: Term = Term { in_motion: Some(in_motion), ..Term::new(has_mud) };

fn in_motion(element: &ElementInMotion<'_>, terms: &mut MotionTerms) {
    let Some(momentum) = element.momentum else { return };
    terms.mass = Some(element.lateral_mass * momentum.lateral_mass());
}
