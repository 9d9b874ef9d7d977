//! Amplification of a disturbance by a scenario: a twin of the run that starts next to it in the window of its statistics.
//!
//! Errors of steps are disturbances, too, and are amplified alike. The cost of the twin, relative to the run, is the window's share of the run, a
//! third at most.

use std::fmt;

use drillsweep_scenario::TimeWindow;
use serde::{Deserialize, Serialize};

use super::ensemble::PARTED;
use super::summary::OrbitSummary;
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{
    Block, CheckpointError, DISTURBANCE, Histories, Outcome, Records, Series, Transient, TransientError,
    twin_time,
};
use drillsweep_sim::solve::statics::Equilibrium;

/// Distance from the run of a twin that starts [`DISTURBANCE`] away.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Sensitivity {
    /// Window from the start to the end of the twin \[s\].
    pub window: TimeWindow,
    /// Largest distance of any recorded node from the run's over that of the start; absent if the twin diverged.
    pub amplification: Option<f64>,
    /// Growth of the largest distance from the first half of the window to the second \[1/s\]; absent if the twin diverged or nothing moved.
    pub growth_rate: Option<f64>,
    /// Largest distance of each recorded node \[m\]; empty if the twin diverged.
    #[serde(skip)]
    pub distances: Vec<f64>,
}

/// Reason for which the sensitivity of a run is not known.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SensitivityError {
    /// The run was cancelled or suspended.
    #[error("the run's twin was stopped")]
    Stopped,
    /// The twin cannot be set up.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The run's histories cannot be read.
    #[error(transparent)]
    Run(#[from] TransientError),
}

impl Sensitivity {
    /// Runs the twin of a finished run; none if no node is recorded.
    ///
    /// # Errors
    /// The run is stopped, or its histories cannot be read.
    pub fn of<H: Histories>(
        model: &Model,
        equilibrium: &Equilibrium,
        run: &Records<H>,
        control: &Control,
    ) -> Result<Option<Self>, SensitivityError>
    where
        H::Error: fmt::Display,
    {
        let longest = twin_time(run.settling.window, run.simulated_time);
        let nodes = run.histories.nodes().len();
        let (Some(start), true) = (&run.window_start, nodes > 0) else { return Ok(None) };
        let twin = Transient::twin(model, equilibrium, start, longest)?;
        let from = twin.recorded() as usize;
        let left = run.histories.samples().saturating_sub(from);
        let samples = ((longest * run.rate_hz).round() as usize).min(left);
        let time = samples as f64 / run.rate_hz;
        let mut distances = vec![[0.0_f64; 2]; nodes];
        let mut next = from;
        let mut compare = |block: Block<'_>| -> Result<(), String> {
            let count = block.histories.first().map_or(0, |first| first.u.len());
            let count = count.min(run.histories.samples().saturating_sub(next));
            for (index, (twin, largest)) in block.histories.iter().zip(&mut distances).enumerate() {
                let read =
                    |series| run.histories.read(index, series, next..next + count).map_err(|e| e.to_string());
                let (u, v) = (read(Series::U)?, read(Series::V)?);
                for k in 0..count {
                    let half = usize::from(2 * (next + k - from) >= samples);
                    let distance = (twin.u[k] - u[k]).hypot(twin.v[k] - v[k]);
                    largest[half] = largest[half].max(distance);
                }
            }
            next += count;
            Ok(())
        };
        let window = TimeWindow { from: from as f64 / run.rate_hz, to: from as f64 / run.rate_hz + time };
        match twin.run_into(&control.part(), &mut compare) {
            Ok(Outcome::Finished(_)) => {}
            Ok(Outcome::Cancelled | Outcome::Suspended(..)) => return Err(SensitivityError::Stopped),
            Err(TransientError::Diverged { .. }) => {
                return Ok(Some(Self {
                    window,
                    amplification: None,
                    growth_rate: None,
                    distances: Vec::new(),
                }));
            }
            Err(error) => return Err(error.into()),
        }
        let [before, after] = [0, 1].map(|half| distances.iter().map(|node| node[half]).fold(0.0, f64::max));
        let growth = (after / before).ln() / (0.5 * time);
        Ok(Some(Self {
            window,
            amplification: Some(before.max(after) / DISTURBANCE),
            growth_rate: growth.is_finite().then_some(growth),
            distances: distances.iter().map(|[before, after]| before.max(*after)).collect(),
        }))
    }

    /// The first recorded node at which run and twin have parted, by its orbit. All have if the twin diverged, and none if the distance
    /// never exceeds that of the start.
    pub fn parted<'a>(&self, orbits: &'a [OrbitSummary]) -> Option<&'a OrbitSummary> {
        let distance = |node: usize| self.distances.get(node).copied().unwrap_or(f64::INFINITY);
        let has_parted = |(node, orbit): &(usize, &OrbitSummary)| {
            distance(*node) > DISTURBANCE.max(PARTED * orbit.orbit_radius_rms)
        };
        orbits.iter().enumerate().find(has_parted).map(|(_, orbit)| orbit)
    }
}

impl fmt::Display for Sensitivity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TimeWindow { from, to } = self.window;
        match self.amplification {
            Some(amplification) => write!(
                formatter,
                "a start {DISTURBANCE:e} m away at {from:.1} s is amplified by {amplification:.3} until {to:.1} s"
            ),
            None => write!(formatter, "a run that starts {DISTURBANCE:e} m away at {from:.1} s diverges"),
        }
    }
}
