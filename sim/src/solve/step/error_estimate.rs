//! Estimate of the error of time integration from the local errors of its steps.

use drillsweep_scenario::Integrator;
use serde::{Deserialize, Serialize};

use crate::math::dof::LATERAL;
use crate::math::linalg::{Four, Lane, NodalField};

/// Estimated error of the run's lateral displacements.
///
/// Each step's local error is estimated by the embedded method of order 3 (ESDIRK4, RK4), step doubling (adaptive RK4) or the
/// Taylor series (generalized-alpha). Contact makes the steps' errors look independent, so their squares add up; the
/// part of that sum that remains in the motion is calibrated once a method against converged runs. It
/// is an estimate for the *history*. Once impacts have made histories part from each other, no step makes a history true, and
/// only statistics have a meaning: ensembles show from which time on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ErrorEstimate {
    /// Root mean square over all nodes of the error of a lateral displacement at the end of the run \[m\].
    pub displacement: f64,
    /// The same relative to the root mean square motion away from the start, over all nodes and the whole run.
    pub relative: f64,
}

/// Local errors and motion of a run so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ErrorSum {
    /// Sum over steps of the local errors' squares, over the lateral degrees of freedom of all nodes \[m2\].
    local: f64,
    /// Sum over the ledger's rows of the squares of the lateral motion away from the start \[m2\].
    motion: f64,
    rows: u64,
}

/// Factor on the root of the summed squares of local errors.
///
/// Over the calibration scenarios (`tests/error_estimate.rs`) the true error is 0.6 to 6 times that root for
/// generalized-alpha, 15 to 150 times for ESDIRK4 (whose embedded method hardly sees a contact's kink) and 4 to 60
/// times for RK4; each factor is near the upper end, so that the estimate covers the error.
fn calibration(integrator: Integrator) -> f64 {
    match integrator {
        Integrator::GeneralizedAlpha => 8.0,
        Integrator::Esdirk4 => 130.0,
        Integrator::Rk4 => 60.0,
    }
}

impl ErrorSum {
    /// Adds a step: the sum of the squares of its lateral displacements' local errors \[m2\].
    pub(crate) fn add(&mut self, squares: f64) {
        self.local += squares;
    }

    /// Adds a step whose displacement errors of a group of nodes are `error(group, dof)` \[m\].
    #[inline(always)]
    pub(crate) fn add_groups(&mut self, groups: usize, error: impl Fn(usize, usize) -> Four) {
        let mut sums = [Four::splat(0.0); LATERAL];
        for group in 0..groups {
            for (dof, sum) in sums.iter_mut().enumerate() {
                let error = error(group, dof);
                *sum = error.mul_add(error, *sum);
            }
        }
        self.local += sums[0].sum() + sums[1].sum();
    }

    /// Takes in the motion at a row of the ledger.
    pub(crate) fn observe_motion<const D: usize>(
        &mut self,
        displacement: &NodalField<D>,
        start: &NodalField<D>,
    ) {
        let mut sums = [Four::splat(0.0); LATERAL];
        for (x, x0) in displacement.groups().iter().zip(start.groups()) {
            for (dof, sum) in sums.iter_mut().enumerate() {
                let moved = x[dof] - x0[dof];
                *sum = moved.mul_add(moved, *sum);
            }
        }
        self.motion += sums[0].sum() + sums[1].sum();
        self.rows += 1;
    }

    /// Root mean square lateral motion away from the start so far \[m\].
    pub(crate) fn motion(&self, nodes: usize) -> f64 {
        (self.motion / (2.0 * nodes as f64 * self.rows.max(1) as f64)).sqrt()
    }

    /// The estimate for a string of `nodes` nodes.
    pub(crate) fn estimate(&self, integrator: Integrator, nodes: usize) -> ErrorEstimate {
        let values = 2.0 * nodes as f64;
        let displacement = calibration(integrator) * (self.local / values).sqrt();
        let motion = (self.motion / (values * self.rows.max(1) as f64)).sqrt();
        ErrorEstimate { displacement, relative: if motion > 0.0 { displacement / motion } else { 0.0 } }
    }
}
