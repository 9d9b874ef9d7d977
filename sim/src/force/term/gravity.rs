//! Gravity: without it neither the string nor the mud has weight.

use super::contribution::Term;
use super::scene::yes;
use super::scene::{Call, Scene};

pub(crate) const TERM: Term = Term::new(called_for);

/// Gravity \[m/s2\], the value behind the buoyed weights of the hydraulic tables.
pub const GRAVITY: f64 = 9.81;

fn called_for(_: &Scene<'_>) -> Call {
    yes("the string has weight")
}

/// The acceleration \[m/s2\] of weight and hydrostatic pressure.
pub(crate) fn acceleration(is_active: bool) -> f64 {
    if is_active { GRAVITY } else { 0.0 }
}
