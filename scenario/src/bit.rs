//! Interaction of bit and rock.

use serde::{Deserialize, Serialize};

use crate::Scenario;

/// Torque over bit speed at break-away relative to that of fast rotation, with the law `velocity_weakening`.
const STATIC_RATIO: f64 = 2.0;

/// Speed over which torque on bit falls \[rad/s\], of a published simulator (docs/model/drive.md).
const WEAKENING_SPEED: f64 = 7.0;

/// Speed of the bit up to which torque on bit rises \[rad/s\].
const REGULARISATION_SPEED: f64 = 0.1;

/// Intrinsic specific energy of the rock \[Pa\] with the law `regenerative`, of a published simulator (docs/model/stability-map.md).
const SPECIFIC_ENERGY: f64 = 1e8;

/// Inclination zeta of the cutting force, of the same simulator.
const INCLINATION: f64 = 0.8;

/// Contact stress under worn cutters \[Pa\], of the same simulator.
const CONTACT_STRESS: f64 = 6e7;

/// Length of the wear flats of all blades \[m\], of the same simulator.
const WEAR_LENGTH: f64 = 5e-3;

/// Product of friction coefficient and geometry of the wear flats, of the same simulator.
const FRICTION_GEOMETRY: f64 = 0.9;

/// Blades of a usual fixed-cutter bit.
const BLADES: u32 = 5;

/// Interaction of bit and rock (docs/model/drive.md, docs/model/stability-map.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Bit {
    /// Torque on bit over the speed of the bit: `constant`, or `velocity_weakening`, which falls as the bit turns faster and so excites torsion; absent means
    /// `constant`. `operation.torque_on_bit` is the torque at the nominal speed of rotation in both. `regenerative` is a bit that cuts what the blade before left: weight and torque follow
    /// the depth of cut, and torque on bit follows from the weight. It is for stability maps only (docs/model/stability-map.md); a run in time refuses it.
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
    /// Radius a of the bit \[m\], with the law `regenerative`, above 0 and at most 2.5; absent means half of the hole's diameter at the bit.
    #[serde(default)]
    pub bit_radius: Option<f64>,
    /// Intrinsic specific energy eps of the rock \[Pa\], with the law `regenerative`: 1e5 to 1e10, 1e8 unless given, usual 1e7 (soft) to 4e8 (hard). The harder the rock, the faster vibration of
    /// the bit grows.
    #[serde(default = "specific_energy")]
    pub specific_energy: f64,
    /// Inclination zeta of the cutting force, with the law `regenerative`: its part along the axis over that along the cut, 0.01 to 10; 0.8 unless given, usual 0.5 to 1.
    #[serde(default = "inclination")]
    pub inclination: f64,
    /// Contact stress sigma under the wear flats \[Pa\], with the law `regenerative`: 0 to 1e10; 6e7 unless given, about the strength of the rock.
    #[serde(default = "contact_stress")]
    pub contact_stress: f64,
    /// Length l of the wear flats of all blades \[m\], with the law `regenerative`: 0 (a new bit) to 0.5; 5e-3 unless given, some millimetres a blade of a worn bit. The bit
    /// drills once its weight exceeds a l sigma.
    #[serde(default = "wear_length")]
    pub wear_length: f64,
    /// Friction coefficient of the wear flats times a number of the bit's geometry, mu gamma, with the law `regenerative`: 0 to 10; 0.9 unless given, usual 0.5 to 1.3.
    #[serde(default = "friction_geometry")]
    pub friction_geometry: f64,
    /// Blades n at equal angles, with the law `regenerative`: 1 to 20, 5 unless given, usual 3 to 9. More blades meet their traces sooner: the bit is stable down to lower speeds.
    #[serde(default = "blades")]
    pub blades: u32,
}

impl Default for Bit {
    fn default() -> Self {
        Self {
            law: BitLaw::default(),
            aggressiveness: None,
            static_ratio: STATIC_RATIO,
            weakening_speed: WEAKENING_SPEED,
            regularisation_speed: REGULARISATION_SPEED,
            bit_radius: None,
            specific_energy: SPECIFIC_ENERGY,
            inclination: INCLINATION,
            contact_stress: CONTACT_STRESS,
            wear_length: WEAR_LENGTH,
            friction_geometry: FRICTION_GEOMETRY,
            blades: BLADES,
        }
    }
}

/// Steady drilling of a bit with the law `regenerative`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyCut {
    /// Advance in a revolution d0 \[m\]: depth of cut of all blades.
    pub depth_of_cut: f64,
    /// Torque on bit T0 \[N m\], positive.
    pub torque: f64,
}

impl Bit {
    /// Weight a l sigma \[N\] that the wear flats of a bit of a radius \[m\] carry: with no more the bit does not drill.
    pub fn carried_weight(&self, radius: f64) -> f64 {
        radius * self.wear_length * self.contact_stress
    }

    /// Steady drilling of a bit of a radius \[m\] under a weight \[N\], positive when pressed on; absent if the bit does not drill.
    pub fn steady_cut(&self, radius: f64, weight: f64) -> Option<SteadyCut> {
        let cutting = weight - self.carried_weight(radius);
        let depth_of_cut = cutting / (radius * self.inclination * self.specific_energy);
        let contact = self.friction_geometry * self.wear_length * self.contact_stress;
        let torque = 0.5 * radius * radius * (self.specific_energy * depth_of_cut + contact);
        (depth_of_cut > 0.0 && depth_of_cut.is_finite()).then_some(SteadyCut { depth_of_cut, torque })
    }
}

impl Scenario {
    /// Radius of the bit \[m\].
    pub fn bit_radius(&self) -> f64 {
        self.bit.bit_radius.unwrap_or_else(|| 0.5 * self.hole_at(self.string.depth_of_bit()).diameter)
    }

    /// Torque on bit at the nominal speed \[N m\]: that of the operation, or of its weight on bit if the bit has an aggressiveness or cuts with the law `regenerative`; it opposes the
    /// rotation, a clockwise one if nothing turns. A pull makes no torque.
    pub fn torque_on_bit(&self) -> f64 {
        let operation = &self.operation;
        let weight = (-operation.weight_on_bit).max(0.0);
        let torque = match (self.bit.law, self.bit.aggressiveness) {
            (BitLaw::Regenerative, _) => {
                self.bit.steady_cut(self.bit_radius(), weight).map_or(0.0, |cut| cut.torque)
            }
            (_, Some(aggressiveness)) => {
                let diameter = self.hole_at(self.string.depth_of_bit()).diameter;
                aggressiveness.max(0.0) * weight * diameter / 3.0
            }
            (_, None) => return operation.torque_on_bit,
        };
        if operation.rotation_speed_rpm < 0.0 { torque } else { -torque }
    }
}

/// Torque on bit over the speed of the bit: `constant` or `velocity_weakening`; or `regenerative`, weight and torque over the depth of cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BitLaw {
    /// Torque on bit does not depend on the motion.
    #[default]
    Constant,
    /// Torque on bit falls exponentially with the speed of the bit, and changes its sign with it.
    VelocityWeakening,
    /// Weight and torque on bit follow the depth of cut, which is the advance since the blade before passed. For stability maps only.
    Regenerative,
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

fn specific_energy() -> f64 {
    SPECIFIC_ENERGY
}

fn inclination() -> f64 {
    INCLINATION
}

fn contact_stress() -> f64 {
    CONTACT_STRESS
}

fn wear_length() -> f64 {
    WEAR_LENGTH
}

fn friction_geometry() -> f64 {
    FRICTION_GEOMETRY
}

fn blades() -> u32 {
    BLADES
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

    #[test]
    fn a_regenerative_bit_cuts_and_turns_under_its_weight_as_an_independent_computation_has_it() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.bit = Bit {
            law: BitLaw::Regenerative,
            specific_energy: 1.2e8,
            inclination: 0.6,
            wear_length: 0.01,
            friction_geometry: 0.6,
            ..Bit::default()
        };
        scenario.well.hole_diameter = 0.2159;
        // a (zeta eps d0 + l sigma) of d0 = 4.5324 mm is 99,998 N, a^2 / 2 (eps d0 + mu gamma l sigma) 5266.6 N m.
        let cut = scenario.bit.steady_cut(scenario.bit_radius(), 99_998.0).unwrap();
        assert!((cut.depth_of_cut - 4.5324e-3).abs() < 1e-7, "{cut:?}");
        assert!((cut.torque - 5266.6).abs() < 0.1, "{cut:?}");
        // Specific energy 2 T0 / (a^2 d0) = (1 - mu gamma zeta) eps + mu gamma W0 / (a d0).
        let (a, d) = (scenario.bit_radius(), cut.depth_of_cut);
        let energy = 2.0 * cut.torque / (a * a * d);
        assert!((energy / ((1.0 - 0.36) * 1.2e8 + 0.6 * 99_998.0 / (a * d)) - 1.0).abs() < 1e-12);
        scenario.operation.weight_on_bit = -99_998.0;
        scenario.operation.torque_on_bit = 0.0;
        assert!((scenario.torque_on_bit() + cut.torque).abs() < 1e-9);
        let resolved = scenario.in_hole().into_owned();
        assert_eq!(resolved.operation.torque_on_bit, scenario.torque_on_bit());
        assert_eq!(*resolved.in_hole(), resolved, "once is enough");
        // 64,770 N rest on the wear flats.
        assert!((scenario.bit.carried_weight(a) - 64_770.0).abs() < 1e-6);
        assert_eq!(scenario.bit.steady_cut(a, 64_770.0 - 1.0), None);
    }
}
