//! Garbage collection: expired data, and unreferenced blobs.

use std::time::Duration;

use anyhow::Context;
use clap::Args;
use drillsweep_server::RetentionConfig;
use drillsweep_store::{Garbage, RetentionPolicy, Role, Store};

use crate::data::DataArguments;
use crate::print;

const DAY: Duration = Duration::from_secs(86_400);

#[derive(Args)]
pub(crate) struct GcArguments {
    #[command(flatten)]
    data: DataArguments,
    /// Report what would be deleted, and delete nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    retention: RetentionArguments,
}

/// Ages at which data are deleted.
#[derive(Args, Clone)]
pub(crate) struct RetentionArguments {
    /// Days for which recordings (histories, from which orbits and spectra are cut, and snapshots) are kept.
    #[arg(long, value_name = "DAYS", default_value_t = 30)]
    recordings_days: u32,
    /// Days for which the other tables of points are kept.
    #[arg(long, value_name = "DAYS", default_value_t = 365)]
    tables_days: u32,
    /// Days for which events are kept.
    #[arg(long, value_name = "DAYS", default_value_t = 30)]
    events_days: u32,
    /// Hours for which an unreferenced blob is kept: longer than a point may take.
    #[arg(long, value_name = "HOURS", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..))]
    grace_hours: u32,
}

impl RetentionArguments {
    /// Retention policy by these arguments.
    pub(crate) fn policy(&self) -> RetentionPolicy {
        let mut policy = RetentionConfig::default().policy;
        policy.artifact_ages = RetentionConfig::of_recordings(DAY * self.recordings_days);
        policy.other_artifacts = DAY * self.tables_days;
        policy.events = DAY * self.events_days;
        policy.blob_grace = Duration::from_secs(3_600) * self.grace_hours;
        policy
    }
}

/// Deletes expired data, and reports how much that was.
pub(crate) fn gc(arguments: &GcArguments) -> anyhow::Result<()> {
    let policy = arguments.retention.policy();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let garbage = runtime.block_on(async {
        let store = Store::open(&arguments.data.existing_store(Role::Server)?).await?;
        let garbage =
            store.collect_garbage(&policy, arguments.dry_run).await.context("garbage cannot be collected")?;
        store.close().await;
        anyhow::Ok(garbage)
    })?;
    if arguments.json {
        let mut report = garbage.to_json();
        report["dry_run"] = arguments.dry_run.into();
        print(&serde_json::to_string_pretty(&report)?);
        return Ok(());
    }
    let Garbage {
        sweeps,
        results,
        artifacts,
        scenarios,
        events,
        blobs,
        blob_bytes,
        unfinished_uploads,
        unfinished_bytes,
    } = garbage;
    let verb = if arguments.dry_run { "would be deleted" } else { "deleted" };
    print(&format!(
        "{verb}: {sweeps} sweeps, {results} results, {artifacts} artifacts, {scenarios} scenarios, {events} events\n\
         {blobs} blobs of {:.1} MB, {unfinished_uploads} unfinished uploads of {:.1} MB",
        blob_bytes as f64 * 1e-6,
        unfinished_bytes as f64 * 1e-6
    ));
    Ok(())
}
