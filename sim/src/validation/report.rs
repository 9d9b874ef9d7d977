//! Collecting problems and warnings.

use std::fmt::Display;
use std::ops::RangeInclusive;

use drillsweep_scenario::{Problem, Problems, Warning};

/// The findings so far.
#[derive(Debug, Default)]
pub(super) struct Report {
    problems: Vec<Problem>,
    warnings: Vec<Warning>,
}

impl Report {
    /// Adds a problem unless `ok`.
    pub(super) fn require(
        &mut self,
        ok: bool,
        path: impl Into<String>,
        got: impl Display,
        message: impl Into<String>,
    ) {
        if !ok {
            self.problems.push(Problem { path: path.into(), got: got.to_string(), message: message.into() });
        }
    }

    /// Adds a problem if a number is finite and breaks the rule. Numbers that are not finite have been reported.
    pub(super) fn number(
        &mut self,
        value: f64,
        path: impl Into<String>,
        rule: impl Fn(f64) -> bool,
        message: impl Into<String>,
    ) {
        self.require(!value.is_finite() || rule(value), path, value, message);
    }

    /// Requires a number greater than 0.
    pub(super) fn positive(&mut self, value: f64, path: impl Into<String>) {
        self.number(value, path, |value| value > 0.0, "must be greater than 0");
    }

    /// Requires a number of 0 or greater.
    pub(super) fn not_negative(&mut self, value: f64, path: impl Into<String>) {
        self.number(value, path, |value| value >= 0.0, "must be 0 or greater");
    }

    /// Adds a warning if `doubtful`.
    pub(super) fn warn(&mut self, doubtful: bool, path: impl Into<String>, message: impl Into<String>) {
        if doubtful {
            self.warnings.push(Warning { path: path.into(), message: message.into() });
        }
    }

    /// Warns of a number outside its usual range, whose bounds are in `unit`.
    pub(super) fn usual(
        &mut self,
        value: f64,
        path: impl Into<String>,
        range: &RangeInclusive<f64>,
        unit: &str,
    ) {
        let (least, most) = range.clone().into_inner();
        // Without the value: a sweep warns once of an axis, whatever the number of its points.
        let bounds = match (least == -most, least == 0.0) {
            (true, _) => format!("up to {most}"),
            (_, true) => format!("0 to {most}"),
            _ => format!("{least} to {most}"),
        };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        self.warn(
            value.is_finite() && !range.contains(&value),
            path,
            format!("is outside the usual range, {bounds}{unit}: is it in another unit?"),
        );
    }

    /// The problems at a path, and all others.
    pub(super) fn split(self, path: &str) -> (Self, Self) {
        let of = |problems| Self { problems, warnings: Vec::new() };
        let (at, elsewhere) = self.problems.into_iter().partition(|problem| problem.path == path);
        (of(at), of(elsewhere))
    }

    /// Takes over the problems of another report, their paths beginning with `to` in place of `from`.
    pub(super) fn take_problems(&mut self, other: Self, from: &str, to: &str) {
        for problem in other.problems {
            let rest = problem.path.strip_prefix(from).unwrap_or_default();
            self.problems.push(Problem { path: format!("{to}{rest}"), ..problem });
        }
    }

    /// The warnings, or all problems if there are any.
    pub(super) fn finish(self) -> Result<Vec<Warning>, Problems> {
        if self.problems.is_empty() { Ok(self.warnings) } else { Err(Problems(self.problems)) }
    }
}

#[cfg(test)]
pub(super) mod testing {
    //! Short assertions on the reports about a changed base case.

    use drillsweep_scenario::{Problem, Scenario, Warning, preset};

    use crate::validation::validate;

    /// Validates the base case after a change that makes it invalid.
    pub(crate) fn problems(change: impl Fn(&mut Scenario)) -> Vec<Problem> {
        let mut scenario = preset("paper-200m").unwrap();
        change(&mut scenario);
        validate(&scenario).expect_err("the change should make the scenario invalid").0
    }

    /// The one problem that a change causes.
    pub(crate) fn problem(path: &str, change: impl Fn(&mut Scenario)) -> Problem {
        let problems = problems(change);
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert_eq!(problems[0].path, path);
        problems[0].clone()
    }

    /// The warnings of the base case after a change that leaves it valid.
    pub(crate) fn warnings(change: impl Fn(&mut Scenario)) -> Vec<Warning> {
        let mut scenario = preset("paper-200m").unwrap();
        change(&mut scenario);
        validate(&scenario).expect("the change should leave the scenario valid")
    }
}
