//! What accuracy costs for a scenario, measured on this machine.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use drillsweep_api::cost::{Measure, PNG_WIDTH, chart, csv, text};
use drillsweep_sim::scenario::Scenario;
use drillsweep_sim::study::CostReport;
use drillsweep_worker::{calibrate, cost_study, study_cpu_time, study_time};
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
    /// Seconds of simulated time of each run in place of the scenario's own; orbits are then looked at over the last third,
    /// spectra over the last sixth.
    #[arg(long)]
    duration: Option<f64>,
    /// Members of the ensemble that each method runs: with 5 or more, bias can be told from spread.
    #[arg(long)]
    members: Option<u32>,
    /// The two methods that make the reference, as JSON: `[{"integrator": "rk4", "step": 5e-5}, {"integrator": "esdirk4", "step":
    /// 1.25e-4, "contact_sweeps": 30}]`.
    #[arg(long, value_parser = json_value)]
    reference: Option<Value>,
    /// Named accuracies to compare, such as `draft,standard`; all three unless said otherwise, none for ''.
    #[arg(long, value_delimiter = ',')]
    presets: Option<Vec<String>>,
    /// Methods and steps in place of the usual ones, as JSON: `[{"integrator": "esdirk4", "steps": [1e-3, 5e-4]}]`; `[]` for none.
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
    /// What the chart shows: orbit_size, radius_deviation or trajectory; absent means the first of them that has an error.
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
    let changes = [duration, members, reference, presets, methods, meshes, effects];
    for (path, value) in changes.into_iter().flatten() {
        scenario = scenario.with(path, value)?;
    }
    scenario.validate()?;
    announce(&scenario)?;
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

/// Says what the study will take, measured by some short runs on this machine.
fn announce(scenario: &Scenario) -> anyhow::Result<()> {
    let (cpu_time, adaptive) = study_cpu_time(scenario, &calibrate()?)?;
    let others = match adaptive {
        0 => String::new(),
        lines => format!(", without the {lines} of its lines whose steps adapt themselves"),
    };
    tracing::info!(
        "{} s of simulated time, about {cpu_time:.0} s of processor time{others}",
        study_time(scenario)
    );
    Ok(())
}

fn write(report: &CostReport, directory: &Path, measure: Option<Measure>) -> anyhow::Result<()> {
    std::fs::create_dir_all(directory).with_context(|| format!("cannot make {}", directory.display()))?;
    let mut files =
        vec![("cost.csv", csv(report).into_bytes()), ("cost.json", serde_json::to_vec_pretty(report)?)];
    if report.compared().next().is_some() {
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
