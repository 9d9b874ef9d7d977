//! The generalized-alpha method of Chung and Hulbert (1993), second order.

use super::forces::Forces;
use super::implicit::{StageCoefficients, StageSolver, flat, flat_mut};
use super::run::{Books, State};
use crate::linalg::SingularBlock;
use crate::model::{DynamicSystem, NodalVector};

/// Spectral radius at infinite frequency where none is asked for. One (the trapezium rule) must not be used with a fixed number of
/// contact sweeps: it fails silently (performance.md section 3).
pub(super) const SPECTRAL_RADIUS: f64 = 0.8;

/// Parameters that follow from the spectral radius: (alpha_m, alpha_f, beta, gamma).
fn parameters(spectral_radius: f64) -> (f64, f64, f64, f64) {
    let alpha_m = (2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0);
    let alpha_f = spectral_radius / (spectral_radius + 1.0);
    let beta = 0.25 * (1.0 - alpha_m + alpha_f).powi(2);
    (alpha_m, alpha_f, beta, 0.5 - alpha_m + alpha_f)
}

/// Of the level at which a step \[s\] balances.
pub(super) fn stage_coefficients(step: f64, spectral_radius: f64) -> StageCoefficients {
    let (alpha_m, alpha_f, beta, gamma) = parameters(spectral_radius);
    StageCoefficients {
        acceleration: (1.0 - alpha_m) / ((1.0 - alpha_f) * beta * step * step),
        velocity: gamma / (beta * step),
    }
}

/// The unknown of a step is the displacement at t + (1 - alpha_f) h, where the forces are balanced.
#[derive(Debug, Clone)]
pub(super) struct GeneralizedAlpha<const D: usize> {
    step: f64,
    spectral_radius: f64,
    pub(super) solver: StageSolver<D>,
    acceleration_offset: NodalVector<D>,
    velocity_offset: NodalVector<D>,
    mean_velocity: NodalVector<D>,
    next_displacement: NodalVector<D>,
}

impl<const D: usize> GeneralizedAlpha<D> {
    pub(super) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        step: f64,
        sweeps: u32,
        spectral_radius: f64,
    ) -> Result<Self, SingularBlock> {
        let solver = StageSolver::new(system, initial, stage_coefficients(step, spectral_radius), sweeps)?;
        let zero = vec![[0.0; D]; initial.len()];
        Ok(Self {
            step,
            spectral_radius,
            solver,
            acceleration_offset: zero.clone(),
            velocity_offset: zero.clone(),
            mean_velocity: zero.clone(),
            next_displacement: zero,
        })
    }

    /// Advances `state` by one step from `time`.
    pub(super) fn advance(
        &mut self,
        forces: &Forces<D>,
        time: f64,
        state: &mut State<D>,
        Books { ledger, errors }: Books<'_, D>,
    ) {
        let (_, alpha_f, beta, _) = parameters(self.spectral_radius);
        let h = self.step;
        let solver = &mut self.solver;
        level_offsets(
            &LevelCoefficients::new(h, self.spectral_radius),
            state,
            flat_mut(&mut self.acceleration_offset),
            flat_mut(&mut self.velocity_offset),
            flat_mut(&mut solver.displacement),
            flat_mut(&mut solver.velocity),
        );
        let level_time = time + (1.0 - alpha_f) * h;
        solver.solve(forces, level_time, &self.acceleration_offset, &self.velocity_offset);
        step_end(
            &EndCoefficients::new(h, self.spectral_radius),
            state,
            flat(&solver.displacement),
            flat_mut(&mut self.next_displacement),
            flat_mut(&mut self.velocity_offset),
            flat_mut(&mut self.acceleration_offset),
            flat_mut(&mut self.mean_velocity),
        );
        std::mem::swap(&mut state.displacement, &mut self.next_displacement);
        std::mem::swap(&mut state.velocity, &mut self.velocity_offset);
        std::mem::swap(&mut state.acceleration, &mut self.acceleration_offset);
        // The Taylor series of a step has h^2/6 where the method has h^2 beta before the change of acceleration.
        let (before, after) = (&self.acceleration_offset, &state.acceleration);
        errors.add(before.len(), |n, d| h * h * (beta - 1.0 / 6.0) * (after[n][d] - before[n][d]));
        ledger.book(
            h,
            &mut self.mean_velocity,
            &mut solver.displacement,
            &solver.contact,
            forces.unbalance_at(level_time),
        );
    }
}

/// What the offsets and the predictor of a step's level take from the state at its start.
struct LevelCoefficients {
    step_to_level: f64,
    half_step: f64,
    /// Of displacement, velocity and acceleration in a^.
    acceleration: [f64; 3],
    /// The same in v^.
    velocity: [f64; 3],
}

impl LevelCoefficients {
    fn new(h: f64, spectral_radius: f64) -> Self {
        let (alpha_m, alpha_f, beta, gamma) = parameters(spectral_radius);
        let StageCoefficients { acceleration, velocity } = stage_coefficients(h, spectral_radius);
        Self {
            step_to_level: (1.0 - alpha_f) * h,
            half_step: 0.5 * h,
            acceleration: [
                -acceleration,
                -(1.0 - alpha_m) / (beta * h),
                alpha_m - (1.0 - alpha_m) * (0.5 - beta) / beta,
            ],
            velocity: [
                -velocity,
                1.0 - (1.0 - alpha_f) * gamma / beta,
                (1.0 - alpha_f) * h * (1.0 - gamma - gamma * (0.5 - beta) / beta),
            ],
        }
    }
}

/// Offsets a^ and v^ of a level, and its predictor in `x` and `v`: the acceleration stays as it is. As the function below, one
/// of its own: only where its slices are arguments does the compiler know that they do not overlap, and takes four values at
/// a time.
#[inline(never)]
fn level_offsets<const D: usize>(
    c: &LevelCoefficients,
    start: &State<D>,
    acceleration_offset: &mut [f64],
    velocity_offset: &mut [f64],
    x: &mut [f64],
    v: &mut [f64],
) {
    let n = x.len();
    let [x0, v0, a0] = [&start.displacement, &start.velocity, &start.acceleration].map(|s| &flat(s)[..n]);
    let (acceleration_offset, velocity_offset) = (&mut acceleration_offset[..n], &mut velocity_offset[..n]);
    let v = &mut v[..n];
    let sum = |c: &[f64; 3], i: usize| c[2].mul_add(a0[i], c[1].mul_add(v0[i], c[0] * x0[i]));
    for i in 0..n {
        acceleration_offset[i] = sum(&c.acceleration, i);
        velocity_offset[i] = sum(&c.velocity, i);
        x[i] = c.step_to_level.mul_add(c.half_step.mul_add(a0[i], v0[i]), x0[i]);
        v[i] = c.step_to_level.mul_add(a0[i], v0[i]);
    }
}

/// What the step's end takes from its level and its start.
struct EndCoefficients {
    /// 1 / (1 - alpha_f): draws the change up to the level out to the whole step.
    drawn_out: f64,
    per_step: f64,
    /// Of the mean velocity less that at the start, and of the acceleration at the start, in the acceleration at the end.
    acceleration: [f64; 2],
    /// Of the accelerations at the start and at the end in the velocity at the end.
    velocity: [f64; 2],
}

impl EndCoefficients {
    fn new(h: f64, spectral_radius: f64) -> Self {
        let (_, alpha_f, beta, gamma) = parameters(spectral_radius);
        Self {
            drawn_out: 1.0 / (1.0 - alpha_f),
            per_step: 1.0 / h,
            acceleration: [1.0 / (beta * h), -(0.5 - beta) / beta],
            velocity: [h * (1.0 - gamma), h * gamma],
        }
    }
}

/// The step's end, and its mean velocity, from the displacements `level`.
#[inline(never)]
fn step_end<const D: usize>(
    c: &EndCoefficients,
    start: &State<D>,
    level: &[f64],
    x: &mut [f64],
    v: &mut [f64],
    a: &mut [f64],
    mean_velocity: &mut [f64],
) {
    let n = x.len();
    let [x0, v0, a0] = [&start.displacement, &start.velocity, &start.acceleration].map(|s| &flat(s)[..n]);
    let (level, v, a, mean_velocity) = (&level[..n], &mut v[..n], &mut a[..n], &mut mean_velocity[..n]);
    for i in 0..n {
        let change = (level[i] - x0[i]) * c.drawn_out;
        mean_velocity[i] = change * c.per_step;
        a[i] = (mean_velocity[i] - v0[i]).mul_add(c.acceleration[0], c.acceleration[1] * a0[i]);
        v[i] = c.velocity[1].mul_add(a[i], c.velocity[0].mul_add(a0[i], v0[i]));
        x[i] = x0[i] + change;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_give_second_order_and_the_wanted_dissipation() {
        for radius in [0.0, 0.5, SPECTRAL_RADIUS, 0.95] {
            let (alpha_m, alpha_f, beta, gamma) = parameters(radius);
            // Chung and Hulbert (1993): second order, and the two ways to write the radius at infinity agree.
            assert!((gamma - (0.5 - alpha_m + alpha_f)).abs() < 1e-15);
            assert!((alpha_f / (1.0 - alpha_f) - radius).abs() < 1e-14);
            assert!(((1.0 + alpha_m) / (2.0 - alpha_m) - radius).abs() < 1e-14);
            assert!((beta - 0.25 * (0.5 + gamma).powi(2)).abs() < 1e-15);
        }
    }
}
