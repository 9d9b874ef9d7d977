//! Top drive: how the top of the string turns.

use serde::{Deserialize, Serialize};

/// Inertia of a top drive \[kg m2\], that of a published simulator (docs/model/drive.md).
const INERTIA: f64 = 2900.0;

/// Damping of a soft speed control in impedances of the top pipe.
const GAIN: f64 = 4.0;

/// Impedance factor of Z-torque control.
const FACTOR: f64 = 1.0;

/// Time constant of the torque filter of Z-torque control \[s\], 20 / (2 pi).
const TIME_CONSTANT: f64 = 3.183_098_861_837_907;

/// Top drive (docs/model/drive.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TopDrive {
    /// Control of the speed at the top: `imposed_speed` holds it exactly, `speed_control` yields to the torque of the string as a drive with inertia and a proportional-integral
    /// control does, `z_torque` is a stiff speed control whose set-point follows the measured torque; absent means `imposed_speed`. In steady rotation all are the same.
    #[serde(default)]
    pub kind: TopDriveKind,
    /// Tuning of `speed_control`: `stiff`, as delivered, or `soft`, which absorbs torsional waves near `frequency_hz` (soft torque); absent means `stiff`.
    #[serde(default)]
    pub tuning: Tuning,
    /// Damping of the soft tuning in torsional impedances of the top pipe, its impedance factor, above 0 and at most 100; 4 unless given. At 1 waves of
    /// `frequency_hz` are absorbed in whole; above it the range of absorbed frequencies is wider.
    #[serde(default = "gain")]
    pub gain: f64,
    /// Frequency to which the soft tuning is set \[Hz\], above 0 and at most 10; absent means the lowest torsional frequency of the string held at its top.
    #[serde(default)]
    pub frequency_hz: Option<f64>,
    /// Moment of inertia of the drive as the string feels it, gear and motor included \[kg m2\], 0 to 1e5; 2900 unless given. It keeps the top turning evenly: at high
    /// frequencies the string is as good as held.
    #[serde(default = "inertia")]
    pub inertia: f64,
    /// Part of the inertia that the control compensates by feeding the acceleration back, 0 to 1; 0 unless given. With 0.9 a soft drive absorbs ten times the
    /// range of frequencies.
    #[serde(default)]
    pub inertia_compensation: f64,
    /// Impedance factor of `z_torque`, 0 to 10; 1 unless given, with which the top absorbs torsional waves of all frequencies well above that of `time_constant`. With 0 the control is stiff.
    #[serde(default = "factor")]
    pub factor: f64,
    /// Time constant of the filter that takes the lasting torque from the measured one, with `z_torque` \[s\], 0.01 to 1000; 3.183 unless given (20/(2 pi)). Waves of a period
    /// well below 2 pi times it are absorbed.
    #[serde(default = "time_constant")]
    pub time_constant: f64,
}

impl Default for TopDrive {
    fn default() -> Self {
        Self {
            kind: TopDriveKind::default(),
            tuning: Tuning::default(),
            gain: GAIN,
            frequency_hz: None,
            inertia: INERTIA,
            inertia_compensation: 0.0,
            factor: FACTOR,
            time_constant: TIME_CONSTANT,
        }
    }
}

/// Control of the speed at the top: `imposed_speed`, `speed_control` or `z_torque`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TopDriveKind {
    /// The top turns at the nominal speed exactly.
    #[default]
    ImposedSpeed,
    /// A motor with inertia follows the nominal speed by proportional-integral control.
    SpeedControl,
    /// The set-point of a stiff speed control follows the torque measured at the top, so that the drive has the impedance of the pipe (Dwars 2015).
    ZTorque,
}

/// Tuning of a speed control: `stiff` or `soft`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tuning {
    /// The top hardly yields: 50 impedances of the top pipe, and the integral 5 1/s2 times the inertia.
    #[default]
    Stiff,
    /// `gain` impedances, and an integral with which the drive resonates at `frequency_hz`.
    Soft,
}

fn gain() -> f64 {
    GAIN
}

fn factor() -> f64 {
    FACTOR
}

fn time_constant() -> f64 {
    TIME_CONSTANT
}

fn inertia() -> f64 {
    INERTIA
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::preset;

    #[test]
    fn absent_fields_are_the_defaults() {
        let read: TopDrive = serde_json::from_value(json!({})).unwrap();
        assert_eq!(read, TopDrive::default());
        assert_eq!(preset("paper-200m").unwrap().top_drive, TopDrive::default());
    }
}
