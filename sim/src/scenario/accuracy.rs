//! How finely time is resolved.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// How finely time is resolved: a preset, or integrator and step in full.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum Accuracy {
    /// A named preset.
    Preset(AccuracyPreset),
    /// Integrator and step in full.
    Explicit(TimeStepping),
}

impl Default for Accuracy {
    fn default() -> Self {
        Accuracy::Preset(AccuracyPreset::Standard)
    }
}

impl Accuracy {
    /// The integrator and step that the choice stands for (performance.md section 7).
    pub fn time_stepping(&self) -> TimeStepping {
        let (integrator, step, contact_sweeps) = match self {
            Accuracy::Explicit(explicit) => return *explicit,
            Accuracy::Preset(AccuracyPreset::Draft) => (Integrator::GeneralizedAlpha, 5e-4, 2),
            Accuracy::Preset(AccuracyPreset::Standard) => (Integrator::Esdirk4, 1e-3, 2),
            Accuracy::Preset(AccuracyPreset::Reference) => (Integrator::Esdirk4, 2.5e-4, 20),
        };
        TimeStepping { contact_sweeps, ..TimeStepping::fixed(integrator, step) }
    }
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
        formatter.write_str("\"draft\", \"standard\", \"reference\" or an object with integrator and step")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Accuracy, E> {
        AccuracyPreset::deserialize(StrDeserializer::new(name)).map(Accuracy::Preset)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Accuracy, A::Error> {
        TimeStepping::deserialize(MapAccessDeserializer::new(map)).map(Accuracy::Explicit)
    }
}

/// Named accuracies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum AccuracyPreset {
    /// Generalized-alpha, 0.5 ms, two contact sweeps.
    Draft,
    /// ESDIRK4(3)6L, 1 ms, two contact sweeps a stage.
    Standard,
    /// ESDIRK4(3)6L, 0.25 ms, contact sweeps to convergence.
    Reference,
}

/// An integrator and its step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct TimeStepping {
    /// The method.
    pub integrator: Integrator,
    /// Step \[s\]; for `rk4` the largest step.
    pub step: f64,
    /// Contact sweeps a solve, 2 or more (implicit methods).
    #[serde(default = "two")]
    pub contact_sweeps: u32,
    /// Relative error tolerance of the adaptive step (`rk4`); absent means a fixed step.
    #[serde(default)]
    pub tolerance: Option<f64>,
    /// Spectral radius at infinite frequency (`generalized_alpha`), 0 to 0.95; absent means 0.8. One, the trapezium rule,
    /// damps nothing, and with a fixed number of contact sweeps it fails silently.
    #[serde(default)]
    pub spectral_radius: Option<f64>,
}

impl TimeStepping {
    /// A method with a fixed step \[s\] and two contact sweeps.
    pub fn fixed(integrator: Integrator, step: f64) -> Self {
        Self { integrator, step, contact_sweeps: two(), tolerance: None, spectral_radius: None }
    }
}

fn two() -> u32 {
    2
}

/// Time integration methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Generalized-alpha (Chung and Hulbert 1993) with spectral radius 0.8 at infinity, order 2.
    GeneralizedAlpha,
    /// ESDIRK4(3)6L (Kennedy and Carpenter 2003), order 4, L-stable.
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
