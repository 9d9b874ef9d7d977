//! Physical instability of a scenario and its mode: distinguishes a failed run from a limit cycle.

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::arnoldi::Eigenpair;
use super::mode::{Completeness, Mode, ModeKind, ModeSearch, ModesError, limit_of_bit};
use super::pencil::{Pencil, add_contact, times};
use super::walk::{Found, eigenpairs, uncounted_eigenpairs};
use crate::force::bit_rock::WeakeningTorque;
use crate::force::contact::sliding_tangent;
use crate::math::dof::{U, V};
use crate::math::linalg::BlockTridiagonal;
use crate::solve::model::{Model, add_element_matrix, clear_held};
use crate::solve::statics::{Equilibrium, negative_eigenvalues};

/// Band in which the verdict searches for growth \[Hz\]: the frequencies of drilling vibrations.
const BAND_HZ: f64 = 20.0;

/// Growth \[1/s\] below which a mode counts as neither growing nor decaying.
const NEUTRAL: f64 = 1e-6;

/// Natural logarithm of the growth from which an unstable mode can explain that a run diverged: twentyfold, from a string that vibrates by all of its
/// clearance, some centimetres, to two hole radii. Vibrations about the equilibrium are smaller and need longer.
const EXPLAINING_GROWTH: f64 = 3.0;

/// The verdict of the linearised equations about the equilibrium, contacts closed, on frequencies up to `complete_to_hz`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Stability {
    /// True if all modes decay; absent if none was found to grow and the search is not known to be complete.
    pub stable: Option<bool>,
    /// Frequency \[Hz\] up to which modes were searched for.
    pub complete_to_hz: f64,
    /// Result of the count that verifies that all modes up to that frequency were found.
    pub completeness: Completeness,
    /// The mode that grows fastest; absent if the scenario is stable.
    pub instability: Option<Instability>,
    /// True if torque on bit follows the speed of the bit, so that stick-slip of the bit is included.
    #[serde(default)]
    pub includes_bit: bool,
}

/// The mode that grows fastest, with the source of its energy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Instability {
    /// Its kind.
    pub kind: InstabilityKind,
    /// Growth of its amplitude \[1/s\].
    pub growth_rate: f64,
    /// Its frequency \[Hz\]; 0 if it does not vibrate.
    pub frequency_hz: f64,
    /// Node that moves most, from 1 at the top.
    pub node: usize,
    /// Measured depth of that node \[m\].
    pub measured_depth: f64,
    /// Modes that grow.
    pub growing_modes: usize,
}

/// Kinds of instability, by the source of the mode's energy and its motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum InstabilityKind {
    /// Compression pushes the string aside.
    Buckling,
    /// Torque winds the string into a helix (Greenhill), with or without vibration.
    TorqueBuckling,
    /// The momentum of the flows pushes the string aside.
    FlowDivergence,
    /// The flows excite a vibration.
    FlowFlutter,
    /// Friction at the wall excites a lateral vibration: dry-friction whirl.
    FrictionWhirl,
    /// Velocity-weakening friction excites torsion: stick-slip.
    StickSlip,
    /// Torque on bit that falls with the speed of the bit excites torsion: stick-slip of the bit.
    BitStickSlip,
    /// Anything else.
    Other,
}

impl InstabilityKind {
    /// The kind in words.
    pub fn in_words(self) -> &'static str {
        match self {
            InstabilityKind::Buckling => "buckling under compression",
            InstabilityKind::TorqueBuckling => "buckling under torque",
            InstabilityKind::FlowDivergence => "divergence by the flow",
            InstabilityKind::FlowFlutter => "flutter by the flow",
            InstabilityKind::FrictionWhirl => "whirl by friction",
            InstabilityKind::StickSlip => "stick-slip by velocity-weakening friction",
            InstabilityKind::BitStickSlip => "stick-slip by the torque on bit",
            InstabilityKind::Other => "an instability",
        }
    }
}

impl fmt::Display for Stability {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.instability {
            None if self.stable == Some(true) => {
                write!(
                    formatter,
                    "stable about its equilibrium up to {:.0} Hz{}",
                    self.complete_to_hz,
                    limit_of_bit(self.includes_bit)
                )
            }
            None => write!(
                formatter,
                "no growing mode about its equilibrium was found up to {:.0} Hz; {}{}",
                self.complete_to_hz,
                self.completeness,
                limit_of_bit(self.includes_bit)
            ),
            Some(unstable) => write!(formatter, "physically unstable: {unstable}"),
        }
    }
}

impl fmt::Display for Instability {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{}, {:.3} Hz, growing with {:.3} 1/s, most at {:.1} m",
            self.kind.in_words(),
            self.frequency_hz,
            self.growth_rate,
            self.measured_depth
        )
    }
}

impl Stability {
    /// True if a growing mode can explain that a run diverged after `time` \[s\].
    pub fn explains_divergence_at(&self, time: f64) -> bool {
        self.instability.is_some_and(|unstable| unstable.growth_rate * time >= EXPLAINING_GROWTH)
    }

    /// The verdict on a run that diverged after `time` \[s\], in words: the instability that explains it, or that none does.
    pub fn of_divergence_at(&self, time: f64) -> String {
        match &self.instability {
            Some(_) if self.explains_divergence_at(time) => self.to_string(),
            Some(unstable) => format!(
                "numerical or unexplained: the fastest growth about the equilibrium ({unstable}) had grown by a factor of {:.2} by then",
                (unstable.growth_rate * time).exp()
            ),
            None => format!("numerical or unexplained: {self}"),
        }
    }
}

/// The verdict on a model about its equilibrium, on all modes up to 20 Hz.
///
/// # Errors
/// The modes cannot be found.
pub fn stability(model: &Model, equilibrium: &Equilibrium) -> Result<Stability, ModesError> {
    ModesError::require_modes(model)?;
    let pencil = Pencil::about(model, equilibrium);
    let search = ModeSearch { to_hz: BAND_HZ, ..ModeSearch::default() };
    let found = eigenpairs(&pencil, &search)?;
    Ok(Stability::of(model, equilibrium, &pencil, &found, found.in_band(&search)))
}

/// The verdict on an equilibrium that the string leaves without vibrating about it, such as that of a buckled string on the hole's axis;
/// `None` if there is no such motion.
///
/// It takes a few milliseconds unless the stiffness is negative in some direction; only then the lowest modes, some tens of them, and the modes that
/// grow without vibrating are found. They are not counted, so that they never show that all modes decay.
pub fn static_stability(model: &Model, equilibrium: &Equilibrium) -> Option<Stability> {
    if negative_directions(model, equilibrium) == 0 {
        return None;
    }
    let pencil = Pencil::about(model, equilibrium);
    // One mode ends the search after its first shift, which yields all modes as low as that.
    let search = ModeSearch { to_hz: BAND_HZ, most: 1, ..ModeSearch::default() };
    let found = uncounted_eigenpairs(&pencil, &search).ok()?;
    let leaving = found.in_band(&search).filter(|pair| does_not_vibrate(pair));
    let verdict = Stability::of(model, equilibrium, &pencil, &found, leaving);
    verdict.instability.is_some().then_some(verdict)
}

/// Number of directions in which the stiffness of the equilibrium is negative, its contacts closed and without friction. Friction makes the
/// stiffness of a contact unsymmetric, so that its symmetric part is almost always negative in some direction; modes that friction excites vibrate.
fn negative_directions(model: &Model, equilibrium: &Equilibrium) -> usize {
    let system = model.system_of_all_motions(equilibrium);
    let mut stiffness = system.stiffness;
    for (node, site) in model.wall.touchable() {
        let [u, v, ..] = equilibrium.displacement[node];
        // Without a sliding speed there is no friction.
        let Some(tangent) = sliding_tangent(model.wall.law(), site, u, v, 0.0) else { continue };
        for (row, entries) in [U, V].into_iter().zip(tangent.stiffness) {
            for (column, entry) in [U, V].into_iter().zip(entries) {
                stiffness.diagonal[node][(row, column)] += entry;
            }
        }
    }
    model.add_force_tangents(&model.at_rest(&equilibrium.displacement), &mut stiffness, None);
    negative_eigenvalues(stiffness, &system.held)
}

impl Stability {
    /// The verdict on those of the eigenpairs found that are `judged`.
    fn of<'a>(
        model: &Model,
        equilibrium: &Equilibrium,
        pencil: &Pencil,
        found: &'a Found,
        judged: impl Iterator<Item = &'a Eigenpair> + Clone,
    ) -> Self {
        let growing = judged.filter(|pair| pair.value.re > NEUTRAL);
        let fastest = growing.clone().max_by(|a, b| a.value.re.total_cmp(&b.value.re));
        Self {
            stable: match (fastest, found.completeness) {
                (Some(_), _) => Some(false),
                (None, Completeness::Counted) => Some(true),
                (None, _) => None,
            },
            complete_to_hz: (found.complete_to / TAU).min(BAND_HZ),
            completeness: found.completeness,
            instability: fastest.map(|pair| {
                let mode = Mode::new(pencil, pair, &model.mesh.depths());
                Instability {
                    kind: kind(model, equilibrium, pencil, pair, mode.kind),
                    growth_rate: mode.growth_rate,
                    frequency_hz: mode.frequency_hz,
                    node: mode.node,
                    measured_depth: mode.measured_depth,
                    growing_modes: growing.count(),
                }
            }),
            includes_bit: WeakeningTorque::of(&model.scenario, &model.effects).is_some(),
        }
    }

    /// Warning, in words, that the string leaves its equilibrium; `None` if no motion was found to grow.
    pub fn warning(&self) -> Option<String> {
        let unstable = self.instability?;
        Some(format!(
            "the equilibrium is unstable: {} moves the string away from it, growing with {:.3} 1/s, most at {:.1} m; the string does not settle at its contacts, forces and torque, and its path away depends on the smallest disturbance",
            unstable.kind.in_words(),
            unstable.growth_rate,
            unstable.measured_depth
        ))
    }
}

/// True if a motion grows more than e times before it has turned by a radian: the string leaves the equilibrium and does not vibrate about it.
fn does_not_vibrate(pair: &Eigenpair) -> bool {
    pair.value.im < pair.value.re
}

/// Kind of a growing mode, by the largest source of its energy.
fn kind(
    model: &Model,
    equilibrium: &Equilibrium,
    pencil: &Pencil,
    pair: &Eigenpair,
    moves: ModeKind,
) -> InstabilityKind {
    let zero = || BlockTridiagonal::zeros(model.node_count());
    let [
        mut compression,
        mut torque,
        mut flow,
        mut coriolis,
        mut wall,
        mut rubbing,
        mut at_nodes,
        mut of_nodes,
    ] = std::array::from_fn(|_| zero());
    for (e, element) in model.elements.iter().enumerate() {
        if let Some(unit) = &element.tension_unit {
            add_element_matrix(&mut compression, e, &(unit * equilibrium.tension[e]));
        }
        if let Some(unit) = &element.torque_unit {
            add_element_matrix(&mut torque, e, &(unit * equilibrium.torque[e]));
        }
        if let Some(matrix) = &element.flow {
            add_element_matrix(&mut flow, e, matrix);
        }
        if let Some(momentum) = element.momentum.as_ref().filter(|_| model.effects.fluid_coriolis) {
            let matrix = element.chord.matrix_to_nodes(&element.beam.coriolis()) * momentum.coriolis;
            add_element_matrix(&mut coriolis, e, &matrix);
        }
    }
    add_contact(model, equilibrium, &mut wall, &mut rubbing);
    model.add_force_tangents(&model.at_rest(&equilibrium.displacement), &mut at_nodes, Some(&mut of_nodes));
    for matrix in [
        &mut compression,
        &mut torque,
        &mut flow,
        &mut coriolis,
        &mut wall,
        &mut rubbing,
        &mut at_nodes,
        &mut of_nodes,
    ] {
        clear_held(matrix, &pencil.held);
    }
    // Mean power of a force -(K + l C) x on the velocity l x.
    let power = |stiffness: &BlockTridiagonal, damping: Option<&BlockTridiagonal>| -> f64 {
        let mut force = times(stiffness, &pair.shape);
        if let Some(damping) = damping {
            for (force, damped) in force.iter_mut().zip(times(damping, &pair.shape)) {
                *force += pair.value * damped;
            }
        }
        let products = pair.shape.iter().zip(&force).map(|(x, force)| (pair.value * x).conj() * force);
        -products.sum::<Complex<f64>>().re
    };
    let powers = [
        power(&compression, None),
        power(&torque, None),
        power(&flow, Some(&coriolis)),
        power(&wall, Some(&rubbing)),
        power(&at_nodes, Some(&of_nodes)),
    ];
    let most = (0..powers.len()).max_by(|&a, &b| powers[a].total_cmp(&powers[b])).unwrap_or(0);
    let still = does_not_vibrate(pair);
    match most {
        _ if powers[most] <= 0.0 => InstabilityKind::Other,
        0 if still => InstabilityKind::Buckling,
        1 => InstabilityKind::TorqueBuckling,
        2 if still => InstabilityKind::FlowDivergence,
        2 => InstabilityKind::FlowFlutter,
        3 if moves == ModeKind::Torsional => InstabilityKind::StickSlip,
        3 => InstabilityKind::FrictionWhirl,
        4 if moves == ModeKind::Torsional => InstabilityKind::BitStickSlip,
        _ => InstabilityKind::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_growth_that_had_the_time_explains_a_divergence() {
        let unstable = Instability {
            kind: InstabilityKind::StickSlip,
            growth_rate: 0.657,
            frequency_hz: 2.2,
            node: 49,
            measured_depth: 57.7,
            growing_modes: 1,
        };
        let verdict = Stability {
            stable: Some(false),
            complete_to_hz: 20.0,
            completeness: Completeness::Counted,
            instability: Some(unstable),
            includes_bit: false,
        };
        assert!(!verdict.explains_divergence_at(0.023) && !verdict.explains_divergence_at(1.5));
        let early = verdict.of_divergence_at(0.023);
        assert!(
            early.starts_with("numerical or unexplained") && early.contains("a factor of 1.02"),
            "{early}"
        );
        assert_eq!(verdict.of_divergence_at(10.0), verdict.to_string());
        let stable = Stability { stable: Some(true), instability: None, ..verdict };
        assert!(
            stable.of_divergence_at(10.0).starts_with("numerical or unexplained: stable about"),
            "{stable}"
        );
        assert!(stable.to_string().ends_with("stick-slip at the bit is not judged"));
        let with_bit = Stability { includes_bit: true, ..stable };
        assert_eq!(with_bit.to_string(), "stable about its equilibrium up to 20 Hz");
    }
}
