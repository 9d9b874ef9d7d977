//! Forces that no matrix holds: those of a scenario, and their entries of the ledger.

use std::sync::Arc;

use crate::force::nodal::{ForceContext, NodalForce};
use crate::force::{bit_rock, cut, end_load, excitation, top_drive, unbalance, wall};

/// Works of forces that the ledger books, each under a name of its own.
pub(crate) const ENTRIES: [&str; 8] = [
    unbalance::WORK.name,
    wall::NORMAL_WORK,
    wall::FRICTION_WORK,
    wall::ROTATION_WORK,
    cut::ENTRY,
    bit_rock::WORK.name,
    excitation::WORK.name,
    top_drive::WORK.name,
];

/// Forces of a scenario at a few nodes.
pub(crate) fn nodal_forces(context: &ForceContext<'_>) -> Vec<Arc<dyn NodalForce>> {
    [end_load::force, unbalance::force, cut::force, bit_rock::force, excitation::force, top_drive::force]
        .into_iter()
        .filter_map(|force| force(context))
        .collect()
}
