//! Effects that a scenario activates, with reasons.

use drillsweep_scenario::{ActiveEffects, AutoRule, Effect, Scenario, Switch};
use serde::Serialize;

use super::register::term;
use crate::force::term::{EffectContext, LateralWave};

/// Change of frequencies below which the aggressive rule omits an effect.
const NEGLIGIBLE: f64 = 1e-3;

/// One effect of a scenario, decided.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct EffectDecision {
    /// The effect.
    pub effect: Effect,
    /// Its switch in the scenario.
    pub switch: Switch,
    /// True if the effect takes part.
    pub active: bool,
    /// Reason for the decision.
    pub reason: String,
}

/// Every effect, in the order of [`Effect::ALL`], with the decision about it and its reason.
///
/// `auto` omits an effect if the scenario makes its term, or a motion, exactly zero, so that the
/// numbers are those of the whole model to rounding. It omits the run in time if no output in time is requested. Only the
/// aggressive rule neglects small effects.
pub fn decide_effects(scenario: &Scenario) -> Vec<EffectDecision> {
    let scenario = &*scenario.in_hole();
    // Gravity is decided before buoyancy, and friction torque before torsion, which depend on them.
    let mut active = ActiveEffects::ALL;
    let decide = |&effect: &Effect| {
        let switch = scenario.effects.switch(effect);
        let (is_active, reason) = match switch {
            Switch::On => (true, "requested".to_owned()),
            Switch::Off => (false, "switched off".to_owned()),
            Switch::Auto => {
                let decision = (term(effect).decide)(&EffectContext { scenario, active: &active });
                let change = frequency_change(scenario, effect);
                let neglects = scenario.effects.auto == AutoRule::Aggressive;
                if decision.active && neglects && change < NEGLIGIBLE {
                    (false, format!("omitted as small: relative change of frequencies about {change:.0e}"))
                } else {
                    (decision.active, decision.reason.to_owned())
                }
            }
        };
        active.set(effect, is_active);
        EffectDecision { effect, switch, active: is_active, reason }
    };
    Effect::ALL.iter().map(decide).collect()
}

/// The effects that take part.
pub fn active_effects(scenario: &Scenario) -> ActiveEffects {
    let mut active = ActiveEffects::ALL;
    for decision in decide_effects(scenario) {
        active.set(decision.effect, decision.active);
    }
    active
}

/// Estimated relative change by an effect of the frequency of a lateral wave that turns with the string, the
/// largest of any section; infinite without an estimate.
fn frequency_change(scenario: &Scenario, effect: Effect) -> f64 {
    let Some(estimate) = term(effect).frequency_change else { return f64::INFINITY };
    let of_section = |section| {
        let change = estimate(&LateralWave::along(section, scenario));
        // Without rotation there is no such wave.
        if change.is_nan() { f64::INFINITY } else { change }
    };
    scenario.string.sections.iter().map(of_section).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Effects, SurveyStation, preset};
    use serde_json::json;

    use super::*;
    use crate::key::canonical_json;

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    /// Effects of sections that the base case lacks.
    const OF_OWN_SECTIONS: [Effect; 3] = [Effect::BitRock, Effect::Excitation, Effect::TopDrive];

    /// Names of the effects that `auto` omits, but those of sections that the base case lacks.
    fn left_out(change: impl Fn(&mut Scenario)) -> Vec<&'static str> {
        let mut scenario = paper();
        scenario.effects = Effects::default();
        change(&mut scenario);
        let left_out = decide_effects(&scenario)
            .into_iter()
            .filter(|decision| !decision.active && !OF_OWN_SECTIONS.contains(&decision.effect));
        left_out.map(|decision| decision.effect.name()).collect()
    }

    #[test]
    fn auto_omits_nothing_in_the_base_case() {
        assert_eq!(left_out(|_| {}), [""; 0]);
    }

    #[test]
    fn auto_omits_effects_that_the_scenario_lacks() {
        let fluid =
            ["fluid_added_mass", "fluid_damping", "fluid_coriolis", "flow_stiffness", "mud_drag", "buoyancy"];
        assert_eq!(left_out(|s| s.mud = None), fluid);
        let still = |s: &mut Scenario| s.mud.as_mut().unwrap().flow_rate = 0.0;
        assert_eq!(left_out(still), ["fluid_coriolis", "flow_stiffness", "mud_drag"]);
        assert_eq!(left_out(|s| s.effects.gravity = Switch::Off), ["gravity", "buoyancy"]);
        assert_eq!(left_out(|s| s.operation.rotation_speed_rpm = 0.0), ["unbalance", "gyroscopic"]);
        assert_eq!(left_out(|s| s.string.unbalance.clear()), ["unbalance"]);
        assert_eq!(left_out(|s| s.damping.mass_proportional = 0.0), ["structural_damping"]);
        let nothing_in_time = |s: &mut Scenario| {
            s.recording.nodes.clear();
            s.recording.spectrum_windows = Some(Vec::new());
            s.recording.orbit_window = None;
        };
        assert_eq!(left_out(nothing_in_time), ["transient"]);
    }

    #[test]
    fn a_motion_that_nothing_drives_is_not_solved_for() {
        let straighten = |s: &mut Scenario| {
            for station in &mut s.well.survey {
                (station.inclination_deg, station.azimuth_deg) = (60.0, 30.0);
            }
        };
        assert_eq!(left_out(straighten), ["well_bending", "axial_motion"]);
        let without_friction = |s: &mut Scenario| {
            (s.contact.static_friction, s.contact.dynamic_friction) = (0.0, 0.0);
        };
        assert_eq!(left_out(without_friction), ["friction", "friction_torque"]);
        let both = |s: &mut Scenario| {
            straighten(s);
            without_friction(s);
        };
        let still = ["friction", "friction_torque", "well_bending", "torsion", "axial_motion"];
        assert_eq!(left_out(both), still);
        // The hole below the string does not matter.
        let curved_below = |s: &mut Scenario| {
            both(s);
            let last = *s.well.survey.last().unwrap();
            let below =
                SurveyStation { measured_depth: last.measured_depth + 50.0, inclination_deg: 70.0, ..last };
            s.well.survey.push(below);
        };
        assert_eq!(left_out(curved_below), still);
        let no_torque = |s: &mut Scenario| {
            without_friction(s);
            s.operation.torque_on_bit = 0.0;
        };
        assert_eq!(left_out(no_torque), ["friction", "friction_torque", "torque_stiffening"]);
    }

    #[test]
    fn bit_excitation_and_drive_take_part_if_the_scenario_has_them() {
        let active = |path: &str, value: serde_json::Value| {
            let scenario = paper().with(path, value).unwrap();
            OF_OWN_SECTIONS.map(|effect| active_effects(&scenario).is_active(effect))
        };
        assert_eq!(active("name", json!("base case")), [false; 3]);
        assert_eq!(active("bit.law", json!("velocity_weakening")), [true, false, false]);
        let force = json!([{ "above_bit": 1.0, "direction": "axial", "force": 1e4, "frequency_hz": 18.0 }]);
        assert_eq!(active("excitation", force), [false, true, false]);
        assert_eq!(active("top_drive.kind", json!("speed_control")), [false, false, true]);
        // A straight string without friction turns evenly but for its bit, and moves along itself under an axial force alone.
        let mut straight = paper().with("bit.law", json!("velocity_weakening")).unwrap();
        for station in &mut straight.well.survey {
            (station.inclination_deg, station.azimuth_deg) = (60.0, 30.0);
        }
        (straight.contact.static_friction, straight.contact.dynamic_friction) = (0.0, 0.0);
        let of = |scenario: &Scenario| {
            let active = active_effects(scenario);
            [active.torsion, active.axial_motion]
        };
        assert_eq!(of(&straight), [true, false]);
        straight.operation.torque_on_bit = 0.0;
        assert_eq!(of(&straight), [false, false]);
        let force = json!([{ "above_bit": 1.0, "direction": "axial", "force": 1e4, "frequency_hz": 18.0 }]);
        assert_eq!(of(&straight.with("excitation", force).unwrap()), [false, true]);
        let torque =
            json!([{ "above_bit": 1.0, "direction": "torsional", "torque": 1e3, "per_revolution": 3.0 }]);
        assert_eq!(of(&straight.with("excitation", torque).unwrap()), [true, false]);
    }

    #[test]
    fn on_and_off_are_obeyed_and_named() {
        let mut scenario = paper();
        scenario.effects.set(Effect::Contact, Switch::Off);
        scenario.effects.set(Effect::Friction, Switch::On);
        scenario.operation.rotation_speed_rpm = 0.0;
        scenario.effects.set(Effect::Gyroscopic, Switch::On);
        let decisions = decide_effects(&scenario);
        let of = |effect| decisions.iter().find(|decision| decision.effect == effect).unwrap();
        assert_eq!(
            (of(Effect::Contact).active, of(Effect::Contact).reason.as_str()),
            (false, "switched off")
        );
        assert_eq!((of(Effect::Friction).active, of(Effect::Friction).reason.as_str()), (true, "requested"));
        assert!(of(Effect::Gyroscopic).active);
        // Friction torque follows from the decision about contact.
        assert_eq!(of(Effect::FrictionTorque).reason, "there is no contact");
    }

    #[test]
    fn the_aggressive_rule_omits_small_effects_with_an_estimate() {
        let mut scenario = paper();
        assert_eq!(left_out(|_| {}), [""; 0]);
        scenario.effects.auto = AutoRule::Aggressive;
        let decisions = decide_effects(&scenario);
        let of = |effect| decisions.iter().find(|decision| decision.effect == effect).unwrap();
        // Collars of 159 x 71 mm: rho I = 7900 * 3.01e-5 kg m, m = 261 kg/m with added mass, E I = 6.1e6 N m2, so that
        // rho I W / (m E I)^(1/2) = 0.238 * 12.57 / 4.0e4 = 7.5e-5.
        let change = frequency_change(&scenario, Effect::Gyroscopic);
        assert!((change / 7.5e-5 - 1.0).abs() < 0.3, "{change:e}");
        assert!(!of(Effect::Gyroscopic).active);
        assert!(of(Effect::Gyroscopic).reason.contains("e-5"), "{:?}", of(Effect::Gyroscopic));
        assert!(of(Effect::Contact).active && of(Effect::FluidDamping).active);
        // Fast flow has an effect.
        scenario.mud.as_mut().unwrap().flow_rate = 0.5;
        let decisions = decide_effects(&scenario);
        let of = |effect| decisions.iter().find(|decision| decision.effect == effect).unwrap();
        assert!(of(Effect::FlowStiffness).active && of(Effect::FluidCoriolis).active);
    }

    #[test]
    fn an_effect_on_and_an_effect_that_auto_activates_share_a_key() {
        let mut asked = paper();
        for &effect in Effect::ALL.iter().filter(|effect| !OF_OWN_SECTIONS.contains(effect)) {
            asked.effects.set(effect, Switch::On);
        }
        assert_eq!(canonical_json(&asked), canonical_json(&paper()));
    }
}
