//! What a client asks for: a sweep, or a single run.

use std::collections::BTreeMap;

use drillsweep_sim::scenario::Scenario;
use indexmap::IndexMap;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use crate::axis::Axis;

/// A sweep: a scenario, changes to it, and the axes along which it is varied.
///
/// Exactly one of `preset` and `scenario` is given. `set` is applied first, then the axes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepRequest {
    /// A name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200, example = "flow rate against density")]
    pub name: Option<String>,
    /// Whose share of the workers the sweep counts against; absent means `default`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 100)]
    pub owner: Option<String>,
    /// Name of a preset scenario, see `GET /v1/scenarios`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "paper-200m")]
    pub preset: Option<String>,
    /// A scenario in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Box<Scenario>>,
    /// Changes to the scenario, by the path of the field, such as `operation.rotation_speed_rpm` or
    /// `string.sections[1].count`. An object changes the fields it names; `null` removes what is optional. An
    /// outer path is applied before those inside it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(example = json!({"duration": 60, "operation.rotation_speed_rpm": 120}))]
    pub set: BTreeMap<String, Value>,
    /// How the axes are combined.
    #[serde(default)]
    pub design: Design,
    /// The swept parameters, by name. The first axis varies slowest, in the order in which they are written.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    #[schema(example = json!({
        "flow_rate": {"values": [0.01, 0.04, 0.06]},
        "mud_density": {"from": 1200, "to": 2100, "count": 4}
    }))]
    pub axes: IndexMap<AxisName, Axis>,
    /// Higher goes first among the sweeps of one owner.
    #[serde(default)]
    #[schema(minimum = -10, maximum = 10)]
    pub priority: i32,
}

/// A single point, computed by the same machinery as a sweep.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RunRequest {
    /// A name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub name: Option<String>,
    /// Whose share of the workers the run counts against; absent means `default`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 100)]
    pub owner: Option<String>,
    /// Name of a preset scenario, see `GET /v1/scenarios`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "paper-200m")]
    pub preset: Option<String>,
    /// A scenario in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Box<Scenario>>,
    /// Changes to the scenario, by the path of the field.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(example = json!({"mud.flow_rate": 0.04}))]
    pub set: BTreeMap<String, Value>,
    /// Higher goes first among the sweeps of one owner.
    #[serde(default)]
    #[schema(minimum = -10, maximum = 10)]
    pub priority: i32,
}

impl From<RunRequest> for SweepRequest {
    /// The sweep of one point that a run is.
    fn from(run: RunRequest) -> Self {
        let RunRequest { name, owner, preset, scenario, set, priority } = run;
        SweepRequest { name, owner, preset, scenario, set, priority, ..SweepRequest::default() }
    }
}

/// How the values of the axes are combined into points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Every value of every axis with every value of the others.
    #[default]
    Grid,
}

/// The parameters that can be swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxisName {
    /// Flow rate of the mud, `mud.flow_rate` \[m3/s\].
    FlowRate,
    /// Density of the mud, `mud.density` \[kg/m3\].
    MudDensity,
}

impl<'de> Deserialize<'de> for AxisName {
    /// As a string rather than as a variant, so that the name shows up in the path of an error below it.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let axis = AxisName::ALL.into_iter().find(|axis| axis.as_str() == name);
        axis.ok_or_else(|| D::Error::unknown_variant(&name, &["flow_rate", "mud_density"]))
    }
}

impl AxisName {
    /// All axes.
    pub const ALL: [AxisName; 2] = [AxisName::FlowRate, AxisName::MudDensity];

    /// The name on the wire.
    pub fn as_str(self) -> &'static str {
        match self {
            AxisName::FlowRate => "flow_rate",
            AxisName::MudDensity => "mud_density",
        }
    }

    /// The path of the scenario's field.
    pub fn scenario_path(self) -> &'static str {
        match self {
            AxisName::FlowRate => "mud.flow_rate",
            AxisName::MudDensity => "mud.density",
        }
    }

    /// The value of the field in a scenario; none when the hole is dry.
    pub fn get(self, scenario: &Scenario) -> Option<f64> {
        let mud = scenario.mud.as_ref()?;
        Some(match self {
            AxisName::FlowRate => mud.flow_rate,
            AxisName::MudDensity => mud.density,
        })
    }

    /// Sets the field; a dry hole has none.
    pub(crate) fn set(self, scenario: &mut Scenario, value: f64) {
        if let Some(mud) = scenario.mud.as_mut() {
            match self {
                AxisName::FlowRate => mud.flow_rate = value,
                AxisName::MudDensity => mud.density = value,
            }
        }
    }
}
