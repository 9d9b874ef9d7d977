//! From a request to the points to compute, or to everything that is wrong with it.

use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::scenario::{PRESETS, Problem, Problems, Scenario, ScenarioRequest, Warning};
use drillsweep_sim::transient::step_problem;
use indexmap::IndexMap;
use serde_json::Value;

use crate::axis::Axis;
use crate::problem::{FieldProblem, ProblemDetails, pointer_token};
use crate::request::{AxisName, SweepRequest};
use crate::service::LIMITS;

/// One point to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPoint {
    /// Number of the point in its sweep, from 1, the first axis varying slowest.
    pub ordinal: u32,
    /// The swept parameters in the order of the axes, then the other axes' values of the scenario.
    pub parameters: IndexMap<String, f64>,
    /// The scenario to simulate: preset, changes and axes applied.
    pub scenario: Scenario,
    /// Content hash of physics version and scenario: equal keys, equal results.
    pub key: PointKey,
}

/// The content hash of a point.
pub type PointKey = [u8; 32];

/// A point's key as it is written on the wire, in hexadecimal.
pub fn key_text(key: &PointKey) -> String {
    blake3::Hash::from_bytes(*key).to_hex().to_string()
}

/// What a request expands into.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expansion {
    /// The points, by ordinal.
    pub points: Vec<SweepPoint>,
    /// What can be simulated but is probably not meant, with JSON Pointers into the request.
    pub warnings: Vec<FieldProblem>,
}

/// The points of a request, every one of them validated.
///
/// Points are ordered like the digits of a counter: the last axis turns fastest, the first slowest.
///
/// # Errors
/// Every distinct problem of the request and of any of its points, once, with JSON Pointers into the request.
pub fn expand(request: &SweepRequest) -> Result<Expansion, Box<ProblemDetails>> {
    let mut problems = Found::default();
    let mut warnings = Found::default();
    let mut points = Vec::new();
    check_members(request, &mut problems);
    let axes_hold = check_axes(request, &mut problems);
    if let Some(scenario) = resolve(request, &mut problems) {
        if axes_hold && check_targets(request, &scenario, &mut problems) {
            points = grid(request, &scenario, &mut problems, &mut warnings);
        } else {
            check_without_axes(request, &scenario, &mut problems);
        }
    }
    // One point stands for all: the limit is the mesh's, hardly the mud's.
    if let Some((point, problem)) =
        points.first().and_then(|point| Some((point, step_problem(&point.scenario)?)))
    {
        problems.add(request, &digits(point.ordinal as usize - 1, request), &problem);
    }
    match problems.0.is_empty() {
        true => Ok(Expansion { points, warnings: warnings.into_vec() }),
        false => Err(Box::new(ProblemDetails::invalid_request(problems.into_vec()))),
    }
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

fn grid(
    request: &SweepRequest,
    base: &Scenario,
    problems: &mut Found,
    warnings: &mut Found,
) -> Vec<SweepPoint> {
    let total: usize = request.axes.values().map(Axis::count).product();
    let mut points = Vec::with_capacity(total);
    for (number, ordinal) in (0..total).zip(1..) {
        let indices = digits(number, request);
        let mut scenario = base.clone();
        for ((name, axis), &index) in request.axes.iter().zip(&indices) {
            name.set(&mut scenario, axis.value(index));
        }
        match scenario.validate() {
            Ok(of_scenario) => {
                for Warning { path, message } in of_scenario {
                    let problem = Problem { path, got: String::new(), message };
                    warnings.add(request, &indices, &problem);
                }
            }
            Err(Problems(of_scenario)) => {
                for problem in &of_scenario {
                    problems.add(request, &indices, problem);
                }
                continue;
            }
        }
        let (parameters, key) = (parameters(request, &scenario), key(&scenario));
        points.push(SweepPoint { ordinal, parameters, scenario, key });
    }
    points
}

/// The index on each axis of point `number`, counted from 0.
fn digits(mut number: usize, request: &SweepRequest) -> Vec<usize> {
    let mut indices: Vec<usize> = request
        .axes
        .values()
        .rev()
        .map(|axis| {
            let index = number % axis.count();
            number /= axis.count();
            index
        })
        .collect();
    indices.reverse();
    indices
}

fn parameters(request: &SweepRequest, scenario: &Scenario) -> IndexMap<String, f64> {
    request
        .axes
        .keys()
        .copied()
        .chain(AxisName::ALL)
        .filter_map(|name| Some((name.as_str().to_owned(), name.get(scenario)?)))
        .collect()
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
                Ok(scenario) => return Some(scenario),
                Err(Problems(of_set)) => {
                    for problem in of_set {
                        problems.add(request, &[], &problem);
                    }
                }
            }
        }
    }
    None
}

fn check_members(request: &SweepRequest, problems: &mut Found) {
    let named =
        [("/name", &request.name, LIMITS.name_length), ("/owner", &request.owner, LIMITS.owner_length)];
    for (pointer, text, limit) in named {
        let Some(text) = text else { continue };
        if text.is_empty() || text.chars().count() > limit {
            let detail = format!("must have 1 to {limit} characters");
            problems.push(pointer, Some(text.as_str().into()), detail);
        }
    }
    let (lowest, highest) = (LIMITS.lowest_priority, LIMITS.highest_priority);
    if !(lowest..=highest).contains(&request.priority) {
        let detail = format!("must be between {lowest} and {highest}");
        problems.push("/priority", Some(request.priority.into()), detail);
    }
}

/// Whether the axes can be expanded; what is wrong with them is noted.
fn check_axes(request: &SweepRequest, problems: &mut Found) -> bool {
    let mut hold = true;
    for (name, axis) in &request.axes {
        for (member, got, detail) in axis.problems() {
            problems.push(format!("/axes/{}{member}", name.as_str()), Some(got), detail);
            hold = false;
        }
    }
    let total = request.axes.values().try_fold(1usize, |total, axis| total.checked_mul(axis.count()));
    let limit = LIMITS.points_per_sweep;
    if total.is_none_or(|total| total > limit) {
        let counts: Vec<_> = request.axes.values().map(|axis| axis.count().to_string()).collect();
        let detail = format!("a sweep has at most {limit} points");
        problems.push("/axes", Some(counts.join(" x ").into()), detail);
        hold = false;
    }
    hold
}

/// Whether the scenario has the fields that the axes vary.
fn check_targets(request: &SweepRequest, scenario: &Scenario, problems: &mut Found) -> bool {
    let missing = request.axes.keys().filter(|name| name.get(scenario).is_none());
    let before = problems.0.len();
    for name in missing {
        problems.push(format!("/axes/{}", name.as_str()), None, "the scenario has no mud to sweep");
    }
    problems.0.len() == before
}

/// The problems of the scenario itself, when the axes cannot be expanded: a sweep's other mistakes are not
/// kept back until its axes are right. What the axes would replace is not looked at.
fn check_without_axes(request: &SweepRequest, scenario: &Scenario, problems: &mut Found) {
    let replaced: Vec<_> = request.axes.keys().map(|name| name.scenario_path()).collect();
    let Err(Problems(of_scenario)) = scenario.validate() else { return };
    for problem in of_scenario.iter().filter(|problem| !replaced.contains(&problem.path.as_str())) {
        problems.add(request, &[], problem);
    }
}

/// Distinct problems, in the order in which they were found.
#[derive(Default)]
struct Found(IndexMap<(String, String), Option<Value>>);

impl Found {
    fn push(&mut self, pointer: impl Into<String>, got: Option<Value>, detail: impl Into<String>) {
        self.0.entry((pointer.into(), detail.into())).or_insert(got);
    }

    /// Notes a problem of a scenario, at the place of the request that decides the field. `indices` are those
    /// of the point on the axes, none when the axes are not applied.
    fn add(&mut self, request: &SweepRequest, indices: &[usize], problem: &Problem) {
        let got = match problem.got.as_str() {
            "" => None,
            got => Some(serde_json::from_str(got).unwrap_or_else(|_| got.into())),
        };
        let (pointer, is_inherited) = place(request, indices, &problem.path);
        let message = &problem.message;
        match is_inherited {
            false => self.push(pointer, got, message),
            true => self.push(pointer, got, format!("{}: {message}", problem.path)),
        }
    }

    fn into_vec(self) -> Vec<FieldProblem> {
        let problem =
            |((pointer, detail), got)| FieldProblem { pointer: Some(pointer), parameter: None, got, detail };
        self.0.into_iter().map(problem).collect()
    }
}

/// Where in a request a field of the scenario is decided, and whether that is the preset that it names
/// rather than the field itself.
fn place(request: &SweepRequest, indices: &[usize], path: &str) -> (String, bool) {
    for ((name, axis), &index) in request.axes.iter().zip(indices) {
        if name.scenario_path() == path {
            return (format!("/axes/{}{}", name.as_str(), axis.member(index)), false);
        }
    }
    let field = scenario_pointer(path);
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
            let points = expand(&request(body)).unwrap().points;
            let values = |point: SweepPoint| {
                let mud = point.scenario.mud.unwrap();
                assert_eq!(point.parameters["flow_rate"], mud.flow_rate);
                assert_eq!(point.parameters["mud_density"], mud.density);
                (point.ordinal, mud.flow_rate, mud.density)
            };
            points.into_iter().map(values).collect()
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
        let flow_rates: Vec<_> = expand(&density_first)
            .unwrap()
            .points
            .iter()
            .map(|point| (point.parameters["mud_density"], point.parameters["flow_rate"]))
            .collect();
        assert_eq!(flow_rates, [(1200.0, 0.01), (1200.0, 0.04), (1500.0, 0.01), (1500.0, 0.04)]);
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
    fn a_run_is_a_sweep_of_one_point() {
        let run: crate::RunRequest =
            serde_json::from_value(json!({"preset": "paper-200m", "set": {"duration": 65}})).unwrap();
        let points = expand(&run.into()).unwrap().points;
        assert_eq!(points.len(), 1);
        assert_eq!(points[0].ordinal, 1);
        assert_eq!(points[0].scenario.duration, 65.0);
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
                "flow_rate": {"from": 0.01, "to": 0.06, "count": 100},
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
}
