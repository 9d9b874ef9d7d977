//! Element lengths that follow from the string and its wall: the mesh `auto`.
//!
//! The wall acts at nodes, so elements have to be short where its force changes along the string. Measured with the contact law
//! `per_length` against meshes of up to sixteen times the base case's elements, in three wells (base case, horizontal, building):
//!
//! - Above all tool joints ask for it. A joint rests on the wall with an edge, since the pipe beside it sags; n elements are 1 + 2/n^2 times
//!   as stiff against its tilting as a joint that rests along its length. Joints alone move the orbit of the pipe between them: 0.81, 0.90, 1.03 and
//!   1.10 mm at 57.7 m of the base case with 1, 2, 4 and 8 elements each, while collars four times as fine move it by 0.2 %.
//! - Bodies between joints are off the wall, or touch it with their middle. Their sag under compression, not the wall, asks for elements.
//! - What lies on the wall by itself presses it in over (4 E I / kappa)^(1/4) beside a place that holds it off (Hetenyi 1946), 1.06 m for
//!   collars of 0.159 m.
//! - Shorter elements beside gauges, beside changes of diameter, or towards the edges of joints gain nothing that the same number does
//!   not gain spread evenly: errors at rest stay the same to a digit.
//!
//! | damped base case, `per_length` | elements | worst node at rest, of the hole's radius | orbit size at 11.7, 57.7, 192.5 m \[mm\] over \[40, 60) s |
//! |---|---|---|---|
//! | the preset's lengths | 296 | 4.5e-3 | 0.594, 0.810, 3.859 |
//! | all of them halved | 592 | 2.5e-3 | 0.695, 0.863, 4.039 |
//! | all of them quartered | 1183 | 2.6e-4 | 0.645, 0.989, 3.952 |
//! | twice those of `auto` | 268 | 3.3e-3 | 0.623, 0.946, 4.108 |
//! | `auto` | 521 | 5.0e-4 | 0.574, 1.072, 3.927 |
//! | an eighth of the preset's | 2366 | 1.2e-4 | 0.637, 1.056, 3.935 |
//! | bodies 0.375, joints 0.019, collars 0.25 m | 957 | | 0.623, 1.074, 3.959 |
//!
//! Orbits were recorded at nodes put at those very depths (two elements more in `auto`). Those of this case scatter by some per cent from mesh to
//! mesh, by a tenth at 11.7 m, however fine it is.
//!
//! In the horizontal well `auto` is 5.1e-4 off at rest (592 elements of half the preset's lengths: 2.2e-3; 1183: 1.1e-3), in the building one 1.4e-4
//! (7.1e-4; 1.6e-4). Its orbits there are within 0.3 and 2 % of those on 957 elements, the ones on 592 elements within 0.9 and 16 %.

use drillsweep_scenario::{Scenario, Section};

use crate::beam::BeamSection;

/// Elements of a tool joint.
const JOINT_ELEMENTS: f64 = 1.0;

/// Elements of a body between two tool joints.
const BODY_ELEMENTS: f64 = 12.0;

/// Elements along the length over which a wall spreads a bent pipe's force.
const ELEMENTS_A_SPREAD: f64 = 2.0;

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
