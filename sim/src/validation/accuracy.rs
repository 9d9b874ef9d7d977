//! Rules of methods, steps and tolerances.

use drillsweep_scenario::{Accuracy, AccuracyTarget, Integrator, Scenario, TOLERANCES, TimeStepping};

use super::report::Report;
use super::window::is_whole;
use crate::force::effect::active_effects;

/// Generalized-alpha's largest spectral radius at infinity that is known to be safe with two contact iterations
/// (docs/model/motion.md, Generalized-alpha).
const LARGEST_SPECTRAL_RADIUS: f64 = 0.95;

/// Smallest step \[s\] at which the implicit methods damp torsional modes of single elements that friction excites.
const FINEST_UNDAMPED_STEP: f64 = 1e-4;

/// Number of contact iterations beyond which a solve has long converged or never will.
const MOST_CONTACT_ITERATIONS: u32 = 1000;

pub(super) fn check_accuracy(report: &mut Report, scenario: &Scenario) {
    let stepping = scenario.accuracy.time_stepping();
    report.positive(stepping.step, "accuracy.step");
    let rate = scenario.recording.rate_hz;
    let adapts = stepping.integrator == Integrator::Esdirk4 && stepping.tolerance.is_some();
    if !adapts && stepping.step > 0.0 && rate > 0.0 && stepping.step.is_finite() && rate.is_finite() {
        let (interval, intervals) = (1.0 / rate, stepping.step * rate);
        let is_part = is_whole(1.0 / intervals);
        if stepping.integrator == Integrator::Esdirk4 {
            let is_power_of_two = is_whole(intervals) && (intervals.round() as u64).is_power_of_two();
            report.require(
                is_part || is_power_of_two,
                "accuracy.step",
                stepping.step,
                format!(
                    "must be a whole part of the recording interval, {interval} s, or that times a power of two"
                ),
            );
        } else {
            report.require(
                is_part,
                "accuracy.step",
                stepping.step,
                format!("must be a whole part of the recording interval, {interval} s"),
            );
        }
    }

    let effects = active_effects(scenario);
    let friction_drives_torsion = scenario.contact.static_friction > scenario.contact.dynamic_friction
        && effects.contact
        && effects.friction_torque
        && effects.torsion;
    report.warn(
        stepping.integrator != Integrator::Rk4
            && stepping.step < FINEST_UNDAMPED_STEP
            && friction_drives_torsion
            && scenario.damping.stiffness_proportional == 0.0,
        "accuracy.step",
        "at so small a step the integrator no longer damps the torsional modes of single elements, some kHz, which velocity-weakening friction excites; give damping.stiffness_proportional a value such as 1e-6 s",
    );

    let explicit = stepping.integrator == Integrator::Rk4;
    report.require(
        explicit || (2..=MOST_CONTACT_ITERATIONS).contains(&stepping.contact_sweeps),
        "accuracy.contact_sweeps",
        stepping.contact_sweeps,
        format!("must be 2 to {MOST_CONTACT_ITERATIONS} for an implicit method"),
    );
    if let Some(radius) = stepping.spectral_radius {
        let of_alpha = stepping.integrator == Integrator::GeneralizedAlpha;
        report.number(
            radius,
            "accuracy.spectral_radius",
            |radius| of_alpha && (0.0..=LARGEST_SPECTRAL_RADIUS).contains(&radius),
            if of_alpha {
                format!(
                    "must be 0 to {LARGEST_SPECTRAL_RADIUS}: nearer to 1 nothing damps the error that contact iterations leave, and results are wrong without any indication"
                )
            } else {
                "is for generalized_alpha only".to_owned()
            },
        );
    }
    check_tolerance(report, scenario);
}

fn check_tolerance(report: &mut Report, scenario: &Scenario) {
    let within = |tolerance: f64| TOLERANCES.contains(&tolerance);
    let valid = || format!("must be {} to {}", TOLERANCES.start(), TOLERANCES.end());
    match scenario.accuracy {
        Accuracy::Preset(_) | Accuracy::Explicit(TimeStepping { tolerance: None, .. }) => {}
        Accuracy::Target(AccuracyTarget::Statistics(tolerance)) => {
            report.number(tolerance, "accuracy.statistics", within, valid());
        }
        Accuracy::Target(AccuracyTarget::Trajectory(tolerance)) => {
            report.number(tolerance, "accuracy.trajectory", within, valid());
        }
        Accuracy::Explicit(TimeStepping { integrator, tolerance: Some(tolerance), .. }) => {
            const PATH: &str = "accuracy.tolerance";
            match integrator {
                Integrator::Esdirk4 => report.number(tolerance, PATH, within, valid()),
                Integrator::Rk4 => report.number(
                    tolerance,
                    PATH,
                    |tolerance| tolerance > 0.0 && tolerance < 0.1,
                    "must be greater than 0 and less than 0.1",
                ),
                Integrator::GeneralizedAlpha => report.number(
                    tolerance,
                    PATH,
                    |_| false,
                    "is for esdirk4 and rk4: generalized_alpha keeps a fixed step",
                ),
            }
        }
    }
}
