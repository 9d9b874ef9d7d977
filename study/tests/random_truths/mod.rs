//! Random scenarios with stick-slip, whose runs of `standard` must be right or report that they may be wrong: judged by RK4 at 0.95 of its stability
//! limit, an independent method.

#![allow(dead_code, unreachable_pub)]

use drillsweep_scenario::{
    Accuracy, AccuracyPreset, Effects, ElementLengths, Integrator, Mesh, OrbitWindow, Recording, Scenario,
    TimeStepping, TimeWindow,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::UndampedTorsion;
use drillsweep_sim::solve::run::{Outcome, Records, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::solve::step::rk4_stability_limit;
use drillsweep_sim::validation::validate;
use drillsweep_study::errors::TimeError;
use drillsweep_study::sensitivity::Sensitivity;
use drillsweep_study::summary::TransientSummary;
use random_scenario::random_scenario;

#[path = "../../../sim/tests/random_scenario/mod.rs"]
mod random_scenario;

/// Largest step of RK4, as part of its stability limit.
const BELOW_LIMIT: f64 = 0.95;

/// Stiffness-proportional damping \[s\] that limits torsion below the mesh's highest frequency, as in the damped base case.
const CLOSING_DAMPING: f64 = 3e-5;

/// Verdict on a run of `standard` in a scenario.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// The scenario is not judged: it has no equilibrium or no stick-slip, or RK4 would take too long.
    Passed(&'static str),
    /// The run failed, and so reports that it has no result.
    Failed,
    /// The run has a result, with its errors in size and deviation relative to RK4's, the worst nodes.
    Known {
        /// Error of orbit size.
        size: f64,
        /// Error of the radius' standard deviation.
        deviation: f64,
        /// The error that the run states; absent if it states that the error is not known.
        stated: Option<f64>,
        /// Amplification of a disturbance by the scenario; absent if the twin diverged.
        amplification: Option<f64>,
    },
}

impl Judgement {
    /// True if the run is wrong by more than it promises and states, and does not report it.
    pub fn is_silently_wrong(&self) -> bool {
        let Some(promise) = Accuracy::Preset(AccuracyPreset::Standard).promise() else { return false };
        match self {
            Judgement::Known { size, deviation, stated: Some(stated), .. } => {
                !(*size <= promise.orbit_size.max(*stated)
                    && *deviation <= promise.radius_deviation.max(*stated))
            }
            _ => false,
        }
    }
}

/// Scenario `index` of a seed, long enough for stick-slip: in the middle of the range of rotation speeds, closed by damping, without tool joints
/// and on elements of `element` \[m\], whose axial frequency limits RK4's steps.
pub fn long_scenario(seed: u64, index: u64, duration: f64, element: f64) -> Scenario {
    let mut scenario = random_scenario(seed, index);
    scenario.effects = Effects::default();
    scenario.duration = duration;
    scenario.accuracy = Accuracy::Preset(AccuracyPreset::Standard);
    scenario.damping.stiffness_proportional = CLOSING_DAMPING;
    scenario.damping.mass_proportional = scenario.damping.mass_proportional.max(0.03);
    let speed = scenario.operation.rotation_speed_rpm;
    scenario.operation.rotation_speed_rpm = (30.0 + speed.abs() % 130.0).copysign(speed);
    for section in &mut scenario.string.sections {
        section.tool_joint = None;
        section.length = section.length.max(element);
    }
    scenario.string.gauges.clear();
    let length: f64 = scenario.string.sections.iter().map(|s| f64::from(s.count) * s.length).sum();
    let drawn = scenario.well.survey.last().map_or(length, |last| last.measured_depth);
    for station in &mut scenario.well.survey {
        station.measured_depth *= length / drawn;
    }
    for mass in &mut scenario.string.unbalance {
        let depth = (mass.depth(drawn) / drawn * length / element).round().max(1.0) * element;
        (mass.measured_depth, mass.above_bit) = (Some(depth.min(length)), None);
    }
    scenario.mesh = Mesh::Lengths(ElementLengths {
        drillpipe: element,
        tool_joint: element,
        collar: element,
        stabilizer: element,
        bit: element,
    });
    let (from, to) = (duration * 2.0 / 3.0, duration);
    scenario.recording = Recording {
        rate_hz: 250.0,
        orbit_window: Some(OrbitWindow::Fixed(TimeWindow { from, to })),
        spectrum_windows: Some(Vec::new()),
        ..scenario.recording
    };
    scenario
}

/// Judges a run of `scenario`; RK4 may take `most_steps`.
pub fn judge(scenario: &Scenario, most_steps: f64) -> Judgement {
    if validate(scenario).is_err() {
        return Judgement::Passed("not valid");
    }
    let Ok(model) = Model::new(scenario) else { return Judgement::Passed("no model") };
    let Ok(equilibrium) = Equilibrium::find(&model) else { return Judgement::Passed("no equilibrium") };
    if scenario.recording.nodes.is_empty() || !model.effects.contact {
        return Judgement::Passed("nothing to compare");
    }
    // Without friction a contact may come to rest on the wall, but does not stick.
    if scenario.contact.static_friction == 0.0 {
        return Judgement::Passed("no friction");
    }
    let Ok(limit) = rk4_stability_limit(&model, &equilibrium) else {
        return Judgement::Passed("singular mass");
    };
    let interval = 1.0 / scenario.recording.rate_hz;
    let step = interval / (interval / (BELOW_LIMIT * limit)).ceil();
    if scenario.duration / step > most_steps {
        return Judgement::Passed("rk4 takes too long");
    }
    let Some((own, records)) = run(&model, &equilibrium) else { return Judgement::Failed };
    if !records.contacts.iter().any(|node| node.slip_to_stick_count > 0) {
        return Judgement::Passed("nothing sticks");
    }
    let control = Control::new();
    let Ok(Some(twin)) = Sensitivity::of(&model, &equilibrium, &records, &control) else {
        return Judgement::Passed("no twin");
    };
    let accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Rk4, step));
    let fine = Scenario { accuracy, ..scenario.clone() };
    let Ok(fine_model) = Model::new(&fine) else { return Judgement::Passed("no model") };
    let Some((truth, _)) = run(&fine_model, &equilibrium) else { return Judgement::Passed("rk4 fails") };
    let torsion = UndampedTorsion::about(&model, &equilibrium);
    let stated = TimeError::new(&own, &[], Some(&twin), torsion.as_ref()).unconditional();
    // An orbit that moves no further than this is rest, in relative terms of anything.
    let least = 1e-5 * scenario.well.hole_diameter;
    let pairs = || own.orbits.iter().zip(&truth.orbits).filter(|(_, truth)| truth.orbit_radius_rms > least);
    let size = pairs().map(|(own, truth)| (own.orbit_radius_rms / truth.orbit_radius_rms - 1.0).abs());
    let deviation = pairs()
        .filter(|(_, truth)| truth.radius_deviation > least)
        .map(|(own, truth)| (own.radius_deviation / truth.radius_deviation - 1.0).abs());
    Judgement::Known {
        size: size.fold(0.0, f64::max),
        deviation: deviation.fold(0.0, f64::max),
        stated,
        amplification: twin.amplification,
    }
}

fn run(model: &Model, equilibrium: &Equilibrium) -> Option<(TransientSummary, Box<Records>)> {
    match Transient::new(model, equilibrium).ok()?.run(&Control::new()).ok()? {
        Outcome::Finished(records) => {
            let Ok(summary) = TransientSummary::new(model, &records);
            Some((summary, records))
        }
        _ => None,
    }
}
