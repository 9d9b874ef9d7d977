//! How fast this machine is: short runs whose steps are timed, so that plans can tell processor times.

use drillsweep_sim::control::Control;
use drillsweep_sim::model::Model;
use drillsweep_sim::plan::{MachineSpeed, RunTime, calibration_runs};
use drillsweep_sim::scenario::{Scenario, preset};
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::transient::{Outcome, Transient};

use crate::compute::{ComputeError, Stopwatch};

/// The scenario that a machine is measured with.
const BASE: &str = "paper-200m";

/// Times each run is made; the shortest counts, since others on the machine can only make it longer.
const REPETITIONS: usize = 3;

/// Measures this machine, in about half a second.
///
/// # Errors
/// When a run fails, which it does on no machine that computes correctly.
pub fn calibrate() -> Result<MachineSpeed, ComputeError> {
    let base = preset(BASE).ok_or_else(|| ComputeError::Invalid(format!("there is no preset {BASE}")))?;
    let model = Model::new(&base)?;
    let statics = shortest(|| {
        let watch = Stopwatch::start();
        Equilibrium::find(&model)?;
        Ok(watch.elapsed().1)
    })?;
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
    let mut steps = 0;
    let cpu_time = shortest(|| {
        let watch = Stopwatch::start();
        match Transient::new(&model, &equilibrium)?.run(&Control::new())? {
            Outcome::Finished(records) => {
                steps = records.effort.steps;
                Ok(watch.elapsed().1)
            }
            Outcome::Cancelled | Outcome::Suspended(_) => Err(ComputeError::Cancelled),
        }
    })?;
    Ok(RunTime { nodes: model.node_count(), steps, cpu_time })
}

fn shortest(mut time: impl FnMut() -> Result<f64, ComputeError>) -> Result<f64, ComputeError> {
    (0..REPETITIONS).try_fold(f64::INFINITY, |shortest, _| Ok(shortest.min(time()?)))
}
