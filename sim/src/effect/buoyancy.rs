//! Weight of the mud in the bore less the buoyancy of the mud outside: without it the string weighs what its steel weighs.

use super::scene::has_mud;
use super::{ElementAtRest, RestTerms, Room};

pub(super) const ROOM: Room = Room { at_rest: Some(at_rest), ..Room::new(has_mud) };

fn at_rest(element: &ElementAtRest<'_>, terms: &mut RestTerms) {
    let Some((mud, _)) = element.mud else { return };
    let section = element.beam.section();
    terms.mass_per_length += mud.density * (section.bore_area() - section.displaced_area());
}
