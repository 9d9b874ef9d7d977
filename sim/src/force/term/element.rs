//! Terms that effects add to an element.

use drillsweep_scenario::{Mud, RayleighDamping};
use nalgebra::Vector3;

use super::account::Account;
use crate::force::mud::{ElementFlow, FlowMomentum};
use crate::string::beam::{BeamElement, Chord, ElementMatrix, ElementVector};
use crate::string::well::NodeFrame;

/// An element before the equilibrium is known, for the terms of effects.
pub struct ElementAtRest<'a> {
    /// The beam in its chord frame.
    pub beam: &'a BeamElement,
    /// The chord frame.
    pub chord: &'a Chord,
    /// Its elastic stiffness, in the chord frame.
    pub stiffness: &'a ElementMatrix,
    /// Frames of the upper and the lower node.
    pub frames: [&'a NodeFrame; 2],
    /// Curvature vector of the centre line at mid-element \[1/m\], global.
    pub curvature: Vector3<f64>,
    /// The mud with the flows past the element; absent without mud.
    pub mud: Option<(&'a Mud, &'a FlowMomentum)>,
    /// True for the element whose lower node is the bit.
    pub ends_at_bit: bool,
}

/// Terms that effects add to an element at rest, in the chord frame.
#[derive(Debug, Clone)]
pub struct RestTerms {
    /// Weight over gravity, of steel and mud \[kg/m\].
    pub mass_per_length: f64,
    /// Distributed load in addition to the weight, along e1, e2, e3 \[N/m\].
    pub distributed: [f64; 3],
    /// Nodal loads.
    pub nodal: ElementVector,
    /// Stiffness that the state does not change.
    pub stiffness: Option<ElementMatrix>,
    /// Stiffening by a tension of 1 N.
    pub by_tension: Option<ElementMatrix>,
    /// Stiffening by a torque of 1 N m.
    pub by_torque: Option<ElementMatrix>,
}

impl RestTerms {
    /// Terms of an element of `mass_per_length` \[kg/m\] and nothing else.
    pub(crate) fn of_mass(mass_per_length: f64) -> Self {
        Self {
            mass_per_length,
            distributed: [0.0; 3],
            nodal: ElementVector::zeros(),
            stiffness: None,
            by_tension: None,
            by_torque: None,
        }
    }
}

/// An element in motion about an equilibrium, for the terms of effects; its matrices are over nodal values.
pub struct ElementInMotion<'a> {
    /// The beam in its chord frame.
    pub beam: &'a BeamElement,
    /// The chord frame.
    pub chord: &'a Chord,
    /// Mass of the structure.
    pub structural_mass: &'a ElementMatrix,
    /// Stiffness of the structure under the tension of the equilibrium.
    pub structural_stiffness: &'a ElementMatrix,
    /// Mass of 1 kg/m that moves sideways.
    pub lateral_mass: &'a ElementMatrix,
    /// Speed of rotation \[rad/s\].
    pub rotation_speed: f64,
    /// Rayleigh damping of the structure.
    pub damping: RayleighDamping,
    /// Masses and momentum of the flows past the element; absent without mud.
    pub momentum: Option<&'a FlowMomentum>,
    /// The flow past it at the equilibrium; absent without mud.
    pub flow: Option<&'a ElementFlow>,
}

/// Terms that effects add to the motion of an element, over nodal values.
#[derive(Debug, Clone, Default)]
pub struct MotionTerms {
    /// Mass in addition to the structure's.
    pub mass: Option<ElementMatrix>,
    /// Matrices that multiply velocities, each with the account of its work.
    pub damping: Vec<(Option<&'static Account>, ElementMatrix)>,
}

impl MotionTerms {
    /// Adds a matrix that multiplies velocities, with the account of its work; a skew one does none.
    pub(crate) fn add_damping(&mut self, account: Option<&'static Account>, matrix: ElementMatrix) {
        self.damping.push((account, matrix));
    }
}
