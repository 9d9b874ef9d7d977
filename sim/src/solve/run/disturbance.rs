//! Starts of the members of an ensemble.

use crate::math::dof::{DOFS, U, V};
use crate::solve::model::{Model, NodalVector};

/// Largest lateral displacement by which a member is disturbed at its start \[m\].
pub const DISTURBANCE: f64 = 1e-6;

/// Number of half waves along the string in a disturbance: it is smooth, so that it starts no vibration of its own.
const HALF_WAVES: usize = 6;

/// Displacements added at the start of a member: none for member 0, and for each other one its own
/// sum of sines along the string with a largest value of [`DISTURBANCE`]. It vanishes at both ends.
pub fn disturbance(model: &Model, member: u32) -> NodalVector {
    let nodes = &model.mesh.nodes;
    let mut shape = vec![[0.0; DOFS]; nodes.len()];
    if member == 0 {
        return shape;
    }
    let length = nodes.last().map_or(1.0, |node| node.measured_depth);
    let mut random = Random(u64::from(member));
    for half_wave in 1..=HALF_WAVES {
        let (along_u, along_v) = (random.next(), random.next());
        for (value, node) in shape.iter_mut().zip(nodes) {
            let sine = (std::f64::consts::PI * half_wave as f64 * node.measured_depth / length).sin();
            value[U] += along_u * sine;
            value[V] += along_v * sine;
        }
    }
    let largest = shape.iter().fold(0.0_f64, |most, value| most.max(value[U].abs()).max(value[V].abs()));
    for value in shape.iter_mut().flatten() {
        *value *= DISTURBANCE / largest;
    }
    shape
}

/// SplitMix64 (Steele, Lea and Flood 2014): the same numbers everywhere.
struct Random(u64);

impl Random {
    /// The next number in \[-1, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;

    #[test]
    fn members_start_apart_by_a_micrometre_and_the_first_not_at_all() {
        let model = Model::new(&preset("paper-200m").unwrap()).unwrap();
        assert!(disturbance(&model, 0).as_flattened().iter().all(|&value| value == 0.0));
        let (one, two) = (disturbance(&model, 1), disturbance(&model, 2));
        for shape in [&one, &two] {
            let largest = shape.as_flattened().iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!((largest - DISTURBANCE).abs() < 1e-18);
            assert_eq!(shape[0], [0.0; DOFS], "the top is held");
        }
        assert_ne!(one, two);
        assert_eq!(one, disturbance(&model, 1));
    }
}
