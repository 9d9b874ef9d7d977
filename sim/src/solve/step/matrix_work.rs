//! Work that the string's matrices do along its motion.

use crate::math::linalg::{
    Block, BlockTridiagonal, Four, Lane, NodalField, SkewPart, WeightedPair, after, can_couple, each_dof,
};

/// Number of stages gathered before the moments are updated: the moments then pass through the processor once for all of them.
const GATHERED: usize = 4;

/// Entries below this share of the matrix' largest entry are rounding of terms that cancel.
const CANCELLED: f64 = 1e-13;

/// Time integrals of `v^T S v` with the symmetric parts of several matrices and of `v^T A x` with the skew part of one
/// more: sums over stages of a weight \[s\] times the form.
///
/// A sum of symmetric forms is the matrix times the sum of the stages' products `v v^T`, entry by entry. Therefore only those products, of
/// a node with itself and with the next one, are summed, once for all matrices; no matrix is read before the work is
/// requested, and the matrices of the time step keep the cache for themselves. The skew matrix is read, for several stages at once.
#[derive(Debug, Clone)]
pub(crate) struct Forms<const N: usize, const D: usize> {
    symmetric: [SymmetricPart<D>; N],
    skew: SkewPart<D>,
    /// Sums of products `w v_i v_j` of velocities of neighbouring nodes, weighted \[s\]: of every four nodes in turn, of each with itself
    /// and with the next one, in [`Places`].
    moments: Vec<Four>,
    /// True if any of the symmetric matrices couples the last degree of freedom with others than the two before it.
    last_couples: bool,
    skew_sum: f64,
    gathered: [GatheredStage<D>; GATHERED],
    count: usize,
}

/// A stage for the forms: the seconds that it counts, its velocities and displacements.
pub(crate) type BookedStage<'a, const D: usize> = WeightedPair<'a, D>;

#[derive(Debug, Clone)]
struct GatheredStage<const D: usize> {
    weight: f64,
    velocity: NodalField<D>,
    displacement: NodalField<D>,
}

/// Integrals of the forms: the symmetric ones, then the skew one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Integrals<const N: usize> {
    pub(crate) symmetric: [f64; N],
    pub(crate) skew: f64,
}

/// Remainder of a matrix' symmetric part, with the nodes that have one: blocks on the diagonal and blocks above it. Between
/// equal neighbours the Coriolis matrices' boundary terms cancel: their remainder is at changes of the section.
#[derive(Debug, Clone)]
struct SymmetricPart<const D: usize> {
    diagonal: Vec<(usize, Block<D>)>,
    upper: Vec<(usize, Block<D>)>,
}

impl<const N: usize, const D: usize> Forms<N, D> {
    pub(crate) fn new(symmetric: [&BlockTridiagonal<D>; N], skew: &BlockTridiagonal<D>) -> Self {
        let zero = NodalField::zeros(skew.rows());
        let last_couples = symmetric.iter().any(|matrix| matrix.last_couples());
        let moments = vec![Four::ZERO; zero.groups().len() * count::<D>(last_couples)];
        let stage = GatheredStage { weight: 0.0, velocity: zero.clone(), displacement: zero };
        Self {
            symmetric: symmetric.map(SymmetricPart::new),
            skew: SkewPart::new(skew, CANCELLED * largest(skew)),
            moments,
            last_couples,
            skew_sum: 0.0,
            gathered: std::array::from_fn(|_| stage.clone()),
            count: 0,
        }
    }

    /// Adds stages.
    pub(crate) fn add<const K: usize>(&mut self, stages: [BookedStage<'_, D>; K]) {
        add_products(self.last_couples, &mut self.moments, &stages);
        self.skew_sum += self.skew.product(stages);
    }

    /// Adds one stage, together with others of its kind: takes its vectors and leaves others of the same size in their places.
    pub(crate) fn gather(
        &mut self,
        weight: f64,
        velocity: &mut NodalField<D>,
        displacement: &mut NodalField<D>,
    ) {
        if self.count == GATHERED {
            self.add_gathered();
        }
        let stage = &mut self.gathered[self.count];
        stage.weight = weight;
        std::mem::swap(&mut stage.velocity, velocity);
        std::mem::swap(&mut stage.displacement, displacement);
        self.count += 1;
    }

    /// Removes everything since the last [`Forms::take`].
    pub(crate) fn forget(&mut self) {
        self.count = 0;
        self.skew_sum = 0.0;
        self.moments.fill(Four::ZERO);
    }

    /// Integrals over the stages since the last take, which are then removed.
    pub(crate) fn take(&mut self) -> Integrals<N> {
        self.add_gathered();
        let symmetric = self.symmetric.each_ref().map(|part| part.integral(&self.moments, self.last_couples));
        let skew = self.skew_sum;
        self.forget();
        Integrals { symmetric, skew }
    }

    fn add_gathered(&mut self) {
        if self.count == 0 {
            return;
        }
        // A missing stage counts nothing, and the values that a rejected step left in its place may not be finite.
        for stage in &mut self.gathered[self.count..] {
            stage.weight = 0.0;
            stage.velocity.fill_zero();
            stage.displacement.fill_zero();
        }
        let stages = self.gathered.each_ref().map(|s| (s.weight, &s.velocity, &s.displacement));
        add_products(self.last_couples, &mut self.moments, &stages);
        self.skew_sum += self.skew.product(stages);
        self.count = 0;
    }
}

fn add_products<const K: usize, const D: usize>(
    last_couples: bool,
    moments: &mut [Four],
    stages: &[BookedStage<'_, D>; K],
) {
    if last_couples {
        add_products_where_coupled::<K, D, true>(moments, stages);
    } else {
        add_products_where_coupled::<K, D, false>(moments, stages);
    }
}

// Without closures over arrays, which the compiler does not always inline.
fn add_products_where_coupled<const K: usize, const D: usize, const LAST: bool>(
    moments: &mut [Four],
    stages: &[BookedStage<'_, D>; K],
) {
    let zero = Four::splat(0.0);
    for (group, moments) in moments.chunks_exact_mut(Places::<D, LAST>::COUNT).enumerate() {
        let (mut velocities, mut velocities_next) = ([[zero; K]; D], [[zero; K]; D]);
        for (k, (_, velocity, _)) in stages.iter().enumerate() {
            let velocity = velocity.neighbourhood(group);
            for dof in 0..D {
                (velocities[dof][k], velocities_next[dof][k]) = (velocity[1][dof], after(velocity, dof));
            }
        }
        each_dof!(D, i, {
            let mut weighted = [zero; K];
            for (k, (weight, ..)) in stages.iter().enumerate() {
                weighted[k] = velocities[i][k] * Four::splat(*weight);
            }
            for j in 0..D {
                if !can_couple::<D>(i, j, LAST) {
                    continue;
                }
                if j >= i {
                    let own = &mut moments[Places::<D, LAST>::OWN[i][j]];
                    for k in 0..K {
                        *own = weighted[k].mul_add(velocities[j][k], *own);
                    }
                }
                let next = &mut moments[Places::<D, LAST>::NEXT[i][j]];
                for k in 0..K {
                    *next = weighted[k].mul_add(velocities_next[j][k], *next);
                }
            }
        });
    }
}

/// Places of the moments of four nodes, found at compile time: of each degree of freedom in turn the moments with the later ones of the same
/// node, then those with all of the next node. If `LAST` is false, the last degree of freedom counts with the two before it alone.
struct Places<const D: usize, const LAST: bool>;

/// A place that does not exist.
const NOWHERE: usize = usize::MAX;

impl<const D: usize, const LAST: bool> Places<D, LAST> {
    /// With the same node, in either order.
    const OWN: [[usize; D]; D] = Self::all().0;
    /// With the next node.
    const NEXT: [[usize; D]; D] = Self::all().1;
    const COUNT: usize = Self::all().2;

    const fn all() -> ([[usize; D]; D], [[usize; D]; D], usize) {
        let (mut own, mut next, mut count) = ([[NOWHERE; D]; D], [[NOWHERE; D]; D], 0);
        let mut i = 0;
        while i < D {
            let mut j = i;
            while j < D {
                if can_couple::<D>(i, j, LAST) {
                    own[i][j] = count;
                    own[j][i] = count;
                    count += 1;
                }
                j += 1;
            }
            let mut j = 0;
            while j < D {
                if can_couple::<D>(i, j, LAST) {
                    next[i][j] = count;
                    count += 1;
                }
                j += 1;
            }
            i += 1;
        }
        (own, next, count)
    }
}

/// Number of moments of four nodes.
const fn count<const D: usize>(last_couples: bool) -> usize {
    if last_couples { Places::<D, true>::COUNT } else { Places::<D, false>::COUNT }
}

impl<const D: usize> SymmetricPart<D> {
    /// The form of the moments.
    fn integral(&self, moments: &[Four], last_couples: bool) -> f64 {
        if last_couples {
            self.integral_where_coupled::<true>(moments)
        } else {
            self.integral_where_coupled::<false>(moments)
        }
    }

    fn integral_where_coupled<const LAST: bool>(&self, moments: &[Four]) -> f64 {
        let moment = |node: usize, place: usize| {
            moments[node / Four::LANES * Places::<D, LAST>::COUNT + place].lane(node % Four::LANES)
        };
        let mut sum = 0.0;
        for (node, block) in &self.diagonal {
            let own = |i: usize, j: usize| moment(*node, Places::<D, LAST>::OWN[i][j]);
            for i in 0..D {
                sum += block[(i, i)] * own(i, i);
                for j in (i + 1..D).filter(|&j| can_couple::<D>(i, j, LAST)) {
                    sum += 2.0 * block[(i, j)] * own(i, j);
                }
            }
        }
        // Entries above the diagonal are mirrored below.
        for (node, block) in &self.upper {
            for i in 0..D {
                for j in (0..D).filter(|&j| can_couple::<D>(i, j, LAST)) {
                    sum += 2.0 * block[(i, j)] * moment(*node, Places::<D, LAST>::NEXT[i][j]);
                }
            }
        }
        sum
    }

    fn new(m: &BlockTridiagonal<D>) -> Self {
        let part = symmetric_part(m);
        let threshold = CANCELLED * largest(m);
        let present = |blocks: &[Block<D>]| {
            blocks.iter().copied().enumerate().filter(|(_, block)| largest_entry(block) > threshold).collect()
        };
        let above = part.upper.len() - 1;
        Self { diagonal: present(&part.diagonal), upper: present(&part.upper[..above]) }
    }
}

/// `(m + m^T) / 2`.
pub(crate) fn symmetric_part<const D: usize>(m: &BlockTridiagonal<D>) -> BlockTridiagonal<D> {
    BlockTridiagonal::combine(0.5, m, 0.5, &transpose(m), 0.0, m)
}

fn largest<const D: usize>(m: &BlockTridiagonal<D>) -> f64 {
    m.lower.iter().chain(&m.diagonal).chain(&m.upper).map(largest_entry).fold(0.0, f64::max)
}

fn largest_entry<const D: usize>(block: &Block<D>) -> f64 {
    block.columns.as_flattened().iter().fold(0.0_f64, |most, v| most.max(v.abs()))
}

fn transpose<const D: usize>(m: &BlockTridiagonal<D>) -> BlockTridiagonal<D> {
    let n = m.rows();
    let mut t = BlockTridiagonal::zeros(n);
    let flip = |block: &Block<D>| Block::from_fn(|row, column| block[(column, row)]);
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
    use crate::math::linalg::DOFS;

    fn field(nodes: &[[f64; DOFS]]) -> NodalField {
        NodalField::from_nodes(nodes)
    }

    /// `full` of every hundred rows carry blocks, whose last degree of freedom couples with all others or with the two before it.
    fn matrix(rows: usize, full: usize, last_couples: bool) -> BlockTridiagonal {
        let mut m = BlockTridiagonal::zeros(rows);
        for row in (0..rows).filter(|row| row % 100 < full) {
            let block = |shift: usize| {
                Block::from_fn(|i, j| match can_couple::<6>(i, j, last_couples) {
                    true => ((shift + 1) as f64 * (row * 36 + i * 6 + j) as f64).sin(),
                    false => 0.0,
                })
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

    fn product(a: &[[f64; DOFS]], m: &BlockTridiagonal, b: &[[f64; DOFS]]) -> f64 {
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
        for (full, last_couples) in [(0, true), (3, true), (100, true), (100, false)] {
            let (m, other) = (matrix(rows, full, last_couples), matrix(rows, 100, last_couples));
            let mut forms = Forms::new([&m, &other], &m);
            for _ in 0..2 * GATHERED {
                forms.gather(7.0, &mut field(&x), &mut field(&v));
            }
            forms.forget();
            forms.add([(0.5, &field(&v), &field(&x)), (0.25, &field(&v), &field(&x))]);
            for _ in 0..GATHERED + 1 {
                forms.gather(0.4 / (GATHERED + 1) as f64, &mut field(&v2), &mut field(&x2));
            }
            // v^T M v sees the symmetric part alone; (v^T M x - x^T M v) / 2 the skew one.
            let square = |m| 0.75 * product(&v, m, &v) + 0.4 * product(&v2, m, &v2);
            let skew = |v: &[_], x: &[_]| 0.5 * (product(v, &m, x) - product(x, &m, v));
            let integrals = forms.take();
            for (got, wanted) in integrals.symmetric.into_iter().zip([square(&m), square(&other)]) {
                assert!((got - wanted).abs() < tolerance, "{got} against {wanted}");
            }
            let wanted = 0.75 * skew(&v, &x) + 0.4 * skew(&v2, &x2);
            assert!((integrals.skew - wanted).abs() < tolerance, "{} against {wanted}", integrals.skew);
            assert_eq!(
                forms.take(),
                Integrals { symmetric: [0.0; 2], skew: 0.0 },
                "taken stages are forgotten"
            );

            // A rejected step may have left anything.
            let not_finite = vec![[f64::NAN; DOFS]; rows];
            for _ in 0..GATHERED {
                forms.gather(7.0, &mut field(&not_finite), &mut field(&not_finite));
            }
            forms.forget();
            forms.gather(1.0, &mut field(&v), &mut field(&x));
            let wanted = product(&v, &m, &v);
            assert!((forms.take().symmetric[0] - wanted).abs() < tolerance);
        }
    }
}
