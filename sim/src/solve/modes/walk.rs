//! The eigenvalues of a band of frequencies: found around shifts that walk along the imaginary axis, counted, and searched again if
//! the list and the count differ.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::accuracy::Accuracy;
use super::arnoldi::{Eigenpair, around};
use super::count::{Counter, Region};
use super::mode::{Completeness, ModeSearch, ModesError};
use super::pencil::Pencil;

/// Initial size of the Krylov space of one shift.
const DIMENSION: usize = 80;

/// Largest size of that space, for dense eigenvalues.
const LARGEST_DIMENSION: usize = 320;

/// Half the step between two shifts over the radius in which all eigenvalues are known: eigenvalues between two shifts are found up
/// to a growth of 0.7 radii.
const OVERLAP: f64 = 0.7;

/// Shifts along the positive real axis, in radii of the first: static instabilities grow without turning.
const REAL_SHIFTS: [f64; 2] = [1.0, 4.0];

/// Growth up to which eigenvalues are counted, in highest circular frequencies of the band.
const COUNTED_GROWTH: f64 = 2.0;

/// Halvings of the band in the search for missing eigenvalues.
const MOST_HALVINGS: u32 = 6;

/// Distance beyond the band at which its edge may lie, in the radius in which eigenvalues are known: there should be none next to the edge.
const MARGIN: f64 = 0.3;

/// Findings of a walk over a band.
pub(super) struct Found {
    /// All known eigenpairs, in the band and beyond, by frequency; those of negative frequency are their conjugates.
    pairs: Vec<Eigenpair>,
    /// Circular frequency up to which the walk has come \[1/s\].
    pub(super) complete_to: f64,
    /// Growth and decay up to which the walk searched \[1/s\].
    pub(super) rate: f64,
    /// Verdict of the count on that.
    pub(super) completeness: Completeness,
}

impl Found {
    /// The modes of the band: all that vibrate, and those that grow without vibrating.
    pub(super) fn in_band(&self, search: &ModeSearch) -> impl Iterator<Item = &Eigenpair> + Clone {
        let band = TAU * search.from_hz..=TAU * search.to_hz;
        self.pairs
            .iter()
            .filter(move |pair| band.contains(&pair.value.im) && (pair.value.im > 0.0 || pair.value.re > 0.0))
    }

    fn values(&self) -> Vec<Complex<f64>> {
        self.pairs.iter().map(|pair| pair.value).collect()
    }

    fn sorted(mut self) -> Self {
        self.pairs.sort_by(|a, b| a.value.im.total_cmp(&b.value.im).then(a.value.re.total_cmp(&b.value.re)));
        self
    }
}

/// The eigenvalues of a band with their shapes, counted.
pub(super) fn eigenpairs(pencil: &Pencil, search: &ModeSearch) -> Result<Found, ModesError> {
    let mut walk = Walk::along(pencil, search)?;
    walk.found.completeness = walk.count();
    Ok(walk.found.sorted())
}

/// The same without the count, which takes most of the time.
pub(super) fn uncounted_eigenpairs(pencil: &Pencil, search: &ModeSearch) -> Result<Found, ModesError> {
    Ok(Walk::along(pencil, search)?.found.sorted())
}

struct Walk<'a> {
    pencil: &'a Pencil,
    accuracy: Accuracy<'a>,
    counter: Counter<'a>,
    /// The band \[1/s\].
    from: f64,
    to: f64,
    dimension: usize,
    found: Found,
}

impl<'a> Walk<'a> {
    /// A walk that has been along a band.
    fn along(pencil: &'a Pencil, search: &ModeSearch) -> Result<Self, ModesError> {
        let (from_hz, to_hz) = (search.from_hz, search.to_hz);
        if !(from_hz >= 0.0 && to_hz > from_hz && to_hz.is_finite()) {
            return Err(ModesError::Band { from_hz, to_hz });
        }
        let mut walk = Self::new(pencil, TAU * from_hz, TAU * to_hz);
        walk.along_the_band(search)?;
        Ok(walk)
    }

    fn new(pencil: &'a Pencil, from: f64, to: f64) -> Self {
        Self {
            pencil,
            accuracy: Accuracy::new(pencil),
            counter: Counter::new(pencil),
            from,
            to,
            dimension: DIMENSION,
            found: Found {
                pairs: Vec::new(),
                complete_to: from,
                rate: f64::INFINITY,
                completeness: Completeness::NotCounted,
            },
        }
    }

    fn along_the_band(&mut self, search: &ModeSearch) -> Result<(), ModesError> {
        let (from, to) = (self.from, self.to);
        let mut ahead = 0.0;
        while self.found.complete_to < to && self.found.in_band(search).count() < search.most {
            let centre = self.found.complete_to + ahead;
            let missing = ModesError::NotFound { frequency_hz: centre / TAU };
            // An eigenvalue that the shift hits is missed by the next one.
            let nudged = Complex::new(1e-7 * (to + 1.0), centre);
            let radius = self
                .around(Complex::new(0.0, centre), 0)
                .or_else(|| self.around(nudged, 0))
                .ok_or(missing)?;
            let reach = OVERLAP * radius;
            if centre - reach > self.found.complete_to {
                // Denser than expected: come back nearer, at last with a larger space.
                ahead = 0.5 * reach;
                if reach < 1e-4 * (to - from) {
                    self.enlarge().ok_or(missing)?;
                }
                continue;
            }
            if reach < 1e-6 * (to - from) {
                self.enlarge().ok_or(missing)?;
                continue;
            }
            if centre == 0.0 {
                for factor in REAL_SHIFTS {
                    let _ = self.around(Complex::new((factor * radius).min(1e4), 0.0), 0);
                }
            }
            self.found.complete_to = centre + reach;
            self.found.rate = self.found.rate.min(reach);
            ahead = 0.95 * reach;
        }
        Ok(())
    }

    /// A larger Krylov space for the shifts that follow; `None` if it may not grow further.
    fn enlarge(&mut self) -> Option<()> {
        self.dimension = Some(2 * self.dimension).filter(|&dimension| dimension <= LARGEST_DIMENSION)?;
        Some(())
    }

    /// Takes in the eigenpairs around a shift, and returns the radius within which they are complete; `None` as [`around`].
    fn around(&mut self, shift: Complex<f64>, start: u64) -> Option<f64> {
        let near = around(shift, self.pencil, self.dimension, start)?;
        for pair in near.pairs {
            self.take(pair);
        }
        Some(near.radius)
    }

    /// Takes in a pair that is new and satisfies the equation of motion.
    fn take(&mut self, mut pair: Eigenpair) {
        let Eigenpair { value, shape } = &mut pair;
        if !value.norm().is_finite() {
            return;
        }
        if value.im.abs() <= 1e-6 * value.norm() {
            value.im = 0.0;
        } else if value.im < 0.0 {
            *value = value.conj();
            shape.iter_mut().for_each(|x| *x = x.conj());
        }
        normalise(shape);
        let judgement = self.accuracy.judge(&pair);
        if !judgement.believed {
            return;
        }
        // Equal eigenvalues have as many modes as independent shapes.
        let size = pair.value.norm();
        let equal = 1e-6 * size.max(1e-3 * self.to);
        let tolerance = equal.max(judgement.uncertainty.min(1e-3 * size));
        let mut rest = pair.shape.clone();
        let mut has_equal = false;
        for other in &self.found.pairs {
            let apart = (other.value - pair.value).norm();
            if apart > tolerance {
                continue;
            }
            has_equal |= apart <= equal;
            let common: Complex<f64> = other.shape.iter().zip(&rest).map(|(a, b)| a.conj() * b).sum();
            for (value, other) in rest.iter_mut().zip(&other.shape) {
                *value -= common * other;
            }
        }
        if rest.iter().map(Complex::norm_sqr).sum::<f64>() > 0.01 {
            if has_equal {
                normalise(&mut rest);
                pair.shape = rest;
            }
            self.found.pairs.push(pair);
        }
    }

    /// Counts the eigenvalues of the band as far as the walk has come, and searches again if some are missing.
    fn count(&mut self) -> Completeness {
        let top = self.found.complete_to.min(self.to);
        if top <= self.from {
            return Completeness::NotCounted;
        }
        let decay = self.found.rate.min(10.0 * self.to);
        let margin = MARGIN * decay;
        let values = self.found.values();
        // Edges lie halfway to the next eigenvalue beyond the band.
        let next =
            values.iter().map(|value| value.im - top).filter(|gap| *gap > 0.0).fold(2.0 * margin, f64::min);
        let previous = values
            .iter()
            .map(|value| self.from - value.im)
            .filter(|gap| *gap > 0.0)
            .fold(2.0 * margin, f64::min);
        let bottom = if self.from > 0.0 { (self.from - 0.5 * previous).max(0.0) } else { 0.0 };
        let region = Region {
            growth: [-decay, COUNTED_GROWTH * self.to.max(decay)],
            frequency: [bottom, top + 0.5 * next],
        };
        let Some(missing) = self.counter.beyond(&values, &region) else { return Completeness::NotCounted };
        let missing = self.find_missing(&region, missing + region.holds(&values), MOST_HALVINGS);
        let count = missing.unsigned_abs() as usize;
        match missing {
            0 => Completeness::Counted,
            ..0 => Completeness::Excess(count),
            _ => Completeness::Missing(count),
        }
    }

    /// Searches a region of `total` eigenvalues until all are known, from its middle with other start vectors and then in halves; returns
    /// the number still missing.
    fn find_missing(&mut self, region: &Region, total: i64, halvings: u32) -> i64 {
        let missing = total - region.holds(&self.found.values());
        if missing <= 0 {
            return missing;
        }
        let [bottom, top] = region.frequency;
        let start = u64::from(MOST_HALVINGS - halvings) + 1;
        for growth in [0.0, 0.5 * region.growth[0], 0.5 * region.growth[1]] {
            self.around(Complex::new(growth, 0.5 * (bottom + top)), start);
        }
        let values = self.found.values();
        let missing = total - region.holds(&values);
        if missing <= 0 || halvings == 0 {
            return missing;
        }
        // Away from known eigenvalues, in the middle half.
        let quarter = 0.25 * (top - bottom);
        let middle = bottom + quarter..=top - quarter;
        let mut stops: Vec<f64> =
            values.iter().map(|value| value.im).filter(|im| middle.contains(im)).collect();
        stops.extend([*middle.start(), *middle.end()]);
        stops.sort_by(f64::total_cmp);
        let gaps = stops.windows(2).map(|ends| (ends[1] - ends[0], 0.5 * (ends[0] + ends[1])));
        let Some((_, cut)) = gaps.max_by(|a, b| a.0.total_cmp(&b.0)) else { return missing };
        let below = Region { frequency: [bottom, cut], ..*region };
        let above = Region { frequency: [cut, top], ..*region };
        // Of both signs in the whole region, and of one in its upper half.
        let conjugates = if bottom == 0.0 { 2 } else { 1 };
        let Some(unknown) = self.counter.beyond(&values, &below) else { return missing };
        let total_below = unknown + below.holds(&values);
        let total_above = (total - total_below) / conjugates;
        self.find_missing(&below, total_below, halvings - 1)
            + conjugates * self.find_missing(&above, total_above, halvings - 1)
    }
}

fn normalise(shape: &mut [Complex<f64>]) {
    let size = shape.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
    shape.iter_mut().for_each(|value| *value /= size);
}
