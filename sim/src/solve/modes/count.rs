//! Number of eigenvalues in a region: the winding number of the determinant along its edge.
//!
//! det Q(l) is analytic, so that its phase turns once around the edge for every eigenvalue inside (the argument principle). The count follows
//! the determinant divided by (l - l_k) for the eigenvalues that are known, inside and outside: its phase turns once for every unknown
//! eigenvalue, and is smooth if none lies near the edge, so that few factorisations follow it.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::pencil::Pencil;
use super::shifted::ShiftedPencil;

/// Places in a piece of the edge at which the determinant is evaluated, in shares of the piece. The steps between them have no common measure:
/// a phase that turned by whole turns in each of them would have to do so in proportion to all of them.
const PLACES: [f64; 5] = [0.0, 0.2099, 0.5067, 0.6364, 1.0];

/// Largest turn of the phase between two of these places \[rad\].
const SMALL_TURN: f64 = 1.0;

/// Largest difference of the steps of phase \[rad\] and of the logarithm of the size from one place to the next, in proportion to their
/// lengths, at which the edge counts as followed. Two unknown zeros next to the edge, a whole turn between two places, show in the size at
/// the others.
const STRAIGHT: f64 = 0.5;

/// Factorisations after which a count is given up.
const MOST_FACTORS: usize = 3000;

/// Halvings of an edge after which it runs into an eigenvalue.
const MOST_HALVINGS: usize = 40;

/// A rectangle of eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Region {
    /// Smallest and largest growth \[1/s\].
    pub(super) growth: [f64; 2],
    /// Smallest and largest circular frequency \[1/s\]. From 0, it holds the conjugate eigenvalues too: eigenvalues of a real pencil
    /// stand on its lower edge.
    pub(super) frequency: [f64; 2],
}

impl Region {
    /// Number of `known` in the region. They stand for their conjugates too: in a region from 0, the conjugates are counted.
    pub(super) fn holds(&self, known: &[Complex<f64>]) -> i64 {
        let ([low, high], [from, to]) = (self.growth, self.frequency);
        let inside =
            known.iter().filter(|value| (low..=high).contains(&value.re) && (from..=to).contains(&value.im));
        inside.map(|value| if from == 0.0 && value.im != 0.0 { 2 } else { 1 }).sum()
    }
}

/// Counts eigenvalues of a pencil.
pub(super) struct Counter<'a> {
    pencil: &'a Pencil,
    /// Logarithms of the determinant by the bits of the point; absent if the determinant is zero.
    determinants: HashMap<[u64; 2], Option<Complex<f64>>>,
    left: usize,
}

impl<'a> Counter<'a> {
    pub(super) fn new(pencil: &'a Pencil) -> Self {
        Self { pencil, determinants: HashMap::new(), left: MOST_FACTORS }
    }

    /// Number of eigenvalues in a region beyond [those](Region::holds) of `known`. `None` if the edge runs into an eigenvalue or cannot be followed.
    pub(super) fn beyond(&mut self, known: &[Complex<f64>], region: &Region) -> Option<i64> {
        let ([low, high], [from, to]) = (region.growth, region.frequency);
        let mut corners = vec![(high, from), (high, to), (low, to), (low, from)];
        // The lower half of a region that is its own mirror image turns as the upper one does.
        let whole_turn = if from == 0.0 { PI } else { TAU };
        if from > 0.0 {
            corners.push((high, from));
        }
        let mut turned = 0.0;
        for ends in corners.windows(2) {
            let [start, end] = [ends[0], ends[1]].map(|(re, im)| Complex::new(re, im));
            turned += self.along(known, start, end, MOST_HALVINGS)?;
        }
        Some((turned / whole_turn).round() as i64)
    }

    /// Turn of the phase along a line.
    fn along(
        &mut self,
        known: &[Complex<f64>],
        start: Complex<f64>,
        end: Complex<f64>,
        halvings: usize,
    ) -> Option<f64> {
        // The ends are the same bits as those of the neighbours.
        let at = |place: f64| match place {
            0.0 => start,
            1.0 => end,
            _ => start + (end - start) * place,
        };
        let mut values = [Complex::new(0.0, 0.0); PLACES.len()];
        for (value, place) in values.iter_mut().zip(PLACES) {
            *value = self.unknown_part(known, at(place))?;
        }
        let steps: Vec<(f64, Complex<f64>)> = values
            .windows(2)
            .zip(PLACES.windows(2))
            .map(|(values, places)| {
                let step = values[1] - values[0];
                (places[1] - places[0], Complex::new(step.re, (step.im + PI).rem_euclid(TAU) - PI))
            })
            .collect();
        let bent = |(a_length, a): (f64, Complex<f64>), (b_length, b): (f64, Complex<f64>)| {
            let bend = (b / b_length - a / a_length) * (0.5 * (a_length + b_length));
            bend.re.abs().max(bend.im.abs()) > STRAIGHT
        };
        if steps.iter().all(|(_, step)| step.im.abs() <= SMALL_TURN)
            && !steps.windows(2).any(|pair| bent(pair[0], pair[1]))
        {
            return Some(steps.iter().map(|(_, step)| step.im).sum());
        }
        let fewer = halvings.checked_sub(1)?;
        let middle = at(PLACES[2]);
        Some(self.along(known, start, middle, fewer)? + self.along(known, middle, end, fewer)?)
    }

    /// The logarithm of the determinant without its known zeros.
    fn unknown_part(&mut self, known: &[Complex<f64>], point: Complex<f64>) -> Option<Complex<f64>> {
        let place = [point.re.to_bits(), point.im.to_bits()];
        let determinant = match self.determinants.get(&place) {
            Some(determinant) => *determinant,
            None => {
                self.left = self.left.checked_sub(1)?;
                let factor = ShiftedPencil::new(point, self.pencil.matrices(), &self.pencil.held);
                let determinant = factor.map(|factor| factor.log_determinant());
                self.determinants.insert(place, determinant);
                determinant
            }
        };
        let mut rest = determinant?;
        for &value in known {
            rest -= (point - value).ln();
            if value.im != 0.0 {
                rest -= (point - value.conj()).ln();
            }
        }
        (rest.re.is_finite() && rest.im.is_finite()).then_some(rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::linalg::{BlockTridiagonal, DOFS};

    /// Oscillators by themselves, of mass 1, which vibrate with these circular frequencies and growths.
    fn oscillators(eigenvalues: &[Complex<f64>]) -> Pencil {
        let nodes = eigenvalues.len().div_ceil(DOFS);
        let zero = BlockTridiagonal::zeros(nodes);
        let [mut mass, mut damping, mut stiffness] = [zero.clone(), zero.clone(), zero];
        let mut held = vec![[true; DOFS]; nodes];
        for (place, value) in eigenvalues.iter().enumerate() {
            let (node, dof) = (place / DOFS, place % DOFS);
            held[node][dof] = false;
            mass.diagonal[node][(dof, dof)] = 1.0;
            damping.diagonal[node][(dof, dof)] = -2.0 * value.re;
            stiffness.diagonal[node][(dof, dof)] = value.norm_sqr();
        }
        Pencil::new(mass, damping, stiffness, held)
    }

    #[test]
    fn as_many_are_missing_as_the_region_holds_and_are_not_known() {
        // Equal ones and pairs, next to the edge on both sides, far outside, and growing ones.
        let values: Vec<Complex<f64>> = [
            (-0.1, 3.0),
            (-0.1, 3.0),
            (-0.99999, 5.0),
            (-1.00001, 6.0),
            (-0.2, 9.99999),
            (-0.2, 9.99999),
            (-0.2, 10.00001),
            (0.5, 7.0),
            (0.0, 300.0),
            (-40.0, 2.0),
        ]
        .map(|(re, im)| Complex::new(re, im))
        .into();
        let pencil = oscillators(&values);
        for frequency in [[0.0, 10.0], [4.0, 10.0], [2.0, 2.5]] {
            let region = Region { growth: [-1.0, 20.0], frequency };
            let inside = |value: &Complex<f64>| {
                (-1.0..20.0).contains(&value.re) && (frequency[0]..frequency[1]).contains(&value.im)
            };
            for known in 0..=values.len() {
                let missing = values[known..].iter().filter(|value| inside(value)).count();
                // The conjugate ones are below 0.
                let expected = if frequency[0] == 0.0 { 2 * missing } else { missing };
                let found = Counter::new(&pencil).beyond(&values[..known], &region);
                assert_eq!(found, Some(expected as i64), "{known} known of {frequency:?}");
            }
            // A known value that is no eigenvalue counts the other way.
            let wrong = [&values[..], &[Complex::new(0.0, 0.5 * (frequency[0] + frequency[1]))]].concat();
            let found = Counter::new(&pencil).beyond(&wrong, &region).expect("counted");
            assert_eq!(found, if frequency[0] == 0.0 { -2 } else { -1 }, "{frequency:?}");
        }
    }

    #[test]
    fn overdamped_motions_count_one_by_one() {
        // l^2 + 5 l + 4: -1 and -4.
        let mut pencil = oscillators(&[Complex::new(-2.5, 0.0)]);
        pencil.stiffness.diagonal[0][(0, 0)] = 4.0;
        let region = |decay: f64| Region { growth: [-decay, 1.0], frequency: [0.0, 1.0] };
        for (decay, expected) in [(0.5, 0), (2.0, 1), (5.0, 2)] {
            assert_eq!(Counter::new(&pencil).beyond(&[], &region(decay)), Some(expected));
        }
    }

    #[test]
    fn an_edge_through_an_eigenvalue_is_not_counted() {
        let pencil = oscillators(&[Complex::new(0.0, 1.0)]);
        let region = Region { growth: [-1.0, 1.0], frequency: [0.0, 1.0] };
        assert_eq!(Counter::new(&pencil).beyond(&[], &region), None);
    }
}
