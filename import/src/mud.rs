//! Muds from viscometer readings, or from plastic viscosity and yield point.
//!
//! Readings are those of an oil-field viscometer with rotor, bob and spring R1-B1-F1: a shear rate of 1.703 1/s per revolution a minute and a wall
//! stress of 0.5107 Pa (1.0667 lbf/100 ft2) per degree of the dial (API RP 13D; ISO 10414-1). The power law of the wall's
//! shear rate is taken as the fluid's, as the field does.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Shear rate per rotor speed \[1/s per rev/min\].
pub const SHEAR_RATE: f64 = 1.703;

/// A pound-force over a hundred square feet \[Pa\].
const POUND_A_HUNDRED: f64 = 4.448_221_615_260_5 / 9.290_304;

/// Wall stress per degree of the dial \[Pa\].
pub const STRESS: f64 = 1.0667 * POUND_A_HUNDRED;

/// Largest number of readings.
const MOST_READINGS: usize = 100;

/// Range in which a flow index is sought, and its last step.
const FLOW_INDICES: [f64; 2] = [0.1, 1.5];
const INDEX_STEP: f64 = 1e-10;

/// A reading of the viscometer.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// Speed of the rotor \[rev/min\].
    pub rpm: f64,
    /// Reading of the dial \[deg\].
    pub dial: f64,
}

/// Yield power law tau = tau_y + K gamma^n of a mud.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct MudFit {
    /// Yield stress tau_y \[Pa\].
    pub yield_stress: f64,
    /// Consistency K \[Pa s^n\].
    pub consistency: f64,
    /// Flow index n.
    pub flow_index: f64,
    /// Root mean square of the differences from the readings \[Pa\].
    pub residual: f64,
}

/// Rheologies of a set of readings, by the conventions in use.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct MudReport {
    /// Yield power law with the least squares of all readings: the one to simulate with.
    pub least_squares: MudFit,
    /// Yield power law by API RP 13D: tau_y = 2 theta_3 - theta_6, n and K from 600 and 300 rev/min; absent without these four readings, or if they
    /// give no such law.
    pub rp_13d: Option<MudFit>,
    /// Bingham fluid with the least squares of all readings; n is 1.
    pub bingham: Option<MudFit>,
    /// Power law with the least squares of all readings; tau_y is 0.
    pub power_law: MudFit,
    /// Plastic viscosity \[Pa s\], from 600 and 300 rev/min.
    pub plastic_viscosity: Option<f64>,
    /// Yield point \[Pa\], from 600 and 300 rev/min.
    pub yield_point: Option<f64>,
}

/// Readings of a viscometer, or else plastic viscosity and yield point.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MudRequest {
    /// Readings at 2 to 100 different speeds, in place of the other members.
    #[serde(default)]
    pub readings: Vec<Reading>,
    /// Plastic viscosity PV \[Pa s\].
    #[serde(default)]
    pub plastic_viscosity: Option<f64>,
    /// Yield point YP \[Pa\].
    #[serde(default)]
    pub yield_point: Option<f64>,
    /// Low-shear yield point LSYP \[Pa\]; absent means 0.
    #[serde(default)]
    pub low_shear_yield_point: Option<f64>,
}

/// Rheologies of readings, or the law of plastic viscosity and yield point.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(untagged)]
pub enum MudAnswer {
    /// Of readings.
    Report(Box<MudReport>),
    /// Of plastic viscosity and yield point.
    Law(MudFit),
}

impl MudRequest {
    /// The rheologies.
    ///
    /// # Errors
    /// Neither or both forms are given, or they give no mud.
    pub fn answer(&self) -> Result<MudAnswer, MudError> {
        let [viscosity, point, low] = [self.plastic_viscosity, self.yield_point, self.low_shear_yield_point];
        match (viscosity, point, self.readings.is_empty()) {
            (Some(viscosity), Some(point), true) => {
                let [point, low] = [point, low.unwrap_or(0.0)].map(|stress| stress / POUND_A_HUNDRED);
                by_rp_13d(1e3 * viscosity, point, low).map(MudAnswer::Law).ok_or(MudError::NoLaw)
            }
            (None, None, false) if low.is_none() => {
                fit(&self.readings).map(|report| MudAnswer::Report(Box::new(report)))
            }
            _ => Err(MudError::Form),
        }
    }
}

/// Reason why readings give no mud.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum MudError {
    /// Too few or too many readings.
    #[error(
        "a mud needs 2 to {MOST_READINGS} readings at different speeds, three for a yield power law; there are {0}"
    )]
    Count(usize),
    /// A speed or reading out of range.
    #[error("reading {0}: speed and dial must be above 0, at most 1,000 rev/min and 1,000 deg")]
    Range(usize),
    /// Neither or both of readings and plastic viscosity with yield point.
    #[error("a mud needs either `readings`, or `plastic_viscosity` with `yield_point`")]
    Form,
    /// No yield power law has the plastic viscosity and the yield points.
    #[error("no yield power law has these values: PV and PV + YP - LSYP must be above 0")]
    NoLaw,
    /// Stresses that do not grow with the shear rate.
    #[error("the readings do not grow with the speed: no viscous fluid has them")]
    NotViscous,
}

/// The rheologies of a set of readings.
///
/// # Errors
/// Fewer than two readings, readings out of range, or readings that do not grow with the speed.
pub fn fit(readings: &[Reading]) -> Result<MudReport, MudError> {
    if !(2..=MOST_READINGS).contains(&readings.len()) {
        return Err(MudError::Count(readings.len()));
    }
    let is_valid = |value: f64| value > 0.0 && value <= 1000.0;
    if let Some(at) = readings.iter().position(|reading| !is_valid(reading.rpm) || !is_valid(reading.dial)) {
        return Err(MudError::Range(at + 1));
    }
    let points: Vec<Point> = readings
        .iter()
        .map(|reading| Point { rate: SHEAR_RATE * reading.rpm, stress: STRESS * reading.dial })
        .collect();
    if points.iter().all(|point| point.rate == points[0].rate) {
        return Err(MudError::Count(1));
    }
    let power_law = best(&points, through_zero).ok_or(MudError::NotViscous)?;
    // Two readings, or none that bends, leave the yield stress open: the power law then.
    let least_squares =
        best(&points, |points, index| line(points, index).filter(|fit| fit.yield_stress >= 0.0));
    let dial = |rpm: f64| readings.iter().find(|reading| reading.rpm == rpm).map(|reading| reading.dial);
    let plastic = dial(600.0).zip(dial(300.0)).map(|(six, three)| (six - three, 2.0 * three - six));
    Ok(MudReport {
        least_squares: match least_squares {
            Some(fit) if points.len() > 2 && fit.residual < power_law.residual => fit,
            _ => power_law,
        },
        rp_13d: plastic.zip(dial(6.0).zip(dial(3.0))).and_then(|((viscosity, point), (six, three))| {
            by_rp_13d(viscosity, point, 2.0 * three - six).map(|fit| with_residual(fit, &points))
        }),
        bingham: line(&points, 1.0).filter(|fit| fit.yield_stress >= 0.0),
        power_law,
        // A degree of the dial between 600 and 300 rev/min is a centipoise.
        plastic_viscosity: plastic.map(|(viscosity, _)| 1e-3 * viscosity),
        yield_point: plastic.map(|(_, point)| POUND_A_HUNDRED * point),
    })
}

/// Yield power law of plastic viscosity PV \[cP\], yield point YP and low-shear yield point LSYP \[lbf/100 ft2\] (API RP 13D, section 5); `None` if
/// there is no such law.
pub fn by_rp_13d(plastic_viscosity: f64, yield_point: f64, low_shear_yield_point: f64) -> Option<MudFit> {
    let yield_stress = low_shear_yield_point.max(0.0);
    let at_300 = plastic_viscosity + yield_point - yield_stress;
    let at_600 = at_300 + plastic_viscosity;
    let flow_index = (at_600 / at_300).log2();
    let is_law = at_300 > 0.0 && flow_index > 0.0 && flow_index.is_finite();
    is_law.then(|| MudFit {
        yield_stress: POUND_A_HUNDRED * yield_stress,
        consistency: POUND_A_HUNDRED * at_300 / (300.0 * SHEAR_RATE).powf(flow_index),
        flow_index,
        residual: 0.0,
    })
}

/// Shear rate \[1/s\] and wall stress \[Pa\].
#[derive(Debug, Clone, Copy)]
struct Point {
    rate: f64,
    stress: f64,
}

/// The fit of the flow index with the smallest residual: the best of a coarse scan, and golden section about it.
fn best(points: &[Point], fit: impl Fn(&[Point], f64) -> Option<MudFit>) -> Option<MudFit> {
    const SCAN: usize = 140;
    let [low, high] = FLOW_INDICES;
    let step = (high - low) / SCAN as f64;
    let residual = |index: f64| fit(points, index).map_or(f64::INFINITY, |fit| fit.residual);
    let scanned = (0..=SCAN).map(|at| low + at as f64 * step);
    let start = scanned.min_by(|a, b| residual(*a).total_cmp(&residual(*b)))?;
    let (mut left, mut right) = ((start - step).max(low), (start + step).min(high));
    let share = 0.5 * (3.0 - 5.0_f64.sqrt());
    while right - left > INDEX_STEP {
        let (first, second) = (left + share * (right - left), right - share * (right - left));
        if residual(first) <= residual(second) { right = second } else { left = first }
    }
    // At the edge of what is a fluid the middle may be none.
    let candidates =
        [0.5 * (left + right), left, right, start].into_iter().filter_map(|index| fit(points, index));
    candidates.min_by(|a, b| a.residual.total_cmp(&b.residual))
}

/// Yield stress and consistency of a given flow index by least squares; `None` if stresses do not grow with the rate.
fn line(points: &[Point], flow_index: f64) -> Option<MudFit> {
    let count = points.len() as f64;
    let abscissa = |point: &Point| point.rate.powf(flow_index);
    let mean = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (middle, stress) = (mean(&abscissa), mean(&|point| point.stress));
    let spread = mean(&|point| (abscissa(point) - middle).powi(2));
    let consistency = mean(&|point| (abscissa(point) - middle) * (point.stress - stress)) / spread;
    let fit = MudFit { yield_stress: stress - consistency * middle, consistency, flow_index, residual: 0.0 };
    (consistency > 0.0 && consistency.is_finite()).then(|| with_residual(fit, points))
}

/// Consistency of a given flow index without a yield stress by least squares.
fn through_zero(points: &[Point], flow_index: f64) -> Option<MudFit> {
    let sum = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>();
    let abscissa = |point: &Point| point.rate.powf(flow_index);
    let consistency = sum(&|point| abscissa(point) * point.stress) / sum(&|point| abscissa(point).powi(2));
    let fit = MudFit { yield_stress: 0.0, consistency, flow_index, residual: 0.0 };
    let grows = line(points, flow_index).is_some();
    (grows && consistency.is_finite()).then(|| with_residual(fit, points))
}

fn with_residual(fit: MudFit, points: &[Point]) -> MudFit {
    let difference =
        |point: &Point| fit.yield_stress + fit.consistency * point.rate.powf(fit.flow_index) - point.stress;
    let squares: f64 = points.iter().map(|point| difference(point).powi(2)).sum();
    MudFit { residual: (squares / points.len() as f64).sqrt(), ..fit }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEEDS: [f64; 6] = [600.0, 300.0, 200.0, 100.0, 6.0, 3.0];

    fn readings(dials: [f64; 6]) -> Vec<Reading> {
        SPEEDS.into_iter().zip(dials).map(|(rpm, dial)| Reading { rpm, dial }).collect()
    }

    #[test]
    fn readings_of_a_known_fluid_give_it_back() {
        for (yield_stress, consistency, flow_index) in
            [(2.664, 0.1269, 0.784), (0.0, 0.5, 0.6), (5.0, 0.02, 1.0)]
        {
            let dials = SPEEDS
                .map(|rpm: f64| (yield_stress + consistency * (SHEAR_RATE * rpm).powf(flow_index)) / STRESS);
            let report = fit(&readings(dials)).unwrap();
            let found = report.least_squares;
            assert!((found.flow_index - flow_index).abs() < 1e-6, "{found:?}");
            assert!((found.consistency / consistency - 1.0).abs() < 1e-5, "{found:?}");
            assert!((found.yield_stress - yield_stress).abs() < 1e-5, "{found:?}");
            assert!(found.residual < 1e-7);
        }
    }

    #[test]
    fn rp_13d_takes_four_readings() {
        // PV 24 cP, YP 14, LSYP 5 lbf/100 ft2: n = log2 (57/33), K = 33/511^n lbf s^n/100 ft2.
        let report = fit(&readings([62.0, 38.0, 29.0, 19.0, 7.0, 6.0])).unwrap();
        let found = report.rp_13d.unwrap();
        assert!((found.flow_index - 0.788_496).abs() < 1e-6, "{found:?}");
        assert!((found.yield_stress / (5.0 * 0.478_803) - 1.0).abs() < 1e-6);
        assert!(
            (found.consistency / (33.0 * 0.478_803 / 510.9_f64.powf(found.flow_index)) - 1.0).abs() < 1e-6
        );
        assert_eq!(report.plastic_viscosity, Some(0.024));
        assert!((report.yield_point.unwrap() - 14.0 * 0.478_803).abs() < 1e-5);
        assert_eq!(by_rp_13d(24.0, 14.0, 5.0).map(|fit| fit.flow_index), Some(found.flow_index));
        // Least squares of six readings cannot be worse than a law through four of them, nor than its own special cases.
        let others = [found, report.bingham.unwrap(), report.power_law];
        assert!(others.iter().all(|other| report.least_squares.residual < other.residual));
    }

    #[test]
    fn a_fit_has_the_least_residual_of_its_neighbours() {
        let report = fit(&readings([62.0, 38.0, 29.0, 19.0, 7.0, 6.0])).unwrap();
        let found = report.least_squares;
        let points: Vec<Point> = readings([62.0, 38.0, 29.0, 19.0, 7.0, 6.0])
            .iter()
            .map(|reading| Point { rate: SHEAR_RATE * reading.rpm, stress: STRESS * reading.dial })
            .collect();
        for (of_yield, of_consistency, of_index) in [
            (1e-3, 0.0, 0.0),
            (-1e-3, 0.0, 0.0),
            (0.0, 1e-5, 0.0),
            (0.0, -1e-5, 0.0),
            (0.0, 0.0, 1e-5),
            (0.0, 0.0, -1e-5),
        ] {
            let other = MudFit {
                yield_stress: found.yield_stress + of_yield,
                consistency: found.consistency + of_consistency,
                flow_index: found.flow_index + of_index,
                residual: 0.0,
            };
            assert!(with_residual(other, &points).residual > found.residual);
        }
    }

    #[test]
    fn hostile_readings_are_refused() {
        let reading = |rpm, dial| Reading { rpm, dial };
        assert_eq!(fit(&[]), Err(MudError::Count(0)));
        assert_eq!(fit(&[reading(600.0, 62.0); 3]), Err(MudError::Count(1)));
        assert_eq!(fit(&vec![reading(600.0, 62.0); 101]), Err(MudError::Count(101)));
        assert_eq!(fit(&[reading(600.0, 62.0), reading(f64::NAN, 38.0)]), Err(MudError::Range(2)));
        assert_eq!(fit(&[reading(600.0, 62.0), reading(300.0, -1.0)]), Err(MudError::Range(2)));
        assert_eq!(fit(&[reading(600.0, 10.0), reading(300.0, 20.0)]), Err(MudError::NotViscous));
        assert_eq!(by_rp_13d(f64::NAN, 1.0, 1.0), None);
        assert_eq!(by_rp_13d(0.0, 10.0, 1.0), None);
        // Two readings give a power law.
        let two = fit(&[reading(600.0, 62.0), reading(300.0, 38.0)]).unwrap();
        assert_eq!(two.least_squares, two.power_law);
        assert!((two.power_law.flow_index - (62.0_f64 / 38.0).log2()).abs() < 1e-6);
    }
}
