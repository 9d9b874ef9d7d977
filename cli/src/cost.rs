//! What accuracy costs for a scenario, measured on this machine.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use drillsweep_api::cost::{Measure, PNG_WIDTH, chart, csv, text};
use drillsweep_sim::scenario::Scenario;
use drillsweep_sim::study::CostReport;
use drillsweep_worker::{cost_study, study_time};
use serde_json::{Value, json};

use crate::print;
use crate::simulate::{parse_set, read_scenario, with_progress};

#[derive(Args)]
pub(crate) struct CostArguments {
    /// A preset's name (see `drillsweep scenario`) or a scenario file (.toml or .json).
    scenario: String,
    /// Change a field of the scenario, such as `mud.flow_rate=0.04` or `mud=null`.
    #[arg(long, value_name = "PATH=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
    /// Seconds of simulated time of each run; 10 where the scenario says nothing else.
    #[arg(long)]
    duration: Option<f64>,
    /// Methods and steps in place of the usual ones, as JSON: `[{"integrator": "esdirk4", "steps": [1e-3, 5e-4]}]`.
    #[arg(long, value_parser = json_value)]
    methods: Option<Value>,
    /// Meshes to compare, as factors on the element lengths, such as `2,0.5,0.25`.
    #[arg(long, value_delimiter = ',')]
    mesh_factors: Vec<f64>,
    /// Switch each effect off in turn instead, at the scenario's own accuracy: what it changes, what time it saves.
    #[arg(long, conflicts_with_all = ["methods", "mesh_factors"])]
    effects: bool,
    /// Directory for cost.csv and cost.json, and for methods cost.svg and cost.png.
    #[arg(long)]
    output: Option<PathBuf>,
    /// What the chart shows: orbit_size or trajectory; absent means the first, or the other where the first has no error.
    #[arg(long)]
    measure: Option<Measure>,
    /// What is printed.
    #[arg(long, default_value = "text")]
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Text,
    Csv,
    Json,
}

/// Runs the study and prints it.
pub(crate) fn cost(arguments: &CostArguments) -> anyhow::Result<()> {
    let mut scenario = read_scenario(&arguments.scenario)?;
    for (path, value) in arguments.set.iter().cloned() {
        scenario = scenario.with(&path, value)?;
    }
    let mut scenario = without_windows(scenario);
    scenario.cost_study.get_or_insert_default();
    let duration = arguments.duration.map(|duration| ("cost_study.duration", json!(duration)));
    let methods = arguments.methods.clone().map(|methods| ("cost_study.methods", methods));
    let factors = &arguments.mesh_factors;
    let meshes = (!factors.is_empty()).then(|| ("cost_study.mesh_factors", json!(factors)));
    let effects = arguments.effects.then(|| ("cost_study.effects", json!(true)));
    for (path, value) in [duration, methods, meshes, effects].into_iter().flatten() {
        scenario = scenario.with(path, value)?;
    }
    scenario.validate()?;
    let report = with_progress(study_time(&scenario), |control| cost_study(&scenario, control))?;
    if let Some(directory) = &arguments.output {
        write(&report, directory, arguments.measure)?;
    }
    match arguments.format {
        Format::Text => print(text(&report).trim_end()),
        Format::Csv => print(csv(&report).trim_end()),
        Format::Json => print(&serde_json::to_string_pretty(&report)?),
    }
    Ok(())
}

/// A study records windows of its own; those of the scenario may lie beyond a duration that was changed.
fn without_windows(mut scenario: Scenario) -> Scenario {
    scenario.recording.spectrum_windows.clear();
    scenario.recording.orbit_window = None;
    scenario
}

fn write(report: &CostReport, directory: &Path, measure: Option<Measure>) -> anyhow::Result<()> {
    std::fs::create_dir_all(directory).with_context(|| format!("cannot make {}", directory.display()))?;
    let mut files =
        vec![("cost.csv", csv(report).into_bytes()), ("cost.json", serde_json::to_vec_pretty(report)?)];
    if !report.methods.is_empty() {
        let chart = chart(report, measure.unwrap_or_else(|| Measure::usual(report)));
        files.extend([("cost.svg", chart.svg().into_bytes()), ("cost.png", chart.png(PNG_WIDTH)?)]);
    }
    for (name, bytes) in files {
        let path = directory.join(name);
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

fn json_value(text: &str) -> Result<Value, serde_json::Error> {
    serde_json::from_str(text)
}
