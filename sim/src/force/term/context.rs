//! Properties of a scenario that activate effects.

use std::f64::consts::PI;

use drillsweep_scenario::{ActiveEffects, Mud, Scenario, Section, SurveyStation};

use crate::force::mud::{FlowGeometry, FlowMomentum};
use crate::string::beam::BeamSection;

/// A scenario, with the decisions about its effects so far.
pub struct EffectContext<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Decisions about the effects before this one in their order; later effects count as active.
    pub active: &'a ActiveEffects,
}

/// Decision on whether a scenario needs an effect, with its reason.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// True if the scenario needs the effect.
    pub active: bool,
    /// Reason, in words.
    pub reason: &'static str,
}

/// The scenario needs the effect.
pub(crate) const fn yes(reason: &'static str) -> Decision {
    Decision { active: true, reason }
}

/// The scenario does not need the effect.
pub(crate) const fn no(reason: &'static str) -> Decision {
    Decision { active: false, reason }
}

impl EffectContext<'_> {
    /// True if the string turns.
    pub(crate) fn turns(&self) -> bool {
        self.scenario.operation.rotation_speed_rpm != 0.0
    }

    /// True if the hole is straight along the whole string.
    pub(crate) fn is_straight(&self) -> bool {
        let length = self.scenario.string.depth_of_bit();
        self.scenario.well.survey.windows(2).all(|stations| {
            let [above, below] = stations else { return true };
            above.measured_depth >= length || same_direction(above, below)
        })
    }
}

/// Decision about an effect of mud, at rest or in flow.
pub(crate) fn has_mud(context: &EffectContext<'_>) -> Decision {
    if context.scenario.mud.is_some() { yes("there is mud") } else { no("the hole is dry") }
}

/// Decision about an effect of flowing mud.
pub(crate) fn has_flow(context: &EffectContext<'_>) -> Decision {
    match &context.scenario.mud {
        None => no("the hole is dry"),
        Some(mud) if mud.flow_rate == 0.0 => no("the mud does not flow"),
        Some(_) => yes("the mud flows"),
    }
}

/// Decision about friction at the wall.
pub(crate) fn has_friction(context: &EffectContext<'_>) -> Decision {
    let law = &context.scenario.contact;
    match (context.active.contact, law.static_friction == 0.0 && law.dynamic_friction == 0.0) {
        (false, _) => no("there is no contact"),
        (true, true) => no("the wall is without friction"),
        (true, false) => yes("the wall has friction"),
    }
}

fn same_direction(a: &SurveyStation, b: &SurveyStation) -> bool {
    let is_vertical = a.inclination_deg == 0.0 || a.inclination_deg == 180.0;
    a.inclination_deg == b.inclination_deg && (is_vertical || a.azimuth_deg == b.azimuth_deg)
}

/// A lateral wave along one section that turns with the string: its wave number k has m w^2 = E I k^4, so that k^2 = w (m/(E I))^(1/2).
pub(crate) struct LateralWave {
    /// The section.
    pub(crate) beam: BeamSection,
    /// Density of its material \[kg/m3\].
    pub(crate) density: f64,
    /// The flows past it; absent without mud.
    pub(crate) flow: Option<FlowMomentum>,
    /// m, mud included \[kg/m\].
    pub(crate) mass: f64,
    /// w \[rad/s\]; without rotation there is no such wave.
    pub(crate) frequency: f64,
    /// k \[1/m\].
    pub(crate) wave_number: f64,
}

impl LateralWave {
    /// Wave along a section of a scenario's string.
    pub(crate) fn along(section: &Section, scenario: &Scenario) -> Self {
        let beam = BeamSection::of(&scenario.string.body(section));
        // The narrowest hole has the greatest added mass.
        let hole = scenario.well.narrowest_hole([0.0, f64::INFINITY]);
        let flow_of = |mud: &Mud| FlowMomentum::new(mud, &FlowGeometry::past(&beam, hole));
        let flow = scenario.mud.as_ref().map(flow_of);
        let mass = beam.density * beam.area + flow.map_or(0.0, |flow| flow.lateral_mass());
        let stiffness = beam.bending_stiffness();
        let frequency = scenario.operation.rotation_speed_rpm.abs() * PI / 30.0;
        let wave_number = (frequency * (mass / stiffness).sqrt()).sqrt();
        Self { beam, density: beam.density, flow, mass, frequency, wave_number }
    }
}
