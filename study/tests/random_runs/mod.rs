//! Runs of random scenarios, and the contract that each must keep: it ends with a result whose numbers are all finite and whose energy ledger closes
//! within its bound, or with a typed failure that has time, node and reason.

use drillsweep_scenario::{Accuracy, AccuracyPreset, Recording, Scenario};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::UndampedTorsion;
use drillsweep_sim::solve::run::{DivergenceReason, Outcome, Records, Transient, TransientError};
use drillsweep_sim::solve::statics::{Equilibrium, StaticsError};
use drillsweep_sim::validation::validate;
use drillsweep_study::cost::Measure;
use drillsweep_study::errors::TimeError;
use drillsweep_study::finer::{self, Verdict};
use drillsweep_study::summary::TransientSummary;

/// Duration at the accuracy of a preset \[s\].
const PRESET_DURATION: f64 = 0.4;

/// End of a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RunEnd {
    /// A result: all numbers finite, the ledger within its bound.
    Finite {
        /// Residual of the ledger over its bound.
        ledger: f64,
    },
    /// A typed failure.
    Failed {
        /// The kind of failure.
        cause: &'static str,
        /// The whole reason, with time and node if there are any.
        reason: String,
    },
    /// A breach of the contract: a number is not finite, the ledger is out of its bound, or the scenario was refused.
    Broken {
        /// Breach of the contract.
        reason: String,
    },
    /// The run was cancelled.
    Cancelled,
}

/// Runs a scenario and judges its end.
pub(crate) fn run(scenario: &Scenario, control: &Control) -> RunEnd {
    match simulate(scenario, control) {
        Ok((_, _, records)) => judge(&records),
        Err(end) => end,
    }
}

/// Findings about the steps of a result.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refined {
    /// Verdict of a finer step.
    pub(crate) verdict: Verdict,
    /// Error of the steps that the result states.
    pub(crate) stated: TimeError,
}

/// Runs a scenario and judges its end; compares a result with that of a finer step, and with the error that it states.
pub(crate) fn run_and_refine(scenario: &Scenario, control: &Control) -> (RunEnd, Option<Refined>) {
    let (model, equilibrium, records) = match simulate(scenario, control) {
        Ok(run) => run,
        Err(end) => return (end, None),
    };
    let end = judge(&records);
    if !matches!(end, RunEnd::Finite { .. }) {
        return (end, None);
    }
    let own = Measure::new(&model, &equilibrium, &records, 0);
    let torsion = UndampedTorsion::about(&model, &equilibrium);
    let Ok(summary) = TransientSummary::new(&model, &records);
    let stated = TimeError::new(&summary, &[], None, torsion.as_ref());
    let verdict = finer::ask(&own, &model, &equilibrium, control);
    (end, Some(Refined { verdict, stated }))
}

fn simulate(scenario: &Scenario, control: &Control) -> Result<(Model, Equilibrium, Box<Records>), RunEnd> {
    let failed = |cause, reason: String| RunEnd::Failed { cause, reason };
    validate(scenario).map_err(|problems| RunEnd::Broken { reason: format!("refused: {problems}") })?;
    let model = Model::new(scenario).map_err(|error| failed("no model", error.to_string()))?;
    let equilibrium =
        Equilibrium::find(&model).map_err(|error| failed(statics_cause(&error), error.to_string()))?;
    let ended = Transient::new(&model, &equilibrium).and_then(|transient| transient.run(control));
    match ended {
        Ok(Outcome::Finished(records)) => Ok((model, equilibrium, records)),
        Ok(Outcome::Cancelled | Outcome::Suspended(..)) => Err(RunEnd::Cancelled),
        Err(error) => Err(failed(transient_cause(&error), error.to_string())),
    }
}

/// Judges a result by the contract.
fn judge(records: &Records) -> RunEnd {
    let broken = |reason: String| RunEnd::Broken { reason };
    for history in &records.histories {
        let series = [
            &history.u,
            &history.v,
            &history.w,
            &history.theta_z,
            &history.u_rate,
            &history.v_rate,
            &history.w_rate,
            &history.theta_z_rate,
        ];
        if series.iter().any(|values| values.iter().any(|value| !value.is_finite())) {
            return broken(format!("the history of node {} is not finite", history.node + 1));
        }
    }
    if let Some(node) = records.contacts.iter().position(|contact| {
        ![contact.largest_radius(), contact.contact_time, contact.largest_normal_force]
            .iter()
            .all(|value| value.is_finite())
    }) {
        return broken(format!("the contact statistics of node {} are not finite", node + 1));
    }
    let Some(last) = records.energy.last() else { return broken("no row in the ledger".into()) };
    let (residual, bound) = (last.residual, records.energy_bound);
    if !(residual.is_finite() && bound.is_finite() && records.error.displacement.is_finite()) {
        return broken(format!("the ledger leaves {residual} J of {bound} J"));
    }
    if residual.abs() > bound {
        return broken(format!("the ledger leaves {residual:.3e} J, its bound is {bound:.3e} J"));
    }
    // A string at rest has no bound either.
    RunEnd::Finite { ledger: if residual == 0.0 { 0.0 } else { residual.abs() / bound } }
}

fn statics_cause(error: &StaticsError) -> &'static str {
    match error {
        StaticsError::NotConverged { .. } => "no equilibrium",
        StaticsError::Singular(_) => "singular tangent",
        StaticsError::OutsideHole { .. } => "no equilibrium in the hole",
        StaticsError::Mud { .. } => "mud without a flow",
        StaticsError::HydraulicsNotConverged { .. } => "equilibrium of string and mud not converged",
    }
}

fn transient_cause(error: &TransientError) -> &'static str {
    match error {
        TransientError::Singular(_) => "singular step matrix",
        TransientError::StepBeyondStability { .. } => "rk4 step beyond its limit",
        TransientError::ContactTooStiff { .. } => "contact too stiff for the step",
        TransientError::Histories(_) => "samples not kept",
        TransientError::Diverged { reason, .. } => match reason {
            DivergenceReason::NotFinite => "not finite",
            DivergenceReason::OutsideHole { .. } => "far outside the hole",
            DivergenceReason::StepCollapsed => "adaptive step collapsed",
            DivergenceReason::EnergyNotConserved { .. } => "energy ledger out of bound",
        },
    }
}

/// The scenario at the accuracy of a preset, for as long as a random string takes to swing a few times.
pub(crate) fn at_accuracy(scenario: Scenario, preset: AccuracyPreset) -> Scenario {
    let recording = Recording { rate_hz: 1000.0, ..scenario.recording };
    Scenario { accuracy: Accuracy::Preset(preset), duration: PRESET_DURATION, recording, ..scenario }
}
