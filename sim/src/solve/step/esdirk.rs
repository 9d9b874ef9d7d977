//! ESDIRK4(3)6L\[2\]SA, the implicit part of ARK4(3)6L\[2\]SA of Kennedy and Carpenter (2003): order 4, L-stable,
//! stiffly accurate, first stage explicit, diagonal 1/4.

use super::adaptive::{self, StepError};
use super::energy::Ledger;
use super::forces::{ActingForces, Forces, StageAt};
use super::grid::Grid;
use super::implicit::{StageCoefficients, StageMatrix, StageSolver};
use super::method::{Books, Method, StepAhead, StepCollapsed, StepMade};
use super::state::State;
use super::work::Work;
use crate::force::points::UnknownStage;
use crate::math::dof::LATERAL;
use crate::math::linalg::{Four, Lane, NodalField, SingularBlock};
use crate::solve::motion::DynamicSystem;

const STAGES: usize = 6;
pub(crate) const DIAGONAL: f64 = 0.25;

/// Angle \[rad\] of an oscillation in a step up to which its period is right to a thousandth, and its amplitude in each period too.
pub(crate) const RESOLVED_ANGLE: f64 = 1.0;

const NODES: [f64; STAGES] = [0.0, 0.5, 83.0 / 250.0, 31.0 / 50.0, 17.0 / 20.0, 1.0];

/// Rows of the tableau left of the diagonal.
const STRICTLY_LOWER: [[f64; STAGES - 1]; STAGES] = [
    [0.0, 0.0, 0.0, 0.0, 0.0],
    [0.25, 0.0, 0.0, 0.0, 0.0],
    [8611.0 / 62500.0, -1743.0 / 31250.0, 0.0, 0.0, 0.0],
    [5012029.0 / 34652500.0, -654441.0 / 2922500.0, 174375.0 / 388108.0, 0.0, 0.0],
    [
        15267082809.0 / 155376265600.0,
        -71443401.0 / 120774400.0,
        730878875.0 / 902184768.0,
        2285395.0 / 8070912.0,
        0.0,
    ],
    [82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0],
];

/// Weights; the last stage is the step's end.
const WEIGHTS: [f64; STAGES] =
    [82889.0 / 524892.0, 0.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0, DIAGONAL];

/// Weights less those of the embedded method of order 3: their sum over the stages is an error of the step.
const ERROR_WEIGHTS: [f64; STAGES] = [
    WEIGHTS[0] - 4586570599.0 / 29645900160.0,
    0.0,
    WEIGHTS[2] - 178811875.0 / 945068544.0,
    WEIGHTS[3] - 814220225.0 / 1159782912.0,
    WEIGHTS[4] + 3700637.0 / 11593932.0,
    WEIGHTS[5] - 61727.0 / 225920.0,
];

/// Coefficients of every stage of a step \[s\].
pub(crate) fn stage_coefficients(step: f64) -> StageCoefficients {
    let c = 1.0 / (DIAGONAL * step);
    StageCoefficients { acceleration: c * c, velocity: c }
}

/// Stages of one step; the last one is the first of the next step.
#[derive(Debug, Clone)]
pub(crate) struct Esdirk<const D: usize> {
    /// Steps \[s\] that can be made, the shortest first, with the matrices of their stages.
    levels: Vec<(f64, StageMatrix<D>)>,
    solver: StageSolver<D>,
    /// Stages after the first, which is the state at the step's start.
    stages: [Stage<D>; STAGES - 1],
    /// Powers at all stages.
    powers: [Work; STAGES],
    /// Sum of the squares of the lateral displacements' local errors in the attempted step \[m2\].
    local_error: f64,
    acceleration_offset: NodalField<D>,
    velocity_offset: NodalField<D>,
    /// Unknowns of a stage without the share of its own rates.
    unknown_base: Vec<f64>,
}

/// Motion at a stage.
#[derive(Debug, Clone)]
struct Stage<const D: usize> {
    displacement: NodalField<D>,
    velocity: NodalField<D>,
    acceleration: NodalField<D>,
    unknowns: Vec<f64>,
    /// Rates of the unknowns \[1/s\].
    unknown_rates: Vec<f64>,
}

impl<const D: usize> Method<D> for Esdirk<D> {
    fn advance(
        &mut self,
        forces: &Forces<D>,
        StepAhead { time, mut level, grid, tolerances }: StepAhead<'_>,
        state: &mut State<D>,
        acting: &ActingForces,
        books: Books<'_, D>,
    ) -> Result<StepMade, StepCollapsed> {
        let nodes = state.displacement.nodes();
        let (mut next_level, mut rejected, mut unresolved) = (None, 0, 0);
        loop {
            self.attempt(level, forces, time, state, acting, books.ledger);
            let Some(tolerances) = tolerances else { break };
            let error = self.error(level, forces, time, state);
            let error = tolerances.relative(&error, books.errors.motion(nodes));
            let next = adaptive::next_level(level, error).min(grid.top());
            let is_within = error <= 1.0;
            if is_within || level == 0 {
                unresolved = u64::from(!is_within);
                next_level = Some(next);
                break;
            }
            rejected += 1;
            level = next;
        }
        self.accept(level, state, books);
        Ok(StepMade {
            level,
            next_level,
            steps: 1,
            step_range: [grid.step(level); 2],
            rejected,
            unresolved,
            iterations: std::mem::take(&mut self.solver.iterations),
        })
    }

    fn peaks(&self) -> &[Four] {
        self.solver.peaks()
    }

    fn start_of_step(&self) -> Option<[&NodalField<D>; 3]> {
        let Stage { displacement, velocity, acceleration, .. } = &self.stages[STAGES - 2];
        Some([displacement, velocity, acceleration])
    }
}

impl<const D: usize> Esdirk<D> {
    /// Stepper for the steps of all levels of `grid`.
    pub(crate) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        forces: &Forces<D>,
        grid: &Grid,
        iteration_limit: u32,
    ) -> Result<Self, SingularBlock> {
        let zero = NodalField::zeros(initial.len());
        let unknowns = forces.points.start().unknowns.len();
        let level = |level| {
            let step = grid.step(level);
            Ok((step, StageMatrix::new(system, initial, stage_coefficients(step), forces)?))
        };
        Ok(Self {
            levels: (0..=grid.top()).map(level).collect::<Result<_, SingularBlock>>()?,
            solver: StageSolver::new(system, initial, forces, iteration_limit),
            stages: std::array::from_fn(|_| Stage {
                displacement: zero.clone(),
                velocity: zero.clone(),
                acceleration: zero.clone(),
                unknowns: vec![0.0; unknowns],
                unknown_rates: vec![0.0; unknowns],
            }),
            powers: [Work::default(); STAGES],
            local_error: 0.0,
            acceleration_offset: zero.clone(),
            velocity_offset: zero,
            unknown_base: vec![0.0; unknowns],
        })
    }

    /// Solves the stages of a step of `level` from `state` at `time`, at which the forces are `acting`; neither the state nor any book
    /// changes.
    fn attempt(
        &mut self,
        level: u32,
        forces: &Forces<D>,
        time: f64,
        state: &State<D>,
        acting: &ActingForces,
        ledger: &Ledger<D>,
    ) {
        let h = self.levels[level as usize].0;
        self.solver.begin_step(acting);
        for stage in 1..STAGES {
            self.predict(h, stage, state);
            self.predict_unknowns(h, stage, state);
            let matrix = &self.levels[level as usize].1;
            let offsets = [&self.acceleration_offset, &self.velocity_offset];
            let unknowns = UnknownStage { base: &self.unknown_base, factor: DIAGONAL * h };
            let at = StageAt { time: time + NODES[stage] * h, state: &state.points, unknowns };
            self.solver.solve(matrix, forces, at, offsets);
            let of_stage = &mut self.stages[stage - 1];
            let Stage { displacement, velocity, acceleration, .. } = of_stage;
            self.solver.rates(matrix, offsets, [acceleration, velocity]);
            // The next stage's predictor overwrites the solver's.
            std::mem::swap(displacement, &mut self.solver.displacement);
            of_stage.solve_unknowns(forces, at, &mut self.solver.acting.unknowns);
            if WEIGHTS[stage] != 0.0 {
                let Stage { displacement, velocity, .. } = of_stage;
                self.powers[stage] = ledger.power(velocity, displacement, &self.solver.acting, forces);
            }
        }
        self.local_error = self.displacement_error(h, state);
    }

    /// Takes the attempted step of `level` into `state` and the books.
    fn accept(&mut self, level: u32, state: &mut State<D>, Books { ledger, errors }: Books<'_, D>) {
        let h = self.levels[level as usize].0;
        self.powers[0] = state.stage_power;
        for (weight, power) in WEIGHTS.iter().zip(&self.powers).filter(|(weight, _)| **weight != 0.0) {
            ledger.book_power(weight * h, power);
        }
        state.stage_power = self.powers[STAGES - 1];
        let [_, s2, s3, s4, s5] = &self.stages;
        let [w0, _, w2, w3, w4, w5] = WEIGHTS.map(|weight| h * weight);
        ledger.book_matrices([
            (w0, &state.velocity, &state.displacement),
            (w2, &s2.velocity, &s2.displacement),
            (w3, &s3.velocity, &s3.displacement),
            (w4, &s4.velocity, &s4.displacement),
            (w5, &s5.velocity, &s5.displacement),
        ]);
        errors.add(self.local_error);
        // The next step overwrites the former values of the state.
        let Stage { displacement, velocity, acceleration, unknowns, unknown_rates } =
            &mut self.stages[STAGES - 2];
        std::mem::swap(&mut state.displacement, displacement);
        std::mem::swap(&mut state.velocity, velocity);
        std::mem::swap(&mut state.acceleration, acceleration);
        std::mem::swap(&mut state.points.unknowns, unknowns);
        std::mem::swap(&mut state.points.rates, unknown_rates);
    }

    /// Errors that the attempted step of `level` from `state` leaves.
    fn error(&self, level: u32, forces: &Forces<D>, time: f64, state: &State<D>) -> StepError {
        let h = self.levels[level as usize].0;
        let end = &self.stages[STAGES - 2];
        let values = 2.0 * end.displacement.nodes() as f64;
        let velocity_error = self.velocity_error(h, state);
        let mut friction = Four::splat(0.0);
        let (wall, contact) = (&forces.wall, &self.solver.acting.wall);
        for (group, _) in contact.touching() {
            let (x, v) = (&end.displacement.groups()[group], &end.velocity.groups()[group]);
            let error = std::array::from_fn(|dof| velocity_error(group, dof));
            friction = wall.friction_change(group, x, v, &error).max(friction);
        }
        let (x, v) = (&end.displacement, &end.velocity);
        friction = wall.largest_friction_change_along(contact, x, v, &velocity_error).max(friction);
        let mut friction = friction.to_array().into_iter().fold(0.0, f64::max);
        if forces.points.follow_motion() {
            let displacement_error = self.embedded_error(h, &state.velocity, |stage| &stage.velocity);
            friction = friction.max(forces.largest_sensitivity(
                (time + h, &state.points),
                [x, v],
                displacement_error,
                velocity_error,
            ));
        }
        StepError {
            displacement: ((self.local_error + 2.0 * self.surface_error(h, forces, state)) / values).sqrt(),
            friction,
            iteration_change: self.solver.change(),
        }
    }

    /// Sum of the squares of the lateral displacements' local errors \[m2\] by the embedded method of order 3.
    fn displacement_error(&self, h: f64, state: &State<D>) -> f64 {
        let error = self.embedded_error(h, &state.velocity, |stage| &stage.velocity);
        let mut sums = [Four::splat(0.0); LATERAL];
        for group in 0..state.velocity.groups().len() {
            for (dof, sum) in sums.iter_mut().enumerate() {
                let error = error(group, dof);
                *sum = error.mul_add(error, *sum);
            }
        }
        sums[0].sum() + sums[1].sum()
    }

    /// Sum of the squares of the local errors of the surface's displacement by the twist \[m2\], at the radius that would touch the wall.
    fn surface_error(&self, h: f64, forces: &Forces<D>, state: &State<D>) -> f64 {
        let Some(twist) = forces.wall.twist() else { return 0.0 };
        let error = self.embedded_error(h, &state.velocity, |stage| &stage.velocity);
        let squares = forces.wall.contact_radii().enumerate().map(|(group, radius)| {
            let error = error(group, twist) * radius;
            error * error
        });
        squares.fold(Four::splat(0.0), |sum, square| sum + square).sum()
    }

    /// Local errors of the velocities, by group and degree of freedom.
    fn velocity_error<'a>(&'a self, h: f64, state: &'a State<D>) -> impl Fn(usize, usize) -> Four + 'a {
        self.embedded_error(h, &state.acceleration, |stage| &stage.acceleration)
    }

    fn embedded_error<'a>(
        &'a self,
        h: f64,
        start: &'a NodalField<D>,
        rates: fn(&Stage<D>) -> &NodalField<D>,
    ) -> impl Fn(usize, usize) -> Four + 'a {
        let [w0, _, w2, w3, w4, w5] = ERROR_WEIGHTS.map(|weight| Four::splat(h * weight));
        let [_, r2, r3, r4, r5] = self.stages.each_ref().map(|stage| rates(stage).groups());
        let r0 = start.groups();
        move |group, dof| {
            let of = |rates: &[[Four; D]]| rates[group][dof];
            w0 * of(r0) + w2 * of(r2) + w3 * of(r3) + w4 * of(r4) + w5 * of(r5)
        }
    }

    /// Unknowns of a stage without the share of its own rates, and the start of their solution.
    fn predict_unknowns(&mut self, h: f64, stage: usize, state: &State<D>) {
        for (place, base) in self.unknown_base.iter_mut().enumerate() {
            let rate = |j: usize| match j {
                0 => state.points.rates[place],
                _ => self.stages[j - 1].unknown_rates[place],
            };
            let before = (0..stage).map(|j| STRICTLY_LOWER[stage][j] * rate(j)).sum::<f64>();
            *base = h.mul_add(before, state.points.unknowns[place]);
            self.solver.acting.unknowns[place] = (DIAGONAL * h).mul_add(rate(stage - 1), *base);
        }
    }

    /// Offsets of a stage from the earlier ones, and the start of its solution.
    fn predict(&mut self, h: f64, stage: usize, state: &State<D>) {
        let c = STRICTLY_LOWER[stage].map(|a| h * a);
        match stage {
            1 => self.predict_from(h, [(0, c[0])], stage, state),
            2 => self.predict_from(h, [(0, c[0]), (1, c[1])], stage, state),
            3 => self.predict_from(h, [(0, c[0]), (1, c[1]), (2, c[2])], stage, state),
            4 => self.predict_from(h, [(0, c[0]), (1, c[1]), (2, c[2]), (3, c[3])], stage, state),
            _ => self.predict_from(h, [(0, c[0]), (2, c[2]), (3, c[3]), (4, c[4])], stage, state),
        }
    }

    /// Prediction from the earlier stages that count, with the factors of their rates \[s\].
    fn predict_from<const K: usize>(
        &mut self,
        h: f64,
        earlier: [(usize, f64); K],
        stage: usize,
        state: &State<D>,
    ) {
        let velocity = |j: usize| if j == 0 { &state.velocity } else { &self.stages[j - 1].velocity };
        let acceleration =
            |j: usize| if j == 0 { &state.acceleration } else { &self.stages[j - 1].acceleration };
        let n = state.displacement.groups().len();
        let groups = |field| &NodalField::groups(field)[..n];
        let (x0, v0, last) =
            (groups(&state.displacement), groups(&state.velocity), groups(acceleration(stage - 1)));
        let (velocities, accelerations) =
            (earlier.map(|(j, _)| groups(velocity(j))), earlier.map(|(j, _)| groups(acceleration(j))));
        let weights = earlier.map(|(_, weight)| Four::splat(weight));
        let velocity_offset = &mut self.velocity_offset.groups_mut()[..n];
        let acceleration_offset = &mut self.acceleration_offset.groups_mut()[..n];
        let x = &mut self.solver.displacement.groups_mut()[..n];
        let v = &mut self.solver.velocity.groups_mut()[..n];
        let c = Four::splat(1.0 / (DIAGONAL * h));
        let diagonal = Four::splat(DIAGONAL * h);
        for i in 0..n {
            for dof in 0..D {
                let (mut x_base, mut v_base) = (x0[i][dof], v0[i][dof]);
                for j in 0..K {
                    x_base = velocities[j][i][dof].mul_add(weights[j], x_base);
                    v_base = accelerations[j][i][dof].mul_add(weights[j], v_base);
                }
                velocity_offset[i][dof] = -c * x_base;
                acceleration_offset[i][dof] = c * (velocity_offset[i][dof] - v_base);
                // The predictor is for the contacts alone.
                v[i][dof] = diagonal.mul_add(last[i][dof], v_base);
                x[i][dof] = diagonal.mul_add(v[i][dof], x_base);
            }
        }
    }
}

impl<const D: usize> Stage<D> {
    /// Solves for the unknowns of the stage, whose motion is known, from those that forces were found with.
    fn solve_unknowns(&mut self, forces: &Forces<D>, at: StageAt<'_>, unknowns: &mut [f64]) {
        if unknowns.is_empty() {
            return;
        }
        let motion = forces.motion_of(&self.displacement, &self.velocity);
        forces.points.solve_unknowns(at.time, &motion, at.unknowns, (&mut *unknowns, at.state));
        let UnknownStage { base, factor } = at.unknowns;
        for ((rate, value), base) in self.unknown_rates.iter_mut().zip(&*unknowns).zip(base) {
            *rate = (value - base) / factor;
        }
        self.unknowns.copy_from_slice(unknowns);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    fn tableau() -> [[f64; STAGES]; STAGES] {
        let mut a = [[0.0; STAGES]; STAGES];
        for i in 0..STAGES {
            a[i][..STAGES - 1].copy_from_slice(&STRICTLY_LOWER[i]);
            if i > 0 {
                a[i][i] += DIAGONAL;
            }
        }
        a
    }

    fn weighted(f: impl Fn(usize) -> f64) -> f64 {
        (0..STAGES).map(|i| WEIGHTS[i] * f(i)).sum()
    }

    #[test]
    fn tableau_satisfies_the_order_conditions_up_to_four() {
        let (a, c) = (tableau(), NODES);
        let row = |i: usize, f: &dyn Fn(usize) -> f64| (0..STAGES).map(|j| a[i][j] * f(j)).sum::<f64>();
        for (i, node) in c.iter().enumerate() {
            assert!((row(i, &|_| 1.0) - node).abs() < 1e-14, "row {i}");
        }
        // The eight rooted trees of order four or less (Butcher).
        let conditions = [
            (weighted(|_| 1.0), 1.0),
            (weighted(|i| c[i]), 1.0 / 2.0),
            (weighted(|i| c[i] * c[i]), 1.0 / 3.0),
            (weighted(|i| row(i, &|j| c[j])), 1.0 / 6.0),
            (weighted(|i| c[i].powi(3)), 1.0 / 4.0),
            (weighted(|i| c[i] * row(i, &|j| c[j])), 1.0 / 8.0),
            (weighted(|i| row(i, &|j| c[j] * c[j])), 1.0 / 12.0),
            (weighted(|i| row(i, &|j| row(j, &|k| c[k]))), 1.0 / 24.0),
        ];
        for (tree, (got, wanted)) in conditions.into_iter().enumerate() {
            assert!((got - wanted).abs() < 1e-14, "tree {tree}: {got} against {wanted}");
        }
    }

    #[test]
    fn embedded_weights_are_of_order_three() {
        let (a, c) = (tableau(), NODES);
        let embedded = |f: &dyn Fn(usize) -> f64| {
            (0..STAGES).map(|i| (WEIGHTS[i] - ERROR_WEIGHTS[i]) * f(i)).sum::<f64>()
        };
        let slopes = |i: usize| (0..STAGES).map(|j| a[i][j] * c[j]).sum::<f64>();
        let conditions = [
            (embedded(&|_| 1.0), 1.0),
            (embedded(&|i| c[i]), 1.0 / 2.0),
            (embedded(&|i| c[i] * c[i]), 1.0 / 3.0),
            (embedded(&slopes), 1.0 / 6.0),
        ];
        for (tree, (got, wanted)) in conditions.into_iter().enumerate() {
            assert!((got - wanted).abs() < 1e-14, "tree {tree}: {got} against {wanted}");
        }
        assert!((embedded(&|i| c[i].powi(3)) - 0.25).abs() > 1e-4, "and not of order four");
    }

    #[test]
    fn an_oscillation_of_the_resolved_angle_is_right_to_a_thousandth() {
        // y' = i y over a step of that angle: the stages are solved one after the other.
        let (a, z) = (tableau(), Complex::new(0.0, RESOLVED_ANGLE));
        let mut rates = [Complex::new(0.0, 0.0); STAGES];
        for i in 0..STAGES {
            let before: Complex<f64> = (0..i).map(|j| rates[j] * a[i][j]).sum();
            rates[i] = z * (Complex::new(1.0, 0.0) + before) / (Complex::new(1.0, 0.0) - z * a[i][i]);
        }
        let end = Complex::new(1.0, 0.0) + (0..STAGES).map(|i| rates[i] * WEIGHTS[i]).sum::<Complex<f64>>();
        assert!((end.arg() / RESOLVED_ANGLE - 1.0).abs() < 1e-3, "period: {end}");
        assert!((end.norm().ln() * std::f64::consts::TAU / RESOLVED_ANGLE).abs() < 1e-3, "amplitude: {end}");
    }

    #[test]
    fn last_stage_is_the_step_so_that_stiff_modes_vanish() {
        // Stiffly accurate with an invertible lower part: L-stable (Hairer and Wanner II, IV.3).
        assert_eq!(tableau()[STAGES - 1], WEIGHTS);
    }
}
