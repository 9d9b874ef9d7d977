//! Stiffening by the effective tension: without it tension changes no lateral stiffness.

use super::scene::yes;
use super::{Call, ElementAtRest, RestTerms, Room, Scene};

pub(super) const ROOM: Room = Room { at_rest: Some(at_rest), ..Room::new(called_for) };

fn called_for(_: &Scene<'_>) -> Call {
    yes("weight and weight on bit load the string")
}

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    terms.by_tension = Some(element.beam.tension_stiffening());
}
