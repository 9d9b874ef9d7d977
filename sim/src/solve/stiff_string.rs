//! Torque and drag of the finite elements: the equilibrium of a string that moves along the hole (docs/model/soft-string.md).
//!
//! Bending stiffness, clearance, gauges and the flow of the mud take part, which a soft string lacks. A case takes as long as an equilibrium.

use drillsweep_scenario::{Bit, Effect, Gauge, Scenario, StartFriction, Switch};

use super::model::{Model, ModelError};
use super::soft_string::{
    BroomstickRow, Carried, DragCase, DragMode, DragSettings, Margins, SoftStringError, Strength,
};
use super::statics::{Equilibrium, StaticsError};
use crate::math::dof::{DOFS, W};

/// Friction of a hole without friction if a section of it has some.
const LEAST_FRICTION: f64 = 1e-12;

/// Reason for which a case has no forces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StiffStringError {
    /// The case itself is not valid.
    #[error(transparent)]
    Case(#[from] SoftStringError),
    /// The scenario has no model with the string at this depth.
    #[error("with the bit at {bit_depth} m: {error}")]
    Model {
        /// Measured depth of the bit \[m\].
        bit_depth: f64,
        /// Error of the model.
        error: ModelError,
    },
    /// The string does not come to rest.
    #[error("{}, with the bit at {bit_depth} m: {error}", .mode.name())]
    Statics {
        /// Motion and loads.
        mode: DragMode,
        /// Measured depth of the bit \[m\].
        bit_depth: f64,
        /// Error of the search.
        error: StaticsError,
    },
}

/// Forces at the surface and margins in one case.
///
/// # Errors
/// The case is not valid, or the string has no model or no equilibrium.
pub fn stiff_row(
    scenario: &Scenario,
    case: &DragCase,
    settings: &DragSettings,
) -> Result<BroomstickRow, StiffStringError> {
    let DragCase { mode, bit_depth, friction } = *case;
    let moving = in_case(scenario, case, settings)?;
    let model = Model::new(&moving).map_err(|error| StiffStringError::Model { bit_depth, error })?;
    let equilibrium =
        Equilibrium::find(&model).map_err(|error| StiffStringError::Statics { mode, bit_depth, error })?;
    let turns = moving.operation.rotation_speed_rpm != 0.0 || moving.operation.torque_on_bit != 0.0;
    let against = |torque: f64| if turns { torque.abs() } else { 0.0 };
    let first = &model.elements[0];
    let drag = equilibrium.drag.first().map_or(0.0, |drag| drag * first.unit_drag[W]);
    // The tension of an element is that in its middle.
    let upper_half = 0.5 * (first.load[W] + first.load[DOFS + W]) + drag;
    Ok(BroomstickRow {
        mode,
        friction,
        bit_depth,
        hook_load: equilibrium.tension[0] + upper_half + settings.travelling_weight,
        surface_torque: against(equilibrium.torque[0]),
        margins: margins(&model, &equilibrium),
    })
}

/// The scenario in equilibrium alone, with the bit at its depth, in the motion and under the loads of a case. Static friction has the value of dynamic friction, so that the wall
/// has one factor for every speed.
fn in_case(
    scenario: &Scenario,
    case: &DragCase,
    settings: &DragSettings,
) -> Result<Scenario, SoftStringError> {
    let DragCase { mode, friction, bit_depth } = *case;
    let mut moving = scenario.clone();
    // Gauges belong to the string.
    let bit = scenario.string.depth_of_bit();
    let in_hole = scenario.in_hole();
    let above_bit = |gauge: &Gauge| Gauge::above_bit(bit - gauge.depth(bit), gauge.clearance);
    moving.string.gauges = in_hole.string.gauges.iter().map(above_bit).collect();
    moving.string.gauges.retain(|gauge| gauge.depth(bit_depth) >= 0.0);
    moving.string.unbalance.clear();
    moving.excitation.clear();
    moving.bit = Bit::default();
    moving.recording.nodes.clear();
    moving.string.bit_depth = Some(bit_depth);
    moving.effects.set(Effect::Transient, Switch::Off);
    moving.statics.friction = StartFriction::BreakAway;
    let motion = mode.motion(&scenario.operation, settings)?;
    let operation = &mut moving.operation;
    operation.axial_speed = motion.axial_speed;
    if motion.rotation_speed == 0.0 {
        operation.rotation_speed_rpm = 0.0;
    } else if operation.rotation_speed_rpm == 0.0 {
        operation.rotation_speed_rpm = 1.0;
    }
    let [weight_on_bit, torque_on_bit] = mode.bit_loads(&in_hole.operation);
    operation.weight_on_bit = weight_on_bit;
    // The rock opposes the rotation.
    operation.torque_on_bit = if operation.rotation_speed_rpm < 0.0 { torque_on_bit } else { -torque_on_bit };
    let contact = &mut moving.contact;
    match friction {
        Some(friction) if !(friction.is_finite() && friction >= 0.0) => {
            return Err(SoftStringError::Friction(friction));
        }
        Some(friction) => {
            (contact.static_friction, contact.dynamic_friction) = (friction, friction);
            for section in &mut moving.well.section {
                (section.static_friction, section.dynamic_friction) = (None, None);
            }
        }
        None => {
            // No friction of the law means none of any section.
            let dynamic = moving.well.section.iter().filter_map(|section| section.dynamic_friction);
            let least = if dynamic.fold(0.0, f64::max) > 0.0 { LEAST_FRICTION } else { 0.0 };
            contact.dynamic_friction = contact.dynamic_friction.max(least);
            contact.static_friction = contact.dynamic_friction;
            for section in &mut moving.well.section {
                section.static_friction = section.dynamic_friction;
            }
        }
    }
    Ok(moving)
}

/// Extremes over all elements, bending to the curvature of the hole.
fn margins(model: &Model, equilibrium: &Equilibrium) -> Margins {
    let mut margins = Margins::default();
    for (e, (element, data)) in model.elements.iter().zip(&model.mesh.elements).enumerate() {
        let tension = equilibrium.tension[e];
        let [weight_x, weight_y] = element.lateral_load;
        let weight = weight_x.hypot(weight_y).hypot(element.axial_weight / data.length);
        let [side_x, side_y] =
            [0, 1].map(|axis| element.lateral_load[axis] + tension * element.curvature[axis]);
        let strength = Strength::new(*element.beam.section(), data.tube.material.grade, weight)
            .with_make_up_torque(model.scenario.string.sections[data.section].make_up_torque);
        let [curved_x, curved_y] = element.curvature;
        margins.keep(
            &strength,
            &Carried {
                measured_depth: data.top + 0.5 * data.length,
                tension,
                torque: equilibrium.torque[e],
                side_force: side_x.hypot(side_y),
                curvature: curved_x.hypot(curved_y),
                hole_diameter: data.hole.diameter,
            },
        );
    }
    margins
}
