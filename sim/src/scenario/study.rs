//! What a work-precision study of a scenario compares.

use serde::{Deserialize, Serialize};

use super::Integrator;

/// A work-precision study: instead of one run, runs of several methods and steps, and of several meshes, against a
/// converged one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct CostStudy {
    /// Simulated time of each run \[s\]; it takes the place of the scenario's duration.
    #[serde(default = "ten_seconds")]
    pub duration: f64,
    /// Methods and their steps; absent means all three with four steps each, those of `rk4` just below its stability
    /// limit.
    #[serde(default)]
    pub methods: Option<Vec<MethodSteps>>,
    /// Factors on the mesh's target element lengths, each a run of its own; empty means none.
    #[serde(default)]
    pub mesh_factors: Vec<f64>,
    /// An effect ablation in place of methods and meshes: the scenario at its own accuracy, with each effect that takes part
    /// switched off in turn.
    #[serde(default)]
    pub effects: bool,
}

/// One method and the steps to try it with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct MethodSteps {
    /// The method.
    pub integrator: Integrator,
    /// Steps \[s\]; each must divide the recording interval.
    pub steps: Vec<f64>,
}

impl Default for CostStudy {
    fn default() -> Self {
        Self { duration: ten_seconds(), methods: None, mesh_factors: Vec::new(), effects: false }
    }
}

fn ten_seconds() -> f64 {
    10.0
}
