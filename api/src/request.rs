//! Requests of a client: a sweep, or a single run.

use std::collections::{BTreeMap, BTreeSet};

use drillsweep_scenario::{Outputs, Scenario};
use indexmap::IndexMap;
use jiff::Timestamp;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::axis::{Axis, AxisName};
use crate::bounded;
use crate::listed::ListedPoints;
use crate::problem::{FieldProblem, ProblemDetails};
use crate::refinement::Refinement;
use crate::signs::{self, Signs};

/// A sweep: a scenario, changes to it, and the axes along which it is varied.
///
/// Exactly one of `preset` and `scenario` is given. `set` is applied first, then the axes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepRequest {
    /// A name for people, of 1 to 200 characters; absent means none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(
        min_length = 1,
        max_length = 200,
        pattern = r"^\P{Cc}*$",
        example = "flow rate against density"
    )]
    pub name: Option<String>,
    /// Owner, whose share of the workers the sweep counts against; absent means `default`. If tokens are in use it is the token's
    /// owner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 100, pattern = r"^\P{Cc}*$")]
    pub owner: Option<String>,
    /// Words to find it by, up to 20 of 1 to 100 characters; none unless given.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty", deserialize_with = "bounded::tags")]
    #[schema(max_items = 20, value_type = Vec<Tag>, example = json!(["campaign-7"]))]
    pub tags: BTreeSet<String>,
    /// Name of a preset scenario, see `GET /v1/scenarios`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "paper-200m")]
    pub preset: Option<String>,
    /// A scenario in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Box<Scenario>>,
    /// Changes to the scenario, by the path of the field, such as `operation.rotation_speed_rpm` or
    /// `string.sections[1].count`. An object changes the fields it names; `null` removes an optional field. An
    /// outer path is applied before those inside it. At most 200.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "bounded::changes")]
    #[schema(example = json!({"duration": 60, "operation.rotation_speed_rpm": 120}))]
    pub set: BTreeMap<String, Value>,
    /// Outputs that are kept of each point, in place of the scenario's `recording.outputs`: `"summary"` (its row of the table alone),
    /// `"spectra"`, `{"orbits": {...}}` or `"full"`; absent means as in the scenario. A point of 60 s takes some 4 MB in full,
    /// 0.5 MB as spectra and nothing as a summary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "full")]
    pub outputs: Option<Outputs>,
    /// Design that makes the points from the axes; absent means `grid`.
    #[serde(default)]
    pub design: Design,
    /// The swept parameters, by name: `flow_rate`, `mud_density`, or the path of any numeric field of the scenario, such as
    /// `operation.rotation_speed_rpm` or `string.sections[1].count`. In a grid the first axis varies slowest, in the order in which
    /// they are written. A sweep has at most 32 axes and 100,000 points, in a grid the product of the axes' counts; without axes it has
    /// one point.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty", deserialize_with = "bounded::axes")]
    #[schema(example = json!({
        "flow_rate": {"values": [0.01, 0.04, 0.06]},
        "mud_density": {"from": 1200, "to": 2100, "count": 4}
    }))]
    pub axes: IndexMap<AxisName, Axis>,
    /// The points of the design `list`, each with a value for every parameter that the first names.
    #[serde(default, skip_serializing_if = "ListedPoints::is_empty")]
    #[schema(value_type = Vec<IndexMap<AxisName, f64>>, max_items = 100_000, example = json!([]))]
    pub points: ListedPoints,
    /// Number of points of the designs `latin_hypercube` and `sobol`, 1 to 100,000, which these designs need; usual ten and more
    /// for each axis, and powers of two for `sobol`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 100_000)]
    pub samples: Option<u32>,
    /// Seed of these designs, any whole number from 0; 0 unless given. The same seed draws the same points, always.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(maximum = 18_446_744_073_709_551_615_u64)]
    pub seed: Option<u64>,
    /// Points at the start of the Sobol sequence to skip, so that a sweep continues another one of the same seed; 0
    /// unless given, below 2^32 with the samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skip: Option<u32>,
    /// Number of points that are run a second time, at the accuracy `reference`, to measure the bias of their own: a part of
    /// them below 1, usual 0.02 to 0.1 (rounded, but one at least), or a number of them, 1 or more; absent means none. A reference
    /// run takes three to four times as long as one at `standard`. They are spread over the order of the points, the same for the
    /// same request; of points that are added later as many are verified as make up that part, or that number, of the whole sweep.
    /// Results are at `GET /v1/sweeps/{id}/verification`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0.0, example = 0.05)]
    pub verify: Option<f64>,
    /// Signs of `operation.weight_on_bit` and `operation.torque_on_bit` in this request: with `driller` compression, and torque that opposes clockwise
    /// rotation, are positive. The request is stored in the signs of the model; values of a preset are in these. Absent means `model`.
    #[serde(default, skip_serializing_if = "Signs::is_model")]
    pub signs: Signs,
    /// Higher goes first among the sweeps of one owner, -10 to 10; 0 unless given. It takes nothing from other owners, who take
    /// turns.
    #[serde(default)]
    #[schema(minimum = -10, maximum = 10)]
    pub priority: i32,
}

/// A word to find a sweep by.
#[derive(utoipa::ToSchema)]
#[schema(min_length = 1, max_length = 100, pattern = r"^\P{Cc}*$")]
#[expect(dead_code, reason = "only its schema is used")]
struct Tag(String);

/// A single point, computed by the same machinery as a sweep.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RunRequest {
    /// A name for people, of 1 to 200 characters; absent means none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 200, pattern = r"^\P{Cc}*$")]
    pub name: Option<String>,
    /// Owner, whose share of the workers the run counts against; absent means `default`. If tokens are in use it is the token's owner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 100, pattern = r"^\P{Cc}*$")]
    pub owner: Option<String>,
    /// Words to find it by, up to 20 of 1 to 100 characters; none unless given.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty", deserialize_with = "bounded::tags")]
    #[schema(max_items = 20, value_type = Vec<Tag>, example = json!(["campaign-7"]))]
    pub tags: BTreeSet<String>,
    /// Name of a preset scenario, see `GET /v1/scenarios`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "paper-200m")]
    pub preset: Option<String>,
    /// A scenario in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Box<Scenario>>,
    /// Changes to the scenario, by the path of the field. At most 200.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "bounded::changes")]
    #[schema(example = json!({"mud.flow_rate": 0.04}))]
    pub set: BTreeMap<String, Value>,
    /// Outputs that are kept of the point, in place of the scenario's `recording.outputs`: `"summary"` (its row of the table alone),
    /// `"spectra"`, `{"orbits": {...}}` or `"full"`; absent means as in the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "full")]
    pub outputs: Option<Outputs>,
    /// Signs of `operation.weight_on_bit` and `operation.torque_on_bit` in this request: with `driller` compression, and torque that opposes clockwise
    /// rotation, are positive. The request is stored in the signs of the model; values of a preset are in these. Absent means `model`.
    #[serde(default, skip_serializing_if = "Signs::is_model")]
    pub signs: Signs,
    /// Higher goes first among the sweeps of one owner, -10 to 10; 0 unless given. It takes nothing from other owners, who take
    /// turns.
    #[serde(default)]
    #[schema(minimum = -10, maximum = 10)]
    pub priority: i32,
}

impl From<RunRequest> for SweepRequest {
    /// The sweep of one point that a run is.
    fn from(run: RunRequest) -> Self {
        let RunRequest { name, owner, tags, preset, scenario, set, outputs, signs, priority } = run;
        SweepRequest {
            name,
            owner,
            tags,
            preset,
            scenario,
            set,
            outputs,
            signs,
            priority,
            ..SweepRequest::default()
        }
    }
}

/// Points to add to a sweep: of its scenario, over its own parameters, by any design, or by a refinement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AppendRequest {
    /// Design that makes the points from the axes; absent means `grid`.
    #[serde(default)]
    pub design: Design,
    /// The sweep's parameters with new values.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty", deserialize_with = "bounded::axes")]
    #[schema(example = json!({"flow_rate": {"values": [0.02, 0.03]}, "mud_density": {"values": [1200]}}))]
    pub axes: IndexMap<AxisName, Axis>,
    /// The points of the design `list`.
    #[serde(default, skip_serializing_if = "ListedPoints::is_empty")]
    #[schema(value_type = Vec<IndexMap<AxisName, f64>>, max_items = 100_000, example = json!([]))]
    pub points: ListedPoints,
    /// Number of points of the designs `latin_hypercube` and `sobol`, 1 to 100,000, which these designs need; usual ten and more
    /// for each axis, and powers of two for `sobol`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 100_000)]
    pub samples: Option<u32>,
    /// Seed of these designs; 0 unless given. For further points of another Latin hypercube give another seed; of a
    /// Sobol sequence, `skip` with the same one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(maximum = 18_446_744_073_709_551_615_u64)]
    pub seed: Option<u64>,
    /// Points at the start of the Sobol sequence to skip, so that a sweep continues another one of the same seed; 0
    /// unless given, below 2^32 with the samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skip: Option<u32>,
    /// Signs of `operation.weight_on_bit` and `operation.torque_on_bit` in this request, as in [`SweepRequest`]; absent means `model`.
    #[serde(default, skip_serializing_if = "Signs::is_model")]
    pub signs: Signs,
    /// Points between neighbours whose classes or values differ, in place of a design.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refine: Option<Refinement>,
}

impl AppendRequest {
    /// The same request in the signs of the model.
    #[must_use]
    pub fn in_model_signs(mut self) -> Self {
        if !std::mem::take(&mut self.signs).is_model() {
            signs::turn_axes(&mut self.axes);
            signs::turn_points(&mut self.points);
        }
        self
    }

    /// The refinement; absent if a design makes the points.
    ///
    /// # Errors
    /// There are both.
    pub fn refinement(&self) -> Result<Option<&Refinement>, Box<ProblemDetails>> {
        let Some(refinement) = &self.refine else { return Ok(None) };
        if (Self { refine: None, ..self.clone() }) != Self::default() {
            let error = FieldProblem {
                pointer: Some("/refine".to_owned()),
                parameter: None,
                got: None,
                detail: "excludes `design`, `axes`, `points`, `samples`, `seed` and `skip`".to_owned(),
            };
            return Err(Box::new(ProblemDetails::invalid_request(vec![error])));
        }
        Ok(Some(refinement))
    }

    /// The request for the added points alone, as a sweep of their own, next to the request `original` of the sweep.
    ///
    /// # Errors
    /// The parameters are not those of the sweep.
    pub fn of(self, original: &SweepRequest) -> Result<SweepRequest, Box<ProblemDetails>> {
        let AppendRequest { design, axes, points, samples, seed, skip, signs: _, refine: _ } = self;
        // The sample is drawn from the points that the sweep lacks, once they are known.
        let request =
            SweepRequest { design, axes, points, samples, seed, skip, verify: None, ..original.clone() };
        let (added, own): (BTreeSet<_>, BTreeSet<_>) = (request.parameters(), original.parameters());
        if added == own {
            return Ok(request);
        }
        let names = |of: &BTreeSet<&str>| of.iter().copied().collect::<Vec<_>>().join(", ");
        let detail = match own.is_empty() {
            true => "the sweep has no parameters, and so one point only".to_owned(),
            false => format!("must be the sweep's parameters: {}", names(&own)),
        };
        let pointer = if request.design == Design::List { "/points" } else { "/axes" };
        let error = FieldProblem {
            pointer: Some(pointer.to_owned()),
            parameter: None,
            got: Some(names(&added).into()),
            detail,
        };
        Err(Box::new(ProblemDetails::invalid_request(vec![error])))
    }
}

impl SweepRequest {
    /// The same request in the signs of the model.
    #[must_use]
    pub fn in_model_signs(mut self) -> Self {
        if !std::mem::take(&mut self.signs).is_model() {
            self.scenario.iter_mut().for_each(|scenario| signs::turn_scenario(scenario));
            self.set.iter_mut().for_each(|(path, value)| signs::turn_change(path, value));
            signs::turn_axes(&mut self.axes);
            signs::turn_points(&mut self.points);
        }
        self
    }

    /// Names of the swept parameters.
    pub fn names(&self) -> impl Iterator<Item = &AxisName> {
        self.axes.keys().chain(self.points.names())
    }

    /// Number of points, by the design; none of a grid with more than can be counted.
    pub fn point_count(&self) -> Option<usize> {
        let counts = self.axes.values().filter_map(Axis::count);
        match self.design {
            Design::Grid => counts.into_iter().try_fold(1, usize::checked_mul),
            Design::Zip => Some(counts.max().unwrap_or(1)),
            Design::List => Some(self.points.len()),
            Design::LatinHypercube | Design::Sobol => Some(self.samples.unwrap_or(1) as usize),
        }
    }

    /// Paths of the swept parameters.
    fn parameters(&self) -> BTreeSet<&str> {
        self.names().map(AxisName::scenario_path).collect()
    }
}

/// Changes to a sweep; absent fields stay as they are.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepPatch {
    /// A name for people; `null` takes it away.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    #[schema(value_type = Option<String>, min_length = 1, max_length = 200, pattern = r"^\P{Cc}*$")]
    pub name: Option<Option<String>>,
    /// Higher goes first among the sweeps of one owner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = -10, maximum = 10)]
    pub priority: Option<i32>,
    /// Words to find it by, in place of those that it has.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "bounded::new_tags")]
    #[schema(max_items = 20, value_type = Option<Vec<Tag>>)]
    pub tags: Option<BTreeSet<String>>,
    /// True to keep the sweep and its data regardless of age.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pinned: Option<bool>,
    /// Time from which the sweep may be deleted, once all its points are final and unless it is pinned; `null` means never.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "time")]
    #[schema(value_type = Option<Timestamp>)]
    pub expires: Option<Option<Timestamp>>,
}

/// A member that is present, also as `null`.
fn given<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<Option<T>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}

/// A time that is present, also as `null`.
fn time<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<Timestamp>>, D::Error> {
    let expected = |_| D::Error::custom("must be a time such as 2026-12-31T00:00:00Z (RFC 3339), or null");
    given(deserializer).map_err(expected)
}

/// Design that makes points from the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Every value of every axis with every value of the others.
    #[default]
    Grid,
    /// The first values of all axes together, then the second ones, and so on: axes of equal length.
    Zip,
    /// The `points` as listed.
    List,
    /// `samples` points, on each axis one in each of as many equal parts (McKay, Beckman and Conover 1979). Axes are
    /// intervals without a count, or lists to pick from.
    LatinHypercube,
    /// `samples` points of the Sobol sequence (direction numbers of Joe and Kuo 2008) with a digital shift by the seed:
    /// spread evenly at any number of points, best at powers of two. Axes as for the Latin hypercube.
    Sobol,
}

impl Design {
    /// True if the design draws values from the axes' intervals, rather than taking the axes' own.
    pub(crate) fn is_drawn(self) -> bool {
        matches!(self, Design::LatinHypercube | Design::Sobol)
    }
}
