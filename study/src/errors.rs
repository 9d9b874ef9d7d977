//! Errors of a result: parts of steps, mesh and sampling in the reported statistics, and their sum.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::ensemble::{PARTED, spread};
use crate::mesh_estimate::MeshEstimate;
use crate::sensitivity::Sensitivity;
use crate::summary::{OrbitSummary, TransientSummary};
use drillsweep_sim::solve::modes::UndampedTorsion;
use drillsweep_sim::solve::run::{DISTURBANCE, MotionRegime};

/// Errors of a result, relative to the statistics of the recorded orbits, each of the worst node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ResultErrors {
    /// Error of the steps.
    pub time: TimeError,
    /// Error of the mesh.
    pub mesh: MeshEstimate,
    /// Error of the window: the run has not settled, or its statistics scatter.
    #[serde(default)]
    pub sampling: SamplingError,
    /// Bound of the accuracy on the error of orbit size by steps, mesh and sampling together; absent if the accuracy sets none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promised: Option<f64>,
    /// Error of orbit size by steps, mesh and sampling together, the root of the sum of their squares, as of independent parts (JCGM 100:2008);
    /// absent if one of them is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whole: Option<f64>,
    /// Spread between runs that start next to each other.
    pub spread: SpreadError,
    /// Amplification of a disturbance by the scenario over the orbit window; absent if no twin was run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<Sensitivity>,
    /// True if the run's histories part from those of its twin, so that their error is not known.
    #[serde(default)]
    pub histories_part: bool,
}

/// The error of the steps of a run in orbit size and in the standard deviation of the radius, relative to them.
///
/// Each step leaves an error, which the embedded method estimates, and the scenario amplifies it until the end of the run as any
/// other disturbance. The amplification is measured by the distance from a twin that starts a micrometre away at the start of the orbit window,
/// or from the members of an ensemble. It varies between scenarios by three orders of magnitude, so an estimate without either is conditional.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum TimeError {
    /// Estimated with the amplification that a twin or an ensemble shows.
    Estimated {
        /// Relative error, the worst node.
        statistics: f64,
        /// Amplification by the scenario of a disturbance of the start at that node.
        amplification: f64,
    },
    /// Estimated under the condition that the scenario amplifies disturbances no more than most: one run does not show it.
    Conditional {
        /// Relative error, the worst node, on that condition.
        statistics: f64,
        /// The condition, in words.
        condition: String,
    },
    /// Not known.
    Unknown {
        /// Reason, in words.
        reason: String,
    },
}

/// The error of orbit size by the window of the statistics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum SamplingError {
    /// Largest relative difference between the windows that agree for regular motion; half width of the confidence interval for irregular motion.
    Estimated {
        /// Relative error, the worst node.
        orbit_size: f64,
    },
    /// Not known.
    Unknown {
        /// Reason, in words.
        reason: String,
    },
}

/// Difference between runs of the same scenario whose starts differ by [`DISTURBANCE`]: a property of the scenario, which no step makes smaller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum SpreadError {
    /// Measured on an ensemble.
    Measured {
        /// Members of the ensemble.
        members: usize,
        /// Standard deviation of orbit size over its mean, the worst node.
        orbit_size: f64,
        /// Standard deviation of the radius' standard deviation over its mean, the worst node.
        radius_deviation: f64,
    },
    /// Not known.
    Unknown {
        /// Reason, in words.
        reason: String,
    },
}

/// A member of an ensemble other than the undisturbed run.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherMember {
    /// Its summary.
    pub summary: TransientSummary,
    /// Root mean square distance from the undisturbed run over the orbit window, of each recorded node \[m\].
    pub distances: Vec<f64>,
}

/// Error of a statistic over the estimated error of the history, if the scenario neither amplifies nor damps a disturbance of the start. With it, and
/// if members stay together, the estimate covers nearly all scenarios of `benches/error_estimate.rs`, and is some six times too large in the
/// median. (The error of the history is a mean over all nodes, so the estimate is ten times too large if a recorded node hardly moves;
/// relative to the root mean square of all recorded orbits it is not, but misses nine runs more of 69.) With the amplification of a twin the whole
/// stated error of eleven settled runs of calm scenarios is 1.0 to 18 times the true one (docs/accuracy.md); no sensitive scenario was compared.
const SHARE_OF_HISTORY: f64 = 0.2;

/// Amplification assumed if none was measured, and the least amplification by an ensemble from the start of the run. Most scenarios stay below it
/// over half a minute; those that hardly damp amplify by hundreds.
const USUAL_AMPLIFICATION: f64 = 5.0;

/// Least amplification by a twin: an error of a step is not taken to die out.
const LEAST_AMPLIFICATION: f64 = 1.0;

/// Largest residual of the energy ledger, as a fraction of its bound, of a run whose error is estimated: usual runs have less than a hundredth.
const SOUND_RESIDUAL: f64 = 0.05;

/// Relative error beyond which an estimate counts as unknown.
const LARGEST_ESTIMATE: f64 = 0.5;

impl ResultErrors {
    /// The errors of a run, from its ensemble, its twin, the torsion that friction excites, the mesh's part and the accuracy's bound for orbit size.
    pub fn new(
        run: &TransientSummary,
        others: &[OtherMember],
        sensitivity: Option<Sensitivity>,
        torsion: Option<&UndampedTorsion>,
        mesh: MeshEstimate,
        promised: Option<f64>,
    ) -> Self {
        let time = TimeError::new(run, others, sensitivity.as_ref(), torsion);
        let sampling = SamplingError::new(run);
        let of_mesh = mesh.estimate().and_then(|errors| errors.orbit_size);
        let whole = [time.unconditional(), of_mesh, sampling.orbit_size()]
            .into_iter()
            .try_fold(0.0, |sum, part| Some(f64::hypot(sum, part?)));
        Self {
            time,
            mesh,
            sampling,
            promised,
            whole,
            spread: SpreadError::new(run, others),
            histories_part: sensitivity.as_ref().is_some_and(|twin| twin.parted(&run.orbits).is_some()),
            sensitivity,
        }
    }
}

impl TimeError {
    /// The error of a run, from its ensemble, its twin and the torsion that friction excites.
    pub fn new(
        run: &TransientSummary,
        others: &[OtherMember],
        twin: Option<&Sensitivity>,
        torsion: Option<&UndampedTorsion>,
    ) -> Self {
        let unknown = |reason: String| TimeError::Unknown { reason };
        if let Some(warning) = torsion.and_then(|torsion| torsion.warning(run.resolved_hz)) {
            return unknown(warning);
        }
        if run.unresolved_steps > 0 {
            return unknown(format!(
                "{} steps of the shortest length exceeded the tolerance",
                run.unresolved_steps
            ));
        }
        if let Some(residual) = run.energy_residual_of_bound.filter(|residual| *residual > SOUND_RESIDUAL) {
            return unknown(format!(
                "the residual of the energy ledger is {:.0} % of its bound: the steps create or lose energy, as in contact chatter on a stiff \
                 wall; a smaller tolerance helps",
                100.0 * residual
            ));
        }
        if let Some((twin, orbit)) = twin.and_then(|twin| Some((twin, twin.parted(&run.orbits)?))) {
            return unknown(format!(
                "{twin}, which is comparable with the orbit at {} m: the errors of the steps are amplified in the same way",
                orbit.measured_depth
            ));
        }
        let distance = |node: usize| {
            let of_members = others.iter().filter_map(|other| other.distances.get(node));
            let of_twin = twin.and_then(|twin| twin.distances.get(node));
            of_members.chain(of_twin).copied().fold(0.0, f64::max)
        };
        let parted =
            |(node, orbit): &(usize, &OrbitSummary)| distance(*node) > PARTED * orbit.orbit_radius_rms;
        if let Some((node, orbit)) = run.orbits.iter().enumerate().find(parted) {
            return unknown(format!(
                "runs that start {DISTURBANCE:e} m apart differ by {:.1e} m at {} m, with an orbit size of {:.1e} m: the errors of the \
                 steps are amplified in the same way",
                distance(node),
                orbit.measured_depth,
                orbit.orbit_radius_rms
            ));
        }
        let least =
            if twin.is_some() && others.is_empty() { LEAST_AMPLIFICATION } else { USUAL_AMPLIFICATION };
        let amplified = run.orbits.iter().enumerate().map(|(node, orbit)| {
            let amplification = (distance(node) / DISTURBANCE).max(least);
            let error = SHARE_OF_HISTORY * amplification * run.error_estimate.displacement;
            (if error == 0.0 { 0.0 } else { error / orbit.orbit_radius_rms }, amplification)
        });
        let Some((statistics, amplification)) = amplified.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            return unknown("no node is recorded over the orbit window".into());
        };
        if statistics > LARGEST_ESTIMATE || !statistics.is_finite() {
            return unknown(format!(
                "the errors of the steps, amplified by {amplification:.0} like any disturbance of this scenario, reach half of the orbit \
                 size or more; a smaller tolerance reduces them"
            ));
        }
        if others.is_empty() && twin.is_none() {
            let condition =
                "the scenario amplifies disturbances no more than most do; ensemble=2 measures it";
            return TimeError::Conditional { statistics, condition: condition.into() };
        }
        TimeError::Estimated { statistics, amplification }
    }

    /// The estimate if it is unconditional; absent otherwise.
    pub fn unconditional(&self) -> Option<f64> {
        match self {
            TimeError::Estimated { statistics, .. } => Some(*statistics),
            TimeError::Conditional { .. } | TimeError::Unknown { .. } => None,
        }
    }

    /// The estimate, conditional or not; absent if it is not known.
    pub fn statistics(&self) -> Option<f64> {
        match self {
            TimeError::Estimated { statistics, .. } | TimeError::Conditional { statistics, .. } => {
                Some(*statistics)
            }
            TimeError::Unknown { .. } => None,
        }
    }
}

impl SamplingError {
    fn new(run: &TransientSummary) -> Self {
        let settling = &run.settling;
        let unknown = |reason: String| SamplingError::Unknown { reason };
        let estimated = match settling.regime {
            MotionRegime::Regular => settling.windows_differ,
            MotionRegime::Irregular => {
                let relative = run
                    .orbits
                    .iter()
                    .filter_map(|orbit| Some(orbit.interval?.orbit_radius_rms / orbit.orbit_radius_rms));
                relative.reduce(f64::max)
            }
            MotionRegime::NotSettled => return unknown("the motion has not settled".into()),
            MotionRegime::Fixed => {
                return unknown("the window is fixed: the motion was not tested for having settled".into());
            }
        };
        match estimated.filter(|error| error.is_finite()) {
            Some(orbit_size) => SamplingError::Estimated { orbit_size },
            None => unknown("no node moves".into()),
        }
    }

    /// The estimate; absent if it is not known.
    pub fn orbit_size(&self) -> Option<f64> {
        match self {
            SamplingError::Estimated { orbit_size } => Some(*orbit_size),
            SamplingError::Unknown { .. } => None,
        }
    }
}

impl Default for SamplingError {
    fn default() -> Self {
        SamplingError::Unknown { reason: "it was not estimated".into() }
    }
}

impl SpreadError {
    fn new(run: &TransientSummary, others: &[OtherMember]) -> Self {
        if others.is_empty() {
            return SpreadError::Unknown { reason: "one run has no spread; ensemble=8 measures it".into() };
        }
        let worst = |value: fn(&OrbitSummary) -> f64| {
            let of_node = |node: usize| {
                let members = std::iter::once(run).chain(others.iter().map(|other| &other.summary));
                let values: Vec<f64> =
                    members.filter_map(|member| member.orbits.get(node)).map(value).collect();
                spread(&values)
                    .map_or(0.0, |(mean, deviation)| if deviation > 0.0 { deviation / mean } else { 0.0 })
            };
            (0..run.orbits.len()).map(of_node).fold(0.0, f64::max)
        };
        SpreadError::Measured {
            members: 1 + others.len(),
            orbit_size: worst(|orbit| orbit.orbit_radius_rms),
            radius_deviation: worst(|orbit| orbit.radius_deviation),
        }
    }

    /// Standard deviation of orbit size over its mean; absent if it is not known.
    pub fn orbit_size(&self) -> Option<f64> {
        match self {
            SpreadError::Measured { orbit_size, .. } => Some(*orbit_size),
            SpreadError::Unknown { .. } => None,
        }
    }
}

/// One line: the bound, the stated error, and its parts.
impl fmt::Display for ResultErrors {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |part: Option<f64>| match part {
            Some(part) => format!("{:.2} %", 100.0 * part),
            None => "not known".to_owned(),
        };
        write!(formatter, "error of orbit size: ")?;
        if let Some(promised) = self.promised {
            write!(formatter, "{} promised, ", percent(Some(promised)))?;
        }
        write!(
            formatter,
            "{} stated (steps {}, mesh {}, sampling {})",
            percent(self.whole),
            percent(self.time.unconditional()),
            percent(self.mesh.estimate().and_then(|errors| errors.orbit_size)),
            percent(self.sampling.orbit_size())
        )?;
        match (self.promised, self.whole) {
            (Some(promised), Some(whole)) if whole > promised => write!(formatter, ": MORE than promised"),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for SamplingError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SamplingError::Estimated { orbit_size } => {
                write!(formatter, "error of orbit size by sampling: {orbit_size:.1e}")
            }
            SamplingError::Unknown { reason } => {
                write!(formatter, "error of orbit size by sampling: not known ({reason})")
            }
        }
    }
}

impl fmt::Display for TimeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TimeError::Estimated { statistics, amplification } => write!(
                formatter,
                "error of statistics by steps: {:.1e}, estimated for a scenario that amplifies disturbances by {amplification:.0}",
                statistics
            ),
            TimeError::Conditional { statistics, condition } => {
                write!(
                    formatter,
                    "error of statistics by steps: {statistics:.1e}, estimated, provided that {condition}"
                )
            }
            TimeError::Unknown { reason } => {
                write!(formatter, "error of statistics by steps: not known ({reason})")
            }
        }
    }
}

impl fmt::Display for SpreadError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SpreadError::Measured { members, orbit_size, radius_deviation } => write!(
                formatter,
                "spread of {members} runs that start 1e-6 m apart: {orbit_size:.1e} of orbit size, {radius_deviation:.1e} of the radius' \
                 standard deviation"
            ),
            SpreadError::Unknown { reason } => write!(formatter, "spread: not known ({reason})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::TimeWindow;

    use super::*;
    use crate::mesh_estimate::MeshErrors;
    use drillsweep_sim::solve::run::{ErrorEstimate, OrbitInterval};

    /// A run with orbits of 1 mm and an error of the history of 10 um.
    fn run() -> TransientSummary {
        let orbit = |node| OrbitSummary {
            measured_depth: 10.0 * node as f64,
            offset: 0.0,
            mean_radius: 0.03,
            largest_radius: 0.04,
            ..OrbitSummary::of(node, 1e-3, 1e-4)
        };
        TransientSummary {
            resolved_hz: 40.0,
            error_estimate: ErrorEstimate { displacement: 1e-5, relative: 0.01 },
            energy_residual_of_bound: Some(0.0),
            ..TransientSummary::of(vec![orbit(1), orbit(2)])
        }
    }

    fn other(distances: [f64; 2], size: f64) -> OtherMember {
        let mut summary = run();
        summary.orbits[1].orbit_radius_rms = size;
        OtherMember { summary, distances: distances.to_vec() }
    }

    #[test]
    fn an_ensemble_scales_the_estimate_by_its_largest_amplification() {
        let run = run();
        let alone = TimeError::new(&run, &[], None, None);
        assert!(
            matches!(alone, TimeError::Conditional { statistics, .. } if (statistics - 0.01).abs() < 1e-12)
        );
        let others = [other([1e-6, 2e-6], 1e-3), other([3e-6, 2e-5], 1e-3)];
        let TimeError::Estimated { statistics, amplification } = TimeError::new(&run, &others, None, None)
        else {
            panic!("members stay together")
        };
        assert!((amplification - 20.0).abs() < 1e-9 && (statistics - 0.04).abs() < 1e-12);
        let parted = TimeError::new(&run, &[other([0.0, 1.1e-4], 1e-3)], None, None);
        assert!(matches!(parted, TimeError::Unknown { .. }), "{parted:?}");
    }

    #[test]
    fn a_twin_makes_an_estimate_unconditional_and_one_that_parts_unknown() {
        let run = run();
        let twin = |distances: Vec<f64>| Sensitivity {
            window: TimeWindow { from: 0.0, to: 1.0 },
            amplification: distances.iter().copied().reduce(f64::max).map(|distance| distance / DISTURBANCE),
            growth_rate: None,
            distances,
        };
        let near = twin(vec![1e-6, 2e-5]);
        let told = TimeError::new(&run, &[], Some(&near), None);
        assert!((told.unconditional().unwrap() - 0.04).abs() < 1e-12, "{told:?}");
        assert_eq!(TimeError::new(&run, &[], None, None).unconditional(), None);
        for parted in [twin(vec![0.0, 1.1e-4]), twin(Vec::new())] {
            let told = TimeError::new(&run, &[], Some(&parted), None);
            assert!(matches!(told, TimeError::Unknown { .. }), "{told:?}");
        }
    }

    #[test]
    fn the_whole_error_is_of_parts_that_are_all_known() {
        let mesh = |orbit_size| {
            MeshEstimate::Estimated(MeshErrors {
                mean_radius: None,
                static_position: 0.0,
                friction_coefficient: None,
                orbit_size,
            })
        };
        let twin = Sensitivity {
            window: TimeWindow { from: 0.0, to: 1.0 },
            amplification: Some(1.0),
            growth_rate: None,
            distances: vec![1e-6; 2],
        };
        let errors = |run: &TransientSummary, orbit_size| {
            ResultErrors::new(run, &[], Some(twin.clone()), None, mesh(orbit_size), Some(0.02))
        };
        let mut settled = run();
        (settled.settling.regime, settled.settling.windows_differ) = (MotionRegime::Regular, Some(0.003));
        let whole = errors(&settled, Some(0.004));
        // A fifth of 10 um in 1 mm.
        assert!((whole.whole.unwrap() - 29e-6_f64.sqrt()).abs() < 1e-12, "{whole:?}");
        assert!(whole.to_string().contains("2.00 % promised, 0.54 % stated"), "{whole}");
        assert!(!whole.to_string().contains("MORE"));
        assert!(errors(&settled, Some(0.02)).to_string().ends_with("MORE than promised"));
        assert_eq!(errors(&settled, None).whole, None);
        for regime in [MotionRegime::Fixed, MotionRegime::NotSettled] {
            let mut other = settled.clone();
            other.settling.regime = regime;
            assert_eq!(errors(&other, Some(0.004)).whole, None);
        }
        let mut scatters = settled.clone();
        (scatters.settling.regime, scatters.settling.windows_differ) = (MotionRegime::Irregular, None);
        for orbit in &mut scatters.orbits {
            orbit.interval = Some(OrbitInterval { orbit_radius_rms: 5e-5, radius_deviation: 0.0 });
        }
        assert!((errors(&scatters, Some(0.0)).whole.unwrap() - 0.05_f64.hypot(0.002)).abs() < 1e-12);
    }

    #[test]
    fn unresolved_motion_has_no_estimate() {
        let sound = TransientSummary { energy_residual_of_bound: Some(0.04), ..run() };
        assert!(TimeError::new(&sound, &[], None, None).statistics().is_some());
        for unsound in [
            TransientSummary { energy_residual_of_bound: Some(0.06), ..run() },
            TransientSummary { unresolved_steps: 1, ..run() },
            TransientSummary { orbits: vec![], ..run() },
            TransientSummary {
                error_estimate: ErrorEstimate { displacement: f64::NAN, relative: 0.0 },
                ..run()
            },
            TransientSummary { error_estimate: ErrorEstimate { displacement: 1e-3, relative: 1.0 }, ..run() },
        ] {
            let told = TimeError::new(&unsound, &[], None, None);
            assert!(matches!(told, TimeError::Unknown { .. }), "{told:?}");
        }
    }

    #[test]
    fn spread_is_that_of_the_worst_node() {
        let SpreadError::Measured { members, orbit_size, radius_deviation } =
            SpreadError::new(&run(), &[other([0.0; 2], 1.2e-3)])
        else {
            panic!("measured")
        };
        // 1 and 1.2 mm: a standard deviation of 0.2 / sqrt 2 about 1.1.
        assert_eq!((members, radius_deviation), (2, 0.0));
        assert!((orbit_size - 0.2 / 2.0_f64.sqrt() / 1.1).abs() < 1e-12);
        assert_eq!(SpreadError::new(&run(), &[]).orbit_size(), None);
    }
}
