//! Powers and works of forces and matrices on the motion.

use serde::{Deserialize, Serialize};

use crate::force::effect::DAMPING;
use crate::force::list::ENTRIES;

/// Powers \[W\], or work \[J\] once multiplied by time, of all forces and matrices that do work on the string's motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Work {
    /// Powers of forces, in the order of [`ENTRIES`].
    pub(super) forces: [f64; ENTRIES.len()],
    /// Powers of the matrices that multiply velocities, in the sense of their accounts' sides, in the order of [`DAMPING`].
    pub(super) damping: [f64; WORKING],
    pub(super) follower: f64,
}

/// Number of accounts of damping: those of [`DAMPING`] that do work.
pub(super) const WORKING: usize = {
    let (mut count, mut place) = (0, 0);
    while place < DAMPING.len() {
        count += DAMPING[place].is_some() as usize;
        place += 1;
    }
    count
};
