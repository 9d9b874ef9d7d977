//! End of a step.

use crate::force::wall::ContactForces;
use crate::math::linalg::{Four, NodalField};

/// Motion and contact forces at the end of a step.
pub(crate) struct Moment<'a, const D: usize> {
    /// Time \[s\].
    pub(crate) time: f64,
    /// Angle of the top \[rad\].
    pub(crate) angle: f64,
    pub(crate) displacement: &'a NodalField<D>,
    pub(crate) velocity: &'a NodalField<D>,
    pub(crate) acceleration: &'a NodalField<D>,
    pub(crate) wall: &'a ContactForces,
    /// Largest normal forces of nodes within the step \[N\], four side by side; empty if they are those of its ends.
    pub(crate) peaks: &'a [Four],
}
