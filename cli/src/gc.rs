//! Collecting garbage: what has reached its age, and blobs that no row names.

use std::collections::BTreeMap;
use std::time::Duration;

use anyhow::Context;
use clap::Args;
use drillsweep_store::{Garbage, RetentionPolicy, Role, Store};
use serde_json::json;

use crate::print;
use crate::service::DataArguments;

/// The artifacts that hold recordings: large, and made again from their scenario when needed.
const RECORDINGS: [&str; 1] = ["history"];

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
    /// Days for which recordings (histories; orbits and spectra are cut from them) are kept.
    #[arg(long, default_value_t = 30)]
    recordings_days: u32,
    /// Days for which the other tables of points are kept.
    #[arg(long, default_value_t = 365)]
    tables_days: u32,
    /// Days for which events are kept.
    #[arg(long, default_value_t = 30)]
    events_days: u32,
    /// Hours for which a blob that no row names is kept: longer than a point may take.
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..))]
    grace_hours: u32,
}

/// Deletes expired data, and reports how much that was.
pub(crate) fn gc(arguments: &GcArguments) -> anyhow::Result<()> {
    let recordings = DAY * arguments.recordings_days;
    let policy = RetentionPolicy {
        artifact_ages: RECORDINGS
            .iter()
            .map(|name| ((*name).to_owned(), recordings))
            .collect::<BTreeMap<_, _>>(),
        other_artifacts: DAY * arguments.tables_days,
        events: DAY * arguments.events_days,
        blob_grace: Duration::from_secs(3_600) * arguments.grace_hours,
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let garbage = runtime.block_on(async {
        let store = Store::open(&arguments.data.existing_store(Role::Server)?).await?;
        let garbage =
            store.collect_garbage(&policy, arguments.dry_run).await.context("garbage cannot be collected")?;
        store.close().await;
        anyhow::Ok(garbage)
    })?;
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
    if arguments.json {
        let report = json!({
            "dry_run": arguments.dry_run,
            "sweeps": sweeps,
            "results": results,
            "artifacts": artifacts,
            "scenarios": scenarios,
            "events": events,
            "blobs": blobs,
            "blob_bytes": blob_bytes,
            "unfinished_uploads": unfinished_uploads,
            "unfinished_bytes": unfinished_bytes,
        });
        print(&serde_json::to_string_pretty(&report)?);
        return Ok(());
    }
    let verb = if arguments.dry_run { "would be deleted" } else { "deleted" };
    print(&format!(
        "{verb}: {sweeps} sweeps, {results} results, {artifacts} artifacts, {scenarios} scenarios, {events} events\n\
         {blobs} blobs of {:.1} MB, {unfinished_uploads} unfinished uploads of {:.1} MB",
        blob_bytes as f64 * 1e-6,
        unfinished_bytes as f64 * 1e-6
    ));
    Ok(())
}
