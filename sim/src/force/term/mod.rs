//! Terms of the model that matrices and constant loads hold, one file of each effect.
//!
//! A [`Term`] is the contribution of an effect: the decision whether a scene calls for it, what it adds to an element at rest and in motion, the degree
//! of freedom that moves only with it, and an estimate of its change of frequencies. Element, equations of motion and decisions iterate over the terms of
//! the active effects. An effect that does work declares its [`Account`] of the energy ledger. Forces that no matrix holds are in
//! [`force`](crate::force).

mod account;
pub(crate) mod axial_motion;
pub(crate) mod axial_stiffening;
pub(crate) mod buoyancy;
mod element;
pub(crate) mod flow_stiffness;
pub(crate) mod fluid_added_mass;
pub(crate) mod fluid_coriolis;
pub(crate) mod fluid_damping;
pub(crate) mod gravity;
pub(crate) mod gyroscopic;
pub(crate) mod mud_drag;
mod scene;
pub(crate) mod structural_damping;
pub(crate) mod torque_stiffening;
pub(crate) mod torsion;
pub(crate) mod transient;
pub(crate) mod well_bending;

pub use account::{Account, Booked, Side};
pub use element::{ElementAtRest, ElementInMotion, MotionTerms, RestTerms};
pub use scene::{Call, Scene};
pub(crate) use scene::{LateralWave, has_friction, no, yes};

/// The accounts of the matrices that multiply velocities, in the order in which these are summed up; `None` is that of skew ones, which do
/// no work.
pub const DAMPING: [Option<&Account>; 4] = [
    Some(&structural_damping::DISSIPATED),
    None,
    Some(&fluid_damping::DISSIPATED),
    Some(&fluid_coriolis::WORK),
];

/// Place of an account in [`DAMPING`].
///
/// # Panics
/// When it has none: an effect that adds such a matrix has its account there.
pub(crate) fn place_of_damping(account: Option<&Account>) -> usize {
    let name = account.map(|account| account.name);
    let place = DAMPING.iter().position(|other| other.map(|other| other.name) == name);
    place.unwrap_or_else(|| panic!("the account {name:?} is not among those of damping"))
}

/// Contributions of an effect.
#[derive(Clone, Copy)]
pub(crate) struct Term {
    /// Decision whether a scene calls for it, and why.
    pub(crate) called_for: fn(&Scene<'_>) -> Call,
    /// Estimated relative change of the frequency of a lateral wave; absent without such an estimate.
    pub(crate) frequency_change: Option<fn(&LateralWave) -> f64>,
    /// Adds its terms to an element, whatever the equilibrium.
    at_rest: Option<fn(&ElementAtRest<'_>, &mut RestTerms)>,
    /// Adds its terms to the motion of an element about the equilibrium.
    in_motion: Option<fn(&ElementInMotion<'_>, &mut MotionTerms)>,
    /// The degree of freedom of a node that moves only with this effect.
    moves: Option<usize>,
}

impl Term {
    /// Term of an effect that only decides whether it is active.
    pub(crate) const fn new(called_for: fn(&Scene<'_>) -> Call) -> Self {
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
