//! Fatigue of pipe with a grade, by the cycles of its axial stress.
//!
//! The stress is that of places around the outer diameter in the middle of an element, which turn with the pipe. Its cycles are counted by rainflow
//! (ASTM E1049-85, 5.4.4) within a block of time; each damages by the S-N curve at its range, which the mean stress raises (Goodman), and damages add up
//! (Miner).

use drillsweep_scenario::Grade;
use serde::{Deserialize, Serialize};

use crate::solve::model::{Model, StringElement};
use crate::solve::statics::Equilibrium;

/// Number of pairs of opposite places.
const PAIRS: usize = 4;

/// Most turning points of a stress that are kept; beyond them the oldest range counts as half a cycle.
const MOST_POINTS: usize = 64;

/// Smallest part of the tensile strength that a mean stress leaves: damages stay finite.
const LEAST_RESERVE: f64 = 0.01;

/// S-N curve of base metal in seawater with cathodic protection, class B of ISO 19902:2007: cycles to failure are 10^14.61 / S^4 up to 10^5 cycles and
/// 10^17.01 / S^5 beyond, with the range S in MPa.
const CURVE: [f64; 2] = [4.073_802_778_041_1e14, 1.023_292_992_280_75e17];

/// Element with a grade.
#[derive(Debug, Clone, Copy)]
pub(super) struct FatigueSite {
    pub(super) element: usize,
    /// Bending stress at the outer diameter by moment \[1/m3\].
    bending: f64,
    /// Axial stress by tension \[1/m2\].
    axial: f64,
    /// Axial stress by the pressures on the pipe's ends, which the effective tension leaves out \[Pa\].
    pressure: f64,
    /// Tensile strength \[Pa\].
    strength: f64,
}

/// Bytes of the turning points of an element with a grade, at most.
pub(super) const POINT_BYTES: usize = 2 * PAIRS * MOST_POINTS * size_of::<f64>();

/// Cycles of a site's stresses within a block.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct SiteCycles {
    places: [Rainflow; 2 * PAIRS],
}

/// Cycles of one stress.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Rainflow {
    /// Turning points whose cycles are open \[Pa\]; the last is the present stress.
    points: Vec<f64>,
    damage: f64,
}

impl FatigueSite {
    /// Elements of a string that have a grade.
    pub(super) fn of(model: &Model, equilibrium: &Equilibrium) -> Vec<Self> {
        let elements = model.elements.iter().zip(&model.mesh.elements).enumerate();
        elements
            .filter_map(|(e, (element, meshed))| {
                Some(Self::new(e, element, meshed.tube.material.grade?, equilibrium))
            })
            .collect()
    }

    fn new(e: usize, element: &StringElement, grade: Grade, equilibrium: &Equilibrium) -> Self {
        let section = element.beam.section();
        let pressure = equilibrium.pressures.as_ref().map_or(0.0, |pressures| {
            let middle = |values: &[f64]| 0.5 * (values[e] + values[e + 1]);
            let inside = middle(&pressures.bore) * section.bore_area();
            (inside - middle(&pressures.annulus) * section.displaced_area()) / section.area
        });
        Self {
            element: e,
            bending: section.outer_bending_stress(),
            axial: 1.0 / section.area,
            pressure,
            strength: grade.tensile_strength(),
        }
    }

    /// Takes in a tension \[N\] and a bending moment \[N m\] by the curvature along two axes that turn with the pipe.
    pub(super) fn observe(&self, tension: f64, [x, y]: [f64; 2], cycles: &mut SiteCycles) {
        let axial = tension.mul_add(self.axial, self.pressure);
        let diagonal = std::f64::consts::FRAC_1_SQRT_2;
        let moments: [f64; PAIRS] = [x, (x + y) * diagonal, y, (y - x) * diagonal];
        let (right, left) = cycles.places.split_at_mut(PAIRS);
        for (pair, moment) in moments.into_iter().enumerate() {
            let bending = moment * self.bending;
            right[pair].observe(axial + bending, self.strength);
            left[pair].observe(axial - bending, self.strength);
        }
    }

    /// Largest damage of a place.
    pub(super) fn damage(&self, cycles: &SiteCycles) -> f64 {
        cycles.places.iter().map(|place| place.damage).fold(0.0, f64::max)
    }

    /// Ends the block of cycles: open ranges count as half cycles.
    pub(super) fn close(&self, cycles: &mut SiteCycles) {
        cycles.places.iter_mut().for_each(|place| place.close(self.strength));
    }
}

impl SiteCycles {
    /// Adds the damages of the block that follows.
    pub(super) fn add(&mut self, next: &Self) {
        self.places.iter_mut().zip(&next.places).for_each(|(sum, next)| sum.damage += next.damage);
    }
}

impl Rainflow {
    fn observe(&mut self, stress: f64, strength: f64) {
        let rises = match *self.points.as_slice() {
            [.., before, last] => (stress - last) * (last - before) >= 0.0,
            [last] if stress == last => return,
            _ => false,
        };
        match self.points.last_mut() {
            Some(last) if rises => *last = stress,
            _ => self.points.push(stress),
        }
        while let [.., first, second, last] = *self.points.as_slice() {
            if (last - second).abs() < (second - first).abs() {
                break;
            }
            let count = self.points.len();
            if count == 3 {
                self.damage += 0.5 * damage_of_cycle(first, second, strength);
                self.points.remove(0);
            } else {
                self.damage += damage_of_cycle(first, second, strength);
                self.points.drain(count - 3..count - 1);
            }
        }
        if self.points.len() > MOST_POINTS {
            self.damage += 0.5 * damage_of_cycle(self.points[0], self.points[1], strength);
            self.points.remove(0);
        }
    }

    fn close(&mut self, strength: f64) {
        for range in self.points.windows(2) {
            self.damage += 0.5 * damage_of_cycle(range[0], range[1], strength);
        }
        self.points = Vec::new();
    }
}

/// Part of the life that a cycle between two stresses \[Pa\] takes.
fn damage_of_cycle(a: f64, b: f64, strength: f64) -> f64 {
    let mean = 0.5 * (a + b);
    let reserve = (1.0 - mean.max(0.0) / strength).max(LEAST_RESERVE);
    let range = 1e-6 * (a - b).abs() / reserve;
    let fourth = range.powi(4);
    // The branches meet at 10^5.01 cycles.
    (fourth / CURVE[0]).min(fourth * range / CURVE[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strength at which means do not matter.
    const STRONG: f64 = 1e30;

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{value} against {expected}");
    }

    #[test]
    fn cycles_of_the_standards_example() {
        // ASTM E1049-85, figure 6: half cycles of 3, 6 and 9, one and a half of 4, one of 8.
        let peaks = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0].map(|stress| 1e7 * stress);
        let expected: f64 = [(3.0, 0.5), (4.0, 1.5), (6.0, 0.5), (8.0, 1.0), (9.0, 0.5)]
            .into_iter()
            .map(|(range, count): (f64, f64)| count * damage_of_cycle(0.0, -1e7 * range, STRONG))
            .sum();
        let mut cycles = Rainflow::default();
        peaks.iter().for_each(|stress| cycles.observe(*stress, STRONG));
        cycles.close(STRONG);
        close(cycles.damage, expected);
        // Values between turning points change nothing.
        let mut finer = Rainflow::default();
        for pair in peaks.windows(2) {
            for part in 0..10 {
                finer.observe(pair[0] + (pair[1] - pair[0]) * f64::from(part) / 10.0, STRONG);
            }
        }
        finer.observe(peaks[8], STRONG);
        finer.close(STRONG);
        close(finer.damage, expected);
    }

    #[test]
    fn the_curve_has_its_lives_and_goodman_halves_the_range() {
        // Both branches meet at 10^2.4 MPa and 10^5.01 cycles; 10^7 cycles are reached at 10^((17.01 - 7) / 5) MPa.
        let life = |range: f64| 1.0 / damage_of_cycle(-0.5e6 * range, 0.5e6 * range, STRONG);
        for (log_range, log_life) in [(2.4_f64, 5.01), (10.01 / 5.0, 7.0), (2.6, 14.61 - 4.0 * 2.6)] {
            assert!((life(10_f64.powf(log_range)).log10() - log_life).abs() < 1e-9);
        }
        // A mean of half the strength leaves half of it: the range counts twice.
        let strength = 1e9;
        close(damage_of_cycle(4.5e8, 5.5e8, strength), damage_of_cycle(-1e8, 1e8, STRONG));
        // Compression does not help.
        close(damage_of_cycle(-5.5e8, -4.5e8, strength), damage_of_cycle(-5e7, 5e7, STRONG));
        assert!(damage_of_cycle(1e9, 3e9, strength).is_finite());
    }

    #[test]
    fn a_decaying_stress_keeps_a_bounded_number_of_turning_points() {
        let mut cycles = Rainflow::default();
        for number in 0..10_000 {
            let size = 1e8 * (1.0 - 1e-4 * f64::from(number));
            cycles.observe(if number % 2 == 0 { size } else { -size }, STRONG);
            assert!(cycles.points.len() <= MOST_POINTS);
        }
        cycles.close(STRONG);
        // Each half cycle counts once.
        let expected: f64 = (0..9_999)
            .map(|number| 0.5 * damage_of_cycle(0.0, 1e8 * (2.0 - 1e-4 * f64::from(2 * number + 1)), STRONG))
            .sum();
        assert!((cycles.damage - expected).abs() <= 1e-9 * expected);
    }
}
