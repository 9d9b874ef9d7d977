//! One element of the string, in the frames of its two nodes.

use drillsweep_scenario::{ActiveEffects, Effect, Mud};
use nalgebra::Vector3;

use crate::force::effect::{ElementAtRest, RestTerms, term};
use crate::force::mud::{FlowGeometry, FlowMomentum};
use crate::force::term::gravity;
use crate::string::beam::{BeamElement, BeamSection, Chord, ElementMatrix, ElementVector};
use crate::string::well::NodeFrame;

/// The matrices and loads of one element that do not change during the search for the equilibrium.
#[derive(Debug, Clone)]
pub struct StringElement {
    /// The beam in its chord frame.
    pub beam: BeamElement,
    /// The chord frame.
    pub chord: Chord,
    /// Geometry of the two flows past the element.
    pub flow_geometry: FlowGeometry,
    /// Masses and momentum of these flows; absent without mud.
    pub momentum: Option<FlowMomentum>,
    /// Elastic stiffness.
    pub elastic: ElementMatrix,
    /// Stiffening by a tension of 1 N; absent if the effect is off.
    pub tension_unit: Option<ElementMatrix>,
    /// Stiffening by a torque of 1 N m; absent if the effect is off.
    pub torque_unit: Option<ElementMatrix>,
    /// Loads, on the left-hand side, of a tension of 1 N on the slopes that the hole's axis has against the chord; zero if the effect is off.
    pub tension_load: ElementVector,
    /// The same of a torque of 1 N m.
    pub torque_load: ElementVector,
    /// Stiffness of the flows, end term included; absent if the effect is off.
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
    /// Load across the chord in its frame: buoyed weight, and centrifugal load of the flows \[N/m\].
    pub lateral_load: [f64; 2],
    /// Curvature of the hole across the chord, in its frame \[1/m\].
    pub curvature: [f64; 2],
    /// Nodal loads of 1 N/m upward along the chord, which the mud's drag multiplies.
    pub unit_drag: ElementVector,
}

/// Inputs of an element.
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
    /// Builds the element, without terms of effects that are off.
    pub fn new(input: &ElementInput<'_>) -> Self {
        let chord = Chord::between(input.frames[0], input.frames[1]);
        let beam = BeamElement::new(input.section, chord.length);
        let section = &input.section;
        let stiffness = beam.stiffness();
        let flow_geometry = FlowGeometry::past(section, input.hole_diameter);
        let momentum = input.mud.map(|mud| FlowMomentum::new(mud, &flow_geometry));
        let mut terms = RestTerms::of_mass(section.density * section.area);
        let element = ElementAtRest {
            beam: &beam,
            chord: &chord,
            stiffness: &stiffness,
            frames: input.frames,
            curvature: input.curvature,
            mud: input.mud.zip(momentum.as_ref()),
            ends_at_bit: input.ends_at_bit,
        };
        for &effect in Effect::ALL.iter().filter(|&&effect| input.effects.is_active(effect)) {
            term(effect).add_at_rest(&element, &mut terms);
        }
        let acceleration = gravity::acceleration(input.effects.gravity);
        let weight = chord.components(&Vector3::new(0.0, 0.0, terms.mass_per_length * acceleration));
        let distributed = std::array::from_fn(|axis| weight[axis] + terms.distributed[axis]);
        let load = beam.distributed_load(distributed) + terms.nodal;
        let curvature = chord.components(&input.curvature);
        let to_nodes = |matrix: ElementMatrix| chord.matrix_to_nodes(&matrix);
        let initial_slopes = chord.tangent_rotations(input.frames[0], input.frames[1]);
        let of_slopes = |unit: &Option<ElementMatrix>| {
            let load = unit.map_or(ElementVector::zeros(), |unit| unit * initial_slopes);
            chord.vector_to_nodes(&load)
        };
        Self {
            elastic: to_nodes(stiffness),
            tension_load: of_slopes(&terms.by_tension),
            torque_load: of_slopes(&terms.by_torque),
            tension_unit: terms.by_tension.map(to_nodes),
            torque_unit: terms.by_torque.map(to_nodes),
            flow: terms.stiffness.map(to_nodes),
            tension_row: chord.vector_to_nodes(&beam.tension_row()),
            torque_row: chord.vector_to_nodes(&beam.torque_row()),
            load: chord.vector_to_nodes(&load),
            axial_weight: distributed[2] * chord.length,
            lateral_load: [distributed[0], distributed[1]],
            curvature: [curvature[0], curvature[1]],
            unit_drag: chord.vector_to_nodes(&beam.distributed_load([0.0, 0.0, -1.0])),
            flow_geometry,
            momentum,
            beam,
            chord,
        }
    }

    /// Loads, on the left-hand side, of tension \[N\] and torque \[N m\] on the slopes of the hole's axis against the chord, T K_s theta0 + T0 K_t
    /// theta0 (docs/model/beam.md, Tension and torque in a curved hole).
    ///
    /// The chords alone carry the lateral load T kappa as forces at the nodes; these loads distribute it along the element.
    pub fn load_of_slopes(&self, tension: f64, torque: f64) -> ElementVector {
        self.tension_load * tension + self.torque_load * torque
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
