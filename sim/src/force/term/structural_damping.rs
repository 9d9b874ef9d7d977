//! Rayleigh damping: without it the structure takes no energy.

use super::account::Account;
use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;
use super::element::{ElementInMotion, MotionTerms};

pub(crate) const TERM: Term = Term { in_motion: Some(in_motion), ..Term::new(decide) };

/// Energy dissipated by Rayleigh damping: int v^T C v dt.
pub(crate) const DISSIPATED: Account = Account::taken("dissipated_structure", |booked| booked.matrices);

fn decide(context: &EffectContext<'_>) -> Decision {
    let damping = &context.scenario.damping;
    if damping.mass_proportional != 0.0 || damping.stiffness_proportional != 0.0 {
        yes("the structure is damped")
    } else {
        no("both coefficients are zero")
    }
}

fn in_motion(element: &ElementInMotion<'_>, terms: &mut MotionTerms) {
    let law = &element.damping;
    let mut matrix = element.structural_mass * law.mass_proportional;
    if law.stiffness_proportional != 0.0 {
        matrix += element.structural_stiffness * law.stiffness_proportional;
    }
    terms.add_damping(Some(&DISSIPATED), matrix);
}
