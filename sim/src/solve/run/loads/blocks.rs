//! Sums of loads over blocks of time.

use std::collections::VecDeque;
use std::ops::Range;

use drillsweep_scenario::TimeWindow;
use serde::{Deserialize, Serialize};

use super::elements::ElementSums;
use super::fatigue::{FatigueSite, SiteCycles};
use super::nodes::NodeSums;
use crate::math::linalg::{Four, Lane};

/// Number of blocks kept: those of the longest settled window, and one that has begun at either end.
pub(super) const MOST_BLOCKS: usize = 10;

/// Bytes of a node and an element in all blocks of a settled window.
pub const LOAD_BYTES: u64 =
    (MOST_BLOCKS * (size_of::<NodeSums>() + size_of::<ElementSums>()) / Four::LANES) as u64;

/// Part of a block by which it may reach beyond the window: rounding of times.
const ROUNDING: f64 = 1e-6;

/// Steps that are observed, and the blocks that they belong to.
#[derive(Debug, Clone)]
pub(super) struct LoadWindow {
    /// Ticks of a block.
    block: u64,
    /// Ticks of a fixed window.
    fixed: Option<Range<u64>>,
}

/// The last blocks of a run, the earliest first.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LoadBlocks {
    blocks: VecDeque<(u64, LoadBlock)>,
}

/// Sums over a block of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LoadBlock {
    /// Start of its first step \[s\].
    pub(super) start: f64,
    /// End of its last step \[s\].
    pub(super) end: f64,
    /// Sums of nodes, four side by side.
    pub(super) nodes: Vec<NodeSums>,
    /// Sums of elements, four side by side.
    pub(super) elements: Vec<ElementSums>,
    /// Stress cycles of elements with a grade.
    pub(super) cycles: Vec<SiteCycles>,
}

impl LoadWindow {
    pub(super) fn new(block: u64, fixed: Option<Range<u64>>) -> Self {
        Self { block: block.max(1), fixed }
    }

    /// True if a step that begins at a tick may be observed.
    pub(super) fn holds(&self, tick: u64) -> bool {
        self.fixed.as_ref().is_none_or(|window| window.contains(&tick))
    }

    /// Number of the block that a step belongs to; absent outside a fixed window.
    pub(super) fn block_of(&self, [start, end]: [u64; 2]) -> Option<u64> {
        match &self.fixed {
            None => Some(start / self.block),
            Some(window) => (start >= window.start && end <= window.end).then_some(0),
        }
    }
}

impl LoadBlocks {
    /// The block of a number, which is that of the last block or higher. The last block ends with the cycles of its `sites` if it is another one.
    pub(super) fn of_number(
        &mut self,
        number: u64,
        new: impl FnOnce() -> LoadBlock,
        sites: &[FatigueSite],
    ) -> &mut LoadBlock {
        if self.blocks.back().is_none_or(|(last, _)| *last != number) {
            if let Some((_, last)) = self.blocks.back_mut() {
                last.close(sites);
            }
            if self.blocks.len() == MOST_BLOCKS {
                self.blocks.pop_front();
            }
            self.blocks.push_back((number, new()));
        }
        let last = self.blocks.len() - 1;
        &mut self.blocks[last].1
    }

    /// Sum of the blocks within `window` \[s\], or of all those that overlap it if it is shorter than a block; absent if there are none.
    pub(super) fn merged(&self, window: TimeWindow, sites: &[FatigueSite]) -> Option<LoadBlock> {
        let TimeWindow { from, to } = window;
        let slack = ROUNDING * (to - from);
        let blocks = || self.blocks.iter().map(|(_, block)| block);
        let within = |block: &&LoadBlock| block.start >= from - slack && block.end <= to + slack;
        let overlaps = |block: &&LoadBlock| block.end > from && block.start < to;
        let sum = |sum: Option<LoadBlock>, block: &LoadBlock| {
            let mut block = block.clone();
            block.close(sites);
            Some(match sum {
                None => block,
                Some(mut sum) => {
                    sum.add(&block);
                    sum
                }
            })
        };
        let whole = blocks().filter(within).fold(None, sum);
        whole.or_else(|| blocks().filter(overlaps).fold(None, sum))
    }
}

impl LoadBlock {
    pub(super) fn new(start: f64, nodes: usize, elements: usize, sites: usize) -> Self {
        Self {
            start,
            end: start,
            nodes: vec![NodeSums::none(); nodes],
            elements: vec![ElementSums::none(); elements],
            cycles: vec![SiteCycles::default(); sites],
        }
    }

    /// Ends the cycles of its sites.
    fn close(&mut self, sites: &[FatigueSite]) {
        self.cycles.iter_mut().zip(sites).for_each(|(cycles, site)| site.close(cycles));
    }

    /// Adds the block that follows.
    fn add(&mut self, next: &Self) {
        self.end = next.end;
        self.nodes.iter_mut().zip(&next.nodes).for_each(|(sum, next)| sum.add(next));
        self.elements.iter_mut().zip(&next.elements).for_each(|(sum, next)| sum.add(next));
        self.cycles.iter_mut().zip(&next.cycles).for_each(|(sum, next)| sum.add(next));
    }
}
