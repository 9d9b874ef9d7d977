//! Contributions of an effect to the model.

use super::context::{Decision, EffectContext, LateralWave};
use super::element::{ElementAtRest, ElementInMotion, MotionTerms, RestTerms};

/// Contributions of an effect.
#[derive(Clone, Copy)]
pub(crate) struct Term {
    /// Decision on whether a scenario needs the effect, with its reason.
    pub(crate) decide: fn(&EffectContext<'_>) -> Decision,
    /// Estimated relative change of the frequency of a lateral wave; absent without such an estimate.
    pub(crate) frequency_change: Option<fn(&LateralWave) -> f64>,
    /// Adds its terms to an element, independently of the equilibrium.
    pub(super) at_rest: Option<fn(&ElementAtRest<'_>, &mut RestTerms)>,
    /// Adds its terms to the motion of an element about the equilibrium.
    pub(super) in_motion: Option<fn(&ElementInMotion<'_>, &mut MotionTerms)>,
    /// The degree of freedom of a node that moves only with this effect.
    pub(super) moves: Option<usize>,
}

impl Term {
    /// Term of an effect that only decides whether it is active.
    pub(crate) const fn new(decide: fn(&EffectContext<'_>) -> Decision) -> Self {
        Self { decide, frequency_change: None, at_rest: None, in_motion: None, moves: None }
    }

    /// Adds the effect's terms to an element, independently of the equilibrium.
    pub(crate) fn add_at_rest(&self, element: &ElementAtRest<'_>, terms: &mut RestTerms) {
        if let Some(add) = self.at_rest {
            add(element, terms);
        }
    }

    /// Adds the effect's terms to the motion of an element about the equilibrium.
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
