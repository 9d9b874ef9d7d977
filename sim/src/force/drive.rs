//! Rotation imposed at the top of the string.

use std::f64::consts::{PI, TAU};

use drillsweep_scenario::Operation;

/// The drive: it turns the frame of the equations of motion at its nominal speed, and the top of the string with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    nominal_speed: f64,
}

impl Drive {
    /// The drive of an operation.
    pub fn new(operation: &Operation) -> Self {
        Self { nominal_speed: operation.rotation_speed_rpm * PI / 30.0 }
    }

    /// Speed of the turning frame \[rad/s\], clockwise positive.
    pub fn nominal_speed(&self) -> f64 {
        self.nominal_speed
    }

    /// Speed of the top \[rad/s\] at `time` \[s\].
    pub fn speed(&self, _time: f64) -> f64 {
        self.nominal_speed
    }

    /// Angle of the top \[rad\] at `time` \[s\] from that at the start, less whole turns, so that late times lose no digits.
    pub fn angle(&self, time: f64) -> f64 {
        (self.nominal_speed * time).rem_euclid(TAU)
    }
}
