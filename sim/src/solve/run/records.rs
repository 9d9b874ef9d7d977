//! Results of a run.

use drillsweep_scenario::{Scenario, TimeStepping, TimeWindow};
use serde::{Deserialize, Serialize};

use super::checkpoint::Checkpoint;
use super::contact_statistics::ContactStatistics;
use super::histories::NodeHistory;
use super::loads::LoadRecords;
use super::settle::Settling;
use crate::math::signal::Course;
use crate::solve::step::{ContactIterations, EnergyRow, ErrorEstimate};

/// Results of a finished run, with its [`Histories`](super::Histories).
#[derive(Debug, Clone, PartialEq)]
pub struct Records<H = Vec<NodeHistory>> {
    /// Recording rate \[Hz\].
    pub rate_hz: f64,
    /// Length of the run \[s\]: the scenario's duration, or at most that if its window is settled.
    pub simulated_time: f64,
    /// Window of the run's statistics, and the verdict on its settling.
    pub settling: Settling,
    /// Motion of the recorded nodes and of the bit at a lower rate: of the whole run if the window is settled, of the window if it
    /// is fixed.
    pub course: Course,
    /// Histories of the recorded nodes.
    pub histories: H,
    /// The run at the start of its orbit window, or a tenth of a second after it; absent if that is the end.
    pub window_start: Option<Box<Checkpoint>>,
    /// Loads of every node and element over the window of the statistics.
    pub loads: LoadRecords,
    /// Contact statistics of every node.
    pub contacts: Vec<ContactStatistics>,
    /// The energy ledger, ten rows a second and one at the end.
    pub energy: Vec<EnergyRow>,
    /// Bound of the last row's residual \[J\]; a run that exceeds it ends as diverged.
    pub energy_bound: f64,
    /// Residual that rounding alone may leave \[J\]: smaller works have no meaning.
    pub energy_rounding: f64,
    /// Estimated error of the lateral displacements.
    pub error: ErrorEstimate,
    /// Effort of the run.
    pub effort: TransientEffort,
}

/// Effort of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TransientEffort {
    /// Integrator and step as used.
    pub stepping: TimeStepping,
    /// Parts into which each step was cut so that the contact iterations are stable.
    pub subdivisions: u32,
    /// Steps made.
    pub steps: u64,
    /// Steps that left more than the tolerance and were made again, shorter.
    pub rejected_steps: u64,
    /// Steps of the shortest length that left more than the tolerance.
    pub unresolved_steps: u64,
    /// The shortest and the longest step made \[s\].
    pub step_range: [f64; 2],
    /// Frequency \[Hz\] up to which the longest step resolves a vibration: its period to a thousandth, and its amplitude to a thousandth
    /// in each period.
    pub resolved_hz: f64,
    /// Contact iterations, with their distance from convergence.
    pub contact_iterations: ContactIterations,
}

/// Outcome of a call to [`Transient::run`](super::Transient::run).
#[derive(Debug)]
pub enum Outcome<H = Vec<NodeHistory>> {
    /// The run is complete.
    Finished(Box<Records<H>>),
    /// It was cancelled.
    Cancelled,
    /// The run was suspended, and continues from here; with the samples so far.
    Suspended(Box<Checkpoint>, H),
}

impl<H> Records<H> {
    /// The windows whose spectra are summarised: the scenario's fixed ones, or the end of the settled one.
    pub fn spectrum_windows(&self, scenario: &Scenario) -> Vec<TimeWindow> {
        scenario.spectrum_windows().unwrap_or_else(|| vec![self.settling.kept_window()])
    }
}

impl Records<()> {
    /// The same with histories that are kept elsewhere.
    pub fn with_histories<H>(self, histories: H) -> Records<H> {
        let Self {
            rate_hz,
            simulated_time,
            settling,
            course,
            histories: (),
            window_start,
            loads,
            contacts,
            energy,
            energy_bound,
            energy_rounding,
            error,
            effort,
        } = self;
        Records {
            rate_hz,
            simulated_time,
            settling,
            course,
            histories,
            window_start,
            loads,
            contacts,
            energy,
            energy_bound,
            energy_rounding,
            error,
            effort,
        }
    }
}
