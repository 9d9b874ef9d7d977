//! Bringing a sweep's results to files.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use serde_json::json;

use crate::client::{Client, ServerArguments};
use crate::print;
use crate::sweeps::percent_encoded;

/// Tables of one point.
const TABLES: [&str; 5] = ["profile", "statics", "history", "contacts", "energy"];

#[derive(Args)]
pub(crate) struct FetchArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
    /// Directory to write to; made if it does not exist.
    #[arg(long, default_value = "results")]
    output: PathBuf,
    /// Format of the files.
    #[arg(long, value_enum, default_value = "csv")]
    format: Format,
    /// Bring the sweep's table only.
    #[arg(long)]
    table_only: bool,
    /// Print the names of the files as JSON instead of the directory's.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Csv,
    Json,
    Parquet,
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Parquet => "parquet",
        }
    }
}

/// Writes `table.csv` with a row a point, and a folder a point with its tables and full spectra.
pub(crate) fn fetch(arguments: &FetchArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server);
    let id = &percent_encoded(&arguments.sweep);
    let format = arguments.format.name();
    std::fs::create_dir_all(&arguments.output)
        .with_context(|| format!("cannot make {}", arguments.output.display()))?;
    let table = client.bytes(&format!("/v1/sweeps/{id}/table?format={format}"))?;
    let mut files = Files::default();
    files.write(arguments.output.join(format!("table.{format}")), &table)?;
    if !arguments.table_only {
        points(&client, id, &arguments.output, format, &mut files)?;
    }
    if arguments.json {
        print(&serde_json::to_string_pretty(&json!(files.written))?);
    } else {
        print(&format!("{}", arguments.output.display()));
    }
    Ok(())
}

fn points(client: &Client, id: &str, output: &Path, format: &str, files: &mut Files) -> anyhow::Result<()> {
    let sweep = client.get(&format!("/v1/sweeps/{id}"))?;
    let total = sweep["counts"]["total"].as_u64().unwrap_or(0);
    let bar = ProgressBar::new(total);
    for ordinal in 1..=total {
        let path = format!("/v1/sweeps/{id}/points/{ordinal}");
        let point = client.get(&path)?;
        let folder = output.join(format!("point-{ordinal:04}"));
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        files.write(folder.join("point.json"), serde_json::to_string_pretty(&point)?.as_bytes())?;
        let has =
            |name: &str| point["tables"].as_array().is_some_and(|tables| tables.iter().any(|t| t == name));
        for table in TABLES.into_iter().filter(|table| has(table)) {
            let bytes = client.bytes(&format!("{path}/{table}?format={format}"))?;
            files.write(folder.join(format!("{table}.{format}")), &bytes)?;
        }
        if has("cost") {
            for extension in ["json", "csv", "svg", "png"] {
                let bytes = client.bytes(&format!("{path}/cost?format={extension}"))?;
                files.write(folder.join(format!("cost.{extension}")), &bytes)?;
            }
        }
        if has("history") {
            for node in recorded_nodes(&point["summary"]) {
                for window in
                    point["scenario"]["recording"]["spectrum_windows"].as_array().into_iter().flatten()
                {
                    let (from, to) = (&window["from"], &window["to"]);
                    let query = format!("node={node}&from={from}&to={to}&window=hann&format={format}");
                    let bytes = client.bytes(&format!("{path}/spectrum?{query}"))?;
                    let name = format!("spectrum-node{node}-{from}-{to}s.{format}");
                    files.write(folder.join(name), &bytes)?;
                }
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

/// Numbers of the nodes that a summary speaks of.
fn recorded_nodes(summary: &serde_json::Value) -> Vec<u32> {
    let prefix = "orbit_mean_radius_";
    let names = summary.as_object().into_iter().flat_map(|summary| summary.keys());
    names.filter_map(|name| name.strip_prefix(prefix)?.parse().ok()).collect()
}

/// The files as they are written.
#[derive(Default)]
struct Files {
    written: Vec<PathBuf>,
}

impl Files {
    fn write(&mut self, path: PathBuf, bytes: &[u8]) -> anyhow::Result<()> {
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        self.written.push(path);
        Ok(())
    }
}
