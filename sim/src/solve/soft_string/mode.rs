//! Motions of a string, with the loads on its bit.

use std::f64::consts::PI;

use drillsweep_scenario::Operation;
use serde::{Deserialize, Serialize};

use super::error::SoftStringError;
use crate::force::contact::BodyMotion;

/// Motion of a string and loads on its bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DragMode {
    /// Pulled up without rotation, off bottom.
    PickUp,
    /// Lowered without rotation, off bottom.
    SlackOff,
    /// Rotating off bottom.
    Rotate,
    /// Rotating on bottom, with weight and torque on bit.
    Drill,
    /// Lowered on bottom without rotation, with weight and torque on bit: a motor drills.
    Slide,
    /// Rotating off bottom with an axial speed, up or down.
    Ream,
}

/// Settings of all cases.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DragSettings {
    /// Weight of top drive and travelling block, part of the hook load \[N\].
    pub travelling_weight: f64,
    /// Axial speed of the mode `ream` \[m/s\], downhole positive.
    pub axial_speed: Option<f64>,
}

impl DragMode {
    /// All modes.
    pub const ALL: [Self; 6] =
        [Self::PickUp, Self::SlackOff, Self::Rotate, Self::Drill, Self::Slide, Self::Ream];

    /// The mode of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }

    /// Name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::PickUp => "pick_up",
            Self::SlackOff => "slack_off",
            Self::Rotate => "rotate",
            Self::Drill => "drill",
            Self::Slide => "slide",
            Self::Ream => "ream",
        }
    }

    /// Velocity of the string as a body, its rotation without its sense.
    pub(crate) fn motion(
        self,
        operation: &Operation,
        settings: &DragSettings,
    ) -> Result<BodyMotion, SoftStringError> {
        // Of a motion along one direction only the sense counts.
        let [axial_speed, rotation_speed] = match self {
            Self::PickUp => [-1.0, 0.0],
            Self::SlackOff | Self::Slide => [1.0, 0.0],
            Self::Rotate | Self::Drill => [0.0, 1.0],
            Self::Ream => {
                let speed = settings.axial_speed.filter(|speed| speed.is_finite());
                let rotation_speed = operation.rotation_speed_rpm.abs() * PI / 30.0;
                [speed.ok_or(SoftStringError::NoAxialSpeed)?, rotation_speed]
            }
        };
        Ok(BodyMotion { rotation_speed, axial_speed })
    }

    /// Tension \[N\] and torque \[N m\] at the bit.
    pub(crate) fn bit_loads(self, operation: &Operation) -> [f64; 2] {
        match self {
            Self::Drill | Self::Slide => [operation.weight_on_bit, operation.torque_on_bit.abs()],
            Self::PickUp | Self::SlackOff | Self::Rotate | Self::Ream => [0.0; 2],
        }
    }
}
