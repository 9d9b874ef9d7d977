//! The generalized-alpha method of Chung and Hulbert (1993), second order.

use super::forces::{ActingForces, Forces, StageAt};
use super::implicit::{StageCoefficients, StageMatrix, StageSolver};
use super::method::{Books, Method, StepAhead, StepCollapsed, StepMade};
use super::state::State;
use crate::force::points::UnknownStage;
use crate::math::linalg::{Four, Lane, NodalField, SingularBlock};
use crate::solve::motion::DynamicSystem;

/// Default spectral radius at infinite frequency. One (the trapezium rule) must not be used with a fixed number of
/// contact iterations: it does not damp their remaining errors, and the contacts' work becomes wrong by orders of magnitude while every
/// value stays finite (docs/model/motion.md, Generalized-alpha).
pub(crate) const SPECTRAL_RADIUS: f64 = 0.8;

/// Angle \[rad\] of an oscillation in a step up to which its period is right to a thousandth at the usual spectral radius (it errs by
/// 0.088 angle^2), and its amplitude in each period too.
pub(crate) const RESOLVED_ANGLE: f64 = 0.1;

/// Parameters that follow from the spectral radius: (alpha_m, alpha_f, beta, gamma).
fn parameters(spectral_radius: f64) -> (f64, f64, f64, f64) {
    let alpha_m = (2.0 * spectral_radius - 1.0) / (spectral_radius + 1.0);
    let alpha_f = spectral_radius / (spectral_radius + 1.0);
    let beta = 0.25 * (1.0 - alpha_m + alpha_f).powi(2);
    (alpha_m, alpha_f, beta, 0.5 - alpha_m + alpha_f)
}

/// Parameters of the method for unknowns of first order (Jansen, Whiting and Hulbert 2000, equations 13 to 18), from the same spectral radius.
struct UnknownParameters {
    alpha_m: f64,
    alpha_f: f64,
    gamma: f64,
}

impl UnknownParameters {
    fn new(spectral_radius: f64) -> Self {
        let alpha_m = 0.5 * (3.0 - spectral_radius) / (1.0 + spectral_radius);
        let alpha_f = 1.0 / (1.0 + spectral_radius);
        Self { alpha_m, alpha_f, gamma: 0.5 + alpha_m - alpha_f }
    }
}

/// Coefficients of the level at which a step \[s\] balances.
pub(crate) fn stage_coefficients(step: f64, spectral_radius: f64) -> StageCoefficients {
    let (alpha_m, alpha_f, beta, gamma) = parameters(spectral_radius);
    StageCoefficients {
        acceleration: (1.0 - alpha_m) / ((1.0 - alpha_f) * beta * step * step),
        velocity: gamma / (beta * step),
    }
}

/// The unknown of a step is the displacement at t + (1 - alpha_f) h, where the forces are balanced.
#[derive(Debug, Clone)]
pub(crate) struct GeneralizedAlpha<const D: usize> {
    step: f64,
    spectral_radius: f64,
    matrix: StageMatrix<D>,
    solver: StageSolver<D>,
    acceleration_offset: NodalField<D>,
    velocity_offset: NodalField<D>,
    mean_velocity: NodalField<D>,
    next_displacement: NodalField<D>,
    /// Unknowns at the step's level without the share of their rates there.
    unknown_base: Vec<f64>,
}

impl<const D: usize> Method<D> for GeneralizedAlpha<D> {
    fn advance(
        &mut self,
        forces: &Forces<D>,
        StepAhead { time, level, .. }: StepAhead<'_>,
        state: &mut State<D>,
        acting: &ActingForces,
        books: Books<'_, D>,
    ) -> Result<StepMade, StepCollapsed> {
        self.step(forces, time, state, acting, books);
        Ok(StepMade {
            level,
            next_level: None,
            steps: 1,
            step_range: [self.step; 2],
            rejected: 0,
            unresolved: 0,
            iterations: std::mem::take(&mut self.solver.iterations),
        })
    }

    fn peaks(&self) -> &[Four] {
        self.solver.peaks()
    }
}

impl<const D: usize> GeneralizedAlpha<D> {
    pub(crate) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        forces: &Forces<D>,
        step: f64,
        iteration_limit: u32,
        spectral_radius: f64,
    ) -> Result<Self, SingularBlock> {
        let matrix = StageMatrix::new(system, initial, stage_coefficients(step, spectral_radius), forces)?;
        let zero = NodalField::zeros(initial.len());
        Ok(Self {
            step,
            spectral_radius,
            matrix,
            solver: StageSolver::new(system, initial, forces, iteration_limit),
            acceleration_offset: zero.clone(),
            velocity_offset: zero.clone(),
            mean_velocity: zero.clone(),
            next_displacement: zero,
            unknown_base: forces.points.start().unknowns,
        })
    }

    /// Advances `state`, whose forces are `acting`, by one step from `time`.
    fn step(
        &mut self,
        forces: &Forces<D>,
        time: f64,
        state: &mut State<D>,
        acting: &ActingForces,
        Books { ledger, errors }: Books<'_, D>,
    ) {
        let (_, alpha_f, beta, _) = parameters(self.spectral_radius);
        let h = self.step;
        self.predict(state);
        let factor = self.predict_unknowns(state);
        let solver = &mut self.solver;
        solver.begin_step(acting);
        let unknowns = UnknownStage { base: &self.unknown_base, factor };
        let at = StageAt { time: time + (1.0 - alpha_f) * h, state: &state.points, unknowns };
        solver.solve(&self.matrix, forces, at, [&self.acceleration_offset, &self.velocity_offset]);
        step_end(
            &EndCoefficients::new(h, self.spectral_radius),
            state,
            &solver.displacement,
            [
                &mut self.next_displacement,
                &mut self.velocity_offset,
                &mut self.acceleration_offset,
                &mut self.mean_velocity,
            ],
        );
        std::mem::swap(&mut state.displacement, &mut self.next_displacement);
        std::mem::swap(&mut state.velocity, &mut self.velocity_offset);
        std::mem::swap(&mut state.acceleration, &mut self.acceleration_offset);
        // The Taylor series of a step has h^2/6; the method has h^2 beta before the change of acceleration.
        let (before, after) = (&self.acceleration_offset, &state.acceleration);
        let factor = Four::splat(h * h * (beta - 1.0 / 6.0));
        let (before, after) = (before.groups(), after.groups());
        errors.add_groups(before.len(), |group, dof| factor * (after[group][dof] - before[group][dof]));
        ledger.book(h, &mut self.mean_velocity, &mut solver.displacement, &solver.acting, forces);
        self.advance_unknowns(state);
    }

    /// Base of the unknowns at the step's level, and the factor of their rates there \[s\]: the method of Jansen, Whiting and Hulbert (2000) for equations of
    /// first order, whose level is the same.
    fn predict_unknowns(&mut self, state: &State<D>) -> f64 {
        let (h, unknowns) = (self.step, UnknownParameters::new(self.spectral_radius));
        let per_level = unknowns.alpha_f * h;
        let share = unknowns.gamma / unknowns.alpha_m;
        for ((base, value), rate) in
            self.unknown_base.iter_mut().zip(&state.points.unknowns).zip(&state.points.rates)
        {
            *base = (per_level * (1.0 - share)).mul_add(*rate, *value);
        }
        per_level * share
    }

    /// Unknowns and their rates at the step's end, from those at its level.
    fn advance_unknowns(&self, state: &mut State<D>) {
        let (h, UnknownParameters { alpha_f, gamma, .. }) =
            (self.step, UnknownParameters::new(self.spectral_radius));
        let points = &mut state.points;
        let at_level = &self.solver.acting.unknowns;
        for ((value, rate), level) in points.unknowns.iter_mut().zip(&mut points.rates).zip(at_level) {
            let change = (level - *value) / alpha_f;
            *rate += (change / h - *rate) / gamma;
            *value += change;
        }
    }

    /// Offsets of the step's level, and the start of its solution.
    fn predict(&mut self, state: &State<D>) {
        let c = LevelCoefficients::new(self.step, self.spectral_radius);
        let n = state.displacement.groups().len();
        let [x0, v0, a0] =
            [&state.displacement, &state.velocity, &state.acceleration].map(|field| &field.groups()[..n]);
        let acceleration_offset = &mut self.acceleration_offset.groups_mut()[..n];
        let velocity_offset = &mut self.velocity_offset.groups_mut()[..n];
        let x = &mut self.solver.displacement.groups_mut()[..n];
        let v = &mut self.solver.velocity.groups_mut()[..n];
        for i in 0..n {
            for dof in 0..D {
                let (x0, v0, a0) = (x0[i][dof], v0[i][dof], a0[i][dof]);
                let sum = |[of_x, of_v, of_a]: [Four; 3]| of_a.mul_add(a0, of_v.mul_add(v0, of_x * x0));
                acceleration_offset[i][dof] = sum(c.acceleration);
                velocity_offset[i][dof] = sum(c.velocity);
                // The predictor is for the contacts alone.
                x[i][dof] = c.step_to_level.mul_add(c.half_step.mul_add(a0, v0), x0);
                v[i][dof] = c.step_to_level.mul_add(a0, v0);
            }
        }
    }
}

/// Coefficients of the state at a step's start in the offsets and the predictor of the step's level.
struct LevelCoefficients {
    step_to_level: Four,
    half_step: Four,
    /// Factors of displacement, velocity and acceleration in a^.
    acceleration: [Four; 3],
    /// The same in v^.
    velocity: [Four; 3],
}

impl LevelCoefficients {
    fn new(h: f64, spectral_radius: f64) -> Self {
        let (alpha_m, alpha_f, beta, gamma) = parameters(spectral_radius);
        let StageCoefficients { acceleration, velocity } = stage_coefficients(h, spectral_radius);
        Self {
            step_to_level: Four::splat((1.0 - alpha_f) * h),
            half_step: Four::splat(0.5 * h),
            acceleration: [
                -acceleration,
                -(1.0 - alpha_m) / (beta * h),
                alpha_m - (1.0 - alpha_m) * (0.5 - beta) / beta,
            ]
            .map(Four::splat),
            velocity: [
                -velocity,
                1.0 - (1.0 - alpha_f) * gamma / beta,
                (1.0 - alpha_f) * h * (1.0 - gamma - gamma * (0.5 - beta) / beta),
            ]
            .map(Four::splat),
        }
    }
}

/// Coefficients of a step's level and start in its end.
struct EndCoefficients {
    /// 1 / (1 - alpha_f): extends the change up to the level to the whole step.
    drawn_out: Four,
    per_step: Four,
    /// Factors of the mean velocity less that at the start, and of the acceleration at the start, in the acceleration at the end.
    acceleration: [Four; 2],
    /// Factors of the accelerations at the start and at the end in the velocity at the end.
    velocity: [Four; 2],
}

impl EndCoefficients {
    fn new(h: f64, spectral_radius: f64) -> Self {
        let (_, alpha_f, beta, gamma) = parameters(spectral_radius);
        Self {
            drawn_out: Four::splat(1.0 / (1.0 - alpha_f)),
            per_step: Four::splat(1.0 / h),
            acceleration: [1.0 / (beta * h), -(0.5 - beta) / beta].map(Four::splat),
            velocity: [h * (1.0 - gamma), h * gamma].map(Four::splat),
        }
    }
}

/// The step's end - displacement, velocity, acceleration - and its mean velocity, from the displacements `level`.
fn step_end<const D: usize>(
    c: &EndCoefficients,
    start: &State<D>,
    level: &NodalField<D>,
    end: [&mut NodalField<D>; 4],
) {
    let n = level.groups().len();
    let [x0, v0, a0, level] =
        [&start.displacement, &start.velocity, &start.acceleration, level].map(|field| &field.groups()[..n]);
    let [x, v, a, mean_velocity] = end.map(|field| &mut field.groups_mut()[..n]);
    for i in 0..n {
        for dof in 0..D {
            let (x0, v0, a0) = (x0[i][dof], v0[i][dof], a0[i][dof]);
            let change = (level[i][dof] - x0) * c.drawn_out;
            let mean = change * c.per_step;
            let after = (mean - v0).mul_add(c.acceleration[0], c.acceleration[1] * a0);
            v[i][dof] = c.velocity[1].mul_add(after, c.velocity[0].mul_add(a0, v0));
            x[i][dof] = x0 + change;
            a[i][dof] = after;
            mean_velocity[i][dof] = mean;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::Matrix3;

    use super::*;

    #[test]
    fn parameters_give_second_order_and_the_requested_dissipation() {
        for radius in [0.0, 0.5, SPECTRAL_RADIUS, 0.95] {
            let (alpha_m, alpha_f, beta, gamma) = parameters(radius);
            // Chung and Hulbert (1993): second order, and the two ways to write the radius at infinity agree.
            assert!((gamma - (0.5 - alpha_m + alpha_f)).abs() < 1e-15);
            assert!((alpha_f / (1.0 - alpha_f) - radius).abs() < 1e-14);
            assert!(((1.0 + alpha_m) / (2.0 - alpha_m) - radius).abs() < 1e-14);
            assert!((beta - 0.25 * (0.5 + gamma).powi(2)).abs() < 1e-15);
        }
    }

    #[test]
    fn the_resolved_angle_is_the_largest_one_that_is_right_to_a_thousandth() {
        // x'' = -w^2 x over a step of one second. Chung and Hulbert (1993), equations (1) to (5): Newmark's formulas, and the balance
        // between the two levels, as a matrix that takes displacement, velocity and acceleration over a step.
        let errors = |angle: f64| {
            let (square, rho) = (angle * angle, SPECTRAL_RADIUS);
            let (alpha_m, alpha_f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
            let (beta, gamma) = (0.25 * (1.0 - alpha_m + alpha_f).powi(2), 0.5 - alpha_m + alpha_f);
            #[rustfmt::skip]
            let after = Matrix3::new(
                1.0, 0.0, -beta,
                0.0, 1.0, -gamma,
                square * (1.0 - alpha_f), 0.0, 1.0 - alpha_m,
            );
            #[rustfmt::skip]
            let before = Matrix3::new(
                1.0, 1.0, 0.5 - beta,
                0.0, 1.0, 1.0 - gamma,
                -square * alpha_f, 0.0, -alpha_m,
            );
            let step = after.try_inverse().unwrap() * before;
            // Of the three eigenvalues one is real, and the oscillation is the pair.
            let values = step.complex_eigenvalues();
            let turning = values.iter().max_by(|a, b| a.im.total_cmp(&b.im)).unwrap();
            [(turning.arg() / angle - 1.0).abs(), (turning.norm().ln() * TAU / angle).abs()]
        };
        let [period, amplitude] = errors(RESOLVED_ANGLE);
        assert!(period < 1e-3 && amplitude < 1e-3, "{period} {amplitude}");
        let [period, _] = errors(1.1 * RESOLVED_ANGLE);
        assert!(period > 1e-3, "{period}");
    }
}
