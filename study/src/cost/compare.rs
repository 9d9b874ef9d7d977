//! Comparison of a row of a study with the reference: statistics with their intervals, spectral lines, histories.

use drillsweep_scenario::StudyReference;

use super::interval::contrast;
use super::measure::Measure;
use super::results::{
    Agreement, CostErrors, LineErrors, NamedLine, NodeAgreement, NodeStatistic, Quantity, SpuriousLine,
    StatisticError,
};
use crate::ensemble::spread;
use drillsweep_sim::math::signal::{FullSpectrum, Peak, PeakSearch};
use drillsweep_sim::solve::run::NodeHistory;

/// Search for lines of the reference in other runs: the number of the strongest ones, and their least distance \[Hz\].
const NAMED_LINES: PeakSearch = PeakSearch { count: 3, min_separation_hz: 0.5, exclude_mean: true };

/// Search for lines of a run in the reference.
const ALL_LINES: PeakSearch = PeakSearch { count: usize::MAX, min_separation_hz: 0.5, exclude_mean: true };

/// Distance below which two lines are the same \[Hz\]; with wider bins, the width of a bin.
const SAME_LINE_HZ: f64 = 0.3;

/// Least height of a line, over the reference's highest.
const LOWEST_LINE: f64 = 0.05;

/// Least height at which a line of one spectrum counts as present in the other, compared with it.
const PRESENT: f64 = 0.5;

/// Largest number of spurious lines that a report names for each node, the highest first.
const MOST_SPURIOUS: usize = 10;

/// The members of one row of a study.
pub(super) type Ensemble<'a> = &'a [&'a Measure];

/// Reference of a comparison: the mean of one or two ensembles.
#[derive(Clone, Copy)]
pub(super) struct Reference<'a> {
    /// The ensembles; neither the list nor any of them is empty.
    parts: &'a [Vec<&'a Measure>],
}

impl<'a> Reference<'a> {
    /// The reference of some ensembles; `None` without an ensemble, or if one is without a member.
    pub(super) fn new(parts: &'a [Vec<&'a Measure>]) -> Option<Self> {
        (!parts.is_empty() && parts.iter().all(|part| !part.is_empty())).then_some(Self { parts })
    }

    /// A member of its first ensemble.
    fn first(self) -> &'a Measure {
        self.parts[0][0]
    }

    fn nodes(self, quantity: Quantity) -> usize {
        match quantity.is_of_string() {
            true => usize::from(self.first().contact_force.is_some()),
            false => self.first().nodes.len(),
        }
    }

    fn measured_depth(self, quantity: Quantity, node: usize) -> Option<f64> {
        let node = self.first().nodes.get(node).filter(|_| !quantity.is_of_string());
        node.map(|node| node.measured_depth)
    }

    /// The errors of an ensemble in the quantities with a reference; histories up to `horizon` \[s\].
    pub(super) fn errors(
        self,
        of: Ensemble<'_>,
        has_reference: impl Fn(Quantity, usize) -> bool,
        horizon: f64,
    ) -> Option<CostErrors> {
        let first = of.first()?;
        let statistic = |quantity| self.statistic_error(of, quantity, |node| has_reference(quantity, node));
        let most = |value: fn(&Measure) -> Option<f64>| {
            of.iter().filter_map(|member| value(member)).reduce(f64::max)
        };
        let reference = self.first();
        Some(CostErrors {
            orbit_size: statistic(Quantity::OrbitSize),
            radius_deviation: statistic(Quantity::RadiusDeviation),
            mean_radius: statistic(Quantity::MeanRadius),
            contact_force: statistic(Quantity::ContactForce),
            torsional_speed: statistic(Quantity::TorsionalSpeed),
            lines: has_reference(Quantity::Lines, 0).then(|| self.line_errors(of)).flatten(),
            trajectory: trajectory_error(
                &first.histories,
                &reference.histories,
                (horizon * first.rate_hz) as usize,
            ),
            static_position: static_position(first, reference),
            friction_coefficient: friction_coefficient(first, reference),
            energy: most(|member| member.energy),
            estimate: most(|member| Some(member.error_estimate)).unwrap_or(0.0),
        })
    }

    /// Bias, interval and spread of one statistic at the nodes that have a reference; absent without any.
    fn statistic_error(
        self,
        of: Ensemble<'_>,
        quantity: Quantity,
        has_reference: impl Fn(usize) -> bool,
    ) -> Option<StatisticError> {
        let weight = -1.0 / self.parts.len() as f64;
        let at = |node: usize| {
            let own = values(of, quantity, node);
            let parts: Vec<_> = self.parts.iter().map(|part| values(part, quantity, node)).collect();
            let against = parts.iter().map(|part| (weight, part.as_slice()));
            let terms: Vec<_> = std::iter::once((1.0, own.as_slice())).chain(against).collect();
            let difference = contrast(&terms);
            let reference = -contrast(&terms[1..]).value;
            let size = reference.abs().max(quantity.floor());
            let deviations = parts.iter().filter(|part| part.len() > 1).filter_map(|part| spread(part));
            let squares: Vec<_> = deviations.map(|(_, deviation)| deviation * deviation).collect();
            let reference_spread = (squares.len() == parts.len())
                .then(|| (squares.iter().sum::<f64>() / parts.len() as f64).sqrt());
            NodeStatistic {
                measured_depth: self.measured_depth(quantity, node),
                reference,
                value: reference + difference.value,
                bias: difference.value / size,
                half_width: difference.half_width.map(|width| width / size),
                spread: spread(&own).filter(|_| own.len() > 1).map(|(_, deviation)| deviation / size),
                reference_spread: reference_spread.map(|spread| spread / size),
            }
        };
        let nodes = (0..self.nodes(quantity)).filter(|&node| has_reference(node));
        let nodes: Vec<NodeStatistic> = nodes.map(at).collect();
        let worst = nodes.iter().max_by(|a, b| a.bound().total_cmp(&b.bound()))?;
        Some(StatisticError {
            bias: worst.bias,
            half_width: worst.half_width,
            spread: worst.spread,
            significant: worst.half_width.map(|width| worst.bias.abs() > width),
            measured_depth: worst.measured_depth,
            nodes,
        })
    }

    /// The reference's lines in an ensemble's mean spectra, and spurious lines there; absent without
    /// spectra.
    fn line_errors(self, of: Ensemble<'_>) -> Option<LineErrors> {
        let mut errors =
            LineErrors { frequency_hz: None, amplitude: 0.0, missing: 0, named: vec![], spurious: vec![] };
        for node in 0..self.first().nodes.len() {
            let depth = self.first().nodes[node].measured_depth;
            let own = mean_spectrum([of], node)?;
            let reference = mean_spectrum(self.parts.iter().map(Vec::as_slice), node)?;
            compare_lines(depth, &own, &reference, &mut errors);
        }
        Some(errors)
    }
}

/// Agreement of the two methods of a reference in each quantity.
pub(super) fn agreements(a: Ensemble<'_>, b: Ensemble<'_>, asked: &StudyReference) -> Vec<Agreement> {
    let parts = [[a.to_vec()], [b.to_vec()]];
    let [Some(of_a), Some(of_b)] = parts.each_ref().map(|part| Reference::new(part)) else {
        return Vec::new();
    };
    let agreement = |&quantity: &Quantity| {
        let bound = if quantity.is_deviation() { asked.deviation_agreement } else { asked.size_agreement };
        let node = |measured_depth, values, difference: f64| NodeAgreement {
            measured_depth,
            values,
            difference: difference.abs(),
            has_reference: difference.abs() <= bound,
        };
        let (mut nodes, half_width, has_same_lines): (Vec<_>, _, _) = if quantity == Quantity::Lines {
            let (lines, back) = (of_a.line_errors(b)?, of_b.line_errors(a)?);
            let named = lines.named.iter().map(|line| {
                let of_b = line.amplitude * (1.0 + line.amplitude_error);
                node(Some(line.measured_depth), [line.amplitude, of_b], line.amplitude_error)
            });
            let is_same = lines.missing == 0 && lines.spurious.is_empty() && back.spurious.is_empty();
            (named.collect(), None, Some(is_same))
        } else {
            let error = of_a.statistic_error(b, quantity, |_| true)?;
            let nodes = error.nodes.iter();
            let nodes =
                nodes.map(|found| node(found.measured_depth, [found.reference, found.value], found.bias));
            (nodes.collect(), error.half_width, None)
        };
        let difference = nodes.iter().fold(0.0_f64, |most, node| most.max(node.difference));
        let has_reference = match has_same_lines {
            Some(is_same) => is_same && difference <= bound,
            None => nodes.iter().any(|node| node.has_reference),
        };
        if has_same_lines.is_some() {
            nodes.iter_mut().for_each(|node| node.has_reference = has_reference);
        }
        Some(Agreement { quantity, difference, half_width, bound, has_reference, nodes })
    };
    Quantity::ALL.iter().filter_map(agreement).collect()
}

fn values(of: Ensemble<'_>, quantity: Quantity, node: usize) -> Vec<f64> {
    of.iter().map(|member| member.statistic(quantity, node)).collect()
}

/// The mean over ensembles of the mean over their members of a node's amplitudes; absent without spectra, or if their
/// frequencies differ.
fn mean_spectrum<'a>(ensembles: impl IntoIterator<Item = Ensemble<'a>>, node: usize) -> Option<FullSpectrum> {
    let mut sum: Option<FullSpectrum> = None;
    let ensembles: Vec<_> = ensembles.into_iter().collect();
    for ensemble in &ensembles {
        let weight = 1.0 / (ensembles.len() * ensemble.len()) as f64;
        for member in *ensemble {
            let spectrum = member.nodes.get(node)?.spectrum.as_ref()?;
            let sum = sum.get_or_insert_with(|| FullSpectrum {
                amplitude: vec![0.0; spectrum.amplitude.len()],
                ..spectrum.clone()
            });
            if sum.amplitude.len() != spectrum.amplitude.len() {
                return None;
            }
            for (sum, amplitude) in sum.amplitude.iter_mut().zip(&spectrum.amplitude) {
                *sum += weight * amplitude;
            }
        }
    }
    sum
}

fn compare_lines(measured_depth: f64, own: &FullSpectrum, reference: &FullSpectrum, errors: &mut LineErrors) {
    let named = reference.peaks(&NAMED_LINES);
    let Some(highest) = named.first().map(|line| line.amplitude).filter(|&highest| highest > 0.0) else {
        return;
    };
    let reach = SAME_LINE_HZ.max(reference.resolution_hz);
    let own_lines = own.peaks(&ALL_LINES);
    for line in named.into_iter().filter(|line| line.amplitude >= LOWEST_LINE * highest) {
        // The highest lines come first.
        let is_it = |own: &&Peak| {
            (own.frequency_hz - line.frequency_hz).abs() <= reach && own.amplitude >= PRESENT * line.amplitude
        };
        let found = own_lines.iter().find(is_it);
        let amplitude =
            found.map_or_else(|| amplitude_near(own, line.frequency_hz, reach), |found| found.amplitude);
        let amplitude_error = amplitude / line.amplitude - 1.0;
        let distance = found.map(|found| (found.frequency_hz - line.frequency_hz).abs());
        errors.frequency_hz = errors.frequency_hz.into_iter().chain(distance).reduce(f64::max);
        errors.amplitude = errors.amplitude.max(amplitude_error.abs());
        errors.missing += u32::from(found.is_none());
        errors.named.push(NamedLine {
            measured_depth,
            frequency_hz: line.frequency_hz,
            amplitude: line.amplitude,
            found_hz: found.map(|found| found.frequency_hz),
            amplitude_error,
        });
    }
    let is_spurious = |amplitude: f64, frequency_hz: f64| {
        amplitude > LOWEST_LINE * highest
            && amplitude_near(reference, frequency_hz, reach) < PRESENT * amplitude
    };
    let spurious = own_lines.iter().filter(|line| is_spurious(line.amplitude, line.frequency_hz));
    errors.spurious.extend(spurious.take(MOST_SPURIOUS).map(|line| SpuriousLine {
        measured_depth,
        frequency_hz: line.frequency_hz,
        height: line.amplitude / highest,
    }));
}

/// The largest amplitude of a spectrum within `reach` of a frequency \[Hz\].
fn amplitude_near(spectrum: &FullSpectrum, frequency_hz: f64, reach: f64) -> f64 {
    let bins = spectrum.frequency_hz.iter().zip(&spectrum.amplitude);
    let near = bins.filter(|(frequency, _)| (*frequency - frequency_hz).abs() <= reach);
    near.fold(0.0, |most, (_, amplitude)| most.max(*amplitude))
}

/// L2 distance of the first `samples` samples over the motion away from the start; absent if nothing moved.
fn trajectory_error(of: &[NodeHistory], reference: &[NodeHistory], samples: usize) -> Option<f64> {
    let (mut distance, mut motion) = (0.0, 0.0);
    for (a, b) in of.iter().zip(reference) {
        for (a, b) in [(&a.u, &b.u), (&a.v, &b.v)] {
            for (x, y) in a.iter().zip(b).take(samples) {
                distance += (x - y).powi(2);
                motion += (y - b[0]).powi(2);
            }
        }
    }
    (motion > 0.0).then(|| (distance / motion).sqrt())
}

/// Largest distance of a node's static position, over the hole's radius.
fn static_position(of: &Measure, reference: &Measure) -> f64 {
    let distance = |&(depth, [u, v]): &(f64, [f64; 2])| {
        let [u_reference, v_reference] = reference.position_at(depth);
        (u - u_reference).hypot(v - v_reference) / of.hole_radius
    };
    of.position.iter().map(distance).fold(0.0, f64::max)
}

/// Distance of C_f, mean over the string's length; absent without mud.
fn friction_coefficient(of: &Measure, reference: &Measure) -> Option<f64> {
    let (mut distance, mut friction) = (0.0, 0.0);
    for ((bottom, value), (top, _)) in of.friction.iter().zip(&of.position) {
        if let Some(reference) = reference.friction_at(0.5 * (top + bottom)) {
            distance += (bottom - top) * (value - reference).abs();
            friction += (bottom - top) * reference;
        }
    }
    (friction > 0.0).then(|| distance / friction)
}
