//! Convergence of contact iterations.

/// Changes that the last contact iteration of a solve still made at touching nodes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct IterationChange {
    /// Largest change of a lateral displacement \[m\].
    pub(crate) lateral: f64,
    /// Largest change of a friction coefficient.
    pub(crate) friction: f64,
}

impl IterationChange {
    /// True if neither change exceeds its bound; a change that is not a number does.
    pub(crate) fn is_within(&self, bound: &IterationChange) -> bool {
        self.lateral <= bound.lateral && self.friction <= bound.friction
    }

    /// Takes in the change of another solve of the same step.
    pub(crate) fn merge(&mut self, other: IterationChange) {
        self.lateral = self.lateral.max(other.lateral);
        self.friction = self.friction.max(other.friction);
    }
}
