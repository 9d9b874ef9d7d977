//! Watching a sweep until it is complete.

use anyhow::ensure;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::Value;

use crate::client::{Client, ServerArguments};
use crate::print;
use crate::sweeps::{percent_encoded, sweep_line, warn_of_bias};

#[derive(Args)]
pub(crate) struct WatchArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep's identifier.
    sweep: String,
    /// Print the complete sweep as JSON.
    #[arg(long)]
    json: bool,
}

/// Watches a sweep until every point is final, and the reference runs that verify some; fails if points have no result.
pub(crate) fn watch(arguments: &WatchArguments) -> anyhow::Result<()> {
    let sweep = follow(&Client::new(&arguments.server), &arguments.sweep)?;
    warn_of_bias(&sweep);
    if arguments.json {
        print(&serde_json::to_string_pretty(&sweep)?);
    } else {
        print(&sweep_line(&sweep));
    }
    check(&sweep)
}

/// Follows a sweep with a progress bar and returns it as it is when every point is final. A server that is away for
/// a while, as when it is started anew, is waited for.
pub(crate) fn follow(client: &Client, id: &str) -> anyhow::Result<Value> {
    let path = format!("/v1/sweeps/{}", percent_encoded(id));
    let bar = ProgressBar::new(1000);
    bar.set_style(ProgressStyle::with_template("{bar:40} {percent:>3} % {elapsed}, {eta} left, {msg}")?);
    let mut sweep = client.get(&path)?;
    loop {
        let counts = &sweep["counts"];
        let count = |name: &str| counts[name].as_u64().unwrap_or(0);
        bar.set_position((sweep["progress"].as_f64().unwrap_or(0.0) * 1000.0) as u64);
        let verified = &sweep["verification"]["counts"];
        let verified = match verified["total"].as_u64() {
            Some(total) => format!(", {} of {total} verified", verified["succeeded"]),
            None => String::new(),
        };
        bar.set_message(format!(
            "{} of {} points, {} running, {} failed{verified}",
            count("succeeded"),
            count("total"),
            count("running"),
            count("failed")
        ));
        if !sweep["finished"].is_null() {
            bar.abandon();
            return Ok(sweep);
        }
        sweep = client.get_with_retries(&format!("{path}?wait=30s"))?;
    }
}

/// An error if a point has no result, so that scripts can tell by the exit status.
pub(crate) fn check(sweep: &Value) -> anyhow::Result<()> {
    let count = |name: &str| sweep["counts"][name].as_u64().unwrap_or(0);
    let id = sweep["id"].as_str().unwrap_or_default();
    ensure!(
        count("failed") == 0,
        "{} points failed; `drillsweep show {id}` has the reasons",
        count("failed")
    );
    ensure!(
        count("cancelled") == 0,
        "{} points were cancelled; `drillsweep retry {id}` queues them",
        count("cancelled")
    );
    Ok(())
}
