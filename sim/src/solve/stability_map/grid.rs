//! Growth over a grid of speeds and weights.

use std::f64::consts::{PI, TAU};

use drillsweep_scenario::{BitLaw, Scenario, TopCondition, TopDriveKind};
use serde::Serialize;

use super::chain::{AxialTop, Chain, Part, Top, TorqueFilter};
use super::feedback::Feedback;
use super::roots::{Growing, growing};
use super::table::{STEP, Table};
use crate::force::bit_rock::WeakeningTorque;
use crate::solve::model::Model;
use crate::solve::modes::{ModesError, rubbing};
use crate::solve::statics::Equilibrium;
use crate::string::beam::BeamSection;

/// Largest number of points of a map.
pub const MOST_POINTS: usize = 10_000;

/// Elements in a wave from which a mesh resolves it.
const ELEMENTS_OF_A_WAVE: f64 = 10.0;

/// Highest frequency \[Hz\] to which motions are searched for.
const HIGHEST_HZ: f64 = 300.0;

/// Parts of the string times places of a table: half a second at most.
const MOST_VALUES: f64 = 4e6;

/// Places of a table, some 5 MB: a slow bit has a long delay, which many places must follow.
const MOST_PLACES: f64 = 65_536.0;

/// Speeds and weights of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityGrid {
    /// Speeds of rotation \[rpm\], above 0.
    pub speeds: Vec<f64>,
    /// Weights on bit \[N\], positive: compression.
    pub weights: Vec<f64>,
    /// Axial condition of the top.
    pub axial_top: AxialTop,
}

/// Stability map: a point for each speed and, within it, each weight.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityMap {
    /// Points, by speed, then by weight.
    pub points: Vec<StabilityPoint>,
    /// Frequency \[Hz\] up to which growing motions were counted at every point; none is above at points that are `complete`.
    pub complete_to_hz: f64,
    /// Frequency \[Hz\] up to which the mesh of the scenario has ten elements to the wave. The map does not depend on the mesh; runs and modes at higher frequencies do.
    pub mesh_to_hz: f64,
}

/// Growth at a speed of rotation and a weight on bit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StabilityPoint {
    /// Speed of rotation \[rpm\].
    pub rotation_speed_rpm: f64,
    /// Weight on bit \[N\], positive: compression.
    pub weight_on_bit: f64,
    /// Torque on bit \[N m\], positive.
    pub torque_on_bit: f64,
    /// Rate of penetration \[m/s\]; absent if the law of the bit has none.
    pub rate_of_penetration: Option<f64>,
    /// Number of growing motions by their count: oscillations, and motions that grow without one; absent if they could not be counted.
    pub growing: Option<usize>,
    /// Growth \[1/s\] of the one that grows fastest; absent if none grows.
    pub growth_rate: Option<f64>,
    /// Its frequency \[Hz\].
    pub frequency_hz: Option<f64>,
    /// True if no motion grows above the frequencies of the count, and all that were counted were found.
    pub complete: bool,
}

/// Reason for which a scenario has no stability map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StabilityError {
    /// The equations of small motions do not apply.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// Torque on bit is constant.
    #[error(
        "a bit with a constant torque excites nothing: set bit.law to `velocity_weakening` or `regenerative`"
    )]
    ConstantTorque,
    /// An axis is empty.
    #[error("a stability map needs at least one speed and one weight")]
    Empty,
    /// Too many points are requested.
    #[error("{0} points are requested, of {MOST_POINTS} at most")]
    TooManyPoints(usize),
    /// A speed is too low or not a number.
    #[error(
        "a speed of rotation of {speed_rpm} rpm: must be a number of at least {slowest_rpm:.3}, bit.regularisation_speed"
    )]
    Speed {
        /// Speed \[rpm\].
        speed_rpm: f64,
        /// Slowest speed \[rpm\].
        slowest_rpm: f64,
    },
    /// A weight is negative or not a number.
    #[error("a weight on bit of {0} N: must be a number of 0 or more, compression positive")]
    Weight(f64),
    /// The wear flats of the bit carry the whole weight.
    #[error("the bit does not drill under {weight} N: its wear flats carry {carried:.0} N")]
    DoesNotDrill {
        /// Weight \[N\].
        weight: f64,
        /// Weight on the wear flats \[N\].
        carried: f64,
    },
    /// The motions of the string by itself cannot be counted.
    #[error("the growing motions of the string at {speed_rpm} rpm cannot be counted")]
    NotCounted {
        /// Speed \[rpm\].
        speed_rpm: f64,
    },
}

/// Growth of small motions at all points of a grid. The equilibrium is that of the scenario: contacts and their forces stay, friction has the slope of each speed. The law of
/// the rock is one over all speeds; `scenario` is that of the model as written, whose bit follows the weight.
///
/// # Errors
/// The grid is empty, too large or out of range; the bit does not follow the motion; or `interrupted`, called at each speed and point, returns an error.
pub fn stability_map<E: From<StabilityError>>(
    scenario: &Scenario,
    model: &Model,
    equilibrium: &Equilibrium,
    grid: &StabilityGrid,
    mut interrupted: impl FnMut() -> Result<(), E>,
) -> Result<StabilityMap, E> {
    let bits = check(scenario, model, grid)?;
    let slowest = grid.speeds.iter().copied().fold(f64::INFINITY, f64::min);
    let longest_delay = bits.iter().map(|bit| bit.feedback(slowest).delay()).fold(0.0, f64::max);
    let mut map =
        StabilityMap { points: Vec::new(), complete_to_hz: f64::INFINITY, mesh_to_hz: mesh_to_hz(model) };
    let mut last: Option<(Vec<f64>, Table)> = None;
    for &speed_rpm in &grid.speeds {
        interrupted()?;
        let dampers = rubbing(model, equilibrium, speed_rpm * PI / 30.0);
        // Without friction the string is the same at all speeds.
        let table = match last.take() {
            Some((of_last, table)) if of_last == dampers => table,
            _ => {
                let chains = chains(model, &dampers, grid.axial_top);
                table(chains, longest_delay).ok_or(StabilityError::NotCounted { speed_rpm })?
            }
        };
        map.complete_to_hz = map.complete_to_hz.min(table.highest() / TAU);
        let is_free = grid.axial_top == AxialTop::HookLoad;
        for bit in &bits {
            interrupted()?;
            map.points.push(bit.point(speed_rpm, &growing(&table, is_free, &bit.feedback(speed_rpm))));
        }
        last = Some((dampers, table));
    }
    Ok(map)
}

/// Table of chains up to the highest frequency that its size allows.
pub(super) fn table(chains: [Chain; 2], longest_delay: f64) -> Option<Table> {
    let parts = chains.iter().map(Chain::len).sum::<usize>().max(1) as f64;
    let travel: f64 = chains.iter().map(Chain::travel_time).sum::<f64>() + longest_delay;
    let places = MOST_PLACES.min(MOST_VALUES / parts);
    let highest = (TAU * HIGHEST_HZ).min(STEP * places / travel);
    Table::new(chains, highest, longest_delay)
}

/// Frequency \[Hz\] up to which every element is a tenth of a torsional wave or less, which is shorter than an axial one.
fn mesh_to_hz(model: &Model) -> f64 {
    let of_element = |speed: f64, length: f64| speed / (ELEMENTS_OF_A_WAVE * length);
    model
        .elements
        .iter()
        .map(|element| of_element(element.beam.section().torsional_wave_speed(), element.beam.length()))
        .fold(f64::INFINITY, f64::min)
}

/// Axial and torsional chain of a model with dampers of twist at its nodes.
pub(super) fn chains(model: &Model, dampers: &[f64], axial_top: AxialTop) -> [Chain; 2] {
    let damping = &model.scenario.damping;
    let rayleigh = if model.effects.structural_damping {
        [damping.mass_proportional, damping.stiffness_proportional]
    } else {
        [0.0; 2]
    };
    let operation = &model.scenario.operation;
    let pipe = model
        .scenario
        .string
        .sections
        .first()
        .map(|section| BeamSection::of(&model.scenario.string.body(section)));
    let continues = |impedance: fn(&BeamSection) -> f64, speed: fn(&BeamSection) -> f64| {
        let pipe = pipe.as_ref().filter(|_| operation.top == TopCondition::Continues)?;
        let return_time = operation.length_above.map(|length| 2.0 * length / speed(pipe));
        Some(Top::Continues { impedance: impedance(pipe), return_time })
    };
    let axial = match axial_top {
        AxialTop::HookLoad => Top::Free,
        AxialTop::Advance => {
            continues(BeamSection::axial_impedance, BeamSection::axial_wave_speed).unwrap_or(Top::Held)
        }
    };
    let drive = &model.scenario.top_drive;
    let driven = model.speed_control.map(|control| {
        let filter =
            (drive.kind == TopDriveKind::ZTorque).then_some(()).and(pipe.as_ref()).map(|pipe| TorqueFilter {
                per_torque: drive.factor / pipe.torsional_impedance(),
                time_constant: drive.time_constant,
            });
        Top::Driven { control, filter }
    });
    let torsional = driven
        .or_else(|| continues(BeamSection::torsional_impedance, BeamSection::torsional_wave_speed))
        .unwrap_or(Top::Held);
    let parts = |impedance: fn(&BeamSection) -> f64, speed: fn(&BeamSection) -> f64, has_dampers: bool| {
        model.elements.iter().zip(&dampers[1..]).map(move |(element, &damper)| {
            let section = element.beam.section();
            Part {
                travel_time: element.beam.length() / speed(section),
                impedance: impedance(section),
                damper: if has_dampers { damper } else { 0.0 },
            }
        })
    };
    [
        Chain::new(
            axial,
            parts(BeamSection::axial_impedance, BeamSection::axial_wave_speed, false),
            rayleigh,
        ),
        Chain::new(
            torsional,
            parts(BeamSection::torsional_impedance, BeamSection::torsional_wave_speed, true),
            rayleigh,
        ),
    ]
}

/// The bit of a scenario under one weight.
struct WeightedBit {
    scenario: Scenario,
    /// Torque on bit at the speed of the scenario \[N m\], positive.
    torque: f64,
    /// Weight \[N\], positive.
    weight: f64,
}

/// Bits of a grid's weights.
fn check(
    scenario: &Scenario,
    model: &Model,
    grid: &StabilityGrid,
) -> Result<Vec<WeightedBit>, StabilityError> {
    ModesError::require_no_axial_speed(model.body_motion())?;
    let bit = &scenario.bit;
    if bit.law == BitLaw::Constant {
        return Err(StabilityError::ConstantTorque);
    }
    let count = grid.speeds.len().saturating_mul(grid.weights.len());
    if count == 0 {
        return Err(StabilityError::Empty);
    }
    if count > MOST_POINTS {
        return Err(StabilityError::TooManyPoints(count));
    }
    let slowest_rpm = bit.regularisation_speed * 30.0 / PI;
    if let Some(&speed_rpm) = grid.speeds.iter().find(|speed| !(speed.is_finite() && **speed >= slowest_rpm))
    {
        return Err(StabilityError::Speed { speed_rpm, slowest_rpm });
    }
    grid.weights
        .iter()
        .map(|&weight| {
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(StabilityError::Weight(weight));
            }
            let carried = bit.carried_weight(scenario.bit_radius());
            if bit.law == BitLaw::Regenerative && bit.steady_cut(scenario.bit_radius(), weight).is_none() {
                return Err(StabilityError::DoesNotDrill { weight, carried });
            }
            let mut scenario = scenario.clone();
            scenario.operation.weight_on_bit = -weight;
            let torque = scenario.torque_on_bit().abs();
            Ok(WeightedBit { scenario, torque, weight })
        })
        .collect()
}

impl WeightedBit {
    /// Feedback at a speed \[rpm\].
    fn feedback(&self, speed_rpm: f64) -> Feedback {
        let (bit, speed) = (&self.scenario.bit, speed_rpm * PI / 30.0);
        match bit.steady_cut(self.scenario.bit_radius(), self.weight) {
            Some(cut) if bit.law == BitLaw::Regenerative => {
                Feedback::regenerative(bit, self.scenario.bit_radius(), cut, speed)
            }
            _ => Feedback::Weakening {
                slope: WeakeningTorque::fall(bit, -self.torque, self.rock_speed(), speed),
            },
        }
    }

    /// Speed of the scenario \[rad/s\], at which its torque on bit holds.
    fn rock_speed(&self) -> f64 {
        self.scenario.operation.rotation_speed_rpm.abs() * PI / 30.0
    }

    fn point(&self, rotation_speed_rpm: f64, growing: &Growing) -> StabilityPoint {
        let bit = &self.scenario.bit;
        let speed = rotation_speed_rpm * PI / 30.0;
        let is_regenerative = bit.law == BitLaw::Regenerative;
        let cut = bit.steady_cut(self.scenario.bit_radius(), self.weight).filter(|_| is_regenerative);
        let fastest = growing.found.iter().max_by(|a, b| a.re.total_cmp(&b.re));
        let is_found = growing.counted == Some(growing.found_with_conjugates());
        StabilityPoint {
            rotation_speed_rpm,
            weight_on_bit: self.weight,
            torque_on_bit: match cut {
                Some(cut) => cut.torque,
                None => -WeakeningTorque::torque(bit, -self.torque, self.rock_speed(), speed),
            },
            rate_of_penetration: cut.map(|cut| cut.depth_of_cut * speed / TAU),
            growing: growing.counted.map(|counted| {
                let found = growing.found.len();
                let missing = (counted - growing.found_with_conjugates()).max(0) as usize;
                found + missing.div_ceil(2)
            }),
            growth_rate: fastest.map(|root| root.re),
            frequency_hz: fastest.map(|root| root.im / TAU),
            complete: growing.is_bounded && is_found,
        }
    }
}
