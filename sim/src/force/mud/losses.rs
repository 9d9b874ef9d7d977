//! Frictional gradients past the sections of a string by each set of formulas.

use drillsweep_scenario::{Mud, PressureLosses};

use super::element::SectionFlow;
use super::error::MudError;
use super::geometry::FlowGeometry;
use super::rp13d::Rp13dFlow;

/// Pressure lost to friction over a length \[Pa/m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionGradients {
    /// In the annulus.
    pub annulus: f64,
    /// In the bore.
    pub bore: f64,
}

/// Gradients by one set of formulas, solved once for each pair of diameters.
#[derive(Debug)]
pub struct SectionLosses {
    mud: Mud,
    losses: PressureLosses,
    rotation_speed: f64,
    known: Vec<(FlowGeometry, Known)>,
}

/// Solution for one pair of diameters.
#[derive(Debug)]
enum Known {
    /// Flow that depends on the eccentricity.
    Eccentric(Box<SectionFlow>),
    /// Gradients of a concentric pipe.
    Concentric(FrictionGradients),
}

impl SectionLosses {
    /// Gradients of a mud past a string that turns at a speed \[rad/s\].
    pub fn new(mud: &Mud, losses: PressureLosses, rotation_speed: f64) -> Self {
        Self { mud: *mud, losses, rotation_speed, known: Vec::new() }
    }

    /// Gradients past a section whose pipe has an eccentricity, which `concentric` and `rp13d` take as 0.
    ///
    /// # Errors
    /// The flow has no solution.
    pub fn past(
        &mut self,
        geometry: &FlowGeometry,
        eccentricity: f64,
    ) -> Result<FrictionGradients, MudError> {
        let found = match self.known.iter().position(|(known, _)| known == geometry) {
            Some(found) => found,
            None => {
                self.known.push((*geometry, self.solve(geometry)?));
                self.known.len() - 1
            }
        };
        match &self.known[found].1 {
            Known::Eccentric(section) => gradients(section, eccentricity),
            Known::Concentric(gradients) => Ok(*gradients),
        }
    }

    fn solve(&self, geometry: &FlowGeometry) -> Result<Known, MudError> {
        Ok(match self.losses {
            PressureLosses::Eccentric => {
                Known::Eccentric(Box::new(SectionFlow::new(&self.mud, geometry, self.rotation_speed)?))
            }
            PressureLosses::Concentric => Known::Concentric(gradients(
                &SectionFlow::new(&self.mud, geometry, self.rotation_speed)?,
                0.0,
            )?),
            PressureLosses::Rp13d => Known::Concentric(FrictionGradients {
                annulus: Rp13dFlow::annulus(&self.mud, geometry)?.friction_gradient,
                bore: Rp13dFlow::pipe(&self.mud, geometry.inner_diameter)?.friction_gradient,
            }),
        })
    }
}

fn gradients(section: &SectionFlow, eccentricity: f64) -> Result<FrictionGradients, MudError> {
    let flow = section.at_eccentricity(eccentricity)?;
    Ok(FrictionGradients { annulus: flow.friction_gradient, bore: flow.bore_friction_gradient })
}

/// Gradient \[Pa/m\] in a pipe of a diameter \[m\].
///
/// # Errors
/// The flow has no solution.
pub(super) fn bore_gradient(mud: &Mud, diameter: f64, losses: PressureLosses) -> Result<f64, MudError> {
    // The annulus of this geometry counts for nothing.
    let line = FlowGeometry {
        hole_diameter: 4.0 * diameter,
        outer_diameter: 2.0 * diameter,
        inner_diameter: diameter,
    };
    Ok(SectionLosses::new(mud, losses, 0.0).past(&line, 0.0)?.bore)
}
