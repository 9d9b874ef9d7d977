//! The skew part of a block-tridiagonal matrix.

use super::block::{Block, DOFS};
use super::field::{Neighbourhood, NodalField, after};
use super::four::Four;
use super::lane::Lane;
use super::tridiagonal::BlockTridiagonal;

const LANES: usize = Four::LANES;

/// `(m - m^T) / 2`, four rows side by side, where there is any.
#[derive(Debug, Clone)]
pub struct SkewPart<const D: usize = DOFS> {
    groups: Vec<Rows<D>>,
    /// Whether the last degree of freedom takes part: a follower torque does not couple the twist with anything.
    last_couples: bool,
}

/// Blocks of a group of four rows, row by row: on the diagonal (only what is right of it counts) and above it; below stand minus
/// the transposed ones.
#[derive(Debug, Clone)]
struct Rows<const D: usize> {
    group: usize,
    own: [[Four; D]; D],
    next: [[Four; D]; D],
}

/// A weight, and the vectors to its left and right.
pub type WeightedPair<'a, const D: usize> = (f64, &'a NodalField<D>, &'a NodalField<D>);

impl<const D: usize> SkewPart<D> {
    /// That of `m`, without entries up to `threshold`: rounding of terms that cancel.
    pub fn new(m: &BlockTridiagonal<f64, D>, threshold: f64) -> Self {
        let rows = m.rows();
        let half_difference = |a: &Block<f64, D>, b: &Block<f64, D>, i: usize, j: usize| {
            let half = 0.5 * (a[(i, j)] - b[(j, i)]);
            if half.abs() > threshold { half } else { 0.0 }
        };
        let own = |row: usize, i: usize, j: usize| {
            if row < rows { half_difference(&m.diagonal[row], &m.diagonal[row], i, j) } else { 0.0 }
        };
        let next = |row: usize, i: usize, j: usize| {
            if row + 1 < rows { half_difference(&m.upper[row], &m.lower[row + 1], i, j) } else { 0.0 }
        };
        let side_by_side = |first: usize, entry: &dyn Fn(usize, usize, usize) -> f64| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| Four::new(std::array::from_fn(|lane| entry(first + lane, i, j))))
            })
        };
        let groups = (0..rows).step_by(LANES).map(|first| Rows {
            group: first / LANES,
            own: side_by_side(first, &own),
            next: side_by_side(first, &next),
        });
        let groups: Vec<_> = groups.filter(|rows: &Rows<D>| rows.couples(0)).collect();
        Self { last_couples: groups.iter().any(|rows| rows.couples(D - 1)), groups }
    }

    /// `sum_k weight_k v_k^T A x_k`, the matrix read once for all of them.
    ///
    /// # Panics
    /// When a vector has fewer rows than the matrix.
    pub fn product<const K: usize>(&self, pairs: [WeightedPair<'_, D>; K]) -> f64 {
        let sums =
            if self.last_couples { self.sums::<K, true>(&pairs) } else { self.sums::<K, false>(&pairs) };
        let mut total = 0.0;
        for ((weight, ..), sum) in pairs.iter().zip(sums) {
            total += weight * sum.sum();
        }
        total
    }

    fn sums<const K: usize, const LAST: bool>(&self, pairs: &[WeightedPair<'_, D>; K]) -> [Four; K] {
        let mut sums = [Four::ZERO; K];
        for rows in &self.groups {
            for (sum, (_, v, x)) in sums.iter_mut().zip(pairs) {
                let (v, x) = (v.neighbourhood(rows.group), x.neighbourhood(rows.group));
                *sum = *sum + rows.product::<LAST>(v, x);
            }
        }
        sums
    }
}

impl<const D: usize> Rows<D> {
    /// Whether any entry of a degree of freedom from `first` on is not zero.
    fn couples(&self, first: usize) -> bool {
        let present = |block: &[[Four; D]; D], i: usize, j: usize| block[i][j].to_array() != [0.0; LANES];
        (0..D).any(|i| {
            (0..D).any(|j| i.max(j) >= first && (present(&self.own, i, j) || present(&self.next, i, j)))
        })
    }

    /// `v^T A x` of these rows: `sum_ij a_ij (v_i x_j - x_i v_j)` over the entries above the diagonal, those of the last degree of
    /// freedom only if it couples.
    #[inline(always)]
    fn product<const LAST: bool>(&self, v: Neighbourhood<'_, D>, x: Neighbourhood<'_, D>) -> Four {
        let count = if LAST { D } else { D - 1 };
        let (mut v_next, mut x_next) = ([Four::ZERO; D], [Four::ZERO; D]);
        for dof in 0..count {
            (v_next[dof], x_next[dof]) = (after(v, dof), after(x, dof));
        }
        let ([_, v, _], [_, x, _]) = (v, x);
        let (mut gained, mut lost) = (Four::ZERO, Four::ZERO);
        for i in 0..count {
            let (mut of_x, mut of_v) = (Four::ZERO, Four::ZERO);
            for j in 0..count {
                of_x = self.next[i][j].mul_add(x_next[j], of_x);
                of_v = self.next[i][j].mul_add(v_next[j], of_v);
            }
            gained = v[i].mul_add(of_x, gained);
            lost = x[i].mul_add(of_v, lost);
        }
        for i in 0..count {
            let (mut of_x, mut of_v) = (Four::ZERO, Four::ZERO);
            for j in i + 1..count {
                of_x = self.own[i][j].mul_add(x[j], of_x);
                of_v = self.own[i][j].mul_add(v[j], of_v);
            }
            gained = v[i].mul_add(of_x, gained);
            lost = x[i].mul_add(of_v, lost);
        }
        gained - lost
    }
}
