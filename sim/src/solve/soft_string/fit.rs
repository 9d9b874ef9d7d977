//! Friction factors of hole sections from measured hook loads and torques.

use drillsweep_scenario::Hole;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::error::SoftStringError;
use super::mode::{DragMode, DragSettings};
use super::string::SoftString;

/// Step of the central differences of hook load and torque by a friction factor: their third derivatives leave some 1e-8 of the slope.
const DIFFERENCE: f64 = 1e-4;

/// Change of the factors at which the iteration ends.
const CONVERGED: f64 = 1e-10;

/// Largest number of iterations: a fit needs some five.
const ITERATIONS: usize = 50;

/// Singular value over the largest one below which the points do not distinguish two factors.
const SMALLEST_SINGULAR_VALUE: f64 = 1e-7;

/// Forces measured at the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredPoint {
    /// Measured depth of the bit \[m\].
    pub bit_depth: f64,
    /// Motion during the measurement.
    pub mode: DragMode,
    /// Hook load \[N\], travelling weight included; absent if not measured.
    #[serde(default)]
    pub hook_load: Option<f64>,
    /// Surface torque \[N m\]; absent if not measured.
    #[serde(default)]
    pub torque: Option<f64>,
}

/// Settings of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitSettings {
    /// Settings of the cases.
    pub drag: DragSettings,
    /// Standard deviation of a measured hook load \[N\]: it weighs hook loads against torques.
    pub hook_load_deviation: f64,
    /// Standard deviation of a measured torque \[N m\].
    pub torque_deviation: f64,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self { drag: DragSettings::default(), hook_load_deviation: 1e4, torque_deviation: 1e3 }
    }
}

/// Friction factor of a hole section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct FittedFriction {
    /// Measured depth of the upper end of the section \[m\].
    pub from: f64,
    /// Friction factor.
    pub friction: f64,
    /// Its standard error, from the scatter of the residuals; absent if there are no more measurements than factors.
    pub standard_error: Option<f64>,
}

/// Measurement less the value of the fitted string.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
pub struct PointResidual {
    /// Of the hook load \[N\]; absent if not measured.
    pub hook_load: Option<f64>,
    /// Of the torque \[N m\]; absent if not measured.
    pub torque: Option<f64>,
}

/// Friction factors that fit measurements best.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct FrictionFit {
    /// Friction of the hole sections that a string reaches, from the top.
    pub friction: Vec<FittedFriction>,
    /// Residuals of the points, in their order.
    pub residuals: Vec<PointResidual>,
    /// Root mean square of the residuals, each over its standard deviation, with the degrees of freedom that are left; near 1 if the deviations are
    /// right. Absent if there are no more measurements than factors.
    pub reduced_deviation: Option<f64>,
    /// Iterations of the Gauss-Newton method.
    pub iterations: usize,
}

/// Reason for which friction factors cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A case cannot be computed.
    #[error("point {point}: {error}")]
    Case {
        /// The point, from 0.
        point: usize,
        /// Reason.
        error: SoftStringError,
    },
    /// A standard deviation or a measurement is not a usable number.
    #[error("{0} is not a finite number in its range")]
    Number(&'static str),
    /// There are fewer measurements than factors, or they do not distinguish them.
    #[error("{measurements} measurements do not determine the friction of {sections} hole sections")]
    Undetermined {
        /// Number of measurements.
        measurements: usize,
        /// Number of sections.
        sections: usize,
    },
    /// The iteration did not converge.
    #[error("the fit did not converge in {ITERATIONS} iterations")]
    NotConverged,
}

/// Hook load and torque over their deviations, for one measurement after the other.
struct Measurements<'a> {
    string: &'a SoftString,
    points: &'a [MeasuredPoint],
    settings: &'a FitSettings,
}

impl SoftString {
    /// Friction factors of the hole sections that fit measurements best, by least squares: Gauss-Newton from the factors of the scenario.
    ///
    /// # Errors
    /// A case cannot be computed, a number is out of range, or the measurements do not determine the factors.
    pub fn fit_friction(
        &self,
        points: &[MeasuredPoint],
        settings: &FitSettings,
    ) -> Result<FrictionFit, FitError> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !positive(settings.hook_load_deviation) {
            return Err(FitError::Number("the standard deviation of hook loads"));
        }
        if !positive(settings.torque_deviation) {
            return Err(FitError::Number("the standard deviation of torques"));
        }
        if points.iter().any(|point| [point.hook_load, point.torque].iter().flatten().any(|v| !v.is_finite()))
        {
            return Err(FitError::Number("a measurement"));
        }
        let deepest = points.iter().map(|point| point.bit_depth).fold(0.0, f64::max);
        let tops: Vec<f64> = std::iter::once(0.0).chain(self.section_tops.iter().copied()).collect();
        let bottom = |hole: usize| tops.get(hole + 1).copied().unwrap_or(f64::INFINITY).min(deepest);
        let reached: Vec<usize> = (0..tops.len()).filter(|&hole| tops[hole] < bottom(hole)).collect();
        let measurements = Measurements { string: self, points, settings };

        let mut factors: Vec<f64> = self.holes.iter().map(|hole: &Hole| hole.dynamic_friction).collect();
        let mut residuals = measurements.residuals(&factors)?;
        let undetermined =
            || FitError::Undetermined { measurements: residuals.len(), sections: reached.len() };
        if residuals.len() < reached.len() || reached.is_empty() {
            return Err(undetermined());
        }
        for iterations in 1..=ITERATIONS {
            let mut slopes = DMatrix::zeros(residuals.len(), reached.len());
            for (column, &hole) in reached.iter().enumerate() {
                let shifted = |by: f64| {
                    let mut shifted = factors.clone();
                    shifted[hole] += by;
                    measurements.residuals(&shifted)
                };
                let slope = (shifted(-DIFFERENCE)? - shifted(DIFFERENCE)?) / (2.0 * DIFFERENCE);
                slopes.set_column(column, &slope);
            }
            let svd = slopes.svd(true, true);
            if svd.singular_values.min() <= SMALLEST_SINGULAR_VALUE * svd.singular_values.max() {
                return Err(FitError::Undetermined {
                    measurements: residuals.len(),
                    sections: reached.len(),
                });
            }
            let step = svd.solve(&residuals, 0.0).expect("both sets of singular vectors are computed");
            for (&hole, step) in reached.iter().zip(&step) {
                factors[hole] += step;
            }
            residuals = measurements.residuals(&factors)?;
            if step.amax() > CONVERGED {
                continue;
            }
            let freedom = residuals.len() - reached.len();
            let variance = (freedom > 0).then(|| residuals.norm_squared() / freedom as f64);
            let right = svd.v_t.expect("computed");
            let error = |column: usize| {
                let of_unit = right.column(column).component_div(&svd.singular_values).norm();
                variance.map(|variance| variance.sqrt() * of_unit)
            };
            let fitted = reached.iter().enumerate().map(|(column, &hole)| FittedFriction {
                from: tops[hole],
                friction: factors[hole],
                standard_error: error(column),
            });
            return Ok(FrictionFit {
                friction: fitted.collect(),
                residuals: measurements.by_point(&residuals),
                reduced_deviation: variance.map(f64::sqrt),
                iterations,
            });
        }
        Err(FitError::NotConverged)
    }
}

impl Measurements<'_> {
    /// Measurements less the values with friction factors, over their standard deviations.
    fn residuals(&self, factors: &[f64]) -> Result<DVector<f64>, FitError> {
        let mut residuals = Vec::new();
        for (index, point) in self.points.iter().enumerate() {
            let at = |error| FitError::Case { point: index, error };
            let (operation, drag) = (&self.string.operation, &self.settings.drag);
            let motion = point.mode.motion(operation, drag).map_err(at)?;
            let laid = self.string.laid(point.bit_depth).map_err(at)?;
            let top = laid.forces(factors, &motion, point.mode.bit_loads(operation), |_, _| {});
            let hook_load = top.tension + drag.travelling_weight;
            let measured = [
                (point.hook_load, hook_load, self.settings.hook_load_deviation),
                (point.torque, top.torque, self.settings.torque_deviation),
            ];
            let one = |(measured, computed, deviation): (Option<f64>, f64, f64)| {
                measured.map(|measured| (measured - computed) / deviation)
            };
            residuals.extend(measured.into_iter().filter_map(one));
        }
        Ok(DVector::from_vec(residuals))
    }

    /// Residuals in their units, point by point.
    fn by_point(&self, residuals: &DVector<f64>) -> Vec<PointResidual> {
        let mut left = residuals.iter();
        let mut next = |measured: Option<f64>, deviation: f64| {
            measured.and_then(|_| left.next()).map(|left| left * deviation)
        };
        self.points
            .iter()
            .map(|point| PointResidual {
                hook_load: next(point.hook_load, self.settings.hook_load_deviation),
                torque: next(point.torque, self.settings.torque_deviation),
            })
            .collect()
    }
}
