//! Borehole contact and friction, equations (10) to (14) and (36) (docs/model/contact.md).
//!
//! With r = sqrt(u^2 + v^2), normal n = (u, v)/r and tangent t = (-v, u)/r in the sense of rotation, a node
//! touches the wall if its penetration P = r - j0 is positive. The law is in [`ContactParameters`], its friction in [`Friction`]; a node's
//! force in motion is [`dynamic_contact`], inside an implicit solve [`implicit_contact`], at rest [`static_contact`]; its
//! linearisation about steady sliding is [`sliding_tangent`].
//!
//! If stiffness belongs to a length, the same law acts along the elements: [`dynamic_segment`], [`implicit_segment`],
//! [`static_segment`] and [`sliding_segment`] integrate it over the part of a [`ContactSegment`] that is in the wall. Gauges remain points.

mod along_element;
mod along_element_tangents;
mod body;
mod friction;
mod law;
mod motion;
mod node;
mod rest;
mod sliding;
mod wall;

#[cfg(test)]
mod tests;

pub use along_element::{
    ContactSegment, Plane, SegmentCompliance, SegmentForce, SegmentMotion, dot, dynamic_segment,
    implicit_segment,
};
pub use along_element_tangents::{
    SlidingSegmentTangent, SmoothSegmentForce, StaticSegmentForce, planes, sliding_segment,
    smooth_static_segment, static_segment, whole_segment,
};
pub use body::BodyMotion;
pub use friction::Friction;
pub use law::{ContactParameters, FrictionAtRest};
pub use motion::{ContactForce, LateralMotion, Surface, Yielding, dynamic_contact, implicit_contact};
pub use node::ContactNode;
pub use rest::{SmoothContactForce, StaticContactForce, smooth_static_contact, static_contact};
pub use sliding::{SlidingTangent, sliding_tangent};
pub use wall::Wall;
