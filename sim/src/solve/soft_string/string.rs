//! The string on the axis of its hole.

use drillsweep_scenario::{Hole, Operation, Scenario};

use super::error::SoftStringError;
use super::strength::Strength;
use crate::force::effect::active_effects;
use crate::force::term::gravity;
use crate::string::beam::BeamSection;
use crate::string::well::WellPath;
use crate::string::{ElementKind, UniformPart, stretches};

/// A string on the axis of its hole.
#[derive(Debug, Clone)]
pub struct SoftString {
    pub(super) path: WellPath,
    /// Parts from the top.
    pub(super) parts: Vec<Part>,
    /// Length of the whole string \[m\].
    pub(super) length: f64,
    /// Measured depth of the bit in the scenario \[m\].
    bit_depth: f64,
    /// Depths at which hole sections begin \[m\].
    pub(super) section_tops: Vec<f64>,
    /// The hole above all sections, then that of each section.
    pub(super) holes: Vec<Hole>,
    pub(super) operation: Operation,
}

/// A part of one cross-section.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Measured depths of its ends with the whole string in the hole \[m\].
    pub(super) ends: [f64; 2],
    /// Buoyed weight \[N/m\].
    pub(super) weight: f64,
    /// Radius at which it touches the wall \[m\]: that of its tool joints if they are larger.
    pub(super) contact_radius: f64,
    pub(super) strength: Strength,
}

impl SoftString {
    /// The string of a scenario, with the weight of its effects.
    ///
    /// # Errors
    /// The survey has no path or the string no sections; a validated scenario has both.
    pub fn new(scenario: &Scenario) -> Result<Self, SoftStringError> {
        let effects = active_effects(scenario);
        let acceleration = gravity::acceleration(effects.gravity);
        let mud = scenario.mud.filter(|_| effects.buoyancy).map_or(0.0, |mud| mud.density);
        let mut whole = scenario.clone();
        whole.string.bit_depth = None;
        let uniform = stretches(&whole)?;
        let joints = |index: usize| {
            let neighbours = [index.checked_sub(1), Some(index + 1)].into_iter().flatten();
            let joints = neighbours.filter_map(|index| uniform.get(index));
            joints.filter(|part| part.kind == ElementKind::ToolJoint).map(|joint| joint.tube.outer_diameter)
        };
        let part = |(index, part): (usize, &UniformPart)| {
            let section = BeamSection::of(&part.tube);
            let mass =
                section.density * section.area + mud * (section.bore_area() - section.displaced_area());
            // A body with joints at both ends hangs between them.
            let carried = part.kind == ElementKind::DrillpipeBody && joints(index).count() == 2;
            let joint = if carried { joints(index).fold(0.0, f64::max) } else { 0.0 };
            Part {
                ends: [part.top, part.bottom],
                weight: acceleration * mass,
                contact_radius: 0.5 * part.tube.outer_diameter.max(joint),
                strength: Strength::new(section, part.tube.material.grade, acceleration * mass)
                    .with_make_up_torque(scenario.string.sections[part.section].make_up_torque),
            }
        };
        let parts: Vec<Part> = uniform.iter().enumerate().map(part).collect();
        let sections = 0..scenario.well.section.len();
        Ok(Self {
            path: WellPath::new(&scenario.well)?,
            length: parts.last().map_or(0.0, |part| part.ends[1]),
            bit_depth: scenario.string.depth_of_bit(),
            parts,
            section_tops: scenario.well.section.iter().map(|section| section.from).collect(),
            holes: std::iter::once(None)
                .chain(sections.map(Some))
                .map(|index| scenario.hole_of(index))
                .collect(),
            operation: scenario.in_hole().operation,
        })
    }

    /// Measured depth of the bit in the scenario \[m\].
    pub fn bit_depth(&self) -> f64 {
        self.bit_depth
    }

    /// Measured depth \[m\] to which the bit can go: the length of the whole string, or the end of the survey.
    pub fn deepest(&self) -> f64 {
        self.path.length().min(self.length)
    }

    /// Friction factors of the hole above all sections and of each section.
    pub(super) fn friction(&self, common: Option<f64>) -> Result<Vec<f64>, SoftStringError> {
        match common {
            Some(friction) if !(friction.is_finite() && friction >= 0.0) => {
                Err(SoftStringError::Friction(friction))
            }
            _ => Ok(self.holes.iter().map(|hole| common.unwrap_or(hole.dynamic_friction)).collect()),
        }
    }
}
