//! ESDIRK4(3)6L\[2\]SA, the implicit part of ARK4(3)6L\[2\]SA of Kennedy and Carpenter (2003): order 4, L-stable,
//! stiffly accurate, first stage explicit, diagonal 1/4.

use super::forces::Forces;
use super::implicit::{StageCoefficients, StageSolver, flat, flat_mut};
use super::{Books, State};
use crate::linalg::SingularBlock;
use crate::model::{DynamicSystem, NodalVector};

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

/// Stage values of one step; the last stage of a step is the first of the next.
#[derive(Debug, Clone)]
pub(super) struct Esdirk<const D: usize> {
    step: f64,
    pub(super) solver: StageSolver<D>,
    velocities: [NodalVector<D>; STAGES],
    accelerations: [NodalVector<D>; STAGES],
    displacement_base: NodalVector<D>,
    velocity_base: NodalVector<D>,
    acceleration_offset: NodalVector<D>,
    velocity_offset: NodalVector<D>,
}

impl<const D: usize> Esdirk<D> {
    pub(super) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        step: f64,
        sweeps: u32,
    ) -> Result<Self, SingularBlock> {
        let zero = vec![[0.0; D]; initial.len()];
        Ok(Self {
            step,
            solver: StageSolver::new(system, initial, stage_coefficients(step), sweeps)?,
            velocities: std::array::from_fn(|_| zero.clone()),
            accelerations: std::array::from_fn(|_| zero.clone()),
            displacement_base: zero.clone(),
            velocity_base: zero.clone(),
            acceleration_offset: zero.clone(),
            velocity_offset: zero,
        })
    }

    /// Advances `state` by one step from `time`. `state.stage_power` holds the powers of the step's first stage.
    pub(super) fn advance(
        &mut self,
        system: &DynamicSystem<D>,
        forces: &Forces<D>,
        time: f64,
        state: &mut State<D>,
        Books { ledger, errors }: Books<'_, D>,
    ) {
        let h = self.step;
        let c = 1.0 / (DIAGONAL * h);
        self.velocities[0].copy_from_slice(&state.velocity);
        self.accelerations[0].copy_from_slice(&state.acceleration);
        ledger.book_again(WEIGHTS[0] * h, &state.velocity, &state.displacement, &state.stage_power);
        for stage in 1..STAGES {
            combine(&mut self.displacement_base, &state.displacement, h, stage, &self.velocities);
            combine(&mut self.velocity_base, &state.velocity, h, stage, &self.accelerations);
            let (xb, vb) = (flat(&self.displacement_base), flat(&self.velocity_base));
            let last = flat(&self.accelerations[stage - 1]);
            let a_hat = flat_mut(&mut self.acceleration_offset);
            let v_hat = flat_mut(&mut self.velocity_offset);
            let x = flat_mut(&mut self.solver.displacement);
            let v = flat_mut(&mut self.solver.velocity);
            for i in 0..xb.len() {
                v_hat[i] = -c * xb[i];
                a_hat[i] = c * (v_hat[i] - vb[i]);
                // Predictor: the acceleration of the stage before.
                v[i] = vb[i] + DIAGONAL * h * last[i];
                x[i] = xb[i] + DIAGONAL * h * v[i];
            }
            let stage_time = time + NODES[stage] * h;
            self.solver.solve(system, forces, stage_time, &self.acceleration_offset, &self.velocity_offset);
            let v = flat(&self.solver.velocity);
            for ((a, v), vb) in flat_mut(&mut self.accelerations[stage]).iter_mut().zip(v).zip(vb) {
                *a = (v - vb) * c;
            }
            self.velocities[stage].copy_from_slice(&self.solver.velocity);
            if WEIGHTS[stage] != 0.0 {
                state.stage_power = ledger.book(
                    WEIGHTS[stage] * h,
                    &self.solver.velocity,
                    &self.solver.displacement,
                    &self.solver.contact,
                    forces.unbalance_at(stage_time),
                );
            }
        }
        let [v0, _, v2, v3, v4, v5] = &self.velocities;
        let [w0, _, w2, w3, w4, w5] = ERROR_WEIGHTS.map(|weight| h * weight);
        errors.add(v0.len(), |n, d| {
            w0 * v0[n][d] + w2 * v2[n][d] + w3 * v3[n][d] + w4 * v4[n][d] + w5 * v5[n][d]
        });
        state.displacement.copy_from_slice(&self.solver.displacement);
        state.velocity.copy_from_slice(&self.solver.velocity);
        state.acceleration.copy_from_slice(&self.accelerations[STAGES - 1]);
    }
}

/// `out = start + h sum_j a_stage,j rates_j` over the stages before `stage`.
fn combine<const D: usize>(
    out: &mut NodalVector<D>,
    start: &NodalVector<D>,
    h: f64,
    stage: usize,
    rates: &[NodalVector<D>; STAGES],
) {
    let c: [f64; STAGES - 1] = STRICTLY_LOWER[stage].map(|a| h * a);
    let [r0, r1, r2, r3, r4, _] = rates.each_ref().map(|rate| flat(rate));
    let (out, start) = (flat_mut(out), flat(start));
    match stage {
        1 => (0..out.len()).for_each(|i| out[i] = r0[i].mul_add(c[0], start[i])),
        2 => (0..out.len()).for_each(|i| out[i] = r1[i].mul_add(c[1], r0[i].mul_add(c[0], start[i]))),
        3 => (0..out.len()).for_each(|i| {
            out[i] = r2[i].mul_add(c[2], r1[i].mul_add(c[1], r0[i].mul_add(c[0], start[i])));
        }),
        4 => (0..out.len()).for_each(|i| {
            let s = r1[i].mul_add(c[1], r0[i].mul_add(c[0], start[i]));
            out[i] = r3[i].mul_add(c[3], r2[i].mul_add(c[2], s));
        }),
        _ => (0..out.len()).for_each(|i| {
            let s = r2[i].mul_add(c[2], r0[i].mul_add(c[0], start[i]));
            out[i] = r4[i].mul_add(c[4], r3[i].mul_add(c[3], s));
        }),
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
