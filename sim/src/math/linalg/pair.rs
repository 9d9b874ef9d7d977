//! Two matrices whose products with two vectors are computed together.

use std::marker::PhantomData;

use super::block::Block;
use super::field::{Neighbourhood, NodalField, after, before};
use super::four::Four;
use super::lane::Lane;
use super::tridiagonal::{BlockTridiagonal, can_couple};
use crate::math::dof::{BENDING_ROTATIONS, DOFS};

const LANES: usize = Four::LANES;

/// Two block-tridiagonal matrices A and B of the same size, copied so that the entries of four neighbouring rows lie side by side
/// and both pass through the processor in one stream: reading them is the cost of a product. Therefore only half of a [`Symmetric`] A is
/// kept, and in both the coupling of the twist with the displacements is omitted if it is zero everywhere.
#[derive(Debug, Clone)]
pub struct MatrixPair<A, const D: usize = DOFS> {
    rows: usize,
    /// Entries by groups of four rows: first those of A, then those of B.
    entries: Vec<Four>,
    /// True if the last degree of freedom couples with all others, false if with the two before it alone.
    last_couples: bool,
    kind: PhantomData<A>,
}

/// Storage of a matrix, four block rows at a time, with its product.
pub trait Storage<const D: usize> {
    /// Contribution of the rows before to these.
    type Carried: Copy;

    /// Contribution carried into the first rows.
    const NOTHING: Self::Carried;

    /// Number of entries of four block rows.
    fn count(last_couples: bool) -> usize;

    /// Adds the entries of the rows from `first` on, zeros beyond the last one.
    fn store(matrix: &BlockTridiagonal<D>, first: usize, last_couples: bool, entries: &mut Vec<Four>);

    /// Product of the entries with x.
    fn product<const LAST: bool>(
        entries: &[Four],
        x: Neighbourhood<'_, D>,
        carried: &mut Self::Carried,
    ) -> [Four; D];
}

impl<A: Storage<D>, const D: usize> MatrixPair<A, D> {
    /// Copies two matrices.
    ///
    /// # Panics
    /// The matrices differ in size.
    pub fn new(a: &BlockTridiagonal<D>, b: &BlockTridiagonal<D>) -> Self {
        assert_eq!(a.rows(), b.rows());
        let last_couples = [a, b].into_iter().any(BlockTridiagonal::last_couples);
        let mut entries = Vec::new();
        for first in (0..a.rows()).step_by(LANES) {
            A::store(a, first, last_couples, &mut entries);
            General::store(b, first, last_couples, &mut entries);
        }
        Self { rows: a.rows(), entries, last_couples, kind: PhantomData }
    }

    /// Bytes that a product reads of the matrices.
    pub fn size(&self) -> usize {
        size_of_val(&*self.entries)
    }

    /// `out = whole - (A x + B y)`.
    ///
    /// # Panics
    /// A vector has another number of rows than the matrices.
    pub fn subtract_products(
        &self,
        whole: &NodalField<D>,
        x: &NodalField<D>,
        y: &NodalField<D>,
        out: &mut NodalField<D>,
    ) {
        assert!([whole.nodes(), x.nodes(), y.nodes(), out.nodes()] == [self.rows; 4]);
        if self.last_couples {
            self.subtract::<true>(whole, x, y, out);
        } else {
            self.subtract::<false>(whole, x, y, out);
        }
    }

    fn subtract<const LAST: bool>(
        &self,
        whole: &NodalField<D>,
        x: &NodalField<D>,
        y: &NodalField<D>,
        out: &mut NodalField<D>,
    ) {
        let (of_a, of_b) = (A::count(LAST), <General as Storage<D>>::count(LAST));
        let vectors = x.neighbourhoods().zip(y.neighbourhoods());
        let groups =
            self.entries.chunks_exact(of_a + of_b).zip(vectors).zip(whole.groups()).zip(out.groups_mut());
        let mut carried = A::NOTHING;
        for (((entries, (x, y)), whole), out) in groups {
            let (a, b) = entries.split_at(of_a);
            // Two sums that do not wait for each other.
            let a = A::product::<LAST>(a, x, &mut carried);
            let b = General::product::<LAST>(b, y, &mut ());
            for dof in 0..D {
                out[dof] = whole[dof] - (a[dof] + b[dof]);
            }
        }
    }
}

/// Any matrix, by columns: the blocks below, on and above the diagonal of a column.
#[derive(Debug, Clone, Copy)]
pub struct General;

impl<const D: usize> Storage<D> for General {
    type Carried = ();
    const NOTHING: () = ();

    fn count(last_couples: bool) -> usize {
        3 * block_count::<D>(last_couples)
    }

    fn store(matrix: &BlockTridiagonal<D>, first: usize, last_couples: bool, entries: &mut Vec<Four>) {
        for column in 0..D {
            for (blocks, rows) in matrix.blocks() {
                for row in (0..D).filter(|&row| can_couple::<D>(row, column, last_couples)) {
                    entries.push(side_by_side(&blocks[..rows.end], rows.start, first, (row, column)));
                }
            }
        }
    }

    #[inline(always)]
    fn product<const LAST: bool>(entries: &[Four], x: Neighbourhood<'_, D>, (): &mut ()) -> [Four; D] {
        assert!(entries.len() == <Self as Storage<D>>::count(LAST));
        let mut sums = [Four::ZERO; D];
        let mut next = 0;
        each_dof!(D, column, {
            for x in [before(x, column), x[1][column], after(x, column)] {
                for (row, sum) in sums.iter_mut().enumerate() {
                    if can_couple::<D>(row, column, LAST) {
                        *sum = entries[next].mul_add(x, *sum);
                        next += 1;
                    }
                }
            }
        });
        sums
    }
}

/// A symmetric matrix, by columns: the blocks on and above the diagonal of a column; those below it are not read.
#[derive(Debug, Clone, Copy)]
pub struct Symmetric;

impl<const D: usize> Storage<D> for Symmetric {
    /// The products of the transposed blocks above the diagonal with the nodes of the rows before, which are added to the next rows.
    type Carried = [Four; D];
    const NOTHING: [Four; D] = [Four::ZERO; D];

    fn count(last_couples: bool) -> usize {
        2 * block_count::<D>(last_couples)
    }

    fn store(matrix: &BlockTridiagonal<D>, first: usize, last_couples: bool, entries: &mut Vec<Four>) {
        for column in 0..D {
            for (blocks, rows) in matrix.blocks().into_iter().skip(1) {
                for row in (0..D).filter(|&row| can_couple::<D>(row, column, last_couples)) {
                    entries.push(side_by_side(&blocks[..rows.end], rows.start, first, (row, column)));
                }
            }
        }
    }

    #[inline(always)]
    fn product<const LAST: bool>(
        entries: &[Four],
        x: Neighbourhood<'_, D>,
        carried: &mut [Four; D],
    ) -> [Four; D] {
        assert!(entries.len() == <Self as Storage<D>>::count(LAST));
        let own = &x[1];
        let (mut sums, mut onwards) = ([Four::ZERO; D], [Four::ZERO; D]);
        let mut next = 0;
        each_dof!(D, column, {
            for (row, sum) in sums.iter_mut().enumerate() {
                if can_couple::<D>(row, column, LAST) {
                    *sum = entries[next].mul_add(own[column], *sum);
                    next += 1;
                }
            }
            let after = after(x, column);
            for (row, sum) in sums.iter_mut().enumerate() {
                if can_couple::<D>(row, column, LAST) {
                    *sum = entries[next].mul_add(after, *sum);
                    onwards[column] = entries[next].mul_add(own[row], onwards[column]);
                    next += 1;
                }
            }
        });
        let from_before = [*carried, onwards, onwards];
        *carried = onwards;
        for (dof, sum) in sums.iter_mut().enumerate() {
            *sum = *sum + before(&from_before, dof);
        }
        sums
    }
}

/// Entries of a block that are kept.
#[inline(always)]
const fn block_count<const D: usize>(last_couples: bool) -> usize {
    if last_couples { D * D } else { D * D - 2 * (D - 1 - BENDING_ROTATIONS) }
}

/// One entry of four blocks from `first` on; zeros without a block.
fn side_by_side<const D: usize>(
    blocks: &[Block<D>],
    start: usize,
    first: usize,
    place: (usize, usize),
) -> Four {
    let entry =
        |row: usize| if row < start { 0.0 } else { blocks.get(row).map_or(0.0, |block| block[place]) };
    Four::new(std::array::from_fn(|lane| entry(first + lane)))
}
