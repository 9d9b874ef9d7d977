//! A work-precision study: its runs side by side on all cores, each with its own processor time.

use drillsweep_scenario::Scenario;
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;
use drillsweep_study::cost::{CostReport, Measure, PlannedRow, plan, report};
use drillsweep_study::plan::MachineSpeed;
use drillsweep_study::plan::expected_cpu_time;
use rayon::prelude::*;

use crate::error::ComputeError;
use crate::stopwatch::Stopwatch;

/// Runs the scenario's cost study (`scenario.cost_study`, or the usual one if that is absent). Progress on `control`
/// counts the simulated time of all runs, [`study_time`] in all.
///
/// # Errors
/// The scenario is not valid, both methods of the reference fail, or it is cancelled.
pub fn cost_study(scenario: &Scenario, control: &Control) -> Result<CostReport, ComputeError> {
    validate(scenario).map_err(|problems| ComputeError::Invalid(problems.to_string()))?;
    let planned = plan(scenario)?;
    let members = planned.iter().flat_map(|row| row.members.clone().map(move |member| (row, member)));
    let members: Vec<_> = members.collect();
    // The reference's runs, the dearest, stand first; taken one by one, they fill the cores best.
    let runs: Vec<_> = members
        .par_iter()
        .with_max_len(1)
        .map(|&(row, member)| match run(row, member, control) {
            Err(ComputeError::Cancelled) => Err(ComputeError::Cancelled),
            other => Ok(other.map_err(|error| error.to_string())),
        })
        .collect::<Result<_, _>>()?;
    let mut runs = runs.into_iter();
    let by_row: Vec<Vec<_>> =
        planned.iter().map(|row| runs.by_ref().take(row.members.len()).collect()).collect();
    Ok(report(scenario, &planned, &by_row)?)
}

/// Simulated time of all runs of the scenario's cost study \[s\]; zero if it cannot be planned.
pub fn study_time(scenario: &Scenario) -> f64 {
    let time = |row: &PlannedRow| row.members.len() as f64 * row.scenario.duration;
    plan(scenario).map_or(0.0, |planned| planned.iter().map(time).sum())
}

/// Processor time that the scenario's cost study is expected to take on a machine of this speed \[s\], and how many of its lines
/// that leaves out, since their steps adapt themselves.
///
/// # Errors
/// The study cannot be planned.
pub fn study_cpu_time(scenario: &Scenario, speed: &MachineSpeed) -> Result<(f64, usize), ComputeError> {
    Ok(expected_cpu_time(&plan(scenario)?, speed))
}

fn run(planned: &PlannedRow, member: u32, control: &Control) -> Result<(Measure, f64), ComputeError> {
    let model = Model::new(&planned.scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let watch = Stopwatch::start();
    match Transient::member(&model, &equilibrium, member)
        .and_then(|run| run.run(&control.part()))
        .map_err(ComputeError::Transient)?
    {
        Outcome::Finished(records) => {
            let (_, cpu_time) = watch.elapsed();
            Ok((Measure::new(&model, &equilibrium, &records, member), cpu_time))
        }
        Outcome::Cancelled | Outcome::Suspended(..) => Err(ComputeError::Cancelled),
    }
}
