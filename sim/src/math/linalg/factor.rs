//! Block elimination from both ends to the middle.

use super::block::Block;
use super::field::NodalField;
use super::singular::SingularBlock;
use super::split::SplitBlock;
use super::tridiagonal::BlockTridiagonal;
use crate::math::dof::DOFS;

/// A factored [`BlockTridiagonal`], ready to solve.
///
/// The elimination is twisted: rows are eliminated from both ends towards the middle one, in two
/// chains that do not wait for each other. There is no pivoting across blocks (inside a block there is), so a
/// regular matrix can still fail; [`Factor::growth`] measures the loss of precision.
#[derive(Debug, Clone)]
pub struct Factor<const D: usize = DOFS> {
    /// Rows eliminated from the top end, in the order of elimination.
    top: Chain<D>,
    /// Rows eliminated from the bottom end, in the order of elimination.
    bottom: Chain<D>,
    middle: Elimination<D>,
    /// `-S^-1 U` of the middle row, S its pivot block.
    middle_from_below: SplitBlock<D>,
    growth: f64,
    has_negative_determinant: bool,
}

/// Rows eliminated one after the other from one end.
#[derive(Debug, Clone)]
struct Chain<const D: usize = DOFS> {
    eliminations: Vec<Elimination<D>>,
    /// `-S^-1` times the coupling to the next row inwards.
    inward: Vec<SplitBlock<D>>,
}

/// Blocks that eliminating a row leaves for the way inwards; S is the row's pivot block.
#[derive(Debug, Clone, Copy)]
struct Elimination<const D: usize = DOFS> {
    /// `S^-1`.
    inverse: SplitBlock<D>,
    /// `-S^-1` times the coupling to the row before.
    outward: SplitBlock<D>,
}

impl<const D: usize> Factor<D> {
    /// Factors a matrix of at least one row.
    ///
    /// # Errors
    /// A pivot block is singular to working precision, or holds values that are not finite; the error names its row.
    pub fn new(matrix: &BlockTridiagonal<D>) -> Result<Self, SingularBlock> {
        let rows = matrix.rows();
        assert!(rows > 0, "a matrix without rows");
        let middle = rows / 2;
        let (mut growth, mut is_negative) = (0.0, false);

        let mut top = Chain::with_capacity(middle);
        let mut from_above = Block::zero();
        for row in 0..middle {
            let mut pivot = matrix.diagonal[row];
            matrix.lower[row].multiply_block_add(&from_above, &mut pivot);
            let inverse = invert(&pivot, row, &matrix.diagonal[row], (&mut growth, &mut is_negative))?;
            from_above = top.push(inverse, &matrix.lower[row], &matrix.upper[row]);
        }

        let mut bottom = Chain::with_capacity(rows - 1 - middle);
        let mut from_below = Block::zero();
        for row in (middle + 1..rows).rev() {
            let mut pivot = matrix.diagonal[row];
            matrix.upper[row].multiply_block_add(&from_below, &mut pivot);
            let inverse = invert(&pivot, row, &matrix.diagonal[row], (&mut growth, &mut is_negative))?;
            from_below = bottom.push(inverse, &matrix.upper[row], &matrix.lower[row]);
        }

        let mut pivot = matrix.diagonal[middle];
        matrix.lower[middle].multiply_block_add(&from_above, &mut pivot);
        matrix.upper[middle].multiply_block_add(&from_below, &mut pivot);
        let inverse = invert(&pivot, middle, &matrix.diagonal[middle], (&mut growth, &mut is_negative))?;
        let negated = inverse.negated();
        Ok(Factor {
            middle: Elimination::new(&inverse, &negated.multiply_block(&matrix.lower[middle])),
            middle_from_below: SplitBlock::new(&negated.multiply_block(&matrix.upper[middle])),
            top,
            bottom,
            growth,
            has_negative_determinant: is_negative,
        })
    }

    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.top.inward.len() + 1 + self.bottom.inward.len()
    }

    /// Largest ratio of an entry of a pivot block to the largest entry of the matrix' own diagonal block in
    /// that row. About one in time stepping; the solution loses that factor of its precision.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// True if the determinant of the matrix is negative.
    pub fn has_negative_determinant(&self) -> bool {
        self.has_negative_determinant
    }

    /// Solves `A x = b`.
    pub fn solve_into(&self, b: &[[f64; D]], x: &mut [[f64; D]]) {
        x.copy_from_slice(b);
        self.solve_in_place(x);
    }

    /// Replaces a right-hand side by the solution.
    pub fn solve_in_place(&self, x: &mut [[f64; D]]) {
        self.solve_with(|_, x| *x, x, |_, value, x| *x = value);
    }

    /// Reads the rows of the right-hand side from `right`, by their numbers, and passes those of the solution to `put`. Both also get
    /// the row's place in `between`, which holds intermediate values from the way inwards for the way outwards.
    #[inline(always)]
    fn solve_with(
        &self,
        right: impl Fn(usize, &[f64; D]) -> [f64; D],
        between: &mut [[f64; D]],
        mut put: impl FnMut(usize, [f64; D], &mut [f64; D]),
    ) {
        let rows = self.rows();
        assert_eq!(between.len(), rows);
        let half = self.top.inward.len();
        let (above, rest) = between.split_at_mut(half);
        let [middle, below @ ..] = rest else { unreachable!("the middle row exists") };

        let mut from_top = [0.0; D];
        let mut from_bottom = [0.0; D];
        let mut bottom_rows = self.bottom.eliminations.iter().zip(below.iter_mut().rev());
        for (row, (elimination, x)) in self.top.eliminations.iter().zip(above.iter_mut()).enumerate() {
            from_top = elimination.apply(&right(row, x), &from_top);
            *x = from_top;
            if let Some((elimination, x)) = bottom_rows.next() {
                from_bottom = elimination.apply(&right(rows - 1 - row, x), &from_bottom);
                *x = from_bottom;
            }
        }

        let centre = self.middle.apply(&right(half, middle), &from_top);
        let centre = self.middle_from_below.multiply_add(&from_bottom, &centre);
        put(half, centre, middle);

        let mut to_top = centre;
        let mut to_bottom = centre;
        let mut bottom_rows = self.bottom.inward.iter().rev().zip(below.iter_mut());
        let top_rows = self.top.inward.iter().rev().zip(above.iter_mut().rev());
        for (distance, (inward, x)) in (1..).zip(top_rows) {
            to_top = inward.multiply_add(&to_top, x);
            put(half - distance, to_top, x);
            if let Some((inward, x)) = bottom_rows.next() {
                to_bottom = inward.multiply_add(&to_bottom, x);
                put(half + distance, to_bottom, x);
            }
        }
    }
}

impl<const D: usize> Factor<D> {
    /// Solves `A x = b`; `between` is scratch of as many rows.
    ///
    /// # Panics
    /// An argument has another number of rows than the matrix.
    pub fn solve_field(&self, b: &NodalField<D>, between: &mut [[f64; D]], x: &mut NodalField<D>) {
        assert!([b.nodes(), x.nodes()] == [self.rows(); 2]);
        self.solve_with(|row, _| b.node(row), between, |row, value, _| x.set_node(row, value));
    }
}

impl<const D: usize> Chain<D> {
    fn with_capacity(rows: usize) -> Self {
        Chain { eliminations: Vec::with_capacity(rows), inward: Vec::with_capacity(rows) }
    }

    /// Adds a row and returns its inward block.
    fn push(&mut self, inverse: Block<D>, outward: &Block<D>, inward: &Block<D>) -> Block<D> {
        let negated = inverse.negated();
        let inward = negated.multiply_block(inward);
        self.eliminations.push(Elimination::new(&inverse, &negated.multiply_block(outward)));
        self.inward.push(SplitBlock::new(&inward));
        inward
    }
}

impl<const D: usize> Elimination<D> {
    fn new(inverse: &Block<D>, outward: &Block<D>) -> Self {
        Self { inverse: SplitBlock::new(inverse), outward: SplitBlock::new(outward) }
    }

    /// `S^-1 b - S^-1 (coupling) previous`.
    #[inline(always)]
    fn apply(&self, b: &[f64; D], previous: &[f64; D]) -> [f64; D] {
        self.inverse.sum_of_products(b, &self.outward, previous)
    }
}

/// The inverse of a pivot block; counts its growth over the matrix' own block, and negative determinants modulo two.
fn invert<const D: usize>(
    pivot: &Block<D>,
    row: usize,
    original: &Block<D>,
    (growth, is_negative): (&mut f64, &mut bool),
) -> Result<Block<D>, SingularBlock> {
    let largest = pivot.largest();
    let (inverse, smallest_pivot, has_negative_determinant) = pivot.inverse();
    let regular = smallest_pivot > largest * (D as f64 * f64::EPSILON) && inverse.is_finite();
    if !regular {
        return Err(SingularBlock { row });
    }
    *growth = growth.max(largest / original.largest());
    *is_negative ^= has_negative_determinant;
    Ok(inverse)
}
