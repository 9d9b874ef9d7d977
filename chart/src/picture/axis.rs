//! Axes of plots: positions of values and of ticks.

/// Length of an axis beyond the values at each end, as a part of the span of the values.
const PADDING: f64 = 0.06;
/// The largest magnitude on a linear axis, so that no span overflows.
const LARGEST: f64 = 1e300;
/// Labelled decades on a logarithmic axis, at most.
const LABELLED_DECADES: f64 = 10.0;
/// Steps on a linear axis, about.
const LINEAR_STEPS: f64 = 6.0;

/// One axis of a plot. It covers the values that it was made for, with some room at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlotAxis {
    scale: Scale,
    /// The ends: decimal logarithms of values if the scale is logarithmic, else the values.
    low: f64,
    high: f64,
    /// True if it runs from its high end to its low one.
    is_flipped: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Logarithmic,
    Linear,
}

/// A tick of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The place along the axis: 0 is its low end, 1 its high end.
    pub fraction: f64,
    /// The value in print; minor ticks have none.
    pub label: Option<String>,
}

impl PlotAxis {
    /// A logarithmic axis over the values that have a place on one: positive and finite. It is at least a
    /// decade long, whatever the values. None if no value has a place.
    pub fn logarithmic(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (low, high) =
            extent(values.into_iter().filter_map(|value| Scale::Logarithmic.coordinate(value)))?;
        let span = ((high - low) * (1.0 + 2.0 * PADDING)).max(1.0);
        Some(Self::around(Scale::Logarithmic, (low + high) / 2.0, span))
    }

    /// A linear axis over the values that are finite; magnitudes beyond 1e300 count as 1e300. It has a length
    /// even if the values are equal. None if no value is finite.
    pub fn linear(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (low, high) = extent(values.into_iter().filter_map(|value| Scale::Linear.coordinate(value)))?;
        let magnitude = low.abs().max(high.abs());
        let shortest = if magnitude < 1.0 / LARGEST { 1.0 } else { magnitude * 1e-6 };
        let span = ((high - low) * (1.0 + 2.0 * PADDING)).max(shortest);
        Some(Self::around(Scale::Linear, f64::midpoint(low, high), span))
    }

    /// A linear axis from the least to the greatest of the values that are finite, without room at the ends. None if
    /// no value is finite.
    pub fn tight(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (low, high) = extent(values.into_iter().filter_map(|value| Scale::Linear.coordinate(value)))?;
        Self::between(low, high).or_else(|| Self::linear([low]))
    }

    /// A linear axis from zero to somewhat above the greatest of the values that are finite. None if no value is.
    pub fn from_zero(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (_, high) = extent(values.into_iter().filter_map(|value| Scale::Linear.coordinate(value)))?;
        Self::between(0.0, high * (1.0 + 2.0 * PADDING)).or_else(|| Self::between(0.0, 1.0))
    }

    /// A linear axis from end to end. None if the ends are not finite, or have no values between them that are distinguishable.
    pub fn between(low: f64, high: f64) -> Option<Self> {
        let (low, high) = (Scale::Linear.coordinate(low)?, Scale::Linear.coordinate(high)?);
        let magnitude = low.abs().max(high.abs());
        let is_long_enough = high - low > magnitude * 1e-9 && magnitude >= 1.0 / LARGEST;
        is_long_enough.then_some(Self { scale: Scale::Linear, low, high, is_flipped: false })
    }

    /// The same axis from its high end to its low one, as for depth.
    #[must_use]
    pub fn downwards(self) -> Self {
        Self { is_flipped: true, ..self }
    }

    fn around(scale: Scale, middle: f64, span: f64) -> Self {
        Self { scale, low: middle - span / 2.0, high: middle + span / 2.0, is_flipped: false }
    }

    /// The place of a value along the axis: 0 is the low end, 1 the high end; values beyond an end lie
    /// outside. None if the value has no place on this scale: it is not finite, or not positive on a
    /// logarithmic axis.
    pub fn fraction(&self, value: f64) -> Option<f64> {
        self.scale.coordinate(value).map(|coordinate| self.fraction_of_coordinate(coordinate))
    }

    /// The ticks, from low to high. On a logarithmic axis decades are labelled, as are 2 and 5 times the
    /// decade if there are few decades.
    pub fn ticks(&self) -> Vec<Tick> {
        match self.scale {
            Scale::Logarithmic => self.logarithmic_ticks(),
            Scale::Linear => self.linear_ticks(),
        }
    }

    fn fraction_of_coordinate(&self, coordinate: f64) -> f64 {
        let fraction = (coordinate - self.low) / (self.high - self.low);
        if self.is_flipped { 1.0 - fraction } else { fraction }
    }

    fn logarithmic_ticks(&self) -> Vec<Tick> {
        let span = self.high - self.low;
        let stride = (span / LABELLED_DECADES).ceil() as i32;
        let labels = if span < 2.0 { &[1, 2, 5][..] } else { &[1] };
        let minor_last = if span < 7.0 { 9 } else { 1 };
        let exponents = self.low.floor() as i32..=self.high.floor() as i32;
        let plain = self.low >= -3.5 && self.high <= 4.0;

        let mut ticks = Vec::new();
        for exponent in exponents.filter(|exponent| exponent.rem_euclid(stride) == 0) {
            for mantissa in 1..=minor_last {
                let coordinate = f64::from(exponent) + f64::from(mantissa).log10();
                if (self.low..=self.high).contains(&coordinate) {
                    let label = labels.contains(&mantissa).then(|| decimal(mantissa, exponent, plain));
                    ticks.push(Tick { fraction: self.fraction_of_coordinate(coordinate), label });
                }
            }
        }
        ticks
    }

    fn linear_ticks(&self) -> Vec<Tick> {
        let coarse = (self.high - self.low) / LINEAR_STEPS;
        let decade = coarse.log10().floor();
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|mantissa| mantissa * 10f64.powf(decade))
            .into_iter()
            .find(|step| *step >= coarse)
            .unwrap_or(coarse);
        let largest = self.low.abs().max(self.high.abs());
        let plain = (1e-4..1e6).contains(&largest);
        // The step is 1, 2 or 5 times a power of ten, whose logarithm may come out a hair too small.
        let step_decade = (step.log10() + 1e-9).floor();
        let decimals = -step_decade.min(0.0) as usize;

        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last)
            .map(|count| {
                let value = count as f64 * step;
                let label = if count == 0 {
                    "0".to_owned()
                } else if plain {
                    format!("{value:.decimals$}")
                } else {
                    scientific(value, (largest.log10().floor() - step_decade).max(0.0) as usize)
                };
                Tick { fraction: self.fraction_of_coordinate(value), label: Some(label.replace('-', "−")) }
            })
            .collect()
    }
}

impl Scale {
    fn coordinate(self, value: f64) -> Option<f64> {
        match self {
            Scale::Logarithmic => (value.is_finite() && value > 0.0).then(|| value.log10()),
            Scale::Linear => value.is_finite().then(|| value.clamp(-LARGEST, LARGEST)),
        }
    }
}

/// A value in three digits: plain if that is short, else in powers of ten.
pub(crate) fn three_digits(value: f64) -> String {
    let magnitude = value.abs();
    let text = if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&magnitude) {
        let decimals = (2.0 - magnitude.log10().floor()).max(0.0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        scientific(value, 2)
    };
    text.replace('-', "−")
}

fn extent(coordinates: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    coordinates.map(|coordinate| (coordinate, coordinate)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// A one-digit multiple of a power of ten, as a plain decimal or in powers.
fn decimal(mantissa: i32, exponent: i32, plain: bool) -> String {
    match (plain, mantissa) {
        (true, _) if exponent < 0 => {
            format!("{:.*}", exponent.unsigned_abs() as usize, f64::from(mantissa) * 10f64.powi(exponent))
        }
        (true, _) => format!("{mantissa}{}", "0".repeat(exponent.unsigned_abs() as usize)),
        (false, 1) => format!("10{}", superscript(exponent)),
        (false, _) => format!("{mantissa}×10{}", superscript(exponent)),
    }
}

/// A value in powers of ten with at most `digits` digits after the point, without zeros at the end.
fn scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    format!("{mantissa}×10{}", superscript(exponent.parse().unwrap_or(0)))
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|sign| match sign {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            '9' => '⁹',
            _ => '⁰',
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &PlotAxis) -> Vec<String> {
        axis.ticks().into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn a_logarithmic_axis_is_linear_in_the_exponent() {
        let axis = PlotAxis::logarithmic([1e-6, 1e-2]).expect("an axis");
        let places = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2].map(|value| axis.fraction(value).expect("a place"));
        for pair in places.windows(2) {
            assert!((pair[1] - pair[0] - 1.0 / (4.0 * (1.0 + 2.0 * PADDING))).abs() < 1e-12);
        }
        assert!(places[0] > 0.0 && places[4] < 1.0);
        assert_eq!(axis.fraction(0.0), None);
        assert_eq!(axis.fraction(-1.0), None);
        assert_eq!(axis.fraction(f64::NAN), None);
        assert_eq!(axis.fraction(f64::INFINITY), None);
    }

    #[test]
    fn decades_are_labelled_at_their_places() {
        let axis = PlotAxis::logarithmic([2e-6, 4e-2]).expect("an axis");
        assert_eq!(labels(&axis), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
        let marked: Vec<_> = axis.ticks().into_iter().filter(|tick| tick.label.is_some()).collect();
        for (tick, value) in marked.iter().zip([1e-5, 1e-4, 1e-3, 1e-2]) {
            assert!((tick.fraction - axis.fraction(value).expect("a place")).abs() < 1e-12);
        }
        assert_eq!(labels(&PlotAxis::logarithmic([0.02, 30.0]).expect("an axis")), ["0.1", "1", "10"]);
    }

    #[test]
    fn few_decades_have_labels_between() {
        let axis = PlotAxis::logarithmic([3e-3, 2e-2]).expect("an axis");
        assert_eq!(labels(&axis), ["0.005", "0.01", "0.02"]);
        let axis = PlotAxis::logarithmic([3e-7, 2e-6]).expect("an axis");
        assert_eq!(labels(&axis), ["5×10⁻⁷", "10⁻⁶", "2×10⁻⁶"]);
    }

    #[test]
    fn one_value_and_extreme_values_have_an_axis_with_few_labels() {
        let cases: [&[f64]; 6] =
            [&[1.0], &[5e-324], &[f64::MAX], &[3.0, 3.0, 3.0], &[5e-324, f64::MAX], &[0.0, f64::NAN, 7.0]];
        for values in cases {
            let axis = PlotAxis::logarithmic(values.iter().copied()).expect("an axis");
            assert!(axis.high - axis.low >= 1.0);
            let labels = labels(&axis);
            assert!((1..=12).contains(&labels.len()), "{values:?}: {labels:?}");
            assert!(axis.ticks().iter().all(|tick| (0.0..=1.0).contains(&tick.fraction)));
        }
        assert_eq!(PlotAxis::logarithmic([0.0, -1.0, f64::NAN, f64::INFINITY]), None);
        assert_eq!(PlotAxis::logarithmic([]), None);
    }

    #[test]
    fn linear_ticks_are_round() {
        let axis = PlotAxis::linear([0.0, 200.0]).expect("an axis");
        assert_eq!(labels(&axis), ["0", "50", "100", "150", "200"]);
        let axis = PlotAxis::linear([-0.3, 0.3]).expect("an axis");
        assert_eq!(labels(&axis), ["−0.2", "0", "0.2"]);
        let axis = PlotAxis::linear([0.0, 3e-7]).expect("an axis");
        assert_eq!(labels(&axis), ["0", "1×10⁻⁷", "2×10⁻⁷", "3×10⁻⁷"]);
    }

    #[test]
    fn linear_labels_have_the_fewest_distinct_digits() {
        for exponent in -3..=5 {
            for mantissa in 1..=9 {
                let end = f64::from(mantissa) * 10f64.powi(exponent);
                let axis = PlotAxis::linear([0.0, end]).expect("an axis");
                let labelled = axis.ticks().into_iter().filter_map(|tick| Some((tick.fraction, tick.label?)));
                let labelled: Vec<(f64, String)> = labelled.filter(|(_, label)| label != "0").collect();
                for (fraction, label) in &labelled {
                    let value = label.parse().expect("a plain number");
                    assert!((axis.fraction(value).expect("a place") - fraction).abs() < 1e-9, "{label}");
                }
                let wasteful = labelled.iter().all(|(_, label)| label.contains('.') && label.ends_with('0'));
                assert!(!wasteful, "{labelled:?}");
            }
        }
    }

    #[test]
    fn an_axis_of_depth_runs_downwards_from_end_to_end() {
        let axis = PlotAxis::tight([0.0, 50.0, 200.0]).expect("an axis").downwards();
        assert_eq!([0.0, 50.0, 200.0].map(|depth| axis.fraction(depth)), [Some(1.0), Some(0.75), Some(0.0)]);
        let ticks = axis.ticks();
        assert_eq!((ticks[0].fraction, ticks[0].label.as_deref()), (1.0, Some("0")));
        assert_eq!(PlotAxis::from_zero([0.2, 2.0]).expect("an axis").fraction(0.0), Some(0.0));
        for values in [[0.0, 0.0], [-1.0, -2.0], [1e-305, 0.0], [f64::NAN, 0.0]] {
            assert!(PlotAxis::from_zero(values).is_some() && PlotAxis::tight(values).is_some(), "{values:?}");
        }
        assert_eq!(PlotAxis::between(1.0, 1.0), None);
        assert_eq!(PlotAxis::between(0.0, f64::INFINITY), None);
    }

    #[test]
    fn three_digits_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (1200.0, "1200"),
            (0.01, "0.01"),
            (37.4512, "37.5"),
            (-0.33333, "−0.333"),
            (2e-7, "2×10⁻⁷"),
            (123_456.0, "1.23×10⁵"),
        ] {
            assert_eq!(three_digits(value), text);
        }
    }

    #[test]
    fn linear_axes_are_never_degenerate() {
        let cases: [&[f64]; 6] =
            [&[0.0], &[5e-324], &[5.0, 5.0], &[f64::MIN, f64::MAX], &[1e12, 1e12 + 1.0], &[f64::NAN, -3.0]];
        for values in cases {
            let axis = PlotAxis::linear(values.iter().copied()).expect("an axis");
            let labels = labels(&axis);
            assert!((2..=12).contains(&labels.len()), "{values:?}: {labels:?}");
            assert!(labels.windows(2).all(|pair| pair[0] != pair[1]), "{values:?}: {labels:?}");
            assert!(axis.ticks().iter().all(|tick| (0.0..=1.0).contains(&tick.fraction)));
        }
        assert_eq!(PlotAxis::linear([f64::NAN]), None);
    }
}
