//! Nodes that a run records.

use crate::solve::model::Model;

/// The nodes whose histories a scenario requests, from 0.
pub fn recorded_nodes(model: &Model) -> Vec<usize> {
    model.scenario.recording.nodes.iter().filter_map(|&choice| model.mesh.chosen_node(choice)).collect()
}

/// The bit, from 0 at the top, if its rotation and torque are recorded in addition to the histories: if torsion is solved for, any node is
/// recorded, and the bit is none of them.
pub fn additional_bit(model: &Model) -> Option<usize> {
    let nodes = recorded_nodes(model);
    let bit = model.node_count().checked_sub(1)?;
    (model.effects.torsion && !nodes.is_empty() && !nodes.contains(&bit)).then_some(bit)
}
