//! Provenance of a result: code, method, machine, times and cost.

use drillsweep_scenario::TimeStepping;
use drillsweep_sim::solve::modes::UndampedTorsion;
use drillsweep_sim::solve::run::{ErrorEstimate, Records};
use drillsweep_study::errors::ResultErrors;
use jiff::Timestamp;
use serde::Serialize;

/// Versions, integrator, steps and cost of a result, as it is stored.
#[derive(Debug, Clone, Serialize)]
pub struct Provenance {
    /// Version of the program.
    pub version: &'static str,
    /// Version of its numbers.
    pub physics_version: u32,
    /// Architecture of the processor.
    pub target: &'static str,
    /// Elements of the mesh.
    pub elements: usize,
    /// Newton iterations of the equilibrium, all passes together.
    pub newton_iterations: usize,
    /// Passes of equilibrium and mud until both had converged.
    pub hydraulic_passes: usize,
    /// Time by the clock for the equilibrium \[s\].
    pub statics_wall_time: f64,
    /// Processor time for the equilibrium \[s\].
    pub statics_cpu_time: f64,
    /// The run in time, if there is one.
    #[serde(flatten)]
    pub run: Option<RunProvenance>,
    /// Errors by steps and by the mesh, and spread.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<ResultErrors>,
    /// The torsional modes that velocity-weakening friction feeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undamped_torsion: Option<UndampedTorsion>,
    /// Warnings about valid scenarios that are probably not meant, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The worker that computed it; none of a point that is computed without a queue.
    #[serde(flatten)]
    pub worker: Option<WorkerProvenance>,
}

/// Provenance of a run in time.
#[derive(Debug, Clone, Serialize)]
pub struct RunProvenance {
    /// Method, step, tolerance and contact iterations.
    #[serde(flatten)]
    stepping: Stepping,
    /// Parts that a step of the scenario was cut into for stability.
    step_subdivisions: u32,
    /// Steps taken.
    pub steps: u64,
    /// Steps that left more than the tolerance and were taken again with shorter ones.
    rejected_steps: u64,
    /// Steps of the shortest length that left more than the tolerance.
    unresolved_steps: u64,
    /// Shortest step taken \[s\].
    pub shortest_step: f64,
    /// Longest step taken \[s\].
    pub longest_step: f64,
    /// Contact iterations made.
    #[serde(rename = "sweeps")]
    contact_iterations: u64,
    /// Largest change of a touching node's lateral displacement in the last iteration of any solve \[m\].
    #[serde(rename = "sweep_largest_change")]
    largest_contact_change: f64,
    /// Solves whose contact iterations had not converged.
    loose_solves: u64,
    /// Estimated error of the history.
    error_estimate: ErrorEstimate,
    /// Meaning of that estimate, for people.
    error_estimate_of: &'static str,
    /// True if the run continued from a checkpoint.
    resumed: bool,
    /// Time by the clock \[s\].
    pub transient_wall_time: f64,
    /// Processor time \[s\].
    pub transient_cpu_time: f64,
}

/// Reported part of the stepping.
#[derive(Debug, Clone, Serialize)]
struct Stepping {
    integrator: drillsweep_scenario::Integrator,
    step: f64,
    tolerance: Option<f64>,
    contact_sweeps: u32,
}

/// Worker that computed a result, and when.
#[derive(Debug, Clone, Serialize)]
pub struct WorkerProvenance {
    /// The machine.
    pub host: String,
    /// Identifier of the worker process.
    pub worker: String,
    /// The claim under which it was computed: grows with every claim of the same work.
    pub fencing_token: i64,
    /// Start by that host's clock: for people, nothing is decided by it.
    pub started: Timestamp,
    /// End, likewise.
    pub ended: Timestamp,
}

/// Meaning of the error estimate, for people.
const ERROR_ESTIMATE_OF: &str = "root mean square error of a lateral displacement over all nodes at the end of the run, \
                                 as long as histories do not part: displacement [m], and relative to the motion";

impl RunProvenance {
    /// Provenance of a finished run, which may have been resumed, with its time by the clock and its processor time \[s\].
    pub(crate) fn new<H>(records: &Records<H>, resumed: bool, (wall_time, cpu_time): (f64, f64)) -> Self {
        let effort = &records.effort;
        let TimeStepping { integrator, step, tolerance, contact_sweeps, .. } = effort.stepping;
        Self {
            stepping: Stepping { integrator, step, tolerance, contact_sweeps },
            step_subdivisions: effort.subdivisions,
            steps: effort.steps,
            rejected_steps: effort.rejected_steps,
            unresolved_steps: effort.unresolved_steps,
            shortest_step: effort.step_range[0],
            longest_step: effort.step_range[1],
            contact_iterations: effort.contact_iterations.count,
            largest_contact_change: effort.contact_iterations.largest_change,
            loose_solves: effort.contact_iterations.loose_solves,
            error_estimate: records.error,
            error_estimate_of: ERROR_ESTIMATE_OF,
            resumed,
            transient_wall_time: wall_time,
            transient_cpu_time: cpu_time,
        }
    }
}
