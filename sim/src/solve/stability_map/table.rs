//! Receptances of a string at the bit, tabulated next to the imaginary axis.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Complex;

use super::chain::Chain;

/// Growth \[1/s\] below which a motion counts as neither growing nor decaying: the line along which roots are counted.
pub(super) const NEUTRAL: f64 = 1e-6;

/// Places of the table in a radian of the waves' and the delay's travel.
pub(super) const STEP: f64 = 0.4;

/// Places from which a value between them is interpolated, half of them on either side.
pub(super) const STENCIL: usize = 16;

/// Growth, in steps of the table, up to which values are interpolated; waves are solved beyond. With 0.4 rad a step the polynomial is off by less than
/// (0.4)^16 / 16! prod |x - k| = 2e-6 of the largest value there, and by 1e-11 on the line.
const FARTHEST: f64 = 6.0;

/// Places above the end of the line, half a stencil and some from which the end is chosen.
const SPARE: usize = 40;

/// Places of the line that closes the region at its highest frequency.
const CLOSING_PLACES: u32 = 120;

/// Steps of the table to the first of these places, and highest frequencies to the last.
const CLOSING_ENDS: [f64; 2] = [0.01, 100.0];

/// Halvings of a step after which the line runs into a zero.
const MOST_HALVINGS: usize = 40;

/// Largest turn of the phase \[rad\] from place to place that counts as followed.
pub(super) const SMALL_TURN: f64 = 1.0;

/// Largest ratio of neighbouring squares of the size that counts as followed: two zeros between two places show next to them with 25 or more.
const SMALL_RATIO: f64 = 8.0;

/// Places in an interval at which a phase is followed, without a common measure.
const PLACES: [f64; 5] = [0.0, 0.2099, 0.5067, 0.6364, 1.0];

/// Products of the entire functions N and w of the axial chain (a) and the torsional one (t): N_a N_t, w_a N_t, w_t N_a.
pub(super) type Products = [Complex<f64>; 3];

/// Axial and torsional receptance of a string at its bit.
#[derive(Debug, Clone)]
pub(super) struct Table {
    chains: [Chain; 2],
    /// Distance of the places \[rad/s\].
    pub(super) step: f64,
    /// Products at the places i step from zero up.
    pub(super) products: Vec<Products>,
    /// The first product.
    pub(super) forces: Vec<Complex<f64>>,
    /// Its inverse squares.
    pub(super) inverse_squares: Vec<f64>,
    /// Turn of the first product's phase from zero to each place \[rad\].
    pub(super) turns: Vec<f64>,
    /// Place of the highest frequency.
    pub(super) last: usize,
    /// Motions of the string by itself that grow, conjugate ones included.
    pub(super) own_growing: i64,
    /// Places of the closing line with the receptances there.
    pub(super) closing: Vec<(Complex<f64>, [Complex<f64>; 2])>,
    /// Frequencies \[rad/s\] with bounds of both receptances from there on.
    bounds: Vec<(f64, [f64; 2])>,
    /// Weights of the polynomial.
    weights: [f64; STENCIL],
}

impl Table {
    /// Table of an axial and a torsional chain up to a frequency \[rad/s\], for delays up to the longest \[s\]; absent if the own growing motions of the string cannot be counted.
    pub(super) fn new(chains: [Chain; 2], highest: f64, longest_delay: f64) -> Option<Self> {
        let travel: f64 = chains.iter().map(Chain::travel_time).sum();
        let step = STEP / (travel + longest_delay);
        let count = (highest / step).ceil() as usize + SPARE + STENCIL / 2;
        let scaled = |place: usize| {
            let s = Complex::new(NEUTRAL, place as f64 * step);
            scaled_products(&chains, s)
        };
        let products: Vec<Products> = (0..count).map(scaled).collect();
        let usable = count - SPARE - STENCIL / 2..count - STENCIL / 2;
        let size = |place: &usize| products[*place][0].norm_sqr();
        let last = usable.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let mut weights = [1.0; STENCIL];
        for k in 1..STENCIL {
            weights[k] = -weights[k - 1] * (STENCIL - k) as f64 / k as f64;
        }
        let forces: Vec<Complex<f64>> = products.iter().map(|products| products[0]).collect();
        let inverse_squares = forces.iter().map(|forces| forces.norm_sqr().recip()).collect();
        let mut table = Self {
            bounds: bounds(&chains, highest),
            chains,
            step,
            products,
            forces,
            inverse_squares,
            turns: Vec::new(),
            last,
            own_growing: 0,
            closing: Vec::new(),
            weights,
        };
        let between =
            |s: Complex<f64>| table.interpolated(&table.forces, s).unwrap_or_else(|| table.solved(s)[0]);
        let turns = table.line_turns(last, &table.forces, &between)?;
        table.turns = turns;
        table.close()?;
        Some(table)
    }

    /// Frequency \[rad/s\] of the last place.
    pub(super) fn highest(&self) -> f64 {
        self.last as f64 * self.step
    }

    /// Lowest tabulated frequency \[rad/s\] from which a feedback that is bounded by `bound` has no roots with growth; absent if there is none.
    pub(super) fn quiet_from(&self, bound: impl Fn(f64, [f64; 2]) -> f64) -> Option<f64> {
        let noisy = self.bounds.iter().rposition(|&(omega, of_string)| {
            bound(omega, of_string).is_nan() || bound(omega, of_string) >= 0.99
        });
        self.bounds.get(noisy.map_or(0, |place| place + 1)).map(|(omega, _)| *omega)
    }

    /// The products at a complex frequency, by waves.
    pub(super) fn solved(&self, s: Complex<f64>) -> Products {
        scaled_products(&self.chains, s)
    }

    /// A function by its values at the places, conjugate below zero, at a complex frequency; absent beyond the values, and too far from the line.
    pub(super) fn interpolated(&self, values: &[Complex<f64>], s: Complex<f64>) -> Option<Complex<f64>> {
        let x = Complex::new(s.im, NEUTRAL - s.re) / self.step;
        let first = x.re.floor() as i64 - (STENCIL as i64 / 2 - 1);
        if !(x.im.abs() <= FARTHEST && first + STENCIL as i64 <= values.len() as i64 && s.im >= 0.0) {
            return None;
        }
        let (mut sum, mut scale) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for (k, weight) in self.weights.iter().enumerate() {
            let place = first + k as i64;
            let value = values[place.unsigned_abs() as usize];
            let value = if place < 0 { value.conj() } else { value };
            let away = Complex::new(x.re - place as f64, x.im);
            let square = away.norm_sqr();
            if square == 0.0 {
                return Some(value);
            }
            let factor = away.conj() * (weight / square);
            scale += factor;
            sum += factor * value;
        }
        Some(sum / scale)
    }

    /// Turns of the phase of a function from zero to each of the places up to `last`; `None` if the line runs into a zero.
    fn line_turns(
        &self,
        last: usize,
        values: &[Complex<f64>],
        between: &impl Fn(Complex<f64>) -> Complex<f64>,
    ) -> Option<Vec<f64>> {
        let steps: Vec<Complex<f64>> = (0..last).map(|i| values[i + 1] * values[i].conj()).collect();
        let sizes: Vec<f64> = (0..=last).map(|i| values[i].norm_sqr()).collect();
        let mut turns = vec![0.0; last + 1];
        for place in 0..last {
            let near = place.saturating_sub(1)..(place + 2).min(last);
            let is_smooth = near.into_iter().all(|i| is_small(steps[i], sizes[i], sizes[i + 1]));
            let turn = if is_smooth { steps[place].arg() } else { self.turn_between(place, between)? };
            turns[place + 1] = turns[place] + turn;
        }
        Some(turns)
    }

    /// Turn of the phase of a function between a place and the next.
    pub(super) fn turn_between(
        &self,
        place: usize,
        function: &impl Fn(Complex<f64>) -> Complex<f64>,
    ) -> Option<f64> {
        let at = |omega: f64| Complex::new(NEUTRAL, omega);
        let [start, end] = [place, place + 1].map(|place| place as f64 * self.step);
        turn(&|omega| function(at(omega)), [start, end], MOST_HALVINGS)
    }

    /// Fills the closing line and counts the growing motions of the string by itself.
    fn close(&mut self) -> Option<()> {
        let highest = self.highest();
        let [first, last] = [CLOSING_ENDS[0] * self.step, CLOSING_ENDS[1] * highest];
        let ratio = (last / first).ln() / f64::from(CLOSING_PLACES - 1);
        let growths = (0..CLOSING_PLACES).map(|k| first * (f64::from(k) * ratio).exp());
        let mut before: Option<Complex<f64>> = None;
        let mut turned = 0.0;
        for growth in [NEUTRAL].into_iter().chain(growths) {
            let s = Complex::new(growth, highest);
            let [axial, torsional] = self.chains.each_ref().map(|chain| chain.end(s));
            let forces = axial.force * torsional.force;
            // The factor exp(-g t) of the ends has no zeros, and turns as its damping has it.
            turned += before.map_or(0.0, |before| (forces * before.conj()).arg());
            if before.is_some_and(|before| (forces * before.conj()).arg().abs() > FRAC_PI_2) {
                return None;
            }
            before = Some(forces);
            self.closing
                .push((s, [axial.displacement / axial.force, torsional.displacement / torsional.force]));
        }
        turned -= before?.arg();
        let line = self.turns.last()? - excess(&self.chains, Complex::new(NEUTRAL, highest)).im;
        let count = -(line + turned) / PI;
        self.own_growing = whole(count)?;
        Some(())
    }
}

/// A count from a turn; absent if it is no whole number.
pub(super) fn whole(count: f64) -> Option<i64> {
    let rounded = count.round();
    ((count - rounded).abs() < 0.05).then_some(rounded as i64)
}

/// True if a function between two places turns little and keeps its size: no zero is near.
pub(super) fn is_small(step: Complex<f64>, size: f64, next: f64) -> bool {
    step.im.abs() <= SMALL_TURN.tan() * step.re && next <= SMALL_RATIO * size && size <= SMALL_RATIO * next
}

/// Exponent of the factor of the products that the ends of the chains do not have. Without it ends turn by exp(-g t), which bends at s = 0 and -alpha; with it by
/// exp(s t - s t / sqrt(1 + beta s)), which is smooth.
fn excess(chains: &[Chain; 2], s: Complex<f64>) -> Complex<f64> {
    chains.iter().map(|chain| chain.excess(s)).sum()
}

/// Products of the ends of two chains, times the smooth factor of both.
fn scaled_products(chains: &[Chain; 2], s: Complex<f64>) -> Products {
    let [axial, torsional] = chains.each_ref().map(|chain| chain.end(s));
    let scale = excess(chains, s).exp();
    [
        axial.force * torsional.force * scale,
        axial.displacement * torsional.force * scale,
        torsional.displacement * axial.force * scale,
    ]
}

/// Bounds of both receptances from frequencies on, up to the highest.
fn bounds(chains: &[Chain; 2], highest: f64) -> Vec<(f64, [f64; 2])> {
    const PLACES: u32 = 80;
    let frequency = |k: u32| highest * (1.07_f64).powi(k as i32 - PLACES as i32 + 1);
    (0..PLACES).map(|k| (frequency(k), chains.each_ref().map(|chain| chain.bound(frequency(k))))).collect()
}

/// Turn of the phase of a function of a frequency along an interval.
fn turn(function: &impl Fn(f64) -> Complex<f64>, [start, end]: [f64; 2], halvings: usize) -> Option<f64> {
    // Ends are the same bits as those of the neighbours.
    let at = |place: f64| match place {
        0.0 => start,
        1.0 => end,
        _ => start + (end - start) * place,
    };
    let values = PLACES.map(|place| function(at(place)));
    let steps = [0, 1, 2, 3].map(|i| values[i + 1] * values[i].conj());
    let sizes = values.map(|value| value.norm_sqr());
    if (0..4).all(|i| is_small(steps[i], sizes[i], sizes[i + 1])) {
        return Some(steps.iter().map(|step| step.arg()).sum());
    }
    let fewer = halvings.checked_sub(1)?;
    let middle = at(PLACES[2]);
    Some(turn(function, [start, middle], fewer)? + turn(function, [middle, end], fewer)?)
}
