//! How fast this machine is: short runs whose steps are timed, so that plans can tell processor times.

use drillsweep_sim::control::Control;
use drillsweep_sim::model::Model;
use drillsweep_sim::plan::{MachineSpeed, calibration_runs};
use drillsweep_sim::scenario::{Scenario, preset};
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::transient::{Outcome, Transient};

use crate::compute::{ComputeError, Stopwatch};

/// The scenario that a machine is measured with.
const BASE: &str = "paper-200m";

/// Measures this machine, in about half a second: every method once to warm up and once for its time.
///
/// # Errors
/// When a run fails, which it does on no machine that computes correctly.
pub fn calibrate() -> Result<MachineSpeed, ComputeError> {
    let base = preset(BASE).ok_or_else(|| ComputeError::Invalid(format!("there is no preset {BASE}")))?;
    let model = Model::new(&base)?;
    Equilibrium::find(&model)?;
    let watch = Stopwatch::start();
    Equilibrium::find(&model)?;
    let (_, statics) = watch.elapsed();
    let mut runs = Vec::new();
    for run in calibration_runs(&base) {
        time_of(&run.scenario)?;
        let (steps, time) = time_of(&run.scenario)?;
        runs.push((run, steps, time));
    }
    Ok(MachineSpeed::from_times(statics, model.node_count(), runs))
}

/// Steps of a run in time and their processor time \[s\].
fn time_of(scenario: &Scenario) -> Result<(u64, f64), ComputeError> {
    let model = Model::new(scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let watch = Stopwatch::start();
    match Transient::new(&model, &equilibrium)?.run(&Control::new())? {
        Outcome::Finished(records) => Ok((records.effort.steps, watch.elapsed().1)),
        Outcome::Cancelled | Outcome::Suspended(_) => Err(ComputeError::Cancelled),
    }
}
