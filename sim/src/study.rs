//! What accuracy costs: a work-precision study of a scenario (design.md section 4).
//!
//! [`plan`] says which runs a study needs, [`Measure`] keeps of a run what is compared, and [`report`] compares. The runs
//! themselves, and their time, are the caller's: nothing here knows a clock.

use serde::{Deserialize, Serialize};

use crate::ensemble::parting_time;
use crate::model::{Model, ModelError};
use crate::scenario::{
    Accuracy, CostStudy, Effect, EffectDecision, Integrator, MethodSteps, NodeChoice, Outputs, Recording,
    Scenario, Switch, TimeStepping, TimeWindow,
};
use crate::statics::{Equilibrium, StaticsError};
use crate::summary::TransientSummary;
use crate::transient::{NodeHistory, Records, TransientError, recorded_nodes, rk4_stability_limit};

/// The reference's step is this part of the smallest step of an implicit method. Not less: the falling friction curve
/// drives torsional modes of single elements at some kHz, which nothing but the integrator damps where the structure has no
/// stiffness-proportional damping, and at 0.06 ms ESDIRK4 no longer does.
const REFERENCE_PART: f64 = 0.5;

/// Energy residual, relative to the contacts' net work, from which on a reference is doubted.
const UNSOUND_RESIDUAL: f64 = 0.01;

/// Most contact sweeps of the reference; it stops when they stand still.
const REFERENCE_SWEEPS: u32 = 4;

/// Recording rates are not halved below this \[Hz\].
const LOWEST_RATE_HZ: f64 = 200.0;

/// Errors that a recommendation is made for.
const WANTED: [f64; 3] = [0.05, 0.01, 0.001];

/// One run of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// What it is for.
    pub role: Role,
    /// The scenario to simulate, with recording and accuracy of the study.
    pub scenario: Scenario,
    /// Member of the ensemble: 0 as it is, 1 disturbed by 1e-6 m.
    pub member: u32,
}

/// What a run of a study is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// What the others are compared with.
    Reference,
    /// The reference, disturbed: where the two part, no history can be trusted.
    Twin,
    /// A method and step.
    Method,
    /// A mesh, its target element lengths multiplied by `factor`.
    Mesh {
        /// Factor on all target element lengths.
        factor: f64,
    },
    /// The scenario without one of its effects.
    Without {
        /// The effect.
        effect: Effect,
    },
}

/// What a study keeps of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    stepping: TimeStepping,
    elements: usize,
    steps: u64,
    subdivisions: u32,
    rate_hz: f64,
    histories: Vec<NodeHistory>,
    summary: TransientSummary,
    error_estimate: f64,
    /// Half the hole's diameter \[m\].
    hole_radius: f64,
    /// Measured depth and static (u, v) of every node.
    position: Vec<(f64, [f64; 2])>,
    /// Measured depth of the lower end and C_f of every element; empty without mud.
    friction: Vec<(f64, f64)>,
}

/// The outcome of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CostReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Simulated time of each run \[s\].
    pub duration: f64,
    /// Duration of the scenario itself \[s\], which recommendations are made for.
    pub scenario_duration: f64,
    /// Window of orbit size, mean radius and lines \[s\].
    pub window: TimeWindow,
    /// Time \[s\] at which a disturbance of 1e-6 m has parted the reference from itself: histories are compared up to
    /// there. Absent where they stayed together.
    pub histories_part_at: Option<f64>,
    /// The reference.
    pub reference: CostRow,
    /// Methods and steps.
    pub methods: Vec<CostRow>,
    /// Meshes. Contact stiffness is a node's unless the contact law has a `reference_length`: then a finer mesh is
    /// another, stiffer wall, and these rows need not converge.
    pub meshes: Vec<CostRow>,
    /// The scenario without one effect at a time; the reference is the whole scenario at its own accuracy then, and what stands as
    /// an error is what the effect changes.
    #[serde(default)]
    pub effects: Vec<CostRow>,
    /// Cheapest methods for some accuracies.
    pub recommendations: Vec<Recommendation>,
    /// What to doubt.
    pub warnings: Vec<String>,
}

/// One run of a study against its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CostRow {
    /// The effect that was switched off; absent where none was.
    #[serde(default)]
    pub effect: Option<Effect>,
    /// Method.
    pub integrator: Integrator,
    /// Step \[s\].
    pub step: f64,
    /// Factor on the mesh's target element lengths.
    pub mesh_factor: f64,
    /// Elements of the mesh.
    pub elements: usize,
    /// Steps made.
    pub steps: u64,
    /// Parts into which each step was cut so that the contact sweeps are stable.
    pub step_subdivisions: u32,
    /// Processor time of the run in time \[s\].
    pub cpu_time: f64,
    /// Processor time per simulated second.
    pub cpu_per_simulated_second: f64,
    /// What it found, against the reference; absent where it failed.
    pub errors: Option<CostErrors>,
    /// Why it failed.
    pub failure: Option<String>,
}

/// Errors of a run against the reference. All but the frequency are relative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CostErrors {
    /// L2 distance of the recorded nodes' (u, v) up to where histories part, over the motion away from the start.
    pub trajectory: Option<f64>,
    /// Orbit size (root mean square distance from the mean position), worst recorded node.
    pub orbit_size: f64,
    /// Mean distance from the hole's axis, worst recorded node.
    pub mean_radius: f64,
    /// Distance \[Hz\] of the reference's strongest line to the nearest of the run's, worst recorded node; absent where
    /// there are no lines.
    pub line_frequency_hz: Option<f64>,
    /// Static position: largest distance of a node, over the hole's radius.
    pub static_position: f64,
    /// C_f, mean over the string's length; absent without mud.
    pub friction_coefficient: Option<f64>,
    /// Energy residual over the net work of the contacts; absent where there was none.
    pub energy: Option<f64>,
    /// The run's own estimate of its error, relative to the motion, over the whole run.
    pub estimate: f64,
}

/// The cheapest way to some accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Recommendation {
    /// Wanted relative error of orbit size.
    pub orbit_size: f64,
    /// Method; absent where none of the study reaches it.
    pub integrator: Option<Integrator>,
    /// Step \[s\].
    pub step: Option<f64>,
    /// Processor time for the scenario's own duration \[s\].
    pub cpu_time: Option<f64>,
    /// The recommendation in words.
    pub text: String,
}

/// Why a study cannot be planned.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// There is no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// There is no equilibrium.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// The explicit method's limit cannot be found, or the reference fails.
    #[error(transparent)]
    Transient(#[from] TransientError),
    /// The reference failed.
    #[error("the reference run failed: {0}")]
    Reference(String),
}

/// The runs of a study, the reference and its twin first.
///
/// # Errors
/// When the scenario has no equilibrium.
pub fn plan(scenario: &Scenario) -> Result<Vec<PlannedRun>, StudyError> {
    let study = scenario.cost_study.clone().unwrap_or_default();
    let model = Model::new(scenario)?;
    let base = Scenario {
        recording: recording(scenario, &study, &model),
        duration: study.duration,
        cost_study: None,
        ensemble: 1,
        ..scenario.clone()
    };
    if study.effects {
        return Ok(ablation(scenario, base));
    }
    let interval = 1.0 / base.recording.rate_hz;
    let methods = match study.methods {
        Some(methods) => methods,
        None => usual_methods(interval, rk4_stability_limit(&model, &Equilibrium::find(&model)?)?),
    };
    let steps =
        || methods.iter().flat_map(|method| method.steps.iter().map(|&step| (method.integrator, step)));
    let smallest = steps()
        .filter(|(integrator, _)| *integrator != Integrator::Rk4)
        .map(|(_, step)| step)
        .fold(0.25 * interval, f64::min);
    let run = |role, stepping, member| {
        let accuracy = Accuracy::Explicit(stepping);
        PlannedRun { role, scenario: Scenario { accuracy, ..base.clone() }, member }
    };
    let reference = TimeStepping {
        contact_sweeps: REFERENCE_SWEEPS,
        ..TimeStepping::fixed(Integrator::Esdirk4, REFERENCE_PART * smallest)
    };
    let mut runs = vec![run(Role::Reference, reference, 0), run(Role::Twin, reference, 1)];
    runs.extend(
        steps().map(|(integrator, step)| run(Role::Method, TimeStepping::fixed(integrator, step), 0)),
    );
    if !study.mesh_factors.is_empty() {
        let mut factors = study.mesh_factors;
        factors.push(1.0);
        factors.sort_by(|a, b| b.total_cmp(a));
        factors.dedup();
        for factor in factors {
            let mut planned =
                run(Role::Mesh { factor }, TimeStepping::fixed(Integrator::Esdirk4, 0.5 * interval), 0);
            let mesh = &mut planned.scenario.mesh;
            for length in [
                &mut mesh.drillpipe,
                &mut mesh.tool_joint,
                &mut mesh.collar,
                &mut mesh.stabilizer,
                &mut mesh.bit,
            ] {
                *length *= factor;
            }
            runs.push(planned);
        }
    }
    Ok(runs)
}

/// The runs of an effect ablation: everything else stays as it was decided for the whole scenario.
fn ablation(scenario: &Scenario, mut base: Scenario) -> Vec<PlannedRun> {
    let decisions = scenario.decide_effects();
    for decision in &decisions {
        base.effects.set(decision.effect, if decision.active { Switch::On } else { Switch::Off });
    }
    let run = |role, member| PlannedRun { role, scenario: base.clone(), member };
    let mut runs = vec![run(Role::Reference, 0), run(Role::Twin, 1)];
    let in_play = decisions.iter().filter(|decision| decision.active && decision.effect != Effect::Transient);
    runs.extend(in_play.map(|&EffectDecision { effect, .. }| {
        let mut planned = run(Role::Without { effect }, 0);
        planned.scenario.effects.set(effect, Switch::Off);
        planned
    }));
    runs
}

/// The recording of a study's runs: by depth, since another mesh has other node numbers, at half the rate where that
/// leaves a whole number of samples, over the last two thirds.
fn recording(scenario: &Scenario, study: &CostStudy, model: &Model) -> Recording {
    let asked = &scenario.recording;
    let half = 0.5 * asked.rate_hz;
    let samples = study.duration * half;
    let is_whole = (samples - samples.round()).abs() < 1e-6;
    let rate_hz = if half >= LOWEST_RATE_HZ && is_whole { half } else { asked.rate_hz };
    let window = TimeWindow { from: (study.duration * rate_hz / 3.0).round() / rate_hz, to: study.duration };
    let nodes = recorded_nodes(model).into_iter();
    Recording {
        rate_hz,
        nodes: nodes.map(|node| NodeChoice::Depth(model.mesh.nodes[node].measured_depth)).collect(),
        spectrum_windows: vec![window],
        orbit_window: Some(window),
        stability: false,
        outputs: Outputs::Full,
    }
}

/// All three methods with four steps each: the implicit ones from the recording interval \[s\] down, RK4 from just below
/// its stability limit \[s\].
fn usual_methods(interval: f64, limit: f64) -> Vec<MethodSteps> {
    let halves = vec![interval, 0.5 * interval, 0.25 * interval, 0.125 * interval];
    let parts = (interval / limit).ceil();
    let below_limit = [1.0, 1.25, 1.6, 2.0].map(|factor| interval / (factor * parts).ceil());
    vec![
        MethodSteps { integrator: Integrator::GeneralizedAlpha, steps: halves.clone() },
        MethodSteps { integrator: Integrator::Esdirk4, steps: halves },
        MethodSteps { integrator: Integrator::Rk4, steps: below_limit.to_vec() },
    ]
}

impl Measure {
    /// Keeps of a run what the study compares.
    pub fn new(model: &Model, equilibrium: &Equilibrium, records: &Records) -> Self {
        let nodes = model.mesh.nodes.iter().zip(&equilibrium.displacement);
        let elements = model.mesh.elements.iter().zip(&equilibrium.flows);
        Self {
            stepping: records.effort.stepping,
            elements: model.elements.len(),
            steps: records.effort.steps,
            subdivisions: records.effort.subdivisions,
            rate_hz: records.rate_hz,
            histories: records.histories.clone(),
            summary: TransientSummary::new(model, records),
            error_estimate: records.error.relative,
            hole_radius: 0.5 * model.scenario.well.hole_diameter,
            position: nodes.map(|(node, x)| (node.measured_depth, [x[0], x[1]])).collect(),
            friction: elements
                .map(|(element, flow)| (element.top + element.length, flow.friction_coefficient))
                .collect(),
        }
    }

    /// Static (u, v) at a depth, between the nodes on a straight line.
    fn position_at(&self, depth: f64) -> [f64; 2] {
        let below =
            self.position.partition_point(|(node, _)| *node < depth).clamp(1, self.position.len() - 1);
        let ((top, a), (bottom, b)) = (self.position[below - 1], self.position[below]);
        let share = ((depth - top) / (bottom - top)).clamp(0.0, 1.0);
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    }

    /// C_f of the element at a depth.
    fn friction_at(&self, depth: f64) -> Option<f64> {
        let element = self.friction.partition_point(|(bottom, _)| *bottom < depth);
        self.friction.get(element).or(self.friction.last()).map(|(_, friction)| *friction)
    }

    /// The errors of this run against a reference, histories up to `horizon` \[s\].
    fn errors(&self, reference: &Measure, horizon: f64) -> CostErrors {
        let orbits = || self.summary.orbits.iter().zip(&reference.summary.orbits);
        let worst = |errors: &mut dyn Iterator<Item = f64>| errors.fold(0.0_f64, f64::max);
        let relative = |value: f64, reference: f64| {
            if reference == 0.0 { 0.0 } else { (value - reference).abs() / reference.abs() }
        };
        let lines =
            self.summary.spectra.iter().zip(&reference.summary.spectra).filter_map(|(of, reference)| {
                let strongest = reference.lines.first()?.frequency_hz.abs();
                of.lines.iter().map(|line| (line.frequency_hz.abs() - strongest).abs()).reduce(f64::min)
            });
        let (mut friction_distance, mut friction) = (0.0, 0.0);
        for ((bottom, value), (top, _)) in self.friction.iter().zip(&self.position) {
            if let Some(reference) = reference.friction_at(0.5 * (top + bottom)) {
                friction_distance += (bottom - top) * (value - reference).abs();
                friction += (bottom - top) * reference;
            }
        }
        CostErrors {
            trajectory: trajectory_error(
                &self.histories,
                &reference.histories,
                (horizon * self.rate_hz) as usize,
            ),
            orbit_size: worst(&mut orbits().map(|(a, b)| relative(a.orbit_radius_rms, b.orbit_radius_rms))),
            mean_radius: worst(&mut orbits().map(|(a, b)| relative(a.mean_radius, b.mean_radius))),
            line_frequency_hz: lines.reduce(f64::max),
            static_position: worst(&mut self.position.iter().map(|&(depth, [u, v])| {
                let [u_reference, v_reference] = reference.position_at(depth);
                (u - u_reference).hypot(v - v_reference) / self.hole_radius
            })),
            friction_coefficient: (friction > 0.0).then(|| friction_distance / friction),
            energy: self.summary.energy_residual_ratio,
            estimate: self.error_estimate,
        }
    }
}

/// L2 distance of the first `samples` samples over the motion away from the start; absent where nothing moved.
fn trajectory_error(of: &[NodeHistory], reference: &[NodeHistory], samples: usize) -> Option<f64> {
    let (mut distance, mut motion) = (0.0, 0.0);
    for (a, b) in of.iter().zip(reference) {
        for (a, b) in [(&a.u, &b.u), (&a.v, &b.v)] {
            for (x, y) in a.iter().zip(b).take(samples) {
                distance += (x - y).powi(2);
                motion += (y - b[0]).powi(2);
            }
        }
    }
    (motion > 0.0).then(|| (distance / motion).sqrt())
}

/// Compares the runs of a study. `runs` belong to the runs of [`plan`], in its order; each is its measure with its
/// processor time \[s\], or why it failed.
///
/// # Errors
/// When the reference failed.
pub fn report(
    scenario: &Scenario,
    planned: &[PlannedRun],
    runs: &[Result<(Measure, f64), String>],
) -> Result<CostReport, StudyError> {
    let with_role = |wanted: fn(&Role) -> bool| {
        planned.iter().zip(runs).filter(move |(planned, _)| wanted(&planned.role))
    };
    let (reference_plan, (reference, _)) = with_role(|role| *role == Role::Reference)
        .map(|(planned, run)| run.as_ref().map(|run| (planned, run)))
        .next()
        .unwrap_or(Err(&String::new()))
        .map_err(|failure| StudyError::Reference(failure.clone()))?;
    let duration = reference_plan.scenario.duration;
    let twin = with_role(|role| *role == Role::Twin).find_map(|(_, run)| run.as_ref().ok());
    let histories_part_at =
        twin.and_then(|(twin, _)| parting_time(&reference.histories, &twin.histories, reference.rate_hz));
    let horizon = histories_part_at.unwrap_or(duration);
    let row = |(planned, run): (&PlannedRun, &Result<(Measure, f64), String>), against: &Measure| {
        let stepping = planned.scenario.accuracy.time_stepping();
        let measure = run.as_ref().ok();
        let cpu_time = measure.map_or(0.0, |(_, cpu_time)| *cpu_time);
        CostRow {
            effect: if let Role::Without { effect } = planned.role { Some(effect) } else { None },
            integrator: stepping.integrator,
            step: stepping.step,
            mesh_factor: if let Role::Mesh { factor } = planned.role { factor } else { 1.0 },
            elements: measure.map_or(0, |(measure, _)| measure.elements),
            steps: measure.map_or(0, |(measure, _)| measure.steps),
            step_subdivisions: measure.map_or(1, |(measure, _)| measure.subdivisions),
            cpu_time,
            cpu_per_simulated_second: cpu_time / duration,
            errors: measure.map(|(measure, _)| measure.errors(against, horizon)),
            failure: run.as_ref().err().cloned(),
        }
    };
    let methods: Vec<CostRow> =
        with_role(|role| *role == Role::Method).map(|run| row(run, reference)).collect();
    let meshes = || with_role(|role| matches!(role, Role::Mesh { .. }));
    // Sorted from coarse to fine.
    let finest = meshes().filter_map(|(_, run)| run.as_ref().ok()).next_back().map(|(measure, _)| measure);
    let mut warnings = Vec::new();
    if let Some(residual) = reference.summary.energy_residual_ratio.filter(|ratio| *ratio > UNSOUND_RESIDUAL)
    {
        warnings.push(format!(
            "the reference's own energy residual is {residual:.1e} of the contacts' net work: do not trust these errors"
        ));
    }
    if !planned[0].scenario.contact.reference_length.is_some_and(|length| length > 0.0)
        && meshes().next().is_some()
    {
        warnings.push(
            "contact stiffness and damping are a node's, so a finer mesh meets a stiffer wall and need not converge; \
             contact.reference_length makes them the length's"
                .to_owned(),
        );
    }
    let recommend = |&wanted: &f64| recommendation(wanted, &methods, duration, scenario.duration);
    Ok(CostReport {
        scenario: scenario.name.clone(),
        duration,
        scenario_duration: scenario.duration,
        window: reference_plan
            .scenario
            .recording
            .orbit_window
            .unwrap_or(TimeWindow { from: 0.0, to: duration }),
        histories_part_at,
        reference: with_role(|role| *role == Role::Reference)
            .map(|run| row(run, reference))
            .next()
            .ok_or_else(|| StudyError::Reference("it is missing".to_owned()))?,
        meshes: finest.map_or_else(Vec::new, |finest| meshes().map(|run| row(run, finest)).collect()),
        effects: with_role(|role| matches!(role, Role::Without { .. }))
            .map(|run| row(run, reference))
            .collect(),
        recommendations: if methods.is_empty() { Vec::new() } else { WANTED.iter().map(recommend).collect() },
        methods,
        warnings,
    })
}

/// The cheapest run whose orbit size errs by no more than `wanted`, all finer and dearer runs of its method keeping to that
/// as well: one that hits by chance is none.
fn recommendation(wanted: f64, methods: &[CostRow], duration: f64, scenario_duration: f64) -> Recommendation {
    let within = |row: &CostRow| row.errors.is_some_and(|errors| errors.orbit_size <= wanted);
    let holds = |row: &&CostRow| {
        let finer =
            methods.iter().filter(|other| other.integrator == row.integrator && other.step <= row.step);
        finer.into_iter().all(within)
    };
    let best = methods.iter().filter(holds).min_by(|a, b| a.cpu_time.total_cmp(&b.cpu_time));
    let percent = 100.0 * wanted;
    let text = match best {
        Some(row) => format!(
            "{percent} % of orbit size: {} with a step of {} ms, {:.3} CPU s per simulated s, {:.0} s for {} s",
            row.integrator.name(),
            1e3 * row.step,
            row.cpu_per_simulated_second,
            row.cpu_time / duration * scenario_duration,
            scenario_duration
        ),
        None => format!("{percent} % of orbit size: none of these; take a smaller step"),
    };
    Recommendation {
        orbit_size: wanted,
        integrator: best.map(|row| row.integrator),
        step: best.map(|row| row.step),
        cpu_time: best.map(|row| row.cpu_time / duration * scenario_duration),
        text,
    }
}
