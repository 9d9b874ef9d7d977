//! Modes of a band.

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::arnoldi::Eigenpair;
use super::pencil::Pencil;
use crate::force::contact::BodyMotion;
use crate::math::dof::DOFS;
use crate::solve::model::Model;

/// Size of `Mode::whirl` from which a mode counts as whirling in one sense.
const ONE_SENSE: f64 = 0.1;

/// Limit of every statement that modes decay if torque on bit is constant: the equations then hold no feedback of the bit's speed on it.
pub const BIT_NOT_JUDGED: &str = "torque on bit is constant: stick-slip at the bit is not judged";

/// That limit after a statement, unless torque on bit follows the speed of the bit.
pub(super) fn limit_of_bit(includes_bit: bool) -> String {
    if includes_bit { String::new() } else { format!("; {BIT_NOT_JUDGED}") }
}

/// The band that is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeSearch {
    /// Lowest frequency \[Hz\]; 0 looks for static instabilities as well.
    pub from_hz: f64,
    /// Highest frequency \[Hz\].
    pub to_hz: f64,
    /// The search ends when it has this many modes.
    pub most: usize,
}

impl Default for ModeSearch {
    fn default() -> Self {
        Self { from_hz: 0.0, to_hz: 20.0, most: 1000 }
    }
}

/// The modes of a band.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct Modes {
    /// The modes, by frequency.
    pub modes: Vec<Mode>,
    /// Frequency \[Hz\] up to which modes were searched for. If `completeness` is [`Completeness::Counted`], no mode is missing whose growth or
    /// decay is below `complete_to_rate`.
    pub complete_to_hz: f64,
    /// See `complete_to_hz` \[1/s\].
    pub complete_to_rate: f64,
    /// Result of the count that verifies this.
    pub completeness: Completeness,
}

/// Check that all eigenvalues were found, by their number: the winding number of the pencil's determinant along the
/// edge of the band, for decay below the rate of the answer and growth below twice the band's highest circular frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Completeness {
    /// The number found is the number counted.
    Counted,
    /// Number of eigenvalues not found, conjugate ones and overdamped motions included if the band begins at 0 Hz.
    Missing(usize),
    /// Number of eigenvalues found beyond the number counted: some are not modes.
    Excess(usize),
    /// The eigenvalues could not be counted.
    NotCounted,
}

impl fmt::Display for Completeness {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Counted => write!(formatter, "all eigenvalues, by their count"),
            Self::Missing(count) => write!(formatter, "{count} of the counted eigenvalues were not found"),
            Self::Excess(count) => write!(formatter, "{count} more eigenvalues were found than counted"),
            Self::NotCounted => write!(formatter, "completeness could not be determined by a count"),
        }
    }
}

/// One mode: `x(t) = Re(shape exp((growth_rate + 2 pi i frequency) t))`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Mode {
    /// Frequency \[Hz\]; 0 is a static instability.
    pub frequency_hz: f64,
    /// Growth of its amplitude \[1/s\]; negative is decay.
    pub growth_rate: f64,
    /// Its main motion.
    pub kind: ModeKind,
    /// Share of the kinetic energy in lateral motion, 0 to 1.
    pub lateral_share: f64,
    /// Share in torsion.
    pub torsional_share: f64,
    /// Share in axial motion.
    pub axial_share: f64,
    /// Sense of its whirl: 1 forward (with the rotation), -1 backward, 0 to and fro.
    pub whirl: f64,
    /// Node with most of the kinetic energy, from 1 at the top.
    pub node: usize,
    /// Measured depth of that node \[m\].
    pub measured_depth: f64,
    /// Measured depths \[m\] between which nine tenths of the kinetic energy lie.
    pub extent: [f64; 2],
}

/// Main motion of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModeKind {
    /// Lateral, whirling with the rotation.
    Forward,
    /// Lateral, whirling against it.
    Backward,
    /// Lateral, to and fro.
    Lateral,
    /// Torsion.
    Torsional,
    /// Along the string.
    Axial,
}

impl ModeKind {
    /// The name in requests and responses.
    pub fn name(self) -> &'static str {
        match self {
            ModeKind::Forward => "forward",
            ModeKind::Backward => "backward",
            ModeKind::Lateral => "lateral",
            ModeKind::Torsional => "torsional",
            ModeKind::Axial => "axial",
        }
    }
}

/// Reason for which a band has no modes.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// The band is empty or not finite.
    #[error("a band from {from_hz} to {to_hz} Hz: must be 0 <= from < to")]
    Band {
        /// Lower end \[Hz\].
        from_hz: f64,
        /// Upper end \[Hz\].
        to_hz: f64,
    },
    /// The string moves along its axis, whose friction in motion is not part of the model.
    #[error(
        "a string with an axial speed ({speed} m/s) has an equilibrium, but no modes: set operation.axial_speed to 0"
    )]
    AxialSpeed {
        /// Axial speed \[m/s\].
        speed: f64,
    },
    /// The control of the top drive has a state of its own, which the equations of modes do not hold.
    #[error(
        "modes do not hold the torque filter of z_torque: take top_drive.kind speed_control or imposed_speed, or a run in time"
    )]
    TorqueFilter,
    /// The iteration did not find the eigenvalues around a shift.
    #[error("the eigenvalues around {frequency_hz:.3} Hz could not be found")]
    NotFound {
        /// Frequency of the shift \[Hz\].
        frequency_hz: f64,
    },
}

impl ModesError {
    /// Refuses what small motions without unknowns of forces do not hold.
    pub(super) fn require_modes(model: &Model) -> Result<(), Self> {
        Self::require_no_axial_speed(model.body_motion())?;
        let has_unknowns = model.forces.iter().any(|force| !force.unknowns().is_empty());
        if has_unknowns { Err(Self::TorqueFilter) } else { Ok(()) }
    }

    /// Refuses a string with an axial speed: small motions about its equilibrium need axial friction in motion.
    pub(in crate::solve) fn require_no_axial_speed(motion: BodyMotion) -> Result<(), Self> {
        let speed = motion.axial_speed;
        if speed == 0.0 { Ok(()) } else { Err(Self::AxialSpeed { speed }) }
    }
}

impl Mode {
    pub(super) fn new(pencil: &Pencil, pair: &Eigenpair, depths: &[f64]) -> Self {
        let inertia = pencil.times_mass(&pair.shape);
        let (shape, _) = pair.shape.as_chunks::<DOFS>();
        let (inertia, _) = inertia.as_chunks::<DOFS>();
        let mut by_motion = [0.0; 3];
        let mut by_node = vec![0.0; shape.len()];
        let (mut forward, mut backward) = (0.0, 0.0);
        let i = Complex::new(0.0, 1.0);
        for ((x, momentum), energy) in shape.iter().zip(inertia).zip(&mut by_node) {
            for dof in 0..DOFS {
                let share = (x[dof].conj() * momentum[dof]).re;
                by_motion[MOTION_OF_DOF[dof]] += share;
                *energy += share;
            }
            // u + i v of Re(x exp(i w t)) is the sum of two circles.
            forward += (x[0] + i * x[1]).norm_sqr();
            backward += (x[0] - i * x[1]).norm_sqr();
        }
        let total: f64 = by_node.iter().sum();
        let [lateral_share, axial_share, torsional_share] = by_motion.map(|share| share / total);
        let whirl = if pair.value.im == 0.0 || forward + backward == 0.0 {
            0.0
        } else {
            (forward - backward) / (forward + backward)
        };
        let kind = if torsional_share > lateral_share.max(axial_share) {
            ModeKind::Torsional
        } else if axial_share > lateral_share {
            ModeKind::Axial
        } else if whirl > ONE_SENSE {
            ModeKind::Forward
        } else if whirl < -ONE_SENSE {
            ModeKind::Backward
        } else {
            ModeKind::Lateral
        };
        let node = (0..by_node.len()).max_by(|&a, &b| by_node[a].total_cmp(&by_node[b])).unwrap_or(0);
        let depth_at = |share: f64| {
            let mut sum = 0.0;
            let place = by_node.iter().position(|energy| {
                sum += energy;
                sum >= share * total
            });
            depths[place.unwrap_or(depths.len() - 1)]
        };
        Self {
            frequency_hz: pair.value.im / TAU,
            growth_rate: pair.value.re,
            kind,
            lateral_share,
            torsional_share,
            axial_share,
            whirl,
            node: node + 1,
            measured_depth: depths[node],
            extent: [depth_at(0.05), depth_at(0.95)],
        }
    }
}

/// Lateral, axial or torsional motion of each degree of freedom of a node.
const MOTION_OF_DOF: [usize; DOFS] = [0, 0, 1, 0, 0, 2];
