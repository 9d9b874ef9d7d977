//! The classical Runge-Kutta method of order 4, with step doubling when a tolerance is given: the paper's method.
//!
//! Stable up to h = 2.785 / omega_max, about 6e-5 s with tool joints of 0.3 m, whatever the requested accuracy.

use super::energy::Ledger;
use super::error_estimate::ErrorSum;
use super::forces::{ActingForces, Forces};
use super::grid::parts;
use super::implicit::{ContactIterations, largest_change, multiply_add};
use super::method::{Books, Method, StepAhead, StepCollapsed, StepMade};
use super::state::State;
use crate::math::linalg::{Factor, Four, General, Lane, MatrixPair, NodalField, SingularBlock};
use crate::solve::model::NodalVector;
use crate::solve::motion::DynamicSystem;

/// Angle \[rad\] of an oscillation in a step up to which its amplitude is right to a thousandth in each period, and the period too: the amplitude
/// loses angle^6 / 144 a step.
pub(crate) const RESOLVED_ANGLE: f64 = 0.45;

/// Shortest step relative to the largest: below it the run counts as diverged. With the largest at some 6e-5 s it is 6e-11 s, some
/// 400,000 a radian of the fastest oscillation.
const SMALLEST_STEP_RATIO: f64 = 1e-6;

/// Divisor of the distance of two steps of h from one step of 2 h that gives the error of the two: 2^p - 1 for order p = 4 (Hairer,
/// Norsett and Wanner 1993, section II.4).
const DISTANCE_OVER_ERROR: f64 = 15.0;

/// Local errors fall with the fifth power of the step.
const PER_LOCAL_ORDER: f64 = 0.2;

/// Part of the step that would just meet the tolerance that is tried next, so that it is likely to be accepted; then the largest factors by which the
/// next step lengthens and a repeated one shortens (Hairer, Norsett and Wanner 1993, section II.4, with a factor of 0.8 or
/// 0.9 and a growth of 1.5 to 5 at most).
const SAFETY: f64 = 0.9;
const LONGEST_GROWTH: f64 = 2.0;
const SHRINKING: [f64; 2] = [0.1, 0.8];

/// Rounding of times within an interval, summed over its steps.
const ROUNDING: f64 = 1e-12;

/// Fixed-step or step-doubling RK4.
#[derive(Debug, Clone)]
pub(crate) struct Rk4<const D: usize> {
    mass: Factor<D>,
    damping_and_stiffness: MatrixPair<General, D>,
    held: Vec<(usize, usize)>,
    largest_step: f64,
    /// Step doubling; absent with fixed steps.
    adaptive: Option<Adaptive<D>>,
    rates: [(NodalField<D>, NodalField<D>); 4],
    stage: (NodalField<D>, NodalField<D>),
    /// Forces that move the string, without those of the contacts.
    external: NodalField<D>,
    right: NodalField<D>,
    between: NodalVector<D>,
    acting: ActingForces,
    /// Rates of the unknowns at the stages \[1/s\].
    unknown_rates: [Vec<f64>; 4],
    rejected: u64,
    steps: u64,
    /// The shortest and the longest step made \[s\].
    step_range: [f64; 2],
}

/// Step doubling.
#[derive(Debug, Clone)]
struct Adaptive<const D: usize> {
    /// Local error of a lateral displacement that a pair of steps may make, in hole radii.
    tolerance: f64,
    hole_radius: f64,
    /// State after one long step.
    coarse: State<D>,
    /// State after two steps of half its length.
    fine: State<D>,
}

impl<const D: usize> Method<D> for Rk4<D> {
    fn advance(
        &mut self,
        forces: &Forces<D>,
        StepAhead { time, level, grid, .. }: StepAhead<'_>,
        state: &mut State<D>,
        _: &ActingForces,
        books: Books<'_, D>,
    ) -> Result<StepMade, StepCollapsed> {
        self.advance_by(forces, time, grid.step(level), state, books)?;
        // That of the last stage, at the step's end to order 3.
        state.acceleration.copy_from(&self.rates[3].1);
        Ok(StepMade {
            level,
            next_level: None,
            steps: std::mem::take(&mut self.steps),
            step_range: self.step_range,
            rejected: std::mem::take(&mut self.rejected),
            unresolved: 0,
            iterations: ContactIterations::default(),
        })
    }
}

impl<const D: usize> Rk4<D> {
    pub(crate) fn new(
        system: &DynamicSystem<D>,
        forces: &Forces<D>,
        largest_step: f64,
        tolerance: Option<f64>,
        hole_radius: f64,
    ) -> Result<Self, SingularBlock> {
        let n = system.load.len();
        let zero = NodalField::zeros(n);
        let state = State::at_rest(&zero, forces.points.start(), largest_step);
        Ok(Self {
            mass: mass_factor(system)?,
            damping_and_stiffness: MatrixPair::new(&system.damping, &system.stiffness),
            held: system.held_places(),
            largest_step,
            adaptive: tolerance.map(|tolerance| Adaptive {
                tolerance,
                hole_radius,
                coarse: state.clone(),
                fine: state,
            }),
            rates: std::array::from_fn(|_| (zero.clone(), zero.clone())),
            stage: (zero.clone(), zero.clone()),
            external: zero,
            right: NodalField::zeros(n),
            between: vec![[0.0; D]; n],
            unknown_rates: std::array::from_fn(|_| forces.points.start().rates),
            acting: ActingForces::none(forces),
            rejected: 0,
            steps: 0,
            step_range: [f64::INFINITY, 0.0],
        })
    }

    /// Advances `state` from `time` over `interval` seconds.
    fn advance_by(
        &mut self,
        forces: &Forces<D>,
        time: f64,
        interval: f64,
        state: &mut State<D>,
        books: Books<'_, D>,
    ) -> Result<(), StepCollapsed> {
        let Some(mut adaptive) = self.adaptive.take() else {
            let Books { ledger, errors } = books;
            let count = parts(interval, self.largest_step);
            let h = interval / count as f64;
            for i in 0..count {
                self.step(forces, time + i as f64 * h, h, state, Some(ledger));
                self.add_error(h, state, errors);
            }
            return Ok(());
        };
        let outcome = self.advance_adaptively(forces, time, interval, state, books, &mut adaptive);
        self.adaptive = Some(adaptive);
        outcome
    }

    fn advance_adaptively(
        &mut self,
        forces: &Forces<D>,
        time: f64,
        interval: f64,
        state: &mut State<D>,
        Books { ledger, errors }: Books<'_, D>,
        Adaptive { tolerance, hole_radius, coarse, fine }: &mut Adaptive<D>,
    ) -> Result<(), StepCollapsed> {
        let mut elapsed = 0.0;
        while elapsed < interval * (1.0 - ROUNDING) {
            let remaining = interval - elapsed;
            let wanted = state.adaptive_step.min(self.largest_step);
            let h = remaining / (2.0 * (remaining / (2.0 * wanted)).ceil().max(1.0));
            let start = time + elapsed;
            coarse.copy_from(state);
            self.step(forces, start, 2.0 * h, coarse, None);
            fine.copy_from(state);
            let mark = ledger.mark();
            for half in 0..2 {
                self.step(forces, start + f64::from(half) * h, h, fine, Some(ledger));
            }
            let error = largest_change(&fine.displacement, &coarse.displacement)
                / (DISTANCE_OVER_ERROR * *hole_radius);
            if error <= *tolerance {
                let share = Four::splat(1.0 / DISTANCE_OVER_ERROR);
                let (end, other) = (fine.displacement.groups(), coarse.displacement.groups());
                errors.add_groups(end.len(), |group, dof| (end[group][dof] - other[group][dof]) * share);
                std::mem::swap(state, fine);
                elapsed += 2.0 * h;
                // The error may be zero.
                let factor = SAFETY * (*tolerance / error.max(f64::MIN_POSITIVE)).powf(PER_LOCAL_ORDER);
                state.adaptive_step = (h * factor.min(LONGEST_GROWTH)).min(self.largest_step);
            } else {
                ledger.roll_back(mark);
                self.rejected += 1;
                let factor = SAFETY * (*tolerance / error).powf(PER_LOCAL_ORDER);
                let [least, most] = SHRINKING;
                state.adaptive_step = h * if factor.is_finite() { factor.clamp(least, most) } else { least };
                if state.adaptive_step < SMALLEST_STEP_RATIO * self.largest_step {
                    return Err(StepCollapsed);
                }
            }
        }
        Ok(())
    }

    /// The difference to the embedded method of order 3 whose last stage is the step's end: h/6 times the change of the
    /// velocity between the two.
    fn add_error(&self, h: f64, state: &State<D>, errors: &mut ErrorSum) {
        let (last, _) = &self.rates[3];
        let (last, velocity, sixth) = (last.groups(), state.velocity.groups(), Four::splat(h / 6.0));
        errors.add_groups(last.len(), |group, dof| sixth * (last[group][dof] - velocity[group][dof]));
    }

    /// One step of `h`, its work in the ledger if it is to be kept.
    fn step(
        &mut self,
        forces: &Forces<D>,
        time: f64,
        h: f64,
        state: &mut State<D>,
        mut ledger: Option<&mut Ledger<D>>,
    ) {
        const FRACTIONS: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
        const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
        for stage in 0..4 {
            let c = FRACTIONS[stage] * h;
            let (x, v) = (&mut self.stage.0, &mut self.stage.1);
            if stage == 0 {
                x.copy_from(&state.displacement);
                v.copy_from(&state.velocity);
            } else {
                let (rate_x, rate_v) = &self.rates[stage - 1];
                multiply_add(rate_x, c, &state.displacement, x);
                multiply_add(rate_v, c, &state.velocity, v);
            }
            let stage_time = time + c;
            self.damping_and_stiffness.subtract_products(&forces.load, v, x, &mut self.external);
            forces.add_of_time(stage_time, &mut self.acting, &mut self.external);
            for &(node, dof) in &self.held {
                self.external[(node, dof)] = 0.0;
            }
            for (place, value) in self.acting.unknowns.iter_mut().enumerate() {
                let rate = if stage == 0 { 0.0 } else { self.unknown_rates[stage - 1][place] };
                *value = c.mul_add(rate, state.points.unknowns[place]);
            }
            let rates = |group: usize, dof: usize| v.groups()[group][dof];
            let at = (stage_time, &state.points);
            forces.add_of_motion(at, x, rates, &mut self.acting, &self.external, &mut self.right);
            if !self.acting.unknowns.is_empty() {
                let motion = forces.motion_of(x, v);
                let unknowns = (self.acting.unknowns.as_slice(), &state.points);
                forces.points.rates(stage_time, &motion, unknowns, &mut self.unknown_rates[stage]);
            }
            self.mass.solve_field(&self.right, &mut self.between, &mut self.rates[stage].1);
            self.rates[stage].0.copy_from(v);
            if let Some(ledger) = &mut ledger {
                ledger.book(WEIGHTS[stage] * h, v, x, &self.acting, forces);
            }
        }
        for (stage, weight) in WEIGHTS.into_iter().enumerate() {
            let (rate_x, rate_v) = &self.rates[stage];
            axpy(&mut state.displacement, weight * h, rate_x);
            axpy(&mut state.velocity, weight * h, rate_v);
            for (value, rate) in state.points.unknowns.iter_mut().zip(&self.unknown_rates[stage]) {
                *value = (weight * h).mul_add(*rate, *value);
            }
        }
        self.steps += 1;
        self.step_range = [self.step_range[0].min(h), self.step_range[1].max(h)];
    }
}

/// The mass matrix, factored; held degrees of freedom have a unit diagonal.
pub(crate) fn mass_factor<const D: usize>(system: &DynamicSystem<D>) -> Result<Factor<D>, SingularBlock> {
    let mut mass = system.mass.clone();
    for (node, dof) in system.held_places() {
        mass.diagonal[node][(dof, dof)] = 1.0;
    }
    Factor::new(&mass)
}

fn axpy<const D: usize>(y: &mut NodalField<D>, a: f64, x: &NodalField<D>) {
    let a = Four::splat(a);
    for (y, x) in y.groups_mut().iter_mut().zip(x.groups()) {
        for dof in 0..D {
            y[dof] = a.mul_add(x[dof], y[dof]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::Complex;

    use super::*;

    #[test]
    fn the_resolved_angle_is_the_largest_one_that_is_right_to_a_thousandth() {
        // One step multiplies exp(i t) by the Taylor polynomial of degree 4 (Hairer and Wanner 1996, section IV.2).
        let errors = |angle: f64| {
            let z = Complex::new(0.0, angle);
            let step = (0..4).rev().fold(Complex::from(1.0), |sum, k| 1.0 + sum * z / f64::from(k + 1));
            [(step.arg() / angle - 1.0).abs(), (step.norm().ln() * TAU / angle).abs()]
        };
        let [period, amplitude] = errors(RESOLVED_ANGLE);
        assert!(period < 1e-3 && amplitude < 1e-3, "{period} {amplitude}");
        let [_, amplitude] = errors(1.1 * RESOLVED_ANGLE);
        assert!(amplitude > 1e-3, "{amplitude}");
    }
}
