//! Validation of scenarios: every rule for simulation, checked all at once.

mod accuracy;
mod drive;
mod hole;
mod loads;
mod report;
mod snapshots;
mod string;
mod study;
mod time;
mod window;

use drillsweep_scenario::{BitLaw, Problems, Scenario, Warning};
use report::Report;

/// Checks that a scenario can be simulated.
///
/// # Errors
/// The scenario has problems; all are returned at once, each with the field's path, its value and the valid range. A scenario
/// without problems may still have warnings of properties that are probably not meant.
pub fn validate(scenario: &Scenario) -> Result<Vec<Warning>, Problems> {
    check(scenario, true, Use::Run)
}

/// Checks that a scenario has stability maps: as [`validate`], but the bit may have the law `regenerative`, which no run in time has.
///
/// # Errors
/// As [`validate`].
pub fn validate_stability_map(scenario: &Scenario) -> Result<Vec<Warning>, Problems> {
    check(scenario, true, Use::Window)
}

/// Use of a scenario.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Use {
    /// A run in time, or anything else that is about the equations of a run.
    Run,
    /// Stability maps of bit and drive.
    Window,
}

/// Checks again a scenario whose numbers at the paths `changed` differ from those of one that was checked in full.
/// The costly part, well, string and mesh, is omitted if none of the paths leads there.
///
/// # Errors
/// As [`validate`]; problems that do not depend on the changed numbers may be missing, and so may warnings.
pub fn validate_changes<'a>(
    scenario: &Scenario,
    changed: impl IntoIterator<Item = &'a str>,
) -> Result<Vec<Warning>, Problems> {
    let shapes = ["well", "string", "mesh", "recording", "cost_study", "excitation"];
    let leads_to = |path: &str, part: &str| {
        path.strip_prefix(part).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    // The largest number of snapshots depends on the nodes.
    let of_snapshots = scenario.recording.snapshots.is_some().then_some("duration");
    let parts = || shapes.into_iter().chain(of_snapshots);
    let mut changed = changed.into_iter();
    check(scenario, changed.any(|path| parts().any(|part| leads_to(path, part))), Use::Run)
}

fn check(scenario: &Scenario, with_shape: bool, purpose: Use) -> Result<Vec<Warning>, Problems> {
    let mut report = Report::default();
    // The other rules skip numbers that are not finite.
    for (path, number) in scenario.numbers_not_finite() {
        report.require(false, path, number, "must be a finite number");
    }
    report.require(
        !scenario.name.chars().any(char::is_control),
        "name",
        scenario.name.escape_default(),
        "must hold no control characters",
    );
    let written = scenario;
    let scenario = &*written.in_hole();
    // A mesh that follows from the scenario may change with any number.
    let mesh = if with_shape || scenario.mesh.is_auto() {
        hole::check(&mut report, scenario);
        string::check(&mut report, written, scenario)
    } else {
        None
    };
    loads::check(&mut report, scenario);
    drive::check(&mut report, written);
    report.require(
        purpose == Use::Window || written.bit.law != BitLaw::Regenerative,
        "bit.law",
        "regenerative",
        "has stability maps only, not a run in time or its modes: take `velocity_weakening`, or `drillsweep stability`",
    );
    time::check(&mut report, scenario, mesh.as_ref());
    report.finish()
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{PRESETS, ScenarioRequest, preset};

    use super::*;

    #[test]
    fn every_preset_is_valid_and_warns_of_its_named_extreme_alone() {
        for (name, _) in PRESETS {
            let extreme = match *name {
                "hard/light-mud" | "hard/heavy-mud" => Some("mud.density"),
                "hard/flow-0.2" | "hard/flow-flutter" => Some("mud.flow_rate"),
                "hard/near-buckling" | "hard/beyond-buckling" => Some("operation.weight_on_bit"),
                _ => None,
            };
            let found = validate(&preset(name).unwrap()).unwrap();
            let paths: Vec<&str> = found.iter().map(|warning| warning.path.as_str()).collect();
            assert_eq!(paths, Vec::from_iter(extreme), "{name}: {found:?}");
        }
    }

    #[test]
    fn a_presets_windows_are_valid_at_any_duration_and_own_windows_at_that_they_were_made_for() {
        for duration in [0.03, 6.0, 61.0, 120.0] {
            let request = format!(r#"{{"preset": "paper-200m", "set": {{"duration": {duration}}}}}"#);
            let scenario = ScenarioRequest::from_json(&request).unwrap().resolve().unwrap();
            assert_eq!(validate(&scenario).map(drop), Ok(()), "{duration} s");
        }
        let own = Scenario { duration: 6.0, ..preset("paper-200m").unwrap() };
        assert!(validate(&own).is_err(), "windows that a scenario gives itself are not changed");
    }

    #[test]
    fn non_finite_numbers_are_reported_at_any_path() {
        let scenario = preset("paper-200m").unwrap().with("accuracy.tolerance", 0.01.into()).unwrap();
        let tree = toml::Value::try_from(&scenario).unwrap();
        let mut paths = Vec::new();
        collect(&tree, String::new(), &mut paths);
        assert!(paths.len() > 100, "the walk found only {} numbers", paths.len());
        for path in paths {
            for number in ["nan", "inf", "-inf"] {
                let mut tree = tree.clone();
                *place(&mut tree, &path) = toml::Value::Float(number.parse().unwrap());
                let problems = validate(&tree.try_into().unwrap()).unwrap_err();
                let at: Vec<_> = problems.0.iter().filter(|problem| problem.path == path).collect();
                assert_eq!(at.len(), 1, "{path} = {number}: {problems}");
                assert_eq!(at[0].message, "must be a finite number");
            }
        }
    }

    /// Paths of all floating-point numbers.
    fn collect(tree: &toml::Value, path: String, paths: &mut Vec<String>) {
        match tree {
            toml::Value::Float(_) => paths.push(path),
            toml::Value::Array(entries) => {
                for (i, entry) in entries.iter().enumerate() {
                    collect(entry, format!("{path}[{i}]"), paths);
                }
            }
            toml::Value::Table(fields) => {
                for (field, value) in fields {
                    let path = if path.is_empty() { field.clone() } else { format!("{path}.{field}") };
                    collect(value, path, paths);
                }
            }
            _ => {}
        }
    }

    fn place<'a>(tree: &'a mut toml::Value, path: &str) -> &'a mut toml::Value {
        path.split(['.', '[']).fold(tree, |tree, step| match step.strip_suffix(']') {
            Some(index) => &mut tree[index.parse::<usize>().unwrap()],
            None => &mut tree[step],
        })
    }

    #[test]
    fn all_problems_come_at_once() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.well.survey[2].inclination_deg = 190.0;
        scenario.string.sections[2].inner_diameter = 0.2;
        scenario.mud.as_mut().unwrap().density = -1200.0;
        scenario.operation.torque_on_bit = 5000.0;
        scenario.recording.nodes.push(drillsweep_scenario::NodeChoice::Node(400));
        scenario.duration = f64::NAN;
        let problems = validate(&scenario).unwrap_err();
        let mut paths: Vec<&str> = problems.0.iter().map(|problem| problem.path.as_str()).collect();
        paths.sort_unstable();
        assert_eq!(
            paths,
            [
                "duration",
                "mud.density",
                "operation.torque_on_bit",
                "recording.nodes[3].node",
                "string.sections[2].inner_diameter",
                "well.survey[2].inclination_deg",
            ]
        );
    }
}
