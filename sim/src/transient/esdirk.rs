//! ESDIRK4(3)6L\[2\]SA, the implicit part of ARK4(3)6L\[2\]SA of Kennedy and Carpenter (2003): order 4, L-stable,
//! stiffly accurate, first stage explicit, diagonal 1/4.

use super::forces::Forces;
use super::implicit::{StageCoefficients, StageSolver};
use super::run::{Books, State};
use crate::linalg::{Four, Lane, NodalField, SingularBlock};
use crate::model::DynamicSystem;

const STAGES: usize = 6;
pub(super) const DIAGONAL: f64 = 0.25;

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

/// Weights less those of the embedded method of order 3: what they make of the stages is an error of the step.
const ERROR_WEIGHTS: [f64; STAGES] = [
    WEIGHTS[0] - 4586570599.0 / 29645900160.0,
    0.0,
    WEIGHTS[2] - 178811875.0 / 945068544.0,
    WEIGHTS[3] - 814220225.0 / 1159782912.0,
    WEIGHTS[4] + 3700637.0 / 11593932.0,
    WEIGHTS[5] - 61727.0 / 225920.0,
];

/// Of every stage of a step \[s\].
pub(super) fn stage_coefficients(step: f64) -> StageCoefficients {
    let c = 1.0 / (DIAGONAL * step);
    StageCoefficients { acceleration: c * c, velocity: c }
}

/// Stages of one step; the last one is the first of the next step.
#[derive(Debug, Clone)]
pub(super) struct Esdirk<const D: usize> {
    step: f64,
    pub(super) solver: StageSolver<D>,
    /// Of the stages after the first, which is the state at the step's start.
    stages: [Stage<D>; STAGES - 1],
    acceleration_offset: NodalField<D>,
    velocity_offset: NodalField<D>,
}

/// Motion at a stage.
#[derive(Debug, Clone)]
struct Stage<const D: usize> {
    displacement: NodalField<D>,
    velocity: NodalField<D>,
    acceleration: NodalField<D>,
}

impl<const D: usize> Esdirk<D> {
    pub(super) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        step: f64,
        sweeps: u32,
    ) -> Result<Self, SingularBlock> {
        let zero = NodalField::zeros(initial.len());
        Ok(Self {
            step,
            solver: StageSolver::new(system, initial, stage_coefficients(step), sweeps)?,
            stages: std::array::from_fn(|_| Stage {
                displacement: zero.clone(),
                velocity: zero.clone(),
                acceleration: zero.clone(),
            }),
            acceleration_offset: zero.clone(),
            velocity_offset: zero,
        })
    }

    /// Advances `state` by one step from `time`. `state.stage_power` holds the powers of the step's first stage.
    pub(super) fn advance(
        &mut self,
        forces: &Forces<D>,
        time: f64,
        state: &mut State<D>,
        Books { ledger, errors }: Books<'_, D>,
    ) {
        let h = self.step;
        ledger.book_power(WEIGHTS[0] * h, &state.stage_power);
        for stage in 1..STAGES {
            self.predict(stage, state);
            let stage_time = time + NODES[stage] * h;
            self.solver.solve(forces, stage_time, &self.acceleration_offset, &self.velocity_offset);
            let Stage { displacement, velocity, acceleration } = &mut self.stages[stage - 1];
            self.solver.rates([&self.acceleration_offset, &self.velocity_offset], [acceleration, velocity]);
            // The next stage's predictor overwrites the solver's.
            std::mem::swap(displacement, &mut self.solver.displacement);
            if WEIGHTS[stage] != 0.0 {
                let unbalance = forces.unbalance_at(stage_time);
                state.stage_power = ledger.power(velocity, displacement, &self.solver.contact, unbalance);
                ledger.book_power(WEIGHTS[stage] * h, &state.stage_power);
            }
        }
        let [_, s2, s3, s4, s5] = &self.stages;
        let [w0, _, w2, w3, w4, w5] = WEIGHTS.map(|weight| h * weight);
        ledger.book_matrices([
            (w0, &state.velocity, &state.displacement),
            (w2, &s2.velocity, &s2.displacement),
            (w3, &s3.velocity, &s3.displacement),
            (w4, &s4.velocity, &s4.displacement),
            (w5, &s5.velocity, &s5.displacement),
        ]);
        let [w0, _, w2, w3, w4, w5] = ERROR_WEIGHTS.map(|weight| Four::splat(h * weight));
        let v0 = &state.velocity;
        let [v2, v3, v4, v5] = [s2, s3, s4, s5].map(|stage| &stage.velocity);
        let [v0, v2, v3, v4, v5] = [v0, v2, v3, v4, v5].map(|velocity| velocity.groups());
        errors.add(v0.len(), |group, dof| {
            let of = |velocity: &[[Four; D]]| velocity[group][dof];
            w0 * of(v0) + w2 * of(v2) + w3 * of(v3) + w4 * of(v4) + w5 * of(v5)
        });
        // What the state held before is overwritten in the next step.
        let Stage { displacement, velocity, acceleration } = &mut self.stages[STAGES - 2];
        std::mem::swap(&mut state.displacement, displacement);
        std::mem::swap(&mut state.velocity, velocity);
        std::mem::swap(&mut state.acceleration, acceleration);
    }

    /// Offsets of a stage from those before it, and what its solution starts from.
    fn predict(&mut self, stage: usize, state: &State<D>) {
        let c = STRICTLY_LOWER[stage].map(|a| self.step * a);
        match stage {
            1 => self.predict_from([(0, c[0])], stage, state),
            2 => self.predict_from([(0, c[0]), (1, c[1])], stage, state),
            3 => self.predict_from([(0, c[0]), (1, c[1]), (2, c[2])], stage, state),
            4 => self.predict_from([(0, c[0]), (1, c[1]), (2, c[2]), (3, c[3])], stage, state),
            _ => self.predict_from([(0, c[0]), (2, c[2]), (3, c[3]), (4, c[4])], stage, state),
        }
    }

    /// With the earlier stages that count, and what their rates are multiplied with \[s\].
    fn predict_from<const K: usize>(&mut self, earlier: [(usize, f64); K], stage: usize, state: &State<D>) {
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
        let c = Four::splat(1.0 / (DIAGONAL * self.step));
        let diagonal = Four::splat(DIAGONAL * self.step);
        for i in 0..n {
            for dof in 0..D {
                let (mut x_base, mut v_base) = (x0[i][dof], v0[i][dof]);
                for j in 0..K {
                    x_base = velocities[j][i][dof].mul_add(weights[j], x_base);
                    v_base = accelerations[j][i][dof].mul_add(weights[j], v_base);
                }
                velocity_offset[i][dof] = -c * x_base;
                acceleration_offset[i][dof] = c * (velocity_offset[i][dof] - v_base);
                // The predictor is for the contacts alone, which ask for the lateral motion and the twist.
                if dof < 2 || dof + 1 == D {
                    v[i][dof] = diagonal.mul_add(last[i][dof], v_base);
                    x[i][dof] = diagonal.mul_add(v[i][dof], x_base);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
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
    fn last_stage_is_the_step_so_that_stiff_modes_vanish() {
        // Stiffly accurate with an invertible lower part: L-stable (Hairer and Wanner II, IV.3).
        assert_eq!(tableau()[STAGES - 1], WEIGHTS);
    }
}
