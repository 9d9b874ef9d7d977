use nalgebra::{DMatrix, DVector};

use super::*;

/// Values in [-1, 1) that look random, the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn block(&mut self, diagonal: f64) -> Block {
        Block::from_fn(|row, column| self.next() + if row == column { diagonal } else { 0.0 })
    }

    /// Nonsymmetric; block diagonally dominant from a `diagonal` of about 20.
    fn matrix(&mut self, rows: usize, diagonal: f64) -> BlockTridiagonal {
        let mut matrix = BlockTridiagonal::zeros(rows);
        for row in 0..rows {
            matrix.add_block(row, row, &self.block(diagonal));
            if row > 0 {
                matrix.add_block(row, row - 1, &self.block(0.0));
                matrix.add_block(row - 1, row, &self.block(0.0));
            }
        }
        matrix
    }

    fn vector(&mut self, rows: usize) -> BlockVector {
        (0..rows).map(|_| std::array::from_fn(|_| self.next())).collect()
    }
}

const ROW_COUNTS: [usize; 8] = [1, 2, 3, 4, 5, 17, 18, 64];

fn dense(matrix: &BlockTridiagonal) -> DMatrix<f64> {
    let rows = matrix.rows();
    DMatrix::from_fn(DOFS * rows, DOFS * rows, |i, j| {
        let place = (i % DOFS, j % DOFS);
        match (i / DOFS, j / DOFS) {
            (row, column) if row == column => matrix.diagonal[row][place],
            (row, column) if row == column + 1 => matrix.lower[row][place],
            (row, column) if row + 1 == column => matrix.upper[row][place],
            _ => 0.0,
        }
    })
}

fn flat(vector: &[[f64; DOFS]]) -> DVector<f64> {
    DVector::from_row_slice(vector.as_flattened())
}

fn relative_difference(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    (a - b).amax() / b.amax()
}

#[test]
fn products_equal_dense_products() {
    let mut numbers = Numbers(1);
    for rows in ROW_COUNTS {
        let (a, x) = (numbers.matrix(rows, 2.0), numbers.vector(rows));
        let dense_ax = dense(&a) * flat(&x);

        let mut out = numbers.vector(rows);
        a.multiply_into(&x, &mut out);
        assert!(relative_difference(&flat(&out), &dense_ax) < 1e-14, "{rows} rows");

        a.multiply_add(&x, &mut out);
        assert!(relative_difference(&flat(&out), &(&dense_ax * 2.0)) < 1e-14, "{rows} rows");
    }
}

/// Two products in one, of matrices that couple the last degree of freedom with all others and of matrices that do not.
#[test]
fn products_of_pairs_equal_dense_products() {
    let mut numbers = Numbers(3);
    for rows in ROW_COUNTS {
        for last_couples in [true, false] {
            let mut matrix = || {
                let mut matrix = numbers.matrix(rows, 2.0);
                let BlockTridiagonal { lower, diagonal, upper } = &mut matrix;
                for block in lower.iter_mut().chain(diagonal).chain(upper).filter(|_| !last_couples) {
                    for displacement in 0..3 {
                        block[(displacement, 5)] = 0.0;
                        block[(5, displacement)] = 0.0;
                    }
                }
                matrix
            };
            let (a, b) = (matrix(), matrix());
            let a = BlockTridiagonal::combine(0.5, &a, 0.5, &transposed(&a), 0.0, &a);
            let (x, y, whole) = (numbers.vector(rows), numbers.vector(rows), numbers.vector(rows));
            let expected = flat(&whole) - dense(&a) * flat(&x) - dense(&b) * flat(&y);
            let [x, y, whole] = [x, y, whole].map(|vector| NodalField::from_nodes(&vector));
            let mut out = NodalField::zeros(rows);
            MatrixPair::<Symmetric>::new(&a, &b).subtract_products(&whole, &x, &y, &mut out);
            assert!(relative_difference(&flat(&out.to_nodes()), &expected) < 1e-14, "symmetric, {rows} rows");
            MatrixPair::<General>::new(&a, &b).subtract_products(&whole, &x, &y, &mut out);
            assert!(relative_difference(&flat(&out.to_nodes()), &expected) < 1e-14, "general, {rows} rows");
        }
    }
}

#[test]
fn forms_of_the_skew_part_equal_dense_ones() {
    let mut numbers = Numbers(9);
    // Couplings: all, all but the twist, or displacements with rotations at all nodes but the fifth and sixth.
    let zero_at: [fn(usize, usize, usize) -> bool; 3] = [
        |_, _, _| false,
        |_, i, j| i.max(j) == 5,
        |row, i, j| i.max(j) == 5 || (!(4..6).contains(&row) && (i < 3) == (j < 3)),
    ];
    for rows in ROW_COUNTS {
        for zero_at in zero_at {
            let mut matrix = numbers.matrix(rows, 2.0);
            let BlockTridiagonal { lower, diagonal, upper } = &mut matrix;
            for blocks in [lower, diagonal, upper] {
                for (row, block) in blocks.iter_mut().enumerate() {
                    for (i, j) in (0..36).map(|place| (place / 6, place % 6)) {
                        if zero_at(row, i, j) {
                            block[(i, j)] = 0.0;
                        }
                    }
                }
            }
            let pairs = [(); 3].map(|()| (numbers.next(), numbers.vector(rows), numbers.vector(rows)));
            let skew = (dense(&matrix) - dense(&matrix).transpose()) * 0.5;
            let form = |(weight, v, x): &(f64, BlockVector, BlockVector)| {
                weight * (flat(v).transpose() * &skew * flat(x))[(0, 0)]
            };
            let expected = pairs.iter().map(form).sum::<f64>();
            let fields =
                pairs.map(|(weight, v, x)| (weight, NodalField::from_nodes(&v), NodalField::from_nodes(&x)));
            let got =
                SkewPart::new(&matrix, 0.0).product(fields.each_ref().map(|(weight, v, x)| (*weight, v, x)));
            // Rounding of 108 products of values up to one in each row.
            assert!((got - expected).abs() < 1e-14 * rows as f64, "{rows} rows: {got} against {expected}");
        }
    }
}

#[test]
fn small_skew_entries_are_left_out() {
    let mut matrix = BlockTridiagonal::zeros(2);
    matrix.diagonal[0][(0, 1)] = 2e-3;
    matrix.upper[0][(2, 3)] = 2.0;
    let unit = |node: usize, dof: usize| {
        let mut field = NodalField::<DOFS>::zeros(2);
        field[(node, dof)] = 1.0;
        field
    };
    let skew = SkewPart::new(&matrix, 1e-3);
    assert_eq!(skew.product([(1.0, &unit(0, 0), &unit(0, 1))]), 0.0);
    assert_eq!(skew.product([(1.0, &unit(0, 2), &unit(1, 3))]), 1.0);
    assert_eq!(skew.product([(3.0, &unit(1, 3), &unit(0, 2))]), -3.0);
}

#[test]
fn a_field_holds_the_values_of_its_nodes() {
    let mut numbers = Numbers(11);
    for rows in ROW_COUNTS {
        let nodes = numbers.vector(rows);
        let mut field = NodalField::from_nodes(&nodes);
        assert_eq!(field.to_nodes(), nodes);
        for (node, values) in nodes.iter().enumerate() {
            assert_eq!(field.node(node), *values);
            // The neighbour after every node, zeros after the last one.
            let group = field.neighbourhood(node / 4);
            for dof in 0..DOFS {
                let next = nodes.get(node + 1).map_or(0.0, |next| next[dof]);
                assert_eq!(after(group, dof).lane(node % 4), next);
            }
        }
        field[(rows - 1, 2)] = f64::INFINITY;
        assert!(NodalField::from_nodes(&nodes).is_finite() && !field.is_finite());
        // Of five and of four degrees of freedom likewise.
        let five: Vec<[f64; 5]> = nodes.iter().map(|[a, b, c, d, e, _]| [*a, *b, *c, *d, *e]).collect();
        let four: Vec<[f64; 4]> = nodes.iter().map(|[a, b, c, d, ..]| [*a, *b, *c, *d]).collect();
        assert_eq!(NodalField::from_nodes(&five).to_nodes(), five);
        assert_eq!(NodalField::from_nodes(&four).to_nodes(), four);
    }
}

fn transposed(matrix: &BlockTridiagonal) -> BlockTridiagonal {
    let transposed = |block: &Block| Block::from_fn(|row, column| block[(column, row)]);
    let rows = matrix.rows();
    let mut out = BlockTridiagonal::zeros(rows);
    for row in 0..rows {
        out.diagonal[row] = transposed(&matrix.diagonal[row]);
        if row > 0 {
            out.lower[row] = transposed(&matrix.upper[row - 1]);
            out.upper[row - 1] = transposed(&matrix.lower[row]);
        }
    }
    out
}

#[test]
fn combination_equals_the_dense_one() {
    let mut numbers = Numbers(2);
    let (a, b, c) = (numbers.matrix(5, 2.0), numbers.matrix(5, 1.0), numbers.matrix(5, 0.0));
    let combined = dense(&BlockTridiagonal::combine(0.5, &a, -3.0, &b, 7.0, &c));
    let expected = dense(&a) * 0.5 - dense(&b) * 3.0 + dense(&c) * 7.0;
    assert!((combined - &expected).amax() < 1e-15 * expected.amax() * 4.0);
}

#[test]
fn solutions_equal_dense_solutions() {
    let mut numbers = Numbers(3);
    for rows in ROW_COUNTS {
        let matrix = numbers.matrix(rows, 20.0);
        let b = numbers.vector(rows);
        let factor = Factor::new(&matrix).expect("diagonally dominant");
        assert_eq!(factor.rows(), rows);

        let mut x = numbers.vector(rows);
        factor.solve_into(&b, &mut x);
        let expected = dense(&matrix).lu().solve(&flat(&b)).expect("diagonally dominant");
        assert!(relative_difference(&flat(&x), &expected) < 1e-13, "{rows} rows");
        assert!(relative_difference(&(dense(&matrix) * flat(&x)), &flat(&b)) < 1e-13, "{rows} rows");

        let mut in_place = b.clone();
        factor.solve_in_place(&mut in_place);
        assert_eq!(in_place, x);
        assert_eq!(field_solution(&factor, &b), x);
    }
}

fn field_solution<const D: usize>(factor: &Factor<D>, b: &[[f64; D]]) -> BlockVector<D> {
    let mut x = NodalField::zeros(b.len());
    factor.solve_field(&NodalField::from_nodes(b), &mut vec![[0.0; D]; b.len()], &mut x);
    x.to_nodes()
}

#[test]
fn blocks_of_an_inverse_equal_the_dense_ones() {
    let mut numbers = Numbers(17);
    for rows in ROW_COUNTS {
        let matrix = numbers.matrix(rows, 20.0);
        let blocks = matrix.inverse_bands().expect("diagonally dominant");
        let inverse = dense(&matrix).try_inverse().expect("diagonally dominant");
        assert_eq!([blocks.diagonal.len(), blocks.upper.len()], [rows; 2]);
        let places = (0..rows).flat_map(|row| [(row, row), (row, row + 1)]);
        for (row, column) in places.filter(|&(_, column)| column < rows) {
            let block = if row == column { &blocks.diagonal[row] } else { &blocks.upper[row] };
            for i in 0..DOFS {
                for j in 0..DOFS {
                    let wanted = inverse[(DOFS * row + i, DOFS * column + j)];
                    assert!((block[(i, j)] - wanted).abs() < 1e-14, "({row}, {column}) of {rows}");
                }
            }
        }
    }
    let mut singular = numbers.matrix(3, 20.0);
    singular.diagonal[1] = Block::zero();
    (singular.lower[1], singular.upper[1]) = (Block::zero(), Block::zero());
    assert_eq!(singular.inverse_bands().expect_err("a row of zeros").row, 1);
}

/// Blocks of four, five and six rows are kept in different ways.
#[test]
fn solutions_of_nodes_with_fewer_degrees_of_freedom_give_their_right_hand_side() {
    fn check<const D: usize>() {
        let mut numbers = Numbers(13);
        for rows in ROW_COUNTS {
            let full = numbers.matrix(rows, 20.0);
            let part = |blocks: &[Block]| -> Vec<Block<D>> {
                blocks.iter().map(|block| Block::from_fn(|i, j| block[(i, j)])).collect()
            };
            let matrix = BlockTridiagonal {
                lower: part(&full.lower),
                diagonal: part(&full.diagonal),
                upper: part(&full.upper),
            };
            let b: BlockVector<D> = (0..rows).map(|_| std::array::from_fn(|_| numbers.next())).collect();
            let factor = Factor::new(&matrix).expect("diagonally dominant");
            let x = field_solution(&factor, &b);
            let mut product = b.clone();
            matrix.multiply_into(&x, &mut product);
            for (got, wanted) in product.as_flattened().iter().zip(b.as_flattened()) {
                assert!(
                    (got - wanted).abs() < 1e-13,
                    "{D} degrees of freedom, {rows} rows: {got} for {wanted}"
                );
            }
        }
    }
    check::<4>();
    check::<5>();
    check::<6>();
}

/// A permutation has no non-zero diagonal: only pivoting inside the block inverts it.
#[test]
fn blocks_are_inverted_with_pivoting() {
    let permutation: Block = Block::from_fn(|row, column| f64::from(u8::from((row + 2) % DOFS == column)));
    let (inverse, smallest_pivot, _) = permutation.inverse();
    assert_eq!(inverse, Block::from_fn(|row, column| permutation[(column, row)]));
    assert_eq!(smallest_pivot, 1.0);
}

#[test]
fn a_singular_pivot_block_is_reported_with_its_row() {
    for singular in [0, 1, 3, 4, 5, 8] {
        let mut numbers = Numbers(4);
        let mut matrix = numbers.matrix(9, 20.0);
        // Decoupled, the row's own block is its pivot block.
        matrix.lower[singular] = Block::zero();
        matrix.upper[singular] = Block::zero();
        let block = &mut matrix.diagonal[singular];
        for row in 0..DOFS {
            block[(row, 5)] = block[(row, 0)] - 3.0 * block[(row, 2)];
        }
        let error = Factor::new(&matrix).expect_err("two columns depend");
        assert_eq!(error, SingularBlock { row: singular });
    }
}

#[test]
fn values_that_are_not_finite_are_reported() {
    for value in [f64::NAN, f64::INFINITY] {
        let mut matrix = Numbers(5).matrix(6, 20.0);
        matrix.diagonal[2][(3, 1)] = value;
        assert_eq!(Factor::new(&matrix).expect_err("not finite").row, 2);
    }
}

/// A regular matrix whose leading block is nearly singular: block elimination without pivoting across blocks
/// loses the precision that `growth` reports.
#[test]
fn growth_measures_the_loss_of_precision() {
    let mut numbers = Numbers(6);
    let mut matrix = numbers.matrix(2, 0.0);
    assert!(Factor::new(&numbers.matrix(17, 20.0)).expect("diagonally dominant").growth() < 2.0);

    let small = 1e-9;
    matrix.diagonal[0] = Block::from_fn(|row, column| if row == column { small } else { 0.0 });
    let factor = Factor::new(&matrix).expect("regular, though nearly not");
    assert!(factor.growth() > 0.1 / small && factor.growth() < 10.0 * DOFS as f64 / small);
    let b = numbers.vector(2);
    let mut x = b.clone();
    factor.solve_in_place(&mut x);
    let residual = relative_difference(&(dense(&matrix) * flat(&x)), &flat(&b));
    assert!(residual < 1e3 * factor.growth() * f64::EPSILON);
}

#[test]
fn arctangent_equals_the_system_library() {
    let mut worst = 0.0f64;
    for exponent in -1074..1024 {
        for significand in [1.0, 1.1, 1.3247, 1.5, 1.653, 1.999] {
            let x = significand * 2f64.powi(exponent);
            worst = worst.max((Lane::atan(x) - f64::atan(x)).abs() / f64::atan(x));
            assert_eq!(Lane::atan(-x), -Lane::atan(x));
        }
    }
    for step in 1..40_000 {
        let x = f64::from(step) * 1e-4;
        worst = worst.max((Lane::atan(x) - f64::atan(x)).abs() / f64::atan(x));
    }
    // Moshier's own figure is 1.8e-16; the system's result is itself rounded.
    assert!(worst < 3e-16, "{worst:e}");

    assert_eq!(Lane::atan(f64::INFINITY), std::f64::consts::FRAC_PI_2);
    assert_eq!(Lane::atan(f64::NEG_INFINITY), -std::f64::consts::FRAC_PI_2);
    assert!(Lane::atan(0.0f64) == 0.0 && Lane::atan(0.0f64).is_sign_positive());
    assert!(Lane::atan(-0.0f64) == 0.0 && Lane::atan(-0.0f64).is_sign_negative());
    assert!(Lane::atan(f64::NAN).is_nan());
}

#[test]
fn sine_and_cosine_equal_the_system_library() {
    let mut worst = 0.0f64;
    let near = (0..40_000).map(|step| f64::from(step) * 1e-3);
    let far = (0..40_000).map(|step| f64::from(step).mul_add(731.37, 0.1));
    let multiples = (0..4_000).map(|quarter| f64::from(quarter) * std::f64::consts::FRAC_PI_4);
    for x in near.chain(far).chain(multiples).flat_map(|x| [x, -x]) {
        let (sin, cos) = Lane::sin_cos(x);
        let (expected_sin, expected_cos) = f64::sin_cos(x);
        worst = worst.max((sin - expected_sin).abs()).max((cos - expected_cos).abs());
    }
    assert!(worst < 3e-16, "{worst:e}");

    let values = [0.3, -2.9, 57.0, -1e6];
    let (sin, cos) = Four::new(values).sin_cos();
    for (lane, value) in values.into_iter().enumerate() {
        assert_eq!((sin.lane(lane), cos.lane(lane)), Lane::sin_cos(value));
    }
}

#[test]
fn a_singular_row_is_named() {
    let mut matrix = BlockTridiagonal::<DOFS>::zeros(3);
    for row in 0..3 {
        matrix.add_block(row, row, &Block::identity());
    }
    matrix.diagonal[1][(2, 2)] = 0.0;
    assert_eq!(Factor::new(&matrix).expect_err("a zero row"), SingularBlock { row: 1 });
}

#[test]
fn arctangent_of_a_lane_has_the_bits_of_one_alone() {
    let values = [0.3, -0.9, 57.0, f64::NEG_INFINITY];
    let together = Four::new(values).atan();
    for (lane, value) in values.into_iter().enumerate() {
        assert_eq!(together.lane(lane), Lane::atan(value));
    }
}
