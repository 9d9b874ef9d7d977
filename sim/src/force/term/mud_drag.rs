//! Axial drag of the annular flow on the string, upward: without it the flow changes no tension.

use super::context::has_flow;
use super::contribution::Term;
use crate::force::mud::ElementFlow;

pub(crate) const TERM: Term = Term::new(has_flow);

/// Drag on every element in the effective tension, upward \[N/m\].
pub(crate) fn per_length(flows: &[ElementFlow]) -> Vec<f64> {
    flows.iter().map(|flow| flow.effective_drag_per_length).collect()
}
