//! Interaction of bit and rock.

use serde::{Deserialize, Serialize};

use crate::Scenario;

/// Torque over bit speed at break-away relative to that of fast rotation, with the law `velocity_weakening`.
const STATIC_RATIO: f64 = 2.0;

/// Speed over which torque on bit falls \[rad/s\], of a published simulator (docs/model/drive.md).
const WEAKENING_SPEED: f64 = 7.0;

/// Speed of the bit up to which torque on bit rises \[rad/s\].
const REGULARISATION_SPEED: f64 = 0.1;

/// Interaction of bit and rock (docs/model/drive.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Bit {
    /// Torque on bit over the speed of the bit: `constant`, or `velocity_weakening`, which falls as the bit turns faster and so excites torsion; absent means
    /// `constant`. `operation.torque_on_bit` is the torque at the nominal speed of rotation in both.
    #[serde(default)]
    pub law: BitLaw,
    /// Torque on bit over a third of the bit's diameter, by weight on bit: mu_b of T = mu_b |W| D / 3, the friction coefficient of a disc with the torque of the bit, 0 to 10, in place of
    /// `operation.torque_on_bit`; absent means that torque. Usual 0.1 to 0.4 of roller-cone bits, 0.5 to 1.2 of fixed cutters. With it a sweep over weight on bit changes the torque.
    #[serde(default)]
    pub aggressiveness: Option<f64>,
    /// Torque of a bit about to turn over that of a fast one rho_s, 1 to 10; 2 unless given. At 1 torque is constant as long as the bit turns. The
    /// more it exceeds 1, the more the bit excites torsion.
    #[serde(default = "static_ratio")]
    pub static_ratio: f64,
    /// Speed omega_w over which the excess of torque on bit falls by a factor e \[rad/s\], above 0 and at most 1000; 7 unless given (67 rpm). Between
    /// 3 and 20 in published fits; a measured record decides. Torsion is unstable up to a few times this speed, beyond it torque hardly falls.
    #[serde(default = "weakening_speed")]
    pub weakening_speed: f64,
    /// Speed up to which torque on bit rises from zero at a standing bit \[rad/s\], above 0 and at most 10; 0.1 unless given (1 rpm). It replaces the jump of dry friction at zero speed: a
    /// stuck bit creeps at less than this speed. Smaller values need shorter steps.
    #[serde(default = "regularisation_speed")]
    pub regularisation_speed: f64,
}

impl Default for Bit {
    fn default() -> Self {
        Self {
            law: BitLaw::default(),
            aggressiveness: None,
            static_ratio: STATIC_RATIO,
            weakening_speed: WEAKENING_SPEED,
            regularisation_speed: REGULARISATION_SPEED,
        }
    }
}

impl Scenario {
    /// Torque on bit at the nominal speed \[N m\]: that of the operation, or of its weight on bit if the bit has an aggressiveness; it opposes the rotation, a clockwise one if nothing
    /// turns. A pull makes no torque.
    pub fn torque_on_bit(&self) -> f64 {
        let operation = &self.operation;
        let Some(aggressiveness) = self.bit.aggressiveness else { return operation.torque_on_bit };
        let diameter = self.hole_at(self.string.depth_of_bit()).diameter;
        let torque = aggressiveness.max(0.0) * (-operation.weight_on_bit).max(0.0) * diameter / 3.0;
        if operation.rotation_speed_rpm < 0.0 { torque } else { -torque }
    }
}

/// Torque on bit over the speed of the bit: `constant` or `velocity_weakening`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BitLaw {
    /// Torque on bit does not depend on the motion.
    #[default]
    Constant,
    /// Torque on bit falls exponentially with the speed of the bit, and changes its sign with it.
    VelocityWeakening,
}

fn static_ratio() -> f64 {
    STATIC_RATIO
}

fn weakening_speed() -> f64 {
    WEAKENING_SPEED
}

fn regularisation_speed() -> f64 {
    REGULARISATION_SPEED
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::preset;

    #[test]
    fn absent_fields_are_the_defaults() {
        let read: Bit = serde_json::from_value(json!({})).unwrap();
        assert_eq!(read, Bit::default());
        assert_eq!(preset("paper-200m").unwrap().bit, Bit::default());
    }

    #[test]
    fn torque_of_an_aggressive_bit_follows_its_weight_and_diameter() {
        let mut scenario = preset("paper-200m").unwrap();
        let of_operation = scenario.operation.torque_on_bit;
        assert_eq!(scenario.torque_on_bit(), of_operation);
        (scenario.bit.aggressiveness, scenario.operation.weight_on_bit) = (Some(0.6), -1e5);
        scenario.well.hole_diameter = 0.2;
        // 0.6 x 100 kN x 0.2 m / 3.
        assert!((scenario.torque_on_bit() + 4000.0).abs() < 1e-9);
        let resolved = scenario.in_hole();
        assert_eq!(
            (resolved.operation.torque_on_bit, resolved.bit.aggressiveness),
            (scenario.torque_on_bit(), None)
        );
        scenario.operation.rotation_speed_rpm = -60.0;
        assert!((scenario.torque_on_bit() - 4000.0).abs() < 1e-9);
        scenario.operation.weight_on_bit = 1e5;
        assert_eq!(scenario.torque_on_bit(), 0.0);
    }
}
