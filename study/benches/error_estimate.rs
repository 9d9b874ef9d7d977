//! The error of its steps that a result states, compared with the true one, over whole runs through stick-slip and impacts.
//! Run: `cargo bench -p drillsweep-study --bench error_estimate` (some ten minutes)

use drillsweep_scenario::{Accuracy, AccuracyPreset, Scenario};
use drillsweep_study::errors::TimeError;
use whole_run_scenarios::{WholeRun, apart, scenarios};

#[path = "../tests/whole_run_scenarios/mod.rs"]
mod whole_run_scenarios;

/// Comparison of estimates with true errors.
#[derive(Debug, Default)]
struct Tally {
    covered: usize,
    missed: usize,
    unknown: usize,
    /// Estimates over true errors.
    ratios: Vec<f64>,
}

#[allow(clippy::print_stdout, reason = "a bench's report")]
fn main() {
    let (mut alone, mut in_ensemble) = (Tally::default(), Tally::default());
    println!(
        "relative errors of orbit size and of the radius' standard deviation, the worst of two nodes, over [20, 30) s"
    );
    println!(
        "{:30} {:10} {:>8} {:>9} {:>10} {:>9} {:>14}",
        "scenario", "accuracy", "size", "deviation", "estimate", "of two", "amplification"
    );
    for (name, scenario) in scenarios() {
        let reference = WholeRun::by_rk4(&scenario);
        let agreement = apart(&WholeRun::by_esdirk4(&scenario, 2.5e-4), &reference);
        println!("{name:30} {:10} {:>8.1e} {:>9.1e}", "(two methods)", agreement[0], agreement[1]);
        for preset in AccuracyPreset::ALL {
            compare(&scenario, preset, &reference, agreement, [&mut alone, &mut in_ensemble]);
        }
    }
    for (name, tally) in [("one run", &mut alone), ("an ensemble of three", &mut in_ensemble)] {
        tally.ratios.sort_by(f64::total_cmp);
        let median = tally.ratios.get(tally.ratios.len() / 2).copied().unwrap_or(f64::NAN);
        println!(
            "{name}: covers {} of {}, {} said to be unknown; the estimate is {median:.0} times the error in the median",
            tally.covered,
            tally.covered + tally.missed,
            tally.unknown
        );
    }
}

#[allow(clippy::print_stdout, reason = "a bench's report")]
fn compare(
    scenario: &Scenario,
    preset: AccuracyPreset,
    reference: &WholeRun,
    agreement: [f64; 4],
    tallies: [&mut Tally; 2],
) {
    let accuracy = Accuracy::Preset(preset);
    let run = WholeRun::of(scenario, accuracy, 0);
    let others = [1, 2].map(|member| WholeRun::of(scenario, accuracy, member));
    let error = apart(&run, reference);
    let told = [run.time_error(&[]), run.time_error(&others)];
    let shown = told
        .each_ref()
        .map(|told| told.statistics().map_or("unknown".into(), |value| format!("{value:.1e}")));
    let amplification = match &told[1] {
        TimeError::Estimated { amplification, .. } => format!("{amplification:.0}"),
        _ => String::new(),
    };
    println!(
        "{:30} {:10} {:>8.1e} {:>9.1e} {:>10} {:>9} {:>14}",
        "",
        preset.name(),
        error[0],
        error[1],
        shown[0],
        shown[1],
        amplification
    );
    for (tally, told) in tallies.into_iter().zip(told) {
        let Some(estimate) = told.statistics() else {
            tally.unknown += 1;
            continue;
        };
        // The disagreement of the reference's two methods is no error of the run.
        let is_covered = error[0] <= estimate + agreement[0] && error[1] <= estimate + agreement[1];
        *(if is_covered { &mut tally.covered } else { &mut tally.missed }) += 1;
        tally.ratios.push(estimate / error[0].max(error[1]));
    }
}
