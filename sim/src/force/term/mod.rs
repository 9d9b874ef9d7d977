//! Terms of the model that matrices and constant loads hold, one file of each effect.
//!
//! A [`Term`] is the contribution of an effect: the decision on whether a scenario needs it, its terms of an element at rest and in motion, the
//! degree of freedom that moves only with it, and an estimate of its change of frequencies. Element, equations of motion and decisions iterate over
//! the terms of the active effects. An effect that does work declares its [`Account`] of the energy ledger. Forces that no matrix holds are in
//! [`force`](crate::force).

pub(crate) mod account;
pub(crate) mod axial_motion;
pub(crate) mod axial_stiffening;
pub(crate) mod buoyancy;
pub(crate) mod context;
pub(crate) mod contribution;
pub(crate) mod element;
pub(crate) mod flow_stiffness;
pub(crate) mod fluid_added_mass;
pub(crate) mod fluid_coriolis;
pub(crate) mod fluid_damping;
pub(crate) mod gravity;
pub(crate) mod gyroscopic;
pub(crate) mod mud_drag;
pub(crate) mod structural_damping;
pub(crate) mod torque_stiffening;
pub(crate) mod torsion;
pub(crate) mod transient;
pub(crate) mod well_bending;

pub use account::{Account, Booked, Side};
pub use context::{Decision, EffectContext};
pub(crate) use context::{LateralWave, has_friction, no, yes};
pub(crate) use contribution::Term;
pub use element::{ElementAtRest, ElementInMotion, MotionTerms, RestTerms};

/// The accounts of the matrices that multiply velocities, in the order in which these are summed up; `None` is that of skew matrices, which do
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
/// The account has no place: an effect that adds such a matrix has its account there.
pub(crate) fn place_of_damping(account: Option<&Account>) -> usize {
    let name = account.map(|account| account.name);
    let place = DAMPING.iter().position(|other| other.map(|other| other.name) == name);
    place.unwrap_or_else(|| panic!("the account {name:?} is not among those of damping"))
}
