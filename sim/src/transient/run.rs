//! The loop over steps: what is recorded, booked and checked on the way.

use serde::{Deserialize, Serialize};

use super::checkpoint::{self, Checkpoint, CheckpointError};
use super::energy::{EnergyRow, Ledger, Work};
use super::error::ErrorSum;
use super::esdirk::Esdirk;
use super::failure::{DivergenceReason, TransientError};
use super::forces::{ContactForces, Forces};
use super::generalized_alpha::{self, GeneralizedAlpha};
use super::implicit::SweepMonitor;
use super::records::{ContactStatistics, NodeHistory};
use super::rk4::{self, Rk4};
use super::{Outcome, Records, TransientEffort, recorded_nodes, stability};
use crate::control::Control;
use crate::linalg::NodalField;
use crate::model::{DynamicSystem, Model, NodalVector};
use crate::scenario::Integrator;

/// Rows of the energy ledger per second of simulated time.
const LEDGER_RATE_HZ: f64 = 10.0;

/// A run that solves for D degrees of freedom a node.
pub(super) struct Run<'m, const D: usize> {
    model: &'m Model,
    system: DynamicSystem<D>,
    forces: Forces<D>,
    /// Displacements at the start, of all degrees of freedom.
    rest: NodalVector,
    /// Those that are solved for.
    initial: NodalField<D>,
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
pub(super) struct Progress<const D: usize> {
    pub(super) sample: u64,
    pub(super) state: State<D>,
    pub(super) work: Work,
    pub(super) monitor: SweepMonitor,
    pub(super) errors: ErrorSum,
    pub(super) rejected: u64,
    pub(super) steps: u64,
    pub(super) histories: Vec<NodeHistory>,
    pub(super) contacts: Vec<ContactStatistics>,
    pub(super) energy: Vec<EnergyRow>,
}

/// Motion at a step's end, with what the methods carry from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct State<const D: usize> {
    #[serde(with = "checkpoint::nodal")]
    pub(super) displacement: NodalField<D>,
    #[serde(with = "checkpoint::nodal")]
    pub(super) velocity: NodalField<D>,
    #[serde(with = "checkpoint::nodal")]
    pub(super) acceleration: NodalField<D>,
    /// Powers at the step's end (the first stage of the next ESDIRK step).
    pub(super) stage_power: Work,
    /// Step of the adaptive method \[s\].
    pub(super) adaptive_step: f64,
}

/// Where a step's work and error are entered.
pub(super) struct Books<'a, const D: usize> {
    pub(super) ledger: &'a mut Ledger<D>,
    pub(super) errors: &'a mut ErrorSum,
}

#[derive(Debug, Clone)]
enum Stepper<const D: usize> {
    GeneralizedAlpha(Box<GeneralizedAlpha<D>>),
    Esdirk(Box<Esdirk<D>>),
    Rk4(Box<Rk4<D>>),
}

impl<'m, const D: usize> Run<'m, D> {
    /// A run of the degrees of freedom `places` of `system`, from the displacements `rest` with the normal forces there.
    pub(super) fn new(
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
        let start = NodalField::from_nodes(&initial);
        let initial = &initial;
        let ledger = Ledger::new(model, &system, initial);
        let interval = 1.0 / scenario.recording.rate_hz;
        let samples = (scenario.duration * scenario.recording.rate_hz).round() as u64;
        let ledger_every = (scenario.recording.rate_hz / LEDGER_RATE_HZ).round().max(1.0) as u64;
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
                state: State::at_rest(&start, stepping.step),
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
                energy: Vec::with_capacity(ledger_rows(samples, ledger_every)),
            },
            model,
            system,
            forces,
            initial: start,
            rest,
            stepper,
            ledger,
            samples,
            interval,
            steps_per_sample,
            ledger_every,
            subdivisions,
            fastest: 0,
        };
        run.start()?;
        Ok(run)
    }

    pub(super) fn go_on_from(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        self.progress = checkpoint.progress_for(&self.model.scenario, self.model.node_count())?;
        self.ledger.set_work(self.progress.work);
        let progress = &mut self.progress;
        for history in &mut progress.histories {
            history.reserve((self.samples - progress.sample) as usize);
        }
        progress.energy.reserve(ledger_rows(self.samples - progress.sample, self.ledger_every));
        Ok(())
    }

    pub(super) fn run(mut self, control: &Control) -> Result<Outcome, TransientError> {
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
        let n = state.displacement.nodes();
        let (mut forces, mut linear) = (NodalField::zeros(n), vec![[0.0; D]; n]);
        let mut contact = ContactForces::none(n);
        let mut external = self.forces.load.clone();
        self.forces.add_unbalance(0.0, &mut external);
        let rates = |group: usize, dof: usize| state.velocity.groups()[group][dof];
        self.forces.contact_into(&state.displacement, rates, &mut contact, &external, &mut forces);
        let mut right = forces.to_nodes();
        self.system.stiffness.multiply_into(&state.displacement.to_nodes(), &mut linear);
        for ((right, linear), held) in right.iter_mut().zip(&linear).zip(&self.system.held) {
            for dof in 0..D {
                right[dof] = if held[dof] { 0.0 } else { right[dof] - linear[dof] };
            }
        }
        rk4::mass_factor(&self.system)?.solve_in_place(&mut right);
        state.acceleration.copy_from_nodes(&right);
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
            history.push(
                &all(state.displacement.node(node), self.rest[node]),
                &all(state.velocity.node(node), [0.0; 6]),
            );
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
        let Self { forces, stepper, ledger, progress, .. } = self;
        let (state, errors) = (&mut progress.state, &mut progress.errors);
        match stepper {
            Stepper::GeneralizedAlpha(method) => {
                for i in 0..self.steps_per_sample {
                    method.advance(forces, start + i as f64 * step, state, Books { ledger, errors });
                    observe(&mut progress.contacts, state, &method.solver.contact, step);
                }
                progress.monitor.merge(&mut method.solver.monitor);
                progress.steps += self.steps_per_sample;
            }
            Stepper::Esdirk(method) => {
                for i in 0..self.steps_per_sample {
                    method.advance(forces, start + i as f64 * step, state, Books { ledger, errors });
                    observe(&mut progress.contacts, state, &method.solver.contact, step);
                }
                progress.monitor.merge(&mut method.solver.monitor);
                progress.steps += self.steps_per_sample;
            }
            Stepper::Rk4(method) => {
                let outcome = method.advance(forces, start, self.interval, state, Books { ledger, errors });
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
        // A solve spreads what is not finite over the whole string; it began where the motion was fastest.
        if !state.displacement.is_finite() || !state.velocity.is_finite() {
            return Err(self.diverged(self.fastest, DivergenceReason::NotFinite));
        }
        let (x, v) = (&state.displacement, &state.velocity);
        for node in 0..x.nodes() {
            let speed_squared = v[(node, 0)] * v[(node, 0)] + v[(node, 1)] * v[(node, 1)];
            if speed_squared > highest_speed {
                (fastest, highest_speed) = (node, speed_squared);
            }
            let radius_squared = x[(node, 0)] * x[(node, 0)] + x[(node, 1)] * x[(node, 1)];
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
    /// Takes over another state of the same string.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self { displacement, velocity, acceleration, stage_power, adaptive_step } = self;
        displacement.copy_from(&other.displacement);
        velocity.copy_from(&other.velocity);
        acceleration.copy_from(&other.acceleration);
        *stage_power = other.stage_power;
        *adaptive_step = other.adaptive_step;
    }

    pub(super) fn at_rest(displacement: &NodalField<D>, adaptive_step: f64) -> Self {
        let zero = NodalField::zeros(displacement.nodes());
        Self {
            displacement: displacement.clone(),
            velocity: zero.clone(),
            acceleration: zero,
            stage_power: Work::default(),
            adaptive_step,
        }
    }
}

/// Rows of the ledger over so many samples, the one at the end included.
fn ledger_rows(samples: u64, every: u64) -> usize {
    (samples / every) as usize + 2
}

/// Equal steps, none longer than `step`, that fill `interval` \[s\].
pub(super) fn steps_per_interval(interval: f64, step: f64) -> u64 {
    (interval / step * (1.0 - 1e-9)).ceil().max(1.0) as u64
}

fn observe<const D: usize>(
    statistics: &mut [ContactStatistics],
    state: &State<D>,
    contact: &ContactForces,
    duration: f64,
) {
    contact.each_node(statistics.len(), |node, contact| {
        let x = &state.displacement;
        statistics[node].observe([x[(node, 0)], x[(node, 1)]], &contact, duration);
    });
}
