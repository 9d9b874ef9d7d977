//! Element lengths that follow from the string and its wall: the mesh `auto`.
//!
//! The wall acts along the elements, so that a tool joint needs no more than one: contact at nodes was 1 + 2/n^2 times too stiff against the rolling
//! of a joint of n elements, contact along them is exact for a rigid one. Bending requires elements:
//!
//! - Bodies between joints sag under compression and touch the wall in their middle in a curved hole. With eight elements a body, orbits between
//!   joints are within some 1 % of their limit.
//! - Far above the bit, and far from every recorded depth, bodies only carry tension and torque and lie in their hole: two elements a body.
//! - A part of the string on the wall presses itself in over (4 E I / kappa)^(1/4) next to a place that holds it off (Hetenyi 1946), 1.06 m for
//!   collars of 0.159 m.
//!
//! `study/tests/contact_mesh.rs` compares positions of rest in three wells with much finer meshes, `sim/tests/real_well.rs` those of a string of
//! 3,438 m, and docs/accuracy.md has settled orbits.

use drillsweep_scenario::{Scenario, Section};

use crate::string::beam::BeamSection;

/// Elements of a tool joint.
const JOINT_ELEMENTS: f64 = 1.0;

/// Elements of a body between two tool joints.
const BODY_ELEMENTS: f64 = 8.0;

/// Elements of a body far above the bit.
const FAR_BODY_ELEMENTS: f64 = 2.0;

/// Distance above the bit \[m\] from which bodies are far: several assemblies.
const FAR_FROM_BIT: f64 = 300.0;

/// Distance from a recorded depth \[m\] from which bodies are far: some joints.
const FAR_FROM_RECORDED: f64 = 50.0;

/// Elements along the length over which a wall spreads a bent pipe's force.
const ELEMENTS_A_SPREAD: f64 = 1.5;

/// Target element lengths \[m\] of body and tool joints of a piece of a section between two depths.
pub(super) fn targets(section: &Section, scenario: &Scenario, piece: [f64; 2]) -> (f64, f64) {
    if let Some(joint) = &section.tool_joint {
        let elements = if is_far(scenario, piece) { FAR_BODY_ELEMENTS } else { BODY_ELEMENTS };
        return ((section.length - 2.0 * joint.length) / elements, joint.length / JOINT_ELEMENTS);
    }
    let pipe = BeamSection::of(&scenario.string.body(section));
    let spread = (4.0 * pipe.bending_stiffness() / scenario.contact.stiffness_of_a_metre()).powf(0.25);
    let target = spread / ELEMENTS_A_SPREAD;
    (target, target)
}

fn is_far(scenario: &Scenario, [top, bottom]: [f64; 2]) -> bool {
    let bit = scenario.string.depth_of_bit();
    // A node that is chosen by its number says nothing of a depth.
    let recorded = scenario.recording.nodes.iter().filter_map(|choice| choice.depth(bit));
    let is_far_from = |depth: f64| depth < top - FAR_FROM_RECORDED || depth > bottom + FAR_FROM_RECORDED;
    bit - bottom > FAR_FROM_BIT && recorded.into_iter().all(is_far_from)
}
