//! Forces that no matrix holds: those of a scenario, and their entries of the ledger.

use std::sync::Arc;

use crate::force::nodal::{ForceContext, NodalForce};
use crate::force::{cut, end_load, unbalance, wall};

/// Works of forces that the ledger books, each under a name of its own.
pub(crate) const ENTRIES: [&str; 5] =
    [unbalance::WORK.name, wall::NORMAL_WORK, wall::FRICTION_WORK, wall::ROTATION_WORK, cut::ENTRY];

/// Forces of a scenario at a few nodes.
pub(crate) fn nodal_forces(context: &ForceContext<'_>) -> Vec<Arc<dyn NodalForce>> {
    [end_load::force, unbalance::force, cut::force].into_iter().filter_map(|force| force(context)).collect()
}
