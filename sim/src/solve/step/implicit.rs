//! Common part of both implicit integrators: a stage solve on one stored factor with contact iterations.
//!
//! At a stage the velocities and accelerations are linear in the unknown displacements,
//! `v = v^ + c_v x` and `a = a^ + c_a x`, so that the equations of motion become
//! `(c_a M + c_v C + K) x = F_external + F_contact(x, v) - M a^ - C v^`. The matrix A0 is factored once for each step length.
//! Contact stays on the right-hand side and is re-evaluated in each contact iteration, implicitly at each node: the blocks on the diagonal
//! of A0^-1 are the compliance of a node to its own contact force, and the force is the one that agrees with it. A sticking node,
//! whose friction is a damper of F_n / v_ref and stiffer than any step resolves, is therefore held in the first iteration. The iterations
//! have to converge only in the forces of nodes on each other.

use super::forces::{ActingForces, Forces, StageAt, StageCompliance};
use crate::force::wall::IterationChange;
use crate::math::dof::LATERAL;
use crate::math::linalg::{
    BlockTridiagonal, Factor, Four, Lane, MatrixPair, NodalField, SingularBlock, Symmetric,
};
use crate::solve::model::NodalVector;
use crate::solve::motion::DynamicSystem;

/// Changes between two contact iterations at which more of them are pointless: of a lateral displacement \[m\], which is 0.01 N of contact force at
/// 1e7 N/m, and of a friction coefficient.
const CONVERGED: IterationChange = IterationChange { lateral: 1e-9, friction: 1e-6 };

/// Changes of the last contact iteration beyond which a solve counts as loose: 1e-5 m is 100 N of contact force at 1e7 N/m, the weight of some
/// decimetres of drillpipe, and 0.05 is a sixth to a quarter of usual friction coefficients. Loose solves are counted and have no other effect.
const LOOSE: IterationChange = IterationChange { lateral: 1e-5, friction: 0.05 };

/// The matrix of the stages of one step length, factored.
#[derive(Debug, Clone)]
pub(crate) struct StageMatrix<const D: usize> {
    factor: Factor<D>,
    coefficients: StageCoefficients,
    /// Entries of the right-hand side at the held degrees of freedom.
    held_values: Vec<f64>,
    /// Compliance of nodes to their own contact forces.
    compliance: StageCompliance,
}

/// Vectors of a stage's solve, and data that all step lengths share.
#[derive(Debug, Clone)]
pub(crate) struct StageSolver<const D: usize> {
    mass_and_damping: MatrixPair<Symmetric, D>,
    held: Vec<(usize, usize)>,
    /// Number of contact iterations of a solve; more than two are a limit.
    iteration_limit: u32,
    external: NodalField<D>,
    right: NodalField<D>,
    /// Intermediate values of a solve: written on the way inwards, read on the way outwards.
    between: NodalVector<D>,
    /// Displacements of the stage: the predictor before a solve, the solution after it.
    pub(crate) displacement: NodalField<D>,
    /// The predictor of the velocities.
    pub(crate) velocity: NodalField<D>,
    /// Displacements of the contact iteration before.
    previous: NodalField<D>,
    /// Forces of the last contact iteration.
    pub(crate) acting: ActingForces,
    pub(crate) iterations: ContactIterations,
    /// Changes by the last contact iterations of the solves of a step.
    change: IterationChange,
    /// Largest normal forces in the solves of a step.
    peaks: Vec<Four>,
    /// Room for the normal forces of a solve.
    normal_forces: Vec<Four>,
}

/// Distance of a run's contact iterations from convergence.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ContactIterations {
    /// Largest change of a touching node's lateral displacement in the last contact iteration of any solve \[m\].
    pub largest_change: f64,
    /// Solves whose last contact iteration still changed a touching node's displacement by more than 1e-5 m or its friction coefficient by more
    /// than 0.05.
    pub loose_solves: u64,
    /// Contact iterations made.
    pub count: u64,
}

impl ContactIterations {
    /// Takes in another count and empties it.
    pub(crate) fn merge(&mut self, other: &mut ContactIterations) {
        let other = std::mem::take(other);
        self.largest_change = self.largest_change.max(other.largest_change);
        self.loose_solves += other.loose_solves;
        self.count += other.count;
    }
}

/// Velocities and accelerations of a stage per displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StageCoefficients {
    /// c_a \[1/s2\].
    pub(crate) acceleration: f64,
    /// c_v \[1/s\].
    pub(crate) velocity: f64,
}

impl StageCoefficients {
    /// `c_a M + c_v C + K`, held degrees of freedom with a diagonal of the size of their node's other entries: next to 1e15 a one would
    /// count as zero. It is a power of two, which costs no digits.
    pub(crate) fn matrix<const D: usize>(&self, system: &DynamicSystem<D>) -> BlockTridiagonal<D> {
        let mut matrix = BlockTridiagonal::combine(
            self.acceleration,
            &system.mass,
            self.velocity,
            &system.damping,
            1.0,
            &system.stiffness,
        );
        for (node, dof) in system.held_places() {
            let largest = (0..D).fold(0.0_f64, |most, i| most.max(matrix.diagonal[node][(i, i)].abs()));
            matrix.diagonal[node][(dof, dof)] =
                if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
        }
        matrix
    }
}

impl<const D: usize> StageMatrix<D> {
    pub(crate) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        coefficients: StageCoefficients,
        forces: &Forces<D>,
    ) -> Result<Self, SingularBlock> {
        let matrix = coefficients.matrix(system);
        let held = system.held_places().into_iter();
        Ok(Self {
            factor: Factor::new(&matrix)?,
            coefficients,
            compliance: forces.compliance(&matrix.inverse_bands()?, coefficients.velocity),
            held_values: held
                .map(|(node, dof)| initial[node][dof] * matrix.diagonal[node][(dof, dof)])
                .collect(),
        })
    }
}

impl<const D: usize> StageSolver<D> {
    pub(crate) fn new(
        system: &DynamicSystem<D>,
        initial: &[[f64; D]],
        forces: &Forces<D>,
        iteration_limit: u32,
    ) -> Self {
        let zero = NodalField::zeros(initial.len());
        Self {
            mass_and_damping: MatrixPair::new(&system.mass, &system.damping),
            held: system.held_places(),
            iteration_limit,
            external: zero.clone(),
            right: zero.clone(),
            between: vec![[0.0; D]; initial.len()],
            displacement: zero.clone(),
            velocity: zero.clone(),
            previous: zero,
            acting: ActingForces::none(forces),
            iterations: ContactIterations::default(),
            change: IterationChange::default(),
            peaks: vec![Four::ZERO; initial.len().div_ceil(Four::LANES)],
            normal_forces: vec![Four::ZERO; initial.len().div_ceil(Four::LANES)],
        }
    }

    /// Begins a step from a state with the forces `acting`.
    pub(crate) fn begin_step(&mut self, acting: &ActingForces) {
        self.acting.copy_from(acting);
        self.change = IterationChange::default();
        self.peaks.fill(Four::ZERO);
    }

    /// Changes by the last contact iterations of the solves of this step.
    pub(crate) fn change(&self) -> IterationChange {
        self.change
    }

    /// Largest normal force of each node in the solves of this step \[N\], four nodes side by side.
    pub(crate) fn peaks(&self) -> &[Four] {
        &self.peaks
    }

    /// Solves the stage `at` a time from the predictor in `displacement` and `velocity`; `acceleration_offset` is
    /// a^ and `velocity_offset` is v^.
    pub(crate) fn solve(
        &mut self,
        matrix: &StageMatrix<D>,
        forces: &Forces<D>,
        at: StageAt<'_>,
        [acceleration_offset, velocity_offset]: [&NodalField<D>; 2],
    ) {
        self.mass_and_damping.subtract_products(
            &forces.load,
            acceleration_offset,
            velocity_offset,
            &mut self.external,
        );
        forces.add_of_time(at.time, &mut self.acting, &mut self.external);
        for (&(node, dof), &value) in self.held.iter().zip(&matrix.held_values) {
            self.external[(node, dof)] = value;
        }
        let speed = matrix.coefficients.velocity;
        let c = Four::splat(speed);
        let mut change = IterationChange::default();
        for iteration in 1..=self.iteration_limit {
            let x = &self.displacement;
            if iteration == 1 {
                let rates = |group: usize, dof: usize| self.velocity.groups()[group][dof];
                let (acting, right) = (&mut self.acting, &mut self.right);
                forces.add_implicit(&matrix.compliance, at, x, rates, acting, (&self.external, right));
            } else {
                // Few nodes touch: between the contact iterations only their velocities are formed.
                let (moved, offset) = (x.groups(), velocity_offset.groups());
                let rates = |group: usize, dof: usize| moved[group][dof].mul_add(c, offset[group][dof]);
                let (acting, right) = (&mut self.acting, &mut self.right);
                forces.add_implicit(&matrix.compliance, at, x, rates, acting, (&self.external, right));
            }
            std::mem::swap(&mut self.displacement, &mut self.previous);
            matrix.factor.solve_field(&self.right, &mut self.between, &mut self.displacement);
            self.iterations.count += 1;
            // Two contact iterations are a fixed count; more are a cap on the way to convergence.
            if iteration >= 2 && (self.iteration_limit > 2 || iteration == self.iteration_limit) {
                let (moved, offset) = (self.displacement.groups(), velocity_offset.groups());
                let rates = |group: usize, dof: usize| moved[group][dof].mul_add(c, offset[group][dof]);
                change = forces.wall.iteration_change(
                    &self.acting.wall,
                    &self.displacement,
                    &self.previous,
                    rates,
                    speed,
                );
                if change.is_within(&CONVERGED) {
                    break;
                }
            }
        }
        self.change.merge(change);
        self.acting.wall.add_to_peaks(&mut self.peaks, &mut self.normal_forces);
        self.iterations.largest_change = self.iterations.largest_change.max(change.lateral);
        self.iterations.loose_solves += u64::from(!change.is_within(&LOOSE));
    }

    /// Accelerations and velocities of the stage that was solved, from their offsets a^ and v^.
    pub(crate) fn rates(
        &self,
        matrix: &StageMatrix<D>,
        offsets: [&NodalField<D>; 2],
        rates: [&mut NodalField<D>; 2],
    ) {
        let n = self.displacement.groups().len();
        let x = &self.displacement.groups()[..n];
        let [a0, v0] = offsets.map(|field| &field.groups()[..n]);
        let [acceleration, velocity] = rates;
        let (a, v) = (&mut acceleration.groups_mut()[..n], &mut velocity.groups_mut()[..n]);
        let c_a = Four::splat(matrix.coefficients.acceleration);
        let c_v = Four::splat(matrix.coefficients.velocity);
        for i in 0..n {
            for dof in 0..D {
                a[i][dof] = x[i][dof].mul_add(c_a, a0[i][dof]);
                v[i][dof] = x[i][dof].mul_add(c_v, v0[i][dof]);
            }
        }
        for &(node, dof) in &self.held {
            acceleration[(node, dof)] = 0.0;
            velocity[(node, dof)] = 0.0;
        }
    }
}

/// `out = x factor + y`.
pub(crate) fn multiply_add<const D: usize>(
    x: &NodalField<D>,
    factor: f64,
    y: &NodalField<D>,
    out: &mut NodalField<D>,
) {
    let factor = Four::splat(factor);
    for ((out, x), y) in out.groups_mut().iter_mut().zip(x.groups()).zip(y.groups()) {
        for dof in 0..D {
            out[dof] = x[dof].mul_add(factor, y[dof]);
        }
    }
}

/// The largest difference of a lateral displacement \[m\].
pub(crate) fn largest_change<const D: usize>(new: &NodalField<D>, old: &NodalField<D>) -> f64 {
    let mut largest = [Four::splat(0.0); LATERAL];
    for (new, old) in new.groups().iter().zip(old.groups()) {
        for (dof, largest) in largest.iter_mut().enumerate() {
            *largest = (new[dof] - old[dof]).abs().max(*largest);
        }
    }
    largest[0].max(largest[1]).to_array().into_iter().fold(0.0, f64::max)
}
