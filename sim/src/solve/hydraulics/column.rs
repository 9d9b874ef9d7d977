//! Pressures of the whole circuit by one set of formulas.

use drillsweep_scenario::{Mud, PressureLosses};
use serde::Serialize;

use super::error::CircuitError;
use crate::force::mud::{CircuitLosses, SectionLosses};
use crate::solve::model::{GRAVITY, Model};
use crate::solve::statics::Equilibrium;

/// Pressures of the whole circuit by one set of formulas \[Pa\].
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct CircuitColumn {
    /// Formulas: `eccentric`, `concentric` or `rp13d`.
    pub losses: PressureLosses,
    /// True if the rotation of the string thins the laminar friction in the annulus.
    pub rotates: bool,
    /// Lost to friction in the lines on the surface.
    pub surface_loss: f64,
    /// Lost to friction in the bore.
    pub bore_loss: f64,
    /// Lost over tools in the string.
    pub tool_loss: f64,
    /// Lost at the bit.
    pub bit_loss: f64,
    /// Lost to friction in the annulus.
    pub annulus_loss: f64,
    /// Pressure at the pump: all losses, the back pressure, and the weight of the mud in the annulus over that in the bore, which is 0.
    pub standpipe_pressure: f64,
    /// Equivalent circulating density at the bit \[kg/m3\]; absent if the bit is not below the top, or without gravity.
    pub equivalent_circulating_density: Option<f64>,
}

/// Losses of every element by one set of formulas, from the top down \[Pa\].
#[derive(Debug, Clone)]
pub(super) struct ElementLosses {
    pub(super) annulus: Vec<f64>,
    pub(super) bore: Vec<f64>,
}

impl CircuitColumn {
    /// The column of a set of formulas, with the losses of every element.
    pub(super) fn new(
        model: &Model,
        equilibrium: &Equilibrium,
        mud: &Mud,
        losses: PressureLosses,
        rotates: bool,
    ) -> Result<(Self, ElementLosses), CircuitError> {
        let failed = |place: String, error| CircuitError::Mud { losses: losses.name(), place, error };
        let mud = Mud { rotation_factor: rotates, ..*mud };
        let mut sections = SectionLosses::new(&mud, losses, model.rotation_speed);
        let count = model.elements.len();
        let mut of_elements =
            ElementLosses { annulus: Vec::with_capacity(count), bore: Vec::with_capacity(count) };
        let elements = model.elements.iter().zip(&model.mesh.elements).zip(&equilibrium.flows);
        for ((of_model, element), flow) in elements {
            let gradients = sections
                .past(&of_model.flow_geometry, flow.eccentricity)
                .map_err(|error| failed(format!("at {:.1} m", element.top), error))?;
            of_elements.annulus.push(gradients.annulus * element.length);
            of_elements.bore.push(gradients.bore * element.length);
        }
        let circuit = CircuitLosses::new(&mud, &model.scenario.hydraulics, losses)
            .map_err(|error| failed("bit and surface lines".to_owned(), error))?;
        let [annulus_loss, bore_loss] =
            [&of_elements.annulus, &of_elements.bore].map(|losses| losses.iter().sum::<f64>());
        let column = Self {
            losses,
            rotates,
            surface_loss: circuit.surface,
            bore_loss,
            tool_loss: circuit.tools,
            bit_loss: circuit.bit,
            annulus_loss,
            standpipe_pressure: mud.back_pressure
                + annulus_loss
                + circuit.bit
                + circuit.tools
                + bore_loss
                + circuit.surface,
            equivalent_circulating_density: density(model, &mud, annulus_loss, count),
        };
        Ok((column, of_elements))
    }
}

/// Equivalent circulating density at a node \[kg/m3\], of the friction above it \[Pa\]; absent if the node is not below the top, or without
/// gravity.
pub(super) fn density(model: &Model, mud: &Mud, friction: f64, node: usize) -> Option<f64> {
    let depth = model.frames.get(node)?.position.z - model.frames.first()?.position.z;
    (depth > 0.0 && model.effects.gravity).then(|| mud.density + friction / (GRAVITY * depth))
}
