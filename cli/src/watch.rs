//! Progress of a sweep until it is complete.

use anyhow::ensure;
use clap::Args;
use drillsweep_api::{Sweep, SweepVerification};
use indicatif::{ProgressBar, ProgressStyle};

use crate::client::{Client, ServerArguments, path_segment};
use crate::print;
use crate::sweeps::{sweep_line, warn_of_bias, warn_of_doubts};

#[derive(Args)]
pub(crate) struct WatchArguments {
    #[command(flatten)]
    server: ServerArguments,
    /// The sweep: its identifier, the beginning of its identifier, or its name.
    sweep: String,
    /// Print the complete sweep as JSON.
    #[arg(long)]
    json: bool,
}

/// Watches a sweep until every point is final, and the reference runs that verify some; fails if points have no result.
pub(crate) fn watch(arguments: &WatchArguments) -> anyhow::Result<()> {
    let client = Client::new(&arguments.server)?;
    let sweep = follow(&client, &client.sweep_id(&arguments.sweep)?)?;
    warn_of_bias(&sweep);
    warn_of_doubts(&client, &sweep);
    if arguments.json {
        print(&serde_json::to_string_pretty(&sweep)?);
    } else {
        print(&sweep_line(&sweep));
    }
    check(&sweep)
}

/// Follows a sweep with a progress bar and returns it once every point is final. Requests are retried while the server
/// does not answer, as during a restart.
pub(crate) fn follow(client: &Client, id: &str) -> anyhow::Result<Sweep> {
    let path = format!("/v1/sweeps/{}", path_segment(id));
    let bar = ProgressBar::new(1000);
    bar.set_style(ProgressStyle::with_template("{bar:40} {percent:>3} % {elapsed}, {eta} left, {msg}")?);
    let mut sweep: Sweep = client.get(&path)?;
    let mut told = None;
    loop {
        let counts = &sweep.counts;
        if sweep.waiting_for != told {
            told.clone_from(&sweep.waiting_for);
            bar.suspend(|| warn_of_waiting(&sweep));
        }
        bar.set_position((sweep.progress * 1000.0) as u64);
        let verified = match &sweep.verification {
            Some(SweepVerification { counts, .. }) => {
                format!(", {} of {} verified", counts.succeeded, counts.total)
            }
            None => String::new(),
        };
        bar.set_message(format!(
            "{} of {} points, {} running, {} failed{verified}",
            counts.succeeded, counts.total, counts.running, counts.failed
        ));
        if sweep.finished.is_some() {
            bar.abandon();
            return Ok(sweep);
        }
        sweep = client.get_with_retries(&format!("{path}?wait=30s"))?;
    }
}

/// Warns if queued points wait for a worker that is not there.
pub(crate) fn warn_of_waiting(sweep: &Sweep) {
    if let Some(waiting) = &sweep.waiting_for {
        tracing::warn!("{}", waiting.reason);
    }
}

/// An error if a point has no result, so that scripts can use the exit status.
pub(crate) fn check(sweep: &Sweep) -> anyhow::Result<()> {
    let Sweep { id, counts, .. } = sweep;
    ensure!(counts.failed == 0, "{} points failed; `drillsweep show {id}` has the reasons", counts.failed);
    ensure!(
        counts.cancelled == 0,
        "{} points were cancelled; `drillsweep retry {id}` queues them",
        counts.cancelled
    );
    Ok(())
}
