//! The loop over steps, with its recording, bookkeeping and checks.

use std::ops::Range;

use drillsweep_scenario::{Integrator, Scenario, TimeWindow};

use super::checkpoint::{Checkpoint, CheckpointError, Progress};
use super::contact_statistics::ContactStatistics;
use super::histories::{NodeHistory, Series};
use super::loads::{LoadBlocks, Loads, Moment};
use super::recorded::{additional_bit, recorded_nodes};
use super::records::{Outcome, Records, TransientEffort};
use super::settle::{Settle, Settling, course_samples, twin_time};
use super::snapshots::{Recorder, SnapshotBlock, SnapshotTimes, torque};
use crate::control::Control;
use crate::math::dof::{DOFS, Dofs, U, V};
use crate::math::linalg::{Four, Lane, NodalField};
use crate::math::signal::{LONGEST_WINDOW, sample_range};
use crate::solve::model::{Model, NodalVector};
use crate::solve::motion::DynamicSystem;
use crate::solve::statics::Equilibrium;
use crate::solve::step::adaptive::{self, Tolerances};
use crate::solve::step::energy::Ledger;
use crate::solve::step::error_estimate::ErrorSum;
use crate::solve::step::esdirk::Esdirk;
use crate::solve::step::forces::{ActingForces, Forces};
use crate::solve::step::generalized_alpha::{self, GeneralizedAlpha};
use crate::solve::step::grid::Grid;
use crate::solve::step::implicit::ContactIterations;
use crate::solve::step::method::{Books, Method, StepAhead, StepMade};
use crate::solve::step::rk4::{self, Rk4};
use crate::solve::step::state::State;
use crate::solve::step::work::Work;
use crate::solve::step::{DivergenceReason, TransientError};
use crate::solve::step::{dense, resolved_hz, stability};

/// Number of times that the longest step of a run with adaptive steps can be halved. The 8 ms of `draft` end at 62 us, at which the explicit method
/// becomes stable in tool joints (6.4e-5 s in the base case): with yet shorter steps an implicit one would have no point.
const HALVINGS: u32 = 7;

/// Rows of the energy ledger per second of simulated time: several a turn of a drillstring, and few next to the steps, of which there are
/// 125 a second at least.
pub const LEDGER_RATE_HZ: f64 = 10.0;

/// Bytes of samples that are handed over in one block.
pub const BLOCK_BYTES: u64 = 8 << 20;

/// Largest number of samples in a block.
const BLOCK_SAMPLES: u64 = 8192;

/// Part of RK4's stability limit up to which it lengthens its steps by itself. The limit is found by a Rayleigh quotient, which converges from
/// below and so makes steps too long, if only by 1e-5 in the base case. It is that of symmetric matrices, without the contributions of gyroscopic
/// moments, flows and friction.
const BELOW_RK4_LIMIT: f64 = 0.95;

/// Longest time \[s\] that RK4 advances at once, so that loads are observed as often as by the other methods.
const RK4_REACH: f64 = 1e-3;

/// A run that solves for D degrees of freedom a node.
pub(super) struct Run<'m, const D: usize> {
    model: &'m Model,
    system: DynamicSystem<D>,
    forces: Forces<D>,
    /// Displacements at the start, of all degrees of freedom.
    rest: NodalVector,
    /// Initial displacements of the degrees of freedom that are solved for.
    initial: NodalField<D>,
    method: Box<dyn Method<D>>,
    ledger: Ledger<D>,
    /// Forces at the present state.
    acting: ActingForces,
    /// Samples of a whole run.
    samples: u64,
    grid: Grid,
    /// Tolerances of the step; absent with fixed steps.
    tolerances: Option<Tolerances>,
    /// Samples from one row of the ledger to the next.
    ledger_every: u64,
    /// Recording intervals that count for the contacts' impulse.
    orbit_samples: Range<u64>,
    settle: Settle,
    loads: Loads<D>,
    subdivisions: u32,
    /// Samples of a block; a step may add some more.
    block_samples: u64,
    /// Node that moved fastest at the last sample, from 0.
    fastest: usize,
    /// Samples of the recorded nodes that were not handed over yet.
    block: Vec<NodeHistory>,
    /// Samples of the bit that were not handed over yet, if it is recorded with the nodes.
    bit: Option<NodeHistory>,
    /// Recorder of snapshots; absent if none are requested.
    snapshots: Option<Recorder<D>>,
    progress: Progress<D>,
}

/// Data that a run has recorded since the last block.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Samples of the recorded nodes.
    pub histories: &'a [NodeHistory],
    /// The same samples of the bit, if its rotation and torque are recorded in addition: [`additional_bit`](additional_bit).
    pub bit: Option<&'a NodeHistory>,
    /// Snapshots; absent if none are requested.
    pub snapshots: Option<&'a SnapshotBlock>,
}

/// Takes a block of recorded data, which follows the block before; its error is the reason for which the block cannot be kept.
pub type Keep<'a> = dyn FnMut(Block<'_>) -> Result<(), String> + 'a;

/// Start of a run.
pub(super) struct Start<'a> {
    /// Displacements at the start, of all degrees of freedom.
    pub(super) rest: NodalVector,
    pub(super) equilibrium: &'a Equilibrium,
    /// Longest step that resolves all that the run must resolve \[s\].
    pub(super) resolving_step: f64,
}

impl<'m, const D: usize> Run<'m, D> {
    /// A run of the degrees of freedom `freedoms` of `system`, from a start, with adaptive steps of at most `resolving_step` \[s\].
    pub(super) fn new(
        model: &'m Model,
        system: &DynamicSystem,
        freedoms: Dofs<D>,
        Start { rest, equilibrium, resolving_step }: Start<'_>,
    ) -> Result<Self, TransientError> {
        let scenario = &model.scenario;
        let stepping = scenario.accuracy.time_stepping();
        let subdivisions = stability::subdivisions(model, system, &equilibrium.normal_force, &stepping)?;
        let rk4_limit = match stepping.integrator {
            Integrator::Rk4 => stability::rk4_limit(model, system)?,
            _ => f64::INFINITY,
        };
        let system = system.reduced_to(freedoms);
        let forces = Forces::new(model, &system);
        let initial: NodalVector<D> = rest.iter().map(|rest| freedoms.of(rest)).collect();
        let start = NodalField::from_nodes(&initial);
        let initial = &initial;
        let ledger = Ledger::new(model, &system, initial);
        let interval = 1.0 / scenario.recording.rate_hz;
        let samples = (scenario.duration * scenario.recording.rate_hz).round() as u64;
        let ledger_every = (scenario.recording.rate_hz / LEDGER_RATE_HZ).round().max(1.0) as u64;
        let longest =
            (stepping.step / f64::from(subdivisions)).min(resolving_step).min(forces.points.longest_step());
        let hole_radius = 0.5 * scenario.well.hole_diameter;
        let (longest, halvings) = match (stepping.integrator, stepping.tolerance) {
            // RK4 makes steps of its own within these.
            (Integrator::Rk4, _) => (interval.min(RK4_REACH), 0),
            (_, Some(_)) => (longest, HALVINGS),
            (_, None) => (longest, 0),
        };
        let grid = Grid::new(interval, longest, halvings);
        let tolerances = stepping.tolerance.map(|tolerance| Tolerances::new(tolerance, hole_radius));
        let method: Box<dyn Method<D>> = match stepping.integrator {
            Integrator::GeneralizedAlpha => Box::new(GeneralizedAlpha::new(
                &system,
                initial,
                &forces,
                grid.step(0),
                stepping.contact_sweeps,
                stepping.spectral_radius.unwrap_or(generalized_alpha::SPECTRAL_RADIUS),
            )?),
            Integrator::Esdirk4 => {
                Box::new(Esdirk::new(&system, initial, &forces, &grid, stepping.contact_sweeps)?)
            }
            Integrator::Rk4 => {
                if stepping.tolerance.is_none() && stepping.step > rk4_limit {
                    let limit = rk4_limit;
                    return Err(TransientError::StepBeyondStability { step: stepping.step, limit });
                }
                let largest = stepping.step.min(BELOW_RK4_LIMIT * rk4_limit);
                let largest = if stepping.tolerance.is_none() { stepping.step } else { largest };
                Box::new(Rk4::new(&system, &forces, largest, stepping.tolerance, hole_radius)?)
            }
        };
        // A step may end beyond the block.
        let of_a_step = (1_u64 << grid.top()).div_ceil(grid.at_sample(1));
        let block_samples = block_samples(model);
        let block_capacity = (block_samples + of_a_step).min(samples);
        let settle = Settle::new(model, equilibrium, samples, ledger_every);
        let orbit_samples = orbit_samples(scenario, samples);
        let fixed = scenario
            .orbit_window()
            .map(|_| grid.at_sample(orbit_samples.start)..grid.at_sample(orbit_samples.end));
        let blocks = (grid.at_sample(settle.block()), fixed);
        let loads = Loads::new(model, equilibrium, freedoms, &rest, blocks);
        let mut run = Self {
            progress: Progress {
                course: settle.course(model),
                ticks: 0,
                // The first events are resolved; after them steps double as long as they may.
                level: if tolerances.is_some() { grid.top() / 2 } else { grid.top() },
                ceiling: grid.top(),
                state: State::at_rest(&start, forces.points.start(), stepping.step),
                work: Work::default(),
                iterations: ContactIterations::default(),
                errors: ErrorSum::default(),
                rejected: 0,
                unresolved: 0,
                step_range: [f64::INFINITY, 0.0],
                steps: 0,
                contacts: vec![ContactStatistics::default(); model.node_count()],
                energy: Vec::with_capacity(ledger_rows(samples, ledger_every)),
                loads: LoadBlocks::default(),
                twin_starts: Vec::new(),
            },
            model,
            system,
            acting: ActingForces::none(&forces),
            snapshots: Recorder::new(model, &forces, of_a_step),
            forces,
            initial: start,
            rest,
            method,
            ledger,
            samples,
            grid,
            tolerances,
            ledger_every,
            orbit_samples,
            settle,
            loads,
            subdivisions,
            block_samples,
            fastest: 0,
            block: recorded_nodes(model)
                .into_iter()
                .map(|node| NodeHistory::with_capacity(node, block_capacity as usize))
                .collect(),
            bit: additional_bit(model).map(|bit| NodeHistory::with_capacity(bit, block_capacity as usize)),
        };
        run.start()?;
        Ok(run)
    }

    pub(super) fn go_on_from(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        self.progress = checkpoint.progress_for(&self.model.scenario, self.model.node_count())?;
        self.ledger.set_work(self.progress.work);
        self.touch();
        self.begin_loads();
        let progress = &mut self.progress;
        progress
            .energy
            .reserve(ledger_rows(self.samples - progress.ticks / self.grid.at_sample(1), self.ledger_every));
        progress.course.reserve(course_samples(&self.model.scenario) as usize);
        Ok(())
    }

    /// Continues as a twin of the run of a checkpoint, `away` from it, for `time` \[s\].
    pub(super) fn go_on_beside(
        &mut self,
        checkpoint: &Checkpoint,
        away: &NodalVector,
        time: f64,
    ) -> Result<(), CheckpointError> {
        self.go_on_from(checkpoint)?;
        let freedoms = self.system.freedoms;
        let displacement = &mut self.progress.state.displacement;
        for (node, away) in away.iter().enumerate() {
            for (dof, away) in freedoms.of(away).into_iter().enumerate() {
                displacement[(node, dof)] += away;
            }
        }
        self.accelerate()?;
        self.settle.close();
        self.loads.close();
        let samples = (time * self.model.scenario.recording.rate_hz).round() as u64;
        self.samples = self.samples.min(self.recorded() + samples);
        Ok(())
    }

    /// Samples of each recorded node that were recorded so far.
    pub(super) fn recorded(&self) -> u64 {
        match self.progress.ticks {
            0 => 0,
            ticks => (ticks / self.grid.at_sample(1) + 1).min(self.samples),
        }
    }

    pub(super) fn model(&self) -> &'m Model {
        self.model
    }

    /// Snapshots that were taken so far.
    pub(super) fn snapshots_taken(&self) -> u64 {
        // As with samples: a run that has not begun has none.
        match (SnapshotTimes::of(&self.model.scenario), self.progress.ticks) {
            (Some(times), 1..) => times.among_first(self.recorded()),
            _ => 0,
        }
    }

    /// Samples of a whole run.
    pub(super) fn samples(&self) -> u64 {
        self.samples
    }

    pub(super) fn run(
        mut self,
        control: &Control,
        keep: &mut Keep<'_>,
    ) -> Result<Outcome<()>, TransientError> {
        let (row, end) = (self.grid.at_sample(self.ledger_every), self.grid.at_sample(self.samples));
        let mut settling = None;
        self.record_start();
        while self.progress.ticks < end {
            if control.is_cancelled() {
                return Ok(Outcome::Cancelled);
            }
            if self.progress.ticks.is_multiple_of(row) {
                control.reach(self.time());
                // The ledger adds up between its rows: a run is suspended at one of them.
                if control.is_suspended() {
                    // A run that has not begun records its start once it does.
                    if self.progress.ticks > 0 {
                        self.hand_over(keep)?;
                    }
                    self.progress.work = self.ledger.work();
                    let checkpoint = Checkpoint::new(&self.model.scenario, &self.progress);
                    return Ok(Outcome::Suspended(Box::new(checkpoint), ()));
                }
                self.keep_twin_start();
                settling = self.settled();
                if settling.is_some() {
                    break;
                }
                self.book()?;
            }
            let next_row = (self.progress.ticks / row + 1) * row;
            self.advance(next_row.min(end))?;
            let is_full = |first: &NodeHistory| first.u.len() as u64 >= self.block_samples;
            if self.block.first().is_some_and(is_full)
                || self.snapshots.as_ref().is_some_and(Recorder::is_full)
            {
                self.hand_over(keep)?;
            }
            control.report(self.time());
        }
        let energy_bound = self.book()?;
        self.hand_over(keep)?;
        // Progress of a settled run is complete, as if it had taken all of its time.
        control.report(self.grid.time(end));
        let simulated_time = self.time();
        let settling = settling.unwrap_or_else(|| self.settle.conclude(&self.progress.course, self.samples));
        let scenario = &self.model.scenario;
        let window_start = self.twin_start(settling.window, simulated_time);
        let load_window = if self.settle.is_open() { settling.kept_window() } else { settling.window };
        let stepping = scenario.accuracy.time_stepping();
        Ok(Outcome::Finished(Box::new(Records {
            rate_hz: scenario.recording.rate_hz,
            simulated_time,
            settling,
            course: self.progress.course,
            histories: (),
            window_start,
            loads: self.loads.records(&self.progress.loads, load_window),
            contacts: self.progress.contacts,
            energy: self.progress.energy,
            energy_bound,
            energy_rounding: self.ledger.rounding(),
            error: self.progress.errors.estimate(stepping.integrator, self.model.node_count()),
            effort: TransientEffort {
                stepping,
                subdivisions: self.subdivisions,
                steps: self.progress.steps,
                rejected_steps: self.progress.rejected,
                unresolved_steps: self.progress.unresolved,
                step_range: self.progress.step_range,
                resolved_hz: resolved_hz(stepping.integrator, self.progress.step_range[1]),
                contact_iterations: self.progress.iterations,
            },
        })))
    }

    /// Verdict on the motion so far; present once it has settled and the run may end.
    fn settled(&self) -> Option<Settling> {
        let sample = self.progress.ticks / self.grid.at_sample(1);
        if !self.settle.is_due(sample) {
            return None;
        }
        self.settle.judge(&self.progress.course, sample)
    }

    /// The start of a finished run's twin, out of those that were kept.
    fn twin_start(&mut self, window: TimeWindow, simulated_time: f64) -> Option<Box<Checkpoint>> {
        let from =
            if self.settle.is_open() { window.to - twin_time(window, simulated_time) } else { window.from };
        let from = self.grid.at_sample((from * self.model.scenario.recording.rate_hz).round() as u64);
        let starts = std::mem::take(&mut self.progress.twin_starts).into_iter();
        starts
            .filter(|(ticks, _)| *ticks < self.progress.ticks)
            .fold(None, |found, (ticks, start)| match found {
                Some((earlier, found)) if earlier >= from => Some((earlier, found)),
                _ => Some((ticks, start)),
            })
            .map(|(_, start)| Box::new(start))
    }

    /// Keeps the state of the run, without data for its own end, if its twin may start here.
    fn keep_twin_start(&mut self) {
        let ticks = self.progress.ticks;
        if self.settle.is_open() {
            if ticks == 0 || !self.settle.is_block(ticks / self.grid.at_sample(1)) {
                return;
            }
            let reach = self.grid.at_sample((LONGEST_WINDOW * self.model.scenario.recording.rate_hz) as u64);
            self.progress.twin_starts.retain(|(start, _)| start + reach >= ticks);
        } else if !self.progress.twin_starts.is_empty()
            || ticks < self.grid.at_sample(self.orbit_samples.start)
        {
            return;
        }
        self.progress.work = self.ledger.work();
        let empty = self.settle.empty_course(self.model);
        let course = std::mem::replace(&mut self.progress.course, empty);
        let last_row = self.progress.energy.last().copied().into_iter().collect();
        let energy = std::mem::replace(&mut self.progress.energy, last_row);
        let starts = std::mem::take(&mut self.progress.twin_starts);
        let loads = std::mem::take(&mut self.progress.loads);
        let start = Checkpoint::new(&self.model.scenario, &self.progress);
        (self.progress.course, self.progress.energy) = (course, energy);
        (self.progress.twin_starts, self.progress.loads) = (starts, loads);
        self.progress.twin_starts.push((ticks, start));
    }

    /// Hands over the recorded data.
    fn hand_over(&mut self, keep: &mut Keep<'_>) -> Result<(), TransientError> {
        let snapshots = self.snapshots.as_ref().map(Recorder::block);
        let has_samples = self.block.first().is_some_and(|first| !first.u.is_empty());
        if has_samples || snapshots.is_some_and(|snapshots| snapshots.count > 0) {
            keep(Block { histories: &self.block, bit: self.bit.as_ref(), snapshots })
                .map_err(TransientError::Histories)?;
        }
        self.block.iter_mut().chain(&mut self.bit).for_each(NodeHistory::clear);
        self.snapshots.iter_mut().for_each(Recorder::clear);
        Ok(())
    }

    /// Simulated time reached \[s\].
    fn time(&self) -> f64 {
        self.grid.time(self.progress.ticks)
    }

    /// Acceleration and powers at t = 0, with the dynamic friction law: most of the static friction vanishes there.
    fn start(&mut self) -> Result<(), TransientError> {
        self.accelerate()?;
        self.touch();
        self.begin_loads();
        self.observe([0.0; 2]);
        Ok(())
    }

    /// Acceleration and powers of the present displacements and velocities, by the equations of motion.
    fn accelerate(&mut self) -> Result<(), TransientError> {
        let time = self.time();
        let state = &mut self.progress.state;
        let n = state.displacement.nodes();
        let (mut forces, mut linear, mut damped) =
            (NodalField::zeros(n), vec![[0.0; D]; n], vec![[0.0; D]; n]);
        let acting = &mut self.acting;
        acting.unknowns.copy_from_slice(&state.points.unknowns);
        let mut external = self.forces.load.clone();
        self.forces.add_of_time(time, acting, &mut external);
        let rates = |group: usize, dof: usize| state.velocity.groups()[group][dof];
        let at = (time, &state.points);
        self.forces.add_of_motion(at, &state.displacement, rates, acting, &external, &mut forces);
        let mut right = forces.to_nodes();
        self.system.stiffness.multiply_into(&state.displacement.to_nodes(), &mut linear);
        self.system.damping.multiply_into(&state.velocity.to_nodes(), &mut damped);
        for (((right, linear), damped), held) in
            right.iter_mut().zip(&linear).zip(&damped).zip(&self.system.held)
        {
            for dof in 0..D {
                right[dof] = if held[dof] { 0.0 } else { right[dof] - linear[dof] - damped[dof] };
            }
        }
        rk4::mass_factor(&self.system)?.solve_in_place(&mut right);
        state.acceleration.copy_from_nodes(&right);
        state.stage_power = self.ledger.power(&state.velocity, &state.displacement, acting, &self.forces);
        let motion = self.forces.motion_of(&state.displacement, &state.velocity);
        let mut rates = std::mem::take(&mut state.points.rates);
        self.forces.points.rates(time, &motion, (&state.points.unknowns, &state.points), &mut rates);
        state.points.rates = rates;
        Ok(())
    }

    /// Evaluates the forces at the present state, from which the next step begins.
    fn touch(&mut self) {
        let time = self.time();
        self.forces.evaluate(time, &self.progress.state, &mut self.acting);
    }

    /// Takes the step that led to the present state into the memories of forces.
    fn commit(&mut self) {
        let time = self.time();
        let State { displacement, velocity, points, .. } = &mut self.progress.state;
        self.forces.points.commit(time, &self.forces.motion_of(displacement, velocity), points);
    }

    /// Enters the present contacts into the statistics, after a step of the first of `durations`; the second is its part in the orbit window.
    fn observe(&mut self, durations: [f64; 2]) {
        let Progress { contacts, state, .. } = &mut self.progress;
        let (x, sticking_speed) = (&state.displacement, self.model.scenario.contact.friction_reference_speed);
        self.acting.wall.each_node(contacts.len(), |node, contact| {
            contacts[node].observe([x[(node, U)], x[(node, V)]], &contact, sticking_speed, durations);
        });
    }

    /// Takes the largest forces within the step into the statistics.
    fn note_peaks(&mut self) {
        for (nodes, peaks) in self.progress.contacts.chunks_mut(Four::LANES).zip(self.method.peaks()) {
            for (node, peak) in nodes.iter_mut().zip(peaks.to_array()) {
                node.largest_normal_force = node.largest_normal_force.max(peak);
            }
        }
    }

    /// Takes the present state as the start of the next step's loads.
    fn begin_loads(&mut self) {
        let (time, angle) = (self.time(), self.model.drive.angle(self.time()));
        let State { displacement, velocity, acceleration, .. } = &self.progress.state;
        let wall = &self.acting.wall;
        self.loads.start(&Moment { time, angle, displacement, velocity, acceleration, wall, peaks: &[] });
    }

    /// Enters the step that led from `start` ticks to the present into the loads.
    fn observe_loads(&mut self, start: u64) {
        let (time, angle) = (self.time(), self.model.drive.angle(self.time()));
        let Progress { state, ticks, loads, .. } = &mut self.progress;
        let State { displacement, velocity, acceleration, .. } = &*state;
        let (wall, peaks) = (&self.acting.wall, self.method.peaks());
        let moment = Moment { time, angle, displacement, velocity, acceleration, wall, peaks };
        let h = self.grid.time(*ticks - start);
        self.loads.observe(&moment, h, [start, *ticks], loads);
    }

    /// Records the first sample.
    fn record_start(&mut self) {
        if self.progress.ticks == 0 {
            let state = &self.progress.state;
            let motion = |node: usize| (state.displacement.node(node), state.velocity.node(node));
            for history in self.block.iter_mut().chain(&mut self.bit) {
                push(history, self.model, self.system.freedoms, &self.rest, motion);
            }
            if let Some(snapshots) = &mut self.snapshots {
                let of = (&self.forces, self.system.freedoms, &self.rest);
                snapshots.take(0, self.model, of, motion);
            }
            self.settle.take(0, &self.block, self.bit.as_ref(), &mut self.progress.course);
        }
    }

    /// Records the samples of the step that led from `start` ticks to the present.
    fn record_step(&mut self, start: u64) {
        let Progress { state, ticks, course, .. } = &mut self.progress;
        let per_sample = self.grid.at_sample(1);
        for sample in start / per_sample + 1..=(*ticks / per_sample).min(self.samples - 1) {
            let at = self.grid.at_sample(sample);
            let motion = |node: usize| {
                let end =
                    [&state.displacement, &state.velocity, &state.acceleration].map(|field| field.node(node));
                match self.method.start_of_step() {
                    Some(start_of_step) if at < *ticks => {
                        let start_motion = start_of_step.map(|field| field.node(node));
                        let step = self.grid.time(*ticks - start);
                        dense::within(
                            step,
                            (at - start) as f64 / (*ticks - start) as f64,
                            &start_motion,
                            &end,
                        )
                    }
                    _ => (end[0], end[1]),
                }
            };
            for history in self.block.iter_mut().chain(&mut self.bit) {
                push(history, self.model, self.system.freedoms, &self.rest, motion);
            }
            if let Some(snapshots) = &mut self.snapshots {
                let of = (&self.forces, self.system.freedoms, &self.rest);
                snapshots.take(sample, self.model, of, motion);
            }
            self.settle.take(sample, &self.block, self.bit.as_ref(), course);
        }
    }

    /// Enters a row into the ledger and returns its bound.
    fn book(&mut self) -> Result<f64, TransientError> {
        let time = self.time();
        let state = &self.progress.state;
        self.progress.errors.observe_motion(&state.displacement, &self.initial);
        let row = self.ledger.row(time, &state.displacement, &state.velocity);
        let smallest_motion = adaptive::smallest_motion(0.5 * self.model.scenario.well.hole_diameter);
        let hardly_moves = self.progress.errors.motion(self.model.node_count()) < smallest_motion;
        let bound = self.ledger.bound(&row, hardly_moves);
        if self.tolerances.is_some() && !hardly_moves {
            let before = self.progress.energy.last().map_or(0.0, |row| row.residual.abs());
            let ceiling = adaptive::ceiling(self.progress.ceiling, [before, row.residual.abs()], bound);
            self.progress.ceiling = ceiling.min(self.grid.top());
        }
        self.progress.energy.push(row);
        // Written so that a residual that is not a number fails.
        if row.residual.abs() <= bound {
            return Ok(bound);
        }
        Err(self
            .diverged(self.fastest, DivergenceReason::EnergyNotConserved { residual: row.residual, bound }))
    }

    /// Makes one step, not beyond `end` ticks.
    fn advance(&mut self, end: u64) -> Result<(), TransientError> {
        let time = self.time();
        let start = self.progress.ticks;
        let level = self.grid.level_at(start, end, self.progress.level.min(self.progress.ceiling));
        let Self { forces, method, ledger, acting, progress, grid, tolerances, .. } = self;
        let ahead = StepAhead { time, level, grid, tolerances: tolerances.as_ref() };
        let books = Books { ledger, errors: &mut progress.errors };
        let Ok(made) = method.advance(forces, ahead, &mut progress.state, acting, books) else {
            return Err(self.diverged(self.fastest, DivergenceReason::StepCollapsed));
        };
        let StepMade { level, next_level, steps, step_range, rejected, unresolved, mut iterations } = made;
        progress.level = next_level.unwrap_or(progress.level);
        progress.iterations.merge(&mut iterations);
        progress.rejected += rejected;
        progress.unresolved += unresolved;
        progress.steps += steps;
        let [shortest, longest] = progress.step_range;
        progress.step_range = [shortest.min(step_range[0]), longest.max(step_range[1])];
        progress.ticks += 1 << level;
        self.check_bounds()?;
        self.commit();
        self.touch();
        let [from, to] =
            [self.orbit_samples.start, self.orbit_samples.end].map(|sample| self.grid.at_sample(sample));
        let counted = self.progress.ticks.min(to).saturating_sub(start.max(from));
        self.observe([self.grid.step(level), self.grid.time(counted)]);
        self.note_peaks();
        self.observe_loads(start);
        self.record_step(start);
        Ok(())
    }

    /// Refuses a state that is not finite or outside the hole.
    fn check_bounds(&mut self) -> Result<(), TransientError> {
        let state = &self.progress.state;
        let hole_radius = 0.5 * self.model.scenario.well.widest_hole();
        let bound = self.model.farthest();
        let (mut fastest, mut highest_speed) = (self.fastest, 0.0);
        // A solve spreads a non-finite value over the whole string; it arose at the fastest node.
        if !state.displacement.is_finite() || !state.velocity.is_finite() {
            return Err(self.diverged(self.fastest, DivergenceReason::NotFinite));
        }
        let (x, v) = (&state.displacement, &state.velocity);
        for node in 0..x.nodes() {
            let speed_squared = v[(node, U)] * v[(node, U)] + v[(node, V)] * v[(node, V)];
            if speed_squared > highest_speed {
                (fastest, highest_speed) = (node, speed_squared);
            }
            let radius_squared = x[(node, U)] * x[(node, U)] + x[(node, V)] * x[(node, V)];
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

/// Recording intervals of the scenario's fixed orbit window, out of `samples`; none if the window is settled.
fn orbit_samples(scenario: &Scenario, samples: u64) -> Range<u64> {
    let Some(window) = scenario.orbit_window() else { return 0..0 };
    let range = sample_range(window.from, window.to, scenario.recording.rate_hz, samples as usize);
    range.start as u64..range.end as u64
}

/// Samples of a block of the model's recorded nodes.
fn block_samples(model: &Model) -> u64 {
    let nodes = recorded_nodes(model).len() + usize::from(additional_bit(model).is_some());
    let bytes = (nodes * Series::ALL.len() * size_of::<f64>()) as u64;
    (BLOCK_BYTES / bytes.max(1)).clamp(1, BLOCK_SAMPLES)
}

/// Number of rows of the ledger over `samples` samples, the one at the end included.
fn ledger_rows(samples: u64, every: u64) -> usize {
    (samples / every) as usize + 2
}

/// Adds a sample to a history: `motion` returns displacements and rates of the degrees of freedom `freedoms` of a node; the others are at
/// rest.
fn push<const D: usize>(
    history: &mut NodeHistory,
    model: &Model,
    freedoms: Dofs<D>,
    rest: &NodalVector,
    motion: impl Fn(usize) -> ([f64; D], [f64; D]),
) {
    let node = history.node;
    let (x, v) = motion(node);
    let x = freedoms.among(&x, rest[node]);
    let of_node =
        |other: usize| if other == node { x } else { freedoms.among(&motion(other).0, rest[other]) };
    let torque = torque(model, node, of_node);
    history.push(&x, &freedoms.among(&v, [0.0; DOFS]), torque);
}

#[cfg(test)]
impl<const D: usize> Run<'_, D> {
    /// Adds to the speed of a degree of freedom, by node and place, at the start.
    pub(super) fn kick(&mut self, place: (usize, usize), speed: f64) {
        self.progress.state.velocity[place] += speed;
        self.accelerate().expect("a mass matrix that is not singular");
    }

    /// Advances to a sample.
    pub(super) fn advance_to_sample(&mut self, sample: u64) -> Result<(), TransientError> {
        let end = self.grid.at_sample(sample);
        while self.progress.ticks < end {
            self.advance(end)?;
        }
        Ok(())
    }

    /// Unknowns of forces at the present state.
    pub(super) fn unknowns(&self) -> &[f64] {
        &self.progress.state.points.unknowns
    }
}
