//! Cost of accuracy for a scenario, measured on this machine.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use drillsweep_api::cost::{Measure, overview, table, text};
use drillsweep_chart::{PNG_WIDTH, work_precision};
use drillsweep_scenario::Scenario;
use drillsweep_sim::validation::validate;
use drillsweep_study::cost::CostReport;
use drillsweep_table::csv;
use drillsweep_worker::{cost_study, study_cpu_time, study_time};
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};

use crate::machine_speed::{SpeedArguments, machine_speed};
use crate::print;
use crate::scenario::ChangeArguments;
use crate::simulate::with_progress;

#[derive(Args)]
pub(crate) struct CostArguments {
    /// Presets by name (see `drillsweep scenario`) or scenario files (.toml or .json); several are studied one after the other.
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<String>,
    #[command(flatten)]
    changes: ChangeArguments,
    /// Seconds of simulated time of each run in place of the scenario's own; orbits are then evaluated over the last third,
    /// spectra over the last sixth.
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,
    /// Members of the ensemble that each method runs: with 5 or more, bias can be distinguished from spread.
    #[arg(long, value_name = "NUMBER")]
    members: Option<u32>,
    /// The two methods that make the reference, as JSON: `[{"integrator": "rk4", "step": 5e-5}, {"integrator": "esdirk4", "step":
    /// 1.25e-4, "contact_sweeps": 30}]`.
    #[arg(long, value_name = "JSON", value_parser = json_value)]
    reference: Option<Value>,
    /// Named accuracies to compare, such as `draft,standard`; all three unless given, none for ''.
    #[arg(long, value_name = "ACCURACIES", value_delimiter = ',')]
    presets: Option<Vec<String>>,
    /// Methods and steps in place of the usual ones, as JSON: `[{"integrator": "esdirk4", "steps": [1e-3, 5e-4]}]`; `[]` for none.
    #[arg(long, value_name = "JSON", value_parser = json_value)]
    methods: Option<Value>,
    /// Meshes to compare, as factors on the element lengths, such as `2,0.5,0.25`.
    #[arg(long, value_name = "FACTORS", value_delimiter = ',')]
    mesh_factors: Vec<f64>,
    /// Recommend the cheapest line for this relative error, too, such as `5%` or `0.05`; for scenarios whose runs end when they have settled.
    #[arg(long, value_name = "SHARE", value_parser = parse_share)]
    total: Option<f64>,
    /// Switch each effect off in turn instead, at the scenario's own accuracy, and report changes and saved time.
    #[arg(long, conflicts_with_all = ["methods", "mesh_factors", "total"])]
    effects: bool,
    /// Simulations run at the same time; absent means one per core. They disturb each other's processor time: 1 measures best.
    #[arg(long, value_name = "NUMBER")]
    threads: Option<NonZeroUsize>,
    /// Directory for cost.csv and cost.json, and for methods cost.svg and cost.png; of several scenarios a folder each, with
    /// a cost.csv of all next to them.
    #[arg(long, value_name = "DIRECTORY")]
    output: Option<PathBuf>,
    #[command(flatten)]
    speed: SpeedArguments,
    /// Measure of the chart: orbit_size, radius_deviation or trajectory; absent means the first of them that has an error.
    #[arg(long)]
    measure: Option<Measure>,
    /// Format of the output: of several scenarios every report and a table of all (text), that table (csv), or both (json).
    #[arg(long, default_value = "text")]
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Text,
    Csv,
    Json,
}

/// Runs the studies and prints them.
///
/// # Errors
/// A scenario is not valid, before any is run; and in the end, when a study failed.
pub(crate) fn cost(arguments: &CostArguments) -> anyhow::Result<()> {
    let scenarios: Vec<Scenario> = arguments
        .scenarios
        .iter()
        .map(|name| studied(arguments, name).with_context(|| name.clone()))
        .collect::<Result<_, _>>()?;
    announce(&scenarios, &arguments.speed)?;
    let pool =
        ThreadPoolBuilder::new().num_threads(arguments.threads.map_or(0, NonZeroUsize::get)).build()?;
    let run = |scenario: &Scenario| {
        with_progress(study_time(scenario), |control| pool.install(|| cost_study(scenario, control)))
    };
    let is_one = scenarios.len() == 1;
    let folders = folder_names(scenarios.iter().map(|scenario| scenario.name.as_str()));
    let (mut reports, mut failed) = (Vec::new(), Vec::new());
    for (scenario, folder) in scenarios.iter().zip(&folders) {
        // One that fails after hours does not take the others with it.
        let report = match run(scenario) {
            Ok(report) => report,
            Err(error) if is_one => return Err(error),
            Err(error) => {
                tracing::error!("{}: {error:#}", scenario.name);
                failed.push(scenario.name.as_str());
                continue;
            }
        };
        if let Format::Text = arguments.format {
            let text = text(&report);
            print(if is_one { text.trim_end() } else { &text });
        }
        if let Some(directory) = &arguments.output {
            write(
                &report,
                &if is_one { directory.clone() } else { directory.join(folder) },
                arguments.measure,
            )?;
        }
        reports.push(report);
        if let Some(directory) = arguments.output.as_ref().filter(|_| !is_one) {
            // Completed studies stay if a later one is interrupted.
            write_file(&directory.join("cost.csv"), csv::write(&table(&reports))?.as_bytes())?;
        }
    }
    match arguments.format {
        Format::Text if is_one => {}
        Format::Text => print(overview(&reports).trim_end()),
        Format::Csv => print(csv::write(&table(&reports))?.trim_end()),
        Format::Json if is_one => print(&serde_json::to_string_pretty(&reports[0])?),
        Format::Json => {
            print(&serde_json::to_string_pretty(&json!({ "reports": reports, "table": table(&reports) }))?);
        }
    }
    if failed.is_empty() { Ok(()) } else { bail!("no study of {}", failed.join(", ")) }
}

/// The scenario of this name with the study of the arguments.
fn studied(arguments: &CostArguments, name: &str) -> anyhow::Result<Scenario> {
    let mut scenario = arguments.changes.applied_to(name, None)?.resolve()?;
    if scenario.name.is_empty() {
        let stem = Path::new(name).file_stem();
        scenario.name = stem.map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    }
    scenario.cost_study.get_or_insert_default();
    let duration = arguments.duration.map(|duration| ("cost_study.duration", json!(duration)));
    let members = arguments.members.map(|members| ("cost_study.members", json!(members)));
    let reference = arguments.reference.clone().map(|methods| ("cost_study.reference.methods", methods));
    let presets = arguments.presets.as_ref().map(|presets| {
        // An empty list is one empty name to the command line.
        let named: Vec<_> = presets.iter().filter(|name| !name.is_empty()).collect();
        ("cost_study.presets", json!(named))
    });
    let methods = arguments.methods.clone().map(|methods| ("cost_study.methods", methods));
    let factors = &arguments.mesh_factors;
    let meshes = (!factors.is_empty()).then(|| ("cost_study.mesh_factors", json!(factors)));
    let effects = arguments.effects.then(|| ("cost_study.effects", json!(true)));
    let total = arguments.total.map(|total| ("cost_study.total", json!(total)));
    let changes = [duration, members, reference, presets, methods, meshes, total, effects];
    for (path, value) in changes.into_iter().flatten() {
        scenario = scenario.with(path, value)?;
    }
    validate(&scenario)?;
    Ok(scenario)
}

/// Logs the expected cost of the studies, from the speed of this machine.
fn announce(scenarios: &[Scenario], arguments: &SpeedArguments) -> anyhow::Result<()> {
    let speed = machine_speed(arguments)?.speed;
    for scenario in scenarios {
        let (cpu_time, adaptive) = study_cpu_time(scenario, &speed)?;
        let others = match adaptive {
            0 => String::new(),
            lines => format!(", excluding its {lines} lines with adaptive steps"),
        };
        tracing::info!(
            "{}: {} s of simulated time, about {cpu_time:.0} s of processor time{others}",
            scenario.name,
            study_time(scenario)
        );
    }
    Ok(())
}

/// Name of a folder for each scenario: its own, with `-` for unusual characters, and a number if another one has it already.
fn folder_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut folders: Vec<String> = Vec::new();
    for name in names {
        let is_plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        let plain: String = name.chars().map(|c| if is_plain(c) { c } else { '-' }).collect();
        let plain = match plain.trim_start_matches('.') {
            "" => "scenario",
            plain => plain,
        };
        let mut folder = plain.to_owned();
        let mut number = 2;
        while folders.contains(&folder) {
            folder = format!("{plain}-{number}");
            number += 1;
        }
        folders.push(folder);
    }
    folders
}

fn write(report: &CostReport, directory: &Path, measure: Option<Measure>) -> anyhow::Result<()> {
    std::fs::create_dir_all(directory).with_context(|| format!("cannot make {}", directory.display()))?;
    let mut files = vec![
        ("cost.csv", csv::write(&table([report]))?.into_bytes()),
        ("cost.json", serde_json::to_vec_pretty(report)?),
    ];
    if report.compared().next().is_some() {
        let drawing = work_precision(report, measure.unwrap_or_else(|| Measure::usual(report)));
        files.extend([("cost.svg", drawing.svg().into_bytes()), ("cost.png", drawing.png(PNG_WIDTH)?)]);
    }
    for (name, bytes) in files {
        write_file(&directory.join(name), &bytes)?;
    }
    Ok(())
}

fn write_file(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// A part of the whole, above 0 and below 1: `5%`, `5 %` or `0.05`.
fn parse_share(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 100.0),
        None => (text, 1.0),
    };
    let share = number.trim().parse::<f64>().ok().map(|number| number / scale);
    share
        .filter(|share| *share > 0.0 && *share < 1.0)
        .ok_or_else(|| "must be above 0 and below 1 (100%), such as 5% or 0.05".to_owned())
}

fn json_value(text: &str) -> Result<Value, serde_json::Error> {
    serde_json::from_str(text)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: CostArguments,
    }

    fn arguments(line: &[&str]) -> Result<CostArguments, clap::Error> {
        Line::try_parse_from(["cost"].iter().chain(line)).map(|line| line.arguments)
    }

    #[test]
    fn changes_apply_to_every_scenario() {
        let arguments =
            arguments(&["paper-200m", "paper-200m-damped", "--set", "duration=61", "--members", "5"])
                .unwrap();
        let scenarios = arguments.scenarios.iter().map(|name| studied(&arguments, name).unwrap());
        let scenarios: Vec<_> = scenarios.collect();
        assert_eq!(scenarios.len(), 2);
        for scenario in &scenarios {
            assert_eq!((scenario.duration, scenario.cost_study.as_ref().unwrap().members), (61.0, 5));
        }
        assert_eq!(arguments.threads, None, "all cores");
    }

    #[test]
    fn a_whole_error_is_a_percentage_or_a_ratio() {
        let total = |text: &str| arguments(&["paper-200m", "--total", text]).map(|found| found.total);
        for (text, share) in [("5%", 0.05), ("0.05", 0.05), ("0.5 %", 0.005), ("12.5%", 0.125)] {
            assert_eq!(total(text).unwrap(), Some(share), "{text}");
        }
        for text in ["5", "0", "0%", "100%", "-5%", "nan", "five", "%", ""] {
            assert!(total(text).is_err(), "{text}");
        }
        let arguments = arguments(&["paper-200m-damped", "--total", "5%"]).unwrap();
        let scenario = studied(&arguments, "paper-200m-damped").unwrap();
        assert_eq!(scenario.cost_study.unwrap().total, Some(0.05));
        let refused = studied(&arguments, "paper-200m").unwrap_err().to_string();
        assert!(refused.contains("cost_study.total"), "{refused}");
    }

    #[test]
    fn there_is_at_least_one_scenario_and_one_thread() {
        assert!(arguments(&[]).is_err());
        assert!(arguments(&["paper-200m", "--threads", "0"]).is_err());
        assert_eq!(arguments(&["paper-200m", "--threads", "1"]).unwrap().threads, NonZeroUsize::new(1));
    }

    #[test]
    fn every_scenario_has_a_folder_of_its_own_below_the_output() {
        let names = ["closed/string-1000m", "base", "base", "../..", "", "base-2"];
        assert_eq!(
            folder_names(names.into_iter()),
            ["closed-string-1000m", "base", "base-2", "-..", "scenario", "base-2-2"]
        );
    }
}
