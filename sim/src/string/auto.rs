//! Element lengths that follow from the string and its wall: the mesh `auto`.
//!
//! The wall acts along the elements, so that a tool joint needs no more than one: contact at nodes was 1 + 2/n^2 times too stiff against the rolling
//! of a joint of n elements, contact along them is exact for a rigid one. Bending requires elements:
//!
//! - Bodies between joints sag under compression and touch the wall in their middle in a curved hole. With eight elements a body, orbits between
//!   joints are within some 1 % of their limit.
//! - A part of the string on the wall presses itself in over (4 E I / kappa)^(1/4) next to a place that holds it off (Hetenyi 1946), 1.06 m for
//!   collars of 0.159 m.
//!
//! `study/tests/contact_mesh.rs` compares positions of rest in three wells with much finer meshes, and docs/accuracy.md has settled orbits.

use drillsweep_scenario::{Scenario, Section};

use crate::string::beam::BeamSection;

/// Elements of a tool joint.
const JOINT_ELEMENTS: f64 = 1.0;

/// Elements of a body between two tool joints.
const BODY_ELEMENTS: f64 = 8.0;

/// Elements along the length over which a wall spreads a bent pipe's force.
const ELEMENTS_A_SPREAD: f64 = 1.5;

/// Target element lengths \[m\] of a section's bodies and tool joints.
pub(super) fn targets(section: &Section, scenario: &Scenario) -> (f64, f64) {
    if let Some(joint) = &section.tool_joint {
        return ((section.length - 2.0 * joint.length) / BODY_ELEMENTS, joint.length / JOINT_ELEMENTS);
    }
    let pipe = BeamSection::pipe(
        section.outer_diameter,
        section.inner_diameter,
        &scenario.string.body_material(section),
    );
    let spread = (4.0 * pipe.bending_stiffness() / scenario.contact.stiffness_of_a_metre()).powf(0.25);
    let target = spread / ELEMENTS_A_SPREAD;
    (target, target)
}
