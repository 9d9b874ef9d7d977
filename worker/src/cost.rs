//! A work-precision study: its runs side by side on all cores, each with its own processor time.

use drillsweep_sim::control::Control;
use drillsweep_sim::model::Model;
use drillsweep_sim::scenario::Scenario;
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::study::{CostReport, Measure, PlannedRun, plan, report};
use drillsweep_sim::transient::{Outcome, Transient};
use rayon::prelude::*;

use crate::compute::{ComputeError, Stopwatch};

/// Runs the scenario's cost study (`scenario.cost_study`, or the usual one where that is absent). Progress on `control`
/// counts the simulated time of all runs, [`study_time`] in all.
///
/// # Errors
/// When the scenario is not valid, the reference run fails, or it is cancelled.
pub fn cost_study(scenario: &Scenario, control: &Control) -> Result<CostReport, ComputeError> {
    scenario.validate().map_err(|problems| ComputeError::Invalid(problems.to_string()))?;
    let planned = plan(scenario)?;
    // The dearest runs stand last in every method; taken one by one, they fill the cores best.
    let runs: Vec<_> = planned
        .par_iter()
        .with_max_len(1)
        .map(|planned| match run(planned, control) {
            Err(ComputeError::Cancelled) => Err(ComputeError::Cancelled),
            other => Ok(other.map_err(|error| error.to_string())),
        })
        .collect::<Result<_, _>>()?;
    Ok(report(scenario, &planned, &runs)?)
}

/// Simulated time of all runs of the scenario's cost study \[s\]; zero where it cannot be planned.
pub fn study_time(scenario: &Scenario) -> f64 {
    plan(scenario).map_or(0.0, |planned| planned.iter().map(|planned| planned.scenario.duration).sum())
}

fn run(planned: &PlannedRun, control: &Control) -> Result<(Measure, f64), ComputeError> {
    let model = Model::new(&planned.scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let watch = Stopwatch::start();
    match Transient::member(&model, &equilibrium, planned.member)
        .and_then(|run| run.run(&control.part()))
        .map_err(ComputeError::Transient)?
    {
        Outcome::Finished(records) => {
            let (_, cpu_time) = watch.elapsed();
            Ok((Measure::new(&model, &equilibrium, &records), cpu_time))
        }
        Outcome::Cancelled | Outcome::Suspended(_) => Err(ComputeError::Cancelled),
    }
}
