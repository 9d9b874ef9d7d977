//! Lengths and numbers of steps: of each method, and those that a scenario needs.

use drillsweep_scenario::{AccuracyPreset, Integrator, Problem, Scenario, TimeStepping};

use super::failure::TransientError;
use super::grid::Grid;
use super::{esdirk, generalized_alpha, rk4, stability};
use crate::force::effect::active_effects;
use crate::solve::model::Model;
use crate::solve::modes::UndampedTorsion;
use crate::solve::statics::Equilibrium;

/// Number of steps of a run of the model's scenario with a given stepping: exact for fixed steps, expected for ESDIRK4 with a tolerance, and
/// none for RK4 with one.
pub fn step_count(model: &Model, stepping: TimeStepping) -> Option<u64> {
    let adapts = stepping.tolerance.is_some();
    if adapts && stepping.integrator == Integrator::Rk4 {
        return None;
    }
    let samples = (model.scenario.duration * model.scenario.recording.rate_hz).round() as u64;
    let grid = expected_grid(model, stepping);
    let longest = grid.at_sample(samples).div_ceil(1 << grid.top());
    let effects = &model.effects;
    let sticks =
        adapts && effects.contact && effects.torsion && (effects.friction || effects.friction_torque);
    let of_friction = if sticks { (model.scenario.duration * STEPS_OF_FRICTION).round() as u64 } else { 0 };
    Some(longest + of_friction)
}

/// Frequency \[Hz\] up to which steps of a method resolve a vibration, as [`TransientEffort::resolved_hz`](crate::solve::run::TransientEffort::resolved_hz) defines it: from the methods'
/// amplification of an undamped oscillation.
pub fn resolved_hz(integrator: Integrator, step: f64) -> f64 {
    let angle = match integrator {
        Integrator::Esdirk4 => esdirk::RESOLVED_ANGLE,
        Integrator::GeneralizedAlpha => generalized_alpha::RESOLVED_ANGLE,
        Integrator::Rk4 => rk4::RESOLVED_ANGLE,
    };
    angle / (std::f64::consts::TAU * step)
}

/// The longest step \[s\] of a run that must resolve the torsion that velocity-weakening friction excites.
pub(crate) fn resolving_step(model: &Model, equilibrium: &Equilibrium) -> f64 {
    let stepping = model.scenario.accuracy.time_stepping();
    let torsion = if resolves_torsion(&stepping) { UndampedTorsion::about(model, equilibrium) } else { None };
    torsion_step(&stepping, torsion.as_ref())
}

/// The longest step \[s\] of a stepping if `torsion` grows. A stepping that adapts its steps to the tolerance of the reference or a smaller one
/// must resolve the highest growing mode; others have no bound. If torsion grows up to
/// the end of the mesh, no step resolves it all; the method damps the modes beyond `FINEST_TORSION_STEP`.
pub fn torsion_step(stepping: &TimeStepping, torsion: Option<&UndampedTorsion>) -> f64 {
    match torsion.and_then(UndampedTorsion::resolving_step) {
        Some(step) if resolves_torsion(stepping) => step.max(FINEST_TORSION_STEP),
        _ => f64::INFINITY,
    }
}

fn resolves_torsion(stepping: &TimeStepping) -> bool {
    stepping.integrator == Integrator::Esdirk4
        && stepping.tolerance.is_some_and(|tolerance| {
            tolerance
                <= TimeStepping::promising(AccuracyPreset::Reference.tolerance()).tolerance.unwrap_or(0.0)
        })
}

/// Shortest step \[s\] for the sake of torsion alone. With it, ESDIRK4 damps torsion above a kilohertz; with shorter steps single elements, at
/// some kilohertz, grow in a model without stiffness-proportional damping.
const FINEST_TORSION_STEP: f64 = 1.25e-4;

/// Longest step \[s\] expected in a run of the model's scenario with a given stepping.
pub fn longest_step(model: &Model, stepping: TimeStepping) -> f64 {
    if stepping.integrator == Integrator::Rk4 {
        return stepping.step;
    }
    let grid = expected_grid(model, stepping);
    grid.step(grid.top())
}

fn expected_grid(model: &Model, stepping: TimeStepping) -> Grid {
    let subdivisions = stability::expected_subdivisions(model, &stepping);
    Grid::new(1.0 / model.scenario.recording.rate_hz, stepping.step / f64::from(subdivisions), 0)
}

/// Additional steps a second \[1/s\], beyond those of the longest length, of a run with adaptive steps if nodes stick and slip: 50 to 190 in the
/// damped scenarios at any accuracy, none in that of 1,000 m.
const STEPS_OF_FRICTION: f64 = 110.0;

/// The largest stable step of RK4 \[s\] for a model about its equilibrium.
///
/// # Errors
/// The mass matrix is singular.
pub fn rk4_stability_limit(model: &Model, equilibrium: &Equilibrium) -> Result<f64, TransientError> {
    Ok(stability::rk4_limit(model, &model.dynamic_system(equilibrium))?)
}

/// Problem with the step of a valid scenario: a fixed step of the explicit method beyond its stability limit. Checked
/// before a run is queued; it takes an equilibrium and some hundred products, and nothing for the other methods.
pub fn step_problem(scenario: &Scenario) -> Option<Problem> {
    let stepping = scenario.accuracy.time_stepping();
    if stepping.integrator != Integrator::Rk4
        || stepping.tolerance.is_some()
        || !active_effects(scenario).transient
    {
        return None;
    }
    let model = Model::new(scenario).ok()?;
    let limit = rk4_stability_limit(&model, &Equilibrium::find(&model).ok()?).ok()?;
    (stepping.step > limit).then(|| {
        let valid = format!(
            "must be at most {limit:.3e} s, the stability limit of rk4 for this mesh; or give a tolerance, or take esdirk4, which has \
             none"
        );
        Problem::new("accuracy.step", stepping.step.to_string(), valid)
    })
}
