//! Roots with growth of the characteristic function: their number by its winding, their places by the secant method.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::feedback::Feedback;
use super::table::{NEUTRAL, Products, STENCIL, Table, is_small, whole};

/// Iterations of the secant method from one start.
const MOST_ITERATIONS: usize = 25;

/// Roots that decay to which the method converges from one start, next to which others may hide.
const MOST_HIDING: usize = 3;

/// Distance, in steps of the table, of found roots that are taken out of the function.
const NEARBY: f64 = 30.0;

/// Change of a root, over the step of the table, at which it is found.
const SOLVED: f64 = 1e-9;

/// Size of the function at a root over that a tenth of a step away.
const SMALL: f64 = 1e-5;

/// Square of the characteristic function below which a place may be next to a root.
const NEAR: f64 = 0.5;

/// Distance of roots, over the step of the table, below which they are one.
const SAME: f64 = 1e-5;

/// Motions of bit and string that grow.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Growing {
    /// Their number by the winding, conjugate ones included; absent if the characteristic function could not be followed.
    pub(super) counted: Option<i64>,
    /// Those found, each s \[1/s\] with a frequency of zero or more.
    pub(super) found: Vec<Complex<f64>>,
    /// True if none is above the highest frequency of the search.
    pub(super) is_bounded: bool,
}

impl Growing {
    /// Number of those found, conjugate ones included.
    pub(super) fn found_with_conjugates(&self) -> i64 {
        self.found.iter().map(|root| if root.im > 0.0 { 2 } else { 1 }).sum()
    }
}

/// The characteristic function of string and bit on a line of the table.
struct Search<'a> {
    table: &'a Table,
    feedback: &'a Feedback,
    /// True if the axial products are divided by s.
    is_free: bool,
    /// Place of the highest frequency of the search.
    last: usize,
    /// The function without its poles at the places of the table, and at some above the last.
    values: Vec<Complex<f64>>,
}

/// Roots with growth of a string, whose top is free along its axis or not, with the feedback of its bit.
pub(super) fn growing(table: &Table, is_free: bool, feedback: &Feedback) -> Growing {
    let quiet = table.quiet_from(|omega, of_string| feedback.bound(omega, of_string));
    let last = quiet.map_or(table.last, |omega| ((omega / table.step).ceil() as usize).min(table.last));
    let mut search = Search { table, feedback, is_free, last, values: Vec::new() };
    search.values = search.on_the_line();
    let is_bounded = quiet.is_some_and(|omega| omega <= table.highest());
    let (turned, starts) = search.follow();
    let counted = turned.and_then(|turned| {
        let closing = if is_bounded { search.closing_bounded() } else { search.closing() };
        whole(-(turned + closing?) / PI).map(|of_feedback| table.own_growing + of_feedback)
    });
    let found = search.find(counted, &starts);
    Growing { counted, found, is_bounded }
}

impl Search<'_> {
    /// N_a N_t + P w_a N_t + Q w_t N_a, an entire function.
    fn at(&self, s: Complex<f64>) -> Complex<f64> {
        match self.table.interpolated(&self.values, s) {
            Some(value) => value,
            None => self.of(self.table.solved(s), s, self.feedback.at(s)),
        }
    }

    /// The characteristic function, with its poles.
    fn relative(&self, s: Complex<f64>) -> Complex<f64> {
        let forces = self.table.interpolated(&self.table.forces, s);
        self.at(s) / forces.unwrap_or_else(|| self.table.solved(s)[0])
    }

    fn of(&self, products: Products, s: Complex<f64>, [p, q]: [Complex<f64>; 2]) -> Complex<f64> {
        let p = if self.is_free { p / s } else { p };
        products[0] + p * products[1] + q * products[2]
    }

    /// Values at the places up to half a stencil above the last.
    fn on_the_line(&self) -> Vec<Complex<f64>> {
        let step = self.table.step;
        let mut shares = self.feedback.along(Complex::new(NEUTRAL, 0.0), Complex::new(0.0, step));
        (0..=self.last + STENCIL / 2)
            .map(|i| {
                let s = Complex::new(NEUTRAL, i as f64 * step);
                self.of(self.table.products[i], s, shares.next_at(s))
            })
            .collect()
    }

    /// Turn of the phase of the characteristic function up the line \[rad\], absent if it runs into a root; and places next to roots.
    fn follow(&self) -> (Option<f64>, Vec<usize>) {
        let last = self.last;
        let steps: Vec<Complex<f64>> = self.values.windows(2).map(|pair| pair[1] * pair[0].conj()).collect();
        let sizes: Vec<f64> = self.values.iter().map(|value| value.norm_sqr()).collect();
        let function = |s: Complex<f64>| self.at(s);
        let (mut turned, mut is_followed) = (0.0, true);
        for place in 0..last {
            let near = place.saturating_sub(1)..(place + 2).min(last);
            let is_smooth = near.into_iter().all(|i| is_small(steps[i], sizes[i], sizes[i + 1]));
            if is_smooth {
                turned += (steps[place].im / steps[place].re).atan();
            } else {
                match self.table.turn_between(place, &function) {
                    Some(turn) => turned += turn,
                    None => is_followed = false,
                }
            }
        }
        let relative: Vec<f64> = sizes[..=last]
            .iter()
            .zip(&self.table.inverse_squares)
            .map(|(size, inverse)| size * inverse)
            .collect();
        let own = self.table.turns[last];
        // A root closer to a pole than a step shows in the function without poles alone.
        let mut starts = smallest(&relative);
        starts.extend(smallest(&sizes[..=last]));
        (is_followed.then_some(turned - own), starts)
    }

    /// Turn of the phase along the closing line where |F - 1| < 1: it ends at the phase of 1.
    fn closing_bounded(&self) -> Option<f64> {
        let last = self.last;
        let end = self.values[last] / self.table.products[last][0];
        (end.re > 0.0).then(|| -end.arg())
    }

    /// Turn of the phase along the closing line at the highest frequency.
    fn closing(&self) -> Option<f64> {
        let mut turned = 0.0;
        let mut before: Option<Complex<f64>> = None;
        for &(s, [axial, torsional]) in &self.table.closing {
            let [p, q] = self.feedback.at(s);
            let p = if self.is_free { p / s } else { p };
            let value = p * axial + q * torsional + 1.0;
            if let Some(before) = before {
                let turn = (value * before.conj()).arg();
                if turn.abs() > 0.5 * PI {
                    return None;
                }
                turned += turn;
            }
            before = Some(value);
        }
        Some(turned - before?.arg())
    }

    /// Roots with growth, from places next to small values of the function and, if some are missing, from a grid.
    fn find(&self, counted: Option<i64>, starts: &[usize]) -> Vec<Complex<f64>> {
        let wanted = match counted {
            Some(count) if count <= 0 => return Vec::new(),
            Some(count) => count,
            None => i64::MAX,
        };
        let step = self.table.step;
        let mut found = Found { growing: Vec::new(), others: Vec::new() };
        let line = |place: usize| Complex::new(NEUTRAL, place as f64 * step);
        // With its poles the function leads to roots next to them, without them to the others.
        for function in [Self::at, Self::relative] {
            for &place in starts {
                for _ in 0..MOST_HIDING {
                    let decaying = found.others.len();
                    self.secant(function, [line(place) + 0.1 * step, line(place)], &mut found);
                    if found.count() >= wanted {
                        return found.growing;
                    }
                    if found.others.len() == decaying {
                        break;
                    }
                }
            }
        }
        // Small values on lines of more growth.
        for growth in [1.5, 3.0, 5.0, 10.0, 20.0] {
            let shifted = |place: usize| line(place) + growth * step;
            let size = |place: usize| self.relative(shifted(place)).norm_sqr();
            let sizes: Vec<f64> = (0..=self.last).map(size).collect();
            let is_near = |place: &usize| sizes[*place] < NEAR;
            for place in smallest(&sizes).into_iter().chain((0..=self.last).filter(is_near)) {
                let start = [shifted(place), shifted(place) + 0.3 * step];
                self.secant(Self::relative, start, &mut found);
                if found.count() >= wanted {
                    return found.growing;
                }
            }
        }
        found.growing
    }

    /// Follows the secant method from two starts to a root that is not yet found.
    fn secant(
        &self,
        function: fn(&Self, Complex<f64>) -> Complex<f64>,
        [mut before, mut here]: [Complex<f64>; 2],
        found: &mut Found,
    ) {
        let step = self.table.step;
        let highest = self.last as f64 * step;
        let near = found.near(here, step);
        // Without the roots nearby that are found.
        let value =
            |s: Complex<f64>| near.iter().fold(function(self, s), |value, root| value * step / (s - root));
        let (mut value_before, mut value_here) = (value(before), value(here));
        for _ in 0..MOST_ITERATIONS {
            let change = value_here * (here - before) / (value_here - value_before);
            let length = change.norm();
            if !length.is_finite() {
                return;
            }
            let change = if length > 4.0 * step { change * (4.0 * step / length) } else { change };
            (before, value_before) = (here, value_here);
            here -= change;
            if here.im < 0.0 {
                (here, before) = (here.conj(), before.conj());
                value_before = value_before.conj();
            }
            if length <= SOLVED * step {
                // A function that is infinite next to a known root ends the method, too.
                let is_root = self.at(here).norm() <= SMALL * self.at(here + 0.1 * step).norm();
                if is_root && here.im <= highest {
                    found.add(here, step);
                }
                return;
            }
            if here.re < -4.0 * step || here.im > highest + 4.0 * step {
                return;
            }
            value_here = value(here);
        }
    }
}

/// Places of the smallest values among their neighbours.
fn smallest(values: &[f64]) -> Vec<usize> {
    let last = values.len() - 1;
    let is_smallest =
        |&i: &usize| values[i] <= values[i.saturating_sub(1)] && values[i] <= values[(i + 1).min(last)];
    (0..=last).filter(is_smallest).collect()
}

/// Roots, of which the method does not converge to one twice.
struct Found {
    growing: Vec<Complex<f64>>,
    others: Vec<Complex<f64>>,
}

impl Found {
    fn count(&self) -> i64 {
        self.growing.iter().map(|root| if root.im > 0.0 { 2 } else { 1 }).sum()
    }

    /// Roots within some steps of a place, conjugate ones included.
    fn near(&self, place: Complex<f64>, step: f64) -> Vec<Complex<f64>> {
        let all = self.growing.iter().chain(&self.others);
        let with_conjugates = all.flat_map(|root| [Some(*root), (root.im > 0.0).then(|| root.conj())]);
        with_conjugates.flatten().filter(|root| (root - place).norm() < NEARBY * step).collect()
    }

    fn add(&mut self, root: Complex<f64>, step: f64) {
        // A root on the real axis is its own conjugate.
        let root = if root.im < SAME * step { Complex::new(root.re, 0.0) } else { root };
        let is_known =
            self.growing.iter().chain(&self.others).any(|known| (known - root).norm() < SAME * step);
        if is_known {
            return;
        }
        if root.re > NEUTRAL { self.growing.push(root) } else { self.others.push(root) }
    }
}
