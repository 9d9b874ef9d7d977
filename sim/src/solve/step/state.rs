//! State of a run from step to step.

use serde::{Deserialize, Serialize};

use super::nodal;
use super::work::Work;
use crate::force::points::PointState;
use crate::math::linalg::NodalField;

/// Motion at a step's end, with the values that the methods carry from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct State<const D: usize> {
    #[serde(with = "nodal")]
    pub(crate) displacement: NodalField<D>,
    #[serde(with = "nodal")]
    pub(crate) velocity: NodalField<D>,
    #[serde(with = "nodal")]
    pub(crate) acceleration: NodalField<D>,
    /// Unknowns and memory of forces.
    pub(crate) points: PointState,
    /// Powers at the step's end (the first stage of the next ESDIRK step).
    pub(crate) stage_power: Work,
    /// Step of the adaptive method \[s\].
    pub(crate) adaptive_step: f64,
}

impl<const D: usize> State<D> {
    /// Takes over another state of the same string.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let Self { displacement, velocity, acceleration, points, stage_power, adaptive_step } = self;
        displacement.copy_from(&other.displacement);
        velocity.copy_from(&other.velocity);
        acceleration.copy_from(&other.acceleration);
        points.copy_from(&other.points);
        *stage_power = other.stage_power;
        *adaptive_step = other.adaptive_step;
    }

    /// The state at the start of a run.
    pub(crate) fn at_rest(displacement: &NodalField<D>, points: PointState, adaptive_step: f64) -> Self {
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
