//! Verification of a data directory.

use anyhow::ensure;
use clap::Args;
use drillsweep_api::PHYSICS_VERSION;
use drillsweep_store::{RepairReport, Role, Store};
use serde_json::json;

use crate::data::DataArguments;
use crate::print;
use crate::text::count;

#[derive(Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    data: DataArguments,
    /// Queue points again if their results have lost a table, so that workers recompute them.
    #[arg(long)]
    repair: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Reads the database and every blob, and fails if something is wrong with them; also if that is being repaired. Access of other
/// users to them is a warning.
pub(crate) fn check(arguments: &CheckArguments) -> anyhow::Result<()> {
    let config = arguments.data.existing_store(Role::Worker)?;
    let warnings: Vec<String> = arguments.data.exposed(&config).iter().map(ToString::to_string).collect();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let (report, repair) = runtime.block_on(async {
        let store = match arguments.repair {
            true => Store::open(&config).await?,
            false => Store::open_read_only(&config).await?,
        };
        let report = store.check().await?;
        let repair = match arguments.repair {
            true => Some(store.repair(&report, PHYSICS_VERSION.into()).await?),
            false => None,
        };
        store.close().await;
        anyhow::Ok((report, repair))
    })?;
    if arguments.json {
        print(&serde_json::to_string_pretty(&json!({
            "results": report.results,
            "blobs": report.blobs,
            "bytes": report.bytes,
            "problems": report.problems,
            "warnings": warnings,
            "repair": repair.map(|repair| json!({
                "queued": repair.queued,
                "under_way": repair.under_way,
                "other_physics_versions": repair.other_numbers,
            })),
        }))?);
    } else {
        print(&format!("{} results, {} blobs of {} bytes", report.results, report.blobs, report.bytes));
        for problem in &report.problems {
            print(&format!("  {problem}"));
        }
        for warning in &warnings {
            print(&format!("warning: {warning}"));
        }
        if let Some(RepairReport { queued, under_way, other_numbers }) = repair {
            print(&format!(
                "{queued} results are queued for recomputation, {under_way} were queued or running already"
            ));
            if other_numbers > 0 {
                print(&format!(
                    "{other_numbers} results are of another physics version than {PHYSICS_VERSION} and cannot be recomputed"
                ));
            }
        }
    }
    ensure!(report.problems.is_empty(), "{} found", count(report.problems.len(), "problem"));
    Ok(())
}
