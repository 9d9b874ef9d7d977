//! Convergence of contact iterations.

/// Changes that the last contact iteration of a solve still made at touching nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct SweepChange {
    /// Largest change of a lateral displacement \[m\].
    pub(crate) lateral: f64,
    /// Largest change of a friction coefficient.
    pub(crate) friction: f64,
}

impl SweepChange {
    /// True if neither change exceeds its bound; a change that is not a number does.
    pub(crate) fn is_within(&self, bound: &SweepChange) -> bool {
        self.lateral <= bound.lateral && self.friction <= bound.friction
    }

    /// Takes in the change of another solve of the same step.
    pub(crate) fn merge(&mut self, other: SweepChange) {
        self.lateral = self.lateral.max(other.lateral);
        self.friction = self.friction.max(other.friction);
    }
}
