//! The run in time: equation (37) from the equilibrium at rest, unbalance on from t = 0.
//!
//! Tension, torque and the mud's coefficients are frozen at the equilibrium (physics.md section 8). A run can be
//! watched, cancelled and suspended through a [`Control`]; a suspended run goes on from its [`Checkpoint`] to the
//! same bits as one that was never interrupted.

mod checkpoint;
mod energy;
mod error;
mod esdirk;
mod forces;
mod forms;
mod generalized_alpha;
mod implicit;
mod records;
mod rk4;
mod stability;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use energy::EnergyRow;
pub use error::ErrorEstimate;
pub use implicit::SweepMonitor;
pub use records::{ContactStatistics, NodeHistory};

use serde::{Deserialize, Serialize};

use crate::control::Control;
use crate::ensemble::disturbance;
use crate::linalg::SingularBlock;
use crate::model::{DynamicSystem, Model, NodalVector};
use crate::scenario::{Integrator, Problem, Scenario, TimeStepping};
use crate::statics::Equilibrium;
use energy::{Ledger, Work};
use error::ErrorSum;
use esdirk::Esdirk;
use forces::{ContactForces, Forces};
use generalized_alpha::GeneralizedAlpha;
use rk4::Rk4;

/// Rows of the energy ledger per second of simulated time.
const LEDGER_RATE_HZ: f64 = 10.0;

/// A run under way.
pub struct Transient<'m>(Solved<'m>);

/// The run, by how many degrees of freedom of a node move: those that are held along the whole string are not solved for.
enum Solved<'m> {
    Six(Box<Run<'m, 6>>),
    Five(Box<Run<'m, 5>>),
    Four(Box<Run<'m, 4>>),
}

/// A run that solves for D degrees of freedom a node.
struct Run<'m, const D: usize> {
    model: &'m Model,
    system: DynamicSystem<D>,
    forces: Forces<D>,
    /// Displacements at the start, of all degrees of freedom.
    rest: NodalVector,
    /// Those that are solved for.
    initial: NodalVector<D>,
    stepper: Stepper<D>,
    ledger: Ledger<D>,
    /// Samples of a whole run.
    samples: u64,
    interval: f64,
    steps_per_sample: u64,
    ledger_every: u64,
    subdivisions: u32,
    /// Node that moved fastest at the last sample, from 0.
    fastest: usize,
    progress: Progress<D>,
}

/// Everything that changes during a run and is not scratch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Progress<const D: usize> {
    sample: u64,
    state: State<D>,
    work: Work,
    monitor: SweepMonitor,
    errors: ErrorSum,
    rejected: u64,
    steps: u64,
    histories: Vec<NodeHistory>,
    contacts: Vec<ContactStatistics>,
    energy: Vec<EnergyRow>,
}

/// Motion at a step's end, with what the methods carry from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State<const D: usize> {
    #[serde(with = "checkpoint::nodal")]
    displacement: NodalVector<D>,
    #[serde(with = "checkpoint::nodal")]
    velocity: NodalVector<D>,
    #[serde(with = "checkpoint::nodal")]
    acceleration: NodalVector<D>,
    /// Powers at the step's end (the first stage of the next ESDIRK step).
    stage_power: Work,
    /// Step of the adaptive method \[s\].
    adaptive_step: f64,
}

/// Where a step's work and error are entered.
struct Books<'a, const D: usize> {
    ledger: &'a mut Ledger<D>,
    errors: &'a mut ErrorSum,
}

#[derive(Debug, Clone)]
enum Stepper<const D: usize> {
    GeneralizedAlpha(Box<GeneralizedAlpha<D>>),
    Esdirk(Box<Esdirk<D>>),
    Rk4(Box<Rk4<D>>),
}

/// What a finished run leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Records {
    /// Recording rate \[Hz\].
    pub rate_hz: f64,
    /// Histories of the recorded nodes.
    pub histories: Vec<NodeHistory>,
    /// Contact statistics of every node.
    pub contacts: Vec<ContactStatistics>,
    /// The energy ledger, ten rows a second and one at the end.
    pub energy: Vec<EnergyRow>,
    /// What the last row's residual may be at most \[J\]; a run that exceeds it ends as diverged.
    pub energy_bound: f64,
    /// Estimated error of the lateral displacements.
    pub error: ErrorEstimate,
    /// What the run took.
    pub effort: TransientEffort,
}

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TransientEffort {
    /// Integrator and step as used.
    pub stepping: TimeStepping,
    /// Parts into which each step was cut so that the contact sweeps are stable.
    pub subdivisions: u32,
    /// Steps made.
    pub steps: u64,
    /// Steps rejected by the adaptive method.
    pub rejected_steps: u64,
    /// Contact sweeps and how far from standing still they ended.
    pub sweeps: SweepMonitor,
}

/// How a call to [`Transient::run`] ended.
#[derive(Debug)]
pub enum Outcome {
    /// The run is complete.
    Finished(Box<Records>),
    /// It was cancelled.
    Cancelled,
    /// It was suspended, and goes on from here.
    Suspended(Box<Checkpoint>),
}

/// Why a run ended without a result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TransientError {
    /// A matrix cannot be factored.
    #[error("the matrix of a step is singular at node {}", .0.row + 1)]
    Singular(#[from] SingularBlock),
    /// A fixed step beyond the explicit method's stability limit.
    #[error("a step of {step:e} s is beyond the stability limit of rk4 for this mesh, {limit:.3e} s")]
    StepBeyondStability {
        /// The step asked for \[s\].
        step: f64,
        /// The largest stable one \[s\].
        limit: f64,
    },
    /// The contact is so stiff that no step is short enough.
    #[error(
        "two contact sweeps need the step of {step:e} s cut into more than {most} parts at node {node}: its contact is too stiff for \
         its mass"
    )]
    ContactTooStiff {
        /// The step asked for \[s\].
        step: f64,
        /// Parts into which a step may be cut.
        most: u32,
        /// The node with the stiffest contact for its mass, from 1.
        node: usize,
    },
    /// The motion left every bound.
    #[error("diverged at t = {time:.6} s, node {node} (depth {measured_depth:.2} m): {reason}")]
    Diverged {
        /// Simulated time \[s\] up to which the state was finite and inside the hole.
        time: f64,
        /// Node, from 1.
        node: usize,
        /// Its measured depth \[m\].
        measured_depth: f64,
        /// What was seen.
        reason: DivergenceReason,
    },
}

/// How a divergence showed itself.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DivergenceReason {
    /// A value was not finite.
    #[error("a displacement or velocity is not finite")]
    NotFinite,
    /// A node was pushed far into the rock.
    #[error("the string is {radius:.3} m off the axis of a hole of radius {hole_radius:.3} m")]
    OutsideHole {
        /// Distance from the axis \[m\].
        radius: f64,
        /// Radius of the hole \[m\].
        hole_radius: f64,
    },
    /// More energy appeared or vanished than the method may make of it.
    #[error(
        "the energy ledger leaves {residual:.3e} J, more than its bound of {bound:.3e} J: the steps are too long for this contact"
    )]
    EnergyNotConserved {
        /// What is left over \[J\].
        residual: f64,
        /// Its bound \[J\].
        bound: f64,
    },
    /// The adaptive step shrank to nothing.
    #[error("the adaptive step collapsed")]
    StepCollapsed,
}

impl TransientError {
    /// The node where the failure shows, from 1; absent where it is the whole string's.
    pub fn node(&self) -> Option<usize> {
        match self {
            Self::Singular(block) => Some(block.row + 1),
            Self::StepBeyondStability { .. } => None,
            Self::ContactTooStiff { node, .. } | Self::Diverged { node, .. } => Some(*node),
        }
    }
}

impl<'m> Transient<'m> {
    /// A run of `model` from its equilibrium, as its scenario says.
    ///
    /// # Errors
    /// When a matrix is singular or an explicit step is beyond its stability limit.
    pub fn new(model: &'m Model, equilibrium: &Equilibrium) -> Result<Self, TransientError> {
        Self::member(model, equilibrium, 0)
    }

    /// A run of `model` as a member of its [ensemble](crate::ensemble): from the equilibrium (0), or slightly beside it.
    ///
    /// # Errors
    /// As [`Transient::new`].
    pub fn member(model: &'m Model, equilibrium: &Equilibrium, member: u32) -> Result<Self, TransientError> {
        let system = model.dynamic_system(equilibrium);
        let mut rest = disturbance(model, member);
        for (value, at_rest) in rest.iter_mut().flatten().zip(equilibrium.displacement.iter().flatten()) {
            *value += at_rest;
        }
        let rest = (rest, equilibrium.normal_force.as_slice());
        Ok(Self(match *system.moving() {
            [a, b, c, d] => Solved::Four(Box::new(Run::new(model, &system, [a, b, c, d], rest)?)),
            [a, b, c, d, e] => Solved::Five(Box::new(Run::new(model, &system, [a, b, c, d, e], rest)?)),
            _ => Solved::Six(Box::new(Run::new(model, &system, system.places, rest)?)),
        }))
    }

    /// A run that goes on from a checkpoint of the same scenario.
    ///
    /// # Errors
    /// When the checkpoint belongs to another scenario or model version, or as [`Transient::new`].
    pub fn resume(
        model: &'m Model,
        equilibrium: &Equilibrium,
        checkpoint: &Checkpoint,
    ) -> Result<Self, CheckpointError> {
        let mut transient = Self::new(model, equilibrium)?;
        match &mut transient.0 {
            Solved::Six(run) => run.go_on_from(checkpoint)?,
            Solved::Five(run) => run.go_on_from(checkpoint)?,
            Solved::Four(run) => run.go_on_from(checkpoint)?,
        }
        Ok(transient)
    }

    /// Degrees of freedom of a node that the run solves for.
    pub fn degrees_of_freedom(&self) -> usize {
        match &self.0 {
            Solved::Six(_) => 6,
            Solved::Five(_) => 5,
            Solved::Four(_) => 4,
        }
    }

    /// Runs to the end of the scenario's duration, or until `control` stops it.
    ///
    /// # Errors
    /// When the motion diverges.
    pub fn run(self, control: &Control) -> Result<Outcome, TransientError> {
        match self.0 {
            Solved::Six(run) => run.run(control),
            Solved::Five(run) => run.run(control),
            Solved::Four(run) => run.run(control),
        }
    }
}

impl<'m, const D: usize> Run<'m, D> {
    /// A run of the degrees of freedom `places` of `system`, from the displacements `rest` with the normal forces there.
    fn new(
        model: &'m Model,
        system: &DynamicSystem,
        places: [usize; D],
        (rest, normal_force): (NodalVector, &[f64]),
    ) -> Result<Self, TransientError> {
        let scenario = &model.scenario;
        let stepping = scenario.accuracy.time_stepping();
        let subdivisions = stability::subdivisions(model, system, normal_force, &stepping)?;
        let rk4_limit = match stepping.integrator {
            Integrator::Rk4 => stability::rk4_limit(model, system)?,
            _ => f64::INFINITY,
        };
        let system = system.reduced_to(places);
        let forces = Forces::new(model, &system);
        let initial: NodalVector<D> = rest.iter().map(|rest| places.map(|place| rest[place])).collect();
        let initial = &initial;
        let ledger = Ledger::new(model, &system, initial);
        let interval = 1.0 / scenario.recording.rate_hz;
        let samples = (scenario.duration * scenario.recording.rate_hz).round() as u64;
        let steps_per_sample = steps_per_interval(interval, stepping.step) * u64::from(subdivisions);
        let step = interval / steps_per_sample as f64;
        let hole_radius = 0.5 * scenario.well.hole_diameter;
        let stepper = match stepping.integrator {
            Integrator::GeneralizedAlpha => Stepper::GeneralizedAlpha(Box::new(GeneralizedAlpha::new(
                &system,
                initial,
                step,
                stepping.contact_sweeps,
                stepping.spectral_radius.unwrap_or(generalized_alpha::SPECTRAL_RADIUS),
            )?)),
            Integrator::Esdirk4 => {
                Stepper::Esdirk(Box::new(Esdirk::new(&system, initial, step, stepping.contact_sweeps)?))
            }
            Integrator::Rk4 => {
                if stepping.tolerance.is_none() && stepping.step > rk4_limit {
                    let limit = rk4_limit;
                    return Err(TransientError::StepBeyondStability { step: stepping.step, limit });
                }
                let largest = stepping.step.min(0.95 * rk4_limit);
                let largest = if stepping.tolerance.is_none() { stepping.step } else { largest };
                Stepper::Rk4(Box::new(Rk4::new(&system, largest, stepping.tolerance, hole_radius)?))
            }
        };
        let mut run = Self {
            progress: Progress {
                sample: 0,
                state: State::at_rest(initial, stepping.step),
                work: Work::default(),
                monitor: SweepMonitor::default(),
                errors: ErrorSum::default(),
                rejected: 0,
                steps: 0,
                histories: recorded_nodes(model)
                    .into_iter()
                    .map(|node| NodeHistory::with_capacity(node, samples as usize))
                    .collect(),
                contacts: vec![ContactStatistics::default(); model.node_count()],
                energy: Vec::new(),
            },
            model,
            system,
            forces,
            initial: initial.clone(),
            rest,
            stepper,
            ledger,
            samples,
            interval,
            steps_per_sample,
            ledger_every: (scenario.recording.rate_hz / LEDGER_RATE_HZ).round().max(1.0) as u64,
            subdivisions,
            fastest: 0,
        };
        run.start()?;
        Ok(run)
    }

    fn go_on_from(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        self.progress = checkpoint.progress_for(&self.model.scenario, self.model.node_count())?;
        self.ledger.set_work(self.progress.work);
        Ok(())
    }

    fn run(mut self, control: &Control) -> Result<Outcome, TransientError> {
        while self.progress.sample < self.samples {
            if control.is_cancelled() {
                return Ok(Outcome::Cancelled);
            }
            // The ledger adds up between its rows: a run is suspended at one of them.
            if control.is_suspended() && self.progress.sample.is_multiple_of(self.ledger_every) {
                self.progress.work = self.ledger.work();
                return Ok(Outcome::Suspended(Box::new(Checkpoint::new(
                    &self.model.scenario,
                    &self.progress,
                ))));
            }
            self.record()?;
            self.advance()?;
            control.report(self.time());
        }
        let time = self.time();
        let energy_bound = self.book(time)?;
        let scenario = &self.model.scenario;
        let stepping = scenario.accuracy.time_stepping();
        Ok(Outcome::Finished(Box::new(Records {
            rate_hz: scenario.recording.rate_hz,
            histories: self.progress.histories,
            contacts: self.progress.contacts,
            energy: self.progress.energy,
            energy_bound,
            error: self.progress.errors.estimate(stepping.integrator, self.model.node_count()),
            effort: TransientEffort {
                stepping,
                subdivisions: self.subdivisions,
                steps: self.progress.steps,
                rejected_steps: self.progress.rejected,
                sweeps: self.progress.monitor,
            },
        })))
    }

    /// Simulated time reached \[s\]: a count times an interval, never a sum.
    fn time(&self) -> f64 {
        self.progress.sample as f64 * self.interval
    }

    /// Acceleration and powers at t = 0, with the dynamic friction law: most of the static friction vanishes there.
    fn start(&mut self) -> Result<(), TransientError> {
        let state = &mut self.progress.state;
        let n = state.displacement.len();
        let mut right = vec![[0.0; D]; n];
        let mut linear = vec![[0.0; D]; n];
        let mut contact = ContactForces::none(n);
        self.forces.external_into(0.0, &mut right);
        self.forces.contact_into(&state.displacement, &state.velocity, &mut contact);
        self.forces.add_contact(&mut right, &contact);
        self.system.stiffness.multiply_into(&state.displacement, &mut linear);
        for ((right, linear), held) in right.iter_mut().zip(&linear).zip(&self.system.held) {
            for dof in 0..D {
                right[dof] = if held[dof] { 0.0 } else { right[dof] - linear[dof] };
            }
        }
        rk4::mass_factor(&self.system)?.solve_in_place(&mut right);
        state.acceleration = right;
        state.stage_power =
            self.ledger.power(&state.velocity, &state.displacement, &contact, self.forces.unbalance_at(0.0));
        observe(&mut self.progress.contacts, state, &contact, 0.0);
        Ok(())
    }

    fn record(&mut self) -> Result<(), TransientError> {
        for history in &mut self.progress.histories {
            let (node, state) = (history.node, &self.progress.state);
            let all = |values: [f64; D], held: [f64; 6]| {
                self.system.places.iter().zip(values).fold(held, |mut all, (&place, value)| {
                    all[place] = value;
                    all
                })
            };
            history
                .push(&all(state.displacement[node], self.rest[node]), &all(state.velocity[node], [0.0; 6]));
        }
        if self.progress.sample.is_multiple_of(self.ledger_every) {
            let time = self.time();
            self.book(time)?;
        }
        Ok(())
    }

    /// Enters a row into the ledger and returns its bound.
    fn book(&mut self, time: f64) -> Result<f64, TransientError> {
        let state = &self.progress.state;
        self.progress.errors.observe_motion(&state.displacement, &self.initial);
        let row = self.ledger.row(time, &state.displacement, &state.velocity);
        let bound = self.ledger.bound(&row);
        self.progress.energy.push(row);
        // Written so that a residual that is not a number fails.
        if row.residual.abs() <= bound {
            return Ok(bound);
        }
        Err(self
            .diverged(self.fastest, DivergenceReason::EnergyNotConserved { residual: row.residual, bound }))
    }

    /// Advances by one recording interval.
    fn advance(&mut self) -> Result<(), TransientError> {
        let start = self.time();
        let step = self.interval / self.steps_per_sample as f64;
        let Self { system, forces, stepper, ledger, progress, .. } = self;
        let (state, errors) = (&mut progress.state, &mut progress.errors);
        match stepper {
            Stepper::GeneralizedAlpha(method) => {
                for i in 0..self.steps_per_sample {
                    method.advance(system, forces, start + i as f64 * step, state, Books { ledger, errors });
                    observe(&mut progress.contacts, state, &method.solver.contact, step);
                }
                progress.monitor.merge(&mut method.solver.monitor);
                progress.steps += self.steps_per_sample;
            }
            Stepper::Esdirk(method) => {
                for i in 0..self.steps_per_sample {
                    method.advance(system, forces, start + i as f64 * step, state, Books { ledger, errors });
                    observe(&mut progress.contacts, state, &method.solver.contact, step);
                }
                progress.monitor.merge(&mut method.solver.monitor);
                progress.steps += self.steps_per_sample;
            }
            Stepper::Rk4(method) => {
                let outcome =
                    method.advance(system, forces, start, self.interval, state, Books { ledger, errors });
                observe(&mut progress.contacts, state, &method.contact, self.interval);
                progress.steps += std::mem::take(&mut method.steps);
                progress.rejected += std::mem::take(&mut method.rejected);
                if outcome.is_err() {
                    return Err(self.diverged(self.fastest, DivergenceReason::StepCollapsed));
                }
            }
        }
        self.check_bounds()?;
        self.progress.sample += 1;
        Ok(())
    }

    /// Refuses a state that is not finite or outside the hole.
    fn check_bounds(&mut self) -> Result<(), TransientError> {
        let state = &self.progress.state;
        let hole_radius = 0.5 * self.model.scenario.well.hole_diameter;
        // Without a wall the string may swing freely, but not out of the theory of small rotations.
        let bound = if self.model.effects.contact { 2.0 } else { 100.0 } * hole_radius;
        let (mut fastest, mut highest_speed) = (self.fastest, 0.0);
        for (node, (x, v)) in state.displacement.iter().zip(&state.velocity).enumerate() {
            // A solve spreads what is not finite over the whole string; it began where the motion was fastest.
            if !x.iter().chain(v).all(|value| value.is_finite()) {
                return Err(self.diverged(self.fastest, DivergenceReason::NotFinite));
            }
            let speed_squared = v[0] * v[0] + v[1] * v[1];
            if speed_squared > highest_speed {
                (fastest, highest_speed) = (node, speed_squared);
            }
            let radius_squared = x[0] * x[0] + x[1] * x[1];
            if radius_squared > bound * bound {
                let radius = radius_squared.sqrt();
                return Err(self.diverged(node, DivergenceReason::OutsideHole { radius, hole_radius }));
            }
        }
        self.fastest = fastest;
        Ok(())
    }

    fn diverged(&self, node: usize, reason: DivergenceReason) -> TransientError {
        TransientError::Diverged {
            time: self.time(),
            node: node + 1,
            measured_depth: self.model.mesh.nodes[node].measured_depth,
            reason,
        }
    }
}

impl<const D: usize> State<D> {
    fn at_rest(displacement: &NodalVector<D>, adaptive_step: f64) -> Self {
        let zero = vec![[0.0; D]; displacement.len()];
        Self {
            displacement: displacement.clone(),
            velocity: zero.clone(),
            acceleration: zero,
            stage_power: Work::default(),
            adaptive_step,
        }
    }
}

/// Steps of a run of the model's scenario with a stepping of its choice; none where the step adapts itself.
pub fn step_count(model: &Model, stepping: TimeStepping) -> Option<u64> {
    if stepping.tolerance.is_some() {
        return None;
    }
    let recording = &model.scenario.recording;
    let samples = (model.scenario.duration * recording.rate_hz).round() as u64;
    let subdivisions = stability::expected_subdivisions(model, &stepping);
    Some(samples * steps_per_interval(1.0 / recording.rate_hz, stepping.step) * u64::from(subdivisions))
}

/// Equal steps, none longer than `step`, that fill `interval` \[s\].
fn steps_per_interval(interval: f64, step: f64) -> u64 {
    (interval / step * (1.0 - 1e-9)).ceil().max(1.0) as u64
}

/// The largest stable step of RK4 \[s\] for a model about its equilibrium.
///
/// # Errors
/// When the mass matrix is singular.
pub fn rk4_stability_limit(model: &Model, equilibrium: &Equilibrium) -> Result<f64, TransientError> {
    Ok(stability::rk4_limit(model, &model.dynamic_system(equilibrium))?)
}

/// What is wrong with the step of a valid scenario: a fixed step of the explicit method beyond its stability limit. Looked
/// for before a run is queued; it takes an equilibrium and some hundred products, and nothing for the other methods.
pub fn step_problem(scenario: &Scenario) -> Option<Problem> {
    let stepping = scenario.accuracy.time_stepping();
    if stepping.integrator != Integrator::Rk4
        || stepping.tolerance.is_some()
        || !scenario.active_effects().transient
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

/// The nodes whose histories a scenario wants, from 0.
pub fn recorded_nodes(model: &Model) -> Vec<usize> {
    model.scenario.recording.nodes.iter().filter_map(|&choice| model.mesh.chosen_node(choice)).collect()
}

fn observe<const D: usize>(
    statistics: &mut [ContactStatistics],
    state: &State<D>,
    contact: &ContactForces,
    duration: f64,
) {
    for ((statistics, x), contact) in statistics.iter_mut().zip(&state.displacement).zip(contact.nodes()) {
        statistics.observe(x, &contact, duration);
    }
}
