//! Rules of duration, accuracy and recording.

use drillsweep_scenario::{
    NodeChoice, OrbitOutputs, OrbitWindow, Outputs, Scenario, Starts, TimeWindow, WindowName,
};

use super::accuracy::check_accuracy;
use super::report::Report;
use super::string::top_moves;
use super::window::{check_window, is_whole};
use super::{snapshots, study};
use crate::force::effect::active_effects;
use crate::solve::run::spectrum_windows_at_most;
use crate::string::StringMesh;

/// Largest number of samples of a node: half an hour at 1 kHz. Its orbit and full spectrum over the whole run are computed in memory.
const MOST_SAMPLES: f64 = 2e6;

/// Largest number of samples of all recorded nodes: 2.5 GiB of history.
const MOST_SAMPLES_OF_NODES: f64 = (1_u64 << 26) as f64;

/// Largest number of spectrum windows.
const MOST_WINDOWS: usize = 100;

pub(super) fn check(report: &mut Report, scenario: &Scenario, mesh: Option<&StringMesh>) {
    let recording = &scenario.recording;
    report.positive(scenario.duration, "duration");
    report.positive(recording.rate_hz, "recording.rate_hz");
    check_accuracy(report, scenario);
    report.require(
        (1..=study::LARGEST_ENSEMBLE).contains(&scenario.ensemble),
        "ensemble",
        scenario.ensemble,
        format!("must be 1 (a single run) to {}", study::LARGEST_ENSEMBLE),
    );
    report.require(
        scenario.statics.start == Starts::One
            || scenario.cost_study.is_none() && active_effects(scenario).transient,
        "statics.start",
        "both",
        "must be one: without runs in time, or with a cost study in their place, no statistics can be compared",
    );
    if let Some(study) = &scenario.cost_study {
        study::check(report, scenario, study);
    }
    check_samples(report, scenario);
    let windows = recording.spectrum_windows.as_ref().map_or(0, Vec::len);
    report.require(
        windows <= MOST_WINDOWS,
        "recording.spectrum_windows",
        format!("{windows} windows"),
        format!("must be at most {MOST_WINDOWS}: the service computes further ones from the history"),
    );
    for (i, window) in recording.spectrum_windows.iter().flatten().take(MOST_WINDOWS).enumerate() {
        check_window(report, scenario, window, &format!("recording.spectrum_windows[{i}]"));
    }
    match &recording.orbit_window {
        Some(OrbitWindow::Fixed(window)) => check_window(report, scenario, window, "recording.orbit_window"),
        Some(OrbitWindow::Named(WindowName::Settled)) => report.require(
            !recording.nodes.is_empty() || !active_effects(scenario).transient,
            "recording.orbit_window",
            "settled",
            "needs at least one of recording.nodes, since their motion shows that it has settled",
        ),
        None => {}
    }
    report.warn(
        recording.nodes.is_empty() && active_effects(scenario).transient,
        "recording.nodes",
        "no node is recorded: there will be no history",
    );
    if let Some(mesh) = mesh {
        check_nodes(report, scenario, mesh);
    }
    check_outputs(report, scenario, mesh);
    snapshots::check(report, scenario, mesh);
}

fn check_outputs(report: &mut Report, scenario: &Scenario, mesh: Option<&StringMesh>) {
    const PATH: &str = "recording.outputs";
    let recording = &scenario.recording;
    match &recording.outputs {
        Outputs::Summary | Outputs::Full => {}
        Outputs::Spectra => {
            for (path, is_empty) in [
                (
                    "recording.spectrum_windows",
                    scenario.spectrum_windows().is_some_and(|windows| windows.is_empty()),
                ),
                ("recording.nodes", recording.nodes.is_empty()),
            ] {
                report.require(!is_empty, PATH, "spectra", format!("needs at least one of {path}"));
            }
        }
        Outputs::Orbits(OrbitOutputs { nodes, window, decimation }) => {
            report.require(
                *decimation >= 1,
                format!("{PATH}.orbits.decimation"),
                decimation,
                "must be 1 (every sample) or more",
            );
            if let Some(window) = window {
                check_window(report, scenario, window, &format!("{PATH}.orbits.window"));
            }
            let (Some(nodes), Some(mesh)) = (nodes, mesh) else { return };
            let recorded: Vec<_> =
                recording.nodes.iter().filter_map(|&choice| mesh.chosen_node(choice)).collect();
            for (i, &choice) in nodes.iter().enumerate() {
                let (name, got) = match choice {
                    NodeChoice::Node(number) => ("node", f64::from(number)),
                    NodeChoice::Depth(depth) => ("depth", depth),
                    NodeChoice::AboveBit(above) => ("above_bit", above),
                };
                report.require(
                    mesh.chosen_node(choice).is_some_and(|node| recorded.contains(&node)),
                    format!("{PATH}.orbits.nodes[{i}].{name}"),
                    got,
                    "must be one of recording.nodes",
                );
            }
        }
    }
}

/// A bound rounded down to three significant digits, for messages.
fn in_three_digits(bound: f64) -> f64 {
    let decimals = 2 - bound.log10().floor() as i32;
    let unit = 10.0_f64.powi(decimals.abs());
    if decimals > 0 { (bound * unit).floor() / unit } else { (bound / unit).floor() * unit }
}

/// Requires that the run holds a whole number of recording intervals, and not too many.
fn check_samples(report: &mut Report, scenario: &Scenario) {
    let (duration, rate) = (scenario.duration, scenario.recording.rate_hz);
    let samples = duration * rate;
    if !(duration > 0.0 && rate > 0.0 && samples.is_finite()) {
        return;
    }
    report.require(
        is_whole(samples),
        "duration",
        duration,
        format!("must be a whole multiple of the recording interval, 1/{rate} s"),
    );
    report.require(
        samples <= MOST_SAMPLES,
        "recording.rate_hz",
        rate,
        format!(
            "must be at most {}: {duration} s may have {MOST_SAMPLES} samples, since orbits and spectra are computed in memory",
            in_three_digits(MOST_SAMPLES / duration)
        ),
    );
    let nodes = scenario.recording.nodes.len() as f64;
    report.require(
        samples > MOST_SAMPLES || nodes * samples <= MOST_SAMPLES_OF_NODES,
        "recording.nodes",
        format!("{nodes} nodes"),
        format!(
            "must be at most {} for {duration} s at {rate} Hz: together they may have {MOST_SAMPLES_OF_NODES} samples, 2.5 GiB of history",
            (MOST_SAMPLES_OF_NODES / samples).floor()
        ),
    );
    let of_windows = |window: &TimeWindow| (window.to - window.from).max(0.0) * rate;
    let windows = spectrum_windows_at_most(scenario);
    let in_windows: f64 = windows.iter().take(MOST_WINDOWS).map(of_windows).sum();
    report.require(
        scenario.recording.outputs != Outputs::Spectra || nodes * in_windows <= MOST_SAMPLES_OF_NODES,
        "recording.spectrum_windows",
        format!("{in_windows} samples in all"),
        format!(
            "must have at most {} samples together, for outputs = \"spectra\" of {nodes} nodes",
            (MOST_SAMPLES_OF_NODES / nodes).floor()
        ),
    );
}

fn check_nodes(report: &mut Report, scenario: &Scenario, mesh: &StringMesh) {
    let mut seen: Vec<(usize, usize)> = Vec::new();
    for (i, &choice) in scenario.recording.nodes.iter().enumerate() {
        let path = format!("recording.nodes[{i}]");
        let Some(node) = mesh.chosen_node(choice) else {
            match choice {
                NodeChoice::Node(number) => report.require(
                    false,
                    format!("{path}.node"),
                    number,
                    format!("must be 1 to {}, the nodes of the mesh", mesh.nodes.len()),
                ),
                NodeChoice::Depth(place) | NodeChoice::AboveBit(place) => report.number(
                    place,
                    match choice {
                        NodeChoice::AboveBit(_) => format!("{path}.above_bit"),
                        _ => format!("{path}.depth"),
                    },
                    |_| false,
                    format!("must be on the string, 0 to {} m", mesh.length()),
                ),
            }
            continue;
        };
        match seen.iter().find(|(other, _)| *other == node) {
            Some((_, first)) => report.require(
                false,
                &path,
                format!("node {} again", node + 1),
                format!("must be another node than that of recording.nodes[{first}]"),
            ),
            None => seen.push((node, i)),
        }
        let is_held = node == 0 && !top_moves(scenario);
        report.warn(is_held, path, "the top node is held: its record is constant");
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{
        Accuracy, AccuracyPreset, AccuracyTarget, CostStudy, Effect, Integrator, Switch, TimeStepping,
    };

    use super::super::report::testing::{problem, problems, warnings};
    use super::*;

    fn explicit(integrator: Integrator, step: f64) -> TimeStepping {
        TimeStepping::fixed(integrator, step)
    }

    fn spectrum_window(scenario: &mut Scenario, index: usize) -> &mut TimeWindow {
        &mut scenario.recording.spectrum_windows.as_mut().unwrap()[index]
    }

    fn accuracy_problem(path: &str, stepping: TimeStepping) -> String {
        problem(path, |s| s.accuracy = Accuracy::Explicit(stepping)).message
    }

    #[test]
    fn runs_have_a_duration() {
        let found = problems(|s| s.duration = 0.0);
        assert!(found.iter().any(|p| p.path == "duration"), "{found:?}");
    }

    #[test]
    fn duration_is_a_multiple_of_the_recording_interval() {
        let found = problem("duration", |s| s.duration = 60.0004);
        assert!(found.message.contains("1/1000 s"), "{found}");
        assert_eq!(warnings(|s| s.duration = 60.001), []);
    }

    #[test]
    fn recording_rate_is_positive_and_affordable() {
        problem("recording.rate_hz", |s| s.recording.rate_hz = 0.0);
        problem("recording.rate_hz", |s| s.recording.rate_hz = -1000.0);
        let found = problem("recording.rate_hz", |s| {
            s.accuracy = Accuracy::Explicit(explicit(Integrator::Rk4, 1e-6));
            s.recording.rate_hz = 1e6;
        });
        assert!(found.message.contains("2000000 samples"), "{found}");
        // An hour is affordable, at half the usual rate.
        problem("recording.rate_hz", |s| s.duration = 3600.0);
        let hour = |s: &mut Scenario| (s.duration, s.recording.rate_hz) = (3600.0, 500.0);
        assert_eq!(warnings(hour), []);
        let found = problem("recording.nodes", |s| {
            hour(s);
            s.recording.nodes = (2..60).map(NodeChoice::Node).collect();
        });
        assert!(found.message.contains("at most 37 for 3600 s"), "{found}");
    }

    #[test]
    fn windows_are_as_many_as_a_result_has_room_for() {
        let windows = |count: usize| {
            let window = |k: usize| TimeWindow { from: 0.01 * k as f64, to: 50.0 };
            Some((0..count).map(window).collect::<Vec<_>>())
        };
        assert_eq!(warnings(|s| s.recording.spectrum_windows = windows(100)), []);
        let found = problem("recording.spectrum_windows", |s| s.recording.spectrum_windows = windows(101));
        assert!(found.message.contains("at most 100"), "{found}");
        let found = problem("recording.spectrum_windows", |s| {
            s.recording.spectrum_windows = windows(100);
            s.recording.nodes = (2..20).map(NodeChoice::Node).collect();
            s.recording.outputs = Outputs::Spectra;
        });
        assert!(found.message.contains("3728270 samples together"), "{found}");
    }

    #[test]
    fn a_fixed_step_divides_the_recording_interval_or_doubles_it() {
        for step in [3e-4, 3e-3, 1.0000001e-3] {
            let message = accuracy_problem("accuracy.step", explicit(Integrator::Esdirk4, step));
            assert!(message.contains("0.001 s"), "{message}");
        }
        accuracy_problem("accuracy.step", explicit(Integrator::GeneralizedAlpha, 2e-3));
        for step in [1e-3, 5e-4, 1e-3 / 3.0, 1e-3 / 7.0, 2e-3, 4e-3] {
            assert_eq!(
                warnings(|s| s.accuracy = Accuracy::Explicit(explicit(Integrator::Esdirk4, step))),
                []
            );
        }
        // Steps that adapt themselves fit any interval.
        assert_eq!(warnings(|s| s.recording.rate_hz = 1500.0), []);
        assert_eq!(warnings(|s| s.accuracy = Accuracy::Preset(AccuracyPreset::Draft)), []);
    }

    #[test]
    fn step_is_positive() {
        for step in [0.0, -1e-3] {
            accuracy_problem("accuracy.step", explicit(Integrator::Esdirk4, step));
        }
    }

    #[test]
    fn implicit_methods_iterate_contact_at_least_twice() {
        for contact_sweeps in [0, 1, 1001] {
            let stepping = TimeStepping { contact_sweeps, ..explicit(Integrator::GeneralizedAlpha, 1e-3) };
            accuracy_problem("accuracy.contact_sweeps", stepping);
            let rk4 = TimeStepping { contact_sweeps, ..explicit(Integrator::Rk4, 1e-5) };
            assert_eq!(warnings(|s| s.accuracy = Accuracy::Explicit(rk4)), []);
        }
    }

    #[test]
    fn tolerances_are_small_and_not_for_generalized_alpha() {
        let tolerance = Some(1e-3);
        let message = accuracy_problem(
            "accuracy.tolerance",
            TimeStepping { tolerance, ..explicit(Integrator::GeneralizedAlpha, 1e-3) },
        );
        assert!(message.contains("esdirk4 and rk4"));
        let esdirk4 = TimeStepping { tolerance, ..explicit(Integrator::Esdirk4, 3e-3) };
        assert_eq!(warnings(|s| s.accuracy = Accuracy::Explicit(esdirk4)), []);
        for tolerance in [1e-5, 0.2] {
            accuracy_problem("accuracy.tolerance", TimeStepping { tolerance: Some(tolerance), ..esdirk4 });
            let target =
                |s: &mut Scenario| s.accuracy = Accuracy::Target(AccuracyTarget::Statistics(tolerance));
            problem("accuracy.statistics", target);
            let target =
                |s: &mut Scenario| s.accuracy = Accuracy::Target(AccuracyTarget::Trajectory(tolerance));
            problem("accuracy.trajectory", target);
        }
        let rk4 = explicit(Integrator::Rk4, 1e-4);
        assert_eq!(warnings(|s| s.accuracy = Accuracy::Explicit(TimeStepping { tolerance, ..rk4 })), []);
        for tolerance in [0.0, -1e-3, 0.1, 1.0].map(Some) {
            accuracy_problem("accuracy.tolerance", TimeStepping { tolerance, ..rk4 });
        }
    }

    #[test]
    fn recorded_nodes_exist() {
        for number in [0, 298] {
            let found =
                problem("recording.nodes[1].node", |s| s.recording.nodes[1] = NodeChoice::Node(number));
            assert!(found.message.contains("1 to 297"), "{found}");
        }
        for depth in [-1.0, 200.5] {
            let found =
                problem("recording.nodes[1].depth", |s| s.recording.nodes[1] = NodeChoice::Depth(depth));
            assert!(found.message.contains("0 to 200 m"), "{found}");
        }
        assert_eq!(warnings(|s| s.recording.nodes[1] = NodeChoice::Depth(200.0)), []);
    }

    #[test]
    fn recorded_nodes_differ() {
        let found = problem("recording.nodes[3]", |s| s.recording.nodes.push(NodeChoice::Depth(57.8)));
        assert_eq!(found.got, "node 49 again");
        assert!(found.message.contains("recording.nodes[1]"), "{found}");
    }

    #[test]
    fn the_held_node_may_be_recorded_with_a_warning() {
        let found = warnings(|s| s.recording.nodes.push(NodeChoice::Node(1)));
        assert_eq!((found.len(), found[0].path.as_str()), (1, "recording.nodes[3]"));
        let found = warnings(|s| s.recording.nodes.clear());
        assert_eq!((found.len(), found[0].path.as_str()), (1, "recording.nodes"));
    }

    #[test]
    fn both_starts_are_compared_by_runs_in_time() {
        for change in [(|s| s.cost_study = Some(CostStudy::default())) as fn(&mut Scenario), |s| {
            s.effects.set(Effect::Transient, Switch::Off)
        }] {
            let found = problem("statics.start", |s| {
                s.statics.start = Starts::Both;
                change(s);
            });
            assert!(found.message.contains("compared"), "{found}");
        }
    }

    #[test]
    fn windows_are_within_the_run() {
        let window = |from, to| TimeWindow { from, to };
        problem("recording.orbit_window.to", |s| s.recording.orbit_window = Some(window(40.0, 61.0).into()));
        problem("recording.orbit_window.from", |s| {
            s.recording.orbit_window = Some(window(-1.0, 20.0).into())
        });
        problem("recording.spectrum_windows[1].to", |s| spectrum_window(s, 1).to = 60.5);
        assert_eq!(warnings(|s| s.recording.orbit_window = Some(window(0.0, 60.0).into())), []);
    }

    #[test]
    fn a_settled_window_needs_motion_to_be_judged_by() {
        let settle = |s: &mut Scenario| s.recording.orbit_window = Some(OrbitWindow::SETTLED);
        assert_eq!(warnings(settle), []);
        let found = problem("recording.orbit_window", |s| {
            settle(s);
            s.recording.nodes.clear();
        });
        assert!(found.message.contains("recording.nodes"), "{found}");
    }

    #[test]
    fn windows_are_not_empty() {
        for to in [15.0, 10.0] {
            let found = problem("recording.spectrum_windows[0]", |s| spectrum_window(s, 0).to = to);
            assert!(found.message.contains("end after it begins"), "{found}");
        }
    }

    #[test]
    fn outputs_cover_recorded_nodes() {
        let keep = |outputs: OrbitOutputs| {
            move |s: &mut Scenario| s.recording.outputs = Outputs::Orbits(outputs.clone())
        };
        let whole = OrbitOutputs::default;
        problem("recording.outputs.orbits.decimation", keep(OrbitOutputs { decimation: 0, ..whole() }));
        let window = Some(TimeWindow { from: 50.0, to: 61.0 });
        problem("recording.outputs.orbits.window.to", keep(OrbitOutputs { window, ..whole() }));
        let nodes = Some(vec![NodeChoice::Node(49), NodeChoice::Node(50)]);
        let found =
            problem("recording.outputs.orbits.nodes[1].node", keep(OrbitOutputs { nodes, ..whole() }));
        assert_eq!(found.got, "50");
        // The node nearest to this depth is node 49.
        let nodes = Some(vec![NodeChoice::Depth(57.8)]);
        assert_eq!(warnings(keep(OrbitOutputs { nodes, ..whole() })), []);
        for clear in [(|s| s.recording.spectrum_windows = Some(Vec::new())) as fn(&mut Scenario), |s| {
            s.recording.nodes.clear()
        }] {
            problem("recording.outputs", move |s| {
                s.recording.outputs = Outputs::Spectra;
                clear(s);
            });
        }
    }

    #[test]
    fn windows_hold_at_least_8_samples() {
        let found = problem("recording.spectrum_windows[0]", |s| spectrum_window(s, 0).to = 15.007);
        assert!(found.message.contains("8 samples"), "{found}");
        assert_eq!(warnings(|s| spectrum_window(s, 0).to = 15.008), []);
    }
}
