//! The effects of the model, one file each.
//!
//! A `Room` holds what is an effect's own: whether a scene calls for it and why, what it adds to an element at rest and in motion,
//! which degree of freedom it lets move, and by how much it is estimated to change frequencies. The element, the equations of motion and
//! the decisions go over the rooms of the effects that are on; the energy ledger goes by the [`Account`]s under which they add their
//! damping. What pushes single nodes stands where it is evaluated: the law of wall and friction in [`crate::contact`], which the time step
//! asks for four nodes side by side, the unbalance in [`crate::motion`].

mod axial_motion;
mod axial_stiffening;
mod buoyancy;
mod contact;
mod decide;
mod flow_stiffness;
mod fluid_added_mass;
mod fluid_coriolis;
mod fluid_damping;
mod friction;
mod friction_torque;
mod gyroscopic;
pub(crate) mod mud_drag;
mod scene;
mod structural_damping;
mod terms;
mod torque_stiffening;
mod torsion;
mod transient;
mod unbalance;
mod well_bending;

pub use decide::EffectDecision;
pub use scene::{Call, Scene};
pub use terms::{Account, ElementAtRest, ElementInMotion, MotionTerms, RestTerms};

use crate::scenario::Effect;
use scene::LateralWave;

/// What an effect brings.
#[derive(Clone, Copy)]
pub(crate) struct Room {
    /// Whether a scene calls for it, and why.
    called_for: fn(&Scene<'_>) -> Call,
    /// By what share of itself it changes the frequency of a lateral wave; absent where no such estimate is made.
    frequency_change: Option<fn(&LateralWave) -> f64>,
    /// What it adds to an element, whatever the equilibrium.
    at_rest: Option<fn(&ElementAtRest<'_>, &mut RestTerms)>,
    /// What it adds to the motion of an element about the equilibrium.
    in_motion: Option<fn(&ElementInMotion<'_>, &mut MotionTerms)>,
    /// The degree of freedom of a node that moves only with this effect.
    moves: Option<usize>,
}

impl Room {
    /// That of an effect that is no more than when it is called for.
    const fn new(called_for: fn(&Scene<'_>) -> Call) -> Self {
        Self { called_for, frequency_change: None, at_rest: None, in_motion: None, moves: None }
    }

    /// Adds to an element what the effect makes of it, whatever the equilibrium.
    pub(crate) fn add_at_rest(&self, element: &ElementAtRest<'_>, terms: &mut RestTerms) {
        if let Some(add) = self.at_rest {
            add(element, terms);
        }
    }

    /// Adds to the motion of an element about the equilibrium.
    pub(crate) fn add_in_motion(&self, element: &ElementInMotion<'_>, terms: &mut MotionTerms) {
        if let Some(add) = self.in_motion {
            add(element, terms);
        }
    }

    /// The degree of freedom of a node that moves only with this effect.
    pub(crate) fn moves(&self) -> Option<usize> {
        self.moves
    }
}

/// The room of an effect.
pub(crate) const fn room(effect: Effect) -> Room {
    match effect {
        Effect::FluidAddedMass => fluid_added_mass::ROOM,
        Effect::FluidDamping => fluid_damping::ROOM,
        Effect::FluidCoriolis => fluid_coriolis::ROOM,
        Effect::FlowStiffness => flow_stiffness::ROOM,
        Effect::MudDrag => mud_drag::ROOM,
        Effect::Buoyancy => buoyancy::ROOM,
        Effect::Contact => contact::ROOM,
        Effect::Friction => friction::ROOM,
        Effect::FrictionTorque => friction_torque::ROOM,
        Effect::Unbalance => unbalance::ROOM,
        Effect::Gyroscopic => gyroscopic::ROOM,
        Effect::AxialStiffening => axial_stiffening::ROOM,
        Effect::TorqueStiffening => torque_stiffening::ROOM,
        Effect::WellBending => well_bending::ROOM,
        Effect::StructuralDamping => structural_damping::ROOM,
        Effect::Torsion => torsion::ROOM,
        Effect::AxialMotion => axial_motion::ROOM,
        Effect::Transient => transient::ROOM,
    }
}
