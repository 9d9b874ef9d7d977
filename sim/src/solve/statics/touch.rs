//! Contact at rest, of nodes and along elements.

use crate::force::contact::{
    BodyMotion, StaticContactForce, StaticSegmentForce, Wall, static_contact, static_segment,
};
use crate::math::dof::{DOFS, U, V};
use crate::solve::model::element_values;

/// Quasi-static contact force of a node; `None` if it does not touch.
pub(super) fn contact_at(
    wall: &Wall,
    node: usize,
    displacement: &[f64; DOFS],
    motion: BodyMotion,
) -> Option<StaticContactForce> {
    let site = wall.sites()[node].as_ref()?;
    let contact = static_contact(wall.law(), site, displacement[U], displacement[V], motion);
    (contact.penetration > 0.0).then_some(contact)
}

/// Quasi-static contact along an element; `None` if it does not touch.
pub(super) fn contact_along(
    wall: &Wall,
    element: usize,
    displacement: &[[f64; DOFS]],
    motion: BodyMotion,
) -> Option<StaticSegmentForce> {
    let segment = wall.segments().get(element)?;
    static_segment(wall.law(), segment, &element_values(displacement, element), motion)
}
