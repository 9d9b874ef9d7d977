//! Work that the string's matrices do along its motion.

use crate::linalg::{Block, BlockTridiagonal, Four, Lane};
use crate::model::NodalVector;

/// Stages that are gathered before the forms' matrices are read: one vector of them.
const GATHERED: usize = Four::LANES;

/// Entries below this share of the matrix' largest entry are rounding of terms that cancel.
const CANCELLED: f64 = 1e-13;

/// Time integrals of `v^T S v` with the symmetric parts of several matrices and of `v^T A x` with the skew part of one
/// more: sums over stages of a weight \[s\] times the form.
///
/// Stages are gathered first and then taken side by side, so that a matrix is read once for all of them.
#[derive(Debug, Clone)]
pub(super) struct Forms<const N: usize, const D: usize> {
    symmetric: [Form<D>; N],
    skew: Form<D>,
    stages: [Stage<D>; GATHERED],
    gathered: usize,
}

/// Velocities and displacements at a stage.
#[derive(Debug, Clone)]
struct Stage<const D: usize> {
    weight: f64,
    velocity: NodalVector<D>,
    displacement: NodalVector<D>,
}

/// What is left of a matrix at each node: the block on the diagonal and the one above it, or nothing. The symmetric
/// part of the Coriolis matrix lives where the section changes, the skew part of the stiffness where the torque does
/// and at the free end: between equal neighbours the element's boundary terms cancel.
#[derive(Debug, Clone)]
struct Form<const D: usize>(Vec<Option<Box<[Block<f64, D>; 2]>>>);

/// Values of a node at the gathered stages, side by side.
type Values<const D: usize> = [Four; D];

/// Integrals of the forms: the symmetric ones, then the skew one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Integrals<const N: usize> {
    pub(super) symmetric: [f64; N],
    pub(super) skew: f64,
}

impl<const N: usize, const D: usize> Forms<N, D> {
    pub(super) fn new(symmetric: [&BlockTridiagonal<f64, D>; N], skew: &BlockTridiagonal<f64, D>) -> Self {
        let zero = vec![[0.0; D]; skew.rows()];
        let stage = Stage { weight: 0.0, velocity: zero.clone(), displacement: zero };
        Self {
            symmetric: symmetric.map(|m| Form::new(m, 0.5)),
            skew: Form::new(skew, -0.5),
            stages: std::array::from_fn(|_| stage.clone()),
            gathered: 0,
        }
    }

    /// Whether the next stage needs [`Forms::take`] first.
    pub(super) fn is_full(&self) -> bool {
        self.gathered == GATHERED
    }

    /// Forgets the stages gathered.
    pub(super) fn forget(&mut self) {
        self.gathered = 0;
    }

    /// Gathers a stage.
    pub(super) fn gather(&mut self, weight: f64, velocity: &[[f64; D]], displacement: &[[f64; D]]) {
        let stage = &mut self.stages[self.gathered];
        stage.weight = weight;
        stage.velocity.copy_from_slice(velocity);
        stage.displacement.copy_from_slice(displacement);
        self.gathered += 1;
    }

    /// Adds to the weight of the last stage; false when there is none.
    pub(super) fn weigh_last(&mut self, weight: f64) -> bool {
        let Some(last) = self.stages[..self.gathered].last_mut() else { return false };
        last.weight += weight;
        true
    }

    /// Integrals over the stages gathered, which are forgotten.
    pub(super) fn take(&mut self) -> Integrals<N> {
        for stage in &mut self.stages[self.gathered..] {
            stage.weight = 0.0;
        }
        self.gathered = 0;
        let stages = &self.stages;
        let weight = Four::new(std::array::from_fn(|lane| stages[lane].weight));
        let velocity = |node: usize| side_by_side(stages.each_ref().map(|stage| stage.velocity.get(node)));
        let displacement =
            |node: usize| side_by_side(stages.each_ref().map(|stage| stage.displacement.get(node)));
        let zero = Four::splat(0.0);
        let (mut symmetric, mut skew) = ([zero; N], zero);
        let (mut v, mut x) = (velocity(0), displacement(0));
        for node in 0..self.skew.0.len() {
            let (v_next, x_next) = (velocity(node + 1), displacement(node + 1));
            let weighted = v.map(|v| weight * v);
            for (sum, form) in symmetric.iter_mut().zip(&self.symmetric) {
                if let Some(blocks) = &form.0[node] {
                    *sum = add_symmetric(*sum, blocks, &weighted, &v, &v_next);
                }
            }
            if let Some(blocks) = &self.skew.0[node] {
                let weighted_displacement = x.map(|x| weight * x);
                skew = add_skew(skew, blocks, (&weighted, &v_next), (&weighted_displacement, &x, &x_next));
            }
            (v, x) = (v_next, x_next);
        }
        let total = |lanes: Four| {
            let [a, b, c, d] = lanes.to_array();
            (a + b) + (c + d)
        };
        Integrals { symmetric: symmetric.map(total), skew: total(skew) }
    }
}

impl<const D: usize> Form<D> {
    /// The symmetric part of `m` for `with_transpose` = 1/2, the skew part for -1/2.
    fn new(m: &BlockTridiagonal<f64, D>, with_transpose: f64) -> Self {
        let part = half_sum(m, with_transpose);
        let threshold = CANCELLED * largest(m);
        let rows = part.diagonal.iter().zip(&part.upper).map(|(diagonal, upper)| {
            let entries = diagonal.columns.as_flattened().iter().chain(upper.columns.as_flattened());
            let present = entries.fold(0.0_f64, |most, v| most.max(v.abs())) > threshold;
            present.then(|| Box::new([*diagonal, *upper]))
        });
        Self(rows.collect())
    }
}

/// Adds `w v_n^T (D v_n + 2 U v_(n+1))`, U being mirrored below the diagonal; `weighted` is w v_n.
#[inline(always)]
fn add_symmetric<const D: usize>(
    sum: Four,
    [d, u]: &[Block<f64, D>; 2],
    weighted: &Values<D>,
    v: &Values<D>,
    v_next: &Values<D>,
) -> Four {
    let mut sum = sum;
    let twice = v_next.map(|v| v + v);
    for (row, weighted) in weighted.iter().enumerate() {
        let own = row_product(d, row, v, Four::splat(0.0));
        sum = weighted.mul_add(row_product(u, row, &twice, own), sum);
    }
    sum
}

/// Adds `w v_n^T (D x_n + U x_(n+1)) - w x_n^T U v_(n+1)`: below the diagonal stands minus the transposed U.
#[inline(always)]
fn add_skew<const D: usize>(
    sum: Four,
    [d, u]: &[Block<f64, D>; 2],
    (weighted_velocity, v_next): (&Values<D>, &Values<D>),
    (weighted_displacement, x, x_next): (&Values<D>, &Values<D>, &Values<D>),
) -> Four {
    let mut sum = sum;
    for row in 0..D {
        let own = row_product(d, row, x, Four::splat(0.0));
        sum = weighted_velocity[row].mul_add(row_product(u, row, x_next, own), sum);
        let pulled = row_product(u, row, v_next, Four::splat(0.0));
        sum = (-weighted_displacement[row]).mul_add(pulled, sum);
    }
    sum
}

#[inline(always)]
fn row_product<const D: usize>(block: &Block<f64, D>, row: usize, x: &Values<D>, sum: Four) -> Four {
    let columns = block.columns.iter().zip(x);
    columns.fold(sum, |sum, (column, x)| Four::splat(column[row]).mul_add(*x, sum))
}

/// Values of one node at all stages; zero beyond the bit.
#[inline(always)]
fn side_by_side<const D: usize>(stages: [Option<&[f64; D]>; GATHERED]) -> Values<D> {
    let [a, b, c, d] = stages.map(|values| values.unwrap_or(&[0.0; D]));
    std::array::from_fn(|dof| Four::new([a[dof], b[dof], c[dof], d[dof]]))
}

/// `m / 2 + with_transpose m^T`.
pub(super) fn half_sum<const D: usize>(
    m: &BlockTridiagonal<f64, D>,
    with_transpose: f64,
) -> BlockTridiagonal<f64, D> {
    BlockTridiagonal::combine(0.5, m, with_transpose, &transpose(m), 0.0, m)
}

fn largest<const D: usize>(m: &BlockTridiagonal<f64, D>) -> f64 {
    let blocks = m.lower.iter().chain(&m.diagonal).chain(&m.upper);
    blocks.flat_map(|block| block.columns.iter().flatten()).fold(0.0_f64, |most, v| most.max(v.abs()))
}

fn transpose<const D: usize>(m: &BlockTridiagonal<f64, D>) -> BlockTridiagonal<f64, D> {
    let n = m.rows();
    let mut t = BlockTridiagonal::zeros(n);
    let flip = |block: &Block<f64, D>| Block::from_fn(|row, column| block[(column, row)]);
    for i in 0..n {
        t.diagonal[i] = flip(&m.diagonal[i]);
        if i + 1 < n {
            t.upper[i] = flip(&m.lower[i + 1]);
            t.lower[i + 1] = flip(&m.upper[i]);
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::DOFS;

    /// `full` of every hundred rows carry blocks.
    fn matrix(rows: usize, full: usize) -> BlockTridiagonal<f64> {
        let mut m = BlockTridiagonal::zeros(rows);
        for row in (0..rows).filter(|row| row % 100 < full) {
            let block = |shift: usize| {
                Block::from_fn(|i, j| ((shift + 1) as f64 * (row * 36 + i * 6 + j) as f64).sin())
            };
            m.diagonal[row] = block(0);
            if row + 1 < rows {
                m.upper[row] = block(1);
                m.lower[row + 1] = block(2);
            }
        }
        m
    }

    fn vector(rows: usize, seed: f64) -> Vec<[f64; DOFS]> {
        (0..rows).map(|row| std::array::from_fn(|i| (seed + (6 * row + i) as f64).cos())).collect()
    }

    fn product(a: &[[f64; DOFS]], m: &BlockTridiagonal<f64>, b: &[[f64; DOFS]]) -> f64 {
        let mut y = vec![[0.0; DOFS]; b.len()];
        m.multiply_into(b, &mut y);
        a.as_flattened().iter().zip(y.as_flattened()).map(|(a, y)| a * y).sum()
    }

    #[test]
    fn integrals_are_those_of_the_whole_matrices() {
        let rows = 201;
        let (v, x) = (vector(rows, 0.3), vector(rows, 1.1));
        let (v2, x2) = (vector(rows, 2.3), vector(rows, 0.1));
        // The last place is a rounding of 20,000 terms of order one.
        let tolerance = 1e-10;
        for full in [0, 3, 100] {
            let (m, other) = (matrix(rows, full), matrix(rows, 100));
            let mut forms = Forms::new([&m, &other], &m);
            forms.gather(7.0, &x, &v);
            forms.forget();
            forms.gather(0.5, &v, &x);
            assert!(forms.weigh_last(0.25));
            forms.gather(0.4, &v2, &x2);
            let integrals = forms.take();
            // v^T M v sees the symmetric part alone; (v^T M x - x^T M v) / 2 the skew one.
            let square = |m| 0.75 * product(&v, m, &v) + 0.4 * product(&v2, m, &v2);
            let skew = |v: &[_], x: &[_]| 0.5 * (product(v, &m, x) - product(x, &m, v));
            let wanted = Integrals {
                symmetric: [square(&m), square(&other)],
                skew: 0.75 * skew(&v, &x) + 0.4 * skew(&v2, &x2),
            };
            assert!(
                (integrals.symmetric[0] - wanted.symmetric[0]).abs() < tolerance,
                "{integrals:?} {wanted:?}"
            );
            assert!(
                (integrals.symmetric[1] - wanted.symmetric[1]).abs() < tolerance,
                "{integrals:?} {wanted:?}"
            );
            assert!((integrals.skew - wanted.skew).abs() < tolerance, "{integrals:?} {wanted:?}");
            assert!(!forms.weigh_last(1.0) && forms.take().skew == 0.0, "taken stages are forgotten");
        }
    }
}
