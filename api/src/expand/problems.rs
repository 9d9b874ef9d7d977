//! Problems of a request, and their places in it.

use std::collections::HashMap;
use std::iter::once;

use drillsweep_scenario::{MOST_PROBLEMS, Problem};
use indexmap::IndexMap;
use serde_json::Value;

use crate::problem::{FieldProblem, ProblemDetails, pointer_token};
use crate::request::SweepRequest;

/// Distinct problems, in the order in which they were found, up to [`MOST_PROBLEMS`].
#[derive(Default)]
pub(super) struct Found(IndexMap<(String, String), Option<Value>>);

impl Found {
    pub(super) fn push(&mut self, pointer: impl Into<String>, got: Option<Value>, detail: impl Into<String>) {
        if !self.is_full() {
            self.0.entry((pointer.into(), detail.into())).or_insert(got);
        }
    }

    /// Notes a problem of a scenario, at the place of the request that decides the field: `place` knows the axes'.
    pub(super) fn add(
        &mut self,
        written: &Written<'_>,
        place: impl Fn(&str) -> Option<String>,
        problem: &Problem,
    ) {
        if self.is_full() {
            return;
        }
        let got = match problem.got.as_str() {
            "" => None,
            got => Some(serde_json::from_str(got).unwrap_or_else(|_| got.into())),
        };
        let message = &problem.message;
        if let Some(pointer) = place(&problem.path) {
            return self.push(pointer, got, message);
        }
        match written.place(&problem.path) {
            (pointer, false) => self.push(pointer, got, message),
            (pointer, true) => self.push(pointer, got, format!("{}: {message}", problem.path)),
        }
    }

    /// True if no further problem is reported.
    pub(super) fn is_full(&self) -> bool {
        self.0.len() >= MOST_PROBLEMS
    }

    /// Number of problems.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The answer to a request that has these problems.
    pub(super) fn into_refusal(self) -> Box<ProblemDetails> {
        Box::new(ProblemDetails::invalid_request(self.into_vec()))
    }

    pub(super) fn into_vec(self) -> Vec<FieldProblem> {
        let problem =
            |((pointer, detail), got)| FieldProblem { pointer: Some(pointer), parameter: None, got, detail };
        self.0.into_iter().map(problem).collect()
    }
}

/// Places of a request, outside of the axes, that decide fields of its scenario.
pub(super) struct Written<'a> {
    request: &'a SweepRequest,
    /// Paths of `set`, by the JSON Pointers of the fields into the scenario.
    set: HashMap<String, &'a str>,
}

impl<'a> Written<'a> {
    pub(super) fn new(request: &'a SweepRequest) -> Self {
        let set = request.set.keys().map(|path| (scenario_pointer(path), path.as_str())).collect();
        Self { request, set }
    }

    /// The JSON Pointer of the place that decides a field, and true if that is the preset of the request rather than the field itself.
    fn place(&self, path: &str) -> (String, bool) {
        let field = scenario_pointer(path);
        if let Some(rest) =
            field.strip_prefix("/recording/outputs").filter(|_| self.request.outputs.is_some())
        {
            return (format!("/outputs{rest}"), false);
        }
        // The longest path wins: it was applied last.
        let ends = once(field.len()).chain(field.rmatch_indices('/').map(|(end, _)| end));
        let of_set = ends
            .filter(|end| *end > 0 || field.is_empty())
            .find_map(|end| Some((self.set.get(&field[..end])?, end)));
        if let Some((path, end)) = of_set {
            return (format!("/set/{}{}", pointer_token(path), &field[end..]), false);
        }
        match self.request.scenario {
            Some(_) => (format!("/scenario{field}"), false),
            None => ("/preset".to_owned(), true),
        }
    }
}

/// The path of a field, such as `string.sections[1].count`, as a JSON Pointer into the scenario.
fn scenario_pointer(path: &str) -> String {
    Problem { path: path.to_owned(), got: String::new(), message: String::new() }.pointer()
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;
    use serde_json::json;

    use super::*;
    use crate::expand::tests::{pointers, problems};

    #[test]
    fn every_problem_is_reported_with_its_path_in_the_request() {
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
    fn of_very_many_problems_the_first_hundred_are_reported() {
        let body = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": vec![-1.0; 5_000]}}});
        assert_eq!(problems(body).len(), MOST_PROBLEMS);
    }
}
