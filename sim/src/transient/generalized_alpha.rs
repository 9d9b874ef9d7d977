//! The generalized-alpha method of Chung and Hulbert (1993), second order.

use super::forces::Forces;
use super::implicit::{StageCoefficients, StageSolver, flat, flat_mut};
use super::{Books, State};
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
            mean_velocity: zero,
        })
    }

    /// Advances `state` by one step from `time`.
    pub(super) fn advance(
        &mut self,
        system: &DynamicSystem<D>,
        forces: &Forces<D>,
        time: f64,
        state: &mut State<D>,
        Books { ledger, errors }: Books<'_, D>,
    ) {
        let (alpha_m, alpha_f, beta, gamma) = parameters(self.spectral_radius);
        let h = self.step;
        let (c_a, c_v) = ((1.0 - alpha_m) / ((1.0 - alpha_f) * beta * h * h), gamma / (beta * h));
        let acceleration_from_v = -(1.0 - alpha_m) / (beta * h);
        let acceleration_from_a = alpha_m - (1.0 - alpha_m) * (0.5 - beta) / beta;
        let velocity_from_v = 1.0 - (1.0 - alpha_f) * gamma / beta;
        let velocity_from_a = (1.0 - alpha_f) * h * (1.0 - gamma - gamma * (0.5 - beta) / beta);
        let solver = &mut self.solver;
        let (x0, v0, a0) = (flat(&state.displacement), flat(&state.velocity), flat(&state.acceleration));
        let a_hat = flat_mut(&mut self.acceleration_offset);
        let v_hat = flat_mut(&mut self.velocity_offset);
        let x = flat_mut(&mut solver.displacement);
        let v = flat_mut(&mut solver.velocity);
        for i in 0..x0.len() {
            a_hat[i] = acceleration_from_a * a0[i] + acceleration_from_v * v0[i] - c_a * x0[i];
            v_hat[i] = velocity_from_v * v0[i] + velocity_from_a * a0[i] - c_v * x0[i];
            // Predictor: the acceleration stays as it is.
            x[i] = x0[i] + (1.0 - alpha_f) * h * (v0[i] + 0.5 * h * a0[i]);
            v[i] = v0[i] + (1.0 - alpha_f) * h * a0[i];
        }
        let level = time + (1.0 - alpha_f) * h;
        solver.solve(system, forces, level, &self.acceleration_offset, &self.velocity_offset);

        let mean_velocity = flat_mut(&mut self.mean_velocity);
        let (y, x0) = (flat(&solver.displacement), flat_mut(&mut state.displacement));
        let (v0, a0) = (flat_mut(&mut state.velocity), flat_mut(&mut state.acceleration));
        let before = flat_mut(&mut self.acceleration_offset);
        before.copy_from_slice(a0);
        for i in 0..y.len() {
            let d = (y[i] - x0[i]) / (1.0 - alpha_f);
            let a1 = (d / h - v0[i]) / (beta * h) - (0.5 - beta) / beta * a0[i];
            v0[i] += h * ((1.0 - gamma) * a0[i] + gamma * a1);
            a0[i] = a1;
            x0[i] += d;
            mean_velocity[i] = d / h;
        }
        // The Taylor series of a step has h^2/6 where the method has h^2 beta before the change of acceleration.
        let (before, after) = (&self.acceleration_offset, &state.acceleration);
        errors.add(before.len(), |n, d| h * h * (beta - 1.0 / 6.0) * (after[n][d] - before[n][d]));
        ledger.book(
            h,
            &self.mean_velocity,
            &solver.displacement,
            &solver.contact,
            forces.unbalance_at(level),
        );
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
