//! State of a run from step to step.

use serde::{Deserialize, Serialize};

use super::energy::{Ledger, Work};
use super::error::ErrorSum;
use super::nodal;
use crate::force::PointState;
use crate::linalg::NodalField;

/// Motion at a step's end, with what the methods carry from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct State<const D: usize> {
    #[serde(with = "nodal")]
    pub(super) displacement: NodalField<D>,
    #[serde(with = "nodal")]
    pub(super) velocity: NodalField<D>,
    #[serde(with = "nodal")]
    pub(super) acceleration: NodalField<D>,
    /// Unknowns and memory of forces.
    pub(super) points: PointState,
    /// Powers at the step's end (the first stage of the next ESDIRK step).
    pub(super) stage_power: Work,
    /// Step of the adaptive method \[s\].
    pub(super) adaptive_step: f64,
}

/// Books that a step's work and error are entered in.
pub(super) struct Books<'a, const D: usize> {
    pub(super) ledger: &'a mut Ledger<D>,
    pub(super) errors: &'a mut ErrorSum,
}

impl<const D: usize> State<D> {
    /// Takes over another state of the same string.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self { displacement, velocity, acceleration, points, stage_power, adaptive_step } = self;
        displacement.copy_from(&other.displacement);
        velocity.copy_from(&other.velocity);
        acceleration.copy_from(&other.acceleration);
        points.copy_from(&other.points);
        *stage_power = other.stage_power;
        *adaptive_step = other.adaptive_step;
    }

    /// The state at the start of a run.
    pub(super) fn at_rest(displacement: &NodalField<D>, points: PointState, adaptive_step: f64) -> Self {
        let zero = NodalField::zeros(displacement.nodes());
        Self {
            displacement: displacement.clone(),
            velocity: zero.clone(),
            acceleration: zero,
            points,
            stage_power: Work::default(),
            adaptive_step,
        }
    }
}
