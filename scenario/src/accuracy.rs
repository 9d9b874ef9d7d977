//! Resolution of time.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// Resolution of time: a preset, a tolerance, or integrator and step in full.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(untagged)]
pub enum Accuracy {
    /// A named preset.
    Preset(AccuracyPreset),
    /// An allowed error.
    Target(AccuracyTarget),
    /// Integrator and step in full.
    Explicit(TimeStepping),
}

/// The relative error that time integration may make.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AccuracyTarget {
    /// Tolerance on statistics over the windows, such as the size of an orbit: 0.0001 to 0.1, usual 0.003 to 0.08. The longest
    /// step is proportional to its root, so that a quarter of it costs about twice the time; from 0.01 to 0.003 the step is the same. Too large, and
    /// stick-slip is inaccurate; from 0.01 down, steps also resolve torsion that velocity-weakening friction excites, to 0.125 ms.
    /// It does not reduce the spread of an ensemble.
    Statistics(f64),
    /// Tolerance on the history itself, relative to the motion, as long as histories of neighbouring starts stay together: 0.0001 to 0.1,
    /// usual 0.01 to 0.05. Steps are those of half as large a tolerance on statistics.
    Trajectory(f64),
}

/// Range of tolerances.
pub const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-4..=0.1;

/// The tolerance that the longest step below belongs to.
const LONGEST_STEP_TOLERANCE: f64 = 0.08;

/// Longest step of the adaptive method \[s\] at that tolerance. Between contacts' changes the error of a step of this method falls with
/// the square of the step or faster, so the longest step goes with the root of the tolerance.
const LONGEST_STEP: f64 = 8e-3;

/// Factors on the lengths of the mesh `auto` that accuracies choose. Longer elements miss bending between contacts, whatever the tolerance.
const MESH_FACTORS: std::ops::RangeInclusive<f64> = 0.4..=1.4;

/// A promised error and the tolerance that keeps it with room: smaller promises go with smaller tolerances in proportion.
const FINE: [f64; 2] = [0.003, 0.01];

impl Default for Accuracy {
    fn default() -> Self {
        Accuracy::Preset(AccuracyPreset::Standard)
    }
}

impl Accuracy {
    /// The integrator and step that the choice stands for.
    pub fn time_stepping(&self) -> TimeStepping {
        match *self {
            Accuracy::Explicit(explicit) => explicit,
            Accuracy::Preset(preset) => TimeStepping::promising(preset.tolerance()),
            Accuracy::Target(AccuracyTarget::Statistics(tolerance)) => TimeStepping::promising(tolerance),
            // A history's error is up to twice that of the sizes of its orbits in the runs that the tolerances are from.
            Accuracy::Target(AccuracyTarget::Trajectory(tolerance)) => {
                TimeStepping::promising(0.5 * tolerance)
            }
        }
    }

    /// The relative error of the size of an orbit that the choice allows; absent if integrator and step are given, which
    /// promise nothing.
    pub fn statistics_tolerance(&self) -> Option<f64> {
        match *self {
            Accuracy::Preset(preset) => Some(preset.tolerance()),
            Accuracy::Target(
                AccuracyTarget::Statistics(tolerance) | AccuracyTarget::Trajectory(tolerance),
            ) => Some(tolerance),
            Accuracy::Explicit(_) => None,
        }
    }

    /// Factor on the lengths of the mesh `auto` that matches the promise of the choice: 1 at `standard`, and without a promise.
    /// The error of a mesh falls with the square of its lengths (bending between contacts) or faster, so they go with the root of the error.
    pub fn mesh_factor(&self) -> f64 {
        let standard = AccuracyPreset::Standard.tolerance();
        let allowed = self.promise().map_or(standard, |promise| promise.orbit_size);
        (allowed / standard).sqrt().clamp(*MESH_FACTORS.start(), *MESH_FACTORS.end())
    }

    /// Promise of the choice for statistics; absent if integrator and step are given, which promise nothing.
    pub fn promise(&self) -> Option<Promise> {
        let orbit_size = self.statistics_tolerance()?;
        Some(match self {
            Accuracy::Preset(preset) => preset.promise(),
            // In the ratio of the standard's.
            Accuracy::Target(_) | Accuracy::Explicit(_) => {
                Promise { orbit_size, radius_deviation: 2.5 * orbit_size }
            }
        })
    }
}

/// Promise of an accuracy for a run's statistics: the largest bias against the converged values, relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Promise {
    /// Bound on the error of orbit sizes.
    pub orbit_size: f64,
    /// Bound on the error of standard deviations of the radius.
    pub radius_deviation: f64,
}

/// Written out, because an untagged enum would not say which field of the explicit form is wrong.
impl<'de> Deserialize<'de> for Accuracy {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AccuracyVisitor)
    }
}

struct AccuracyVisitor;

impl<'de> Visitor<'de> for AccuracyVisitor {
    type Value = Accuracy;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(
            "\"draft\", \"standard\", \"reference\", an object with a tolerance (statistics or trajectory), or one with integrator and step",
        )
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Accuracy, E> {
        AccuracyPreset::deserialize(StrDeserializer::new(name)).map(Accuracy::Preset)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Accuracy, A::Error> {
        let fields = Fields::deserialize(MapAccessDeserializer::new(map))?;
        let Fields { statistics, trajectory, integrator, step, contact_sweeps, tolerance, spectral_radius } =
            fields;
        let explicit = integrator.is_some()
            || step.is_some()
            || contact_sweeps.is_some()
            || tolerance.is_some()
            || spectral_radius.is_some();
        match (statistics, trajectory, explicit) {
            (Some(tolerance), None, false) => Ok(Accuracy::Target(AccuracyTarget::Statistics(tolerance))),
            (None, Some(tolerance), false) => Ok(Accuracy::Target(AccuracyTarget::Trajectory(tolerance))),
            (None, None, _) => Ok(Accuracy::Explicit(TimeStepping {
                integrator: integrator.ok_or_else(|| de::Error::missing_field("integrator"))?,
                step: step.ok_or_else(|| de::Error::missing_field("step"))?,
                contact_sweeps: contact_sweeps.unwrap_or_else(two),
                tolerance,
                spectral_radius,
            })),
            _ => Err(de::Error::custom("statistics, trajectory, or integrator with step: one of them alone")),
        }
    }
}

/// The fields of all forms that are objects.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    statistics: Option<f64>,
    trajectory: Option<f64>,
    integrator: Option<Integrator>,
    step: Option<f64>,
    contact_sweeps: Option<u32>,
    tolerance: Option<f64>,
    spectral_radius: Option<f64>,
}

/// Named accuracies, by the error allowed in the size of an orbit and in the standard deviation of its radius: `draft` 8 and 15 %,
/// `standard` 2 and 5 %, `reference` 0.3 and 1 %.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AccuracyPreset {
    /// 8 % of the size of an orbit, 15 % of the standard deviation of its radius.
    Draft,
    /// 2 % and 5 %.
    Standard,
    /// 0.3 % and 1 %.
    Reference,
}

impl AccuracyPreset {
    /// All of them, from the loosest.
    pub const ALL: [AccuracyPreset; 3] =
        [AccuracyPreset::Draft, AccuracyPreset::Standard, AccuracyPreset::Reference];

    /// The one of a name on the wire.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// The relative error of the size of an orbit that it allows.
    pub fn tolerance(self) -> f64 {
        match self {
            AccuracyPreset::Draft => 0.08,
            AccuracyPreset::Standard => 0.02,
            AccuracyPreset::Reference => 0.003,
        }
    }

    /// Bounds on the relative error of the statistics.
    pub fn promise(self) -> Promise {
        let radius_deviation = match self {
            AccuracyPreset::Draft => 0.15,
            AccuracyPreset::Standard => 0.05,
            AccuracyPreset::Reference => 0.01,
        };
        Promise { orbit_size: self.tolerance(), radius_deviation }
    }

    /// The name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            AccuracyPreset::Draft => "draft",
            AccuracyPreset::Standard => "standard",
            AccuracyPreset::Reference => "reference",
        }
    }
}

/// An integrator and its step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeStepping {
    /// The method.
    pub integrator: Integrator,
    /// Step \[s\], above 0; with a tolerance the longest one. A fixed step is a whole part of the recording interval, or for
    /// `esdirk4` that times a power of two. Usual 2.5e-4 to 8e-3 for `esdirk4`, 1e-4 to 1e-3 for `generalized_alpha`, 1e-5 to 6e-5
    /// for `rk4`. Implicit methods damp motion that a long step does not resolve, and cut it into up to 4096 parts if contact iterations
    /// would diverge; `rk4` is refused beyond its stability limit. Below 1e-4 s implicit methods no longer damp the torsion of
    /// single elements, which velocity-weakening friction feeds unless `damping.stiffness_proportional` is above 0.
    pub step: f64,
    /// Contact iterations a solve, 2 to 1000, 2 unless given (implicit methods). Two are a fixed number; more are a limit on iterations
    /// that end once they have converged (1e-9 m, and 1e-6 of a friction coefficient). Usual 2, or 30 for a reference: with a fixed
    /// step too few leave contact forces inconsistent with the motion, counted as `loose_solves` in the result's provenance.
    #[serde(default = "two")]
    pub contact_sweeps: u32,
    /// Adapts the step; absent means a fixed step, which `generalized_alpha` always has. For `esdirk4` the relative error that
    /// statistics may have, 0.0001 to 0.1, usual 0.003 to 0.08; for `rk4` the local error of a lateral displacement in hole radii,
    /// above 0 and below 0.1, usual 1e-6 to 1e-4. Too large misses sticking and impacts. Too small needs steps that are not
    /// taken: `esdirk4` keeps its shortest, a 128th of the longest, and counts it in `unresolved_steps`; `rk4` fails below a
    /// millionth of it.
    #[serde(default)]
    pub tolerance: Option<f64>,
    /// Spectral radius at infinite frequency (`generalized_alpha` only), 0 to 0.95; absent means 0.8, usual 0.6 to 0.9. Smaller
    /// values damp more, also resolved motion; larger ones leave unresolved frequencies undamped. One, the trapezium rule,
    /// damps nothing, and with a fixed number of contact iterations it fails silently.
    #[serde(default)]
    pub spectral_radius: Option<f64>,
}

impl TimeStepping {
    /// The adaptive method for a relative error of statistics that is promised.
    ///
    /// The error of a method of order 4 falls faster than its tolerance: steps for 0.01 leave 0.0004 of orbit sizes if the sizes are settled,
    /// and are those that 0.003 is promised with.
    pub fn promising(error: f64) -> Self {
        let [promised, tolerance] = FINE;
        Self::adaptive(error.max(tolerance.min(tolerance * error / promised)))
    }

    /// The adaptive method for a relative tolerance on statistics.
    pub fn adaptive(tolerance: f64) -> Self {
        let step = LONGEST_STEP * (tolerance / LONGEST_STEP_TOLERANCE).sqrt();
        Self { tolerance: Some(tolerance), ..Self::fixed(Integrator::Esdirk4, step) }
    }

    /// A method with a fixed step \[s\] and two contact iterations.
    pub fn fixed(integrator: Integrator, step: f64) -> Self {
        Self { integrator, step, contact_sweeps: two(), tolerance: None, spectral_radius: None }
    }

    /// The same method, finer: half the step, and the tolerance that belongs to it. The longest step of `esdirk4` goes with the root of
    /// its tolerance; that of `rk4` is of a local error of order 5.
    pub fn finer(&self) -> Self {
        let tolerance = self.tolerance.map(|tolerance| match self.integrator {
            Integrator::Rk4 => tolerance / 32.0,
            Integrator::Esdirk4 | Integrator::GeneralizedAlpha => (0.25 * tolerance).max(*TOLERANCES.start()),
        });
        Self { step: 0.5 * self.step, tolerance, ..*self }
    }
}

fn two() -> u32 {
    2
}

/// Time integration methods: `esdirk4` is ESDIRK4(3)6L (Kennedy and Carpenter 2003), order 4, L-stable, the method of all named
/// accuracies; `generalized_alpha` (Chung and Hulbert 1993) has order 2 and fixed steps; `rk4` is the classical Runge-Kutta method
/// of order 4, the paper's, explicit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Generalized-alpha (Chung and Hulbert 1993) with spectral radius 0.8 at infinity, order 2.
    GeneralizedAlpha,
    /// ESDIRK4(3)6L (Kennedy and Carpenter 2003), order 4, L-stable, with steps that adapt themselves when a tolerance is given.
    Esdirk4,
    /// Classical Runge-Kutta of order 4 (the paper's), with step doubling when a tolerance is given.
    Rk4,
}

impl Integrator {
    /// The name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Integrator::GeneralizedAlpha => "generalized_alpha",
            Integrator::Esdirk4 => "esdirk4",
            Integrator::Rk4 => "rk4",
        }
    }
}
