//! The effects of the model, one file each.
//!
//! A `Room` holds what is an effect's own: whether a scene calls for it and why, what it adds to an element at rest and in motion,
//! which degree of freedom it lets move, and by how much it is estimated to change frequencies. The element, the equations of motion and
//! the decisions go over the rooms of the effects that are on. Beside it stand the effect's nodal forces with their power, and the
//! [`Account`] of the energy ledger that tells of its work; the ledger goes over [`ACCOUNTS`]. Only the law of wall and friction stands
//! elsewhere, in [`crate::contact`], which the time step asks for four nodes side by side.

mod account;
mod axial_motion;
mod axial_stiffening;
mod buoyancy;
pub(crate) mod contact;
mod decide;
mod flow_stiffness;
mod fluid_added_mass;
mod fluid_coriolis;
mod fluid_damping;
pub(crate) mod friction;
pub(crate) mod friction_torque;
pub(crate) mod gravity;
mod gyroscopic;
pub(crate) mod mud_drag;
mod scene;
pub(crate) mod structural_damping;
mod terms;
mod torque_stiffening;
mod torsion;
mod transient;
pub(crate) mod unbalance;
mod well_bending;

pub use account::{Account, Booked, NodalWork, Side};
pub use decide::{EffectDecision, active_effects, decide_effects};
pub use gravity::GRAVITY;
pub use scene::{Call, Scene};
pub use terms::{ElementAtRest, ElementInMotion, MotionTerms, RestTerms};
pub use unbalance::UnbalanceForce;

use drillsweep_scenario::Effect;
use scene::LateralWave;

/// The accounts of the energy ledger, in the order of its columns.
pub const ACCOUNTS: [&Account; 8] = [
    &unbalance::WORK,
    &friction_torque::ROTATION,
    &fluid_coriolis::WORK,
    &structural_damping::DISSIPATED,
    &fluid_damping::DISSIPATED,
    &friction::DISSIPATED,
    &contact::DISSIPATED,
    &contact::WORK,
];

/// The accounts of the matrices that multiply velocities, in the order in which these are summed up; `None` is that of skew ones, which do
/// no work.
pub const DAMPING: [Option<&Account>; 4] = [
    Some(&structural_damping::DISSIPATED),
    None,
    Some(&fluid_damping::DISSIPATED),
    Some(&fluid_coriolis::WORK),
];

/// Where in [`DAMPING`] an account stands.
///
/// # Panics
/// When it does not: an effect that adds such a matrix has its account there.
pub(crate) fn place_of_damping(account: Option<&Account>) -> usize {
    let name = account.map(|account| account.name);
    let place = DAMPING.iter().position(|other| other.map(|other| other.name) == name);
    place.unwrap_or_else(|| panic!("the account {name:?} is not among those of damping"))
}

/// Contributions of an effect.
#[derive(Clone, Copy)]
pub(crate) struct Room {
    /// Whether a scene calls for it, and why.
    called_for: fn(&Scene<'_>) -> Call,
    /// By what share of itself it changes the frequency of a lateral wave; absent where no such estimate is made.
    frequency_change: Option<fn(&LateralWave) -> f64>,
    /// Adds its terms to an element, whatever the equilibrium.
    at_rest: Option<fn(&ElementAtRest<'_>, &mut RestTerms)>,
    /// Adds its terms to the motion of an element about the equilibrium.
    in_motion: Option<fn(&ElementInMotion<'_>, &mut MotionTerms)>,
    /// The degree of freedom of a node that moves only with this effect.
    moves: Option<usize>,
}

impl Room {
    /// Room of an effect that is no more than when it is called for.
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
        Effect::Gravity => gravity::ROOM,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_account_has_a_name_of_its_own_and_one_place_in_the_ledger() {
        for (i, account) in ACCOUNTS.iter().enumerate() {
            assert_eq!(
                ACCOUNTS.iter().position(|other| other.name == account.name),
                Some(i),
                "{}",
                account.name
            );
        }
        for account in DAMPING.into_iter().flatten() {
            assert!(
                ACCOUNTS.iter().any(|other| other.name == account.name),
                "{} has no column",
                account.name
            );
            assert_ne!(
                account.side,
                Side::Beside,
                "{}: what is booked there is not in the balance",
                account.name
            );
        }
    }
}
