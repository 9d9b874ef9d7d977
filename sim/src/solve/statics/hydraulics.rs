//! The mud past a string at rest: flows, drag and pressures, by the string's position.

use drillsweep_scenario::{Mud, PressureLosses};

use super::error::StaticsError;

use crate::force::mud::{
    CircuitLosses, ElementFlow, FlowGeometry, MudError, PressureStep, Pressures, SectionFlow, SectionLosses,
    pressures,
};
use crate::force::term::{gravity, mud_drag};
use crate::math::dof::{DOFS, U, V};
use crate::solve::model::{Model, StringElement};
use crate::string::MeshElement;

/// Change of the eccentricity over which the slope of the drag is taken.
const ECCENTRICITY_STEP: f64 = 1e-6;

/// The flow past every cross-section of the string, solved once for each pair of diameters.
pub(super) struct Sections {
    distinct: Vec<SectionFlow>,
    of_element: Vec<usize>,
}

impl Sections {
    pub(super) fn new(model: &Model) -> Result<Self, StaticsError> {
        let mut sections = Self { distinct: Vec::new(), of_element: Vec::new() };
        let Some(mud) = &model.scenario.mud else { return Ok(sections) };
        let mut seen: Vec<FlowGeometry> = Vec::new();
        for (e, element) in model.elements.iter().enumerate() {
            let geometry = element.flow_geometry;
            let index = match seen.iter().position(|other| *other == geometry) {
                Some(index) => index,
                None => {
                    let flow = SectionFlow::new(mud, &geometry, model.rotation_speed);
                    sections.distinct.push(flow.map_err(|error| StaticsError::Mud { node: e + 1, error })?);
                    seen.push(geometry);
                    seen.len() - 1
                }
            };
            sections.of_element.push(index);
        }
        Ok(sections)
    }

    /// The flow past every element at its eccentricity; empty without mud.
    pub(super) fn flows(&self, eccentricity: &[f64]) -> Result<Vec<ElementFlow>, StaticsError> {
        let elements = self.of_element.iter().zip(eccentricity).enumerate();
        let flow = |(e, (&section, &eccentricity)): (usize, (&usize, &f64))| {
            let flow = self.distinct[section].at_eccentricity(eccentricity);
            flow.map_err(|error| StaticsError::Mud { node: e + 1, error })
        };
        elements.map(flow).collect()
    }

    /// Drag on every element at the string's position \[N/m\], with its derivatives by u and v of the upper and of the lower node \[N/m2\]; empty
    /// if drag is left out. `None` if there is no flow.
    pub(super) fn drag_at(
        &self,
        model: &Model,
        displacement: &[[f64; DOFS]],
    ) -> Option<Vec<(f64, [[f64; 2]; 2])>> {
        if !model.effects.mud_drag {
            return Some(Vec::new());
        }
        let of_element = |(element, &section): (usize, &usize)| {
            let eccentricity = model.eccentricity(element, displacement);
            let drag = |eccentricity| {
                let flow = self.distinct[section].at_eccentricity(eccentricity).ok()?;
                Some(mud_drag::per_length(std::slice::from_ref(&flow))[0])
            };
            // A pipe beyond the wall has the flow of one that touches it.
            let slope = if eccentricity < 1.0 {
                let ends = [(eccentricity - ECCENTRICITY_STEP).max(0.0), eccentricity + ECCENTRICITY_STEP];
                (drag(ends[1])? - drag(ends[0])?) / (ends[1] - ends[0])
            } else {
                0.0
            };
            let clearance = model.mesh.elements[element].clearance();
            let by_node = [element, element + 1].map(|node| {
                let [u, v] = [displacement[node][U], displacement[node][V]];
                let radius = u.hypot(v);
                let by_radius = if radius > 0.0 { 0.5 * slope / (clearance * radius) } else { 0.0 };
                [by_radius * u, by_radius * v]
            });
            Some((drag(eccentricity)?, by_node))
        };
        self.of_element.iter().enumerate().map(of_element).collect()
    }
}

/// Pressures of the mud at every node.
pub(super) fn node_pressures(model: &Model, mud: &Mud, flows: &[ElementFlow]) -> Result<Pressures, MudError> {
    let true_vertical_depth: Vec<f64> = model.frames.iter().map(|frame| frame.position.z).collect();
    let steps = pressure_steps(model, mud, flows)?;
    let hydraulics = &model.scenario.hydraulics;
    let losses = CircuitLosses::new(mud, hydraulics, hydraulics.losses)?;
    let mud = Mud { bit_pressure_drop: losses.bit + losses.tools, ..*mud };
    pressures(&mud, gravity::acceleration(model.effects.gravity), &true_vertical_depth, &steps)
}

/// Frictional gradients of every element by the scenario's formulas.
pub(super) fn pressure_steps(
    model: &Model,
    mud: &Mud,
    flows: &[ElementFlow],
) -> Result<Vec<PressureStep>, MudError> {
    let losses = model.scenario.hydraulics.losses;
    let mut sections = SectionLosses::new(mud, losses, model.rotation_speed);
    let elements = model.mesh.elements.iter().zip(&model.elements).zip(flows);
    let step = |((element, of_model), flow): ((&MeshElement, &StringElement), &ElementFlow)| {
        let (annulus, bore) = match losses {
            PressureLosses::Eccentric => (flow.friction_gradient, flow.bore_friction_gradient),
            PressureLosses::Concentric | PressureLosses::Rp13d => {
                let gradients = sections.past(&of_model.flow_geometry, flow.eccentricity)?;
                (gradients.annulus, gradients.bore)
            }
        };
        Ok(PressureStep { length: element.length, friction_gradient: annulus, bore_friction_gradient: bore })
    };
    elements.map(step).collect()
}

/// Drag of the mud on every element, upward \[N/m\]; empty if drag is left out.
pub(super) fn drag(model: &Model, flows: &[ElementFlow]) -> Vec<f64> {
    if model.effects.mud_drag { mud_drag::per_length(flows) } else { Vec::new() }
}
