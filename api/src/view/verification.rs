//! Results of verifying a sample of a sweep's points: the bias of each statistic against the reference.

use std::fmt;

use drillsweep_quantity::{Name, Quantity, Variant, columns};
use drillsweep_scenario::{PointError, Promise};
use drillsweep_table::{Column, Table};
use indexmap::{IndexMap, IndexSet};
use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Value, json};

use crate::point::PointState;

/// Lengths below this \[m\] are residuals of rounding and of the iteration of the equilibrium, without motion: they have no bias.
const LEAST_LENGTH: f64 = 1e-9;

/// A statistic of a node whose bias is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Statistic {
    OrbitSize,
    RadiusDeviation,
    MeanRadius,
    LineFrequency,
}

impl Statistic {
    const QUANTITIES: [(&'static Quantity, Statistic); 4] = [
        (&columns::ORBIT_RADIUS_RMS, Statistic::OrbitSize),
        (&columns::ORBIT_RADIUS_DEVIATION, Statistic::RadiusDeviation),
        (&columns::ORBIT_MEAN_RADIUS, Statistic::MeanRadius),
        (&columns::LINE_FREQUENCY_HZ, Statistic::LineFrequency),
    ];

    /// Statistic of a field of the summary, if its bias is reported.
    fn of(name: &str) -> Option<Self> {
        let name = Name::parse(name).filter(|name| name.variant == Variant::Value && name.place.is_some())?;
        let is_it = |(quantity, _): &&(&Quantity, Statistic)| *quantity == name.quantity;
        Self::QUANTITIES.iter().find(is_it).map(|(_, statistic)| *statistic)
    }

    /// The bias of a value: relative for lengths, in Hz for frequencies. Which way a line turns does not count: forward and backward
    /// lines of one motion are often nearly alike.
    fn bias(self, value: f64, reference: f64) -> Option<f64> {
        let bias = match self {
            Statistic::LineFrequency => value.abs() - reference.abs(),
            _ if reference < LEAST_LENGTH => return None,
            _ => (value - reference) / reference,
        };
        bias.is_finite().then_some(bias)
    }

    /// Promise for it; none for mean radii and for frequencies.
    fn promised(self, promise: Option<Promise>) -> Option<f64> {
        match self {
            Statistic::OrbitSize => Some(promise?.orbit_size),
            Statistic::RadiusDeviation => Some(promise?.radius_deviation),
            Statistic::MeanRadius | Statistic::LineFrequency => None,
        }
    }
}

/// A point that is verified, and how far that is.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifiedPoint {
    /// Number of the point in its sweep, from 1.
    pub ordinal: u32,
    /// Its parameters, by axis name.
    pub parameters: IndexMap<String, f64>,
    /// The point's own, once it has a result.
    pub statistics: Option<Statistics>,
    /// State of the reference run.
    pub state: PointState,
    /// The reference run's, once it has a result.
    pub reference: Option<Statistics>,
    /// Reason of the reference run's failure, if it failed.
    pub error: Option<PointError>,
}

/// Statistics whose bias is reported, by their names in a summary: read from one, its other members being skipped. Of ensembles they
/// are the means over the members, which the spread of histories troubles least.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Statistics(IndexMap<String, f64>);

/// Written out, because a sweep may have thousands of summaries, of which little is wanted here.
impl<'de> Deserialize<'de> for Statistics {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(StatisticsVisitor)
    }
}

struct StatisticsVisitor;

impl<'de> Visitor<'de> for StatisticsVisitor {
    type Value = Statistics;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a summary")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Statistics, A::Error> {
        let (mut statistics, mut means) = (IndexMap::new(), IndexMap::new());
        while let Some(name) = map.next_key::<String>()? {
            let (name, into) = match Variant::EnsembleMean.strip(&name) {
                Some(of_ensemble) => (of_ensemble, &mut means),
                None => (name.as_str(), &mut statistics),
            };
            if Statistic::of(name).is_none() {
                map.next_value::<IgnoredAny>()?;
            } else if let Some(value) = map.next_value::<Value>()?.as_f64() {
                into.insert(name.to_owned(), value);
            }
        }
        statistics.extend(means);
        Ok(Statistics(statistics))
    }
}

/// Values of one statistic at a verified point.
struct Pair {
    value: f64,
    reference: f64,
    bias: Option<f64>,
}

impl VerifiedPoint {
    /// The statistics that both runs have.
    fn pairs(&self) -> IndexMap<&str, Pair> {
        let (Some(Statistics(own)), Some(Statistics(of_reference))) = (&self.statistics, &self.reference)
        else {
            return IndexMap::new();
        };
        let mut pairs = IndexMap::new();
        for (name, &value) in own {
            if let (Some(statistic), Some(&reference)) = (Statistic::of(name), of_reference.get(name)) {
                pairs
                    .insert(name.as_str(), Pair { value, reference, bias: statistic.bias(value, reference) });
            }
        }
        pairs
    }

    /// The bias of each statistic, by its name in the summary.
    pub fn biases(&self) -> IndexMap<String, f64> {
        let pairs = self.pairs().into_iter();
        pairs.filter_map(|(name, pair)| Some((name.to_owned(), pair.bias?))).collect()
    }
}

/// Bias of one statistic at the verified points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct StatisticBias {
    /// Points at which its bias is known.
    pub verified: usize,
    /// Mean of the biases: relative to the reference, or in Hz of frequencies.
    pub mean: f64,
    /// 95 % confidence interval of the mean over all points, if biases are normally distributed (Student's t); absent for
    /// a single point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// The bias that is farthest from zero.
    pub largest: f64,
    /// The point that has it.
    pub largest_at: u32,
    /// Promise of the sweep's accuracy; absent if it promises nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promised: Option<f64>,
    /// Points whose bias exceeds the promise.
    pub exceeding: usize,
}

/// The bias of orbit size that is farthest from zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct WorstBias {
    /// Name of the statistic in the summary, such as `orbit_radius_rms_49`.
    pub statistic: String,
    /// The point that has it.
    pub ordinal: u32,
    /// The bias, relative to the reference.
    pub bias: f64,
    /// Promise of the sweep's accuracy; absent if it promises nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promised: Option<f64>,
}

/// Findings at the verified points of a sweep.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Statistics by their names in the summary.
    pub statistics: IndexMap<String, StatisticBias>,
    /// Biases beyond the promise, in words.
    pub warnings: Vec<String>,
}

impl Findings {
    /// Findings at these points, of an accuracy with this promise.
    pub fn new(points: &[VerifiedPoint], promise: Option<Promise>) -> Self {
        let mut biases: IndexMap<String, Vec<(u32, f64)>> = IndexMap::new();
        for point in points {
            for (name, bias) in point.biases() {
                biases.entry(name).or_default().push((point.ordinal, bias));
            }
        }
        let statistic = |(name, biases): (String, Vec<(u32, f64)>)| {
            let promised = Statistic::of(&name)?.promised(promise);
            Some((name, StatisticBias::new(&biases, promised)?))
        };
        let statistics: IndexMap<String, StatisticBias> = biases.into_iter().filter_map(statistic).collect();
        let warnings = statistics.iter().filter_map(|(name, statistic)| statistic.warning(name)).collect();
        Self { statistics, warnings }
    }

    /// The bias of orbit size that is farthest from zero.
    pub fn worst_orbit_size(&self) -> Option<WorstBias> {
        let orbit_sizes =
            self.statistics.iter().filter(|(name, _)| Statistic::of(name) == Some(Statistic::OrbitSize));
        let (name, worst) =
            orbit_sizes.max_by(|(_, a), (_, b)| a.largest.abs().total_cmp(&b.largest.abs()))?;
        Some(WorstBias {
            statistic: name.clone(),
            ordinal: worst.largest_at,
            bias: worst.largest,
            promised: worst.promised,
        })
    }

    /// Caption of a picture of a column, below its title: of the column's own bias, else of the worst of orbit size.
    pub fn caption(&self, column: &str) -> Option<String> {
        let (name, bias) = match self.statistics.get_key_value(column) {
            Some((name, bias)) => (name, bias),
            None => self.statistics.get_key_value(&self.worst_orbit_size()?.statistic)?,
        };
        let words = Name::parse(name).map_or_else(|| name.clone(), |name| name.to_string());
        let of = if name == column { String::new() } else { format!(" of {words}") };
        let largest = in_words(name, bias.largest);
        let asked = match bias.promised {
            Some(promised) if bias.exceeding > 0 => format!(", beyond the {} promised", percent(promised)),
            Some(promised) => format!(", within the {} promised", percent(promised)),
            None => String::new(),
        };
        Some(format!("{} verified by the reference: bias{of} up to {largest}{asked}", number(bias.verified)))
    }
}

impl StatisticBias {
    fn new(biases: &[(u32, f64)], promised: Option<f64>) -> Option<Self> {
        let (largest_at, largest) = *biases.iter().max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
        let number = biases.len() as f64;
        let mean = biases.iter().map(|(_, bias)| bias).sum::<f64>() / number;
        let interval = (biases.len() > 1).then(|| {
            let squares: f64 = biases.iter().map(|(_, bias)| (bias - mean) * (bias - mean)).sum();
            let half = student_t_975(biases.len() - 1) * (squares / (number - 1.0) / number).sqrt();
            [mean - half, mean + half]
        });
        let exceeds = |bias: f64| promised.is_some_and(|promised| bias.abs() > promised);
        let exceeding = biases.iter().filter(|(_, bias)| exceeds(*bias)).count();
        Some(Self { verified: biases.len(), mean, interval, largest, largest_at, promised, exceeding })
    }

    fn warning(&self, name: &str) -> Option<String> {
        let promised = self.promised.filter(|_| self.exceeding > 0)?;
        Some(format!(
            "{name}: {} of {} verified exceed the bias of {} that the accuracy promises; the largest is {}, at point {}",
            self.exceeding,
            number(self.verified),
            percent(promised),
            in_words(name, self.largest),
            self.largest_at
        ))
    }
}

/// A bias with its sign, in per cent or Hz.
fn in_words(name: &str, bias: f64) -> String {
    match Statistic::of(name) {
        Some(Statistic::LineFrequency) => format!("{bias:+.2} Hz").replace('-', "−"),
        _ => format!("{:+.2} %", 100.0 * bias).replace('-', "−"),
    }
}

fn percent(part: f64) -> String {
    // 100 times 0.003 has an odd last digit.
    format!("{} %", (1e6 * part).round() / 1e4)
}

fn number(points: usize) -> String {
    format!("{points} {}", if points == 1 { "point" } else { "points" })
}

/// The 97.5 % point of Student's t distribution: from a table, and beyond it by Fisher's expansion (Abramowitz and Stegun 26.7.5),
/// within 3e-4 there.
fn student_t_975(degrees: usize) -> f64 {
    const TABLE: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
    if let Some(value) = degrees.checked_sub(1).and_then(|index| TABLE.get(index)) {
        return *value;
    }
    let (z, n) = (1.959_963_985_f64, degrees as f64);
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + first / n + second / (n * n) + third / (n * n * n)
}

/// One row a verified point: `ordinal`, its parameters, the `state` of the reference run, for each statistic NAME its value, the
/// reference's (`reference_NAME`) and the bias (`bias_NAME`), and the `error` of a reference run that failed.
///
/// The attribute `statistics` has a [`StatisticBias`] by name, `warnings` the texts of [`Findings`].
pub fn verification(points: &[VerifiedPoint], findings: &Findings) -> Table {
    let mut table = Table::default()
        .attribute("statistics", json!(findings.statistics))
        .attribute("warnings", json!(findings.warnings))
        .with(
            &columns::ORDINAL,
            Column::Integer(points.iter().map(|point| Some(point.ordinal.into())).collect()),
        );
    let parameters: IndexSet<&str> =
        points.iter().flat_map(|point| point.parameters.keys().map(String::as_str)).collect();
    for name in parameters {
        let values = points.iter().map(|point| point.parameters.get(name).copied().unwrap_or(f64::NAN));
        table.push(name, Column::Number(values.collect()));
    }
    table.push(
        &columns::STATE,
        Column::Text(points.iter().map(|point| Some(point.state.to_string())).collect()),
    );
    let pairs: Vec<IndexMap<&str, Pair>> = points.iter().map(VerifiedPoint::pairs).collect();
    let names: IndexSet<&str> = pairs.iter().flat_map(|pairs| pairs.keys().copied()).collect();
    for name in names {
        let column = |get: fn(&Pair) -> Option<f64>| {
            let values = pairs.iter().map(|pairs| pairs.get(name).and_then(get).unwrap_or(f64::NAN));
            Column::Number(values.collect())
        };
        table.push(name, column(|pair| Some(pair.value)));
        table.push(Variant::Reference.of(name), column(|pair| Some(pair.reference)));
        table.push(Variant::Bias.of(name), column(|pair| pair.bias));
    }
    let error = |point: &VerifiedPoint| point.error.as_ref().map(|error| error.reason.clone());
    table.with(&columns::ERROR, Column::Text(points.iter().map(error).collect()))
}

/// True if a column of a table is the bias of a statistic.
pub fn is_bias_column(name: &str) -> bool {
    Variant::Bias.strip(name).is_some_and(|statistic| Statistic::of(statistic).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    const STANDARD: Promise = Promise { orbit_size: 0.02, radius_deviation: 0.05 };

    fn point(ordinal: u32, summary: Value, reference: Value) -> VerifiedPoint {
        VerifiedPoint {
            ordinal,
            parameters: [("flow_rate".to_owned(), 0.01 * f64::from(ordinal))].into(),
            state: if reference.is_null() { PointState::Queued } else { PointState::Succeeded },
            statistics: serde_json::from_value(summary).unwrap(),
            reference: serde_json::from_value(reference).unwrap(),
            error: None,
        }
    }

    fn orbit(ordinal: u32, size: f64) -> VerifiedPoint {
        point(ordinal, json!({"orbit_radius_rms_49": size}), json!({"orbit_radius_rms_49": 0.001}))
    }

    #[test]
    fn biases_are_relative_but_for_frequencies_and_absent_at_rest() {
        let of = |name: &str, value: f64, reference: f64| {
            let biases = point(1, json!({ name: value }), json!({ name: reference })).biases();
            biases.get(name).copied()
        };
        assert!((of("orbit_radius_rms_49", 0.00102, 0.001).unwrap() - 0.02).abs() < 1e-12);
        assert!((of("orbit_radius_deviation_282", 0.0009, 0.001).unwrap() + 0.1).abs() < 1e-12);
        assert_eq!(of("orbit_mean_radius_49", 0.037, 0.037), Some(0.0));
        // The sense of the whirl does not count.
        assert_eq!(of("line_frequency_hz_49_w1", -2.25, 2.0), Some(0.25));
        assert_eq!(of("orbit_radius_rms_49", 3e-15, 1e-15), None);
        assert_eq!(of("orbit_radius_rms_49", 1e300, 1e-9), None, "beyond all numbers");
        assert_eq!(of("contact_count", 3.0, 4.0), None);
        // Statistics that one of the two lacks, and runs without a result yet.
        assert!(point(1, json!({"orbit_radius_rms_49": 1.0}), json!({})).biases().is_empty());
        assert!(
            point(1, json!({"orbit_radius_rms_49": null}), json!({"orbit_radius_rms_49": 1.0}))
                .biases()
                .is_empty()
        );
        assert!(point(1, json!({"orbit_radius_rms_49": 1.0}), Value::Null).biases().is_empty());
    }

    #[test]
    fn of_ensembles_the_means_are_compared() {
        let row = |own: f64, mean: f64| json!({"orbit_radius_rms_49": own, "ensemble_mean_orbit_radius_rms_49": mean});
        let biases = point(1, row(0.002, 0.0011), row(0.001, 0.001)).biases();
        assert_eq!(biases.len(), 1);
        assert!((biases["orbit_radius_rms_49"] - 0.1).abs() < 1e-12);
    }

    #[test]
    fn the_mean_has_an_interval_and_a_broken_promise_a_warning() {
        let points = [orbit(3, 0.00101), orbit(8, 0.00095), orbit(9, 0.00103), orbit(12, 0.00099)];
        let findings = Findings::new(&points, Some(STANDARD));
        let found = &findings.statistics["orbit_radius_rms_49"];
        assert_eq!((found.verified, found.largest_at, found.exceeding), (4, 8, 2));
        assert!((found.mean + 0.005).abs() < 1e-12 && (found.largest + 0.05).abs() < 1e-12);
        // Deviations 1.5, -4.5, 3.5, -0.5 %: variance 35/3, of the mean 35/12; t with 3 degrees is 3.182.
        let half = 0.01 * 3.182 * (35.0_f64 / 12.0).sqrt();
        let [low, high] = found.interval.unwrap();
        assert!((low + 0.005 + half).abs() < 1e-12 && (high + 0.005 - half).abs() < 1e-12);
        assert_eq!(
            findings.warnings,
            [
                "orbit_radius_rms_49: 2 of 4 points verified exceed the bias of 2 % that the accuracy promises; \
              the largest is −5.00 %, at point 8"
            ]
        );
        let worst = findings.worst_orbit_size().unwrap();
        assert_eq!((worst.ordinal, worst.promised), (8, Some(0.02)));
        assert_eq!(
            findings.caption("orbit_radius_rms_49").unwrap(),
            "4 points verified by the reference: bias up to −5.00 %, beyond the 2 % promised"
        );
        assert_eq!(
            findings.caption("contact_count").unwrap(),
            "4 points verified by the reference: bias of lateral vibration, node 49 up to −5.00 %, beyond the 2 % promised"
        );

        // A method that promises nothing breaks no promise.
        let findings = Findings::new(&points, None);
        assert!(findings.warnings.is_empty());
        assert_eq!(findings.statistics["orbit_radius_rms_49"].promised, None);
        assert!(findings.caption("contact_count").unwrap().ends_with("up to −5.00 %"));
        // One point has a bias but no interval, and within the promise no warning.
        let findings = Findings::new(&[orbit(3, 0.00101)], Some(STANDARD));
        assert_eq!(findings.statistics["orbit_radius_rms_49"].interval, None);
        assert!(findings.warnings.is_empty());
        assert_eq!(Findings::new(&[], Some(STANDARD)), Findings::default());
        assert_eq!(Findings::default().caption("contact_count"), None);
    }

    #[test]
    fn students_t_agrees_with_tables() {
        // Abramowitz and Stegun, table 26.10, which has three decimals.
        for (degrees, t) in [(1, 12.706), (10, 2.228), (11, 2.201), (15, 2.131), (30, 2.042), (120, 1.980)] {
            assert!((student_t_975(degrees) - t).abs() < 8e-4, "{degrees}");
        }
    }

    #[test]
    fn the_table_has_both_values_and_the_bias_with_their_units() {
        let waiting = point(7, json!({"orbit_radius_rms_49": 0.002}), Value::Null);
        let points = [orbit(3, 0.00101), waiting];
        let table = verification(&points, &Findings::new(&points, Some(STANDARD)));
        let names: Vec<&str> = table.columns.keys().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "ordinal",
                "flow_rate",
                "state",
                "orbit_radius_rms_49",
                "reference_orbit_radius_rms_49",
                "bias_orbit_radius_rms_49",
                "error"
            ]
        );
        assert_eq!(table.units["reference_orbit_radius_rms_49"], "m");
        assert_eq!(table.units["bias_orbit_radius_rms_49"], "1");
        assert_eq!(table.attributes["statistics"]["orbit_radius_rms_49"]["verified"], 1);
        let json = serde_json::to_value(&table).unwrap();
        assert_eq!(json["columns"]["state"], json!(["succeeded", "queued"]));
        assert_eq!(json["columns"]["bias_orbit_radius_rms_49"][1], Value::Null);
    }
}
