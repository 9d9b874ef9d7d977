//! Loads on the string: accelerations, whirl, rotation, action of the wall, bending and stress of every node and element, over the window of a run's
//! statistics.
//!
//! They are accumulated at the ends of accepted steps, so that extremes do not depend on the recording rate. Means over time follow the trapezoidal
//! rule. A window that is settled is not known before its end, so sums are kept by blocks of ten seconds, and the blocks within the window are
//! merged.

mod blocks;
mod elements;
mod fatigue;
mod moment;
mod nodes;
mod statistics;
#[cfg(test)]
mod tests;

use std::ops::Range;

use drillsweep_scenario::TimeWindow;

pub(super) use blocks::LoadBlocks;
use blocks::{LoadBlock, LoadWindow};
use elements::{Elements, element_loads};
pub(super) use moment::Moment;
use nodes::{Nodes, node_loads};

pub use blocks::LOAD_BYTES;
pub use elements::ElementLoads;
pub use fatigue::CYCLE_BYTES;
pub use nodes::{NodeLoads, SHOCKS_G};
pub use statistics::{Peak, RmsAndPeak, Span};

use crate::math::dof::Dofs;
use crate::solve::model::{Model, NodalVector};
use crate::solve::statics::Equilibrium;

/// Loads over the window of a run's statistics.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadRecords {
    /// Window \[s\]: of a settled one the whole blocks of ten seconds within its last 80 s.
    pub window: TimeWindow,
    /// Loads of every node, from the top; empty if no step ended in the window.
    pub nodes: Vec<NodeLoads>,
    /// Loads of every element, from the top; empty if no step ended in the window.
    pub elements: Vec<ElementLoads>,
}

/// Observer of the loads of a run that solves for D degrees of freedom a node.
pub(super) struct Loads<const D: usize> {
    window: LoadWindow,
    nodes: Nodes<D>,
    elements: Elements<D>,
}

impl<const D: usize> Loads<D> {
    /// Observer of `model`. A settled window is observed in blocks of `block` ticks; a fixed one, `fixed`, in ticks, in one block.
    pub(super) fn new(
        model: &Model,
        equilibrium: &Equilibrium,
        freedoms: Dofs<D>,
        rest: &NodalVector,
        (block, fixed): (u64, Option<Range<u64>>),
    ) -> Self {
        Self {
            window: LoadWindow::new(block, fixed),
            nodes: Nodes::new(model, freedoms),
            elements: Elements::new(model, equilibrium, freedoms, rest),
        }
    }

    /// Ends observation: the run from here on is compared with another one.
    pub(super) fn close(&mut self) {
        self.window = LoadWindow::new(1, Some(0..0));
    }

    /// Takes the present moment as the start of the next step.
    pub(super) fn start(&mut self, moment: &Moment<'_, D>) {
        self.nodes.start(moment);
        self.elements.start(moment);
    }

    /// Takes in the moment at the end of a step of `h` \[s\] from `ticks[0]` to `ticks[1]`.
    pub(super) fn observe(
        &mut self,
        moment: &Moment<'_, D>,
        h: f64,
        ticks: [u64; 2],
        blocks: &mut LoadBlocks,
    ) {
        let Some(number) = self.window.block_of(ticks) else {
            if self.window.holds(ticks[1]) {
                self.start(moment);
            }
            return;
        };
        let sites = self.elements.sites();
        let new_block =
            || LoadBlock::new(moment.time - h, self.nodes.groups(), self.elements.groups(), sites.len());
        let block = blocks.of_number(number, new_block, sites);
        block.end = moment.time;
        self.nodes.observe(moment, h, &mut block.nodes);
        self.elements.observe(moment, h, &mut block.elements, &mut block.cycles);
    }

    /// Loads over the blocks within `window` \[s\].
    pub(super) fn records(&self, blocks: &LoadBlocks, window: TimeWindow) -> LoadRecords {
        let Some(whole) = blocks.merged(window, self.elements.sites()) else {
            return LoadRecords { window, nodes: Vec::new(), elements: Vec::new() };
        };
        let duration = whole.end - whole.start;
        LoadRecords {
            window: TimeWindow { from: whole.start, to: whole.end },
            nodes: (0..self.nodes.count())
                .map(|node| node_loads(&whole.nodes, node, duration, self.nodes.has_rotation()))
                .collect(),
            elements: (0..self.elements.count())
                .map(|element| {
                    let loads = element_loads(
                        &whole.elements,
                        element,
                        duration,
                        self.elements.outer_stress(element),
                    );
                    ElementLoads {
                        fatigue_rate: self.elements.damage(element, &whole.cycles, duration),
                        ..loads
                    }
                })
                .collect(),
        }
    }
}
