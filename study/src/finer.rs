//! Check of a result by a finer time step: the statistics of a run are compared with those of another run of the same scenario with a finer step.
//!
//! A run can be finite, its ledger closed, and wrong. If statistics change by more than the accuracy allows when the step is refined, the run
//! is not to be trusted: its steps are too long for the scenario, or the scenario is too sensitive for a window of this length.
//! A third run distinguishes the two, with the steps of the first and a start a micrometre away from it. Runs of one method share
//! its bias, so agreement is no proof; the [cost study](super::cost) compares two independent methods.

use drillsweep_scenario::{
    Accuracy, AccuracyPreset, AccuracyTarget, Integrator, Promise, Scenario, TimeStepping,
};

use super::cost::{Measure, Quantity};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::solve::step::SMALLEST_MOTION;

/// Verdict of a finer step.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Agreement within the allowed difference; with the difference that comes nearest to it.
    Agrees(Difference),
    /// Disagreement; with the difference that exceeds the allowed one most.
    Differs(Difference),
    /// Disagreement, also with a run whose start is a micrometre away, by as much: the scenario is too sensitive for its window.
    Sensitive {
        /// The difference from the finer run that exceeds the allowed one most.
        finer: Difference,
        /// The difference from the run with the other start.
        neighbour: Difference,
    },
    /// All compared statistics are at rest in both runs.
    AtRest,
    /// The finer run has no result, for this reason.
    NoResult(String),
    /// It was cancelled.
    Cancelled,
}

/// One statistic of a run and of the finer one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// The statistic.
    pub quantity: Quantity,
    /// Measured depth of the node \[m\]; absent if the value is the whole string's.
    pub measured_depth: Option<f64>,
    /// Values of the run and of the finer one: lengths \[m\], forces \[N\], speeds \[rad/s\].
    pub values: [f64; 2],
    /// Their difference over the finer run's value, or over the value that counts as rest if that is larger.
    pub relative: f64,
    /// Largest difference that the accuracy allows.
    pub allowed: f64,
}

impl Difference {
    /// The difference over the allowed one.
    pub fn share(&self) -> f64 {
        self.relative / self.allowed
    }
}

/// Bounds for an accuracy in this check: its own; for `esdirk4` with a tolerance, those of this tolerance; and for other
/// steps, which have no bounds, those of `standard`.
pub fn promise_of(accuracy: &Accuracy) -> Promise {
    let stepping = accuracy.time_stepping();
    let tolerance = stepping.tolerance.filter(|_| stepping.integrator == Integrator::Esdirk4);
    let standard = AccuracyPreset::Standard.tolerance();
    let as_target = Accuracy::Target(AccuracyTarget::Statistics(tolerance.unwrap_or(standard)));
    accuracy
        .promise()
        .or(as_target.promise())
        .unwrap_or(Promise { orbit_size: standard, radius_deviation: standard })
}

/// Ratio up to which differences count as equally large: single runs of a sensitive scenario are draws, whose differences scatter.
const SAME_SIZE: f64 = 5.0;

/// Largest number of runs from a start a micrometre away before a difference counts as one of the steps: the statistics of a single one may agree by
/// chance.
const NEIGHBOURS: u32 = 3;

/// Runs a model with a [finer step](TimeStepping::finer) and compares the run with its first one, whose measure is `own`.
pub fn ask(own: &Measure, model: &Model, equilibrium: &Equilibrium, control: &Control) -> Verdict {
    let stepping = model.scenario.accuracy.time_stepping();
    let promise = promise_of(&model.scenario.accuracy);
    let against =
        |stepping: TimeStepping, member: u32| match measure(model, equilibrium, stepping, member, control) {
            Ok(Some(other)) => compare(own, &other, &model.scenario, promise),
            Ok(None) => Verdict::Cancelled,
            Err(reason) => Verdict::NoResult(reason),
        };
    // Half of the step that was made: contacts may have cut the requested one.
    let made = match stepping.integrator {
        Integrator::Rk4 => stepping.step,
        Integrator::Esdirk4 | Integrator::GeneralizedAlpha => stepping.step.min(own.longest_step),
    };
    let finer = TimeStepping { step: made, ..stepping }.finer();
    match against(finer, 0) {
        Verdict::Differs(finer) => {
            for member in 1..=NEIGHBOURS {
                match against(stepping, member) {
                    Verdict::Cancelled => return Verdict::Cancelled,
                    Verdict::Differs(neighbour) if finer.share() <= SAME_SIZE * neighbour.share() => {
                        return Verdict::Sensitive { finer, neighbour };
                    }
                    _ => {}
                }
            }
            Verdict::Differs(finer)
        }
        verdict => verdict,
    }
}

/// Measure of a run of the model with another stepping, as a member of its ensemble; `None` if it was cancelled.
fn measure(
    model: &Model,
    equilibrium: &Equilibrium,
    stepping: TimeStepping,
    member: u32,
    control: &Control,
) -> Result<Option<Measure>, String> {
    // Neither the model nor its equilibrium depends on time.
    let mut model = model.clone();
    model.scenario.accuracy = Accuracy::Explicit(stepping);
    let run = Transient::member(&model, equilibrium, member).and_then(|transient| transient.run(control));
    match run.map_err(|error| error.to_string())? {
        Outcome::Finished(records) => Ok(Some(Measure::new(&model, equilibrium, &records, member))),
        Outcome::Cancelled | Outcome::Suspended(..) => Ok(None),
    }
}

/// The verdict on two runs of a scenario.
fn compare(own: &Measure, finer: &Measure, scenario: &Scenario, promise: Promise) -> Verdict {
    let statistics = Quantity::ALL.iter().filter(|&&quantity| quantity != Quantity::Lines);
    let differences = statistics.flat_map(|&quantity| {
        let nodes = if quantity.is_of_string() { 1 } else { own.nodes.len() };
        let rest = rest(quantity, scenario);
        (0..nodes).map(move |node| {
            let values = [own, finer].map(|measure| measure.statistic(quantity, node));
            let depth = own.nodes.get(node).map(|node| node.measured_depth);
            Difference {
                quantity,
                measured_depth: depth.filter(|_| !quantity.is_of_string()),
                values,
                relative: (values[0] - values[1]).abs() / values[1].abs().max(rest),
                allowed: if quantity.is_deviation() { promise.radius_deviation } else { promise.orbit_size },
            }
        })
    });
    let differences: Vec<Difference> = differences.collect();
    let moves = |difference: &Difference| {
        let is_motion = !matches!(difference.quantity, Quantity::MeanRadius | Quantity::ContactForce);
        is_motion && difference.values.iter().any(|value| *value > rest(difference.quantity, scenario))
    };
    let worst = differences.iter().max_by(|a, b| a.share().total_cmp(&b.share()));
    match worst {
        Some(worst) if worst.share() > 1.0 => Verdict::Differs(*worst),
        Some(worst) if differences.iter().any(moves) => Verdict::Agrees(*worst),
        _ => Verdict::AtRest,
    }
}

/// Least size for a relative difference. For lengths it is at least the motion for which steps are chosen. For twist it is the
/// reference speed of friction at the surface: steps hold a sliding speed to a part of that, and a smaller one has no effect on the string.
fn rest(quantity: Quantity, scenario: &Scenario) -> f64 {
    let hole_radius = 0.5 * scenario.well.hole_diameter;
    match quantity {
        Quantity::OrbitSize | Quantity::RadiusDeviation | Quantity::MeanRadius => {
            SMALLEST_MOTION * hole_radius
        }
        Quantity::TorsionalSpeed => scenario.contact.friction_reference_speed / hole_radius,
        Quantity::ContactForce | Quantity::Lines => quantity.floor(),
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Switch, preset};

    use super::*;

    /// The verdict on a run of two seconds of a preset with a stepping.
    fn verdict(name: &str, stepping: TimeStepping, contact: Switch) -> Verdict {
        let mut scenario = preset(name).unwrap();
        scenario.effects.contact = contact;
        scenario.accuracy = Accuracy::Explicit(stepping);
        (scenario.duration, scenario.recording.orbit_window) = (2.0, None);
        scenario.recording.rate_hz = (1.0 / stepping.step).min(1000.0);
        let model = Model::new(&scenario).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let own = measure(&model, &equilibrium, stepping, 0, &Control::new()).unwrap().unwrap();
        ask(&own, &model, &equilibrium, &Control::new())
    }

    #[test]
    fn a_step_that_damps_the_statistics_is_detected() {
        // On the axis an unbalance drives a whirl from rest; a method of order 2 does not follow it with ten steps a second.
        let of = |step| {
            verdict("hard/on-axis", TimeStepping::fixed(Integrator::GeneralizedAlpha, step), Switch::Off)
        };
        let Verdict::Differs(difference) = of(0.1) else { panic!("{:?}", of(0.1)) };
        assert!(difference.share() > 1.0 && difference.allowed >= 0.02, "{difference:?}");
        assert!(matches!(of(1e-3), Verdict::Agrees(difference) if difference.share() < 0.5));
    }

    #[test]
    fn a_still_run_is_at_rest_and_a_missing_finer_run_has_its_reason() {
        let standard = TimeStepping::adaptive(0.02);
        assert_eq!(verdict("hard/near-buckling", standard, Switch::Auto), Verdict::AtRest);
        let control = Control::new();
        control.cancel();
        let model = Model::new(&preset("hard/on-axis").unwrap()).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let stepping = model.scenario.accuracy.time_stepping();
        let own = measure(&model, &equilibrium, stepping, 0, &Control::new()).unwrap().unwrap();
        assert_eq!(ask(&own, &model, &equilibrium, &control), Verdict::Cancelled);
    }

    #[test]
    fn a_finer_step_is_half_as_long_and_its_tolerance_goes_with_it() {
        let finer = TimeStepping::adaptive(0.08).finer();
        assert_eq!(finer, TimeStepping::adaptive(0.02));
        let fixed = TimeStepping::fixed(Integrator::GeneralizedAlpha, 1e-3);
        assert_eq!(fixed.finer(), TimeStepping { step: 5e-4, ..fixed });
        // No tolerance is below the smallest admissible one.
        assert_eq!(TimeStepping::adaptive(1e-4).finer().tolerance, Some(1e-4));
    }
}
