//! Submission of sweeps, and of further points.

use std::fmt::Write as _;
use std::io::Write as _;

use anyhow::{Context, anyhow, bail};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use drillsweep_api::{
    AppendRequest, Axis, AxisName, Design, FieldProblem, ListedPoints, PlannedPoint, PlannedVerification,
    Refinement, RefinementState, Scale, Signs, Sweep, SweepRequest,
};
use drillsweep_quantity::{entry, unit};
use drillsweep_scenario::ScenarioRequest;
use serde::Deserialize;
use serde_json::Value;

use crate::client::{Client, DEFAULT_SERVER, ServerArguments, path_segment};
use crate::print;
use crate::scenario::{ScenarioArguments, parse_value};
use crate::sweeps::{print_sweep, verification_line, warn_of_bias, warn_of_doubts};
use crate::text::{Alignment, columns, count, number};
use crate::watch::{check, follow, warn_of_waiting};

#[derive(Args)]
pub(crate) struct SubmitArguments {
    #[command(flatten)]
    server: ServerArguments,
    #[command(flatten)]
    scenario: ScenarioArguments,
    #[command(flatten)]
    design: DesignArguments,
    /// Accuracy: draft, standard or reference.
    #[arg(long)]
    accuracy: Option<String>,
    /// Outputs that are kept of each point: `summary` (its row of the table alone), `spectra`, `full`, or JSON such as
    /// `{"orbits": {"window": {"from": 40, "to": 60}, "decimation": 4}}`.
    #[arg(long, value_parser = parse_value)]
    outputs: Option<Value>,
    /// Verify some of the points by a second run at the accuracy `reference`: a fraction of them such as 0.05, or a number of
    /// them.
    #[arg(long, value_name = "SHARE_OR_NUMBER")]
    verify: Option<f64>,
    /// Name of the sweep.
    #[arg(long)]
    name: Option<String>,
    /// Owner of the sweep, whose share of the workers it uses.
    #[arg(long, env = "DRILLSWEEP_OWNER")]
    owner: Option<String>,
    /// Tag of the sweep; may be given again.
    #[arg(long = "tag", value_name = "TAG")]
    tags: Vec<String>,
    /// Use of results that are stored already: use them (reuse), recompute them (refresh), or use them and compute nothing
    /// (only).
    #[arg(long, default_value = "reuse", value_parser = ["reuse", "refresh", "only"])]
    cache: String,
    /// Priority among the sweeps of one owner, higher first: -10 to 10.
    #[arg(long, allow_negative_numbers = true)]
    priority: Option<i32>,
    /// Idempotency key, such as a UUID: repeated requests with the same key make one sweep.
    #[arg(long)]
    idempotency_key: Option<String>,
    /// Print the points of the request with estimates (with --json also its plan), and store nothing.
    #[arg(long)]
    dry_run: bool,
    /// Return at once instead of watching the sweep.
    #[arg(long)]
    detach: bool,
    /// Print the sweep as JSON instead of its identifier: complete, or as stored with `--detach`.
    #[arg(long)]
    json: bool,
}

/// Points of a sweep.
#[derive(Args)]
pub(crate) struct DesignArguments {
    /// Flow rates in m3/s, or with their unit: `0.01,0.04,0.06` or `from:to:count`, such as `300gpm:700gpm:5`.
    #[arg(long, value_name = "M3_PER_S", value_parser = |text: &str| parse_axis("flow_rate", text))]
    flow_rate: Option<Axis>,
    /// Mud densities in kg/m3, or with their unit: `1200,1500` or `from:to:count`, such as `10ppg:17ppg:4`.
    #[arg(long, value_name = "KG_PER_M3", value_parser = |text: &str| parse_axis("mud_density", text))]
    mud_density: Option<Axis>,
    /// Any numeric field of the scenario as a further axis, such as `operation.rotation_speed_rpm=90,120` or
    /// `contact.stiffness=1e5:1e7:5:log`; with the designs `latin_hypercube` and `sobol`, `from:to` or `from:to:log`.
    #[arg(long, value_name = "PATH=VALUES", value_parser = parse_named_axis)]
    axis: Vec<(String, Axis)>,
    /// Signs of weight on bit and torque on bit in this request: `driller` takes compression, and torque that opposes clockwise rotation, as
    /// positive.
    #[arg(long, default_value = "model", value_parser = PossibleValuesParser::new(["model", "driller"]).try_map(signs))]
    signs: Signs,
    /// Design that makes points from the axes.
    #[arg(
        long,
        default_value = "grid",
        value_parser = PossibleValuesParser::new(["grid", "zip", "latin_hypercube", "sobol"]).try_map(design)
    )]
    design: Design,
    /// Number of points of the designs `latin_hypercube` and `sobol`.
    #[arg(long, value_name = "NUMBER")]
    samples: Option<u32>,
    /// Seed of the designs `latin_hypercube` and `sobol`.
    #[arg(long)]
    seed: Option<u64>,
    /// Number of points to skip at the start of the Sobol sequence: those that a sweep of the same seed has already.
    #[arg(long, value_name = "NUMBER")]
    skip: Option<u32>,
}

#[derive(Args)]
pub(crate) struct AppendArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    #[command(flatten)]
    design: DesignArguments,
    /// Print the sweep as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(crate) struct RefineArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    /// Column whose values are compared, or `class`.
    #[arg(long, default_value = "class", value_name = "COLUMN")]
    by: String,
    /// Parameters over which points are neighbours, one or two.
    #[arg(long, value_name = "PATH", value_delimiter = ',')]
    over: Vec<String>,
    /// Longest edge that is not divided, as a part of the range of a parameter.
    #[arg(long, default_value_t = 0.02, value_name = "PART")]
    resolution: f64,
    /// For a column: smallest difference that is divided, as a part of the range of all values.
    #[arg(long, value_name = "PART")]
    difference: Option<f64>,
    /// For classes: changes of the default limits, `COLUMN:VALUE` or `COLUMN:off`, separated by commas.
    #[arg(long)]
    limits: Option<String>,
    /// Largest number of points to add.
    #[arg(long, default_value_t = 100, value_name = "NUMBER")]
    budget: u32,
    /// Print the sweep as JSON.
    #[arg(long)]
    json: bool,
}

impl DesignArguments {
    /// Part of a request that describes its points.
    fn request(&self) -> AppendRequest {
        let named = [("flow_rate", &self.flow_rate), ("mud_density", &self.mud_density)];
        let named = named.into_iter().filter_map(|(name, axis)| Some((name, axis.as_ref()?)));
        let further = self.axis.iter().map(|(name, axis)| (name.as_str(), axis));
        AppendRequest {
            design: self.design,
            axes: named.chain(further).map(|(name, axis)| (AxisName::from(name), axis.clone())).collect(),
            points: ListedPoints::default(),
            samples: self.samples,
            seed: self.seed,
            skip: self.skip,
            signs: self.signs,
            refine: None,
        }
    }
}

/// Adds points to a sweep and prints its state.
pub(crate) fn append(arguments: &AppendArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let id = client.sweep_id(&arguments.sweep)?;
    let path = format!("/v1/sweeps/{}/points", path_segment(&id));
    let sweep = client.post(&path, &arguments.design.request())?;
    warn(&sweep);
    print_sweep(&sweep, arguments.json)
}

/// Adds points between different neighbours, round by round, until the resolution is reached or the budget is spent; prints the sweep.
pub(crate) fn refine(arguments: &RefineArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let id = client.sweep_id(&arguments.sweep)?;
    let path = format!("/v1/sweeps/{}/points", path_segment(&id));
    let mut sweep = follow(&client, &id)?;
    let first = sweep.counts.total;
    let state = loop {
        let added = u32::try_from(sweep.counts.total.saturating_sub(first))?;
        let left = arguments.budget.saturating_sub(added);
        if left == 0 {
            break sweep.refinement;
        }
        let refine = Refinement {
            by: arguments.by.clone(),
            over: arguments.over.iter().map(|name| AxisName::from(name.as_str())).collect(),
            resolution: arguments.resolution,
            difference: arguments.difference,
            limits: arguments.limits.clone(),
            budget: left,
        };
        let request = AppendRequest { refine: Some(refine), ..AppendRequest::default() };
        let before = sweep.counts.total;
        sweep = client.post(&path, &request)?;
        warn(&sweep);
        if sweep.counts.total == before {
            break sweep.refinement;
        }
        sweep = Sweep { refinement: sweep.refinement, ..follow(&client, &id)? };
    };
    if !arguments.json {
        let added = count(sweep.counts.total.saturating_sub(first), "point");
        print(&match state {
            Some(RefinementState { open_edges, longest_edge, .. }) if open_edges > 0 => format!(
                "{added} added; before the last of them {} longer than {} remained, the longest {longest_edge:.3} of its axis",
                count(open_edges, "edge"),
                arguments.resolution
            ),
            _ => format!("{added} added; every edge is located to {} of its axis", arguments.resolution),
        });
    }
    print_sweep(&sweep, arguments.json)
}

impl SubmitArguments {
    fn request(&self) -> anyhow::Result<SweepRequest> {
        let AppendRequest { design, axes, points, samples, seed, skip, signs, refine: _ } =
            self.design.request();
        let ScenarioRequest { preset, scenario, set } = self.scenario.request(self.accuracy.as_deref())?;
        let outputs = self.outputs.clone().map(serde_json::from_value).transpose();
        Ok(SweepRequest {
            name: self.name.clone(),
            owner: self.owner.clone(),
            tags: self.tags.iter().cloned().collect(),
            preset,
            scenario: scenario.map(Box::new),
            set,
            outputs: outputs.context("--outputs")?,
            design,
            axes,
            points,
            samples,
            seed,
            skip,
            verify: self.verify,
            signs,
            priority: self.priority.unwrap_or_default(),
        })
    }
}

/// Submits a sweep; watches it unless detached; prints its identifier.
pub(crate) fn submit(arguments: &SubmitArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let request = arguments.request()?;
    if arguments.dry_run {
        let dry_run = format!("/v1/sweeps?dry_run=true&cache={}", arguments.cache);
        let answer: Value = client.post(&dry_run, &request)?;
        match arguments.json {
            true => print(&serde_json::to_string_pretty(&answer)?),
            false => print(&DryRun::deserialize(&answer)?.text()),
        }
        return Ok(());
    }
    let key = arguments.idempotency_key.as_deref();
    let headers: Vec<(&str, &str)> = key.map(|key| ("idempotency-key", key)).into_iter().collect();
    let sweep: Sweep =
        client.post_with(&format!("/v1/sweeps?cache={}", arguments.cache), &request, &headers)?;
    warn(&sweep);
    if !arguments.json {
        print(&sweep.id);
        hints(&client, &sweep)?;
    }
    if arguments.detach {
        warn_of_waiting(&sweep);
    }
    let sweep = if arguments.detach { sweep } else { follow(&client, &sweep.id)? };
    if let Some(verification) = &sweep.verification {
        // To the log: standard output has the identifier alone, for scripts.
        tracing::info!("{}", verification_line(verification));
    }
    warn_of_bias(&sweep);
    if !arguments.detach {
        warn_of_doubts(&client, &sweep);
    }
    if arguments.json {
        print(&serde_json::to_string_pretty(&sweep)?);
    }
    if arguments.detach { Ok(()) } else { check(&sweep) }
}

/// Prints the next commands to standard error: standard output has the identifier alone, for scripts.
fn hints(client: &Client, sweep: &Sweep) -> std::io::Result<()> {
    let (id, server) = (&sweep.id, client.server());
    let at = if server == DEFAULT_SERVER { String::new() } else { format!(" --server {server}") };
    writeln!(
        std::io::stderr().lock(),
        "{}; page:  {server}/#/sweeps/{id}\n\
         watch:  drillsweep watch {id}{at}\n\
         when complete:  drillsweep fetch {id}{at} --output results\n\
         table of points:  {server}/v1/sweeps/{id}/table?format=csv\n\
         C_f along the string:  {server}/v1/sweeps/{id}/points/1/profile?format=svg",
        count(sweep.counts.total, "point")
    )
}

/// Fields that are read from the answer to a dry run.
#[derive(Deserialize)]
struct DryRun {
    total: u64,
    known: u64,
    cpu_time: Option<f64>,
    wall_time: Option<f64>,
    table_bytes: u64,
    memory_bytes: u64,
    points: Vec<PlannedPoint>,
    verification: Option<PlannedVerification>,
    #[serde(default)]
    warnings: Vec<FieldProblem>,
}

/// Bytes as a size that people read.
pub(crate) fn megabytes(bytes: u64) -> String {
    format!("{} MB", number((bytes as f64 / 1e6).ceil()))
}

/// Points of a dry run that are shown.
const POINTS_SHOWN: usize = 50;

impl DryRun {
    fn text(&self) -> String {
        let mut text = format!("{}, {} with a result already", count(self.total, "point"), self.known);
        if let Some(references) = &self.verification {
            let _ = write!(text, "; {} reference runs, {} with a result", references.total, references.known);
        }
        let _ = match self.cpu_time {
            Some(time) => write!(text, "\nabout {} s of processor time", number(time.ceil())),
            None => write!(text, "\nprocessor time is not known before a worker has measured its machine"),
        };
        if let Some(time) = self.wall_time {
            let _ = write!(text, ", {} s with the present workers", number(time.ceil()));
        }
        let [tables, memory] = [self.table_bytes, self.memory_bytes].map(megabytes);
        let _ = write!(text, "\n{tables} of tables before compression, {memory} of memory a worker");
        let names: Vec<&String> =
            self.points.first().into_iter().flat_map(|point| point.parameters.keys()).collect();
        let named = |name: &&String| match unit(name).filter(|unit| *unit != "1") {
            Some(unit) => format!("{name} {unit}"),
            None => (*name).clone(),
        };
        let titles: Vec<String> = names.iter().map(named).collect();
        let header: Vec<&str> = ["point"].into_iter().chain(titles.iter().map(String::as_str)).collect();
        let row = |point: &PlannedPoint| {
            let values = names
                .iter()
                .map(|name| point.parameters.get(*name).map_or_else(String::new, |value| number(*value)));
            [point.ordinal.to_string()].into_iter().chain(values).collect()
        };
        let rows: Vec<Vec<String>> = self.points.iter().take(POINTS_SHOWN).map(row).collect();
        let _ = write!(text, "\n{}", columns(&header, &rows, |_| Alignment::Right));
        if self.points.len() > POINTS_SHOWN {
            let _ = write!(text, "\n... and {} more; --json lists all", self.points.len() - POINTS_SHOWN);
        }
        for warning in &self.warnings {
            let _ = write!(text, "\nwarning: {warning}");
        }
        text
    }
}

/// Logs warnings on requests that are valid but probably not meant.
fn warn(sweep: &Sweep) {
    for warning in &sweep.warnings {
        tracing::warn!("{}: {}", warning.pointer.as_deref().unwrap_or_default(), warning.detail);
    }
}

fn design(name: String) -> Result<Design, serde_json::Error> {
    serde_json::from_value(Value::String(name))
}

fn signs(name: String) -> Result<Signs, serde_json::Error> {
    serde_json::from_value(Value::String(name))
}

/// `path=` and values as [`parse_axis`] reads them.
fn parse_named_axis(text: &str) -> anyhow::Result<(String, Axis)> {
    let (path, values) = text.split_once('=').with_context(|| format!("write PATH=VALUES, got {text:?}"))?;
    let path = path.trim();
    Ok((path.to_owned(), parse_axis(path, values)?))
}

/// `a,b,c`, `from:to:count`, `from:to`, the latter two with `:log` for equal ratios. A value of a quantity may have its unit.
pub(crate) fn parse_axis(path: &str, text: &str) -> anyhow::Result<Axis> {
    let units = drillsweep_quantity::of(path).and_then(|quantity| quantity.units);
    let number = |text: &str| -> anyhow::Result<f64> {
        match (text.trim().parse(), units) {
            (Ok(value), _) => Ok(value),
            (Err(_), Some(units)) => {
                entry::read(text, units).map_err(|error| anyhow!("{text:?} must be {error}"))
            }
            (Err(_), None) => bail!("{text:?} is not a number"),
        }
    };
    let (text, scale) = match text.strip_suffix(":log") {
        Some(range) => (range, Scale::Log),
        None => (text, Scale::Linear),
    };
    let parts: Vec<&str> = text.split(':').collect();
    match parts[..] {
        [from, to] => Ok(Axis::Interval { from: number(from)?, to: number(to)?, scale }),
        [list] => {
            let values: anyhow::Result<Vec<f64>> = list.split(',').map(number).collect();
            Ok(Axis::Values { values: values? })
        }
        [from, to, count] => {
            let count: u32 = count.trim().parse().with_context(|| format!("{count:?} is not a count"))?;
            Ok(Axis::Range { from: number(from)?, to: number(to)?, count, scale })
        }
        _ => bail!("write a list such as 0.01,0.04 or a range from:to:count, got {text:?}"),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn values_of_an_axis_have_units_of_its_quantity() {
        let range = |from: f64, to: f64| Axis::Range { from, to, count: 5, scale: Scale::Linear };
        let gpm = |number: f64| number * 0.003_785_411_784 / 60.0;
        let flow = parse_axis("flow_rate", "300gpm:700 gpm:5").unwrap();
        assert!(
            matches!(flow, Axis::Range { from, .. } if (from / gpm(300.0) - 1.0).abs() < 1e-15),
            "{flow:?}"
        );
        let speed = parse_named_axis("operation.rotation_speed_rpm=1rev/s:2rev/s:5").unwrap();
        assert_eq!(speed, ("operation.rotation_speed_rpm".to_owned(), range(60.0, 120.0)));
        let widths = parse_named_axis("well.hole_diameter=8 1/2 in, 0.25").unwrap().1;
        assert_eq!(widths, Axis::Values { values: vec![0.2159, 0.25] });
        let message = parse_axis("mud_density", "10ppg,500gpm").unwrap_err().to_string();
        assert!(message.contains("\"500gpm\"") && message.contains("unit of volume flow rate"), "{message}");
        assert!(parse_axis("no.such.field", "10ppg").unwrap_err().to_string().contains("not a number"));
    }

    #[test]
    fn a_dry_run_is_a_table_with_estimates() {
        let point = |ordinal: u32| json!({"ordinal": ordinal, "parameters": {"flow_rate": 0.01, "contact.friction": 0.3}, "key": "k"});
        let dry_run = |points: u32, more: Value| {
            let mut answer = json!({
                "total": points, "known": 0, "table_bytes": 123_456, "memory_bytes": 7_000_000,
                "points": (1..=points).map(point).collect::<Vec<_>>(),
            });
            answer.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
            DryRun::deserialize(&answer).unwrap().text()
        };
        let warning =
            json!({"pointer": "/set/accuracy", "detail": "the step is longer than a period of the contact"});
        let verified = json!({
            "known": 1, "cpu_time": 1234.5, "wall_time": 310.2, "verification": {"total": 1, "known": 0, "points": []},
            "warnings": [warning],
        });
        insta::assert_snapshot!([dry_run(2, verified), dry_run(52, json!({}))].join("\n\n"));
    }
}
