//! From a request to the points to compute, or to everything that is wrong with it.

use std::collections::BTreeSet;
use std::iter::{once, repeat};

use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::scenario::{
    Accuracy, AccuracyPreset, Outputs, PRESETS, Problem, Problems, Scenario, ScenarioRequest, Warning,
};
use drillsweep_sim::transient::step_problem;
use indexmap::{IndexMap, IndexSet};
use serde_json::{Map, Value, json};

use crate::axis::Axis;
use crate::design::{SOBOL_AXES, Sobol, latin_hypercube};
use crate::problem::{FieldProblem, ProblemDetails, pointer_token};
use crate::request::{AppendRequest, AxisName, Design, SweepPatch, SweepRequest};
use crate::service::LIMITS;
use crate::verify::{sample, verify_problem};

/// Problems of one request that are reported at most: a hundred thousand points may each have their own.
const MOST_PROBLEMS: usize = 100;

/// What a request expands into: one scenario, and what each point changes in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Expansion {
    /// Preset or scenario with the changes of the request. At the swept fields it has the values of point 1.
    pub base: Scenario,
    /// The swept parameters, in order.
    pub axes: Vec<AxisName>,
    /// The points, by ordinal.
    pub points: Vec<SweepPoint>,
    /// The reference runs that verify some of the points, as [`Expansion::references`] gives them, where the request wants some.
    pub verification: Option<Box<Expansion>>,
    /// What can be simulated but is probably not meant, with JSON Pointers into the request.
    pub warnings: Vec<FieldProblem>,
}

/// One point to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPoint {
    /// Number of the point in its sweep, from 1.
    pub ordinal: u32,
    /// The values of the swept parameters, in the order of the axes.
    pub values: Vec<f64>,
    /// Content hash of physics version and scenario: equal keys, equal results.
    pub key: PointKey,
    /// The key of the same point with everything kept, where this one keeps less: its result will do.
    pub fuller_key: Option<PointKey>,
}

impl SweepPoint {
    /// The point of this scenario, which is left as it was.
    fn new(ordinal: u32, values: Vec<f64>, scenario: &mut Scenario) -> Self {
        let key_of_point = key(scenario);
        let fuller_key = (scenario.recording.outputs != Outputs::Full).then(|| {
            let outputs = std::mem::take(&mut scenario.recording.outputs);
            let fuller = key(scenario);
            scenario.recording.outputs = outputs;
            fuller
        });
        SweepPoint { ordinal, values, key: key_of_point, fuller_key }
    }
}

/// The content hash of a point.
pub type PointKey = [u8; 32];

/// A point's key as it is written on the wire, in hexadecimal.
pub fn key_text(key: &PointKey) -> String {
    blake3::Hash::from_bytes(*key).to_hex().to_string()
}

impl Expansion {
    /// The scenario to simulate at a point of this expansion.
    pub fn scenario(&self, point: &SweepPoint) -> Scenario {
        let mut scenario = self.base.clone();
        for (name, &value) in self.axes.iter().zip(&point.values) {
            // Each of these was made once, when the point was validated.
            let _ = set_number(&mut scenario, name.scenario_path(), value);
        }
        scenario
    }

    /// What a point changes in the base, by path: with [`compose`] the point's scenario again.
    pub fn changes(&self, point: &SweepPoint) -> Map<String, Value> {
        let change = |(name, value): (&AxisName, &f64)| (name.scenario_path().to_owned(), number(*value));
        self.axes.iter().zip(&point.values).map(change).collect()
    }

    /// The swept parameters of a point in the order of the axes, then the scenario's other parameters with a name.
    pub fn parameters(&self, point: &SweepPoint) -> IndexMap<String, f64> {
        let swept =
            self.axes.iter().zip(&point.values).map(|(name, value)| (name.as_str().to_owned(), *value));
        let is_swept = |path: &str| self.axes.iter().any(|name| name.scenario_path() == path);
        let mud = self.base.mud.as_ref();
        let others =
            AxisName::NAMED.into_iter().filter(|(_, path)| !is_swept(path)).filter_map(|(name, _)| {
                let value = if name == "flow_rate" { mud?.flow_rate } else { mud?.density };
                Some((name.to_owned(), value))
            });
        swept.chain(others).collect()
    }

    /// The reference runs that verify the points at these indices: the same scenarios at the accuracy `reference`, under the points'
    /// ordinals. Parameters of the accuracy itself are left out.
    ///
    /// # Errors
    /// When there is nothing to verify, or the reference cannot run such a point; of the request as a whole.
    pub fn references(&self, indices: &[usize]) -> Result<Expansion, Box<ProblemDetails>> {
        let mut problems = Found::default();
        let references = references(self, indices, "", &mut problems);
        match problems.0.is_empty() {
            true => Ok(references),
            false => Err(Box::new(ProblemDetails::invalid_request(problems.into_vec()))),
        }
    }
}

/// The scenario of a stored point: its base with its changes, both as JSON text.
///
/// # Errors
/// When either text is not what a release of the same physics version writes.
pub fn compose(base: &str, changes: &str) -> Result<Scenario, Problem> {
    let mut scenario = Scenario::from_json(base)?;
    let malformed = |error: serde_json::Error| Problem {
        path: String::new(),
        got: String::new(),
        message: format!("the point's changes cannot be read: {error}"),
    };
    let changes: IndexMap<String, f64> = serde_json::from_str(changes).map_err(malformed)?;
    for (path, value) in changes {
        set_number(&mut scenario, &path, value)?;
    }
    Ok(scenario)
}

/// The points of a request, every one of them validated.
///
/// In a grid points are ordered like the digits of a counter: the last axis turns fastest, the first slowest.
///
/// # Errors
/// Every distinct problem of the request and of any of its points, once, with JSON Pointers into the request; of very
/// many the first hundred.
pub fn expand(request: &SweepRequest) -> Result<Expansion, Box<ProblemDetails>> {
    let mut problems = Found::default();
    check_members(request, &mut problems);
    let layout = Layout::new(request, &mut problems);
    let expansion = resolve(request, &mut problems).and_then(|mut base| {
        let Some(layout) = layout else {
            check_without_axes(request, &base, &mut problems);
            return None;
        };
        let fields_hold = set_fields(request, &layout, &mut base, &mut problems);
        if fields_hold {
            let mut expansion = points(request, &layout, base, &mut problems);
            if let Some(verify) = request.verify.filter(|_| problems.0.is_empty()) {
                let total = expansion.points.len();
                let sample = sample(verify, total, 0, total);
                expansion.verification =
                    Some(Box::new(references(&expansion, &sample, "/verify", &mut problems)));
            }
            return Some(expansion);
        }
        check_without_axes(request, &base, &mut problems);
        None
    });
    match expansion {
        Some(expansion) if problems.0.is_empty() => Ok(expansion),
        _ => Err(Box::new(ProblemDetails::invalid_request(problems.into_vec()))),
    }
}

/// The points that are to be added to the sweep that `original` asked for, as a sweep of their own. Their parameters have the
/// names that they have in that sweep.
///
/// # Errors
/// As [`expand`]; also if their parameters are not those of the sweep.
pub fn expand_added(added: AppendRequest, original: &SweepRequest) -> Result<Expansion, Box<ProblemDetails>> {
    let mut expansion = expand(&added.of(original)?)?;
    for name in &mut expansion.axes {
        if let Some(known) = original.names().find(|known| known.scenario_path() == name.scenario_path()) {
            *name = known.clone();
        }
    }
    Ok(expansion)
}

/// The content hash of a scenario: BLAKE3 over a domain tag, the physics version and the scenario's
/// canonical bytes.
pub fn key(scenario: &Scenario) -> PointKey {
    let mut hasher = blake3::Hasher::new();
    hasher.update(b"drillsweep point\0");
    hasher.update(&PHYSICS_VERSION.to_le_bytes());
    hasher.update(&scenario.canonical_bytes());
    hasher.finalize().into()
}

/// Sets a numeric field. Whole numbers go by way of the written form, which says what is wrong with others.
fn set_number(scenario: &mut Scenario, path: &str, value: f64) -> Result<(), Problem> {
    match scenario.number_mut(path) {
        Some(number) => *number = value,
        None => {
            let refused = |problem: Problem| match problem.got.as_str() {
                "" => problem,
                _ => Problem { got: number(value).to_string(), ..problem },
            };
            *scenario = scenario.with(path, number(value)).map_err(refused)?;
        }
    }
    Ok(())
}

/// A number as JSON, a whole one without its decimal point.
fn number(value: f64) -> Value {
    const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;
    if value.fract() == 0.0 && value.abs() <= LARGEST_WHOLE && !(value == 0.0 && value.is_sign_negative()) {
        json!(value as i64)
    } else {
        json!(value)
    }
}

/// How the points of a request get their values.
struct Layout<'a> {
    request: &'a SweepRequest,
    names: Vec<AxisName>,
    total: usize,
    draw: Draw,
}

enum Draw {
    /// The values are the axes' or the points' own.
    Listed,
    /// Fractions by axis and point.
    LatinHypercube(Vec<Vec<f64>>),
    /// Fractions from a sequence, from this point on.
    Sobol(Sobol, u32),
}

impl<'a> Layout<'a> {
    /// Checks design and axes against each other; what is wrong is noted.
    fn new(request: &'a SweepRequest, problems: &mut Found) -> Option<Self> {
        let before = problems.0.len();
        let design = request.design;
        let names: Vec<AxisName> = match design {
            Design::List => {
                request.points.first().map(|point| point.keys().cloned().collect()).unwrap_or_default()
            }
            _ => request.axes.keys().cloned().collect(),
        };
        check_design_members(request, problems);
        for (name, axis) in &request.axes {
            let pointer = axis_pointer(name);
            for (member, got, detail) in axis.problems() {
                problems.push(format!("{pointer}{member}"), Some(got), detail);
            }
            match axis {
                Axis::Range { count, .. } if design.is_drawn() => {
                    let detail = "is not given in this design: `samples` says how many points there are";
                    problems.push(format!("{pointer}/count"), Some((*count).into()), detail);
                }
                Axis::Interval { .. } if !design.is_drawn() => {
                    problems.push(pointer, None, "a range needs `count` too");
                }
                _ => {}
            }
        }
        check_names(request, &names, problems);
        let total = match design {
            Design::Grid => request
                .axes
                .values()
                .try_fold(1, |total: usize, axis| total.checked_mul(axis.count().unwrap_or(1))),
            Design::Zip => Some(request.axes.values().filter_map(Axis::count).max().unwrap_or(1)),
            Design::List => Some(request.points.len()),
            Design::LatinHypercube | Design::Sobol => Some(request.samples.unwrap_or(1) as usize),
        };
        let limit = LIMITS.points_per_sweep;
        if total.is_none_or(|total| total > limit) {
            let (pointer, got) = match design {
                Design::List => ("/points", json!(request.points.len())),
                Design::LatinHypercube | Design::Sobol => ("/samples", json!(request.samples)),
                Design::Grid | Design::Zip => {
                    let counts = request.axes.values().filter_map(Axis::count).map(|count| count.to_string());
                    ("/axes", counts.collect::<Vec<_>>().join(" x ").into())
                }
            };
            problems.push(pointer, Some(got), format!("a sweep has at most {limit} points"));
        }
        if problems.0.len() > before {
            return None;
        }
        let (total, seed, skip) = (total?, request.seed.unwrap_or(0), request.skip.unwrap_or(0));
        let draw = match design {
            Design::Grid | Design::Zip | Design::List => Draw::Listed,
            Design::LatinHypercube => Draw::LatinHypercube(latin_hypercube(names.len(), total, seed)),
            Design::Sobol => Draw::Sobol(Sobol::new(names.len(), seed), skip),
        };
        Some(Layout { request, names, total, draw })
    }

    /// The values of point `number`, from 0, in the order of the axes.
    fn values(&self, number: usize) -> Vec<f64> {
        let axes = self.request.axes.values();
        match &self.draw {
            Draw::Listed if self.request.design == Design::List => {
                let point = &self.request.points[number];
                self.names.iter().filter_map(|name| point.get(name).copied()).collect()
            }
            Draw::Listed => axes.zip(self.indices(number)).map(|(axis, index)| axis.value(index)).collect(),
            Draw::LatinHypercube(fractions) => {
                axes.zip(fractions).map(|(axis, fractions)| axis.at(fractions[number])).collect()
            }
            Draw::Sobol(sobol, skip) => {
                let number = skip.wrapping_add(number as u32);
                axes.zip(0..).map(|(axis, index)| axis.at(sobol.fraction(number, index))).collect()
            }
        }
    }

    /// The index on each axis of point `number` of a grid or a zip.
    fn indices(&self, mut number: usize) -> Vec<usize> {
        if self.request.design == Design::Zip {
            return vec![number; self.names.len()];
        }
        let digit = |axis: &Axis| {
            let count = axis.count().unwrap_or(1);
            let index = number % count;
            number /= count;
            index
        };
        let mut indices: Vec<usize> = self.request.axes.values().rev().map(digit).collect();
        indices.reverse();
        indices
    }

    /// Where in the request the value of an axis at point `number` is written.
    fn pointer(&self, number: usize, axis: usize) -> String {
        let name = &self.names[axis];
        match (self.request.design, self.request.axes.get(name)) {
            (Design::List, _) | (_, None) => format!("/points/{number}/{}", pointer_token(name.as_str())),
            (Design::Grid | Design::Zip, Some(values)) => {
                format!("{}{}", axis_pointer(name), values.member(self.indices(number)[axis]))
            }
            (Design::LatinHypercube | Design::Sobol, Some(_)) => axis_pointer(name),
        }
    }

    /// Where in the request a field of the scenario is decided at point `number`, if by an axis.
    fn place(&self, number: usize, path: &str) -> Option<String> {
        let axis = self.names.iter().position(|name| name.scenario_path() == path)?;
        Some(self.pointer(number, axis))
    }

    /// The first point, and for every axis those with its least and greatest value.
    fn extremes(&self, points: &[SweepPoint]) -> IndexSet<usize> {
        let mut extremes = IndexSet::from([0]);
        for axis in 0..self.names.len() {
            let by_value = |a: &usize, b: &usize| points[*a].values[axis].total_cmp(&points[*b].values[axis]);
            extremes.extend((0..points.len()).min_by(by_value));
            extremes.extend((0..points.len()).max_by(by_value));
        }
        extremes
    }
}

/// Whether members are given that the design does not know, or not given that it needs.
fn check_design_members(request: &SweepRequest, problems: &mut Found) {
    let design = request.design;
    if design == Design::List {
        if request.points.is_empty() {
            problems.push("/points", Some(json!([])), "the design `list` needs at least one point");
        }
        if !request.axes.is_empty() {
            problems.push("/axes", None, "is not given in the design `list`: the points have their values");
        }
    } else if !request.points.is_empty() {
        problems.push("/points", None, "is given in the design `list` only");
    }
    match (design.is_drawn(), request.samples) {
        (true, None | Some(0)) => {
            problems.push("/samples", request.samples.map(Value::from), "must be given, 1 or more");
        }
        (false, Some(samples)) => {
            let detail = "is given in the designs `latin_hypercube` and `sobol` only";
            problems.push("/samples", Some(samples.into()), detail);
        }
        _ => {}
    }
    if let Some(seed) = request.seed.filter(|_| !design.is_drawn()) {
        let detail = "is given in the designs `latin_hypercube` and `sobol` only";
        problems.push("/seed", Some(seed.into()), detail);
    }
    if let Some(skip) = request.skip {
        let detail = match design {
            Design::Sobol => "skip and samples must stay below 4294967296 together",
            _ => "is given in the design `sobol` only",
        };
        if design != Design::Sobol || skip.checked_add(request.samples.unwrap_or(0)).is_none() {
            problems.push("/skip", Some(skip.into()), detail);
        }
    }
    if design == Design::Zip {
        let counts: IndexSet<_> = request.axes.values().filter_map(Axis::count).collect();
        if counts.len() > 1 {
            let counts: Vec<_> = counts.iter().map(usize::to_string).collect();
            let detail = "the axes of the design `zip` must have the same number of values";
            problems.push("/axes", Some(counts.join(" and ").into()), detail);
        }
    }
    if design != Design::Grid && design != Design::List && request.axes.is_empty() {
        problems.push("/axes", None, "this design needs at least one axis");
    }
}

/// Whether every field is swept once, and every listed point has the same parameters.
fn check_names(request: &SweepRequest, names: &[AxisName], problems: &mut Found) {
    if names.len() > SOBOL_AXES {
        let detail = format!("a sweep has at most {SOBOL_AXES} axes");
        problems.push("/axes", Some(names.len().into()), detail);
    }
    for (index, name) in names.iter().enumerate() {
        if let Some(other) = names[..index].iter().find(|other| other.scenario_path() == name.scenario_path())
        {
            let pointer = match request.design {
                Design::List => format!("/points/0/{}", pointer_token(name.as_str())),
                _ => axis_pointer(name),
            };
            problems.push(pointer, None, format!("is the same field as {}", other.as_str()));
        }
    }
    for (number, point) in request.points.iter().enumerate() {
        if point.len() != names.len() || !names.iter().all(|name| point.contains_key(name)) {
            let names: Vec<_> = names.iter().map(AxisName::as_str).collect();
            let detail = format!("must have the same parameters as the first point: {}", names.join(", "));
            problems.push(format!("/points/{number}"), None, detail);
        }
    }
}

fn axis_pointer(name: &AxisName) -> String {
    format!("/axes/{}", pointer_token(name.as_str()))
}

/// Sets the swept fields to the values of the first point; false where one of them is no numeric field.
fn set_fields(
    request: &SweepRequest,
    layout: &Layout<'_>,
    base: &mut Scenario,
    problems: &mut Found,
) -> bool {
    let before = problems.0.len();
    for (axis, (name, value)) in layout.names.iter().zip(layout.values(0)).enumerate() {
        if let Err(problem) = set_number(base, name.scenario_path(), value) {
            let pointer = match request.design {
                Design::List => layout.pointer(0, axis),
                _ => axis_pointer(name),
            };
            let got = (!problem.got.is_empty()).then(|| number(value));
            problems.push(pointer, got, format!("{}: {}", problem.path, problem.message));
        }
    }
    problems.0.len() == before
}

/// All points. The first is validated in full, the others where the axes may have made a difference.
fn points(request: &SweepRequest, layout: &Layout<'_>, base: Scenario, problems: &mut Found) -> Expansion {
    let mut warnings = Found::default();
    let mut points = Vec::with_capacity(layout.total);
    let mut scenario = base.clone();
    let paths: Vec<&str> = layout.names.iter().map(AxisName::scenario_path).collect();
    for (index, ordinal) in (0..layout.total).zip(1..) {
        let values = layout.values(index);
        let set =
            paths.iter().zip(&values).try_for_each(|(path, value)| set_number(&mut scenario, path, *value));
        let checked = set.map_err(Problems::from).and_then(|()| match index {
            0 => scenario.validate(),
            _ => scenario.validate_changes(paths.iter().copied()),
        });
        match checked {
            Ok(of_scenario) => {
                for Warning { path, message } in of_scenario {
                    let problem = Problem { path, got: String::new(), message };
                    warnings.add(request, |path| layout.place(index, path), &problem);
                }
            }
            Err(Problems(of_scenario)) => {
                for problem in &of_scenario {
                    problems.add(request, |path| layout.place(index, path), problem);
                }
                if problems.0.len() >= MOST_PROBLEMS {
                    break;
                }
                continue;
            }
        }
        points.push(SweepPoint::new(ordinal, values, &mut scenario));
    }
    let warnings = warnings.into_vec();
    let expansion = Expansion { base, axes: layout.names.clone(), points, verification: None, warnings };
    // The stability limit of an explicit step takes an equilibrium to find: the extreme points stand for all.
    if problems.0.is_empty() {
        for index in layout.extremes(&expansion.points) {
            if let Some(problem) = step_problem(&expansion.scenario(&expansion.points[index])) {
                problems.add(request, |path| layout.place(index, path), &problem);
            }
        }
    }
    expansion
}

/// The reference runs of [`Expansion::references`]; what is wrong is noted at this pointer. The first is validated in full, the others where the axes may have made a
/// difference.
fn references(expansion: &Expansion, indices: &[usize], pointer: &str, problems: &mut Found) -> Expansion {
    let mut base = expansion.base.clone();
    let reference = Accuracy::Preset(AccuracyPreset::Reference);
    if base.accuracy == reference {
        problems.push(
            pointer,
            None,
            "the points are of the accuracy `reference` already, which verifies others",
        );
    }
    if base.cost_study.is_some() || !base.active_effects().transient {
        problems.push(
            pointer,
            None,
            "there is no run in time to verify: a cost study, or an equilibrium alone",
        );
    }
    base.accuracy = reference;
    let kept: Vec<usize> = (0..expansion.axes.len())
        .filter(|axis| !expansion.axes[*axis].scenario_path().starts_with("accuracy."))
        .collect();
    let axes: Vec<AxisName> = kept.iter().map(|axis| expansion.axes[*axis].clone()).collect();
    let paths: Vec<&str> = axes.iter().map(AxisName::scenario_path).collect();
    let mut scenario = base.clone();
    let mut points = Vec::with_capacity(indices.len());
    for (point, is_first) in
        indices.iter().map(|index| &expansion.points[*index]).zip(once(true).chain(repeat(false)))
    {
        let values: Vec<f64> = kept.iter().map(|axis| point.values[*axis]).collect();
        let set =
            paths.iter().zip(&values).try_for_each(|(path, value)| set_number(&mut scenario, path, *value));
        let checked = set.map_err(Problems::from).and_then(|()| match is_first {
            true => scenario.validate(),
            false => scenario.validate_changes(paths.iter().copied()),
        });
        match checked {
            Ok(_) => points.push(SweepPoint::new(point.ordinal, values, &mut scenario)),
            // The point itself is valid: it is the reference that the scenario does not allow.
            Err(Problems(of_scenario)) => {
                for Problem { path, message, .. } in of_scenario {
                    problems.push(pointer, None, format!("the reference cannot run this: {path}: {message}"));
                }
            }
        }
    }
    Expansion { base, axes, points, verification: None, warnings: Vec::new() }
}

/// The scenario that the axes are applied to: preset or scenario, with the changes of `set`.
fn resolve(request: &SweepRequest, problems: &mut Found) -> Option<Scenario> {
    match (&request.preset, &request.scenario) {
        (Some(_), Some(_)) => problems.push("", None, "`preset` and `scenario` exclude each other; give one"),
        (None, None) => problems.push("", None, "either `preset` or `scenario` must be given"),
        (Some(name), None) if !PRESETS.iter().any(|(preset, _)| preset == name) => {
            let names: Vec<_> = PRESETS.iter().map(|(name, _)| *name).collect();
            let detail = format!("there is no such preset; there are {}", names.join(", "));
            problems.push("/preset", Some(name.as_str().into()), detail);
        }
        _ => {
            let scenario = ScenarioRequest {
                preset: request.preset.clone(),
                scenario: request.scenario.as_deref().cloned(),
                set: request.set.clone(),
            };
            match scenario.resolve() {
                Ok(mut scenario) => {
                    if let Some(outputs) = &request.outputs {
                        scenario.recording.outputs = outputs.clone();
                    }
                    return Some(scenario);
                }
                Err(Problems(of_set)) => {
                    for problem in of_set {
                        problems.add(request, |_| None, &problem);
                    }
                }
            }
        }
    }
    None
}

/// Checks the members of a change of a sweep.
///
/// # Errors
/// Everything that is wrong with them, with JSON Pointers into the body.
pub fn check_patch(patch: &SweepPatch) -> Result<(), Box<ProblemDetails>> {
    let mut problems = Found::default();
    let name = patch.name.as_ref().and_then(Option::as_ref);
    check_text("/name", name, LIMITS.name_length, &mut problems);
    if let Some(priority) = patch.priority {
        check_priority(priority, &mut problems);
    }
    if let Some(tags) = &patch.tags {
        check_tags(tags, &mut problems);
    }
    match problems.0.is_empty() {
        true => Ok(()),
        false => Err(Box::new(ProblemDetails::invalid_request(problems.into_vec()))),
    }
}

fn check_members(request: &SweepRequest, problems: &mut Found) {
    check_text("/name", request.name.as_ref(), LIMITS.name_length, problems);
    check_text("/owner", request.owner.as_ref(), LIMITS.owner_length, problems);
    check_priority(request.priority, problems);
    check_tags(&request.tags, problems);
    if let Some((verify, detail)) = request.verify.and_then(|verify| Some((verify, verify_problem(verify)?)))
    {
        problems.push("/verify", Some(number(verify)), detail);
    }
}

fn check_text(pointer: &str, text: Option<&String>, limit: usize, problems: &mut Found) {
    if let Some(text) = text.filter(|text| text.is_empty() || text.chars().count() > limit) {
        let detail = format!("must have 1 to {limit} characters");
        problems.push(pointer, Some(text.as_str().into()), detail);
    }
}

fn check_priority(priority: i32, problems: &mut Found) {
    let (lowest, highest) = (LIMITS.lowest_priority, LIMITS.highest_priority);
    if !(lowest..=highest).contains(&priority) {
        let detail = format!("must be between {lowest} and {highest}");
        problems.push("/priority", Some(priority.into()), detail);
    }
}

fn check_tags(tags: &BTreeSet<String>, problems: &mut Found) {
    let (most, length) = (LIMITS.tags_per_sweep, LIMITS.tag_length);
    if tags.len() > most {
        problems.push("/tags", Some(tags.len().into()), format!("a sweep has at most {most} tags"));
    }
    for (index, tag) in tags.iter().enumerate() {
        check_text(&format!("/tags/{index}"), Some(tag), length, problems);
    }
}

/// The problems of the scenario itself, when the axes cannot be expanded: a sweep's other mistakes are not
/// kept back until its axes are right. What the axes would replace is not looked at.
fn check_without_axes(request: &SweepRequest, scenario: &Scenario, problems: &mut Found) {
    let Err(Problems(of_scenario)) = scenario.validate() else { return };
    let names = request.axes.keys().chain(request.points.iter().flat_map(IndexMap::keys));
    let replaced: IndexSet<&str> = names.map(AxisName::scenario_path).collect();
    for problem in of_scenario.iter().filter(|problem| !replaced.contains(problem.path.as_str())) {
        problems.add(request, |_| None, problem);
    }
}

/// Distinct problems, in the order in which they were found, up to [`MOST_PROBLEMS`].
#[derive(Default)]
struct Found(IndexMap<(String, String), Option<Value>>);

impl Found {
    fn push(&mut self, pointer: impl Into<String>, got: Option<Value>, detail: impl Into<String>) {
        if self.0.len() < MOST_PROBLEMS {
            self.0.entry((pointer.into(), detail.into())).or_insert(got);
        }
    }

    /// Notes a problem of a scenario, at the place of the request that decides the field: `place` knows the axes'.
    fn add(&mut self, request: &SweepRequest, place: impl Fn(&str) -> Option<String>, problem: &Problem) {
        let got = match problem.got.as_str() {
            "" => None,
            got => Some(serde_json::from_str(got).unwrap_or_else(|_| got.into())),
        };
        let message = &problem.message;
        if let Some(pointer) = place(&problem.path) {
            return self.push(pointer, got, message);
        }
        match written(request, &problem.path) {
            (pointer, false) => self.push(pointer, got, message),
            (pointer, true) => self.push(pointer, got, format!("{}: {message}", problem.path)),
        }
    }

    fn into_vec(self) -> Vec<FieldProblem> {
        let problem =
            |((pointer, detail), got)| FieldProblem { pointer: Some(pointer), parameter: None, got, detail };
        self.0.into_iter().map(problem).collect()
    }
}

/// Where in a request a field of the scenario is written outside the axes, and whether that is the preset that it
/// names rather than the field itself.
fn written(request: &SweepRequest, path: &str) -> (String, bool) {
    let field = scenario_pointer(path);
    if let Some(rest) = field.strip_prefix("/recording/outputs").filter(|_| request.outputs.is_some()) {
        return (format!("/outputs{rest}"), false);
    }
    // The longest path wins: it was applied last.
    let of_set = request
        .set
        .keys()
        .filter_map(|path| Some((path, field.strip_prefix(&scenario_pointer(path))?)))
        .filter(|(path, rest)| rest.is_empty() || (rest.starts_with('/') && !path.is_empty()))
        .max_by_key(|(path, _)| path.len());
    if let Some((path, rest)) = of_set {
        return (format!("/set/{}{rest}", pointer_token(path)), false);
    }
    match request.scenario {
        Some(_) => (format!("/scenario{field}"), false),
        None => ("/preset".to_owned(), true),
    }
}

/// The path of a field, such as `string.sections[1].count`, as a JSON Pointer into the scenario.
fn scenario_pointer(path: &str) -> String {
    Problem { path: path.to_owned(), got: String::new(), message: String::new() }.pointer()
}

#[cfg(test)]
mod tests {
    use super::*;
    use drillsweep_sim::scenario::preset;
    use serde_json::json;

    fn request(body: Value) -> SweepRequest {
        serde_json::from_value(body).unwrap()
    }

    fn problems(body: Value) -> Vec<(String, Option<Value>, String)> {
        let details = expand(&request(body)).expect_err("the request must be refused");
        assert_eq!(details.status, 422);
        let of = |error: FieldProblem| (error.pointer.unwrap_or_default(), error.got, error.detail);
        details.errors.into_iter().map(of).collect()
    }

    fn pointers(body: Value) -> Vec<String> {
        problems(body).into_iter().map(|(pointer, ..)| pointer).collect()
    }

    #[test]
    fn the_first_axis_varies_slowest() {
        let flow_first = json!({"preset": "paper-200m", "axes": {
            "flow_rate": {"values": [0.01, 0.04]},
            "mud_density": {"from": 1200, "to": 1800, "count": 3}
        }});
        let order = |body| -> Vec<_> {
            let expansion = expand(&request(body)).unwrap();
            let values = |point: &SweepPoint| {
                let mud = expansion.scenario(point).mud.unwrap();
                let parameters = expansion.parameters(point);
                assert_eq!(parameters["flow_rate"], mud.flow_rate);
                assert_eq!(parameters["mud_density"], mud.density);
                (point.ordinal, mud.flow_rate, mud.density)
            };
            expansion.points.iter().map(values).collect()
        };
        assert_eq!(
            order(flow_first),
            [
                (1, 0.01, 1200.0),
                (2, 0.01, 1500.0),
                (3, 0.01, 1800.0),
                (4, 0.04, 1200.0),
                (5, 0.04, 1500.0),
                (6, 0.04, 1800.0)
            ]
        );
        // Through text: a JSON value would sort the names.
        let density_first: SweepRequest = serde_json::from_str(
            r#"{"preset": "paper-200m", "axes": {
                "mud_density": {"values": [1200, 1500]}, "flow_rate": {"values": [0.01, 0.04]}}}"#,
        )
        .unwrap();
        let values: Vec<_> =
            expand(&density_first).unwrap().points.into_iter().map(|point| point.values).collect();
        assert_eq!(values, [[1200.0, 0.01], [1200.0, 0.04], [1500.0, 0.01], [1500.0, 0.04]]);
    }

    #[test]
    fn equal_points_have_equal_keys_however_they_are_asked_for() {
        let key_of = |body| key_text(&expand(&request(body)).unwrap().points[0].key);
        let by_preset = key_of(json!({"preset": "paper-200m"}));
        let mut scenario = serde_json::to_value(preset("paper-200m").unwrap()).unwrap();
        scenario["name"] = "another name".into();
        let mud = scenario["mud"].clone();
        let by_scenario = key_of(json!({"scenario": scenario}));
        let by_set = key_of(json!({"preset": "paper-200m", "set": {"mud.flow_rate": mud["flow_rate"]}}));
        let by_axis =
            key_of(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [mud["flow_rate"]]}}}));
        assert_eq!(by_preset, by_scenario);
        assert_eq!(by_preset, by_set);
        assert_eq!(by_preset, by_axis);
        assert_ne!(by_preset, key_of(json!({"preset": "paper-200m", "set": {"mud.flow_rate": 0.02}})));
        assert_eq!(by_preset.len(), 64);
    }

    #[test]
    fn what_is_kept_belongs_to_the_point_and_is_checked_where_it_was_written() {
        let of = |outputs: Value| json!({"preset": "paper-200m", "outputs": outputs});
        let key_of = |body| expand(&request(body)).unwrap().points[0].key;
        let whole = key_of(json!({"preset": "paper-200m"}));
        assert_eq!(key_of(of(json!("full"))), whole);
        assert_ne!(key_of(of(json!("summary"))), whole);
        let fuller = |body| expand(&request(body)).unwrap().points[0].fuller_key;
        assert_eq!(fuller(of(json!("summary"))), Some(whole));
        assert_eq!(fuller(of(json!("full"))), None);
        let by_path = json!({"preset": "paper-200m", "set": {"recording.outputs": "summary"}});
        assert_eq!(key_of(of(json!("summary"))), key_of(by_path));
        let found = problems(of(json!({"orbits": {"nodes": [{"node": 49}, {"node": 48}], "decimation": 0}})));
        let pointers: Vec<_> = found.iter().map(|(pointer, ..)| pointer.as_str()).collect();
        assert_eq!(pointers, ["/outputs/orbits/decimation", "/outputs/orbits/nodes/1/node"]);
    }

    #[test]
    fn a_sample_is_verified_by_the_same_scenarios_at_the_reference() {
        let body = json!({"preset": "paper-200m", "verify": 4, "outputs": "summary", "set": {"accuracy": "draft"}, "axes": {
            "flow_rate": {"from": 0.01, "to": 0.06, "count": 6}, "mud_density": {"from": 1200, "to": 2100, "count": 10}}});
        let expansion = expand(&request(body.clone())).unwrap();
        let references = expansion.verification.as_deref().unwrap();
        assert_eq!(Some(references), expand(&request(body.clone())).unwrap().verification.as_deref());
        let ordinals: Vec<u32> = references.points.iter().map(|point| point.ordinal).collect();
        assert_eq!(ordinals.len(), 4);
        for (k, ordinal) in (0..4).zip(&ordinals) {
            assert!((15 * k + 1..=15 * k + 15).contains(ordinal), "one of each fourth: {ordinals:?}");
        }
        for reference in &references.points {
            let point = &expansion.points[reference.ordinal as usize - 1];
            let wanted = Scenario {
                accuracy: Accuracy::Preset(AccuracyPreset::Reference),
                ..expansion.scenario(point)
            };
            assert_eq!(references.scenario(reference), wanted);
            assert_eq!(
                (reference.key, references.parameters(reference)),
                (key(&wanted), expansion.parameters(point))
            );
            let stored = |of: &Expansion| serde_json::to_string(&of.base).unwrap();
            let changes = serde_json::to_string(&references.changes(reference)).unwrap();
            assert_eq!(compose(&stored(references), &changes).unwrap(), wanted);
        }
        // Who asks for that very point asks for the same work.
        let first = &references.points[0];
        let asked = json!({"preset": "paper-200m", "outputs": "summary", "set": {
            "accuracy": "reference", "mud.flow_rate": first.values[0], "mud.density": first.values[1]}});
        let asked = expand(&request(asked)).unwrap();
        assert_eq!((asked.points[0].key, asked.points[0].fuller_key), (first.key, first.fuller_key));
        assert_eq!(asked.verification, None);

        // What is swept of the accuracy itself does not reach the reference.
        let steps = json!({"preset": "paper-200m", "verify": 2, "set": {"accuracy": {"integrator": "esdirk4", "step": 1e-3}},
            "axes": {"accuracy.step": {"values": [1e-3, 5e-4]}}});
        let references = expand(&request(steps)).unwrap().verification.unwrap();
        assert_eq!(references.points[0].key, references.points[1].key);
        assert!(references.axes.is_empty());
    }

    #[test]
    fn what_cannot_be_verified_is_refused_where_it_was_asked_for() {
        let of = |verify: Value, set: Value| json!({"preset": "paper-200m", "verify": verify, "set": set});
        for verify in [json!(0), json!(-1), json!(1.5), json!(-0.05)] {
            let [(pointer, got, detail)] = problems(of(verify.clone(), json!({}))).try_into().unwrap();
            assert_eq!((pointer.as_str(), got), ("/verify", Some(verify)));
            assert!(detail.contains("a part of the points"), "{detail}");
        }
        for (set, said) in [
            (json!({"accuracy": "reference"}), "accuracy `reference` already"),
            (json!({"effects.transient": "off"}), "no run in time to verify"),
        ] {
            let [(pointer, got, detail)] = problems(of(json!(0.5), set)).try_into().unwrap();
            assert_eq!((pointer.as_str(), got), ("/verify", None));
            assert!(detail.contains(said), "{detail}");
        }
        // Beside other problems only what is wrong with the wish itself.
        assert_eq!(pointers(of(json!(0.5), json!({"duration": -1}))), ["/set/duration"]);
    }

    #[test]
    fn a_run_is_a_sweep_of_one_point() {
        let run: crate::RunRequest =
            serde_json::from_value(json!({"preset": "paper-200m", "set": {"duration": 65}})).unwrap();
        let expansion = expand(&run.into()).unwrap();
        assert_eq!(expansion.points.len(), 1);
        assert_eq!(expansion.points[0].ordinal, 1);
        assert_eq!(expansion.scenario(&expansion.points[0]).duration, 65.0);
    }

    #[test]
    fn every_problem_is_reported_at_once_where_it_was_written() {
        let body = json!({
            "preset": "paper-200m",
            "priority": 11,
            "set": {"mud.flow_index": -1},
            "axes": {
                "flow_rate": {"values": [0.01, 0.04, -0.06]},
                "mud_density": {"from": -5, "to": 2100, "count": 3}
            }
        });
        let mut found = pointers(body);
        found.sort();
        assert_eq!(
            found,
            ["/axes/flow_rate/values/2", "/axes/mud_density/from", "/priority", "/set/mud.flow_index"]
        );
    }

    #[test]
    fn a_problem_of_many_points_is_reported_once() {
        let body = json!({
            "preset": "paper-200m",
            "set": {"mud.flow_index": -1},
            "axes": {"flow_rate": {"from": 0.01, "to": 0.06, "count": 50}}
        });
        let found = problems(body);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].1, Some(json!(-1)));
    }

    #[test]
    fn problems_of_a_whole_scenario_point_into_it() {
        let mut scenario = serde_json::to_value(preset("paper-200m").unwrap()).unwrap();
        scenario["mud"]["flow_index"] = json!(-0.5);
        scenario["contact"]["stiffness"] = json!(-1);
        let mut found = pointers(json!({"scenario": scenario}));
        found.sort();
        assert_eq!(found, ["/scenario/contact/stiffness", "/scenario/mud/flow_index"]);
    }

    #[test]
    fn unsafe_time_stepping_is_refused_with_what_would_be_valid() {
        let of = |accuracy: Value| {
            problems(
                json!({"preset": "paper-200m", "set": {"accuracy": accuracy}, "axes": {"flow_rate": {"values": [0.01, 0.02]}}}),
            )
        };
        let beyond = of(json!({"integrator": "rk4", "step": 1e-4}));
        assert_eq!(beyond.len(), 1, "{beyond:?}");
        // performance.md section 3: the limit is 6.37e-5 s.
        assert!(beyond[0].0.starts_with("/set/accuracy") && beyond[0].2.contains("6.3"), "{beyond:?}");
        let undamped = of(json!({"integrator": "generalized_alpha", "step": 5e-4, "spectral_radius": 1.0}));
        assert!(undamped.len() == 1 && undamped[0].2.contains("0 to 0.95"), "{undamped:?}");
        let one_sweep = of(json!({"integrator": "esdirk4", "step": 1e-3, "contact_sweeps": 1}));
        assert!(one_sweep.len() == 1 && one_sweep[0].2.contains("2 to"), "{one_sweep:?}");
    }

    #[test]
    fn wrong_axes_do_not_keep_other_problems_back() {
        let body = json!({
            "preset": "paper-200m",
            "set": {"mud.flow_index": -1},
            "axes": {"flow_rate": {"from": 0.01, "to": 0.06, "count": 1}, "mud_density": {"values": []}}
        });
        assert_eq!(
            pointers(body),
            ["/axes/flow_rate/count", "/axes/mud_density/values", "/set/mud.flow_index"]
        );
    }

    #[test]
    fn a_sweep_has_a_largest_size() {
        let sweep = |count: u32| {
            json!({"preset": "paper-200m", "axes": {
                "flow_rate": {"from": 0.01, "to": 0.06, "count": 1000},
                "mud_density": {"from": 1200, "to": 2100, "count": count}
            }})
        };
        assert_eq!(expand(&request(sweep(100))).unwrap().points.len(), LIMITS.points_per_sweep);
        assert_eq!(pointers(sweep(101)), ["/axes"]);
        assert_eq!(pointers(sweep(u32::MAX)), ["/axes"]);
    }

    #[test]
    fn a_dry_hole_has_no_mud_to_sweep() {
        let found = problems(json!({"preset": "paper-200m-dry", "axes": {"flow_rate": {"values": [0.01]}}}));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "/axes/flow_rate");
    }

    #[test]
    fn exactly_one_of_preset_and_scenario_is_given() {
        assert_eq!(pointers(json!({})), [""]);
        let scenario = serde_json::to_value(preset("paper-200m").unwrap()).unwrap();
        assert_eq!(pointers(json!({"preset": "paper-200m", "scenario": scenario})), [""]);
        assert_eq!(pointers(json!({"preset": "papre-200m"})), ["/preset"]);
    }

    #[test]
    fn an_override_of_no_field_is_reported_at_its_path() {
        let body =
            json!({"preset": "paper-200m", "set": {"mud.flow_rat": 0.02, "a/b": 1, "duration": "long"}});
        let mut found = pointers(body);
        found.sort();
        assert_eq!(found, ["/set/a~1b", "/set/duration", "/set/mud.flow_rat"]);
    }

    fn expansion(body: Value) -> Expansion {
        expand(&request(body)).unwrap_or_else(|problem| panic!("{problem}"))
    }

    #[test]
    fn every_numeric_field_is_an_axis_by_its_path() {
        let set = json!({"contact.law": "per_length"});
        let expansion = expansion(json!({"preset": "paper-200m", "set": set, "axes": {
            "operation.rotation_speed_rpm": {"values": [90, 120]},
            "contact.stiffness_per_length": {"from": 1e7, "to": 2e7, "count": 2},
            "ensemble": {"values": [4]},
            "accuracy.step": {"values": [1e-3, 5e-4]}
        }}));
        assert_eq!(expansion.points.len(), 8);
        for point in &expansion.points {
            let [speed, stiffness, members, step] = point.values[..] else { panic!("{point:?}") };
            let scenario = preset("paper-200m")
                .unwrap()
                .with("operation.rotation_speed_rpm", json!(speed))
                .and_then(|scenario| scenario.with("contact.law", json!("per_length")))
                .and_then(|scenario| scenario.with("contact.stiffness_per_length", json!(stiffness)))
                .and_then(|scenario| scenario.with("ensemble", json!(members as u32)))
                .and_then(|scenario| scenario.with("accuracy.step", json!(step)))
                .unwrap();
            assert_eq!(expansion.scenario(point), scenario);
            assert_eq!(point.key, key(&scenario));
            // What is stored of the point is the point.
            let changes = Value::Object(expansion.changes(point)).to_string();
            assert_eq!(compose(&expansion.base.to_json(), &changes).unwrap(), scenario);
        }
        let parameters = expansion.parameters(&expansion.points[7]);
        let names: Vec<&str> = parameters.keys().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "operation.rotation_speed_rpm",
                "contact.stiffness_per_length",
                "ensemble",
                "accuracy.step",
                "flow_rate",
                "mud_density"
            ]
        );
    }

    #[test]
    fn axes_that_are_no_numeric_fields_are_refused_by_name() {
        let of = |name: &str| problems(json!({"preset": "paper-200m", "axes": {name: {"values": [1]}}}));
        for (name, detail) in [
            ("mud.flowrate", "no such field; mud has"),
            ("operation.top", "must be"),
            ("mud", "must be"),
            ("string.sections[99].length", "8 entries"),
            ("name", "must be"),
        ] {
            let found = of(name);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].0, format!("/axes/{name}"));
            assert!(found[0].2.contains(detail), "{found:?}");
        }
        let half = problems(json!({"preset": "paper-200m", "axes": {"ensemble": {"values": [8, 7.5]}}}));
        let expected = ("/axes/ensemble/values/1".to_owned(), Some(json!(7.5)));
        assert_eq!(
            half.iter().map(|of| (of.0.clone(), of.1.clone())).collect::<Vec<_>>(),
            [expected],
            "{half:?}"
        );
        let twice = json!({"preset": "paper-200m",
            "axes": {"flow_rate": {"values": [0.01]}, "mud.flow_rate": {"values": [0.02]}}});
        assert_eq!(pointers(twice), ["/axes/mud.flow_rate"]);
    }

    #[test]
    fn what_is_left_out_for_later_points_would_not_have_been_found() {
        // The second point is bad in the one thing that its axis decides, whichever part of the scenario that is in.
        for (path, values) in [
            ("mud.flow_index", [0.5, -0.5]),
            ("contact.stiffness", [1e6, -1.0]),
            ("well.hole_diameter", [0.22, 0.1]),
            ("string.gauges[0].measured_depth", [150.0, 500.0]),
            ("mesh.collar", [0.5, -1.0]),
            ("recording.rate_hz", [1000.0, -1.0]),
            ("duration", [60.0, 0.0]),
            ("damping.mass_proportional", [0.1, -0.1]),
            ("accuracy.step", [1e-3, -1e-3]),
        ] {
            let body = json!({"preset": "paper-200m", "axes": {path: {"values": values}}});
            let found = pointers(body);
            assert!(found.iter().any(|pointer| pointer.starts_with("/")), "{path}: {found:?}");
        }
    }

    #[test]
    fn zip_takes_the_values_of_all_axes_together() {
        let body = |count: u32| {
            json!({"preset": "paper-200m", "design": "zip", "axes": {
                "flow_rate": {"values": [0.01, 0.02, 0.03]},
                "mud_density": {"from": 1200, "to": 1400, "count": count}
            }})
        };
        let values: Vec<_> = expansion(body(3)).points.into_iter().map(|point| point.values).collect();
        assert_eq!(values, [[0.01, 1200.0], [0.02, 1300.0], [0.03, 1400.0]]);
        assert_eq!(pointers(body(4)), ["/axes"]);
    }

    #[test]
    fn listed_points_are_taken_as_they_are() {
        let body = |last: Value| {
            json!({"preset": "paper-200m", "design": "list", "points": [
                {"flow_rate": 0.01, "operation.rotation_speed_rpm": 90},
                {"operation.rotation_speed_rpm": 120, "flow_rate": 0.02},
                last
            ]})
        };
        let last = json!({"flow_rate": 0.01, "operation.rotation_speed_rpm": 100});
        let values: Vec<_> = expansion(body(last)).points.into_iter().map(|point| point.values).collect();
        assert_eq!(values, [[0.01, 90.0], [0.02, 120.0], [0.01, 100.0]]);
        assert_eq!(pointers(body(json!({"flow_rate": 0.01}))), ["/points/2"]);
        let bad = json!({"flow_rate": -1, "operation.rotation_speed_rpm": 100});
        assert_eq!(pointers(body(bad)), ["/points/2/flow_rate"]);
    }

    #[test]
    fn drawn_designs_fill_their_intervals_and_go_on_where_they_ended() {
        let body = |design: &str, samples: u32, skip: Option<u32>| {
            let mut body = json!({"preset": "paper-200m", "design": design, "samples": samples, "seed": 3, "axes": {
                "flow_rate": {"from": 0.01, "to": 0.06},
                "contact.stiffness": {"from": 1e5, "to": 1e7, "scale": "log"},
                "ensemble": {"values": [7, 8, 9]}
            }});
            if let Some(skip) = skip {
                body["skip"] = json!(skip);
            }
            body
        };
        for design in ["latin_hypercube", "sobol"] {
            let points = expansion(body(design, 64, None)).points;
            assert_eq!(points.len(), 64);
            let in_lower_half =
                |axis: usize, middle: f64| points.iter().filter(|point| point.values[axis] < middle).count();
            assert_eq!((in_lower_half(0, 0.035), in_lower_half(1, 1e6)), (32, 32), "{design}");
            assert!((20..=22).contains(&in_lower_half(2, 8.0)), "{design}");
        }
        let whole = expansion(body("sobol", 10, None)).points;
        let rest = expansion(body("sobol", 6, Some(4))).points;
        let keys = |points: &[SweepPoint]| points.iter().map(|point| point.key).collect::<Vec<_>>();
        assert_eq!(keys(&whole[4..]), keys(&rest));
    }

    #[test]
    fn members_of_other_designs_are_refused() {
        let of = |extra: Value| {
            let mut body = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01]}}});
            body.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
            pointers(body)
        };
        assert_eq!(of(json!({"samples": 3, "seed": 1, "skip": 2})), ["/samples", "/seed", "/skip"]);
        assert_eq!(of(json!({"points": [{"flow_rate": 0.01}]})), ["/points"]);
        assert_eq!(of(json!({"design": "sobol"})), ["/samples"]);
        assert_eq!(of(json!({"design": "latin_hypercube", "samples": 2, "skip": 1})), ["/skip"]);
        assert_eq!(of(json!({"design": "list", "points": []})), ["/points", "/axes"]);
        assert_eq!(of(json!({"axes": {"flow_rate": {"from": 0.01, "to": 0.02}}})), ["/axes/flow_rate"]);
        let counted = json!({"design": "sobol", "samples": 4, "axes": {"flow_rate": {"from": 0.01, "to": 0.02, "count": 3}}});
        assert_eq!(of(counted), ["/axes/flow_rate/count"]);
        assert_eq!(of(json!({"design": "zip", "axes": {}})), ["/axes"]);
        assert_eq!(of(json!({"design": "sobol", "samples": 200_000})), ["/samples"]);
    }

    #[test]
    fn of_very_many_problems_the_first_hundred_are_reported() {
        let body = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": vec![-1.0; 5_000]}}});
        assert_eq!(problems(body).len(), MOST_PROBLEMS);
    }
}
