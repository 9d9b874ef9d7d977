//! Points drawn from the unit cube: Latin hypercube and Sobol sequence, seeded, the same bits everywhere and always.

/// Fractions by axis for every point of a Latin hypercube (McKay, Beckman and Conover 1979): on each axis one point in
/// each of `samples` equal parts, at a random place in it, the parts matched at random between the axes.
pub(crate) fn latin_hypercube(axes: usize, samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let axis = |axis| {
        let mut random = Random::new("drillsweep 2026 latin hypercube", seed, axis);
        let mut parts: Vec<u32> = (0..samples as u32).collect();
        // Fisher and Yates's shuffle.
        for i in (1..samples).rev() {
            parts.swap(i, random.below(i as u64 + 1) as usize);
        }
        parts.into_iter().map(|part| (f64::from(part) + random.fraction()) / samples as f64).collect()
    };
    (0..axes).map(axis).collect()
}

/// The Sobol sequence with the direction numbers of Joe and Kuo 2008, shifted digitally by the seed: every binary digit
/// that the seed has set is turned over, in all points alike. That keeps what makes the sequence even (it stays a
/// (t, s)-sequence in base 2) and takes it off the corner.
pub(crate) struct Sobol {
    axes: Vec<[u32; 32]>,
    shifts: Vec<u32>,
}

/// Axes that the Sobol sequence is tabulated for.
pub(crate) const SOBOL_AXES: usize = 1 + DIRECTIONS.len();

impl Sobol {
    /// A sequence over at most [`SOBOL_AXES`] axes.
    pub(crate) fn new(axes: usize, seed: u64) -> Self {
        Self {
            axes: (0..axes).map(directions).collect(),
            shifts: (0..axes)
                .map(|axis| Random::new("drillsweep 2026 sobol", seed, axis).next() as u32)
                .collect(),
        }
    }

    /// The fraction of an axis at point `number`, from 0. Points are in the order of Antonov and Saleev's Gray code.
    pub(crate) fn fraction(&self, number: u32, axis: usize) -> f64 {
        let gray = number ^ (number >> 1);
        let mut digits = self.shifts[axis];
        for (bit, direction) in self.axes[axis].iter().enumerate() {
            if gray >> bit & 1 == 1 {
                digits ^= direction;
            }
        }
        // The middle of the cell that 32 digits name: neither end of the axis is ever met.
        (f64::from(digits) + 0.5) / 4_294_967_296.0
    }
}

/// Direction numbers of one axis as binary fractions, the first digit on top.
fn directions(axis: usize) -> [u32; 32] {
    let mut v = [0; 32];
    let Some((coefficients, initial)) = axis.checked_sub(1).map(|row| DIRECTIONS[row]) else {
        // The first axis is van der Corput's.
        return std::array::from_fn(|bit| 1 << (31 - bit));
    };
    let degree = initial.len();
    for i in 0..32 {
        v[i] = match initial.get(i) {
            Some(m) => m << (31 - i),
            None => (1..degree)
                .filter(|k| coefficients >> (degree - 1 - k) & 1 == 1)
                .fold(v[i - degree] ^ (v[i - degree] >> degree), |digits, k| digits ^ v[i - k]),
        };
    }
    v
}

/// Inner coefficients a of the primitive polynomial and initial direction numbers m of the axes from the second, of
/// `new-joe-kuo-6.21201`: S. Joe and F. Y. Kuo, Constructing Sobol sequences with better two-dimensional projections,
/// SIAM J. Sci. Comput. 30 (2008) 2635; <https://web.maths.unsw.edu.au/~fkuo/sobol/>, BSD licence.
const DIRECTIONS: [(u32, &[u32]); 31] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
    (19, &[1, 1, 1, 15, 7, 5]),
    (22, &[1, 3, 1, 15, 13, 25]),
    (25, &[1, 1, 5, 5, 19, 61]),
    (1, &[1, 3, 7, 11, 23, 15, 103]),
    (4, &[1, 3, 7, 13, 13, 15, 69]),
    (7, &[1, 1, 3, 13, 7, 35, 63]),
    (8, &[1, 3, 5, 9, 1, 25, 53]),
    (14, &[1, 3, 1, 13, 9, 35, 107]),
    (19, &[1, 3, 1, 5, 27, 61, 31]),
    (21, &[1, 1, 5, 11, 19, 41, 61]),
    (28, &[1, 3, 5, 3, 3, 13, 69]),
    (31, &[1, 1, 7, 13, 1, 19, 1]),
    (32, &[1, 3, 7, 5, 13, 19, 59]),
    (37, &[1, 1, 3, 9, 25, 29, 41]),
    (41, &[1, 3, 5, 13, 23, 1, 55]),
    (42, &[1, 3, 7, 3, 13, 59, 17]),
];

/// Random numbers out of BLAKE3's output stream: defined by its specification, so that no release of any library
/// changes them.
struct Random(blake3::OutputReader);

impl Random {
    fn new(context: &str, seed: u64, axis: usize) -> Self {
        let mut hasher = blake3::Hasher::new_derive_key(context);
        hasher.update(&seed.to_le_bytes());
        hasher.update(&(axis as u64).to_le_bytes());
        Self(hasher.finalize_xof())
    }

    fn next(&mut self) -> u64 {
        let mut bytes = [0; 8];
        self.0.fill(&mut bytes);
        u64::from_le_bytes(bytes)
    }

    /// 0 to 1, without the end.
    fn fraction(&mut self) -> f64 {
        (self.next() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// 0 to `end`, without the end, each as likely as the others: what would favour some is drawn again.
    fn below(&mut self, end: u64) -> u64 {
        let fair = u64::MAX - u64::MAX % end;
        loop {
            let number = self.next();
            if number < fair {
                return number % end;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The sequence without the shift.
    fn plain(axes: usize) -> Sobol {
        Sobol { shifts: vec![0; axes], ..Sobol::new(axes, 0) }
    }

    #[test]
    fn sobol_points_are_those_of_joe_and_kuo() {
        // The first ten points in three dimensions as their own program prints them.
        let expected = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
            [0.1875, 0.3125, 0.9375],
            [0.6875, 0.8125, 0.4375],
        ];
        let sobol = plain(3);
        for (number, expected) in (0..).zip(expected) {
            for (axis, expected) in expected.into_iter().enumerate() {
                let half_a_cell = 0.5 / 4_294_967_296.0;
                assert_eq!(
                    sobol.fraction(number, axis),
                    expected + half_a_cell,
                    "point {number}, axis {axis}"
                );
            }
        }
    }

    proptest! {
        #[test]
        fn every_block_of_a_sobol_sequence_fills_every_axis_evenly(seed: u64, block in 0u32..50, power in 0u32..9) {
            let (sobol, size) = (Sobol::new(SOBOL_AXES, seed), 1 << power);
            for axis in 0..SOBOL_AXES {
                let mut parts: Vec<_> = (block * size..(block + 1) * size)
                    .map(|number| (sobol.fraction(number, axis) * f64::from(size)) as u32)
                    .collect();
                parts.sort_unstable();
                prop_assert_eq!(parts, (0..size).collect::<Vec<_>>(), "axis {}", axis);
            }
        }

        #[test]
        fn the_first_two_sobol_axes_fill_every_box_of_equal_area(seed: u64, across in 0u32..6, down in 0u32..6) {
            // A (0, m, 2)-net in base 2: one point in each elementary box, whatever its shape.
            let (sobol, size) = (Sobol::new(2, seed), 1u32 << (across + down));
            let mut boxes: Vec<_> = (0..size)
                .map(|number| {
                    let part = |axis, power: u32| (sobol.fraction(number, axis) * f64::from(1 << power)) as u32;
                    (part(0, across) << down) + part(1, down)
                })
                .collect();
            boxes.sort_unstable();
            prop_assert_eq!(boxes, (0..size).collect::<Vec<_>>());
        }

        #[test]
        fn a_latin_hypercube_has_one_point_in_each_part_of_each_axis(seed: u64, axes in 1usize..6, samples in 1usize..200) {
            for fractions in latin_hypercube(axes, samples, seed) {
                let mut parts: Vec<_> =
                    fractions.iter().map(|fraction| (fraction * samples as f64) as usize).collect();
                parts.sort_unstable();
                prop_assert_eq!(parts, (0..samples).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn axes_and_seeds_differ() {
        let cube = latin_hypercube(2, 50, 1);
        assert_ne!(cube[0], cube[1]);
        assert_ne!(cube, latin_hypercube(2, 50, 2));
        assert_ne!(Sobol::new(1, 1).fraction(0, 0), Sobol::new(1, 2).fraction(0, 0));
    }

    /// These bits name stored results: a change of them makes every stored sweep another one.
    #[test]
    fn drawn_points_have_these_bits() {
        let sobol = Sobol::new(SOBOL_AXES, 7);
        let of_sobol = [sobol.fraction(0, 0), sobol.fraction(1, 1), sobol.fraction(99_999, SOBOL_AXES - 1)];
        assert_eq!(of_sobol.map(f64::to_bits), SOBOL_BITS);
        let cube = latin_hypercube(2, 100, 7);
        assert_eq!([cube[0][0], cube[0][99], cube[1][50]].map(f64::to_bits), CUBE_BITS);
    }

    const SOBOL_BITS: [u64; 3] = [4588885932257574912, 4604087098164641792, 4590195825853857792];
    const CUBE_BITS: [u64; 3] = [4604190195330887818, 4600400041522655155, 4603721791787879356];
}
