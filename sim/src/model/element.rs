//! One element of the string, in the frames of its two nodes.

use nalgebra::Vector3;

use super::chord::Chord;
use crate::beam::{BeamElement, BeamSection, ElementMatrix, ElementVector};
use crate::mud::FlowGeometry;
use crate::scenario::{ActiveEffects, Mud};
use crate::well::NodeFrame;

/// Gravity \[m/s2\], the value behind the buoyed weights of the hydraulic tables.
pub const GRAVITY: f64 = 9.81;

/// The matrices and loads of one element that do not change during the search for the equilibrium.
#[derive(Debug, Clone)]
pub struct StringElement {
    /// The beam in its chord frame.
    pub beam: BeamElement,
    /// The chord frame.
    pub chord: Chord,
    /// Geometry of the two flows past the element.
    pub flow_geometry: FlowGeometry,
    /// Elastic stiffness.
    pub elastic: ElementMatrix,
    /// Stiffening by a tension of 1 N; absent where the effect is off.
    pub tension_unit: Option<ElementMatrix>,
    /// Stiffening by a torque of 1 N m; absent where the effect is off.
    pub torque_unit: Option<ElementMatrix>,
    /// Stiffness of the flows, end term included; absent where the effect is off.
    pub flow: Option<ElementMatrix>,
    /// T = `tension_row` . q \[N\].
    pub tension_row: ElementVector,
    /// T0 = `torque_row` . q \[N m\].
    pub torque_row: ElementVector,
    /// Loads that do not depend on the eccentricity: weight, buoyancy, centrifugal load of the flows, less the
    /// forces of a straight pipe bent into the hole.
    pub load: ElementVector,
    /// Buoyed weight along the chord, downhole \[N\].
    pub axial_weight: f64,
    /// Nodal loads of 1 N/m upward along the chord, which the mud's drag multiplies.
    pub unit_drag: ElementVector,
}

/// What an element is made from.
pub struct ElementInput<'a> {
    /// Cross-section.
    pub section: BeamSection,
    /// Frames of the upper and the lower node.
    pub frames: [&'a NodeFrame; 2],
    /// Curvature vector of the centre line at mid-element \[1/m\], global.
    pub curvature: Vector3<f64>,
    /// Hole diameter \[m\].
    pub hole_diameter: f64,
    /// The mud, if there is any.
    pub mud: Option<&'a Mud>,
    /// The effects that take part.
    pub effects: &'a ActiveEffects,
    /// True for the element whose lower node is the bit.
    pub ends_at_bit: bool,
}

impl StringElement {
    /// Builds the element; terms whose effect is off are not assembled.
    pub fn new(input: &ElementInput<'_>) -> Self {
        let chord = Chord::between(input.frames[0], input.frames[1]);
        let beam = BeamElement::new(input.section, chord.length);
        let effects = input.effects;
        let section = &input.section;
        let stiffness = beam.stiffness();

        let steel = section.density * section.area;
        let weight = match input.mud {
            Some(mud) if effects.buoyancy => {
                steel + mud.density * (section.bore_area() - section.displaced_area())
            }
            _ => steel,
        };
        let mut distributed = chord.components(&Vector3::new(0.0, 0.0, weight * GRAVITY));
        let mut flow = None;
        let flow_geometry = FlowGeometry {
            hole_diameter: input.hole_diameter,
            outer_diameter: section.outer_diameter,
            inner_diameter: section.inner_diameter,
        };
        if let Some(mud) = input.mud.filter(|_| effects.flow_stiffness) {
            let momentum = FlowMomentum::new(mud, section, input.hole_diameter);
            let curvature = chord.components(&input.curvature);
            for (load, kappa) in distributed.iter_mut().zip(curvature).take(2) {
                *load -= (momentum.bore_flux - momentum.annulus_flux) * kappa;
            }
            let v2 = momentum.bore_flux + momentum.added_mass_coefficient * momentum.annulus_flux;
            let mut matrix = beam.tension_stiffening() * -v2;
            if input.ends_at_bit {
                matrix += beam.flow_end() * v2;
            }
            flow = Some(chord.matrix_to_nodes(&matrix));
        }
        let mut load = beam.distributed_load(distributed);
        if effects.well_bending {
            load -= stiffness * chord.tangent_rotations(input.frames[0], input.frames[1]);
        }
        let to_nodes = |m: ElementMatrix| chord.matrix_to_nodes(&m);
        Self {
            elastic: to_nodes(stiffness),
            tension_unit: effects.axial_stiffening.then(|| to_nodes(beam.tension_stiffening())),
            torque_unit: effects.torque_stiffening.then(|| to_nodes(beam.torque_stiffening())),
            flow,
            tension_row: chord.vector_to_nodes(&beam.tension_row()),
            torque_row: chord.vector_to_nodes(&beam.torque_row()),
            load: chord.vector_to_nodes(&load),
            axial_weight: distributed[2] * chord.length,
            unit_drag: chord.vector_to_nodes(&beam.distributed_load([0.0, 0.0, -1.0])),
            flow_geometry,
            beam,
            chord,
        }
    }

    /// Stiffness at a given tension \[N\] and torque \[N m\].
    pub fn stiffness(&self, tension: f64, torque: f64) -> ElementMatrix {
        let mut k = self.elastic;
        if let Some(unit) = &self.tension_unit {
            k += unit * tension;
        }
        if let Some(unit) = &self.torque_unit {
            k += unit * torque;
        }
        if let Some(flow) = &self.flow {
            k += flow;
        }
        k
    }
}

/// Momentum fluxes of the two flows past one section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowMomentum {
    /// M_f U_i^2 \[N\].
    pub bore_flux: f64,
    /// rho_f A_o U_o^2 \[N\].
    pub annulus_flux: f64,
    /// Mass of mud in the bore per length M_f \[kg/m\].
    pub bore_mass: f64,
    /// Mass displaced per length rho_f A_o \[kg/m\].
    pub displaced_mass: f64,
    /// Added mass coefficient chi, equation (28).
    pub added_mass_coefficient: f64,
    /// Coriolis coefficient 2 M_f U_i - 2 chi rho_f A_o U_o \[kg/s\].
    pub coriolis: f64,
}

impl FlowMomentum {
    /// The fluxes for the mean speeds of `mud` past `section` in a hole of `hole_diameter` \[m\].
    pub fn new(mud: &Mud, section: &BeamSection, hole_diameter: f64) -> Self {
        let (hole2, outer2) = (hole_diameter.powi(2), section.outer_diameter.powi(2));
        let annulus_area = std::f64::consts::FRAC_PI_4 * (hole2 - outer2);
        let bore_mass = mud.density * section.bore_area();
        let displaced_mass = mud.density * section.displaced_area();
        let bore_speed = if section.bore_area() > 0.0 { mud.flow_rate / section.bore_area() } else { 0.0 };
        let annulus_speed = mud.flow_rate / annulus_area;
        let chi = (hole2 + outer2) / (hole2 - outer2);
        Self {
            bore_flux: bore_mass * bore_speed * bore_speed,
            annulus_flux: displaced_mass * annulus_speed * annulus_speed,
            bore_mass,
            displaced_mass,
            added_mass_coefficient: chi,
            coriolis: 2.0 * (bore_mass * bore_speed - chi * displaced_mass * annulus_speed),
        }
    }
}
