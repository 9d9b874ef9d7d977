//! Speed of this machine, from short runs whose steps are timed, so that plans can predict processor times.

use drillsweep_scenario::{Scenario, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_study::plan::{MachineSpeed, RunTime, calibration_runs};

use crate::error::ComputeError;
use crate::stopwatch::Stopwatch;

/// The scenario that a machine is measured with.
const BASE: &str = "paper-200m";

/// Times each run is made; the shortest counts, since others on the machine can only make it longer.
const REPETITIONS: usize = 5;

/// Measures this machine, in about a second.
///
/// # Errors
/// A run fails, which it does on no machine that computes correctly.
pub fn calibrate() -> Result<MachineSpeed, ComputeError> {
    let base = preset(BASE).ok_or_else(|| ComputeError::Invalid(format!("there is no preset {BASE}")))?;
    let model = Model::new(&base)?;
    let mut statics = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let watch = Stopwatch::start();
        Equilibrium::find(&model)?;
        statics = statics.min(watch.elapsed().1);
    }
    let times = calibration_runs(&base).into_iter().map(|run| {
        let time = time_of(&run.scenario)?;
        Ok((run, time))
    });
    let times: Vec<_> = times.collect::<Result<_, ComputeError>>()?;
    Ok(MachineSpeed::from_times(statics / model.node_count() as f64, times))
}

fn time_of(scenario: &Scenario) -> Result<RunTime, ComputeError> {
    let model = Model::new(scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let mut time = RunTime {
        nodes: model.node_count(),
        steps: 0,
        start_cpu_time: f64::INFINITY,
        steps_cpu_time: f64::INFINITY,
    };
    for _ in 0..REPETITIONS {
        let watch = Stopwatch::start();
        let run = Transient::new(&model, &equilibrium).map_err(ComputeError::Transient)?;
        time.start_cpu_time = time.start_cpu_time.min(watch.elapsed().1);
        let watch = Stopwatch::start();
        match run.run(&Control::new()).map_err(ComputeError::Transient)? {
            Outcome::Finished(records) => {
                time.steps = records.effort.steps;
                time.steps_cpu_time = time.steps_cpu_time.min(watch.elapsed().1);
            }
            Outcome::Cancelled | Outcome::Suspended(..) => return Err(ComputeError::Cancelled),
        }
    }
    Ok(time)
}
