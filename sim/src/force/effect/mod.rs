//! The register of effects, each with its term, and of the accounts of the energy ledger; decisions about the effects that a scenario activates.

mod decide;
mod register;

pub use decide::{EffectDecision, active_effects, decide_effects};
pub(crate) use register::term;
pub use register::{ACCOUNTS, CONTACT_WORK};

pub use crate::force::term::gravity::GRAVITY;
pub use crate::force::term::{
    Account, Booked, DAMPING, Decision, EffectContext, ElementAtRest, ElementInMotion, MotionTerms,
    RestTerms, Side,
};
