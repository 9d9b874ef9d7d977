//! Reports of sweeps and points, as files to print.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use crate::client::{Client, ServerArguments, path_segment};
use crate::print;
use crate::sweeps::with_filters;

#[derive(Args)]
pub(crate) struct ReportArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    /// One of its points, from 1; absent means the whole sweep.
    point: Option<u32>,
    /// HTML file to write.
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    output: PathBuf,
    /// Units of values and pictures.
    #[arg(long, value_parser = ["si", "field"], default_value = "si")]
    units: String,
    /// Changes of the limits by which points are judged: COLUMN:VALUE or COLUMN:off, separated by commas.
    #[arg(long, value_name = "LIMITS")]
    limits: Option<String>,
}

/// Writes the report that the server makes, and prints the file's name.
pub(crate) fn report(arguments: &ReportArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let id = path_segment(&client.sweep_id(&arguments.sweep)?);
    let of_what = match arguments.point {
        Some(point) => format!("/v1/sweeps/{id}/points/{point}"),
        None => format!("/v1/sweeps/{id}"),
    };
    let path = format!("{of_what}/report?units={}", arguments.units);
    let html = client.bytes(&with_filters(path, &[("limits", &arguments.limits)]))?;
    let file = &arguments.output;
    std::fs::write(file, html).with_context(|| format!("cannot write {}", file.display()))?;
    print(&file.display().to_string());
    Ok(())
}
