//! The quasi-static equilibrium of the string on its wall, and the mud around it.
//!
//! Equation (35) by Newton's method on the exact tangent, with steps that are limited at each node, iterated
//! with the hydraulics until both have converged (docs/model/equilibrium.md).

mod buckling;
mod error;
mod homotopy;
mod hydraulics;
mod newton;
mod overload;
mod path;
mod relaxation;
mod touch;

pub use buckling::buckling_ratios;
pub use error::StaticsError;
pub use overload::Overload;
pub(crate) use overload::negative_eigenvalues;

use drillsweep_scenario::StartFriction;
use hydraulics::{Sections, drag, node_pressures, pressure_steps};
use newton::Start;
use touch::{contact_along, contact_at};

use crate::force::contact::Wall;
use crate::force::mud::{ElementFlow, MudError, PressureStep, Pressures};
use crate::math::dof::DOFS;
use crate::solve::model::{Model, NodalVector, element_values};

/// Hydraulic passes after which a fixed point must have been reached; each gains about three digits.
const HYDRAULIC_PASSES: usize = 30;

/// Change of an eccentricity at which string and mud have converged: with three digits gained in a pass, the remainder is rounding.
const ECCENTRICITY_TOLERANCE: f64 = 1e-10;

/// The string at rest: displacements, internal forces, contacts, flow.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// Displacement of every node in its own frame \[m, rad\].
    pub displacement: NodalVector,
    /// Effective tension of every element \[N\].
    pub tension: Vec<f64>,
    /// Torque of every element \[N m\].
    pub torque: Vec<f64>,
    /// Normal contact force of every node \[N\]; of contact along an element, the share of each node by its nearness.
    pub normal_force: Vec<f64>,
    /// Flow past every element; empty without mud.
    pub flows: Vec<ElementFlow>,
    /// Axial drag of the mud on every element, upward \[N/m\]; empty without drag.
    pub drag: Vec<f64>,
    /// Pressures of the mud at every node; absent without mud.
    pub pressures: Option<Pressures>,
    /// Effort of the search.
    pub effort: StaticsEffort,
}

/// Effort of finding an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticsEffort {
    /// Newton iterations in all.
    pub newton_iterations: usize,
    /// Passes of hydraulics and equilibrium.
    pub hydraulic_passes: usize,
    /// Largest unbalanced force \[N\] or moment \[N m\] left.
    pub residual: f64,
}

impl Equilibrium {
    /// The equilibrium of a model, searched from the centre line.
    ///
    /// # Errors
    /// Newton's method or the iteration with the hydraulics does not converge.
    pub fn find(model: &Model) -> Result<Self, StaticsError> {
        Self::find_from(model, vec![[0.0; DOFS]; model.node_count()])
    }

    /// The equilibrium searched from given displacements.
    ///
    /// # Errors
    /// As [`Equilibrium::find`].
    pub fn find_from(model: &Model, displacement: NodalVector) -> Result<Self, StaticsError> {
        let sections = Sections::new(model)?;
        let concentric = vec![0.0; model.elements.len()];
        let mut start = Start::Anywhere;
        let found = Self::in_passes(
            model,
            &model.wall,
            &sections,
            (displacement, concentric),
            |load, displacement| {
                let outcome = settled(model, load, displacement, start)?;
                start = Start::NextToSolution;
                Ok(outcome)
            },
        );
        let failure = match found {
            Err(failure) if !matches!(failure, StaticsError::Mud { .. }) => failure,
            ended => return ended,
        };
        // A string that no position holds may be in balance nevertheless, as a pencil on its tip.
        let failure = failure.with_overload(|| overload::find(model));
        if matches!(failure, StaticsError::NotConverged { overload: Some(_), .. }) {
            return Err(failure);
        }
        let Some((displacement, outcome)) = homotopy::find(model, &sections) else { return Err(failure) };
        let eccentricity = eccentricities(model, &displacement);
        let flows = sections.flows(&eccentricity)?;
        let drag = drag(model, &flows);
        let effort = StaticsEffort {
            newton_iterations: outcome.iterations,
            hydraulic_passes: 1,
            residual: outcome.residual,
        };
        Self::assemble(model, &model.wall, displacement, flows, drag, effort)
    }

    /// The equilibrium of the same model with another friction at rest, searched from this one; this one itself if there is no friction.
    ///
    /// # Errors
    /// Newton's method from this equilibrium, with and without its spring, or the iteration with the hydraulics does not converge.
    pub fn with_friction_at_rest(
        &self,
        model: &Model,
        friction: StartFriction,
    ) -> Result<Self, StaticsError> {
        let effects = &model.effects;
        let slides = model.body_motion().slides() && model.scenario.contact.static_friction != 0.0;
        if !(slides && effects.contact && (effects.friction || effects.friction_torque)) {
            return Ok(self.clone());
        }
        let wall = model.wall.with_friction_at_rest(friction);
        let sections = Sections::new(model)?;
        let start = (self.displacement.clone(), eccentricities(model, &self.displacement));
        Self::in_passes(model, &wall, &sections, start, |load, displacement| {
            let before = displacement.clone();
            newton::solve(model, &wall, load, displacement, Start::NextToSolution).or_else(|_| {
                *displacement = before;
                newton::solve(model, &wall, load, displacement, Start::Anywhere)
            })
        })
    }

    /// The same displacements with the flow past the string of another model of it, such as one that turns faster.
    ///
    /// # Errors
    /// The flow past a section has no solution.
    pub(crate) fn with_flows_of(&self, model: &Model) -> Result<Self, StaticsError> {
        let flows = Sections::new(model)?.flows(&eccentricities(model, &self.displacement))?;
        Ok(Self { flows, ..self.clone() })
    }

    /// The equilibrium on `wall` under the drag of the mud at the string's position. Equilibrium and drag are computed from each other in turn,
    /// beginning with displacements and eccentricities; `solve` moves displacements to the equilibrium under a load.
    fn in_passes(
        model: &Model,
        wall: &Wall,
        sections: &Sections,
        (mut displacement, mut eccentricity): (NodalVector, Vec<f64>),
        mut solve: impl FnMut(&[[f64; DOFS]], &mut NodalVector) -> Result<newton::NewtonOutcome, StaticsError>,
    ) -> Result<Self, StaticsError> {
        let mut newton_iterations = 0;
        for pass in 1..=HYDRAULIC_PASSES {
            let flows = sections.flows(&eccentricity)?;
            let drag = drag(model, &flows);
            let outcome = solve(&model.constant_load(&drag), &mut displacement)?;
            newton_iterations += outcome.iterations;
            let (mut change, mut node) = (0.0, 1);
            for (e, old) in eccentricity.iter_mut().enumerate() {
                let new = model.eccentricity(e, &displacement);
                if (new - *old).abs() > change {
                    (change, node) = ((new - *old).abs(), e + 1);
                }
                *old = new;
            }
            if flows.is_empty() || change <= ECCENTRICITY_TOLERANCE {
                let effort =
                    StaticsEffort { newton_iterations, hydraulic_passes: pass, residual: outcome.residual };
                return Self::assemble(model, wall, displacement, flows, drag, effort);
            }
            if pass == HYDRAULIC_PASSES {
                return Err(StaticsError::HydraulicsNotConverged { passes: pass, change, node });
            }
        }
        unreachable!("the last pass returns")
    }

    /// The string on the centre line without any load or flow: a stand-in for an equilibrium that is not known yet.
    pub(crate) fn unloaded(model: &Model) -> Self {
        let (nodes, elements) = (model.node_count(), model.elements.len());
        Self {
            displacement: vec![[0.0; DOFS]; nodes],
            tension: vec![0.0; elements],
            torque: vec![0.0; elements],
            normal_force: vec![0.0; nodes],
            flows: Vec::new(),
            drag: Vec::new(),
            pressures: None,
            effort: StaticsEffort { newton_iterations: 0, hydraulic_passes: 0, residual: 0.0 },
        }
    }

    /// Frictional gradients of every element by the formulas of the scenario's hydraulics; empty without mud.
    ///
    /// # Errors
    /// The flow past a section has no solution by these formulas.
    pub fn pressure_steps(&self, model: &Model) -> Result<Vec<PressureStep>, MudError> {
        match &model.scenario.mud {
            Some(mud) => pressure_steps(model, mud, &self.flows),
            None => Ok(Vec::new()),
        }
    }

    fn assemble(
        model: &Model,
        wall: &Wall,
        displacement: NodalVector,
        flows: Vec<ElementFlow>,
        drag: Vec<f64>,
        effort: StaticsEffort,
    ) -> Result<Self, StaticsError> {
        let rows = |row: fn(&crate::solve::model::StringElement) -> &crate::string::beam::ElementVector| {
            model
                .elements
                .iter()
                .enumerate()
                .map(|(e, element)| row(element).dot(&element_values(&displacement, e)))
                .collect::<Vec<f64>>()
        };
        let tension = rows(|element| &element.tension_row);
        let torque = rows(|element| &element.torque_row);
        let mut normal_force: Vec<f64> = (0..model.node_count())
            .map(|node| {
                contact_at(wall, node, &displacement[node], model.body_motion())
                    .map_or(0.0, |contact| contact.normal)
            })
            .collect();
        for element in 0..model.elements.len() {
            let contact = contact_along(&model.wall, element, &displacement, model.body_motion());
            let [upper, lower] = contact.map_or([0.0; 2], |contact| contact.ends);
            normal_force[element] += upper;
            normal_force[element + 1] += lower;
        }
        let pressures = model.scenario.mud.as_ref().map(|mud| node_pressures(model, mud, &flows)).transpose();
        // Pressures add up along the whole string: they are largest at its end.
        let pressures = pressures.map_err(|error| StaticsError::Mud { node: model.node_count(), error })?;
        Ok(Self { displacement, tension, torque, normal_force, flows, drag, pressures, effort })
    }
}

fn eccentricities(model: &Model, displacement: &[[f64; DOFS]]) -> Vec<f64> {
    (0..model.elements.len()).map(|element| model.eccentricity(element, displacement)).collect()
}

/// Newton's method. If it does not converge: relaxation from the same start.
fn settled(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
    start: Start,
) -> Result<newton::NewtonOutcome, StaticsError> {
    let before = displacement.clone();
    newton::solve(model, &model.wall, load, displacement, start).or_else(|failure| {
        *displacement = before;
        relaxation::settle(model, load, displacement).ok_or(failure)
    })
}
