//! Submitting a sweep and watching it.

use std::path::PathBuf;

use anyhow::{Context, bail, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Map, Value, json};

use crate::client::{Client, ServerArguments};
use crate::print;
use crate::simulate::parse_set;

#[derive(Args)]
pub(crate) struct SubmitArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// A preset's name (see `drillsweep scenario`) or a scenario file (.toml or .json).
    scenario: String,
    /// Flow rates \[m3/s\]: `0.01,0.04,0.06` or `from:to:count`.
    #[arg(long, value_parser = parse_axis)]
    flow_rate: Option<Value>,
    /// Mud densities \[kg/m3\]: `1200,1500` or `from:to:count`.
    #[arg(long, value_parser = parse_axis)]
    mud_density: Option<Value>,
    /// Change a field of the scenario, such as `duration=5` or `operation.rotation_speed_rpm=90`.
    #[arg(long, value_name = "PATH=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
    /// A name for people.
    #[arg(long)]
    name: Option<String>,
    /// Whose share of the workers it counts against.
    #[arg(long, env = "DRILLSWEEP_OWNER")]
    owner: Option<String>,
    /// Print what the request would become, and store nothing.
    #[arg(long)]
    dry_run: bool,
    /// Return at once instead of watching the sweep.
    #[arg(long)]
    detach: bool,
}

#[derive(Args)]
pub(crate) struct WatchArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
}

/// Submits a sweep; watches it unless told otherwise; prints its identifier.
pub(crate) fn submit(arguments: &SubmitArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server);
    let mut request = Map::new();
    let path = PathBuf::from(&arguments.scenario);
    if path.extension().is_some_and(|extension| extension == "toml" || extension == "json") {
        let scenario = crate::simulate::read_scenario(&arguments.scenario)?;
        request.insert("scenario".into(), serde_json::from_str(&scenario.to_json())?);
    } else {
        request.insert("preset".into(), json!(arguments.scenario));
    }
    let mut axes = Map::new();
    for (name, axis) in [("flow_rate", &arguments.flow_rate), ("mud_density", &arguments.mud_density)] {
        if let Some(axis) = axis {
            axes.insert(name.into(), axis.clone());
        }
    }
    request.insert("axes".into(), Value::Object(axes));
    if !arguments.set.is_empty() {
        request.insert("set".into(), Value::Object(arguments.set.iter().cloned().collect()));
    }
    for (name, text) in [("name", &arguments.name), ("owner", &arguments.owner)] {
        if let Some(text) = text {
            request.insert(name.into(), json!(text));
        }
    }
    let request = Value::Object(request);
    if arguments.dry_run {
        print(&serde_json::to_string_pretty(&client.post("/v1/sweeps?dry_run=true", &request)?)?);
        return Ok(());
    }
    let sweep = client.post("/v1/sweeps", &request)?;
    let id = sweep["id"].as_str().context("the server's answer has no id")?.to_owned();
    print(&id);
    if arguments.detach { Ok(()) } else { follow(&client, &id) }
}

/// Watches a sweep until it is complete.
pub(crate) fn watch(arguments: &WatchArguments) -> anyhow::Result<()> {
    follow(&Client::new(&arguments.server), &arguments.sweep)
}

fn follow(client: &Client, id: &str) -> anyhow::Result<()> {
    let bar = ProgressBar::new(1000);
    bar.set_style(ProgressStyle::with_template("{bar:40} {percent:>3} % {elapsed}, {eta} left, {msg}")?);
    loop {
        let sweep = client.get(&format!("/v1/sweeps/{id}"))?;
        let counts = &sweep["counts"];
        let count = |name: &str| counts[name].as_u64().unwrap_or(0);
        let progress = sweep["progress"].as_f64().unwrap_or(0.0);
        bar.set_position((progress * 1000.0) as u64);
        bar.set_message(format!(
            "{} of {} points, {} running, {} failed",
            count("succeeded"),
            count("total"),
            count("running"),
            count("failed")
        ));
        if sweep["state"] != "running" {
            bar.abandon();
            ensure!(
                count("failed") == 0,
                "{} points failed; `drillsweep fetch {id}` has the reasons",
                count("failed")
            );
            return Ok(());
        }
        std::thread::sleep(std::time::Duration::from_millis(500));
    }
}

/// `a,b,c` or `from:to:count`.
fn parse_axis(text: &str) -> anyhow::Result<Value> {
    let number = |text: &str| -> anyhow::Result<f64> {
        text.trim().parse().with_context(|| format!("{text:?} is not a number"))
    };
    let parts: Vec<&str> = text.split(':').collect();
    match parts[..] {
        [list] => {
            let values: anyhow::Result<Vec<f64>> = list.split(',').map(number).collect();
            Ok(json!({ "values": values? }))
        }
        [from, to, count] => {
            let count: u32 = count.trim().parse().with_context(|| format!("{count:?} is not a count"))?;
            Ok(json!({ "from": number(from)?, "to": number(to)?, "count": count }))
        }
        _ => bail!("write a list such as 0.01,0.04 or a range from:to:count, got {text:?}"),
    }
}
