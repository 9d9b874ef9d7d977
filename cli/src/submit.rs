//! Submitting a sweep, and adding points to one.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use serde_json::{Map, Value, json};

use crate::client::{Client, ServerArguments};
use crate::print;
use crate::simulate::{parse_set, parse_value};
use crate::sweeps::{percent_encoded, print_sweep, verification_line, warn_of_bias};
use crate::watch::{check, follow};

#[derive(Args)]
pub(crate) struct SubmitArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// A preset's name (see `drillsweep scenario`) or a scenario file (.toml or .json).
    scenario: String,
    #[command(flatten)]
    design: DesignArguments,
    /// Change a field of the scenario, such as `duration=5` or `operation.rotation_speed_rpm=90`.
    #[arg(long, value_name = "PATH=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
    /// Accuracy: draft, standard or reference.
    #[arg(long)]
    accuracy: Option<String>,
    /// What is kept of each point: `summary` (its row of the table alone), `spectra`, `full`, or JSON such as
    /// `{"orbits": {"window": {"from": 40, "to": 60}, "decimation": 4}}`.
    #[arg(long, value_parser = parse_value)]
    outputs: Option<Value>,
    /// Run some of the points again by the reference, to see how far the accuracy can be trusted: a part of them such as 0.05, or a
    /// number of them.
    #[arg(long)]
    verify: Option<f64>,
    /// A name for people.
    #[arg(long)]
    name: Option<String>,
    /// Whose share of the workers it counts against.
    #[arg(long, env = "DRILLSWEEP_OWNER")]
    owner: Option<String>,
    /// A word to find the sweep by; may be given again.
    #[arg(long = "tag", value_name = "TAG")]
    tags: Vec<String>,
    /// What becomes of points that were computed before: take their results (reuse), compute them anew (refresh), or
    /// take them and compute nothing (only).
    #[arg(long, default_value = "reuse", value_parser = ["reuse", "refresh", "only"])]
    cache: String,
    /// Higher goes first among the sweeps of one owner: -10 to 10.
    #[arg(long, allow_negative_numbers = true)]
    priority: Option<i32>,
    /// A text of your making: the same request under the same text is one sweep, however often it is sent.
    #[arg(long)]
    idempotency_key: Option<String>,
    /// Print what the request would become, and store nothing.
    #[arg(long)]
    dry_run: bool,
    /// Return at once instead of watching the sweep.
    #[arg(long)]
    detach: bool,
    /// Print the sweep as JSON instead of its identifier: complete, or as stored with `--detach`.
    #[arg(long)]
    json: bool,
}

/// Which points.
#[derive(Args)]
pub(crate) struct DesignArguments {
    /// Flow rates \[m3/s\]: `0.01,0.04,0.06` or `from:to:count`.
    #[arg(long, value_parser = parse_axis)]
    flow_rate: Option<Value>,
    /// Mud densities \[kg/m3\]: `1200,1500` or `from:to:count`.
    #[arg(long, value_parser = parse_axis)]
    mud_density: Option<Value>,
    /// Any numeric field of the scenario as a further axis, such as `operation.rotation_speed_rpm=90,120` or
    /// `contact.stiffness=1e5:1e7:5:log`; with the designs that draw, `from:to` or `from:to:log`.
    #[arg(long, value_name = "PATH=VALUES", value_parser = parse_named_axis)]
    axis: Vec<(String, Value)>,
    /// How points are made from the axes.
    #[arg(long, default_value = "grid", value_parser = ["grid", "zip", "latin_hypercube", "sobol"])]
    design: String,
    /// Number of points of a design that draws.
    #[arg(long)]
    samples: Option<u32>,
    /// What such a design is drawn from.
    #[arg(long)]
    seed: Option<u64>,
    /// Points at the start of the Sobol sequence to skip: as many as a sweep of the same seed has already.
    #[arg(long)]
    skip: Option<u32>,
}

#[derive(Args)]
pub(crate) struct AppendArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
    #[command(flatten)]
    design: DesignArguments,
    /// Print the sweep as JSON.
    #[arg(long)]
    json: bool,
}

impl DesignArguments {
    /// What a request says of its points.
    fn request(&self) -> Map<String, Value> {
        let mut axes = Map::new();
        for (name, axis) in [("flow_rate", &self.flow_rate), ("mud_density", &self.mud_density)] {
            if let Some(axis) = axis {
                axes.insert(name.into(), axis.clone());
            }
        }
        axes.extend(self.axis.iter().cloned());
        let mut request = Map::from_iter([
            ("axes".to_owned(), Value::Object(axes)),
            ("design".to_owned(), json!(self.design)),
        ]);
        for (name, number) in [
            ("samples", self.samples.map(u64::from)),
            ("seed", self.seed),
            ("skip", self.skip.map(u64::from)),
        ] {
            if let Some(number) = number {
                request.insert(name.to_owned(), json!(number));
            }
        }
        request
    }
}

/// Adds points to a sweep; prints how it stands then.
pub(crate) fn append(arguments: &AppendArguments) -> anyhow::Result<()> {
    let path = format!("/v1/sweeps/{}/points", percent_encoded(&arguments.sweep));
    let request = Value::Object(arguments.design.request());
    let sweep = Client::new(&arguments.server).post(&path, &request)?;
    warn(&sweep);
    print_sweep(&sweep, arguments.json)
}

/// Submits a sweep; watches it unless told otherwise; prints its identifier.
pub(crate) fn submit(arguments: &SubmitArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server);
    let mut request = arguments.design.request();
    let path = PathBuf::from(&arguments.scenario);
    if path.extension().is_some_and(|extension| extension == "toml" || extension == "json") {
        let scenario = crate::simulate::read_scenario(&arguments.scenario)?;
        request.insert("scenario".into(), serde_json::from_str(&scenario.to_json())?);
    } else {
        request.insert("preset".into(), json!(arguments.scenario));
    }
    let accuracy = arguments.accuracy.iter().map(|name| ("accuracy".to_owned(), json!(name)));
    let set: Map<String, Value> = arguments.set.iter().cloned().chain(accuracy).collect();
    if !set.is_empty() {
        request.insert("set".into(), Value::Object(set));
    }
    if let Some(outputs) = &arguments.outputs {
        request.insert("outputs".into(), outputs.clone());
    }
    if let Some(verify) = arguments.verify {
        request.insert("verify".into(), json!(verify));
    }
    if let Some(priority) = arguments.priority {
        request.insert("priority".into(), json!(priority));
    }
    if !arguments.tags.is_empty() {
        request.insert("tags".into(), json!(arguments.tags));
    }
    for (name, text) in [("name", &arguments.name), ("owner", &arguments.owner)] {
        if let Some(text) = text {
            request.insert(name.into(), json!(text));
        }
    }
    let request = Value::Object(request);
    if arguments.dry_run {
        let dry_run = format!("/v1/sweeps?dry_run=true&cache={}", arguments.cache);
        print(&serde_json::to_string_pretty(&client.post(&dry_run, &request)?)?);
        return Ok(());
    }
    let key = arguments.idempotency_key.as_deref();
    let headers: Vec<(&str, &str)> = key.map(|key| ("idempotency-key", key)).into_iter().collect();
    let sweep = client.post_with(&format!("/v1/sweeps?cache={}", arguments.cache), &request, &headers)?;
    warn(&sweep);
    let id = sweep["id"].as_str().context("the server's answer has no id")?;
    if !arguments.json {
        print(id);
    }
    let sweep = if arguments.detach { sweep } else { follow(&client, id)? };
    if let Some(verification) = sweep.get("verification") {
        // To the log: what is printed is the identifier alone, for scripts.
        tracing::info!("{}", verification_line(verification));
    }
    warn_of_bias(&sweep);
    if arguments.json {
        print(&serde_json::to_string_pretty(&sweep)?);
    }
    if arguments.detach { Ok(()) } else { check(&sweep) }
}

/// What can be simulated but is probably not meant.
fn warn(sweep: &Value) {
    for warning in sweep["warnings"].as_array().into_iter().flatten() {
        let text = |name: &str| warning[name].as_str().unwrap_or_default();
        tracing::warn!("{}: {}", text("pointer"), text("detail"));
    }
}

/// `path=` and values as [`parse_axis`] reads them.
fn parse_named_axis(text: &str) -> anyhow::Result<(String, Value)> {
    let (path, values) = text.split_once('=').with_context(|| format!("write PATH=VALUES, got {text:?}"))?;
    Ok((path.trim().to_owned(), parse_axis(values)?))
}

/// `a,b,c`, `from:to:count`, `from:to`, the latter two with `:log` for equal ratios.
fn parse_axis(text: &str) -> anyhow::Result<Value> {
    let number = |text: &str| -> anyhow::Result<f64> {
        text.trim().parse().with_context(|| format!("{text:?} is not a number"))
    };
    let (text, scale) = match text.strip_suffix(":log") {
        Some(range) => (range, "log"),
        None => (text, "linear"),
    };
    let parts: Vec<&str> = text.split(':').collect();
    match parts[..] {
        [from, to] => Ok(json!({ "from": number(from)?, "to": number(to)?, "scale": scale })),
        [list] => {
            let values: anyhow::Result<Vec<f64>> = list.split(',').map(number).collect();
            Ok(json!({ "values": values? }))
        }
        [from, to, count] => {
            let count: u32 = count.trim().parse().with_context(|| format!("{count:?} is not a count"))?;
            Ok(json!({ "from": number(from)?, "to": number(to)?, "count": count, "scale": scale }))
        }
        _ => bail!("write a list such as 0.01,0.04 or a range from:to:count, got {text:?}"),
    }
}
