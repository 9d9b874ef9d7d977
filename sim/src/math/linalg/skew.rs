//! The skew part of a block-tridiagonal matrix.

use super::block::Block;
use super::field::{Neighbourhood, NodalField, after};
use super::four::Four;
use super::lane::Lane;
use super::tridiagonal::BlockTridiagonal;
use crate::math::dof::{BENDING_ROTATIONS, DOFS};

const LANES: usize = Four::LANES;

/// `(m - m^T) / 2`, four rows side by side; only groups with entries are kept.
#[derive(Debug, Clone)]
pub struct SkewPart<const D: usize = DOFS> {
    groups: Vec<Rows>,
    /// Entries by groups, row by row: those of the blocks above the diagonal, then those right of the diagonal of the blocks
    /// on it. The entries below are minus the transposed.
    entries: Vec<Four>,
    /// True if the last degree of freedom takes part: a follower torque does not couple the twist with anything.
    last_couples: bool,
}

/// A group of four rows.
#[derive(Debug, Clone)]
struct Rows {
    group: usize,
    /// True if displacements couple with rotations, and rotations with each other at the same node, but nothing else: a torque acts
    /// on bending.
    only_bending: bool,
}

/// A weight, and the vectors to its left and right.
pub type WeightedPair<'a, const D: usize> = (f64, &'a NodalField<D>, &'a NodalField<D>);

impl<const D: usize> SkewPart<D> {
    /// Skew part of `m`, without entries up to `threshold`: rounding of terms that cancel.
    pub fn new(m: &BlockTridiagonal<D>, threshold: f64) -> Self {
        let rows = m.rows();
        let half_difference = |a: &Block<D>, b: &Block<D>, i: usize, j: usize| {
            let half = 0.5 * (a[(i, j)] - b[(j, i)]);
            if half.abs() > threshold { half } else { 0.0 }
        };
        let entry = |same_node: bool, row: usize, i: usize, j: usize| match same_node {
            true if row < rows => half_difference(&m.diagonal[row], &m.diagonal[row], i, j),
            false if row + 1 < rows => half_difference(&m.upper[row], &m.lower[row + 1], i, j),
            _ => 0.0,
        };
        let side_by_side = |group: usize, same_node: bool, i: usize, j: usize| {
            Four::new(std::array::from_fn(|lane| entry(same_node, LANES * group + lane, i, j)))
        };
        let is_present = |group: usize, chosen: &dyn Fn(bool, usize, usize) -> bool| {
            coupled_entries::<D>(true, false).any(|(same_node, i, j)| {
                chosen(same_node, i, j) && side_by_side(group, same_node, i, j).to_array() != [0.0; LANES]
            })
        };
        let present: Vec<_> =
            (0..rows.div_ceil(LANES)).filter(|&group| is_present(group, &|_, _, _| true)).collect();
        let last_couples = present.iter().any(|&group| is_present(group, &|_, i, j| i.max(j) == D - 1));
        let mut part = Self { groups: Vec::new(), entries: Vec::new(), last_couples };
        for group in present {
            let only_bending =
                !is_present(group, &|same_node, i, j| !is_kept::<D>(same_node, i, j, last_couples, true));
            let kept = coupled_entries::<D>(last_couples, only_bending);
            part.entries.extend(kept.map(|(same_node, i, j)| side_by_side(group, same_node, i, j)));
            part.groups.push(Rows { group, only_bending });
        }
        part
    }

    /// `sum_k weight_k v_k^T A x_k`, the matrix read once for all of them.
    ///
    /// # Panics
    /// A vector has fewer rows than the matrix.
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
        let mut rest = &self.entries[..];
        for rows in &self.groups {
            let entries;
            if rows.only_bending {
                (entries, rest) = rest.split_at(const { count::<D>(LAST, true) });
                add_products::<K, D, LAST, true>(rows.group, entries, pairs, &mut sums);
            } else {
                (entries, rest) = rest.split_at(const { count::<D>(LAST, false) });
                add_products::<K, D, LAST, false>(rows.group, entries, pairs, &mut sums);
            }
        }
        sums
    }
}

#[inline(always)]
fn add_products<const K: usize, const D: usize, const LAST: bool, const BENDING: bool>(
    group: usize,
    entries: &[Four],
    pairs: &[WeightedPair<'_, D>; K],
    sums: &mut [Four; K],
) {
    for (sum, (_, v, x)) in sums.iter_mut().zip(pairs) {
        let (v, x) = (v.neighbourhood(group), x.neighbourhood(group));
        *sum = *sum + product::<D, LAST, BENDING>(entries, v, x);
    }
}

/// `v^T A x` of four rows: `sum_ij a_ij (v_i x_j - x_i v_j)` over the entries above the diagonal, those of the last degree of
/// freedom only if it couples.
#[inline(always)]
fn product<const D: usize, const LAST: bool, const BENDING: bool>(
    entries: &[Four],
    v: Neighbourhood<'_, D>,
    x: Neighbourhood<'_, D>,
) -> Four {
    assert!(entries.len() == const { count::<D>(LAST, BENDING) });
    let (mut v_next, mut x_next) = ([Four::ZERO; D], [Four::ZERO; D]);
    for dof in 0..D {
        (v_next[dof], x_next[dof]) = (after(v, dof), after(x, dof));
    }
    let (next, own) = entries.split_at(const { count_in_block::<D>(false, LAST, BENDING) });
    let mut sums = [Four::ZERO; 2];
    add_block::<D, LAST, BENDING, false>(next, [v[1], x[1]], [v_next, x_next], &mut sums);
    add_block::<D, LAST, BENDING, true>(own, [v[1], x[1]], [v[1], x[1]], &mut sums);
    let [gained, lost] = sums;
    gained - lost
}

/// Adds the contributions of the blocks of the same nodes or of the next ones: to the left `v` and `x` of the nodes, to the right those of
/// the nodes coupled with them.
#[inline(always)]
fn add_block<const D: usize, const LAST: bool, const BENDING: bool, const SAME: bool>(
    entries: &[Four],
    [v, x]: [[Four; D]; 2],
    [v_coupled, x_coupled]: [[Four; D]; 2],
    [gained, lost]: &mut [Four; 2],
) {
    let mut place = 0;
    each_dof!(if LAST { D } else { D - 1 }, i, {
        let (mut of_x, mut of_v) = (Four::ZERO, Four::ZERO);
        for j in 0..D {
            if is_kept::<D>(SAME, i, j, LAST, BENDING) {
                of_x = entries[place].mul_add(x_coupled[j], of_x);
                of_v = entries[place].mul_add(v_coupled[j], of_v);
                place += 1;
            }
        }
        *gained = v[i].mul_add(of_x, *gained);
        *lost = x[i].mul_add(of_v, *lost);
    });
}

/// Places of the entries that are kept, in their order: of the same node or the next one, row and column.
fn coupled_entries<const D: usize>(
    last_couples: bool,
    only_bending: bool,
) -> impl Iterator<Item = (bool, usize, usize)> {
    let all = [false, true]
        .into_iter()
        .flat_map(|same_node| (0..D).flat_map(move |i| (0..D).map(move |j| (same_node, i, j))));
    all.filter(move |&(same_node, i, j)| is_kept::<D>(same_node, i, j, last_couples, only_bending))
}

/// Number of entries of four rows.
const fn count<const D: usize>(last_couples: bool, only_bending: bool) -> usize {
    count_in_block::<D>(false, last_couples, only_bending)
        + count_in_block::<D>(true, last_couples, only_bending)
}

/// Number of entries of the same node, or of the next one.
const fn count_in_block<const D: usize>(same_node: bool, last_couples: bool, only_bending: bool) -> usize {
    let (mut count, mut place) = (0, 0);
    while place < D * D {
        count += is_kept::<D>(same_node, place / D, place % D, last_couples, only_bending) as usize;
        place += 1;
    }
    count
}

/// True if an entry, of the same node or of the next one, is kept. It lies right of the diagonal. An entry of the last degree of freedom is kept
/// only if that couples; if only bending couples, an entry is kept between a displacement and a rotation, or between two rotations of a node.
#[inline(always)]
const fn is_kept<const D: usize>(
    same_node: bool,
    i: usize,
    j: usize,
    last_couples: bool,
    only_bending: bool,
) -> bool {
    if (same_node && j <= i) || (!last_couples && (i + 1 == D || j + 1 == D)) {
        return false;
    }
    // The last degree of freedom is the twist, or the second rotation of a string that does not twist.
    let displacements = D - BENDING_ROTATIONS - !last_couples as usize;
    let (of_i, of_j) = (i < displacements, j < displacements);
    !only_bending || of_i != of_j || (same_node && !of_i)
}
