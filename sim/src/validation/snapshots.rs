//! Rules of snapshots of the whole string.

use drillsweep_scenario::{Outputs, Scenario, Snapshots};

use super::report::Report;
use super::window::{check_window, is_whole};
use crate::force::effect::active_effects;
use crate::solve::run::SnapshotTimes;
use crate::string::StringMesh;

/// Largest number of nodes of all snapshots together: about 1 GB with all data of a node.
const MOST_NODES: u64 = 1 << 25;

/// Number of parts that are searched for a rate of a few digits.
const LOOKED_AT: usize = 100;

/// Least number of snapshots: fewer show no motion.
const FEWEST: u64 = 2;

pub(super) fn check(report: &mut Report, scenario: &Scenario, mesh: Option<&StringMesh>) {
    const PATH: &str = "recording.snapshots";
    const RATE: &str = "recording.snapshots.rate_hz";
    const WINDOW: &str = "recording.snapshots.window";
    let Some(Snapshots { rate_hz, window }) = scenario.recording.snapshots else { return };
    report.require(
        scenario.recording.outputs != Outputs::Summary,
        PATH,
        "with the outputs summary",
        "needs the outputs spectra, orbits or full: a summary keeps no table",
    );
    report.warn(
        scenario.cost_study.is_some() || !active_effects(scenario).transient,
        PATH,
        "snapshots need a run in time",
    );
    report.positive(rate_hz, RATE);
    if let Some(window) = &window {
        check_window(report, scenario, window, WINDOW);
    }
    let (recorded, duration) = (scenario.recording.rate_hz, scenario.duration);
    let is_counted = |value: f64| value > 0.0 && value.is_finite();
    if ![rate_hz, recorded, duration, duration * recorded].into_iter().all(is_counted) {
        return;
    }
    if !is_whole(recorded / rate_hz) {
        report.require(
            false,
            RATE,
            rate_hz,
            format!("must be {}", valid_rates(recorded, recorded / rate_hz)),
        );
        return;
    }
    let Some(times) = SnapshotTimes::of(scenario) else { return };
    let count = times.count();
    let (path, got, holds) = match window {
        Some(window) => (WINDOW, format!("{} to {} s", window.from, window.to), "must hold"),
        None => (RATE, rate_hz.to_string(), "must be so high that the run holds"),
    };
    report.require(
        count >= FEWEST || window.is_some_and(|window| window.to <= window.from),
        path,
        got,
        format!("{holds} at least {FEWEST} snapshots, {} s", FEWEST as f64 / rate_hz),
    );
    if let Some(mesh) = mesh {
        let nodes = mesh.nodes.len() as u64;
        let most = rate_hz * MOST_NODES as f64 / (nodes * count.max(1)) as f64;
        report.require(
            nodes.saturating_mul(count) <= MOST_NODES,
            RATE,
            rate_hz,
            format!(
                "must be at most {most:.3} with {nodes} nodes in this window: all snapshots together may have {MOST_NODES} nodes, about \
                 1 GB; or keep a shorter window"
            ),
        );
    }
}

/// Rates, in words, near `recorded / ratio` \[Hz\] whose snapshots are samples: whole parts of the recording rate that are written in
/// a few digits.
fn valid_rates(recorded: f64, ratio: f64) -> String {
    if ratio < 1.0 {
        return format!("at most recording.rate_hz, {recorded}");
    }
    let is_short = |parts: &f64| is_whole(1e3 * recorded / parts);
    let mut more = std::iter::successors(Some(ratio.ceil()), |parts| Some(parts + 1.0)).take(LOOKED_AT);
    let mut fewer =
        std::iter::successors(Some(ratio.floor()), |parts| Some(parts - 1.0).filter(|parts| *parts >= 1.0))
            .take(LOOKED_AT);
    let below = recorded / more.find(is_short).unwrap_or(ratio.ceil());
    let above = recorded / fewer.find(is_short).unwrap_or(ratio.floor());
    format!("a whole part of recording.rate_hz, {recorded}, such as {below} or {above}")
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{CostStudy, Outputs, Scenario, Snapshots, TimeWindow, preset};

    use super::super::report::testing::{problem, warnings};
    use crate::validation::validate_changes;

    fn asking(rate_hz: f64, window: Option<(f64, f64)>) -> impl Fn(&mut Scenario) {
        let window = window.map(|(from, to)| TimeWindow { from, to });
        move |s| s.recording.snapshots = Some(Snapshots { rate_hz, window })
    }

    #[test]
    fn the_rate_is_a_whole_part_of_the_recording_rate() {
        for rate in [1000.0, 500.0, 1000.0 / 3.0, 25.0, 0.5] {
            assert_eq!(warnings(asking(rate, None)), [], "{rate}");
        }
        for rate in [0.0, -25.0] {
            assert!(
                problem("recording.snapshots.rate_hz", asking(rate, None)).message.contains("greater than 0")
            );
        }
        let found = problem("recording.snapshots.rate_hz", asking(30.0, None));
        assert!(found.message.contains("such as 25 or 31.25"), "{found}");
        let found = problem("recording.snapshots.rate_hz", asking(2000.0, None));
        assert!(found.message.contains("at most recording.rate_hz, 1000"), "{found}");
    }

    #[test]
    fn the_window_is_within_the_run_and_holds_two_snapshots() {
        assert_eq!(warnings(asking(25.0, Some((40.0, 60.0)))), []);
        problem("recording.snapshots.window.to", asking(25.0, Some((40.0, 61.0))));
        problem("recording.snapshots.window.from", asking(25.0, Some((-1.0, 20.0))));
        problem("recording.snapshots.window", asking(25.0, Some((20.0, 20.0))));
        let found = problem("recording.snapshots.window", asking(25.0, Some((20.0, 20.04))));
        assert!(found.message.contains("at least 2 snapshots, 0.08 s"), "{found}");
        assert_eq!(warnings(asking(25.0, Some((20.0, 20.08)))), []);
        let found = problem("recording.snapshots.rate_hz", asking(0.01, None));
        assert!(found.message.contains("at least 2 snapshots"), "{found}");
    }

    #[test]
    fn all_snapshots_together_have_a_limit() {
        let found = problem("recording.snapshots.rate_hz", |s| {
            (s.duration, s.recording.rate_hz) = (1200.0, 200.0);
            asking(200.0, None)(s);
        });
        // 2^25 nodes of 297 in 1200 s.
        assert!(found.message.contains("at most 94.1") && found.message.contains("297 nodes"), "{found}");
        let hour = |s: &mut Scenario| {
            (s.duration, s.recording.rate_hz) = (3600.0, 500.0);
            asking(500.0, Some((100.0, 300.0)))(s);
        };
        assert_eq!(warnings(hour), []);
        // A sweep over the duration checks again.
        let mut scenario = preset("paper-200m").unwrap();
        (scenario.duration, scenario.recording.rate_hz) = (1200.0, 200.0);
        asking(200.0, None)(&mut scenario);
        assert!(validate_changes(&scenario, ["duration"]).is_err());
    }

    #[test]
    fn snapshots_are_of_a_run_whose_tables_are_kept() {
        let found = problem("recording.snapshots", |s| {
            asking(25.0, None)(s);
            s.recording.outputs = Outputs::Summary;
        });
        assert!(found.message.contains("a summary keeps no table"), "{found}");
        let found = warnings(|s| {
            asking(25.0, None)(s);
            s.cost_study = Some(CostStudy::default());
        });
        assert!(found.iter().any(|warning| warning.path == "recording.snapshots"), "{found:?}");
    }
}
