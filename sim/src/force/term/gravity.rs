//! Gravity: without it neither the string nor the mud has weight.

use super::context::yes;
use super::context::{Decision, EffectContext};
use super::contribution::Term;

pub(crate) const TERM: Term = Term::new(decide);

/// Gravity \[m/s2\], the value behind the buoyed weights of the hydraulic tables.
pub const GRAVITY: f64 = 9.81;

fn decide(_: &EffectContext<'_>) -> Decision {
    yes("the string has weight")
}

/// The acceleration \[m/s2\] of weight and hydrostatic pressure.
pub(crate) fn acceleration(is_active: bool) -> f64 {
    if is_active { GRAVITY } else { 0.0 }
}
