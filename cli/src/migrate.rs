//! Carrying a store over to another database and object store.

use std::path::PathBuf;

use anyhow::{Context as _, ensure};
use clap::Args;
use drillsweep_store::{
    DatabaseLocation, ObjectsLocation, Role, SourceUse, StoreConfig, TransferProgress, TransferReport,
    transfer,
};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::data::{DataArguments, add_credentials, with_password};
use crate::print;

#[derive(Args)]
pub(crate) struct MigrateArguments {
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    target: TargetArguments,
    /// Copy the store as it is now although workers use it: later changes are not copied, and running
    /// points arrive as queued.
    #[arg(long)]
    while_running: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Destination of the data. The environment does not set it, since it names the present store; except for the service that has
/// the bucket.
#[derive(Args)]
struct TargetArguments {
    /// Directory for the database and the object store, unless these are placed elsewhere.
    #[arg(long, value_name = "DIRECTORY")]
    to_data: Option<PathBuf>,
    /// Target database, which must be empty: `postgres://user@host/name`, or the path of a SQLite file;
    /// `drillsweep.sqlite` in the directory of `--to-data` unless given.
    #[arg(long, visible_alias = "to", value_name = "DATABASE")]
    to_database: Option<DatabaseLocation>,
    /// Target object store for the tables of results: `s3://BUCKET/PREFIX`, or a directory; `blobs` in the directory of `--to-data`
    /// unless given. One that has them already is permitted: they are verified, and stay.
    #[arg(long, value_name = "OBJECTS")]
    to_objects: Option<ObjectsLocation>,
    /// File with the password for the target PostgreSQL database.
    #[arg(long, value_name = "FILE")]
    to_database_password_file: Option<PathBuf>,
    /// File with the credentials for the target bucket, in the form of `--objects-credentials-file`.
    #[arg(long, value_name = "FILE")]
    to_objects_credentials_file: Option<PathBuf>,
}

impl TargetArguments {
    fn store(&self) -> anyhow::Result<StoreConfig> {
        let mut config = match (&self.to_data, &self.to_database, &self.to_objects) {
            (Some(data), ..) => StoreConfig::in_directory(data, Role::Server),
            // Nothing stays.
            (None, Some(_), Some(_)) => StoreConfig::in_directory(&PathBuf::new(), Role::Server),
            (None, ..) => {
                anyhow::bail!(
                    "no destination: give --to-database and --to-objects, or --to-data for a directory"
                )
            }
        };
        if let Some(database) = &self.to_database {
            config.database = database.clone();
        }
        if let Some(objects) = &self.to_objects {
            config.objects = objects.clone();
        }
        if let Some(path) = &self.to_database_password_file {
            config.database = with_password(&config.database, path, "--to-database-password-file")?;
        }
        if let Some(path) = &self.to_objects_credentials_file {
            add_credentials(&mut config.objects, path, "--to-objects-credentials-file")?;
        }
        Ok(config)
    }
}

/// Copies a store, and fails if one of its blobs was lost already.
pub(crate) fn migrate(arguments: &MigrateArguments) -> anyhow::Result<()> {
    let source = arguments.data.existing_store(Role::Worker)?;
    let target = arguments.target.store()?;
    let source_use = if arguments.while_running { SourceUse::Running } else { SourceUse::Idle };
    let bar = ProgressBar::no_length();
    bar.set_style(ProgressStyle::with_template("{bar:40} {pos} of {len} tables of results, {msg}")?);
    let mut show = |progress| match progress {
        TransferProgress::Blobs { done, of } => {
            bar.set_length(of);
            bar.set_position(done);
            bar.set_message("copying");
        }
        TransferProgress::Rows(table) => bar.set_message(format!("copying the rows of {table}")),
        TransferProgress::Compared(table) => bar.set_message(format!("comparing the rows of {table}")),
    };
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let report = runtime.block_on(transfer(&source, &target, source_use, &mut show));
    bar.finish_and_clear();
    let report = report.with_context(|| {
        format!("the store was not migrated to {} and {}", target.database, target.objects)
    })?;
    print(&if arguments.json { as_json(&report)? } else { as_text(&report, &target) });
    ensure!(
        report.lost.is_empty(),
        "{} tables or checkpoints were missing from the source and are missing from the target; `drillsweep check \
         --repair` on the target recomputes them",
        report.lost.len()
    );
    Ok(())
}

fn as_text(report: &TransferReport, target: &StoreConfig) -> String {
    let rows: u64 = report.rows.iter().map(|(_, rows)| rows).sum();
    let copied = report.blobs - report.blobs_present - report.lost.len() as u64;
    let mut lines = vec![
        format!(
            "{rows} rows of {} tables were copied to {} and compared",
            report.rows.len(),
            target.database
        ),
        format!(
            "{copied} blobs of {} bytes were copied to {}, {} existed already",
            report.bytes_copied, target.objects, report.blobs_present
        ),
    ];
    if report.released > 0 {
        lines.push(format!("{} running points are queued in the target", report.released));
    }
    lines.extend(report.lost.iter().map(|lost| format!("  {lost}")));
    lines.join("\n")
}

fn as_json(report: &TransferReport) -> anyhow::Result<String> {
    let rows: serde_json::Map<String, serde_json::Value> =
        report.rows.iter().map(|(table, rows)| ((*table).to_owned(), (*rows).into())).collect();
    Ok(serde_json::to_string_pretty(&json!({
        "rows": rows,
        "blobs": report.blobs,
        "blobs_present": report.blobs_present,
        "bytes_copied": report.bytes_copied,
        "released": report.released,
        "lost": report.lost,
    }))?)
}
