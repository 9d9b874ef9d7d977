//! Adaptive steps: the error allowed for a step, and the length of the next one.

use drillsweep_scenario::TimeStepping;

use crate::force::wall::IterationChange;

/// Errors that a step may leave, for a tolerance on the statistics of a run.
///
/// Between events, steps leave small and similar errors, of the period and damping of vibrations, and a limit cycle adds them up as long
/// as it remembers: some ten seconds if its growth is 0.1 1/s. A step may therefore leave a part of the tolerance: the ratio of the longest step of
/// that tolerance to the memory. This holds for lateral displacements and, since friction excites torsion, for the rotation of the surface. Shorter
/// steps are made for single events, impacts and slip-to-stick transitions, which do not recur in every step: they may leave as much.
///
/// A node that sticks and slips is more sensitive to a step than any displacement: friction is as steep as 1 / v_ref at rest. The error
/// of its coefficient, the error of the sliding speed times the slope of the curve, is therefore checked at all touching nodes. The changes of the
/// last contact iteration show whether the contacts converged. The shares of the tolerance are from comparisons with converged runs
/// over whole runs (`tests/whole_runs.rs`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tolerances {
    /// Local error of the displacements of a step, root mean square over the nodes, relative to the lateral motion.
    displacement: f64,
    /// Local error of a friction coefficient.
    friction: f64,
    /// Change in the last contact iteration: of a lateral displacement relative to the motion, and of a friction coefficient.
    iteration_change: IterationChange,
    /// Smallest motion for relative errors \[m\].
    smallest_motion: f64,
}

/// Errors that a step leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepError {
    /// Local error of the lateral displacements and of the surface's displacement by the twist, root mean square over the nodes \[m\].
    pub(crate) displacement: f64,
    /// Largest local error of a friction coefficient.
    pub(crate) friction: f64,
    /// Changes by the last contact iterations.
    pub(crate) iteration_change: IterationChange,
}

/// Smallest motion, relative to the hole's radius; smaller motion counts as this much. It is 10 um in a hole of 0.2 m, so that a string that hardly
/// moves does not need steps that resolve nothing.
pub const SMALLEST_MOTION: f64 = 1e-4;

/// Smallest motion \[m\] that the steps of a run must resolve, root mean square over its nodes, in a hole of radius `hole_radius` \[m\].
pub(crate) fn smallest_motion(hole_radius: f64) -> f64 {
    SMALLEST_MOTION * hole_radius
}

/// The embedded method is of order 3: a local error falls with the fourth power of the step.
const LOCAL_ORDER: f64 = 4.0;

/// Error, relative to the allowed one, below which a step of twice the length is tried: it would leave two thirds.
const ROOM_TO_DOUBLE: f64 = 0.04;

/// Time over which errors of steps are taken to add up \[s\]. In stick-slip of four wells, steps of 8 ms that leave 6e-3 of the motion a second make
/// orbits 2 to 8 % wrong, and those of 4 ms that leave 1.2e-3 a second 0.2 to 1 %. That corresponds to 8 to 13 s for the mean of a run's steps, and
/// to less here, since every single step has to meet the bound.
const MEMORY: f64 = 5.0;

impl Tolerances {
    /// Tolerances for a relative tolerance on statistics, in a hole of radius `hole_radius` \[m\].
    pub(crate) fn new(statistics: f64, hole_radius: f64) -> Self {
        Self {
            displacement: statistics * TimeStepping::adaptive(statistics).step / MEMORY,
            friction: 0.3 * statistics,
            iteration_change: IterationChange { lateral: 0.06 * statistics, friction: 3.0 * statistics },
            smallest_motion: smallest_motion(hole_radius),
        }
    }

    /// The error of a step relative to the allowed one, for a motion of `motion` \[m\]: up to 1 it is within the tolerance.
    pub(crate) fn relative(&self, error: &StepError, motion: f64) -> f64 {
        let motion = motion.max(self.smallest_motion);
        let parts = [
            error.displacement / (self.displacement * motion),
            error.friction / self.friction,
            error.iteration_change.lateral / (self.iteration_change.lateral * motion),
            error.iteration_change.friction / self.iteration_change.friction,
        ];
        // A value that is not a number exceeds every tolerance: it is handed on, not compared.
        parts.into_iter().fold(0.0, |most, part| if part <= most || most.is_nan() { most } else { part })
    }
}

/// The level of the step after one of `level` that left `error`, relative to the allowed one.
pub(crate) fn next_level(level: u32, error: f64) -> u32 {
    if error < ROOM_TO_DOUBLE {
        level + 1
    } else if error <= 1.0 {
        level
    } else {
        let halvings = (error.log2() / LOCAL_ORDER).ceil();
        // An error that is not finite does not show how much shorter the step must be.
        level.saturating_sub(if halvings.is_finite() { halvings as u32 } else { 1 })
    }
}

/// Shares of its bound that the ledger's residual may reach: below the first, steps may lengthen; above the second, they are shortened. The two are
/// further apart than the effect of one halving by the order of the method.
const RESIDUAL_SHARES: [f64; 2] = [0.01, 0.25];

/// Largest growth of the residual from one row of the ledger to the next, as part of its distance from the bound. A residual that grows no faster
/// approaches the bound and does not reach it.
const RESIDUAL_GROWTH: f64 = 0.01;

/// The highest level that steps may have until the ledger's next row, after one of `ceiling`. The residual, without its sign, was `before` at the
/// last row and is `now` at this one; its bound is `bound` \[J\].
///
/// The local error does not show contacts that chatter: each step is accurate for the motion as a whole, and takes energy from vibrations that
/// it does not resolve, always of the same sign. The ledger adds up this energy.
pub(crate) fn ceiling(ceiling: u32, [before, now]: [f64; 2], bound: f64) -> u32 {
    let [low, high] = RESIDUAL_SHARES;
    if now > high * bound && now - before > RESIDUAL_GROWTH * (bound - now) {
        ceiling.saturating_sub(1)
    } else if now < low * bound {
        ceiling + 1
    } else {
        ceiling
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_shorten_while_the_ledger_opens_and_lengthen_when_it_is_closed() {
        assert_eq!(ceiling(5, [0.2, 0.3], 1.0), 4);
        assert_eq!(ceiling(5, [0.3, 0.3], 1.0), 5);
        assert_eq!(ceiling(5, [0.299, 0.3], 1.0), 5);
        assert_eq!(ceiling(5, [0.989, 0.99], 1.0), 4);
        assert_eq!(ceiling(5, [0.1, 0.2], 1.0), 5);
        assert_eq!(ceiling(5, [0.1, 0.009], 1.0), 6);
        assert_eq!(ceiling(0, [0.2, 0.3], 1.0), 0);
    }

    #[test]
    fn a_step_is_halved_as_often_as_its_order_says() {
        assert_eq!(next_level(5, 1.0), 5);
        assert_eq!(next_level(5, 0.03), 6);
        assert_eq!(next_level(5, 1.1), 4);
        assert_eq!(next_level(5, 15.9), 4);
        assert_eq!(next_level(5, 17.0), 3);
        assert_eq!(next_level(1, 1e9), 0);
        assert_eq!(next_level(5, f64::INFINITY), 4);
        assert_eq!(next_level(5, f64::NAN), 4);
    }

    #[test]
    fn the_worst_part_counts_and_a_part_that_is_not_a_number_is_the_worst() {
        let tolerances = Tolerances { displacement: 1.2e-4, ..Tolerances::new(0.02, 0.1) };
        let quiet =
            StepError { displacement: 0.0, friction: 0.0, iteration_change: IterationChange::default() };
        assert_eq!(tolerances.relative(&quiet, 1e-3), 0.0);
        let friction = StepError { friction: 0.02, ..quiet };
        assert!((tolerances.relative(&friction, 1e-3) - 10.0 / 3.0).abs() < 1e-12);
        let displacement = StepError { displacement: 6e-7, ..friction };
        assert!((tolerances.relative(&displacement, 1e-3) - 5.0).abs() < 1e-12);
        // In a hole of 0.1 m, rest counts as 10 um of motion.
        assert!((tolerances.relative(&displacement, 0.0) - 500.0).abs() < 1e-9);
        let lost = StepError {
            iteration_change: IterationChange { lateral: f64::NAN, friction: 0.0 },
            ..displacement
        };
        assert!(tolerances.relative(&lost, 1e-3).is_nan());
    }
}
